//! How things meet: where on either the contact lies, against gravity.

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;

use crate::objectness::body::Bodies;
use crate::raster::Raster;
use crate::regions::{SegmentId, Segments};

/// What carries goes on below what it carries: so far (m) behind the line of contact, which is all that is seen of a foot.
pub(crate) const UNDER_M: f64 = 0.03;

/// How one region touches another that may carry it, in pairs of points in contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Meeting {
    /// Its foot is on a top of the other, level with it.
    pub(crate) on: u32,
    /// Of these, those behind which the other goes on below it.
    pub(crate) under: u32,
    /// Its foot touches the other, on a top or not.
    pub(crate) foot: u32,
    /// It touches the other above its foot.
    pub(crate) side: u32,
    /// Sum of the ways from its middle to the other there, in the plan view (m).
    pub(crate) side_way_m: DVec2,
}

/// How every two regions that touch meet, by (lower, upper), either way; planes are never the upper one.
///
/// `touching`: the pixels in contact. The foot is what is level with the lowest visible part. O(pairs of pixels · log of pairs);
/// parallel over pairs of regions.
pub(crate) fn meetings(
    touching: &[(usize, usize)],
    regions: &Segments,
    points_m: &Raster<[f32; 3]>,
    bodies: &Bodies<'_>,
) -> BTreeMap<(usize, usize), Meeting> {
    let either_way = touching.iter().flat_map(|&(i, j)| [(i, j), (j, i)]);
    let by_region = |(upper, lower)| Some(((regions.at(lower)?, regions.at(upper)?), (upper, lower)));
    let mut pairs: Vec<_> = either_way.filter_map(by_region).collect();
    pairs.retain(|((_, upper), _)| upper.index() >= bodies.planes.len());
    // In their order within a pair of regions.
    pairs.sort_by_key(|&(regions, _)| regions);
    let meetings: Vec<_> = pairs.chunk_by(|a, b| a.0 == b.0).collect();
    let meeting = |pairs: &[(_, (usize, usize))]| {
        let (lower, upper): (SegmentId, SegmentId) = pairs[0].0;
        let [lower, upper] = [lower, upper].map(SegmentId::index);
        let mut meeting = Meeting::default();
        pairs.iter().for_each(|&(_, pixels)| meeting.add(lower, upper, pixels, points_m, bodies));
        ((lower, upper), meeting)
    };
    meetings.into_par_iter().map(meeting).collect()
}

impl Meeting {
    /// Adds two points in contact: the pixels of the upper and of the lower region.
    fn add(
        &mut self,
        of_lower: usize,
        of_upper: usize,
        (upper, lower): (usize, usize),
        points_m: &Raster<[f32; 3]>,
        bodies: &Bodies<'_>,
    ) {
        let plan = &bodies.plan;
        let [at_m, below_m] = [upper, lower].map(|k| points_m[k]);
        let (height_m, body) = (plan.height_m(at_m), &bodies.all[of_upper]);
        if height_m > body.foot_m + body.level_m {
            self.side += 1;
            self.side_way_m += plan.place_m(below_m) - body.middle_m;
            return;
        }
        self.foot += 1;
        let is_level = (height_m - plan.height_m(below_m)).abs() <= body.level_m;
        if is_level && bodies.ends_at(of_lower, below_m, body.level_m) {
            self.on += 1;
            let place_m = plan.place_m(at_m);
            let behind_m = place_m + UNDER_M * place_m.normalize_or_zero();
            self.under += u32::from(bodies.holds(of_lower, behind_m));
        }
    }
}
