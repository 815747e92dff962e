//! Guesses: values of a parameter, in few digits, that may turn a decision.

use crate::check::{Bound, Check};
use crate::clusters::history::Rule;
use crate::explain::explanation::Reason;
use crate::params::{ParameterInfo, Params};

/// Significant digits of a guess.
const DIGITS: i32 = 3;

/// A value of a parameter that may turn a decision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Guess {
    pub(super) parameter: &'static str,
    pub(super) from: f64,
    /// The decision may turn between this value and `to`.
    pub(super) near: f64,
    pub(super) to: f64,
}

impl Guess {
    /// The change of the parameter, as a share of its present value.
    pub(super) fn relative_change(&self) -> f64 {
        (self.to - self.from).abs() / self.from.abs().max(f64::MIN_POSITIVE)
    }
}

/// The checks to turn in order to decide otherwise: the failing checks, or if none fails, all of them (one suffices).
fn turned(checks: &[Check]) -> impl Iterator<Item = &Check> {
    let any_fails = checks.iter().any(|check| !check.holds());
    checks.iter().filter(move |check| !any_fails || !check.holds())
}

/// Values that turn one of these checks.
pub(super) fn guess_checks(checks: &[Check], params: &Params) -> Vec<Guess> {
    turned(checks).flat_map(|check| guess(check, params)).collect()
}

/// No share is larger: it switches bottoms off.
const BOTTOMS_OFF: f64 = 1.01;

/// The parameter that switches off what decided, and the number that does so, if it is no switch. `None` where none does.
///
/// Of a rule with limits that no parameter sets, and where another rule would do the same, no limit turns the decision.
pub(super) fn switched_off(reason: Reason, yes: bool) -> Option<(&'static str, Option<f64>)> {
    match (reason, yes) {
        (Reason::Rule(Rule::VesselBottom), true) => Some(("vessels.bottom_contact_share", Some(BOTTOMS_OFF))),
        (Reason::Rule(Rule::VesselBottom), false) => None,
        (Reason::Rule(rule), true) if rule.is_of_vessels() => Some(("vessels.concavity", Some(0.0))),
        (Reason::Rule(Rule::Neck), true) => Some(("necks.enabled", None)),
        (Reason::Rule(Rule::Occlusion), true) => Some(("occlusion.enabled", None)),
        (Reason::Flat, true) => Some(("flat.enabled", None)),
        (Reason::Seam, false) => Some(("seams.enabled", None)),
        (Reason::Skirt, _) => Some(("structure.skirt_reach_px", Some(0.0))),
        _ => None,
    }
}

/// Values of a check's parameter that turn the check: the nearest round one, one a little farther, and the end of its range. Where the
/// nearest does not turn the decision, because something else then speaks against it too, a far one may: it lets other things in.
fn guess(check: &Check, params: &Params) -> Vec<Guess> {
    let Some(parameter) = check.parameter else { return Vec::new() };
    let Some(from) = params.number(parameter).filter(|value| *value != 0.0 && check.limit != 0.0) else {
        return Vec::new();
    };
    let limits = info(parameter).and_then(|info| info.limits());
    let Some((least, greatest)) = limits else { return Vec::new() };
    // The limit is proportional to the parameter. It has to rise or to fall to turn the check.
    let factor = check.limit / from;
    let exact = check.measured / factor;
    let limit_rises = matches!(check.bound, Bound::Below | Bound::AtMost) != check.holds();
    let sign = if limit_rises == (factor > 0.0) { 1.0 } else { -1.0 };
    let is_allowed = |guess: &Guess| (least..=greatest).contains(&guess.to) && guess.to != from;
    let whole = is_whole(parameter);
    let end = if sign > 0.0 { greatest } else { least };
    let values = [beyond(exact, sign, 1.0, whole), beyond(exact, sign, 2.0, whole), end];
    let guesses = values.map(|to| Guess { parameter, from, near: to, to });
    // If the nearest value is beyond the range, its end does not turn the check.
    let turns = is_allowed(&guesses[0]);
    guesses.into_iter().filter(|guess| turns && is_allowed(guess)).collect()
}

/// A round value beyond `exact` on the side of `sign`, by at most `steps` units of its last digit.
fn beyond(exact: f64, sign: f64, steps: f64, whole: bool) -> f64 {
    let digit = if whole { 1.0 } else { last_digit(exact) };
    // Counted from the last round value before `exact`, so that one step leads beyond `exact`.
    let before = (sign * exact / digit).floor();
    round(sign * (before + steps) * digit)
}

/// The unit of the last digit of a guess.
pub(super) fn last_digit(value: f64) -> f64 {
    let magnitude = if value == 0.0 { 0.0 } else { libm::log10(value.abs()).floor() };
    10_f64.powi(magnitude as i32 + 1 - DIGITS)
}

