//! Superpixels of `context`: watershed of the fit residual (docs/CONTEXT.md 1.2).

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::oversegment::links::{FREE, Links, STRETCH};
use crate::params;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::simd::vectorized;
use crate::surface::disparity::DisparitySpace;

/// Levels of the relief per quantum of residual.
const LEVELS_PER_QUANTUM: f32 = 40.0;
/// The level of pixels without a fit; it is flooded last.
const HIGHEST: usize = 255;
/// Between frames each queue keeps room for 1 in 64 pixels; all together take at most 16 bytes a pixel.
const KEPT_SHARE: usize = 64;

/// One seed per block of `seed_block_px`: its first free pixel of least residual (quanta). Blocks without free pixels have none.
/// O(pixels); parallel over rows of blocks.
pub fn find_seeds(
    residual: &Raster<f32>,
    links: &Links,
    space: &DisparitySpace,
    params: &params::Watershed,
) -> Vec<usize> {
    let block = space.length_px(params.seed_block_px);
    let tops: Vec<usize> = (0..residual.height()).step_by(block).collect();
    tops.par_iter().map(|&top| find_seeds_from(top, block, residual, links)).flatten_iter().collect()
}

/// The seeds of the blocks whose top row is `top`.
fn find_seeds_from(top: usize, block: usize, residual: &Raster<f32>, links: &Links) -> Vec<usize> {
    let (width, height) = residual.size();
    // The least residual of each column and its first row. Residuals are not negative, so their bits sort in the same order.
    let (mut least, mut rows) = (vec![i32::MAX; width], vec![0; width]);
    vectorized(
        #[inline(always)]
        || {
            for v in top..height.min(top + block) {
                let row = v * width..(v + 1) * width;
                let pixels = residual.as_slice()[row.clone()].iter().zip(&links.sides.as_slice()[row]);
                for ((least, row), (residual, sides)) in least.iter_mut().zip(&mut rows).zip(pixels) {
                    let bits = if sides & FREE != 0 { residual.to_bits() as i32 } else { i32::MAX };
                    let is_less = bits < *least;
                    *least = if is_less { bits } else { *least };
                    *row = if is_less { v as i32 } else { *row };
                }
            }
        },
    );
    let columns: Vec<_> = least.into_iter().zip(rows).zip(0..).collect();
    let firsts = columns.chunks(block).filter_map(|columns| columns.iter().min());
    let seed = |&((bits, v), u): &((i32, i32), usize)| (bits < i32::MAX).then_some(v as usize * width + u);
    firsts.filter_map(seed).collect()
}

/// Floods the relief of fit residuals (quanta) from the seeds, across links only. Each seed gives one superpixel, and so does each
/// connected group of free pixels that no seed reaches.
///
/// Watershed by flooding (Meyer 1994): regions first grow where residuals are small and meet at edges. Superpixels cover all free
/// pixels. `seeds`: indices of free pixels, each once. O(pixels).
///
/// # Panics
/// When a seed lies outside the image, or when `links` belong to an image of another size.
pub fn flood(residual: &Raster<f32>, seeds: &[usize], links: &Links) -> Segments {
    let mut queues: Buffer<Vec<u32>> = Buffer::stale(HIGHEST + 1, Vec::new());
    queues.iter_mut().for_each(Vec::clear);
    let mut labels = Buffer::filled(residual.len(), Segments::NONE);
    let level = |i: usize| match residual[i] {
        e if e.is_finite() => ((LEVELS_PER_QUANTUM * e) as usize).min(HIGHEST - 1),
        _ => HIGHEST,
    };
    let mut count = 0;
    for &i in seeds {
        labels[i] = count;
        count += 1;
        queues[level(i)].push(i as u32);
    }
    for now in 0..=HIGHEST {
        // A pixel reached at this level is flooded now, even if its own level is lower.
        let (mut queue, mut first) = (std::mem::take(&mut queues[now]), 0);
        while let Some(&i) = queue.get(first) {
            let label = labels[i as usize];
            for j in links.neighbours(i as usize) {
                if labels[j] == Segments::NONE {
                    labels[j] = label;
                    let level = level(j);
                    let queue = if level > now { &mut queues[level] } else { &mut queue };
                    queue.push(j as u32);
                }
            }
            first += 1;
        }
        queue.clear();
        queue.shrink_to(residual.len() / KEPT_SHARE);
        queues[now] = queue;
    }
    count += flood_the_rest(links, &mut labels, count);
    Segments::from_numbered(residual.with_data(labels), count as usize)
}

/// Labels the free pixels that are still unlabelled: one new label, from `first` on, for each connected group. Returns the number
/// of groups.
fn flood_the_rest(links: &Links, labels: &mut [i32], first: i32) -> i32 {
    let mut next = first;
    let mut open = Vec::new();
    for start in (0..labels.len()).step_by(STRETCH) {
        let stretch = start..labels.len().min(start + STRETCH);
        let is_left = |(label, sides): (&i32, &u8)| (*label == Segments::NONE) & (sides & FREE != 0);
        let sides = &links.sides.as_slice()[stretch.clone()];
        if !labels[stretch.clone()].iter().zip(sides).fold(false, |any, pixel| any | is_left(pixel)) {
            continue;
        }
        for i in stretch {
            if !is_left((&labels[i], &links.sides[i])) {
                continue;
            }
            labels[i] = next;
            open.push(i);
            while let Some(i) = open.pop() {
                for j in links.neighbours(i) {
                    if labels[j] == Segments::NONE {
                        labels[j] = next;
                        open.push(j);
                    }
                }
            }
            next += 1;
        }
    }
    next - first
}

#[cfg(test)]
mod tests;
