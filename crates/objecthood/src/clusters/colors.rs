//! How alike the colours of two parts are, as measured and in the same light (docs/CONTEXT.md 4.4 and
//! 4.7.5).

use glam::Vec3;

use crate::clusters::scene::{Scene, sampled};
use crate::color::histogram::ColorHistogram;
use crate::color::{LIGHT_OFFSET, mean};

/// Least share of the light of another face that a face in the shade of its own body has, to the third root:
/// a third of the light.
const SHADE: f32 = 0.7;

/// Some colours of a part; none without colour.
#[derive(Clone, Debug, Default)]
pub(super) struct Colors {
    /// L\*a\*b\*.
    lab: Vec<[f32; 3]>,
    histogram: ColorHistogram,
}

impl Colors {
    /// The colours of about 200 of these pixels. O(1).
    pub(super) fn of(scene: &Scene<'_>, pixels: &[u32]) -> Self {
        let lab = scene.lab.map(|lab| sampled(pixels).map(|i| lab[i]).collect());
        let lab: Vec<[f32; 3]> = lab.unwrap_or_default();
        Self { histogram: ColorHistogram::of(lab.iter().copied()), lab }
    }

    /// The overlap with the colours of another; 0 without colour. O(bins).
    pub(super) fn overlap(&self, other: &Self) -> f64 {
        self.histogram.overlap(&other.histogram)
    }

    /// As [`Self::overlap`], or the overlap with the darker of the two brought to the light of the other, if
    /// that is larger. Light scales L\* + 16, a\* and b\* alike. O(sampled pixels + bins).
    pub(super) fn overlap_in_light(&self, other: &Self) -> f64 {
        let (darker, lighter) = if other.light() < self.light() { (other, self) } else { (self, other) };
        let gain = (lighter.light() / darker.light()).min(1.0 / SHADE);
        let in_light = |&[l, a, b]: &[f32; 3]| [(l + LIGHT_OFFSET) * gain - LIGHT_OFFSET, a * gain, b * gain];
        let relit = ColorHistogram::of(darker.lab.iter().map(in_light));
        relit.overlap(&lighter.histogram).max(self.overlap(other))
    }

    /// The light that comes from it: the mean of L\* + 16.
    fn light(&self) -> f32 {
        mean(self.lab.iter().map(|color| Vec3::from(*color))).x + LIGHT_OFFSET
    }
}
