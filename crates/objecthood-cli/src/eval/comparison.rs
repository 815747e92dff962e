//! The settings of a method that a comparison scores.

use anyhow::Result;
use objecthood::{Method, Params};
use objecthood_eval::settings::ABLATED;
use objecthood_eval::{Setting, ablation, ladder, sensitivity};

use crate::args::ComparisonArgs;
use crate::failure::usage;

/// What is compared with what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Comparison {
    /// The paper's settings of colour, depth and curvature.
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
    /// Of usage, when the method does not read the parameters to vary, or the user has set one of them.
    pub(crate) fn settings(self, params: &Params, set: &[String]) -> Result<Vec<Setting>> {
        let names = ABLATED.join(" and ");
        match (self, params.method) {
            (Self::Ablation, Method::Paper) => {
                let swept = |set: &&String| ABLATED.iter().any(|name| set.trim_start().starts_with(name));
                match set.iter().find(swept) {
                    Some(assignment) => Err(usage(format!(
                        "--ablation goes through the values of {names}: leave out --set {assignment}"
                    ))),
                    None => Ok(ablation(params)),
                }
            }
            (Self::Ablation, Method::Context) => Err(usage(format!(
                "--ablation goes through the values of {names}, which the method context does not read: \
                 say --method paper, or --ladder for the steps of context"
            ))),
            (Self::Ladder, Method::Context) => Ok(ladder(params)),
            (Self::Ladder, Method::Paper) => Err(usage(
                "--ladder switches on the steps of the method context: say --method context, or --ablation for \
                 the comparison of paper",
            )),
            (Self::Sensitivity, _) => Ok(sensitivity(params)?),
        }
    }
}
