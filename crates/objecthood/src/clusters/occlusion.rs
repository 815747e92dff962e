//! Occlusion: a surface cut in two by something nearer continues behind it (docs/CONTEXT.md 4.6).
//!
//! 1. [`pieces`]: find the large facets of clusters that have something in front of them.
//! 2. [`along`]: for two pieces set up a frame along the gap; drop pairs whose planes differ hopelessly in direction.
//! 3. [`surface`]: fit one surface to both; compare its error with the errors of one surface for each.
//! 4. [`sight`]: examine the gap along the pixels of [`line`]s.

mod along;
mod line;
mod pieces;
mod sight;
mod spread;
mod surface;

use glam::DVec3;
use rayon::prelude::*;

use self::along::{Along, ROUNDING_DEG};
use self::pieces::{Piece, find_pieces};
use self::sight::{HIDDEN_SHARE, HOPELESS, SEEN_THROUGH_SHARE, Seen, look_into_gap};
use self::surface::{Surface, fit_jointly};
use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Proposal, Rule, Source};
use crate::discovery::join::{Continuation, Join, JoinEvidence};
use crate::linear::length;
use crate::params;
use crate::regions::SegmentId;
use crate::union_find::UnionFind;

/// Clusters that touch along more pairs than this (px at 525 px) are neighbours, not parts behind an
/// occluder.
const TOUCH_PX: usize = 6;
/// A facet is level when the cosine between its normal and the support's exceeds this. Tops of equal height are common, so two level
/// facets need more evidence.
const HORIZONTAL: f64 = 0.92;
/// Factor on the largest distance of two level facets.
const HORIZONTAL_DISTANCE: f64 = 0.8;
/// Least colour overlap of two level facets.
const HORIZONTAL_COLOR: f64 = 0.15;

/// Joins two clusters if a facet of one continues a facet of the other behind something nearer. Both facets
/// lie on one surface and have one direction. In the gap most pixels are nearer, and hardly any are farther.
///
/// O(F^2 · (samples + pixels of the lines + all facets)) for F facets that are large and partly hidden; parallel over pairs.
pub(crate) fn join_behind_occluders(clusters: &mut Clusters<'_>, params: &params::Occlusion) {
    if !params.enabled {
        return;
    }
    let (joins, refused) = Comparer::new(clusters, params).compare_all();
    join_all(clusters, joins);
    clusters.history.note_misses(refused.into_iter().map(|pair| pair.propose(pair.clusters).refuse()));
}

/// Joins pairs of clusters, the pairs of least disagreement first. A pair that is one cluster already is skipped.
fn join_all(clusters: &mut Clusters<'_>, mut joins: Vec<Comparison>) {
    let disagreement = |pair: &Comparison| pair.continuation.disagreement_quanta;
    joins.sort_by(|x, y| disagreement(x).total_cmp(&disagreement(y)));
    // The parts are described in their state before the first join.
    let parts: Vec<_> = joins.iter().map(|pair| pair.clusters.map(|id| clusters.part(id))).collect();
    let highest = joins.iter().flat_map(|pair| pair.clusters).map(|id| id.index() + 1).max();
    let mut sets = UnionFind::new(highest.unwrap_or(0));
    for (pair, parts) in joins.into_iter().zip(parts) {
        let [a, b] = pair.clusters.map(|cluster| sets.find(cluster.index()));
        if a != b {
            let [into, from] = [a.min(b), a.max(b)];
            sets.link(into, from);
            let evidence = JoinEvidence::Occlusion(pair.continuation);
            let join = (Join { parts, evidence, behind: None }, pair.hider);
            let proposal = pair.propose([into, from].map(|root| SegmentId(root as u32)));
            clusters.give(proposal.accept(Some(join)));
        }
    }
}

/// The comparison of two pieces of different clusters.
struct Comparison {
    clusters: [SegmentId; 2],
    checks: Vec<Check>,
    /// The measurements that show whether one continues the other.
    continuation: Continuation,
    /// The facet that hides most of the gap.
    hider: Option<SegmentId>,
}

impl Comparison {
    fn is_join(&self) -> bool {
        self.checks.iter().all(Check::holds)
    }

    fn propose(&self, [into, from]: [SegmentId; 2]) -> Proposal {
        let mut proposal = Proposal::new(Rule::Occlusion, Source::Cluster(from), Some(into));
        proposal.extend(self.checks.iter().copied());
        proposal
    }
}

/// The surface through two pieces.
struct Common {
    surface: Surface<4>,
    /// Normal of the first piece.
    normal: DVec3,
    /// Disagreement of the surface with both pieces (quanta), and the angle between the pieces.
    disagreement_quanta: f64,
    angle_deg: f64,
}

/// Compares pieces of the clusters.
struct Comparer<'a> {
    clusters: &'a Clusters<'a>,
    params: &'a params::Occlusion,
    /// Pairs whose normals have a smaller cosine are dropped; the margin allows for rounding.
    hopeless_cosine: f64,
}

impl<'a> Comparer<'a> {
    fn new(clusters: &'a Clusters<'a>, params: &'a params::Occlusion) -> Self {
        let hopeless_deg = HOPELESS * params.angle_deg + ROUNDING_DEG;
        let hopeless_cosine =
            if hopeless_deg < 180.0 { libm::cos(hopeless_deg.to_radians()) } else { f64::NEG_INFINITY };
        Self { clusters, params, hopeless_cosine }
    }

