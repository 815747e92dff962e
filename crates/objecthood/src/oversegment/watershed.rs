//! Superpixels of `context`: watershed of the fit residual (docs/CONTEXT.md 1.2).

use std::ops::Range;

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::params;
use crate::raster::{Raster, marked};
use crate::regions::{RegionEdge, RegionGraph, SegmentId, Segments};
use crate::simd::vectorized;
use crate::surface::disparity::DisparitySpace;

/// Which neighbouring pixels lie on one surface, of everything measured that is no structure.
///
/// One byte a pixel, so that a look at it answers for all its neighbours.
#[derive(Debug)]
pub struct Links {
    sides: Raster<u8>,
}

/// The pixel to the right, to the left, below, above is on one surface with this one.
const RIGHT: u8 = 1;
const LEFT: u8 = 2;
const DOWN: u8 = 4;
const UP: u8 = 8;
/// This pixel is measured and no structure.
const FREE: u8 = 16;

/// Levels of the relief per quantum of residual.
const LEVELS_PER_QUANTUM: f32 = 40.0;
/// The level of pixels without a fit, and the number of levels below it.
const HIGHEST: usize = 255;
/// The queue of a level is kept for this share of the pixels: of all levels together 16 bytes a pixel at most.
const KEPT_SHARE: usize = 64;
/// Pixels of a row of which is asked first whether any is free.
const STRETCH: usize = 64;

/// What of a row decides about links.
#[derive(Clone, Copy)]
struct Pixels<'a> {
    disparity: &'a [f32],
    slope: &'a [[f32; 2]],
    structure: &'a [i32],
}

/// How far pixels on one surface may be apart.
struct Limits {
    jump_quanta: f32,
    lateral_noise_px: f32,
}

impl Links {
    /// The links of a frame with these disparities and slopes. `structure`: -1 = none. O(pixels); parallel over rows.
    ///
    /// Two 4-neighbours are linked when their disparities differ by no more than the slope of either explains, but for
    /// `link_jump_quanta` and the sideways noise.
    pub fn new(
        disparity: &Raster<f32>,
        slope: &Raster<[f32; 2]>,
        structure: &Raster<i32>,
        space: &DisparitySpace,
        params: &params::Watershed,
    ) -> Self {
        let (width, height) = disparity.size();
        let limits = Limits {
            jump_quanta: params.link_jump_quanta,
            lateral_noise_px: space.lateral_noise_px() as f32,
        };
        let pixels = |v: usize, columns: Range<usize>| {
            let part = v * width + columns.start..v * width + columns.end;
            Pixels {
                disparity: &disparity.as_slice()[part.clone()],
                slope: &slope.as_slice()[part.clone()],
                structure: &structure.as_slice()[part],
            }
        };
        let stretch = |v: usize, left: usize, sides: &mut [u8]| {
            let right = left + sides.len();
            let own = pixels(v, left..right);
            own.mark_free(sides);
            if sides.iter().fold(0, |any, sides| any | sides) == 0 {
                return;
            }
            let (inner, outer) = (left.max(1), right.min(width - 1));
            limits.link(
                [pixels(v, left..outer), pixels(v, left + 1..outer + 1)],
                0,
                RIGHT,
                &mut sides[..outer - left],
            );
            limits.link(
                [pixels(v, inner - 1..right - 1), pixels(v, inner..right)],
                0,
                LEFT,
                &mut sides[inner - left..],
            );
            if v + 1 < height {
                limits.link([own, pixels(v + 1, left..right)], 1, DOWN, sides);
            }
            if v > 0 {
                limits.link([pixels(v - 1, left..right), own], 1, UP, sides);
            }
        };
        let mut sides = Buffer::stale(disparity.len(), 0);
        sides.par_chunks_mut(width).enumerate().for_each(|(v, sides)| {
            vectorized(
                #[inline(always)]
                || {
                    for (k, sides) in sides.chunks_mut(STRETCH).enumerate() {
                        stretch(v, k * STRETCH, sides);
                    }
                },
            );
        });
        Self { sides: disparity.with_data(sides) }
    }

