//! Edges of the pixel graph that can be decided before any edge is sorted.

use std::ops::Range;

use rayon::prelude::*;

use crate::oversegment::graph::{BAND_ROWS, PixelGraph};
use crate::oversegment::pixel_edge::{PixelEdge, STEPS, by_direction, columns};
use crate::raster::Raster;
use crate::simd::vectorized;

/// Settles some of the `open` edges. Single pixels tolerate the weight `tolerated`; `shut` pixels join nothing. Afterwards bit d of
/// a pixel is set if its edge in direction d is still open, bit 4 + d if this edge joins its pixels.
///
/// If an edge is lighter than all other edges at both its pixels, it is decided before either of them is joined to anything. So it
/// joins them if a single pixel tolerates its weight (one step of Borůvka's algorithm, for pairs). In a triangle with it, the two
/// other edges then connect one set with one pixel. The lighter of them decides: if it is refused, one side tolerates less than its
/// weight and will never tolerate more, so the heavier one would be refused too. The heavier one changes nothing and is closed.
/// O(pixels); parallel over bands of rows.
pub(crate) fn settle(graph: &PixelGraph, shut: &Raster<bool>, tolerated: f32, open: &mut [u8]) {
    let width = graph.width();
    open.par_chunks_mut(BAND_ROWS * width).enumerate().for_each(|(band, open)| {
        let rows = band * BAND_ROWS..band * BAND_ROWS + open.len() / width;
        vectorized(
            #[inline(always)]
            || settle_rows(graph, shut, tolerated, rows, open),
        );
    });
}

/// Calls `join` with the edges that join their pixels, in scan order. No pixel has two such edges. O(pixels).
pub(crate) fn join_settled(graph: &PixelGraph, settled: &[u8], mut join: impl FnMut(PixelEdge)) {
    let width = graph.width();
    let mut found = vec![0; width];
    for (v, settled) in settled.chunks_exact(width).enumerate() {
        let mut count = 0;
        for (u, &settled) in settled.iter().enumerate() {
            found[count] = u;
            count += usize::from(settled >> STEPS.len() != 0);
        }
        for &u in &found[..count] {
            let d = settled[u].ilog2() as usize - STEPS.len();
            let (du, dv) = STEPS[d];
            let (p, q) = (v * width + u, ((v + dv) * width + u).wrapping_add_signed(du));
            join(PixelEdge { weight: graph.row(v)[d * width + u], p: p as u32, q: q as u32 });
        }
    }
}

/// As [`settle`], for some rows. Each row passes through four steps: find its lightest edges, its joining edges, its idle edges,
/// then update its open edges. Rows in different steps are held at the same time.
#[inline(always)]
fn settle_rows(graph: &PixelGraph, shut: &Raster<bool>, tolerated: f32, rows: Range<usize>, open: &mut [u8]) {
    let (width, height) = shut.size();
    let first = rows.start.saturating_sub(1);
    let [mut above, mut own, mut below, mut last] = [(); 4].map(|()| Row::new(width));
    // In row v the lightest edges become known, in row v - 1 the joining ones, in row v - 2 the idle ones.
    for v in first..rows.end + 2 {
        if v < height {
            let shut = &shut.as_slice()[v * width..][..width];
            last.find_lightest((v > 0).then(|| graph.row(v - 1)), graph.row(v), shut, tolerated);
        }
        if v > first && v <= height {
            below.find_joined(graph.row(v - 1), (v < height).then_some(&last.lightest));
        }
        if v > first + 1 {
            own.find_idle(graph.row(v - 2), (v <= height).then(|| (graph.row(v - 1), &below.joined[..])));
        }
        if v >= rows.start + 2 {
            let open = open[(v - 2 - rows.start) * width..][..width].iter_mut().zip(&own.joined);
            let idle = own.idle[1..].iter().zip(&own.idle).zip(&above.idle[1..]);
            for ((open, joined), ((own, left), above)) in open.zip(idle) {
                let idle = own | left >> OF_B | above >> OF_C;
                *open = (*open & !(idle | joined) as u8) | (joined << STEPS.len()) as u8;
            }
        }
        [above, own, below, last] = [own, below, last, above];
    }
}

