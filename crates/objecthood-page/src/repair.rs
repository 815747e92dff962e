//! What would change the answer for a pixel or two: a search through all parameters, as far as it was asked.

use std::time::{Duration, Instant};

use objecthood::explain::{Explainer, Pixels, Repair, RepairSearch};
use objecthood_io::explanation::{side_effects, sought};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::error::Result;
use crate::pipelines::Bench;
use crate::session::Session;
use crate::settings::Settings;

/// No other parameters are begun after this time: the page asks again, unless it has a newer question.
const TURN: Duration = Duration::from_millis(400);

/// What is to be changed.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Asked {
    /// The number of the frame.
    frame: usize,
    /// The parameters.
    settings: Settings,
    /// Column and row.
    pixel: [usize; 2],
    /// Those of a second pixel.
    with: Option<[usize; 2]>,
}

/// A search that is under way.
pub(crate) struct Repairing {
    asked: Asked,
    explainer: Explainer,
    search: RepairSearch,
}

impl Repairing {
    /// Nothing is tried yet.
    fn new(bench: &mut Bench, session: &Session, asked: &Asked) -> Result<Self> {
        let capture = bench.capture(session, asked.frame)?;
        let params = asked.settings.params()?;
        let explainer = Explainer::new(&bench.pipeline, &capture.frame, &params)?;
        let pixels = Pixels { pixel: asked.pixel, with: asked.with };
        let search = RepairSearch::new(&explainer, pixels)?;
        Ok(Self { asked: asked.clone(), explainer, search })
    }
}

/// Goes on with the search of the bench for a moment, or begins another one; says what was found so far, the best first.
///
/// # Errors
/// Those of the frame, the parameters and the method; [`objecthood::Error::OutsideImage`].
pub(crate) fn repair(bench: &mut Bench, session: &Session, asked: &Asked) -> Result<Value> {
    let start = Instant::now();
    let mut repairing = match bench.repairing.take() {
        Some(same) if same.asked == *asked => same,
        _ => Repairing::new(bench, session, asked)?,
    };
    let Repairing { explainer, search, .. } = &mut repairing;
    while start.elapsed() < TURN && search.step(explainer) {}
    let found: Vec<Value> = search.found.iter().map(said).collect();
    let told = json!({
        "sought": sought(search.now),
        "tried": search.tried,
        "left": search.left.len(),
        "found": found,
    });
    bench.repairing = Some(repairing);
    Ok(told)
}

fn said(repair: &Repair) -> Value {
    let Repair { parameter, from, to, others, .. } = repair;
    json!({
        "parameter": parameter, "from": from, "to": to, "others": others.count(), "side_effects": side_effects(*others),
    })
}
