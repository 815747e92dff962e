//! Reports on the borders of a facet, and on whether the facets on both sides are one thing.

use crate::clusters::history::Rule;
use crate::explain::Explainer;
use crate::explain::explanation::{BorderReport, Decision, Question, Reason};
use crate::params;
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
            color_change_mm: 1e3 * evidence.color_change_m,
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
        let reason = match (one_shape, vote_m > 0.0) {
            (true, true) => Reason::Folds,
            (false, false) => against(evidence, &self.subject.params.contraction),
            _ => Reason::OtherBorders,
        };
        self.decision(question, reason, Vec::new())
    }
}

/// What took most of the vote of a border that votes for two things. Colour did if the others together vote for one.
fn against(evidence: &BorderEvidence, params: &params::Contraction) -> Reason {
    let folds_m: f64 = evidence.folds.iter().map(|fold| fold.vote_m(params)).sum();
    let steps_m = params.occlusion_weight * evidence.step_m;
    if folds_m > steps_m {
        Reason::Colors
    } else if evidence.step_m > 0.0 && steps_m >= -folds_m {
        Reason::Steps
    } else {
        Reason::Folds
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::border::Fold;

    #[test]
    fn what_took_most_of_the_vote_is_the_reason() {
        let reason = |angle_deg: f64, step_m: f64| {
            let folds = vec![Fold { angle_deg, length_m: 0.1 }];
            let evidence = BorderEvidence { folds, step_m, color_change_m: 0.1, ..Default::default() };
            let params = params::Contraction::default();
            assert!(evidence.vote_m(&params) < 0.0);
            against(&evidence, &params)
        };
        assert_eq!(reason(-8.0, 0.0), Reason::Colors);
        assert_eq!(reason(-8.0, 1.0), Reason::Steps, "the folds vote for one thing");
        assert_eq!(reason(-40.0, 0.1), Reason::Folds);
    }
}
