//! Pictures of the scenes that are hardest for a method.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use objecthood::{Method, Params};
use objecthood_eval::{Report, Scene, numbered_as_truth, object_map, score};
use objecthood_io::output;
use objecthood_view::{comparison, png};
use rayon::prelude::*;

use super::stock::Stock;
use crate::outputs::make_folder;

/// Number of scenes that are drawn.
const HARDEST: usize = 12;

/// Draws the hardest scenes of `report`, which scores `stock`: colour, the result of each method, truth.
///
/// # Errors
/// When a scene can no longer be read, or a picture cannot be written.
pub(crate) fn draw(folder: &Path, stock: &Stock, report: &Report, params: &Params) -> Result<()> {
    make_folder(folder)?;
    let draw_one = |&k: &usize| -> Result<(PathBuf, Vec<u8>)> {
        let name = &report.scenes[k].name;
        let picture = picture(&stock.scene(k)?, params).with_context(|| name.clone())?;
        Ok((folder.join(format!("{name}.png")), picture))
    };
    let files = hardest(report).par_iter().map(draw_one).collect::<Result<Vec<_>>>()?;
    Ok(output::write_together(&files)?)
}

/// The indices of the scenes with most objects that are not correct; of two equal ones, the one with more objects first.
pub(crate) fn hardest(report: &Report) -> Vec<usize> {
    let mut places: Vec<usize> = (0..report.scenes.len()).collect();
    places.sort_by_key(|&k| {
        let counts = report.scenes[k].counts();
        std::cmp::Reverse((counts.total() - counts.correct, counts.total()))
    });
    places.truncate(HARDEST);
    places
}

fn picture(scene: &Scene, params: &Params) -> Result<Vec<u8>> {
    let found = [Method::Paper, Method::Context].map(|method| -> Result<_> {
        let params = Params { method, ..params.clone() };
        let labels = objecthood::discover(&scene.frame, &params)?.labels;
        let objects = score(&labels, &scene.truth)?.objects;
        let correct =
            objects.iter().filter(|object| object.verdict == objecthood_eval::Verdict::Correct).count();
        let title = format!("{method}: {correct} of {} correct", objects.len());
        Ok((title, numbered_as_truth(&labels, &scene.truth)?))
    });
    let [paper, context] = found;
    let (paper, context, truth) = (paper?, context?, object_map(&scene.truth)?);
    let maps = [(paper.0.as_str(), &paper.1), (context.0.as_str(), &context.1), ("truth", &truth)];
    Ok(png(&comparison(&scene.frame, &maps))?)
}
