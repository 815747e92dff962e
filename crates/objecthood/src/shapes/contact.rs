//! Contacts: regions that are close to each other in space (paper, III-C: "close in 3-D Euclidean space").

use glam::Vec3;

use crate::params;
use crate::raster::{Raster, marked, part};
use crate::regions::{RegionGraph, Segments};
use crate::surface::disparity::DisparitySpace;

/// The number of directions of the walks: right, down, down-right and down-left.
const DIRECTIONS: usize = 4;

/// Points in contact may lie this many steps of the sensor apart (quanta): each is off by up to one.
const CONTACT_QUANTA: f64 = 2.0;

/// Counts, for any two regions, the pairs of points in contact.
///
/// From every pixel of a region walks lead right, down, down-right and down-left for at most `reach_px`. A walk crosses pixels of
/// the same region, of no region or without depth, and ends at the first pixel of another region. The two pixels are in contact when
/// their points are nearer than `distance_m`. O(pixels + pairs log pairs).
pub fn find_contacts(
    segments: &Segments,
    points_m: &Raster<[f32; 3]>,
    params: &params::Contact,
) -> RegionGraph<u32> {
    let pairs = find_touching_pairs(segments, points_m, Nearness::at_any_depth(params)).into_iter();
    let regions = pairs.filter_map(|(p, q)| Some((segments.at(p as usize)?, segments.at(q as usize)?)));
    RegionGraph::from_pairs(segments.count(), regions)
}

/// Finds the pairs of pixels that [`find_contacts`] counts. Pairs with the same second pixel and direction follow each other.
///
/// A walk leaves its region where the label changes. So walks start only at changes: all pixels of the region before a change meet
/// the same pixel. O(pixels + changes · `reach_px`).
pub(crate) fn find_touching_pairs(
    segments: &Segments,
    points_m: &Raster<[f32; 3]>,
    nearness: Nearness,
) -> Vec<(u32, u32)> {
    let (width, height) = segments.labels().size();
    let mut pairs = Vec::new();
    for (u, v) in find_changes(segments) {
        let (right, down, left) = (width - 1 - u, height - 1 - v, u);
        let walks: [_; DIRECTIONS] = [
            Walk { step: 1, ahead: right, behind: left },
            Walk { step: width, ahead: down, behind: v },
            Walk { step: width + 1, ahead: down.min(right), behind: v.min(left) },
            Walk { step: width - 1, ahead: down.min(left), behind: v.min(right) },
        ];
        for walk in walks {
            walk.find_pairs(v * width + u, segments.labels().as_slice(), points_m, nearness, &mut pairs);
        }
    }
    pairs
}

/// How near two points in contact are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearness {
    /// In the image (px).
    pub(crate) reach_px: usize,
    /// In space (m), at least ...
    least_m: f32,
    /// ... or this times the square of depth (1/m).
    per_m: f32,
}

impl Nearness {
    /// The same at any depth.
    pub(crate) fn at_any_depth(params: &params::Contact) -> Self {
        Self { reach_px: params.reach_px, least_m: params.distance_m, per_m: 0.0 }
    }

    /// No less than the sensor resolves, and pixels at a focal length of 525 px.
    pub(crate) fn of_sensor(params: &params::Contact, space: &DisparitySpace) -> Self {
        let steps = CONTACT_QUANTA * space.noise().step_scale();
        let (reach_px, per_m) = (space.length_px(params.reach_px), space.step_m(steps, 1.0) as f32);
        Self { reach_px, least_m: params.distance_m, per_m }
    }

    /// The greatest distance (m) of points at a depth (m).
    pub(crate) fn distance_m(&self, z_m: f32) -> f32 {
        self.least_m.max(self.per_m * z_m * z_m)
    }
}

/// A walk in one direction.
struct Walk {
    /// Difference of the indices of successive pixels.
    step: usize,
    /// Number of pixels to the edge of the image, forwards (`ahead`) and backwards (`behind`).
    ahead: usize,
    behind: usize,
}

impl Walk {
    /// Adds pairs of pixels in contact. The second pixel is the first one of another region after pixel `i`. The first pixel is `i`, or
    /// one of the pixels of the same label directly before it.
    fn find_pairs(
        &self,
        i: usize,
        labels: &[i32],
        points_m: &Raster<[f32; 3]>,
        nearness: Nearness,
        pairs: &mut Vec<(u32, u32)>,
    ) {
        let own = labels[i];
        let reach_px = nearness.reach_px;
        if self.ahead == 0 || labels[i + self.step] == own {
            return;
        }
        let is_other = |t: &usize| {
            let label = labels[i + t * self.step];
            label >= 0 && label != own && !points_m[i + t * self.step][2].is_nan()
        };
        let Some(t) = (1..=self.ahead.min(reach_px)).find(is_other) else { return };
        let q = i + t * self.step;
        let met = Vec3::from(points_m[q]);
        let distance_m = nearness.distance_m(met.z);
        for k in 0..=self.behind.min(reach_px - t) {
            let p = i - k * self.step;
            if labels[p] != own {
                break;
            }
            let point = Vec3::from(points_m[p]);
            // The depths alone rule out most pairs. NaN compares false.
            if (point.z - met.z).abs() < distance_m && point.distance(met) < distance_m {
                pairs.push((p as u32, q as u32));
            }
        }
    }
}

