//! Which single parameter would decide otherwise: guessed from the evidence, then tried with the whole method.

use std::collections::BTreeMap;

use crate::clusters::check::{Bound, Check};
use crate::explain::Explainer;
use crate::explain::explanation::{Decision, Flip, Question, Reason};
use crate::explain::run::Run;
use crate::explain::sweep::{self, Sweep};
use crate::params::{ParameterInfo, Params};
use crate::regions::SegmentId;
use crate::shapes::contraction::Shapes;

/// What one explanation may cost, in looks at all borders of the frame, ...
const BUDGET_LOOKS: usize = 16 * RUN_LOOKS;
/// ... and what one run of the whole method costs: 80 ms against 3 ms at 640 x 480.
const RUN_LOOKS: usize = 24;
/// So many guesses are tried for one decision.
const GUESSES: usize = 6;
/// So often half way to a flip is taken in its place.
const HALVINGS: usize = 6;
/// So often an interval in which the votes turn is halved.
const NARROWINGS: usize = 14;
/// A guess has so many digits.
const DIGITS: i32 = 3;

/// A value of a parameter that may decide otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Guess {
    pub(super) parameter: &'static str,
    pub(super) from: f64,
    /// A value from which on it may: between this and `to`.
    pub(super) near: f64,
    pub(super) to: f64,
}

impl Guess {
    /// How much it changes its parameter, as a share of its value.
    fn relative_change(&self) -> f64 {
        (self.to - self.from).abs() / self.from.abs().max(f64::MIN_POSITIVE)
    }
}

/// Looks for flips in one frame, for one explanation.
pub(super) struct Search<'a> {
    asked: &'a Explainer,
    /// Whether the sweep is paid for.
    is_swept: bool,
    /// What stage 3 makes of values that the sweep has not, by parameter and bits of the value.
    shapes: BTreeMap<(&'static str, u64), Option<Shapes>>,
    looks_left: usize,
}

impl<'a> Search<'a> {
    pub(super) fn new(asked: &'a Explainer) -> Self {
        Self { asked, is_swept: false, shapes: BTreeMap::new(), looks_left: BUDGET_LOOKS }
    }

    /// Of the guesses that are true about the nearest.
    pub(super) fn flip(&mut self, decision: &Decision) -> Flip {
        let &Decision { question, yes, reason, ref checks, .. } = decision;
        if self.looks_left < RUN_LOOKS {
            return Flip::NotSought;
        }
        let pair = match (reason, question) {
            (Reason::Folds | Reason::Steps | Reason::OtherBorders, Question::OneThing { facets }) => {
                Some(facets.map(|facet| self.asked.run.free(SegmentId(facet))))
            }
            _ => None,
        };
        let guesses = match pair {
            Some([Some(a), Some(b)]) => self.guess_votes([a, b]),
            Some(_) => Some(Vec::new()),
            None => Some(guess_checks(checks, &self.asked.params)),
        };
        let Some(mut guesses) = guesses else { return Flip::NotSought };
        guesses.sort_by(|a, b| a.relative_change().total_cmp(&b.relative_change()));
        let mut tried = Vec::new();
        for mut guess in guesses.into_iter().take(GUESSES) {
            if let Some([Some(a), Some(b)]) = pair {
                guess.to = self.narrowed(&guess, [a, b]);
            }
            match self.confirm(question, yes, &guess) {
                Confirmed::Yes(flip) => return flip,
                Confirmed::No => tried.push(guess.parameter),
                Confirmed::Refused => {}
                Confirmed::Unknown => return Flip::NotSought,
            }
        }
        tried.sort_unstable();
        tried.dedup();
        Flip::Nowhere { tried }
    }

    /// Tries a guess, and nearer and nearer values as long as half way does the same.
    fn confirm(&mut self, question: Question, yes: bool, guess: &Guess) -> Confirmed {
        let &Guess { parameter, from, mut to, .. } = guess;
        match self.ask(question, parameter, to) {
            Asked::NotRun => return Confirmed::Unknown,
            Asked::Refused => return Confirmed::Refused,
            Asked::Answer(answer) if answer == yes => return Confirmed::No,
            Asked::Answer(_) => {}
        }
        let mut is_tight = false;
        for _ in 0..HALVINGS {
            let half = half_way(from, to, is_whole(parameter));
            is_tight = half == from || half == to;
            if is_tight {
                break;
            }
            match self.ask(question, parameter, half) {
                Asked::Answer(answer) if answer != yes => to = half,
                Asked::Answer(_) => {
                    is_tight = true;
                    break;
                }
                Asked::NotRun | Asked::Refused => break,
            }
        }
        Confirmed::Yes(Flip::At { parameter, from, to, is_tight })
    }

    /// The answer with another value of a parameter.
    fn ask(&mut self, question: Question, parameter: &str, value: f64) -> Asked {
        let Some(params) = self.asked.params.with_number(parameter, value) else { return Asked::Refused };
        if self.spend(RUN_LOOKS).is_none() {
            return Asked::NotRun;
        }
        // Only the stages that the parameter reaches run again.
        let mut trial = self.asked.pipeline.clone();
        if trial.discover(&self.asked.frame, &params).is_err() {
            return Asked::Refused;
        }
        let run = trial.context_outputs().and_then(Run::new);
        run.map_or(Asked::Refused, |run| Asked::Answer(run.answer(question)))
    }

    /// Takes so much from what is left, if it is.
    fn spend(&mut self, looks: usize) -> Option<()> {
        self.looks_left = self.looks_left.checked_sub(looks)?;
        Some(())
    }