    /// The linked neighbours of pixel `i`: right, left, below, above.
    #[inline]
    fn neighbours(&self, i: usize) -> impl Iterator<Item = usize> {
        let (sides, width) = (self.sides[i], self.sides.width());
        let to = [(RIGHT, 1), (LEFT, 1_usize.wrapping_neg()), (DOWN, width), (UP, width.wrapping_neg())];
        to.into_iter().filter(move |(side, _)| sides & side != 0).map(move |(_, step)| i.wrapping_add(step))
    }
}

impl Pixels<'_> {
    /// Marks which are free, and nothing else.
    #[inline(always)]
    fn mark_free(&self, sides: &mut [u8]) {
        for ((sides, d), structure) in sides.iter_mut().zip(self.disparity).zip(self.structure) {
            *sides = FREE * u8::from(!d.is_nan() & (*structure < 0));
        }
    }
}

impl Limits {
    /// Marks with this `side` where a pixel is linked to the next one along the axis (0: to its right, 1: below).
    #[inline(always)]
    fn link(&self, [own, next]: [Pixels<'_>; 2], axis: usize, side: u8, sides: &mut [u8]) {
        let own = own.disparity.iter().zip(own.slope).zip(own.structure);
        let next = next.disparity.iter().zip(next.slope).zip(next.structure);
        for (sides, (((d_i, slope_i), structure_i), ((d_j, slope_j), structure_j))) in
            sides.iter_mut().zip(own.zip(next))
        {
            let (rise, rise_i, rise_j) = (d_j - d_i, slope_i[axis], slope_j[axis]);
            // Not a number without either disparity, which is no less than anything.
            let misfit = (rise - rise_i).abs().min((rise - rise_j).abs());
            let limit = self.jump_quanta + 0.5 * self.lateral_noise_px * rise_i.abs().min(rise_j.abs());
            *sides |= side * u8::from((misfit < limit) & (structure_i & structure_j < 0));
        }
    }
}

/// Superpixels on everything measured that is no structure: regions grow in flat surface first and meet on the edges.
///
/// Watershed by flooding (Meyer 1994) of the relief of fit residuals (quanta) from [`seeds`], across links only; what no
/// seed reaches is flooded by itself. O(pixels).
pub fn watershed(residual: &Raster<f32>, seeds: &[usize], links: &Links) -> Segments {
    let mut floods: Buffer<Vec<u32>> = Buffer::stale(HIGHEST + 1, Vec::new());
    floods.iter_mut().for_each(Vec::clear);
    let mut labels = Buffer::filled(residual.len(), Segments::NONE);
    let level = |i: usize| match residual[i] {
        e if e.is_finite() => ((LEVELS_PER_QUANTUM * e) as usize).min(HIGHEST - 1),
        _ => HIGHEST,
    };
    let mut count = 0;
    for &i in seeds {
        labels[i] = count;
        count += 1;
        floods[level(i)].push(i as u32);
    }
    for now in 0..=HIGHEST {
        // What is reached from here belongs here, however low it lies.
        let (mut flood, mut first) = (std::mem::take(&mut floods[now]), 0);
        while let Some(&i) = flood.get(first) {
            let label = labels[i as usize];
            for j in links.neighbours(i as usize) {
                if labels[j] == Segments::NONE {
                    labels[j] = label;
                    let level = level(j);
                    let flood = if level > now { &mut floods[level] } else { &mut flood };
                    flood.push(j as u32);
                }
            }
            first += 1;
        }
        flood.clear();
        flood.shrink_to(residual.len() / KEPT_SHARE);
        floods[now] = flood;
    }
    count += flood_the_rest(links, &mut labels, count);
    Segments::from_numbered(residual.with_data(labels), count as usize)
}

/// Of every block with free pixels the first of those with the least residual. O(pixels); parallel over rows of blocks.
pub fn seeds(
    residual: &Raster<f32>,
    links: &Links,
    space: &DisparitySpace,
    params: &params::Watershed,
) -> Vec<usize> {
    let (width, height) = residual.size();
    let block = space.length_px(params.seed_block_px);
    let seeds_from = |top: usize| -> Vec<usize> {
        // Of every column the least, and the first row that has it. Residuals are not negative: their bits are in their order.
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
        let seed =
            |&((bits, v), u): &((i32, i32), usize)| (bits < i32::MAX).then_some(v as usize * width + u);
        firsts.filter_map(seed).collect()
    };
    let tops: Vec<usize> = (0..height).step_by(block).collect();
    tops.par_iter().map(|&top| seeds_from(top)).flatten_iter().collect()
}

/// Labels what is free and has no label yet, piece by piece, from `first` on; says how many pieces there are.
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

/// How many linked pairs of 4-neighbours join any two superpixels. O(pixels); parallel over rows.
pub fn linked_pairs(superpixels: &Segments, links: &Links) -> RegionGraph<u32> {
    let (width, height) = superpixels.labels().size();
    let labels = superpixels.labels().as_slice();
    let from_row = |marks: &mut Vec<i32>, v: usize| {
        let start = v * width;
        let own = &labels[start..start + width];
        let sides = &links.sides.as_slice()[start..start + width];
        // What has no neighbour on a side has no link there.
        let right = &labels[start + 1..labels.len().min(start + width + 1)];
        let below = if v + 1 < height { &labels[start + width..start + 2 * width] } else { own };
        vectorized(
            #[inline(always)]
            || {
                let mark = |side: u8, sides: u8, a: i32, b: i32| {
                    i32::from(side * u8::from((a != b) & (a >= 0) & (b >= 0) & (sides & side != 0)))
                };
                for (((marked, sides), a), b) in marks.iter_mut().zip(sides).zip(own).zip(below) {
                    *marked = mark(DOWN, *sides, *a, *b);
                }
                for (((marked, sides), a), b) in marks.iter_mut().zip(sides).zip(own).zip(right) {
                    *marked |= mark(RIGHT, *sides, *a, *b);
                }
            },
        );
        let mut pairs: Vec<([u32; 2], u32)> = Vec::new();
        for u in marked(marks) {
            let i = start + u;
            for (side, j) in [(DOWN, i + width), (RIGHT, i + 1)] {
                if marks[u] & i32::from(side) != 0 {
                    let pair = [labels[i].min(labels[j]), labels[i].max(labels[j])].map(|s| s as u32);
                    // The same pair comes often in a row.
                    match pairs.last_mut() {
                        Some((last, times)) if *last == pair => *times += 1,
                        _ => pairs.push((pair, 1)),
                    }
                }
            }
        }
        pairs
    };
    let rows = (0..height).into_par_iter().map_init(|| vec![0; width], from_row);
    let rows: Vec<Vec<_>> = rows.collect();
    counted(superpixels.count(), rows.into_iter().flatten())
}

/// The graph of pairs that come, the smaller number first, with how often each does. A superpixel has few neighbours: for each
/// pair its list is searched, which takes less time than to sort all that come.
fn counted(superpixels: usize, pairs: impl Iterator<Item = ([u32; 2], u32)>) -> RegionGraph<u32> {
    const END: u32 = u32::MAX;
    let mut firsts = vec![END; superpixels];
    // The other superpixel, how often, and the next in the list.
    let mut entries: Vec<(u32, u32, u32)> = Vec::new();
    for ([a, b], times) in pairs {
        let first = &mut firsts[a as usize];
        let mut at = *first;
        while at != END && entries[at as usize].0 != b {
            at = entries[at as usize].2;
        }
        match entries.get_mut(at as usize) {
            Some(entry) => entry.1 += times,
            None => {
                entries.push((b, times, *first));
                *first = entries.len() as u32 - 1;
            }
        }
    }
    let mut edges = Vec::with_capacity(entries.len());
    for (a, first) in (0..).zip(firsts) {
        let (own, mut at) = (edges.len(), first);
        while let Some(&(b, times, next)) = entries.get(at as usize) {
            edges.push(RegionEdge { a: SegmentId(a), b: SegmentId(b), evidence: times });
            at = next;
        }
        edges[own..].sort_unstable_by_key(|edge| edge.b);
    }
    RegionGraph::from_sorted(superpixels, edges)
}

#[cfg(test)]
mod tests {
    use std::cmp::Reverse;
    use std::collections::{BTreeMap, BinaryHeap};

