//! Finds a single parameter change that turns a decision: guessed from the evidence, then confirmed by a run of the whole method.

use std::collections::BTreeMap;

use crate::explain::explanation::{Decision, Flip, Question, Reason};
use crate::explain::guess::{Guess, guess_checks, is_whole, last_digit, switched_off};
use crate::explain::run::Run;
use crate::explain::subject::Subject;
use crate::explain::sweep::{self, Sweep};
use crate::params::Params;
use crate::regions::SegmentId;
use crate::shapes::contraction::Shapes;

/// Budget of one explanation: sixteen runs of the method. The unit, a *look*, is one measurement of all borders of the frame.
const BUDGET_LOOKS: usize = 16 * RUN_LOOKS;
/// Cost of one run of the whole method in looks: about 80 ms against 3 ms at 640 x 480.
const RUN_LOOKS: usize = 24;
/// Most guesses tried for one decision.
const GUESSES: usize = 6;
/// Most halvings of the interval between the present value and a flip.
const HALVINGS: usize = 6;
/// Most halvings of an interval in which the votes turn.
const NARROWINGS: usize = 14;

/// The search for flips in one frame, for one explanation.
pub(super) struct Search<'a> {
    asked: &'a Subject,
    /// Whether the cost of the sweep is paid.
    is_swept: bool,
    /// Shapes for values outside the sweep, by parameter and bits of the value.
    shapes: BTreeMap<(&'static str, u64), Option<Shapes>>,
    looks_left: usize,
}

impl<'a> Search<'a> {
    pub(super) fn new(asked: &'a Subject) -> Self {
        Self { asked, is_swept: false, shapes: BTreeMap::new(), looks_left: BUDGET_LOOKS }
    }

    /// Tries guesses in the order of their relative change, and returns the first that turns the decision.
    pub(super) fn flip(&mut self, decision: &Decision) -> Flip {
        let &Decision { question, yes, reason, ref checks, .. } = decision;
        if self.looks_left < RUN_LOOKS {
            return Flip::NotSought;
        }
        let pair = match (reason, question) {
            (
                Reason::Folds | Reason::Steps | Reason::Colors | Reason::OtherBorders,
                Question::OneThing { facets },
            ) => Some(facets.map(|facet| self.asked.run.free(SegmentId(facet)))),
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
        if let Some((parameter, number)) = switched_off(reason, yes) {
            let now = &self.asked.params;
            let (off, flip) = match number {
                Some(to) => {
                    let from = now.number(parameter).unwrap_or(to);
                    (now.with_number(parameter, to), Flip::At { parameter, from, to, is_tight: false })
                }
                None => (now.with_choice(parameter, "false"), Flip::Off { parameter }),
            };
            match self.ask(question, off) {
                Asked::Answer(answer) if answer != yes => return flip,
                Asked::Answer(_) => tried.push(parameter),
                Asked::Refused => {}
                Asked::NotRun => return Flip::NotSought,
            }
        }
        tried.sort_unstable();
        tried.dedup();
        Flip::Nowhere { tried }
    }

    /// Tries a guess. If it turns the answer, halves the distance to the present value as long as the answer
    /// still turns.
    fn confirm(&mut self, question: Question, yes: bool, guess: &Guess) -> Confirmed {
        let &Guess { parameter, from, mut to, .. } = guess;
        match self.ask_at(question, parameter, to) {
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
            match self.ask_at(question, parameter, half) {
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

    /// The answer to a question with another number for a parameter.
    fn ask_at(&mut self, question: Question, parameter: &str, number: f64) -> Asked {
        self.ask(question, self.asked.params.with_number(parameter, number))
    }

    /// The answer to a question with other parameters; `None` if they are not allowed.
    fn ask(&mut self, question: Question, params: Option<Params>) -> Asked {
        let Some(params) = params else { return Asked::Refused };
        if self.spend(RUN_LOOKS).is_none() {
            return Asked::NotRun;
        }
        // Only the stages that the parameter affects run again.
        let mut trial = self.asked.pipeline.clone();
        if trial.discover(&self.asked.frame, &params).is_err() {
            return Asked::Refused;
        }
        let run = trial.context_outputs().and_then(Run::new);
        let asked = |run: Run| Some(run.answer(run.translated(question, &self.asked.run)?));
        run.and_then(asked).map_or(Asked::Refused, Asked::Answer)
    }

    /// Takes `looks` from the budget; `None` if too little is left.
    fn spend(&mut self, looks: usize) -> Option<()> {
        self.looks_left = self.looks_left.checked_sub(looks)?;
        Some(())
    }

    /// Rough guesses that turn the votes on two facets; `None` when too little of the budget is left.
    fn guess_votes(&mut self, pair: [usize; 2]) -> Option<Vec<Guess>> {
        if !self.is_swept {
            self.spend(sweep::looks(&self.asked.params))?;
            self.is_swept = true;
        }
        let sweep = &self.asked.sweep;
        let sweep = sweep.get().unwrap_or_else(|| {
            // Outside the lock: while a thread waits inside, rayon may give it another task that needs the same sweep.
            let swept = Sweep::new(&self.asked.params, &self.asked.surfaces, &self.asked.run);
            sweep.get_or_init(|| swept)
        });
        Some(sweep.guesses(&self.asked.run, pair))
    }

    /// A round value near `near` that turns the votes on two facets as the guess does; as near as the budget allows.
    fn narrowed(&mut self, guess: &Guess, [a, b]: [usize; 2]) -> f64 {
        let &Guess { parameter, from, mut near, to: mut far } = guess;
        let together = |shapes: &Shapes| shapes.of_facet[a] == shapes.of_facet[b];
        let now = together(self.asked.run.shaped().2);
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

    /// The shapes of stage 3 with another value; `None` when the value is not allowed, or the budget is spent.
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

/// The answer of the method with another value of a parameter.
enum Asked {
    Answer(bool),
    /// The value is not allowed, or the method fails with it.
    Refused,
    /// Too little of the budget is left for a run.
    NotRun,
}

/// The result of trying a guess.
enum Confirmed {
    Yes(Flip),
    No,
    /// The method does not accept the value.
    Refused,
    /// Too little of the budget was left.
    Unknown,
}

fn half_way(from: f64, to: f64, whole: bool) -> f64 {
    let half = (from + to) / 2.0;
    if whole { half.round() } else { half }
}
