//! The decision: which hypotheses become objects.

use crate::check::{Bound, Check};
use crate::objectness::hypotheses::Hypothesis;
use crate::objectness::size::longest_side_m;
use crate::params::{self, Method};

impl Hypothesis {
    /// Whether it is an object. In `paper`: its longest side is within `min_side_m..=max_side_m`, and its P(O) is at least `min_p_o`
    /// (eq. 8). In `context`: its objectness is at least `threshold`.
    ///
    /// *Differs from the paper:* it states neither the limits of size nor the threshold.
    pub fn is_object(&self, method: Method, params: &params::Objectness) -> bool {
        match method {
            Method::Paper => {
                let graspable = params.min_side_m..=params.max_side_m;
                graspable.contains(&longest_side_m(&self.box_m)) && self.parts.support >= params.min_p_o
            }
            Method::Context => !self.check_unlikely(params).holds(),
        }
    }

    /// Checks that its objectness is too small for an object of `context`.
    pub(crate) fn check_unlikely(&self, params: &params::Objectness) -> Check {
        let [measured, limit] = [self.objectness, params.threshold].map(f64::from);
        Check::new("its objectness", "", measured, Bound::Below, limit).set_by("objectness.threshold")
    }

    /// The same as a check that it is likely enough.
    pub(crate) fn check_likely(&self, params: &params::Objectness) -> Check {
        Check { bound: Bound::AtLeast, ..self.check_unlikely(params) }
    }
}

/// Keeps the hypotheses that are objects; with `every_hypothesis`, all hypotheses.
pub(crate) fn decide<'a>(
    hypotheses: &'a [Hypothesis],
    method: Method,
    params: &params::Objectness,
) -> Vec<&'a Hypothesis> {
    let keeps = |hypothesis: &&Hypothesis| params.every_hypothesis || hypothesis.is_object(method, params);
    hypotheses.iter().filter(keeps).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discovery::object::OrientedBox;
    use crate::discovery::parts::ObjectnessParts;
    use crate::regions::SegmentId;

    fn hypothesis(longest_m: f32, p_o: f32, objectness: f32) -> Hypothesis {
        let box_m = OrientedBox {
            center_m: [0.0; 3],
            rotation_xyzw: [0.0, 0.0, 0.0, 1.0],
            extents_m: [0.01, longest_m, 0.01],
        };
        let parts = ObjectnessParts {
            size: 1.0,
            support: p_o,
            footing: 1.0,
            compactness: 1.0,
            separation: 1.0,
            visibility: 1.0,
        };
        let pixels = vec![0];
        Hypothesis {
            region: SegmentId(0),
            pixels,
            box_m,
            objectness,
            parts,
            top_m: None,
            joins: Vec::new(),
            is_flat: false,
            contrast: 0.0,
        }
    }

    #[test]
    fn in_paper_size_and_support_decide_and_limits_are_included() {
        let params = params::Objectness::default();
        let is_object = |longest_m, p_o| hypothesis(longest_m, p_o, 0.0).is_object(Method::Paper, &params);
        let cases =
            [(0.3, 0.9, true), (0.6, 0.9, true), (0.61, 0.9, false), (0.02, 0.9, true), (0.019, 0.9, false)];
        for (longest_m, p_o, expected) in cases.into_iter().chain([(0.3, 0.7, true), (0.3, 0.69, false)]) {
            assert_eq!(is_object(longest_m, p_o), expected, "{longest_m} m, P(O) {p_o}");
        }
    }

    #[test]
    fn in_context_objectness_decides() {
        let params = params::Objectness::default();
        let is_object = |objectness| hypothesis(9.0, 0.0, objectness).is_object(Method::Context, &params);
        assert!(is_object(params.threshold) && !is_object(params.threshold - 0.01));
    }

    #[test]
    fn every_hypothesis_is_kept_when_asked_for() {
        let kept = |every_hypothesis| {
            let params = params::Objectness { every_hypothesis, ..Default::default() };
            let both = [hypothesis(0.1, 1.0, 0.0), hypothesis(0.1, 1.0, 0.9)];
            decide(&both, Method::Context, &params).len()
        };
        assert_eq!((kept(false), kept(true)), (1, 2));
    }
}
