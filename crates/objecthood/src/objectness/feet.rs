//! What the feet of things meet: the way down in the image, against what stands there.

use std::collections::BTreeMap;

use glam::Vec3;

use crate::objectness::body::{Body, Plan};
use crate::params;
use crate::raster::Raster;
use crate::regions::Segments;

/// What lies below the lowest visible part of a region, counted in pixels of its edge.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Foot {
    /// Another region that touches it there.
    pub(crate) touching: BTreeMap<usize, u32>,
    /// Something nearer, the border of the image, or a hole without depth: it may go on there.
    pub(crate) hidden: u32,
    /// Something farther: there it ends, above the ground.
    pub(crate) open: u32,
}

impl Foot {
    /// Share of the visible foot that a region touches.
    pub(crate) fn share_on(&self, region: usize) -> f64 {
        let touching = self.touching.get(&region).copied().unwrap_or(0);
        share(touching, self.touching.values().sum::<u32>() + self.open)
    }

    /// Share of the foot that is hidden.
    pub(crate) fn hidden_share(&self) -> f64 {
        share(self.hidden, self.touching.values().sum::<u32>() + self.open + self.hidden)
    }
}

fn share(part: u32, whole: u32) -> f64 {
    f64::from(part) / f64::from(whole.max(1))
}

/// The feet of all regions from number `from` on: what is within `band_m` of the lowest visible part. From each of
/// its pixels one walks along gravity in the image, at most `reach_px`, to the first other region. O(pixels · `reach_px`).
pub(crate) fn feet(
    regions: &Segments,
    points_m: &Raster<[f32; 3]>,
    bodies: &[Body],
    plan: &Plan,
    (from, band_m): (usize, f64),
    params: &params::Contact,
) -> Vec<Foot> {
    let mut feet = vec![Foot::default(); bodies.len()];
    let (width, height) = points_m.size();
    let members = regions.members().filter(|&(i, region)| region >= from && !points_m[i][2].is_nan());
    for (i, region) in
        members.filter(|&(i, region)| plan.height_m(points_m[i]) < bodies[region].foot_m + band_m)
    {
        let Some(step) = plan.step_down(points_m[i]) else { continue };
        let pixel = |t: i32| {
            let [u, v] = [(i % width) as i32 + t * step[0], (i / width) as i32 + t * step[1]];
            let is_inside = (0..width as i32).contains(&u) && (0..height as i32).contains(&v);
            is_inside.then_some(v as usize * width + u as usize)
        };
        let own = |j: usize| regions.at(j).is_some_and(|other| other.index() == region);
        if pixel(1).is_some_and(own) {
            continue;
        }
        let reach = 1..=params.reach_px.min(i32::MAX as usize) as i32;
        let seen = reach
            .map_while(pixel)
            .find_map(|j| Some((j, regions.at(j)?)).filter(|&(j, _)| !points_m[j][2].is_nan()));
        let foot = &mut feet[region];
        match seen {
            // Across a hole, the same again.
            Some((_, other)) if other.index() == region => {}
            Some((j, other)) => {
                let [a, b] = [i, j].map(|k| Vec3::from(points_m[k]));
                if a.distance(b) < params.distance_m {
                    *foot.touching.entry(other.index()).or_default() += 1;
                } else if b.z < a.z {
                    foot.hidden += 1;
                } else {
                    foot.open += 1;
                }
            }
            None => foot.hidden += 1,
        }
    }
    feet
}