    use proptest::prelude::*;

    use super::*;
    use crate::testing::{coarse_disparity, kinect, raster, small_size};

    /// What the watershed looks at, in coarse steps, so that levels and residuals tie.
    #[derive(Clone, Debug)]
    struct Relief {
        disparity: Raster<f32>,
        slope: Raster<[f32; 2]>,
        residual: Raster<f32>,
        structure: Raster<i32>,
    }

    fn relief() -> impl Strategy<Value = Relief> {
        // None, and from flat to beyond the highest level.
        let residual = prop_oneof![1 => Just(f32::INFINITY), 6 => (0_u8..6).prop_map(|k| 1.3 * f32::from(k))];
        let slope = prop::array::uniform2(-2_i8..=2).prop_map(|slope| slope.map(|s| 1.5 * f32::from(s)));
        let structure = prop_oneof![7 => Just(-1), 1 => Just(0)];
        // Small, and wider than what is looked at together.
        let size = prop_oneof![4 => small_size(), 1 => (STRETCH - 3..STRETCH + 9, 1_usize..5)];
        size.prop_flat_map(move |size| {
            let disparity = raster(size, coarse_disparity());
            let parts = (
                disparity,
                raster(size, slope.clone()),
                raster(size, residual.clone()),
                raster(size, structure.clone()),
            );
            parts.prop_map(|(disparity, slope, residual, structure)| Relief {
                disparity,
                slope,
                residual,
                structure,
            })
        })
    }

