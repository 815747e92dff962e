//! Contrast: how clearly the colours on both sides of an outline differ (docs/CONTEXT.md 6.4).

use std::collections::BTreeMap;

use glam::Vec3;

use crate::color::image::LabImage;
use crate::color::{CLEAR_CONTRAST, CONTRAST, difference, unlike_in_light};
use crate::regions::SegmentId;

/// Sides of a region in a block of this many columns and rows (px of the image) are compared together,
/// because single pixels of a carpet differ as much as things do.
pub(super) const BLOCK_PX: usize = 16;

/// A side of an outline whose colours are compared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Across {
    /// The pixel at the side, and the distance to the pixel beyond it in scan order, which distinguishes the
    /// four sides of a pixel.
    pub side: usize,
    pub step: isize,
    /// A pixel inside the region and one beyond, both a little away from the outline.
    pub colors_at: [usize; 2],
}

/// How clearly the colours on the two sides of an outline differ, for each side of a pixel, in [0, 1]; 0 if
/// there is nothing to compare. `width`: columns of the image.
///
/// All sides of a region in a block that face the same way share one value. The mean colour inside is
/// compared with the mean colour beyond, as measured and with the darker one in less light; the smaller
/// difference counts, so a shadow does not. The value is 0 below [`CONTRAST`], else the difference over
/// [`CLEAR_CONTRAST`], at most 1. O(sides · log(blocks)).
///
/// Source: ours, because depth shows no step at small things far away, nor where it is smeared.
pub(super) fn measure_clearness(
    lab: &LabImage,
    width: usize,
    sides: &[(SegmentId, Option<Across>)],
) -> Vec<f64> {
    let block = |region: SegmentId, at: Across| {
        (region, at.step, at.side / width / BLOCK_PX, at.side % width / BLOCK_PX)
    };
    let mut sums: BTreeMap<_, ([Vec3; 2], f32)> = BTreeMap::new();
    for &(region, across) in sides {
        let Some(across) = across else { continue };
        let (colors, count) = sums.entry(block(region, across)).or_default();
        for (color, pixel) in colors.iter_mut().zip(across.colors_at) {
            *color += Vec3::from(lab[pixel]);
        }
        *count += 1.0;
    }
    let of_block: BTreeMap<_, f64> = sums
        .into_iter()
        .map(|(block, (colors, count))| (block, clearness(colors.map(|sum| sum / count))))
        .collect();
    let of_side =
        |region, across: Option<Across>| across.map_or(0.0, |across| of_block[&block(region, across)]);
    sides.iter().map(|&(region, across)| of_side(region, across)).collect()
}

/// How clearly two mean colours (L\*a\*b\*) differ, in [0, 1]: 0 for paint and its shadow.
fn clearness([inside, beyond]: [Vec3; 2]) -> f64 {
    let unlike = f64::from(difference(inside.into(), beyond.into())).min(unlike_in_light(inside, beyond));
    if unlike < f64::from(CONTRAST) { 0.0 } else { (unlike / CLEAR_CONTRAST).min(1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: [f32; 3] = [50.0, 40.0, 20.0];
    /// RED in an eighth of the light: L\* + 16, a\* and b\* are halved.
    const SHADE: [f32; 3] = [17.0, 20.0, 10.0];
    const BLUE: [f32; 3] = [50.0, 10.0, -20.0];

    /// The clearness of sides between a pixel of the left half of an image and one of the right half, of these colours.
    fn measured(left: impl Fn(usize) -> [f32; 3], right: impl Fn(usize) -> [f32; 3]) -> Vec<f64> {
        let lab = LabImage::drawn((64, 2), |u, _| if u < 32 { left(u / 2) } else { right(u / 2) });
        let sides: Vec<_> = (0..16)
            .step_by(2)
            .map(|u| (SegmentId(0), Some(Across { side: u, step: 1, colors_at: [u, u + 32] })))
            .collect();
        measure_clearness(&lab, 64, &sides)
    }

    #[test]
    fn paint_differs_and_a_shadow_does_not() {
        let of = |other| measured(|_| RED, |_| other)[0];
        assert_eq!(of(RED), 0.0);
        assert_eq!(of(SHADE), 0.0);
        assert_eq!(of(BLUE), 1.0);
        assert_eq!(of([50.0, 20.0, 20.0]), 0.5);
    }

    /// A piece of a carpet was an object, because its threads have many colours.
    #[test]
    fn what_is_as_motley_on_both_sides_does_not_differ() {
        let threads = |k: usize| if k.is_multiple_of(2) { RED } else { BLUE };
        assert_eq!(measured(threads, |k| threads(k + 1)), [0.0; 8]);
    }

    #[test]
    fn regions_and_blocks_are_compared_by_themselves_and_nothing_is_no_contrast() {
        let lab = LabImage::drawn((64, 2), |u, _| if u < 32 { RED } else { BLUE });
        let at = |side, colors_at| Some(Across { side, step: 1, colors_at });
        let [same, other] = [at(0, [0, 2]), at(2, [2, 40])];
        let [next_column, next_row] = [at(20, [20, 22]), at(64 * 16, [0, 2])];
        let sides = [(0, same), (1, other), (1, next_column), (1, next_row), (0, None)];
        let sides = sides.map(|(region, across)| (SegmentId(region), across));
        assert_eq!(measure_clearness(&lab, 64, &sides), [0.0, 1.0, 0.0, 0.0, 0.0]);
    }
}