/// Finds the pixels of regions that have a neighbour of another label to the right or below, and all region pixels in the first and
/// the last column: (column, row) in scan order. O(pixels).
fn find_changes(segments: &Segments) -> Vec<(usize, usize)> {
    let width = segments.labels().width();
    let mut rows = segments.labels().as_slice().chunks_exact(width).enumerate().peekable();
    let mut changes = Vec::new();
    // The first and the last pixel of a row are always marked.
    let mut marks = vec![1; width];
    let inner = width.saturating_sub(2);
    while let Some((v, own)) = rows.next() {
        let below = rows.peek().map_or(own, |(_, below)| below);
        let (label, right) = (part(own, 1, inner), part(own, 2, inner));
        let below = [0, 1, 2].map(|u| part(below, u, inner));
        let marks_inner = &mut marks[1.min(width)..][..inner];
        // Slices of one length and no branches let vector units compare many pixels at once.
        for k in 0..inner {
            let own = label[k];
            let differs =
                (right[k] != own) | (below[0][k] != own) | (below[1][k] != own) | (below[2][k] != own);
            marks_inner[k] = i32::from((own >= 0) & differs);
        }
        changes.extend(marked(&marks).filter(|&u| own[u] >= 0).map(|u| (u, v)));
    }
    changes
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;
    use crate::testing::kinect;

    /// A thing 3 m away, one step of a Kinect behind what it stands on.
    #[test]
    fn far_away_contacts_are_as_far_apart_as_the_sensor_resolves() {
        let touching = |z_m: f32, apart_m: f32| {
            let points = Raster::from_vec(2, 1, vec![[0.0, 0.0, z_m], [0.0, 0.0, z_m + apart_m]]).unwrap();
            let regions = Segments::from_labels(&Raster::from_vec(2, 1, vec![0, 1]).unwrap());
            let nearness = Nearness::of_sensor(&params::Contact::default(), &kinect());
            find_touching_pairs(&regions, &points, nearness).len()
        };
        assert_eq!([touching(3.0, 0.026), touching(3.0, 0.06)], [1, 0]);
        assert_eq!([touching(1.0, 0.019), touching(1.0, 0.026)], [1, 0]);
    }

    proptest! {
        #[test]
        fn contacts_are_the_brute_force_ones(
            (width, pixels) in (1_usize..9, 1_usize..9)
                .prop_flat_map(|(w, h)| (Just(w), prop::collection::vec((-1_i32..4, 0_u8..8, 0.0_f32..0.06), w * h))),
            reach_px in 1_usize..6,
        ) {
            let height = pixels.len() / width;
            let labels = Raster::from_vec(width, height, pixels.iter().map(|p| p.0).collect()).unwrap();
            let segments = Segments::from_labels(&labels);
            let point = |(i, p): (usize, &(i32, u8, f32))| match p.1 {
                0 => [f32::NAN; 3],
                _ => [(i % width) as f32 * 0.004, (i / width) as f32 * 0.004, 1.0 + p.2],
            };
            let points = Raster::from_vec(width, height, pixels.iter().enumerate().map(point).collect()).unwrap();
            let params = params::Contact { reach_px, distance_m: 0.02 };

            let mut expected = BTreeMap::new();
            for p in 0..labels.len() {
                let at = |step: (isize, isize), t: usize| {
                    let u = (p % width) as isize + step.0 * t as isize;
                    let v = (p / width) as isize + step.1 * t as isize;
                    points.get(usize::try_from(u).ok()?, v as usize).map(|_| v as usize * width + u as usize)
                };
                let region = |i: usize| segments.at(i).filter(|_| !points[i][2].is_nan());
                let Some(a) = region(p) else { continue };
                for step in [(1, 0), (0, 1), (1, 1), (-1, 1)] {
                    for q in (1..=reach_px).map_while(|t| at(step, t)) {
                        let Some(b) = region(q).filter(|&b| b != a) else { continue };
                        if Vec3::from(points[p]).distance(Vec3::from(points[q])) < 0.02 {
                            *expected.entry((a.min(b), a.max(b))).or_insert(0) += 1;
                        }
                        break;
                    }
                }
            }
            let graph = find_contacts(&segments, &points, &params);
            let got: Vec<_> = graph.edges().iter().map(|e| ((e.a, e.b), e.evidence)).collect();
            prop_assert_eq!(got, expected.into_iter().collect::<Vec<_>>());
        }
    }
}
