//! Feet: what is seen below the lowest visible part of a thing.

use glam::Vec3;

use crate::params;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::support::body::Bodies;

/// What is seen below the foot of a region, in pixels of the foot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Foot {
    /// Another region that touches it or is nearer, the border of the image, or a hole: the region may go on there.
    pub(crate) ended: u32,
    /// Something farther: the region ends there, above the ground.
    pub(crate) open: u32,
}

impl Foot {
    /// Share of the foot below which something farther is seen; 0 without a foot.
    pub(crate) fn open_share(&self) -> f64 {
        f64::from(self.open) / f64::from((self.open + self.ended).max(1))
    }
}

/// Looks below the feet of all things. The foot of a thing is its pixels level with its lowest visible part. From each the first
/// pixel with region and depth is looked for, along gravity in the image and within `reach_px`. If it is the thing's own, the foot
/// goes on and does not count. O(pixels of feet · `reach_px`).
pub(crate) fn find_feet(
    regions: &Segments,
    points_m: &Raster<[f32; 3]>,
    bodies: &Bodies<'_>,
    params: &params::Contact,
) -> Vec<Foot> {
    let mut feet = vec![Foot::default(); regions.count()];
    let (width, height) = points_m.size();
    let reach = params.reach_px.min(width.max(height)) as i64;
    let feet_of = |thing: usize| bodies.all[thing].foot.iter().map(move |&i| (i as usize, thing));
    for (i, region) in bodies.things().flat_map(feet_of) {
        let Some(step) = bodies.plan.step_down(points_m[i]) else { continue };
        let pixel = |t: i64| {
            let [u, v] = [(i % width) as i64 + t * step[0], (i / width) as i64 + t * step[1]];
            let is_inside = (0..width as i64).contains(&u) && (0..height as i64).contains(&v);
            is_inside.then(|| v as usize * width + u as usize)
        };
        let mut below = (1..=reach).map_while(pixel).filter_map(|j| Some((j, regions.at(j)?.index())));
        let Some((j, other)) = below.find(|&(j, _)| !points_m[j][2].is_nan()) else {
            feet[region].ended += 1;
            continue;
        };
        if other == region {
            continue;
        }
        let [a, b] = [i, j].map(|k| Vec3::from(points_m[k]));
        let is_open = b.z > a.z && a.distance(b) >= params.distance_m;
        *(if is_open { &mut feet[region].open } else { &mut feet[region].ended }) += 1;
    }
    feet
}