/// A row of pixels. Two adjacent pixels of the row are the upper pixels a and b of a block of two by two; c and d lie below.
struct Row {
    /// The weight of each pixel's lightest edge; `NaN` when another edge is as light, or when the edge joins nothing.
    lightest: Vec<f32>,
    /// The weight of the second lightest edge.
    second: Vec<f32>,
    /// Bit d: the edge in direction d joins its pixels.
    joined: Vec<u32>,
    /// The idle edges, which change nothing. Entry u is for the block whose pixel a is in column u - 1: bit d for a, bit
    /// `OF_B` + d for b, bit `OF_C` + d for c. The first and the last entry belong to no block.
    idle: Vec<u32>,
}

/// In a word that holds the edges of three pixels, the first bit of the second pixel, b.
const OF_B: u32 = 8;
/// In a word that holds the edges of three pixels, the first bit of the third pixel, c.
const OF_C: u32 = 16;

impl Row {
    fn new(width: usize) -> Self {
        Self {
            lightest: vec![0.0; width],
            second: vec![0.0; width],
            joined: vec![0; width],
            idle: vec![0; width + 1],
        }
    }

    #[inline(always)]
    fn find_lightest(&mut self, above: Option<&[f32]>, own: &[f32], shut: &[bool], tolerated: f32) {
        let width = shut.len();
        self.lightest.fill(f32::INFINITY);
        self.second.fill(f32::INFINITY);
        let mut look = |pixels: Range<usize>, weights: &[f32]| {
            let least = self.lightest[pixels.clone()].iter_mut().zip(&mut self.second[pixels]);
            for ((lightest, second), &weight) in least.zip(weights) {
                let heavier = if weight < *lightest { *lightest } else { weight };
                *lightest = if weight < *lightest { weight } else { *lightest };
                *second = if heavier < *second { heavier } else { *second };
            }
        };
        for ((du, _), weights) in STEPS.into_iter().zip(by_direction(own)) {
            let (from, _) = columns(du, width);
            look(from.clone(), &weights[from]);
        }
        let [right, ..] = by_direction(own);
        look(1..width, right);
        for ((du, _), weights) in STEPS.into_iter().zip(above.map(by_direction).into_iter().flatten()).skip(1)
        {
            let (from, to) = columns(du, width);
            look(to, &weights[from]);
        }
        for ((lightest, second), shut) in self.lightest.iter_mut().zip(&self.second).zip(shut) {
            let joins = (*lightest < *second) & (*lightest <= tolerated) & !shut;
            *lightest = if joins { *lightest } else { f32::NAN };
        }
    }

    #[inline(always)]
    fn find_joined(&mut self, own: &[f32], below: Option<&Vec<f32>>) {
        self.joined.fill(0);
        for (d, ((du, dv), weights)) in STEPS.into_iter().zip(by_direction(own)).enumerate() {
            let Some(others) = (if dv == 0 { Some(&self.lightest) } else { below }) else { continue };
            let (from, to) = columns(du, self.joined.len());
            let ends = self.lightest[from.clone()].iter().zip(&others[to]);
            for ((joined, weight), (p, q)) in
                self.joined[from.clone()].iter_mut().zip(&weights[from]).zip(ends)
            {
                *joined |= u32::from((weight == p) & (weight == q)) << d;
            }
        }
    }

    #[inline(always)]
    fn find_idle(&mut self, own: &[f32], below: Option<(&[f32], &[u32])>) {
        self.idle.fill(0);
        let Some((below, joined_below)) = below else { return };
        let ([right, down, down_right, down_left], [bottom, ..]) = (by_direction(own), by_direction(below));
        let blocks = right.len() - 1;
        let (ab, ac, ad) = (&right[..blocks], &down[..blocks], &down_right[..blocks]);
        let (bd, bc, cd) = (&down[1..][..blocks], &down_left[1..][..blocks], &bottom[..blocks]);
        let (of_a, of_b, of_c) =
            (&self.joined[..blocks], &self.joined[1..][..blocks], &joined_below[..blocks]);
        let idle = &mut self.idle[1..][..blocks];
        for i in 0..blocks {
            let (ab, ac, ad, bd, bc, cd) = (ab[i], ac[i], ad[i], bd[i], bc[i], cd[i]);
            let joined = of_a[i] | of_b[i] << OF_B | of_c[i] << OF_C;
            // The edges of each triangle in the order of their numbers.
            idle[i] = heaviest([(ab, AB), (ac, AC), (bc, BC)], joined)
                | heaviest([(ab, AB), (ad, AD), (bd, BD)], joined)
                | heaviest([(ac, AC), (ad, AD), (cd, CD)], joined)
                | heaviest([(bd, BD), (bc, BC), (cd, CD)], joined);
        }
    }
}

