//! Colours for the regions of a stage.

use std::cmp::Reverse;

use image::Rgb;
use objecthood::Raster;

use crate::palette::{PALETTE, Swatch};

/// This many colours of the palette differ enough for the regions of a stage.
const REGION_COLORS: usize = 48;
/// Regions that touch differ by this much (`OKLab`) for every eye, as long as there is such a colour.
const NEIGHBOUR_DIFFERENCE: f32 = 0.14;

/// The greys of tables, walls and floors.
pub(crate) const STRUCTURE: [u8; 4] = [150, 110, 185, 75];

/// The colour of every region of a stage, whose labels are below `count`: grey for the first `structure`, for the others such that
/// regions that touch differ; `None` for those that own no pixel.
pub fn stage_colors(labels: &Raster<i32>, count: usize, structure: usize) -> Vec<Option<Rgb<u8>>> {
    let mut colors = region_colors(labels, count);
    for (color, grey) in colors.iter_mut().take(structure).zip(STRUCTURE.iter().cycle()) {
        *color = Some(Rgb([*grey; 3]));
    }
    colors
}

/// The colour of every region of a label map whose labels are below `count`, such that regions that touch differ;
/// `None` for those that own no pixel.
///
/// Each takes, from a hash of its number on, the least used of the colours that differ enough from those of its
/// neighbours; the largest choose first, so that one with many neighbours is not left without a choice.
fn region_colors(labels: &Raster<i32>, count: usize) -> Vec<Option<Rgb<u8>>> {
    let touching = touching(labels);
    let mut sizes = vec![0_usize; count];
    for region in labels.as_slice().iter().filter_map(|&l| usize::try_from(l).ok()) {
        sizes[region] += 1;
    }
    let mut order: Vec<usize> = (0..count).filter(|&region| sizes[region] > 0).collect();
    order.sort_by_key(|&region| Reverse(sizes[region]));

    let mut uses = [0_usize; REGION_COLORS];
    let mut chosen: Vec<Option<&Swatch>> = vec![None; count];
    for region in order {
        let first = touching.partition_point(|&(a, _)| a < region);
        let pairs = touching[first..].iter().take_while(|&&(a, _)| a == region);
        let neighbours: Vec<&Swatch> = pairs.filter_map(|&(_, b)| chosen[b]).collect();
        let difference =
            |k: usize| neighbours.iter().map(|n| n.difference(&PALETTE[k])).fold(f32::INFINITY, f32::min);
        // The golden ratio spreads consecutive numbers over the palette.
        let hash = (region as u32).wrapping_mul(0x9e37_79b1) >> 16;
        let candidates = (0..REGION_COLORS).map(|k| (hash as usize + k) % REGION_COLORS);
        let best = candidates
            .clone()
            .filter(|&k| difference(k) >= NEIGHBOUR_DIFFERENCE)
            .min_by_key(|&k| uses[k])
            .or_else(|| candidates.max_by(|&k, &l| difference(k).total_cmp(&difference(l))));
        if let Some(k) = best {
            uses[k] += 1;
            chosen[region] = Some(&PALETTE[k]);
        }
    }
    chosen.into_iter().map(|swatch| swatch.map(|s| s.rgb)).collect()
}

/// The pairs of regions that touch side by side, sorted, each in both orders.
fn touching(labels: &Raster<i32>) -> Vec<(usize, usize)> {
    let (pixels, width) = (labels.as_slice(), labels.width());
    let beside = pixels.chunks(width).flat_map(|row| row.iter().zip(&row[1..]));
    let below = pixels.iter().zip(pixels.iter().skip(width));
    let mut pairs: Vec<(usize, usize)> = beside
        .chain(below)
        .filter(|(a, b)| a != b)
        .filter_map(|(&a, &b)| usize::try_from(a).ok().zip(usize::try_from(b).ok()))
        .flat_map(|(a, b)| [(a, b), (b, a)])
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn neighbours_look_different_and_the_same_labels_the_same() {
        // Blocks of 4 x 3 pixels, one label each; the first ones have none.
        let label = |i: i32| if i < 50 { -1 } else { i % 120 / 4 + i / 120 / 3 * 30 };
        let labels = testing::raster(120, 90, |i| label(i as i32));
        let colors = region_colors(&labels, 1000);
        assert_eq!(colors, region_colors(&labels, 1000));
        assert_eq!(colors.iter().flatten().count(), 900);
        assert_eq!(colors[900], None);
        let swatch = |region: usize| PALETTE.iter().find(|s| Some(s.rgb) == colors[region]).unwrap();
        for (a, b) in touching(&labels) {
            assert!(swatch(a).difference(swatch(b)) >= NEIGHBOUR_DIFFERENCE, "{a} {b}");
        }
    }

    #[test]
    fn few_regions_have_a_colour_each_even_where_none_touch() {
        let labels = testing::raster(2 * REGION_COLORS, 1, |i| if i % 2 == 0 { i as i32 / 2 } else { -1 });
        let mut colors: Vec<_> =
            region_colors(&labels, REGION_COLORS).into_iter().map(|c| c.unwrap().0).collect();
        colors.sort_unstable();
        colors.dedup();
        assert_eq!(colors.len(), REGION_COLORS);
    }

    #[test]
    fn a_region_among_more_neighbours_than_colours_differs_from_all() {
        // Region 0 lies below 300 others.
        let labels = testing::raster(300, 3, |i| if i < 300 { i as i32 + 1 } else { 0 });
        let colors = region_colors(&labels, 301);
        assert!(colors[1..].iter().all(|c| c.is_some() && *c != colors[0]));
    }
}
