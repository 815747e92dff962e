//! Meetings: the contacts between two regions, described against gravity.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use glam::DVec2;

use crate::raster::Raster;
use crate::regions::Segments;
use crate::support::body::Bodies;
use crate::support::plan::Plan;

/// A carrier reaches at least this far (m) behind the visible line of contact, under the hidden rest of the foot.
pub(crate) const UNDER_M: f64 = 0.03;

/// The contacts of an upper region with a lower one that may carry it, in pairs of points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Meeting {
    /// Pairs in which the foot of the upper is level with a top of the lower.
    pub(crate) on: u32,
    /// The part of `on` behind which the lower goes on below the upper.
    pub(crate) under: u32,
    /// Pairs in which the foot of the upper touches the lower, on a top or not.
    pub(crate) foot: u32,
    /// Pairs in which the upper touches the lower above its foot.
    pub(crate) side: u32,
    /// Sum of the vectors from the middle of the upper to the contacts of `side`, in the plan view (m).
    pub(crate) side_way_m: DVec2,
}

/// Finds the meetings of all touching regions, by (lower, upper). Each pair of regions occurs in both orders, but a plane is never the
/// upper one.
///
/// `touching`: pairs of pixels in contact; fastest if pairs with the same second pixel follow each other. O(pairs of pixels + n log n)
/// for n changes between pairs of regions in this list.
pub(crate) fn find_meetings(
    touching: &[(u32, u32)],
    regions: &Segments,
    points_m: &Raster<[f32; 3]>,
    bodies: &Bodies<'_>,
) -> BTreeMap<(usize, usize), Meeting> {
    let labels = regions.labels().as_slice();
    let spot = |i: u32| Spot::of(points_m[i as usize], &bodies.plan);
    let mut meetings: BTreeMap<(usize, usize), Meeting> = BTreeMap::new();
    let pair = |&(first, second): &(u32, u32)| (labels[first as usize], labels[second as usize]);
    for touching in touching.chunk_by(|x, y| pair(x) == pair(y)) {
        let [a, b] = <[_; 2]>::from(pair(&touching[0])).map(|label| label as usize);
        let [a_stands, b_stands] = [a, b].map(|region| region >= bodies.planes.len());
        let (mut a_upon_b, mut b_upon_a) = (Meeting::default(), Meeting::default());
        for touching in touching.chunk_by(|x, y| x.1 == y.1) {
            let mut second = spot(touching[0].1);
            for &(first, _) in touching {
                let mut first = spot(first);
                if a_stands {
                    a_upon_b.add((b, &mut second), (a, &first), bodies);
                }
                if b_stands {
                    b_upon_a.add((a, &mut first), (b, &second), bodies);
                }
            }
        }
        for (pair, meeting, stands) in [((b, a), a_upon_b, a_stands), ((a, b), b_upon_a, b_stands)] {
            if stands {
                *meetings.entry(pair).or_default() += meeting;
            }
        }
    }
    meetings
}

/// A point in contact.
struct Spot {
    height_m: f64,
    place_m: DVec2,
    /// Whether its region ends upwards there, once computed; valid for one other region.
    is_end: Option<bool>,
}

impl Spot {
    fn of(point_m: [f32; 3], plan: &Plan) -> Self {
        Self { height_m: plan.height_m(point_m), place_m: plan.place_m(point_m), is_end: None }
    }
}

impl AddAssign for Meeting {
    fn add_assign(&mut self, other: Self) {
        self.on += other.on;
        self.under += other.under;
        self.foot += other.foot;
        self.side += other.side;
        self.side_way_m += other.side_way_m;
    }
}

impl Meeting {
    /// Adds a pair of points in contact, one of the lower and one of the upper region.
    fn add(
        &mut self,
        (of_lower, lower): (usize, &mut Spot),
        (of_upper, upper): (usize, &Spot),
        bodies: &Bodies<'_>,
    ) {
        let body = &bodies.all[of_upper];
        if upper.height_m > body.foot_m + body.level_m {
            self.side += 1;
            self.side_way_m += lower.place_m - body.middle_m;
            return;
        }
        self.foot += 1;
        let is_level = (upper.height_m - lower.height_m).abs() <= body.level_m;
        let mut is_end = || {
            let ends = || bodies.ends_at(of_lower, lower.place_m, lower.height_m + body.level_m);
            *lower.is_end.get_or_insert_with(ends)
        };
        if is_level && is_end() {
            self.on += 1;
            let behind_m = upper.place_m + UNDER_M * upper.place_m.normalize_or_zero();
            self.under += u32::from(bodies.holds(of_lower, behind_m));
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;
    use crate::discovery::up::{Up, UpSource};
    use crate::params;
    use crate::planes::StructurePlane;
    use crate::shapes::contact::{Nearness, find_touching_pairs};
    use crate::support::scene::SupportScene;
    use crate::testing::{kinect, raster};

    proptest! {
        /// The reference: every pair of points by itself.
        #[test]
        fn meetings_are_those_of_single_pairs(
            pixels in (2_usize..12, 2_usize..12)
                .prop_flat_map(|size| raster(size, (-1_i32..4, prop::array::uniform3(0.0_f32..0.03)))),
            direction in prop::array::uniform3(-1.0_f32..1.0),
            planes in 0_usize..3,
        ) {
            let up = Vec3::from(direction).try_normalize().unwrap_or(Vec3::NEG_Y).to_array();
            let up = Up { direction: up, source: UpSource::Camera };
            let points = pixels.map(|&(_, [x, y, z])| [x, y, 1.0 + z]);
            let regions = Segments::from_numbered(pixels.map(|pixel| pixel.0), 4);
            let normals = points.map(|_| [0.0, 0.0, -1.0]);
            let plane = StructurePlane { normal: up.direction, offset_m: 1.0, inlier_share: 1.0 };
            let planes = &[plane; 2][..planes];
            let scene = SupportScene {
                regions: &regions, points_m: &points, normals: &normals, planes, up: &up, space: &kinect(),
            };
            let bodies = Bodies::new(&scene);
            let touching = find_touching_pairs(&regions, &points, Nearness::at_any_depth(&params::Contact::default()));
            let mut expected: BTreeMap<(usize, usize), Meeting> = BTreeMap::new();
            for (upper, lower) in touching.iter().flat_map(|&(i, j)| [(i, j), (j, i)]) {
                let [of_upper, of_lower] = [upper, lower].map(|i| regions.at(i as usize).unwrap().index());
                // A plane does not stand on anything.
                if of_upper < planes.len() {
                    continue;
                }
                let [upper, mut lower] =
                    [upper, lower].map(|i| Spot::of(points[i as usize], &bodies.plan));
                let meeting = expected.entry((of_lower, of_upper)).or_default();
                meeting.add((of_lower, &mut lower), (of_upper, &upper), &bodies);
            }
            let got = find_meetings(&touching, &regions, &points, &bodies);
            prop_assert_eq!(got.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
            for (got, expected) in got.values().zip(expected.values()) {
                let counts = |meeting: &Meeting| [meeting.on, meeting.under, meeting.foot, meeting.side];
                prop_assert_eq!(counts(got), counts(expected));
                prop_assert!(got.side_way_m.distance(expected.side_way_m) < 1e-9);
            }
        }
    }
}
