//! The settings of a method that a comparison scores.

use anyhow::Result;
use objecthood::{Method, Params};
use objecthood_eval::settings::ablated;
use objecthood_eval::{Setting, ablation, ladder, sensitivity};

use crate::args::ComparisonArgs;
use crate::failure::usage;

/// What is compared with what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Comparison {
    /// Depth with and without colour; with `paper` also with and without curvature.
    Ablation,
    /// The steps of `context`, one after the other.
    Ladder,
    /// Every parameter, changed alone.
    Sensitivity,
}

impl Comparison {
    /// The comparison that the command line asks for, if any.
    pub(crate) fn asked(args: ComparisonArgs) -> Option<Self> {
        let ComparisonArgs { ablation, ladder, sensitivity } = args;
        let all = [(ablation, Self::Ablation), (ladder, Self::Ladder), (sensitivity, Self::Sensitivity)];
        all.into_iter().find_map(|(is_asked, comparison)| is_asked.then_some(comparison))
    }

    /// The settings to score; `set` holds the values of `--set`.
    ///
    /// # Errors
    /// Of usage, when the comparison is of the other method, or the user has set a parameter that it varies.
    pub(crate) fn settings(self, params: &Params, set: &[String]) -> Result<Vec<Setting>> {
        match (self, params.method) {
            (Self::Ablation, method) => {
                let names = ablated(method);
                let swept = |set: &&String| names.iter().any(|name| set.trim_start().starts_with(name));
                match set.iter().find(swept) {
                    Some(assignment) => Err(usage(format!(
                        "--ablation goes through the values of {}: leave out --set {assignment}",
                        names.join(" and ")
                    ))),
                    None => Ok(ablation(params)),
                }
            }
            (Self::Ladder, Method::Context) => Ok(ladder(params)),
            (Self::Ladder, Method::Paper) => Err(usage(
                "--ladder switches on the steps of the method context: say --method context, or --ablation for \
                 the comparison of paper",
            )),
            (Self::Sensitivity, _) => Ok(sensitivity(params)?),
        }
    }
}