    /// What turns the votes on two facets, roughly; `None` when too little is left to find out.
    fn guess_votes(&mut self, pair: [usize; 2]) -> Option<Vec<Guess>> {
        if !self.is_swept {
            self.spend(sweep::looks(&self.asked.params))?;
            self.is_swept = true;
        }
        let sweep = &self.asked.sweep;
        let sweep = sweep.get().unwrap_or_else(|| {
            // Not within the lock: who waits there for another thread may be handed work that asks for the same.
            let swept = Sweep::new(&self.asked.params, &self.asked.surfaces, &self.asked.run);
            sweep.get_or_init(|| swept)
        });
        Some(sweep.guesses(&self.asked.run, pair))
    }

    /// The value nearest to `near`, and a round one, that does to the votes on two facets what the guess does; as near as what is
    /// left allows.
    fn narrowed(&mut self, guess: &Guess, [a, b]: [usize; 2]) -> f64 {
        let &Guess { parameter, from, mut near, to: mut far } = guess;
        let together = |shapes: &Shapes| shapes.of_facet[a] == shapes.of_facet[b];
        let now = together(&self.asked.run.shapes);
        for _ in 0..NARROWINGS {
            if (far - near).abs() <= last_digit(far) {
                break;
            }
            let middle = (near + far) / 2.0;
            let Some(shapes) = self.shapes(parameter, middle) else { break };
            *(if together(shapes) == now { &mut near } else { &mut far }) = middle;
        }
        sweep::outwards(far, from)
    }

    /// What stage 3 makes of the facets with another value; `None` when that is not allowed, or nothing is left.
    fn shapes(&mut self, parameter: &'static str, value: f64) -> Option<&Shapes> {
        let key = (parameter, value.to_bits());
        if !self.shapes.contains_key(&key) {
            self.spend(sweep::looks_at(parameter))?;
            let shapes = self.asked.sweep.get()?.shapes(&self.asked.run, parameter, value);
            self.shapes.insert(key, shapes);
        }
        self.shapes.get(&key)?.as_ref()
    }
}

/// What the method says with another value of a parameter.
enum Asked {
    Answer(bool),
    /// The value is not allowed beside the others, or with it the frame cannot be looked at.
    Refused,
    /// Too little is left for a run.
    NotRun,
}

/// What became of a guess.
enum Confirmed {
    Yes(Flip),
    No,
    /// The method takes no such value.
    Refused,
    /// Too little was left to find out.
    Unknown,
}

/// The checks that have to be turned over to decide otherwise: those that fail, or if none does any.
fn turned(checks: &[Check]) -> impl Iterator<Item = &Check> {
    let any_fails = checks.iter().any(|check| !check.holds());
    checks.iter().filter(move |check| !any_fails || !check.holds())
}

/// Values that turn one of these checks over.
fn guess_checks(checks: &[Check], params: &Params) -> Vec<Guess> {
    turned(checks).flat_map(|check| guess(check, params)).collect()
}

/// Values of the parameter behind a check that turn it over: the nearest, and one a little farther.
fn guess(check: &Check, params: &Params) -> Vec<Guess> {
    let Some(parameter) = check.parameter else { return Vec::new() };
    let Some(from) = params.number(parameter).filter(|value| *value != 0.0 && check.limit != 0.0) else {
        return Vec::new();
    };
    let limits = info(parameter).and_then(|info| info.limits());
    let Some((least, greatest)) = limits else { return Vec::new() };
    // The limit is proportional to the parameter, and has to rise or to fall to turn the check over.
    let factor = check.limit / from;
    let exact = check.measured / factor;
    let limit_rises = matches!(check.bound, Bound::Below | Bound::AtMost) != check.holds();
    let sign = if limit_rises == (factor > 0.0) { 1.0 } else { -1.0 };
    let is_allowed = |guess: &Guess| (least..=greatest).contains(&guess.to) && guess.to != from;
    let whole = is_whole(parameter);
    let beyond = [1.0, 2.0].map(|steps| {
        let to = beyond(exact, sign, steps, whole);
        Guess { parameter, from, near: to, to }
    });
    beyond.into_iter().filter(is_allowed).collect()
}

/// A round value beyond `exact` on the side of `sign`, by at most so many `steps` of its last digit.
fn beyond(exact: f64, sign: f64, steps: f64, whole: bool) -> f64 {
    let digit = if whole { 1.0 } else { last_digit(exact) };
    // Counted from the last round value before it, so that one step is beyond it.
    let before = (sign * exact / digit).floor();
    round(sign * (before + steps) * digit)
}

/// The unit of the last of the digits that a guess has.
pub(super) fn last_digit(value: f64) -> f64 {
    let magnitude = if value == 0.0 { 0.0 } else { libm::log10(value.abs()).floor() };
    10_f64.powi(magnitude as i32 + 1 - DIGITS)
}

/// Without the noise in the last bits that comes of decimal steps.
pub(super) fn round(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

fn half_way(from: f64, to: f64, whole: bool) -> f64 {
    let half = (from + to) / 2.0;
    if whole { half.round() } else { half }
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

/// What is known of a parameter.
pub(super) fn info(parameter: &str) -> Option<ParameterInfo> {
    Params::table().into_iter().find(|info| info.name == parameter)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_guess_turns_its_check_over_and_is_round() {
        let params = Params::default();
        // Whatever is measured, on either side of the limit: with the limit that the guess makes the check turns.
        for bound in [Bound::Below, Bound::AtMost, Bound::Above, Bound::AtLeast] {
            for (parameter, factor) in
                [("height.min_top_m", 1.0), ("vessels.concavity", -0.5), ("fragments.max_size_px", 0.25)]
            {
                let from = params.number(parameter).unwrap();
                for share in [0.013, 0.4, 0.999, 1.0, 1.001, 1.7] {
                    let limit = from * factor;
                    // Pixels are counted.
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
        // Beyond what the parameter may be: 1 m at most.
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
}
