//! What a pipeline computes again after one parameter has changed, as a share of a whole frame.

use anyhow::Result;
use objecthood::{Frame, Method, Params, Pipeline};

use crate::figure::{Figure, timed};

/// How often each change is measured on a frame; the median counts.
const ROUNDS: usize = 5;
/// Steps away from a default, as factors; the first that the parameter takes is used.
const FACTORS: [f64; 4] = [1.1, 2.0, 0.5, 0.0];

/// Figures `METHOD/recomputed/GROUP.NAME/share`: CPU time of `discover` after a change of this parameter alone, over the CPU time of a
/// frame of which nothing is kept. Of every number that the method reads.
///
/// # Errors
/// When the method refuses the frame.
pub fn recomputed(name: &str, frame: &Frame, method: Method) -> Result<Vec<Figure>> {
    let params = Params { method, ..Params::default() };
    let mut pipeline = Pipeline::default();
    let cpu_ms = |pipeline: &mut Pipeline, params: &Params| -> Result<f64> {
        let (found, spent) = timed(|| pipeline.discover(frame, params).map(|_| ()));
        found?;
        Ok(1e3 * spent.cpu.as_secs_f64())
    };
    let mut whole_ms = Vec::new();
    for _ in 0..ROUNDS {
        pipeline.forget();
        whole_ms.push(cpu_ms(&mut pipeline, &params)?);
    }
    let mut figures = Vec::new();
    for info in Params::table().iter().filter(|info| info.first_stage(method).is_some()) {
        let Some(other) = changed(&params, &info.name) else { continue };
        let mut again_ms = Vec::new();
        for _ in 0..ROUNDS {
            cpu_ms(&mut pipeline, &params)?;
            again_ms.push(cpu_ms(&mut pipeline, &other)?);
        }
        let series = format!("{method}/recomputed/{}/share", info.name);
        figures.push(Figure {
            frame: name.to_owned(),
            series,
            value: median(&mut again_ms) / median(&mut whole_ms),
        });
    }
    Ok(figures)
}

/// The same parameters with another value of one number; `None` of a choice.
fn changed(params: &Params, name: &str) -> Option<Params> {
    let number = params.number(name)?;
    let others = FACTORS.iter().flat_map(|factor| [factor * number, (factor * number).round()]);
    others.filter(|&other| other != number).find_map(|other| params.with_number(name, other))
}

pub(crate) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