    /// Links and superpixels.
    fn flooded(relief: &Relief, params: &params::Watershed) -> (Links, Segments) {
        let Relief { disparity, slope, residual, structure } = relief;
        let links = Links::new(disparity, slope, structure, &kinect(), params);
        let seeds = seeds(residual, &links, &kinect(), params);
        let superpixels = watershed(residual, &seeds, &links);
        (links, superpixels)
    }

    /// The neighbours of a pixel in the order of the flood.
    fn around(i: usize, (width, height): (usize, usize)) -> Vec<(usize, usize)> {
        let (u, v) = ((i % width) as isize, (i / width) as isize);
        [(1, 0), (-1, 0), (0, 1), (0, -1)]
            .into_iter()
            .map(|(du, dv)| (u + du, v + dv, usize::from(dv != 0)))
            .filter(|&(u, v, _)| (0..width as isize).contains(&u) && (0..height as isize).contains(&v))
            .map(|(u, v, axis)| (v as usize * width + u as usize, axis))
            .collect()
    }

    /// Whether two measured 4-neighbours that are no structure lie on one surface, from the words of docs/CONTEXT.md 1.2.
    fn linked(relief: &Relief, i: usize, j: usize, axis: usize) -> bool {
        let Relief { disparity, slope, structure, .. } = relief;
        let step = if j > i { 1.0 } else { -1.0 };
        let rise = disparity[j] - disparity[i];
        let slopes = [i, j].map(|k| slope[k][axis] * step);
        let misfit = slopes.map(|slope| (rise - slope).abs());
        let sideways = 0.8 * slopes[0].abs().min(slopes[1].abs());
        structure[i] < 0 && structure[j] < 0 && misfit[0].min(misfit[1]) < 2.5 + 0.5 * sideways
    }

    /// Floods pixel by pixel, always from the lowest level, there from the pixel that was reached first.
    fn naive(relief: &Relief, block: usize) -> Vec<i32> {
        let Relief { disparity, residual, structure, .. } = relief;
        let size = disparity.size();
        let is_free = |i: usize| !disparity[i].is_nan() && structure[i] < 0;
        let level = |i: usize| {
            if residual[i].is_finite() { (residual[i] * 40.0).floor().min(254.0) as usize } else { 255 }
        };
        let mut seeds: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        for i in (0..disparity.len()).filter(|&i| is_free(i)) {
            let seed = seeds.entry((i / size.0 / block, i % size.0 / block)).or_insert(i);
            if residual[i] < residual[*seed] {
                *seed = i;
            }
        }
        let mut labels = vec![-1; disparity.len()];
        let mut queue = BinaryHeap::new();
        let mut reached = 0;
        for (label, &i) in seeds.values().enumerate() {
            labels[i] = label as i32;
            queue.push(Reverse((level(i), reached, i)));
            reached += 1;
        }
        let mut count = seeds.len() as i32;
        loop {
            while let Some(Reverse((now, _, i))) = queue.pop() {
                for (j, axis) in around(i, size) {
                    if labels[j] < 0 && linked(relief, i, j, axis) {
                        labels[j] = labels[i];
                        queue.push(Reverse((level(j).max(now), reached, j)));
                        reached += 1;
                    }
                }
            }
            let Some(left) = (0..labels.len()).find(|&i| labels[i] < 0 && is_free(i)) else { return labels };
            labels[left] = count;
            count += 1;
            queue.push(Reverse((0, reached, left)));
        }
    }

