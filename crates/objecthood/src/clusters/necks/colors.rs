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

/// The overlap of the colours of two parts; 0 without colour. O(sampled pixels).
pub(super) fn overlap(clusters: &Clusters<'_>, pair: [SegmentId; 2]) -> f64 {
    overlap_of(&colors(clusters, pair))
}

/// The same, or if it is more, that with the darker part in the light of the other: light that falls scales L\* + 16, a\* and b\* alike. O(sampled
/// pixels).
fn overlap_in_light(clusters: &Clusters<'_>, pair: [SegmentId; 2]) -> f64 {
    let mut colors = colors(clusters, pair);
    let as_seen = overlap_of(&colors);
    let light =
        colors.each_ref().map(|colors| mean(colors.iter().map(|color| Vec3::from(*color))).x + LIGHT_OFFSET);
    let darker = usize::from(light[1] < light[0]);
    let gain = (light[1 - darker] / light[darker]).min(1.0 / SHADE);
    for [l, a, b] in &mut colors[darker] {
        (*l, *a, *b) = ((*l + LIGHT_OFFSET) * gain - LIGHT_OFFSET, *a * gain, *b * gain);
    }
    overlap_of(&colors).max(as_seen)
}

/// Checks that an overlap of colours is larger than `least`.
pub(super) fn check_alike(overlap: f64, least: f64) -> Check {
    Check::new("overlap of their colours", "", overlap, Bound::Above, least).set_by("necks.color_overlap")
}

/// The same in the same light. O(sampled pixels).
pub(super) fn check_alike_in_light(clusters: &Clusters<'_>, pair: [SegmentId; 2], least: f64) -> Check {
    let overlap = overlap_in_light(clusters, pair);
    Check::new("overlap of their colours in the same light", "", overlap, Bound::Above, least)
        .set_by("necks.color_overlap")
}

fn overlap_of([a, b]: &[Vec<[f32; 3]>; 2]) -> f64 {
    ColorHistogram::of(a.iter().copied()).overlap(&ColorHistogram::of(b.iter().copied()))
}

/// Some colours (L\*a\*b\*) of two parts; none without colour.
fn colors(clusters: &Clusters<'_>, pair: [SegmentId; 2]) -> [Vec<[f32; 3]>; 2] {
    let of = |id: SegmentId| {
        let lab = clusters.scene.lab?;
        Some(sampled(&clusters.get(id).pixels).map(|i| lab[i]).collect())
    };
    pair.map(|id| of(id).unwrap_or_default())
}
