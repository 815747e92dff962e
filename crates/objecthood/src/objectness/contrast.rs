//! Contrast: where the colours on both sides of an outline differ (docs/CONTEXT.md 6.4).

use std::collections::BTreeMap;

use glam::Vec3;

use crate::color::image::LabImage;
use crate::color::{CLEAR_CONTRAST, CONTRAST, difference, unlike_in_light};
use crate::regions::SegmentId;

/// Sides of a region in a block of so many columns are compared together, because pixels of a carpet differ as much as things do.
const BLOCK_PX: usize = 16;

/// Two pixels on both sides of an outline, a little away from it: in the region, and beyond.
pub(super) type Across = [usize; 2];

/// How clearly the colours of some sides of outlines differ, in [0, 1] each: those of a few rows, with their regions. 0 where there is nothing to
/// compare.
///
/// The mean colours of all sides of a region in a block are compared. What is darker is compared with the other in less light, so a shadow is none. They
/// are unlike from the contrast of a seam on, and clearly from its clear contrast on (3.4). O(sides · log(blocks)).
pub(super) fn measure_contrast(
    lab: &LabImage,
    columns: usize,
    sides: &[(SegmentId, Option<Across>)],
) -> Vec<f64> {
    let block = |region: SegmentId, [inside, _]: Across| (region, inside % columns / BLOCK_PX);
    let mut sums: BTreeMap<(SegmentId, usize), ([Vec3; 2], f32)> = BTreeMap::new();
    for &(region, across) in sides {
        let Some(across) = across else { continue };
        let (colors, count) = sums.entry(block(region, across)).or_default();
        for (color, pixel) in colors.iter_mut().zip(across) {
            *color += Vec3::from(lab[pixel]);
        }
        *count += 1.0;
    }
    let clearness: BTreeMap<(SegmentId, usize), f64> = sums
        .into_iter()
        .map(|(block, (colors, count))| (block, clearness(colors.map(|sum| sum / count))))
        .collect();
    sides
        .iter()
        .map(|&(region, across)| across.map_or(0.0, |across| clearness[&block(region, across)]))
        .collect()
}

/// How clearly two colours (L\*a\*b\*) differ, in [0, 1].
fn clearness([inside, beyond]: [Vec3; 2]) -> f64 {
    let unlike = f64::from(difference(inside.into(), beyond.into())).min(unlike_in_light(inside, beyond));
    if unlike < f64::from(CONTRAST) { 0.0 } else { (unlike / CLEAR_CONTRAST).min(1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: [f32; 3] = [50.0, 40.0, 20.0];
    /// The colour of RED in half of the light, to the third root.
    const SHADE: [f32; 3] = [17.0, 20.0, 10.0];
    const BLUE: [f32; 3] = [50.0, 10.0, -20.0];

    /// The clearness of sides between a pixel of the left half of an image and one of the right half, of these colours.
    fn measured(left: impl Fn(usize) -> [f32; 3], right: impl Fn(usize) -> [f32; 3]) -> Vec<f64> {
        let lab = LabImage::drawn((64, 2), |u, _| if u < 32 { left(u / 2) } else { right(u / 2) });
        let sides: Vec<_> = (0..16).step_by(2).map(|u| (SegmentId(0), Some([u, u + 32]))).collect();
        measure_contrast(&lab, 64, &sides)
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
        let [same, other] = [Some([0, 2]), Some([2, 40])];
        let sides = [
            (SegmentId(0), same),
            (SegmentId(1), other),
            (SegmentId(1), Some([20, 22])),
            (SegmentId(0), None),
        ];
        assert_eq!(measure_contrast(&lab, 64, &sides), [0.0, 1.0, 0.0, 0.0]);
    }
}
