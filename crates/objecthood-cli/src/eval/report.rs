//! The report of `eval`: figures and plots, and the hardest scenes as the live page shows them.

use std::path::Path;

use anyhow::{Context, Result};
use objecthood::{Params, Pipeline};
use objecthood_eval::mosd;
use objecthood_io::Capture;
use objecthood_io::output::Growing;
use objecthood_page::{Page, Report, Shown};

use super::pictures::hardest;
use super::plots::Plot;
use super::stock::Stock;
use super::subject::Scored;
use crate::shell::words_of_frames;

/// Writes figures alone.
///
/// # Errors
/// When the file cannot be written.
pub(crate) fn write_figures(path: &Path, figures: &str, params: &Params) -> Result<()> {
    Ok(begun(path, figures, &[], params)?.finish()?)
}

/// Writes figures, plots and, of a single setting, the hardest scenes.
///
/// # Errors
/// When a scene can no longer be read, or the file cannot be written.
pub(crate) fn write(
    path: &Path,
    figures: &str,
    plots: &[Plot],
    params: &Params,
    (stock, scored): (&Stock, &Scored),
) -> Result<()> {
    let mut report = begun(path, figures, plots, params)?;
    if let ([(_, scores)], false) = (&scored.reports[..], scored.laps.is_empty()) {
        let places = hardest(scores);
        let mut pipeline = Pipeline::default();
        for (number, &k) in places.iter().enumerate() {
            let name = &scores.scenes[k].name;
            let page = page(&mut pipeline, params, stock, k, (name, number, places.len()));
            report.add(&page.with_context(|| name.clone())?)?;
        }
    }
    Ok(report.finish()?)
}

fn begun(path: &Path, figures: &str, plots: &[Plot], params: &Params) -> Result<Report> {
    let mut report = Report::begin(Growing::create(path)?, words_of_frames("eval"), params)?;
    report.tell(figures);
    plots.iter().for_each(|(_, svg)| report.plot(svg));
    Ok(report)
}

/// The scene at a place of the stock, called `name`, as the `number`th of so many.
fn page(
    pipeline: &mut Pipeline,
    params: &Params,
    stock: &Stock,
    place: usize,
    (name, number, frames): (&str, usize, usize),
) -> Result<Page> {
    let scene = stock.scene(place)?;
    let mut capture = Capture::new(scene.frame);
    capture.truth = Some(mosd::labels_of(&scene.truth));
    let shown = Shown { name, capture: &capture, number, frames, laps: None, followed: None };
    Ok(Page::new(pipeline, params, &shown)?)
}
