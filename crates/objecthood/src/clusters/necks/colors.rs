//! How alike the colours of two parts are (docs/CONTEXT.md 4.7).

use glam::Vec3;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::scene::sampled;
use crate::color::histogram::ColorHistogram;
use crate::color::{LIGHT_OFFSET, mean};
use crate::regions::SegmentId;

/// A face in the shade of its own body has this share of the light of another, to the third root, at least: a third of the light.
const SHADE: f32 = 0.7;

/// Some colours of a part; none without colour.
#[derive(Debug)]
pub(super) struct Colors {
    /// L\*a\*b\*.
    lab: Vec<[f32; 3]>,
    histogram: ColorHistogram,
}

impl Colors {
    /// O(sampled pixels).
    pub(super) fn of(clusters: &Clusters<'_>, id: SegmentId) -> Self {
        let pixels = &clusters.get(id).pixels;
        let lab = clusters.scene.lab.map(|lab| sampled(pixels).map(|i| lab[i]).collect());
        let lab: Vec<[f32; 3]> = lab.unwrap_or_default();
        Self { histogram: ColorHistogram::of(lab.iter().copied()), lab }
    }

    /// The light that comes from it: the mean of L\* + 16.
    fn light(&self) -> f32 {
        mean(self.lab.iter().map(|color| Vec3::from(*color))).x + LIGHT_OFFSET
    }
}

/// The overlap of the colours of two parts; 0 without colour. O(bins).
pub(super) fn overlap([a, b]: [&Colors; 2]) -> f64 {
    a.histogram.overlap(&b.histogram)
}

/// The same, or if it is more, that with the darker part in the light of the other: light that falls scales L\* + 16, a\* and b\* alike. O(sampled
/// pixels).
fn overlap_in_light(pair: [&Colors; 2]) -> f64 {
    let light = pair.map(Colors::light);
    let darker = usize::from(light[1] < light[0]);
    let gain = (light[1 - darker] / light[darker]).min(1.0 / SHADE);
    let in_light = |&[l, a, b]: &[f32; 3]| [(l + LIGHT_OFFSET) * gain - LIGHT_OFFSET, a * gain, b * gain];
    let relit = ColorHistogram::of(pair[darker].lab.iter().map(in_light));
    relit.overlap(&pair[1 - darker].histogram).max(overlap(pair))
}

/// Checks that an overlap of colours is larger than `least`.
pub(super) fn check_alike(overlap: f64, least: f64) -> Check {
    Check::new("overlap of their colours", "", overlap, Bound::Above, least).set_by("necks.color_overlap")
}

/// The same in the same light. O(sampled pixels).
pub(super) fn check_alike_in_light(pair: [&Colors; 2], least: f64) -> Check {
    let overlap = overlap_in_light(pair);
    Check::new("overlap of their colours in the same light", "", overlap, Bound::Above, least)
        .set_by("necks.color_overlap")
}