/// The bit of the edge from a to b, and so on for the other edges of a block.
const AB: u32 = 1;
const AC: u32 = 1 << 1;
const AD: u32 = 1 << 2;
const BD: u32 = 1 << (OF_B + 1);
const BC: u32 = 1 << (OF_B + 3);
const CD: u32 = 1 << OF_C;

/// The bit of the heaviest edge of a triangle, the last one on ties, if one of its edges joins.
#[inline(always)]
fn heaviest([(first, a), (middle, b), (last, c)]: [(f32, u32); 3], joined: u32) -> u32 {
    let is_last = (last >= first) & (last >= middle);
    let bit = if is_last {
        c
    } else if middle >= first {
        b
    } else {
        a
    };
    if joined & (a | b | c) != 0 { bit } else { 0 }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use proptest::prelude::*;

    use super::*;
    use crate::oversegment::graph::testing::{naive_edges, of_weights};

    proptest! {
        #[test]
        fn each_edge_is_settled_as_by_looking_at_all_others(
            (width, pixels) in prop_oneof![(1_usize..20, 1_usize..9), (1_usize..4, 60_usize..140)].prop_flat_map(|(w, h)| {
                // Many equal weights, and some that are lighter than all around them.
                let weight = prop_oneof![0.0_f32..9.0, (0_u8..4).prop_map(f32::from), Just(f32::INFINITY)];
                (Just(w), prop::collection::vec((prop::array::uniform4(weight), 0_u8..9), w * h))
            }),
            tolerated in 0.0_f32..9.0,
        ) {
            let graph = of_weights(width, &pixels.iter().map(|p| p.0).collect::<Vec<_>>());
            let shut = Raster::from_vec(width, pixels.len() / width, pixels.iter().map(|p| p.1 == 0).collect()).unwrap();
            let part: Vec<u32> = (0..pixels.len() as u32).collect();
            let mut settled = graph.between(&part);
            settle(&graph, &shut, tolerated, &mut settled);
            let mut joined = Vec::new();
            join_settled(&graph, &settled, |edge| joined.push(edge));

            // In the order of the algorithm.
            let edges = naive_edges(&graph);
            let has = |e: &PixelEdge, pixel: u32| e.p == pixel || e.q == pixel;
            let lightest_of_all = |edge: &PixelEdge| {
                let rivals = edges.iter().filter(|e| *e != edge && (has(e, edge.p) || has(e, edge.q)));
                rivals.fold(f32::INFINITY, |least, e| least.min(e.weight)) > edge.weight
            };
            let joins = |e: &PixelEdge| {
                lightest_of_all(e) && e.weight <= tolerated && !shut[e.p as usize] && !shut[e.q as usize]
            };
            let expected: Vec<PixelEdge> = edges.iter().copied().filter(joins).collect();
            let in_turn = |mut edges: Vec<PixelEdge>| {
                edges.sort_by(|a, b| (a.weight, a.p, a.q).partial_cmp(&(b.weight, b.p, b.q)).unwrap());
                edges
            };
            prop_assert_eq!(in_turn(joined), in_turn(expected.clone()));

            let turns: HashMap<(u32, u32), usize> = edges.iter().enumerate().map(|(i, e)| ((e.p, e.q), i)).collect();
            let find = |a: u32, b: u32| turns.get(&(a.min(b), a.max(b))).copied();
            let is_idle = |i: usize| {
                let PixelEdge { p, q, .. } = edges[i];
                let near = p.saturating_sub(width as u32 + 1)..=q + width as u32 + 1;
                near.into_iter().any(|t| match (find(p, t), find(q, t)) {
                    (Some(a), Some(b)) => a < i && b < i && [a, b].iter().any(|&x| expected.contains(&edges[x])),
                    _ => false,
                })
            };
            for (i, edge) in edges.iter().enumerate() {
                let open = !is_idle(i) && !expected.contains(edge);
                let step = edge.q - edge.p;
                let d = if edge.q as usize % width == edge.p as usize % width + 1 && step == 1 { 0 } else {
                    1 + (0..3).find(|&k| [width, width + 1, width.wrapping_sub(1)][k] == step as usize).unwrap()
                };
                prop_assert_eq!(settled[edge.p as usize] >> d & 1 == 1, open, "{:?}", edge);
            }
        }
    }
}
