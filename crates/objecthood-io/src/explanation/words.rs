//! Reasons, measurements and changes of parameters in words.

use objecthood::Params;
use objecthood::check::{Bound, Check};
use objecthood::clusters::history::Rule;
use objecthood::explain::{Flip, Reason};

/// A limit that differs from its parameter by a smaller share is the parameter.
const SAME: f64 = 1e-3;
/// Beyond this share a change is not given in percent: the value has doubled or changed its sign, and is another one
/// rather than a changed one.
const MOST_PERCENT: f64 = 100.0;
/// A smaller change would be written as 0.0 %.
const LEAST_PERCENT: f64 = 0.05;

/// What decided.
pub(super) fn reason(reason: Reason) -> &'static str {
    match reason {
        Reason::Folds => "the folds of their border",
        Reason::Steps => "the steps of their border",
        Reason::Colors => "a change of colour along their border",
        Reason::Seam => "a seam of colour runs along their border",
        Reason::OtherBorders => "other borders outvote their own",
        Reason::Size => "it has too few pixels",
        Reason::Structure => "it lies on a large plane that carries or encloses objects",
        Reason::Skirt => "it looks like the plane beside it, and depth is not so exact at borders",
        Reason::Objectness => "its objectness is too low",
        Reason::Flat => "it lies flat on its support, and differs from what is around it",
        Reason::Passed => "nothing speaks against it",
        Reason::Rule(Rule::Fragment) => "a fragment goes to what it touches most",
        Reason::Rule(Rule::Low) => "what hardly rises above the support is a part of it",
        Reason::Rule(Rule::Bump) => {
            "what rises no higher above a wall than the sensor's waves is a part of it"
        }
        Reason::Rule(Rule::VesselInside) => "two pieces of the inside of a vessel",
        Reason::Rule(Rule::VesselWall) => "the inside of a vessel and the wall before it",
        Reason::Rule(Rule::VesselRim) => "within the rim of a vessel",
        Reason::Rule(Rule::VesselRemainder) => "a remainder of a vessel",
        Reason::Rule(Rule::VesselTurned) => "pieces of one round vessel",
        Reason::Rule(Rule::BoxWalls) => "the walls of a box",
        Reason::Rule(Rule::OpenBox) => "the walls and the bottom of an open box",
        Reason::Rule(Rule::VesselBottom) => "the bottom of a vessel",
        Reason::Rule(Rule::Neck) => "the parts of one body, across a neck or fold",
        Reason::Rule(Rule::Occlusion) => "one surface behind something nearer",
    }
}

/// A measurement beside its limit, as a formula: `its pixels: 149 px < 250 (fragments.max_size_px)`.
pub(super) fn formula(check: &Check, params: &Params) -> String {
    let sign = match side(check) {
        Side::Less => "<",
        Side::AtMost => "<=",
        Side::More => ">",
        Side::AtLeast => ">=",
    };
    let limit = match check.parameter {
        Some(parameter) => match scale(parameter, check.limit, params) {
            Some(scale) => {
                format!("{} ({} x {parameter}, for this focal length)", number(check.limit), number(scale))
            }
            None => format!("{} ({parameter})", number(check.limit)),
        },
        None => number(check.limit),
    };
    format!("{}: {} {sign} {limit}", check.what, measured(check))
}

/// The same as a clause: `its pixels: 149 px, less than fragments.max_size_px = 250`.
pub(super) fn clause(check: &Check, params: &Params) -> String {
    let side = match side(check) {
        Side::Less => "less than",
        Side::AtMost => "at most",
        Side::More => "more than",
        Side::AtLeast => "at least",
    };
    let limit = match check.parameter {
        Some(parameter) => match scale(parameter, check.limit, params) {
            Some(scale) => {
                format!("{} x {parameter} = {}, for this focal length", number(scale), number(check.limit))
            }
            None => format!("{parameter} = {}", number(check.limit)),
        },
        None => number(check.limit),
    };
    format!("{}: {}, {side} {limit}", check.what, measured(check))
}

/// By what a parameter whose unit holds at a certain focal length is multiplied to give the limit for this camera; `None` when it is not.
fn scale(parameter: &str, limit: f64, params: &Params) -> Option<f64> {
    let info = Params::table().into_iter().find(|info| info.name == parameter)?;
    let scale = limit / params.number(parameter)?;
    let is_scaled = info.unit.contains("focal length") && scale.is_finite() && (scale - 1.0).abs() > SAME;
    is_scaled.then(|| format!("{scale:.2}").parse().unwrap_or(scale))
}

