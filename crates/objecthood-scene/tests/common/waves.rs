//! The disagreement of neighbouring blocks.

use objecthood::Raster;

/// docs/CONTEXT.md 0.2: what a Kinect v1 resolves.
const QUANTUM_PER_M: f64 = 0.00285;

/// Sums over a block of `side` x `side` pixels about its middle: d, d x, d y, and the squares that its plane leaves.
struct Block {
    sums: [f64; 3],
    rest: f64,
}

/// First quartile over all pairs of neighbouring whole blocks of how much worse one plane for both fits than one for
/// each (quanta), the merge cost of docs/CONTEXT.md 3.5. `None` when there are fewer than 40 pairs.
pub(crate) fn disagreement(depth_m: &Raster<f32>, side: usize) -> Option<f64> {
    let (width, height) = depth_m.size();
    let (columns, rows) = (width / side, height / side);
    let blocks: Vec<Option<Block>> = (0..columns * rows)
        .map(|k| Block::of(depth_m, [k % columns * side, k / columns * side], side))
        .collect();
    let mut costs = Vec::new();
    for k in 0..blocks.len() {
        let right = (k % columns + 1 < columns).then_some((k + 1, [1, 2]));
        let below = (k + columns < blocks.len()).then_some((k + columns, [2, 1]));
        for (other, axes) in [right, below].into_iter().flatten() {
            if let (Some(a), Some(b)) = (&blocks[k], &blocks[other]) {
                costs.push(cost(a, b, axes, side as f64));
            }
        }
    }
    costs.sort_by(f64::total_cmp);
    (costs.len() >= 40).then(|| costs[costs.len() / 4])
}

impl Block {
    fn of(depth_m: &Raster<f32>, [u, v]: [usize; 2], side: usize) -> Option<Self> {
        let quanta = |x: usize, y: usize| {
            1.0 / (f64::from(depth_m[(v + y) * depth_m.width() + u + x]) * QUANTUM_PER_M)
        };
        // Without the block's own level the squares keep their digits.
        let level = quanta(0, 0);
        let (mut sums, mut squares) = ([0.0; 3], 0.0);
        for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
            let d = quanta(x, y) - level;
            let middle = (side - 1) as f64 / 2.0;
            for (sum, by) in sums.iter_mut().zip([1.0, x as f64 - middle, y as f64 - middle]) {
                *sum += d * by;
            }
            squares += d * d;
        }
        let (n, s2) = spread(side as f64);
        let rest = squares - sums[0] * sums[0] / n - (sums[1] * sums[1] + sums[2] * sums[2]) / s2;
        sums[0] += n * level;
        rest.is_finite().then_some(Self { sums, rest })
    }
}

/// Number of pixels of a block, and the sum of squares of their columns about the middle.
fn spread(side: f64) -> (f64, f64) {
    (side * side, side * side * (side * side - 1.0) / 12.0)
}

/// `axes`: which sum runs along the pair, and which across.
fn cost(a: &Block, b: &Block, [along, across]: [usize; 2], side: f64) -> f64 {
    let (n, s2) = spread(side);
    let slopes = |block: &Block| (block.sums[1] * block.sums[1] + block.sums[2] * block.sums[2]) / s2;
    let step = (b.sums[0] - a.sums[0]) / n;
    let tilt = a.sums[along] + b.sums[along] + n * step * side / 2.0;
    let roll = a.sums[across] + b.sums[across];
    let joint_tilt = tilt * tilt / (2.0 * n * (4.0 * side * side - 1.0) / 12.0);
    let extra = slopes(a) + slopes(b) + n * step * step / 2.0 - joint_tilt - roll * roll / (2.0 * s2);
    // A surface that is steep wobbles by the lateral noise, which is no wave: 0.8 px (docs/CONTEXT.md 1.2) times its slope.
    let slope = |block: &Block| slopes(block).sqrt() / s2.sqrt();
    let steepness = 0.8 * slope(a).min(slope(b));
    (extra.max(0.0) * 2.0 / n).sqrt() / (1.0 + steepness * steepness).sqrt()
}
