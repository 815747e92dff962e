//! Rule 1, flat bottoms: what the inside of a plate surrounds is its bottom (docs/CONTEXT.md 4.4.1).

use super::insides::touching_pairs;
use super::limits::Limits;
use super::walls::FLAT;
use crate::check::{Bound, Check};
use crate::clusters::bottoms::{check_contact, check_majority};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Miss, Proposal, Rule, Source};
use crate::discovery::join::JoinEvidence;
use crate::planes::Plane;
use crate::quantile::element_at;
use crate::regions::SegmentId;

/// This quantile of the heights of the inside over the plane of the bottom is not below 0.
const RISE_SHARE: f64 = 0.2;

/// Joins the first flat bottom that it finds to the inside around it, and returns whether it found any. A plate that
/// lies on something else, or is held, has a bottom that is no part of the support. It is not concave, and the valley
/// between it and the inside is as clear as that between two things.
///
/// O(pairs + neighbours and pixels of what insides touch).
pub(super) fn join_flat_bottom(
    clusters: &mut Clusters<'_>,
    limits: Limits<'_>,
    misses: &mut Vec<Miss>,
) -> bool {
    let ordered = touching_pairs(clusters).into_iter().flat_map(|[a, b]| [[a, b], [b, a]]);
    for [inside, bottom] in ordered {
        let bends = [inside, bottom].map(|id| clusters.convexity(id));
        let concave = limits.check_concave("how far the inside bends outwards", bends[0], 1.0);
        // Most pairs are no inside with something in it. They are not recorded.
        if !concave.holds() {
            continue;
        }
        let Enclosure { contact_share, of_all } = Enclosure::of(clusters, [inside, bottom]);
        let majority = check_majority(of_all);
        if !majority.holds() {
            continue;
        }
        let check_flat =
            |bound, limit| Check::new("how far the bottom bends outwards", "", bends[1], bound, limit);
        let mut join = Proposal::new(Rule::VesselBottom, Source::Cluster(bottom), Some(inside));
        join.extend([concave, majority]);
        // What bends inwards is a piece of an inside, or another vessel: `insides` decides.
        let is_bottom = join.check(check_flat(Bound::AtMost, FLAT))
            && join.check(check_flat(Bound::AtLeast, -FLAT))
            && join.check(check_contact(contact_share, limits.params))
            && join.check(limits.check_color(clusters, bottom, &[inside]))
            && join.check(check_rise(clusters, [inside, bottom]));
        if is_bottom {
            clusters.join(join, JoinEvidence::VesselBottom { contact_share });
            return true;
        }
        misses.push(join.refuse());
    }
    false
}

/// How much of the border of a bottom touches an inside, that is without a step.
struct Enclosure {
    /// As a share of the border without what stands on the bottom.
    contact_share: f64,
    /// As a share of the whole border.
    of_all: f64,
}

impl Enclosure {
    /// Pixels at the edge of the image count: what is cut there may go on. O(pixels + neighbours).
    fn of(clusters: &Clusters<'_>, [inside, bottom]: [SegmentId; 2]) -> Self {
        let touch = f64::from(clusters.borders(bottom, inside).touch);
        let (width, height) = clusters.scene.disparity.size();
        let is_at_edge = |&&i: &&u32| {
            let [u, v] = [i as usize % width, i as usize / width];
            u == 0 || u + 1 == width || v == 0 || v + 1 == height
        };
        let cut = clusters.get(bottom).pixels.iter().filter(is_at_edge).count() as u32;
        let (mut all, mut open) = (cut, cut);
        for (&other, borders) in &clusters.get(bottom).neighbours {
            // Another cluster that touches the bottom, or hides a part of it, stands on it.
            let stands_on_it = other.is_some_and(|other| other != inside);
            all += borders.all();
            open += borders.all() - if stands_on_it { borders.touch + borders.behind } else { 0 };
        }
        Self { contact_share: touch / f64::from(open.max(1)), of_all: touch / f64::from(all.max(1)) }
    }
}

