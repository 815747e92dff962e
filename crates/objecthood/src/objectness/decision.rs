//! The decision: which hypotheses are objects.

use crate::objectness::hypotheses::Hypothesis;
use crate::objectness::size::longest_side_m;
use crate::params::{self, Method, Params};

impl Hypothesis {
    /// Whether it is an object: in `paper`, when its longest side is within `min_side_m..=max_side_m` and its P(O) at least
    /// `min_p_o` (eq. 8); in `context`, when its objectness is at least `threshold`.
    ///
    /// *Differs from the paper:* it prints neither the limits of size nor the threshold.
    pub fn is_object(&self, method: Method, params: &params::Objectness) -> bool {
        match method {
            Method::Paper => {
                let graspable = params.min_side_m..=params.max_side_m;
                graspable.contains(&longest_side_m(&self.box_m)) && self.parts.support >= params.min_p_o
            }
            Method::Context => self.objectness >= params.threshold,
        }
    }
}

/// The hypotheses that are objects; with `every_hypothesis` all of them.
pub(crate) fn decided(mut hypotheses: Vec<Hypothesis>, params: &Params) -> Vec<Hypothesis> {
    if !params.objectness.every_hypothesis {
        hypotheses.retain(|hypothesis| hypothesis.is_object(params.method, &params.objectness));
    }
    hypotheses
}
