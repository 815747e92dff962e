//! Feet: examines the image below the lowest visible part of each thing.

use glam::Vec3;

use crate::raster::Raster;
use crate::regions::Segments;
use crate::shapes::contact::Nearness;
use crate::support::body::Bodies;

/// The pixels of a region's foot, counted by their surroundings below.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Foot {
    /// Below is another region that touches it or is nearer, the border of the image, or a hole: the region may continue there.
    pub(crate) ended: u32,
    /// Below is something farther: the region ends there, above the ground.
    pub(crate) open: u32,
}

impl Foot {
    /// Share of the foot below which something farther is seen; 0 without a foot.
    pub(crate) fn open_share(&self) -> f64 {
        f64::from(self.open) / f64::from((self.open + self.ended).max(1))
    }
}

/// Examines the image below the feet of all things. The foot of a thing is its pixels level with its lowest visible part. From each
/// of them, the search follows gravity in the image for up to `reach_px`, to the first pixel with a region and depth. A pixel of the
/// thing itself is not counted: the thing continues there. O(pixels of feet · `reach_px`).
pub(crate) fn find_feet(
    regions: &Segments,
    points_m: &Raster<[f32; 3]>,
    bodies: &Bodies<'_>,
    nearness: Nearness,
) -> Vec<Foot> {
    let mut feet = vec![Foot::default(); regions.count()];
    let (width, height) = points_m.size();
    let reach = nearness.reach_px.min(width.max(height)) as i64;
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
        let is_open = b.z > a.z && a.distance(b) >= nearness.distance_m(a.z);
        *(if is_open { &mut feet[region].open } else { &mut feet[region].ended }) += 1;
    }
    feet
}
