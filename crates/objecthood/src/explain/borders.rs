//! Reports on the borders of a facet, and on whether the facets on both sides are one thing.

use crate::clusters::history::Rule;
use crate::explain::Explainer;
use crate::explain::explanation::{BorderReport, Decision, Question, Reason};
use crate::regions::{RegionEdge, SegmentId};
use crate::shapes::border::BorderEvidence;

impl Explainer {
    /// The borders of a facet, the longest first.
    pub(super) fn borders(&self, facet: SegmentId) -> Vec<BorderReport> {
        let own = |edge: &&RegionEdge<BorderEvidence>| edge.a == facet || edge.b == facet;
        let mut edges: Vec<&RegionEdge<BorderEvidence>> =
            self.subject.run.shaped().1.edges().iter().filter(own).collect();
        let length_m = |edge: &RegionEdge<BorderEvidence>| edge.evidence.gaps.length_m;
        edges.sort_by(|a, b| length_m(b).total_cmp(&length_m(a)));
        edges.into_iter().map(|edge| self.border(facet, edge)).collect()
    }

    fn border(&self, facet: SegmentId, edge: &RegionEdge<BorderEvidence>) -> BorderReport {
        let evidence = &edge.evidence;
        let (other, sign) = if edge.a == facet { (edge.b, 1.0) } else { (edge.a, -1.0) };
        let fold_m = evidence.fold_m();
        let turn = evidence.folds.iter().map(|fold| fold.angle_deg * fold.length_m).sum::<f64>();
        let gaps = &evidence.gaps;
        let has_vote = self.subject.run.free(facet).is_some() && self.subject.run.free(other).is_some();
        let vote_m = has_vote.then(|| evidence.vote_m(&self.subject.params.contraction));
        BorderReport {
            facet: other.0,
            structure_plane: self.plane(other),
            mean_angle_deg: (fold_m > 0.0).then(|| turn / fold_m),
            gap_quanta: sign * gaps.quanta_m / gaps.length_m,
            gap_mm: sign * 1e3 * gaps.depth_m2 / gaps.length_m,
            folded_mm: 1e3 * fold_m,
            stepped_mm: 1e3 * evidence.step_m,
            seam_mm: 1e3 * evidence.seam_m,
            vote_mm: vote_m.map(|vote_m| 1e3 * vote_m),
            decision: vote_m.map(|vote_m| self.vote(facet, other, evidence, vote_m)),
        }
    }

    /// Whether two facets that share a border are one thing, and why.
    fn vote(&self, a: SegmentId, b: SegmentId, evidence: &BorderEvidence, vote_m: f64) -> Decision {
        let question = Question::OneThing { facets: [a.0, b.0] };
        let one_shape = self.subject.run.shape(a) == self.subject.run.shape(b);
        if !one_shape && self.subject.run.one_thing(a, b) {
            let event = self.subject.run.uniting(a, b).map(|step| &step.event);
            // A small hole in a surface is filled without an event.
            let (rule, checks) =
                event.map_or((Rule::VesselBottom, Vec::new()), |event| (event.rule, event.checks.clone()));
            return self.decision(question, Reason::Rule(rule), checks);
        }
        let seam = Option::as_ref(&self.subject.run.seams)
            .and_then(|seams| seams.cuts.between(a.index(), b.index()));
        if let Some(seam) = seam.filter(|_| !one_shape) {
            return self.decision(question, Reason::Seam, seam.checks.clone());
        }
        let steps_m = self.subject.params.contraction.occlusion_weight * evidence.step_m;
        let reason = match (one_shape, vote_m > 0.0) {
            (true, true) => Reason::Folds,
            (false, false) if evidence.step_m > 0.0 && steps_m >= -(vote_m + steps_m) => Reason::Steps,
            (false, false) => Reason::Folds,
            _ => Reason::OtherBorders,
        };
        self.decision(question, reason, Vec::new())
    }
}