/// Removes the rounding noise of decimal steps.
pub(super) fn round(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

/// Whether a parameter takes whole numbers only.
pub(super) fn is_whole(parameter: &str) -> bool {
    let info = info(parameter);
    info.is_some_and(|info| Params::default().with_number(&info.name, fraction_within(&info)).is_none())
}

/// A number with a fraction in the range of a parameter.
fn fraction_within(info: &ParameterInfo) -> f64 {
    let (least, greatest) = info.limits().unwrap_or((0.0, 1.0));
    if greatest - least > 1.0 { least + 0.5 } else { (least + greatest) / 2.0 }
}

/// The line of a parameter in the table.
pub(super) fn info(parameter: &str) -> Option<ParameterInfo> {
    Params::table().into_iter().find(|info| info.name == parameter)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_guess_turns_its_check_over_and_is_round() {
        let params = Params::default();
        // For any measured value, on either side of the limit: the check turns with the limit that the guess sets.
        for bound in [Bound::Below, Bound::AtMost, Bound::Above, Bound::AtLeast] {
            for (parameter, factor) in
                [("height.min_top_m", 1.0), ("vessels.concavity", -0.5), ("fragments.max_size_px", 0.25)]
            {
                let from = params.number(parameter).unwrap();
                for share in [0.013, 0.4, 0.999, 1.0, 1.001, 1.7] {
                    let limit = from * factor;
                    // Numbers of pixels are whole.
                    let measured = if is_whole(parameter) { (limit * share).round() } else { limit * share };
                    let check = Check::new("", "", measured, bound, limit).set_by(parameter);
                    let guesses = guess(&check, &params);
                    let turns =
                        |guess: &Guess| Check { limit: guess.to * factor, ..check }.holds() != check.holds();
                    assert!(guesses.iter().any(turns), "{check:?} {guesses:?}");
                    for Guess { to, .. } in guesses {
                        assert!(params.with_number(parameter, to).is_some(), "{to}");
                        let rounded: f64 = format!("{to:.2e}").parse().unwrap();
                        assert!(rounded == to || is_whole(parameter), "{to} is not round");
                    }
                }
            }
        }
    }

    #[test]
    fn what_no_parameter_sets_has_no_guess() {
        let params = Params::default();
        let fixed = Check::new("", "", 1.0, Bound::Below, 2.0);
        assert_eq!(guess(&fixed, &params), []);
        assert_eq!(guess(&fixed.set_by("no.parameter"), &params), []);
        assert_eq!(guess(&fixed.set_by("vessels.rim_circle"), &params), []);
        // Outside the range of the parameter: it is 1 m at most.
        let far = Check::new("", "", 5.0, Bound::AtMost, 0.015).set_by("vessels.rim_height_m");
        assert_eq!(guess(&far, &params), []);
    }

    #[test]
    fn only_what_decided_is_turned() {
        let holds = Check::new("", "", 1.0, Bound::Below, 2.0).set_by("height.min_top_m");
        let fails = Check::new("", "", 3.0, Bound::Below, 2.0).set_by("occlusion.angle_deg");
        let parameters =
            |checks: &[Check]| turned(checks).filter_map(|check| check.parameter).collect::<Vec<_>>();
        assert_eq!(parameters(&[holds, fails]), ["occlusion.angle_deg"]);
        assert_eq!(parameters(&[holds]), ["height.min_top_m"]);
    }

    #[test]
    fn whole_numbers_are_known() {
        for info in Params::table().iter().filter(|info| info.limits().is_some()) {
            let (least, greatest) = info.limits().unwrap();
            let is_float = info.default.contains('.') || least.fract() != 0.0 || greatest.fract() != 0.0;
            assert!(!(is_whole(&info.name) && is_float), "{}", info.name);
        }
        assert!(is_whole("fragments.max_size_px") && is_whole("graph.min_size_px"));
        assert!(!is_whole("occlusion.angle_deg") && !is_whole("contraction.reflex_offset_deg"));
    }

    #[test]
    fn what_decided_can_be_switched_off() {
        let params = Params::default();
        for (reason, yes) in [
            (Reason::Rule(Rule::VesselWall), true),
            (Reason::Rule(Rule::VesselBottom), true),
            (Reason::Rule(Rule::Neck), true),
            (Reason::Rule(Rule::Occlusion), true),
            (Reason::Flat, true),
            (Reason::Seam, false),
            (Reason::Skirt, false),
        ] {
            let (parameter, number) = switched_off(reason, yes).unwrap();
            let other = match number {
                Some(number) => params.with_number(parameter, number),
                None => params.with_choice(parameter, "false"),
            };
            assert!(other.is_some_and(|other| other != params), "{parameter}");
        }
        for (reason, yes) in [
            (Reason::Rule(Rule::VesselWall), false),
            (Reason::Rule(Rule::VesselBottom), false),
            (Reason::Rule(Rule::Neck), false),
            (Reason::Folds, true),
        ] {
            assert_eq!(switched_off(reason, yes), None);
        }
    }
}