/// On which side of its limit a measurement lies.
enum Side {
    Less,
    AtMost,
    More,
    AtLeast,
}

fn side(check: &Check) -> Side {
    match (check.bound, check.holds()) {
        (Bound::Below, true) | (Bound::AtLeast, false) => Side::Less,
        (Bound::AtMost, true) | (Bound::Above, false) => Side::AtMost,
        (Bound::Above, true) | (Bound::AtMost, false) => Side::More,
        (Bound::AtLeast, true) | (Bound::Below, false) => Side::AtLeast,
    }
}

fn measured(check: &Check) -> String {
    let space = if check.unit.is_empty() { "" } else { " " };
    format!("{}{space}{}", number(check.measured), check.unit)
}

/// What would change the answer.
pub(super) fn flip(flip: &Flip) -> String {
    match flip {
        Flip::At { parameter, from, to, is_tight } => {
            let less = if *is_tight { "" } else { "; a smaller change may do" };
            format!("would change with --set {parameter}={to} (now {from}{}{less})", share(*from, *to))
        }
        Flip::Off { parameter } => format!("would change with --set {parameter}=false (now true)"),
        Flip::Nowhere { tried } if tried.is_empty() => {
            "no parameter suggests itself; a repair search tries all".to_owned()
        }
        Flip::Nowhere { tried } => {
            format!("none of the parameters tried turns it: {}; a repair search tries all", tried.join(", "))
        }
        Flip::NotSought => "what would change it was not searched to the end: that takes too long".to_owned(),
    }
}

/// The change from one value to another in percent of the first, where that says something.
pub(super) fn share(from: f64, to: f64) -> String {
    // From 0 it is not finite, which is beyond every bound.
    let percent = 100.0 * (to - from) / from.abs();
    if (LEAST_PERCENT..=MOST_PERCENT).contains(&percent.abs()) {
        format!(", {percent:+.1} %")
    } else {
        String::new()
    }
}

/// With four digits, as short as they can be written.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    rounded.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// It said "-714 %".
    #[test]
    fn no_percent_is_given_of_a_value_that_is_another_one() {
        assert_eq!(share(250.0, 148.0), ", -40.8 %");
        assert_eq!(share(0.55, 0.825), ", +50.0 %");
        assert_eq!(share(-12.0, -6.0), ", +50.0 %");
        assert_eq!(share(2.0, 4.0), ", +100.0 %");
        assert_eq!(share(0.95, 0.94975), "", "it said -0.0 %");
        for (from, to) in [(12.0, -85.7), (4.0, 15.3), (0.0, 1.0), (0.0, 0.0), (1.0, -0.1)] {
            assert_eq!(share(from, to), "", "{from} to {to}");
        }
    }

    /// A limit of 341 stood beside a slider at 250.
    #[test]
    fn a_limit_for_another_focal_length_says_by_what_it_was_multiplied() {
        let check = Check {
            what: "its pixels",
            unit: "px",
            measured: 149.0,
            bound: Bound::Below,
            limit: 341.0,
            parameter: Some("fragments.max_size_px"),
        };
        let params = Params::default();
        assert_eq!(
            formula(&check, &params),
            "its pixels: 149 px < 341 (1.36 x fragments.max_size_px, for this focal length)"
        );
        assert_eq!(
            clause(&check, &params),
            "its pixels: 149 px, less than 1.36 x fragments.max_size_px = 341, for this focal length"
        );
    }

    #[test]
    fn a_measurement_is_said_from_its_own_side_of_the_limit() {
        let check = |bound, measured| Check {
            what: "its pixels",
            unit: "px",
            measured,
            bound,
            limit: 250.0,
            parameter: Some("fragments.max_size_px"),
        };
        let params = Params::default();
        for (bound, measured, sign, words) in [
            (Bound::Below, 149.0, "<", "less than"),
            (Bound::Below, 250.0, ">=", "at least"),
            (Bound::AtMost, 251.0, ">", "more than"),
            (Bound::Above, 250.0, "<=", "at most"),
        ] {
            let check = check(bound, measured);
            let its_pixels = format!("its pixels: {measured} px");
            assert_eq!(formula(&check, &params), format!("{its_pixels} {sign} 250 (fragments.max_size_px)"));
            assert_eq!(clause(&check, &params), format!("{its_pixels}, {words} fragments.max_size_px = 250"));
        }
    }
}
