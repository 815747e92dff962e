//! Repeats stage 3 alone with other parameters, on the same facets, to find parameter values that turn the votes of borders.

use std::sync::Arc;

use rayon::prelude::*;

use crate::explain::guess::{Guess, info, last_digit, round};
use crate::explain::run::Run;
use crate::params::{Method, Params};
use crate::shapes::border::measure_borders;
use crate::shapes::contraction::{Shapes, contract, sum_votes};
use crate::stage::Stage;
use crate::surface::surfaces::Surfaces;

/// The parameters on which votes depend.
const PARAMETERS: [&str; 6] = [
    "contraction.reflex_offset_deg",
    "contraction.full_vote_deg",
    "contraction.occlusion_weight",
    "contraction.color_change_weight",
    "border.gap_quanta",
    "border.step_depth_m",
];
/// Distance of the first value of a sweep from the present value, as a share of it.
const FIRST_STEP: f64 = 0.02;
/// Factor between the distances of successive values of a sweep from the present value.
const GROWTH: f64 = 1.6;

/// The shapes with other values of one parameter, on one side of the present value, from the nearest value to the farthest.
struct Side {
    parameter: &'static str,
    from: f64,
    shapes: Vec<(f64, Shapes)>,
}

/// The shapes with other values of each parameter of the votes.
pub(super) struct Sweep {
    params: Params,
    surfaces: Arc<Surfaces>,
    sides: Vec<Side>,
}

impl Sweep {
    /// Computes the shapes for all values. O(values · borders of facets), plus [`looks`] measurements of all borders.
    pub(super) fn new(params: &Params, surfaces: &Arc<Surfaces>, run: &Run) -> Self {
        let mut sweep = Self { params: params.clone(), surfaces: surfaces.clone(), sides: Vec::new() };
        let side = |(parameter, from, values): (&'static str, f64, Vec<f64>)| {
            let shapes = |value| Some((value, sweep.shapes(run, parameter, value)?));
            Side { parameter, from, shapes: values.into_par_iter().filter_map(shapes).collect() }
        };
        let sides = sides(params).map(side).collect();
        sweep.sides = sides;
        sweep
    }

    /// The shapes with another value of one parameter.
    pub(super) fn shapes(&self, run: &Run, parameter: &str, value: f64) -> Option<Shapes> {
        let params = self.params.with_number(parameter, value)?;
        let (facets, borders, _) = run.shaped();
        let structure = facets.structure;
        Some(if looks_at(parameter) == 0 {
            contract(&sum_votes(borders, structure, &params.contraction))
        } else {
            let evidence = measure_borders(facets, &self.surfaces, &params.border);
            let evidence = match &*run.seams {
                Some(seams) => seams.cuts.mark(evidence),
                None => evidence,
            };
            contract(&sum_votes(&evidence, structure, &params.contraction))
        })
    }

    /// For each parameter and side, the nearest interval in which the votes on two facets turn: two shapes become one, or one shape
    /// becomes two. Facets are counted without the structure.
    pub(super) fn guesses(&self, run: &Run, [a, b]: [usize; 2]) -> Vec<Guess> {
        let together = |shapes: &Shapes| shapes.of_facet[a] == shapes.of_facet[b];
        let now = together(run.shaped().2);
        let guess = |side: &Side| {
            let k = side.shapes.iter().position(|(_, shapes)| together(shapes) != now)?;
            let &Side { parameter, from, .. } = side;
            let near = k.checked_sub(1).map_or(from, |k| side.shapes[k].0);
            Some(Guess { parameter, from, near, to: side.shapes[k].0 })
        };
        self.sides.iter().filter_map(guess).collect()
    }
}

/// Each parameter of the votes with its value and, for each side, the values to try.
fn sides(params: &Params) -> impl Iterator<Item = (&'static str, f64, Vec<f64>)> {
    let sides = PARAMETERS.iter().flat_map(|&parameter| [-1.0, 1.0].map(|sign| (parameter, sign)));
    sides.filter_map(|(parameter, sign)| {
        let from = params.number(parameter)?;
        Some((parameter, from, values(from, sign, info(parameter)?.limits()?)))
    })
}

/// The cost of a sweep in looks: how often it measures all borders.
pub(super) fn looks(params: &Params) -> usize {
    sides(params).map(|(parameter, _, values)| looks_at(parameter) * values.len()).sum()
}

/// The cost of one other value of a parameter in looks: 1 for a parameter of the measurement of borders, 0 for one of the votes.
pub(super) fn looks_at(parameter: &str) -> usize {
    let first_stage = info(parameter).and_then(|info| info.first_stage(Method::Context));
    usize::from(first_stage == Some(Stage::Borders))
}

/// A round value next to `value`, on the side away from `from`.
pub(super) fn outwards(value: f64, from: f64) -> f64 {
    let digit = last_digit(value);
    let steps = if value < from { (value / digit).floor() } else { (value / digit).ceil() };
    round(steps * digit)
}

/// Values on one side of `from`, at growing distances, up to the limit.
fn values(from: f64, sign: f64, (least, greatest): (f64, f64)) -> Vec<f64> {
    let limit = if sign < 0.0 { least } else { greatest };
    let first = FIRST_STEP * if from == 0.0 { 1.0 } else { from.abs() };
    let steps = (0..).map(|k| from + sign * first * GROWTH.powi(k));
    let mut values: Vec<f64> = steps.take_while(|value| sign * value < sign * limit).collect();
    if from != limit {
        values.push(limit);
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_go_to_the_limit_in_growing_steps() {
        for (from, limits) in [(12.0, (-180.0, 180.0)), (0.15, (0.0, 100.0)), (0.0, (0.0, 10.0))] {
            for sign in [-1.0, 1.0] {
                let values = values(from, sign, limits);
                let limit = if sign < 0.0 { limits.0 } else { limits.1 };
                assert_eq!(values.last().copied(), Some(limit).filter(|limit| *limit != from));
                let steps: Vec<f64> = std::iter::once(from).chain(values).collect();
                assert!(steps.windows(2).all(|pair| sign * (pair[1] - pair[0]) > 0.0), "{steps:?}");
                assert!(steps.len() < 40);
            }
        }
    }

    #[test]
    fn what_a_sweep_costs_is_bounded() {
        let looks = looks(&Params::default());
        assert!((20..=100).contains(&looks), "{looks}");
        let odd = Params::default().with_number("border.gap_quanta", 1e-9).expect("it is within its range");
        assert!(self::looks(&odd) < 200);
    }

    #[test]
    fn round_values_lie_outwards() {
        for (value, from, expected) in
            [(13.1187, 12.0, 13.2), (11.9731, 12.0, 11.9), (-92.31, 12.0, -92.4), (0.013456, 0.013, 0.0135)]
        {
            assert_eq!(outwards(value, from), expected);
        }
    }
}