    proptest! {
        #[test]
        fn the_flood_is_the_naive_one(relief in relief(), block in 1_usize..6) {
            let params = params::Watershed { seed_block_px: block, link_jump_quanta: 2.5 };
            let (_, superpixels) = flooded(&relief, &params);
            let expected = naive(&relief, block);
            prop_assert_eq!(superpixels.labels().as_slice(), expected.as_slice());
            prop_assert_eq!(superpixels.count() as i32, expected.iter().max().map_or(0, |most| most + 1));
        }

        #[test]
        fn superpixels_cover_what_is_free_and_hang_together_by_links(relief in relief()) {
            let params = params::Watershed { seed_block_px: 3, link_jump_quanta: 2.5 };
            let (links, superpixels) = flooded(&relief, &params);
            let Relief { disparity, structure, .. } = &relief;
            let size = disparity.size();
            let mut pairs: BTreeMap<(u32, u32), u32> = BTreeMap::new();
            let mut parts = crate::union_find::UnionFind::new(disparity.len());
            for i in 0..disparity.len() {
                let is_free = !disparity[i].is_nan() && structure[i] < 0;
                prop_assert_eq!(superpixels.at(i).is_some(), is_free, "{}", i);
                for (j, axis) in around(i, size) {
                    let is_linked = links.neighbours(i).any(|k| k == j);
                    prop_assert_eq!(is_linked, linked(&relief, i, j, axis), "{} {}", i, j);
                    prop_assert_eq!(is_linked, linked(&relief, j, i, axis), "{} {}", i, j);
                    let (Some(a), Some(b)) = (superpixels.at(i), superpixels.at(j)) else { continue };
                    if a == b && is_linked {
                        let [p, q] = [i, j].map(|k| parts.find(k));
                        parts.link(p, q);
                    } else if a < b && is_linked {
                        *pairs.entry((a.0, b.0)).or_default() += 1;
                    }
                }
            }
            // In one piece each.
            let mut root: BTreeMap<SegmentId, usize> = BTreeMap::new();
            for i in (0..disparity.len()).filter(|&i| superpixels.at(i).is_some()) {
                let found = parts.find(i);
                let expected = superpixels.at(i).map(|s| *root.entry(s).or_insert(found));
                prop_assert_eq!(expected, Some(found), "{}", i);
            }
            let graph = linked_pairs(&superpixels, &links);
            let got: Vec<_> = graph.edges().iter().map(|e| ((e.a.0, e.b.0), e.evidence)).collect();
            prop_assert_eq!(got, pairs.into_iter().collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_step_parts_and_a_slope_does_not() {
        let params = params::Watershed::default();
        let disparity = Raster::from_vec(4, 1, vec![200.0, 207.0, 214.0, 230.0]).unwrap();
        let linked = |slope: f32| {
            let slopes = Raster::filled(4, 1, [slope, 0.0]).unwrap();
            let structure = Raster::filled(4, 1, -1).unwrap();
            let links = Links::new(&disparity, &slopes, &structure, &kinect(), &params);
            [0, 1, 2].map(|i| links.neighbours(i).any(|j| j == i + 1))
        };
        assert_eq!(linked(0.0), [false, false, false]);
        assert_eq!(linked(7.0), [true, true, false]);
        // 0.8 px of sideways noise on a slope of 12 quanta/px are 4.8 quanta more to either side.
        assert_eq!(linked(12.0), [true, true, true]);
    }
}
