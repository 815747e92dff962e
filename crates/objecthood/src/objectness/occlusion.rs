//! Occlusion joins: a surface cut in two by something nearer goes on behind it (METHOD 3.13).
//!
//! 1. [`pieces`]: the large facets of clusters before which something stands.
//! 2. [`along`]: for two of them a frame along the gap, in which pairs are told that are turned hopelessly apart.
//! 3. [`surface`]: one surface through both, and how much worse it fits than one each.
//! 4. [`sight`]: what is seen in the gap, along the pixels of [`line`]s.

mod along;
mod line;
mod pieces;
mod sight;
mod surface;

use glam::DVec3;
use rayon::prelude::*;

use self::along::{Along, ROUNDING_DEG};
use self::pieces::{Piece, pieces};
use self::sight::{HIDDEN_SHARE, SEEN_THROUGH_SHARE, Seen, look};
use self::surface::{Surface, joint};
use crate::linear::length;
use crate::objectness::check::{Bound, Check};
use crate::objectness::clusters::Clusters;
use crate::objectness::history::{Event, Miss, Rule, Source};
use crate::objectness::join::{Continuation, Join, JoinEvidence};
use crate::params;
use crate::regions::SegmentId;
use crate::union_find::UnionFind;

/// Clusters that touch along more pairs (px at 525 px) are neighbours, not parts.
const TOUCH_PX: usize = 6;
/// Beyond so many times a tolerance nothing else is looked at.
const HOPELESS: f64 = 2.0;
/// Cosine to the support plane's normal from which a facet is horizontal: tops of equal height are common, so ...
const HORIZONTAL: f64 = 0.92;
/// ... they have to be nearer, by this factor, ...
const HORIZONTAL_DISTANCE: f64 = 0.8;
/// ... and of more alike colour.
const HORIZONTAL_COLOR: f64 = 0.15;

/// Joins clusters of which one facet each continues the other behind something nearer: same surface, same direction, and the gap
/// shows what is nearer, hardly anything that is farther.
///
/// O(F^2 · (samples + pixels of the lines + all facets)) for F facets that are large and partly hidden; in parallel over pairs.
pub(crate) fn join_behind_occluders(clusters: &mut Clusters<'_>, params: &params::Occlusion) {
    if !params.enabled {
        return;
    }
    let pieces = pieces(clusters);
    let hopeless_deg = HOPELESS * params.angle_deg + ROUNDING_DEG;
    let hopeless_cosine =
        if hopeless_deg < 180.0 { libm::cos(hopeless_deg.to_radians()) } else { f64::NEG_INFINITY };
    let gap = Gap { clusters, params, hopeless_cosine };
    let looks: Vec<Look> = pieces
        .par_iter()
        .enumerate()
        .flat_map_iter(|(k, a)| pieces[k + 1..].iter().filter_map(|b| gap.compare(a, b)))
        .collect();
    let (mut joins, misses): (Vec<Look>, Vec<Look>) = looks.into_iter().partition(Look::is_join);
    let disagreement = |look: &Look| look.continuation.disagreement_quanta;
    joins.sort_by(|x, y| disagreement(x).total_cmp(&disagreement(y)));
    // As the parts are before the first of them is joined.
    let parts: Vec<_> =
        joins.iter().map(|look| look.clusters.map(|cluster| clusters.part(cluster))).collect();

    let rule = Rule::Occlusion;
    let highest = joins.iter().flat_map(|look| look.clusters).map(|id| id.index() + 1).max();
    let mut sets = UnionFind::new(highest.unwrap_or(0));
    for (Look { clusters: pair, checks, continuation, hider }, parts) in joins.into_iter().zip(parts) {
        let [a, b] = pair.map(|cluster| sets.find(cluster.index()));
        if a != b {
            let (into, from) = (SegmentId(a.min(b) as u32), SegmentId(a.max(b) as u32));
            sets.link(into.index(), from.index());
            let evidence = JoinEvidence::Occlusion(continuation);
            let join = Some((Join { parts, evidence, behind: None }, hider));
            clusters.give(Event { rule, from: Source::Cluster(from), into: Some(into), checks, join });
        }
    }
    clusters.note_misses(misses.into_iter().map(|Look { clusters: [into, from], checks, .. }| Miss {
        rule,
        from: Source::Cluster(from),
        into: Some(into),
        checks,
    }));
}

/// What goes through two pieces.
struct Common {
    surface: Surface<4>,
    /// Of the first piece.
    normal: DVec3,
    /// How far it is from both (quanta), and the angle between them.
    disagreement_quanta: f64,
    angle_deg: f64,
}

/// What was found out about two pieces of different clusters.
struct Look {
    clusters: [SegmentId; 2],
    checks: Vec<Check>,
    /// How one continues the other.
    continuation: Continuation,
    /// The facet that hides most of what is between them.
    hider: Option<SegmentId>,
}

impl Look {
    fn is_join(&self) -> bool {
        self.checks.iter().all(Check::holds)
    }
}

struct Gap<'a> {
    clusters: &'a Clusters<'a>,
    params: &'a params::Occlusion,
    /// Of an angle that is hopeless even if it is measured with rounding.
    hopeless_cosine: f64,
}