/// Checks that an inside rises from the plane of the bottom. Beside something that lies loose in a vessel, the inside
/// is lower. What fills a vessel from side to side cannot be told from a bottom by depth.
fn check_rise(clusters: &Clusters<'_>, [inside, bottom]: [SegmentId; 2]) -> Check {
    let points = |id: SegmentId| clusters.scene.sampled_points(&clusters.get(id).pixels);
    // The normal of a plane points to the camera.
    let rise_m = Plane::fit(points(bottom)).map_or(f64::NEG_INFINITY, |plane| {
        let mut heights_m: Vec<f64> =
            points(inside).map(|point| plane.normal.dot(point) + plane.offset_m).collect();
        element_at(&mut heights_m, RISE_SHARE)
    });
    let what = "how far the inside rises from the plane of the bottom";
    Check::new(what, "m", rise_m, Bound::AtLeast, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, named, single};
    use crate::clusters::vessels::repeat;
    use crate::color::image::LabImage;
    use crate::params;

    const RED: [f32; 3] = [50.0, 50.0, 30.0];
    const BLUE: [f32; 3] = [40.0, 10.0, -40.0];

    /// A plate as seen from above.
    #[derive(Clone, Copy)]
    struct Plate {
        /// Height of the middle of the bottom (m), by how much its edge is higher, and its colour.
        bottom_m: f64,
        hollow_m: f64,
        color: [f32; 3],
        /// The inside rises by this slope from 2 cm above the table, up to this column.
        slope: f64,
        end: usize,
        /// The column of the middle.
        middle: f64,
    }

    const PLATE: Plate =
        Plate { bottom_m: 0.020, hollow_m: 0.0, color: RED, slope: 0.6, end: 60, middle: 30.0 };

    /// The clusters of the inside and of the bottom.
    fn joined(plate: Plate) -> Vec<Option<u32>> {
        let Plate { bottom_m, hollow_m, color, slope, end, middle } = plate;
        let at = |u: usize, v: usize| match (u as f64 - middle).hypot(v as f64 - 30.0) {
            r if r < 16.0 => (2, bottom_m + hollow_m * (r / 16.0).powi(2)),
            r if r < 28.0 && u < end => (1, 0.020 + slope * 0.0019 * (r - 16.0)),
            _ => (0, 0.0),
        };
        let mut table = Table::new((60, 60), |u, v| Some(at(u, v)));
        table.lab = Some(LabImage::drawn((60, 60), |u, v| [BLUE, RED, color][at(u, v).0 as usize]));
        let scene = table.scene();
        let mut clusters = single(&scene);
        let params = params::Vessels::default();
        let limits = Limits { support: scene.ground().expect("a table"), params: &params };
        repeat(&mut clusters, 2, |clusters, misses| join_flat_bottom(clusters, limits, misses));
        named(&clusters)
    }

    #[test]
    fn a_flat_bottom_belongs_to_the_inside_around_it() {
        let (one, two) = (vec![Some(0), Some(0)], vec![Some(0), Some(1)]);
        assert_eq!(joined(PLATE), one);
        let loose = Plate { bottom_m: 0.026, ..PLATE };
        assert_eq!(joined(loose), two, "the inside beside it is lower");
        assert_eq!(joined(Plate { slope: -0.6, ..PLATE }), two, "the top of something");
        assert_eq!(joined(Plate { color: BLUE, ..PLATE }), two, "other colours");
        assert_eq!(joined(Plate { end: 34, ..PLATE }), two, "it is not enclosed");
        assert_eq!(joined(Plate { middle: 4.0, ..PLATE }), two, "the edge of the image cuts it");
        assert_eq!(joined(Plate { hollow_m: -0.015, ..PLATE }), two, "a ball in a plate");
        let bowl = Plate { bottom_m: 0.012, hollow_m: 0.015, ..PLATE };
        assert_eq!(joined(bowl), two, "a bowl in a bowl, or a piece of the inside");
    }
}