    /// Compares any two pieces. Returns the comparisons of the pairs to join, and of the refused pairs.
    fn compare_all(&self) -> (Vec<Comparison>, Vec<Comparison>) {
        let pieces = find_pieces(self.clusters);
        let pairs: Vec<Comparison> = pieces
            .par_iter()
            .enumerate()
            .flat_map_iter(|(k, a)| pieces[k + 1..].iter().filter_map(|b| self.compare(a, b)))
            .collect();
        pairs.into_iter().partition(Comparison::is_join)
    }

    /// Compares two pieces. `None` when they are of one cluster, touch, are too far apart or differ hopelessly.
    fn compare(&self, a: &Piece, b: &Piece) -> Option<Comparison> {
        let scene = self.clusters.scene;
        let distance_m = self.distance_m(a, b)?;
        let origin = f64::from(scene.disparity[a.pixels[0] as usize]);
        let along = Along::between([a.centroid, b.centroid], origin)?;
        let color_overlap = scene.color.map(|_| a.color_overlap(b));
        if color_overlap.is_some_and(|overlap| HOPELESS * overlap < self.params.color_overlap) {
            return None;
        }
        let Common { surface, normal, disagreement_quanta, angle_deg } = self.fit_common(a, b, &along)?;
        let Seen { hidden_share, seen_through_share, hider } = look_into_gap(
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
            scene.ground().is_some_and(|support| normal.dot(support.normal).abs() > HORIZONTAL);
        let mut checks = self.check(&continuation);
        if is_horizontal {
            checks.extend(self.check_horizontal(&continuation));
        }
        Some(Comparison { clusters: [a.cluster, b.cluster], checks, continuation, hider })
    }

    /// The distance (m) of two pieces. `None` when they are of one cluster, touch or are too far apart.
    fn distance_m(&self, a: &Piece, b: &Piece) -> Option<f64> {
        if a.cluster == b.cluster {
            return None;
        }
        let distance_m = a.middle_m.distance(b.middle_m);
        if distance_m > self.params.max_distance_m {
            return None;
        }
        let touch = self.clusters.borders(a.cluster, b.cluster).touch as usize;
        (touch <= self.clusters.scene.space.length_px(TOUCH_PX)).then_some(distance_m)
    }

    /// Fits one surface to both pieces; `None` when the pieces differ hopelessly.
    fn fit_common(&self, a: &Piece, b: &Piece, along: &Along) -> Option<Common> {
        let space = self.clusters.scene.space;
        // Most pairs differ in direction; a quick fit from their spread shows this.
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
        let (surface, disagreement_quanta) = fit_jointly(&of_a, &of_b, &flat, noise);
        let is_hopeless = disagreement_quanta > HOPELESS * self.disagreement_limit();
        (!is_hopeless).then_some(Common { surface, normal: normals[0], disagreement_quanta, angle_deg })
    }

    /// Disagreement (quanta) up to which two pieces lie on one surface.
    fn disagreement_limit(&self) -> f64 {
        self.clusters.scene.space.noise().step_scale() * self.params.disagreement_quanta
    }

    /// Checks that one piece continues the other.
    fn check(&self, found: &Continuation) -> Vec<Check> {
        let params = self.params;
        let below = |what, unit, measured, limit| Check::new(what, unit, measured, Bound::Below, limit);
        let disagreement = found.disagreement_quanta;
        let mut checks = vec![
            check_no_farther("distance of the parts", found, params.max_distance_m),
            below("disagreement of the surfaces", "quanta", disagreement, self.disagreement_limit())
                .set_by("occlusion.disagreement_quanta"),
            below("angle between the surfaces", "degrees", found.angle_deg, params.angle_deg)
                .set_by("occlusion.angle_deg"),
            below("share of the gap seen through", "", found.seen_through_share, SEEN_THROUGH_SHARE),
            Check::new("share of the gap that is hidden", "", found.hidden_share, Bound::Above, HIDDEN_SHARE),
        ];
        checks.extend(found.color_overlap.map(|overlap| {
            Check::new("overlap of their colours", "", overlap, Bound::Above, params.color_overlap)
                .set_by("occlusion.color_overlap")
        }));
        checks
    }

    /// The additional checks of two level pieces: they are near each other and alike in colour.
    fn check_horizontal(&self, found: &Continuation) -> Vec<Check> {
        let limit_m = HORIZONTAL_DISTANCE * self.params.max_distance_m;
        let mut checks = vec![check_no_farther("distance of the parts, which are level", found, limit_m)];
        checks.extend(found.color_overlap.map(|overlap| {
            let what = "overlap of their colours, as they are level";
            Check::new(what, "", overlap, Bound::AtLeast, HORIZONTAL_COLOR)
        }));
        checks
    }
}

fn check_no_farther(what: &'static str, found: &Continuation, limit_m: f64) -> Check {
    Check::new(what, "m", found.distance_m, Bound::AtMost, limit_m).set_by("occlusion.max_distance_m")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, named, single};

    /// A plank, facets 1 and 2 at these heights (m), cut by a bar above it, facet 3. `bar_m`: the height of the bar in a row; `None` = no
    /// bar in this row.
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

    /// The clusters of the plank's two parts and of the bar, and the joins of the first part, each with its hider.
    struct Joined {
        clusters: Vec<Option<u32>>,
        joins: Vec<(Join, Option<SegmentId>)>,
    }

    fn joined(table: &Table, params: &params::Occlusion) -> Joined {
        let scene = table.scene();
        let mut clusters = single(&scene);
        join_behind_occluders(&mut clusters, params);
        Joined { clusters: named(&clusters), joins: clusters.finish().clusters[0].joins.clone() }
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
        // From the middle of the left part, column 34.5, to the middle of the right part, column 82, at 0.95 m.
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
