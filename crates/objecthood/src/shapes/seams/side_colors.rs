//! The colours on the two sides of a trace.

use glam::Vec3;

use crate::color::histogram::ColorHistogram;
use crate::color::{LIGHT_OFFSET, mean, unlike_in_light, weighted};
use crate::shapes::seams::body::{Body, BodyPixel};
use crate::shapes::seams::trace::Trace;

/// About this many pixels of a body give its colours.
const COLORS: usize = 4096;
/// A face with fewer sampled pixels on one side says nothing about the light on it.
const LEAST_LIT: usize = 20;
/// Two faces whose lightness (L\* + 16) differs by less than this share are lit alike.
const LIT_UNLIKE: f32 = 0.1;

/// Sampled colours (L\*a\*b\*) below a trace and above it, without the pixels that may show both.
type FaceSides = [Vec<[f32; 3]>; 2];

/// How well the colours of the two sides of a trace can be distinguished.
pub(super) struct ToldApart {
    /// How often a colour is taken for one of the other side, as shares of both sides added up, with the best
    /// threshold on the line from the mean of one side to the mean of the other: 0 if never, 1 if the sides
    /// are alike.
    pub(super) confused: f64,
    /// The difference of the means (Lab, lightness weighted).
    pub(super) difference: f64,
}

/// The colours of each face of a body on the two sides of a trace.
pub(super) struct SideColors {
    faces: Vec<FaceSides>,
    /// Every so-many-th pixel is sampled.
    step: usize,
}

impl SideColors {
    /// O(pixels of the body).
    pub(super) fn of(body: &Body, trace: &Trace) -> Self {
        let step = body.size_px().div_ceil(COLORS);
        let of_face = |pixels: &[BodyPixel]| {
            let mut sides = FaceSides::default();
            for pixel in pixels.iter().step_by(step) {
                let height_m = trace.height_m(pixel.point);
                if height_m.abs() > trace.blur_m {
                    sides[usize::from(height_m > 0.0)].push(pixel.color);
                }
            }
            sides
        };
        Self { faces: body.faces.iter().map(|face| of_face(&face.pixels)).collect(), step }
    }

    fn side(&self, side: usize) -> impl Iterator<Item = [f32; 3]> {
        self.faces.iter().flat_map(move |face| face[side].iter().copied())
    }

    /// The faces that show enough of both sides to compare the light on them.
    fn lit_faces(&self) -> impl Iterator<Item = &FaceSides> {
        self.faces.iter().filter(|face| face.iter().all(|side| side.len() >= LEAST_LIT))
    }

    /// The overlap of the colours of both sides on one face of the body; `None` if it has fewer pixels of one.
    pub(super) fn overlap_of_face(&self, face: usize, least_px: usize) -> Option<f64> {
        let sides = &self.faces[face];
        let has_both = sides.iter().all(|side| side.len() * self.step >= least_px);
        let histogram = |side: usize| ColorHistogram::of(sides[side].iter().copied());
        has_both.then(|| histogram(0).overlap(&histogram(1)))
    }

    /// The overlap of the colours of both sides.
    pub(super) fn overlap(&self) -> f64 {
        let [below, above] = [0, 1].map(|side| ColorHistogram::of(self.side(side)));
        below.overlap(&above)
    }

    /// The difference of the darker side from the other in less light (ΔE of chroma).
    pub(super) fn unlike_shadow(&self) -> f64 {
        let [below, above] = [0, 1].map(|side| mean(self.side(side).map(Vec3::from)));
        unlike_in_light(below, above)
    }

    /// How even the sides are, and how far apart their colours. Light differs from face to face, so each face
    /// that shows both sides counts as if lit like the largest; other faces do not count. `None` if no face
    /// shows both sides. O(pixels · log pixels).
    pub(super) fn tell_apart(&self) -> Option<ToldApart> {
        let light = |face: &FaceSides| face.iter().map(|side| lightness(side)).sum::<f32>();
        let shown = |face: &&FaceSides| face.iter().map(Vec::len).min();
        let largest = light(self.lit_faces().max_by_key(shown)?);
        let mut sides = [Vec::new(), Vec::new()];
        for face in self.lit_faces() {
            let gain = largest / light(face);
            let in_that_light = |[l, a, b]: &[f32; 3]| weighted([l + LIGHT_OFFSET, *a, *b]) * gain;
            sides.iter_mut().zip(face).for_each(|(all, side)| all.extend(side.iter().map(in_that_light)));
        }
        let [below, above] = [0, 1].map(|side| mean(sides[side].iter().copied()));
        let way = above - below;
        Some(ToldApart { confused: least_error(&sides, way), difference: way.length().into() })
    }