impl Gap<'_> {
    /// How piece `b` continues piece `a`: `None` when they are of one cluster, touch, are too far apart or hopelessly unlike.
    fn compare(&self, a: &Piece, b: &Piece) -> Option<Look> {
        let scene = self.clusters.scene;
        if a.cluster == b.cluster {
            return None;
        }
        let distance_m = a.middle_m.distance(b.middle_m);
        if distance_m > self.params.max_distance_m {
            return None;
        }
        let touch = self.clusters.borders(a.cluster, b.cluster).touch as usize;
        if touch > scene.space.length_px(TOUCH_PX) {
            return None;
        }
        let origin = f64::from(scene.disparity[a.pixels[0] as usize]);
        let along = Along::between([a.centroid, b.centroid], origin)?;
        let color_overlap = scene.color.map(|_| a.color_overlap(b));
        if color_overlap.is_some_and(|overlap| HOPELESS * overlap < self.params.color_overlap) {
            return None;
        }
        let Common { surface, normal, disagreement_quanta, angle_deg } = self.common(a, b, &along)?;
        let Seen { hidden_share, seen_through_share, hider } = look(
            self.clusters,
            [a, b],
            #[inline(always)]
            move |at| along.disparity(&surface, at),
        )?;
        let continuation = Continuation {
            disagreement_quanta,
            angle_deg,
            distance_m,
            hidden_share,
            seen_through_share,
            color_overlap,
        };
        let is_horizontal =
            scene.support.is_some_and(|support| normal.dot(support.normal).abs() > HORIZONTAL);
        let checks = self.checks(&continuation, is_horizontal);
        Some(Look { clusters: [a.cluster, b.cluster], checks, continuation, hider })
    }

    /// The surface that goes through both pieces; `None` when they are hopelessly unlike.
    fn common(&self, a: &Piece, b: &Piece, along: &Along) -> Option<Common> {
        let space = self.clusters.scene.space;
        // Most are not alike at all, which their spread tells.
        let [rough_a, rough_b] = [a, b].map(|piece| along.normal(&along.plane(&piece.spread), space));
        if rough_a.dot(rough_b) < self.hopeless_cosine {
            return None;
        }
        let [of_a, of_b] = [a, b].map(|piece| along.take(&piece.samples));
        let flat = [&of_a, &of_b].map(|samples| Surface::<3>::fit(samples.iter()));
        let normals = flat.each_ref().map(|surface| along.normal(surface, space));
        let angle_deg = libm::acos(normals[0].dot(normals[1]).clamp(-1.0, 1.0)).to_degrees();
        if angle_deg > HOPELESS * self.params.angle_deg {
            return None;
        }
        let steepness = flat.each_ref().map(|surface| length(along.slope(surface)));
        let noise = space.slope_noise(steepness[0].min(steepness[1]));
        let (surface, disagreement_quanta) = joint(&of_a, &of_b, &flat, noise);
        let is_hopeless = disagreement_quanta > HOPELESS * self.params.disagreement_quanta;
        (!is_hopeless).then_some(Common { surface, normal: normals[0], disagreement_quanta, angle_deg })
    }

    /// What decides whether one piece continues the other.
    fn checks(&self, found: &Continuation, is_horizontal: bool) -> Vec<Check> {
        let &params::Occlusion { max_distance_m, disagreement_quanta, angle_deg, color_overlap, .. } =
            self.params;
        let share = |what, share, bound, limit| Check::new(what, "", share, bound, limit);
        let no_farther = |what, limit_m| {
            Check::new(what, "m", found.distance_m, Bound::AtMost, limit_m).set_by("occlusion.max_distance_m")
        };
        let (disagreement, angle) = (found.disagreement_quanta, found.angle_deg);
        let mut checks = vec![
            no_farther("distance of the parts", max_distance_m),
            Check::new(
                "disagreement of the surfaces",
                "quanta",
                disagreement,
                Bound::Below,
                disagreement_quanta,
            )
            .set_by("occlusion.disagreement_quanta"),
            Check::new("angle between the surfaces", "degrees", angle, Bound::Below, angle_deg)
                .set_by("occlusion.angle_deg"),
            share(
                "share of the gap seen through",
                found.seen_through_share,
                Bound::Below,
                SEEN_THROUGH_SHARE,
            ),
            share("share of the gap that is hidden", found.hidden_share, Bound::Above, HIDDEN_SHARE),
        ];
        checks.extend(found.color_overlap.map(|overlap| {
            share("overlap of their colours", overlap, Bound::Above, color_overlap)
                .set_by("occlusion.color_overlap")
        }));
        if is_horizontal {
            let limit_m = HORIZONTAL_DISTANCE * max_distance_m;
            checks.push(no_farther("distance of the parts, which are level", limit_m));
            checks.extend(found.color_overlap.map(|overlap| {
                let what = "overlap of their colours, as they are level";
                share(what, overlap, Bound::AtLeast, HORIZONTAL_COLOR)
            }));
        }
        checks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objectness::testing::{Table, named, single};

    /// A plank, facets 1 and 2 at these heights (m), below a bar, facet 3, that cuts it: `bar_m` is the bar's height in a row,
    /// if there is any of it.
    struct Cut {
        plank_m: [f64; 2],
        bar_m: fn(usize) -> Option<f64>,
    }

    const CUT: Cut = Cut { plank_m: [0.05, 0.05], bar_m: |_| Some(0.15) };

    impl Cut {
        fn seen(&self) -> Table {
            Table::new((120, 80), |u, v| {
                let is_plank = (20..100).contains(&u) && (30..50).contains(&v);
                let bar_m = (self.bar_m)(v).filter(|_| (50..65).contains(&u) && (10..70).contains(&v));
                Some(match bar_m {
                    Some(height_m) => (3, height_m),
                    None if is_plank && u < 50 => (1, self.plank_m[0]),
                    None if is_plank && u >= 65 => (2, self.plank_m[1]),
                    None => (0, 0.0),
                })
            })
        }
    }

    /// The clusters of the plank's two parts and of the bar, and the joins of the first, each with its hider.
    struct Joined {
        clusters: Vec<Option<u32>>,
        joins: Vec<(Join, Option<SegmentId>)>,
    }

    fn joined(table: &Table, params: &params::Occlusion) -> Joined {
        let scene = table.scene();
        let mut clusters = single(&scene);
        join_behind_occluders(&mut clusters, params);
        Joined { clusters: named(&clusters), joins: clusters.joins(SegmentId(0)).cloned().collect() }
    }

    const PARTED: [Option<u32>; 3] = [Some(0), Some(1), Some(2)];

    #[test]
    fn a_plank_goes_on_below_a_bar() {
        let Joined { clusters, joins } = joined(&CUT.seen(), &params::Occlusion::default());
        assert_eq!(clusters, [Some(0), Some(0), Some(2)]);
        let [(join, hider)] = &joins[..] else { panic!("one join: {joins:?}") };
        assert_eq!(*hider, Some(SegmentId(3)));
        assert_eq!(join.parts.map(|part| part.size_px), [600, 700]);
        let JoinEvidence::Occlusion(continuation) = join.evidence else { panic!("{join:?}") };
        assert!(
            continuation.hidden_share == 1.0 && continuation.seen_through_share == 0.0,
            "{continuation:?}"
        );
        // From the middle of the left part, column 34.5, to that of the right one, 82, at 0.95 m.
        assert!((continuation.distance_m - 47.5 * 0.95 / 525.0).abs() < 1e-3, "{continuation:?}");
        assert!(continuation.angle_deg < 0.1 && continuation.color_overlap.is_none(), "{continuation:?}");
    }

    #[test]
    fn parts_on_two_levels_are_two() {
        let cut = Cut { plank_m: [0.05, 0.08], ..CUT };
        assert_eq!(joined(&cut.seen(), &params::Occlusion::default()).clusters, PARTED);
    }

    #[test]
    fn what_is_seen_through_is_no_occluder() {
        // A hole of a third of the plank's width, through which the table shows.
        let cut = Cut { bar_m: |v| (!(36..43).contains(&v)).then_some(0.15), ..CUT };
        assert_eq!(joined(&cut.seen(), &params::Occlusion::default()).clusters, PARTED);
    }

    #[test]
    fn what_is_level_with_the_parts_hides_nothing() {
        // In 11 of the plank's 20 rows the bar is no higher than the plank.
        let cut = Cut { bar_m: |v| Some(if (34..45).contains(&v) { 0.05 } else { 0.15 }), ..CUT };
        assert_eq!(joined(&cut.seen(), &params::Occlusion::default()).clusters, PARTED);
    }

    #[test]
    fn parts_of_other_colour_are_two() {
        let mut table = CUT.seen();
        let painted = |left: [u8; 3], right: [u8; 3]| {
            let pixels = (0..table.disparity.len()).map(|i| if i % 120 < 57 { left } else { right });
            table.disparity.with_data(pixels.collect())
        };
        let [same, other] = [[200, 30, 30], [30, 30, 200]].map(|right| painted([200, 30, 30], right));
        table.color = Some(same);
        let Joined { clusters, joins } = joined(&table, &params::Occlusion::default());
        assert_eq!(clusters, [Some(0), Some(0), Some(2)]);
        let JoinEvidence::Occlusion(continuation) = joins[0].0.evidence else { panic!("{joins:?}") };
        let overlap = continuation.color_overlap.unwrap();
        assert!(overlap <= 1.0 && overlap > 0.999_999, "no share exceeds 1: {overlap}");
        table.color = Some(other);
        assert_eq!(joined(&table, &params::Occlusion::default()).clusters, PARTED);
    }

    #[test]
    fn parameters_part_what_would_be_joined() {
        let table = CUT.seen();
        let default = params::Occlusion::default;
        for params in [
            params::Occlusion { enabled: false, ..default() },
            params::Occlusion { max_distance_m: 0.09, ..default() },
            params::Occlusion { disagreement_quanta: 0.0, ..default() },
        ] {
            assert_eq!(joined(&table, &params).clusters, PARTED, "{params:?}");
        }
    }
}
