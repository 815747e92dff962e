//! Rule 1, flat bottoms: what the inside of a plate surrounds is its bottom (docs/CONTEXT.md 4.4.1).

use super::insides::touching_pairs;
use super::limits::{CONCAVITY, Limits};
use super::walls::FLAT;
use crate::check::{Bound, Check};
use crate::clusters::bottoms::{check_contact, check_majority};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Miss, Proposal, Rule, Source};
use crate::discovery::join::JoinEvidence;
use crate::planes::Plane;
use crate::quantile::element_at;
use crate::regions::SegmentId;

/// The inside rises from the bottom all around it: this quantile of its heights over the plane of the bottom is not
/// below that plane.
const RISE_SHARE: f64 = 0.2;

/// Joins the first flat bottom that it finds to the inside around it, and returns whether it found any. A plate that
/// lies on something else, or is held, has a bottom that is no part of the support. It is not concave, and the valley
/// between it and the inside is as clear as that between two things.
pub(super) fn join_flat_bottom(
    clusters: &mut Clusters<'_>,
    limits: Limits<'_>,
    misses: &mut Vec<Miss>,
) -> bool {
    let ordered = touching_pairs(clusters).into_iter().flat_map(|[a, b]| [[a, b], [b, a]]);
    for [inside, bottom] in ordered {
        let Enclosure { contact_share, of_all } = Enclosure::of(clusters, [inside, bottom]);
        let bends = [inside, bottom].map(|id| clusters.convexity(id));
        let most = -limits.params.concavity;
        let concave = Check::new("how far the inside bends outwards", "", bends[0], Bound::AtMost, most);
        let majority = check_majority(of_all);
        // Most pairs are no inside with something in it; they are not recorded.
        if !majority.holds() || !concave.holds() {
            continue;
        }
        let mut join = Proposal::new(Rule::VesselBottom, Source::Cluster(bottom), Some(inside));
        join.extend([concave.set_by(CONCAVITY), majority]);
        let is_bottom =
            join.check(Check::new("how far the bottom bends outwards", "", bends[1], Bound::AtMost, FLAT))
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

/// How far an inside encloses a bottom, without a step.
struct Enclosure {
    /// The share of the bottom's border, but for what stands on it.
    contact_share: f64,
    /// The share of the whole border.
    of_all: f64,
}

impl Enclosure {
    /// O(neighbours).
    fn of(clusters: &Clusters<'_>, [inside, bottom]: [SegmentId; 2]) -> Self {
        let touch = f64::from(clusters.borders(bottom, inside).touch);
        let (mut all, mut open) = (0, 0);
        for (&other, borders) in &clusters.get(bottom).neighbours {
            // Another cluster that touches the bottom, or hides a part of it, stands on it.
            let stands_on_it = other.is_some_and(|other| other != inside);
            all += borders.all();
            open += borders.all() - if stands_on_it { borders.touch + borders.behind } else { 0 };
        }
        Self { contact_share: touch / f64::from(open.max(1)), of_all: touch / f64::from(all.max(1)) }
    }
}

/// Checks that an inside rises from the plane of the bottom. What lies in a vessel is higher than the inside around it.
fn check_rise(clusters: &Clusters<'_>, [inside, bottom]: [SegmentId; 2]) -> Check {
    let points = |id: SegmentId| clusters.scene.sampled_points(&clusters.get(id).pixels);
    // The normal of a plane points to the camera.
    let rise_m = Plane::fit(points(bottom)).map_or(f64::NAN, |plane| {
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
    use crate::params;

    /// A plate as seen from above: a bottom at a height, within an inside that rises from 2 cm above the table by a
    /// slope, all around or up to a column. Returns the clusters of both.
    fn joined(bottom_m: f64, slope: f64, end: usize) -> Vec<Option<u32>> {
        let table = Table::new((60, 60), |u, v| {
            let from_middle = (u as f64 - 30.0).hypot(v as f64 - 30.0);
            match from_middle {
                r if r < 16.0 => Some((2, bottom_m)),
                r if r < 28.0 && u < end => Some((1, 0.020 + slope * 0.0019 * (r - 16.0))),
                _ => Some((0, 0.0)),
            }
        });
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
        assert_eq!(joined(0.020, 0.6, 60), one);
        assert_eq!(
            joined(0.026, 0.6, 60),
            two,
            "it lies in the plate, and is higher than the inside beside it"
        );
        assert_eq!(joined(0.020, -0.6, 60), two, "the top of something");
        assert_eq!(joined(0.020, 0.6, 34), two, "it is not enclosed");
    }
}