    /// The change of the darker side from face to face, over that of the lighter side (as logarithms), or the
    /// inverse if that is smaller. It is near 1 for paint, which reflects one share of any light, and near 0
    /// for a shadow, which is lit by the room alone. 0 if no two faces are lit differently.
    pub(super) fn follows_light(&self) -> f64 {
        let mut logs: Vec<[f32; 2]> =
            self.lit_faces().map(|face| [0, 1].map(|side| libm::logf(lightness(&face[side])))).collect();
        let total = |side: usize| logs.iter().map(|face| face[side]).sum::<f32>();
        if total(0) > total(1) {
            logs.iter_mut().for_each(|face| face.swap(0, 1));
        }
        let by_light = |a: &&[f32; 2], b: &&[f32; 2]| a[1].total_cmp(&b[1]);
        let (Some(dim), Some(bright)) = (logs.iter().min_by(by_light), logs.iter().max_by(by_light)) else {
            return 0.0;
        };
        let [dark, lit] = [0, 1].map(|side| bright[side] - dim[side]);
        if lit < LIT_UNLIKE || dark <= 0.0 { 0.0 } else { f64::from((dark / lit).min(lit / dark)) }
    }
}

/// The mean of L\* + 16.
fn lightness(colors: &[[f32; 3]]) -> f32 {
    mean(colors.iter().map(|color| Vec3::from(*color))).x + LIGHT_OFFSET
}

/// The least error of a threshold along a direction from the first side to the second: the sum of the shares
/// of both sides beyond it.
fn least_error(sides: &[Vec<Vec3>; 2], along: Vec3) -> f64 {
    let of_side = |side: usize| sides[side].iter().map(move |color| (color.dot(along), side));
    let mut places: Vec<(f32, usize)> = of_side(0).chain(of_side(1)).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let shares = [0, 1].map(|side| 1.0 / sides[side].len().max(1) as f64);
    let (mut error, mut least) = (1.0, 1.0_f64);
    for alike in places.chunk_by(|a, b| a.0 == b.0) {
        error += alike.iter().map(|(_, side)| [-shares[0], shares[1]][*side]).sum::<f64>();
        least = least.min(error);
    }
    least.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faces with one colour below the trace and one above it.
    fn faces(colors: &[[[f32; 3]; 2]]) -> SideColors {
        SideColors {
            faces: colors.iter().map(|sides| sides.map(|color| vec![color; LEAST_LIT])).collect(),
            step: 1,
        }
    }

    /// A colour in this share of the light, to the third root.
    fn lit([l, a, b]: [f32; 3], light: f32) -> [f32; 3] {
        [(l + LIGHT_OFFSET) * light - LIGHT_OFFSET, a * light, b * light]
    }

    const GREY: [f32; 3] = [40.0, 0.0, 0.0];
    const WHITE: [f32; 3] = [80.0, 0.0, 0.0];

    #[test]
    fn paint_follows_the_light_from_face_to_face_and_a_shadow_does_not() {
        let paint = faces(&[[GREY, WHITE], [lit(GREY, 0.7), lit(WHITE, 0.7)]]);
        assert!((paint.follows_light() - 1.0).abs() < 1e-3);
        let turned = faces(&[[WHITE, GREY], [lit(WHITE, 0.7), lit(GREY, 0.7)]]);
        assert!((turned.follows_light() - 1.0).abs() < 1e-3);
        let shadow = faces(&[[GREY, WHITE], [GREY, lit(WHITE, 0.7)]]);
        assert!(shadow.follows_light().abs() < 1e-3);
        let other_way = faces(&[[GREY, WHITE], [lit(GREY, 0.5), lit(WHITE, 0.7)]]);
        assert!(other_way.follows_light() < 0.6, "it goes farther than the light");
        assert_eq!(faces(&[[GREY, WHITE]]).follows_light(), 0.0, "one face tells nothing");
        assert_eq!(faces(&[[GREY, WHITE], [GREY, WHITE]]).follows_light(), 0.0, "faces that are lit alike");
    }

    #[test]
    fn a_face_with_few_pixels_of_one_side_shows_no_change() {
        let mut sides = faces(&[[GREY, WHITE], [GREY, GREY]]);
        let changes = |sides: &SideColors, face, least_px| {
            sides.overlap_of_face(face, least_px).map(|overlap| overlap < 0.5)
        };
        assert_eq!([0, 1].map(|face| changes(&sides, face, LEAST_LIT)), [Some(true), Some(false)]);
        assert_eq!(changes(&sides, 0, LEAST_LIT + 1), None);
        // Every third pixel was sampled.
        sides.step = 3;
        assert_eq!(changes(&sides, 0, 3 * LEAST_LIT), Some(true));
    }

    #[test]
    fn colors_are_compared_in_the_light_of_one_face() {
        // In shade the white is as dark as the grey in the light.
        let shade = (GREY[0] + LIGHT_OFFSET) / (WHITE[0] + LIGHT_OFFSET);
        let sides = faces(&[[GREY, WHITE], [lit(GREY, shade), lit(WHITE, shade)]]);
        let told = sides.tell_apart().unwrap();
        assert!(told.confused < 1e-9 && told.difference > 10.0);
        assert_eq!(faces(&[[GREY, GREY]]).tell_apart().unwrap().confused, 1.0);
        assert!(SideColors { faces: Vec::new(), step: 1 }.tell_apart().is_none());
        let mut mixed = faces(&[[GREY, WHITE]]);
        mixed.faces[0][0][..LEAST_LIT / 4].fill(WHITE);
        assert!((mixed.tell_apart().unwrap().confused - 0.25).abs() < 1e-9);
    }
}
