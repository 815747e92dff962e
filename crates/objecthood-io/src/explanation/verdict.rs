//! The verdict: what a pixel is, and why, in one sentence.

use objecthood::Params;
use objecthood::explain::{Explanation, Outcome, Reason};

use super::words;

/// One plain sentence: what the pixel belongs to, and what decided that.
pub(super) fn verdict(explanation: &Explanation, params: &Params) -> String {
    let why = why(explanation, params);
    match explanation.outcome {
        Outcome::NoDepth => {
            "This pixel belongs to nothing: the sensor measured no depth here, or --range, --roi or --mask excludes it."
                .to_owned()
        }
        Outcome::NoFacet => {
            "This pixel belongs to nothing: it has depth, but lies on no surface of at least merging.min_facet_px pixels."
                .to_owned()
        }
        Outcome::Structure { plane } => format!("This pixel belongs to structure plane {plane}{why}."),
        Outcome::Background { plane: 0 } => format!("This pixel belongs to no object{why}."),
        Outcome::Background { plane } => {
            format!("This pixel belongs to no object, but to structure plane {plane}{why}.")
        }
        Outcome::TooSmall | Outcome::Unlikely => format!("This pixel belongs to no object{why}."),
        Outcome::Object { object } => format!("This pixel belongs to object {object}{why}."),
    }
}

/// The deciding reason, with the measurement that decided where there is one.
fn why(explanation: &Explanation, params: &Params) -> String {
    let Some(kept) = &explanation.kept else { return String::new() };
    // Rules list first what they are about; of what passed every test the objectness comes last.
    let check = match kept.reason {
        Reason::Rule(_) => kept.checks.first(),
        _ => kept.checks.last(),
    };
    let measured = check.map_or(String::new(), |check| format!(" ({})", words::clause(check, params)));
    format!(": {}{measured}", words::reason(kept.reason))
}

#[cfg(test)]
mod tests {
    use objecthood::check::{Bound, Check};
    use objecthood::clusters::history::Rule;
    use objecthood::explain::{Decision, Flip, Question};

    use super::*;

    fn said(outcome: Outcome, decided: Option<(Reason, Vec<Check>)>) -> String {
        let kept = decided.map(|(reason, checks)| Decision {
            question: Question::Kept { facet: 3 },
            yes: true,
            reason,
            checks,
            flip: Flip::NotSought,
        });
        let explanation = Explanation {
            pixel: [1, 2],
            depth_m: Some(1.0),
            outcome,
            facet: None,
            kept,
            borders: Vec::new(),
            way: Vec::new(),
            near_misses: Vec::new(),
            object: None,
        };
        verdict(&explanation, &Params::default())
    }

    fn check(what: &'static str, measured: f64, bound: Bound, limit: f64) -> Check {
        Check { what, unit: "", measured, bound, limit, parameter: None }
    }

    /// The explanation opened with a list.
    #[test]
    fn the_verdict_is_one_sentence_with_the_reason_that_decided() {
        let checks = vec![
            check("its pixels", 9.0, Bound::Below, 5.0),
            check("its objectness", 0.8, Bound::Below, 0.5),
        ];
        assert_eq!(
            said(Outcome::Object { object: 2 }, Some((Reason::Passed, checks))),
            "This pixel belongs to object 2: nothing speaks against it (its objectness: 0.8, at least 0.5)."
        );
        let low =
            vec![check("its top", 0.004, Bound::Below, 0.01), check("something", 1.0, Bound::Below, 2.0)];
        assert_eq!(
            said(Outcome::Background { plane: 1 }, Some((Reason::Rule(Rule::Low), low))),
            "This pixel belongs to no object, but to structure plane 1: what hardly rises above the support is a part of it \
             (its top: 0.004, less than 0.01)."
        );
        let outcomes = [
            Outcome::NoDepth,
            Outcome::NoFacet,
            Outcome::Structure { plane: 1 },
            Outcome::Background { plane: 0 },
            Outcome::TooSmall,
            Outcome::Unlikely,
        ];
        for outcome in outcomes {
            for decided in [None, Some((Reason::Size, Vec::new()))] {
                let said = said(outcome, decided);
                assert!(said.starts_with("This pixel belongs to ") && said.ends_with('.'), "{said}");
                assert!(!said.contains('\n') && !said.contains(":."), "{said}");
            }
        }
    }
}
