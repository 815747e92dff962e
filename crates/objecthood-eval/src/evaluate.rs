//! Running something over the scenes of a data set and scoring what comes out.

use std::fmt::Display;
use std::fs;
use std::ops::Range;
use std::path::PathBuf;

use objecthood::{Object, Raster};
use objecthood_io::{GridCamera, label_image};
use rayon::prelude::*;

use crate::composer::Composer;
use crate::dataset::{Scene, SceneRef};
use crate::error::{Error, Result};
use crate::report::{Report, SceneReport};
use crate::stages::Stages;

/// The folder under which composed scenes are reported, and what their names begin with.
pub const COMPOSITE: &str = "composite";

/// What is said about a scene.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// The object of every pixel: 0 = none, other values = one object each.
    pub labels: Raster<u16>,
    /// The objects of the label image, if more is known of them than their pixels.
    pub objects: Option<Vec<Object>>,
    /// The diagnostics of the stages before it, if they were watched.
    pub stages: Option<Stages>,
}

/// Scores what `predict` says about each scene.
///
/// Scenes run in parallel and are reported in the order given; no more of them than there are threads are in memory.
/// `camera` is that of [`SceneRef::load`]. An error of `predict` is returned as it is, so it should name the scene.
///
/// # Errors
/// Of the scenes that fail, what the first one fails with; [`Error::NoObjects`] when no scene holds an object.
pub fn evaluate<E: From<Error> + Send>(
    scenes: &[SceneRef],
    camera: Option<&GridCamera>,
    predict: impl Fn(&Scene, &SceneRef) -> std::result::Result<Prediction, E> + Sync,
) -> std::result::Result<Report, E> {
    let load = |reference: &SceneRef| reference.load(camera);
    let reports = for_each_scene(scenes, load, |scene, reference| {
        Ok::<_, E>(report_of(scene, reference, &predict(scene, reference)?)?)
    })?;
    Ok(Report::new(reports)?)
}

/// As [`evaluate`] for each of `settings`, one report a setting; every scene is read only once.
///
/// # Errors
/// As [`evaluate`].
pub fn evaluate_settings<S: Sync, E: From<Error> + Send>(
    scenes: &[SceneRef],
    camera: Option<&GridCamera>,
    settings: &[S],
    predict: impl Fn(&S, &Scene, &SceneRef) -> std::result::Result<Prediction, E> + Sync,
) -> std::result::Result<Vec<Report>, E> {
    let load = |reference: &SceneRef| reference.load(camera);
    let by_scene = for_each_scene(scenes, load, |scene, reference| {
        let report = |s| Ok(report_of(scene, reference, &predict(s, scene, reference)?)?);
        settings.iter().map(report).collect::<std::result::Result<Vec<_>, E>>()
    })?;
    by_setting(by_scene, settings.len())
}

/// As [`evaluate_settings`] on the scenes that `composer` makes of `seeds`, in the folder [`COMPOSITE`]; `predict` gets the
/// name of the scene.
///
/// # Errors
/// As [`evaluate`], and as [`Composer::compose`].
pub fn evaluate_composites<S: Sync, E: From<Error> + Send>(
    composer: &Composer,
    seeds: Range<u64>,
    settings: &[S],
    predict: impl Fn(&S, &Scene, &str) -> std::result::Result<Prediction, E> + Sync,
) -> std::result::Result<Vec<Report>, E> {
    let seeds: Vec<u64> = seeds.collect();
    let by_scene = for_each_scene(
        &seeds,
        |&seed| composer.compose(seed),
        |scene, seed| {
            let name = format!("{COMPOSITE}{seed}");
            let report = |s| Ok(report(scene, (&name, COMPOSITE), &name, &predict(s, scene, &name)?)?);
            settings.iter().map(report).collect::<std::result::Result<Vec<_>, E>>()
        },
    )?;
    by_setting(by_scene, settings.len())
}

/// One report a setting, from the reports of all settings a scene.
fn by_setting<E: From<Error>>(
    by_scene: Vec<Vec<SceneReport>>,
    settings: usize,
) -> std::result::Result<Vec<Report>, E> {
    let mut by_setting = vec![Vec::with_capacity(by_scene.len()); settings];
    for reports in by_scene {
        for (of_setting, report) in by_setting.iter_mut().zip(reports) {
            of_setting.push(report);
        }
    }
    by_setting.into_iter().map(|reports| Ok(Report::new(reports)?)).collect()
}

/// The figures of a scene, which an error calls `source`.
fn report(
    scene: &Scene,
    (name, folder): (&str, &str),
    source: &dyn Display,
    prediction: &Prediction,
) -> Result<SceneReport> {
    let (name, folder) = (name.to_owned(), folder.to_owned());
    SceneReport::of(name, folder, &scene.truth, prediction)
        .map_err(|error| Error::InScene { scene: source.to_string(), error: Box::new(error) })
}

fn report_of(scene: &Scene, reference: &SceneRef, prediction: &Prediction) -> Result<SceneReport> {
    report(scene, (&reference.name, &reference.folder), &reference.path.display(), prediction)
}

/// Gets the scenes with `load` and applies `work`, one scene a thread. A batch ends before the next begins, because a
/// thread that waits within `work` would otherwise begin another scene meanwhile, and another within that.
fn for_each_scene<R: Sync, T: Send, E: From<Error> + Send>(
    scenes: &[R],
    load: impl Fn(&R) -> Result<Scene> + Sync,
    work: impl Fn(&Scene, &R) -> std::result::Result<T, E> + Sync,
) -> std::result::Result<Vec<T>, E> {
    let mut done = Vec::with_capacity(scenes.len());
    for batch in scenes.chunks(rayon::current_num_threads()) {
        let results: Vec<_> = batch.par_iter().map(|r| work(&load(r)?, r)).collect();
        for result in results {
            done.push(result?);
        }
    }
    Ok(done)
}

/// A folder of label images, `<scene><suffix>` each: 8- or 16-bit grey PNG, 0 = none.
#[derive(Clone, Debug)]
pub struct LabelFolder {
    /// The folder.
    pub path: PathBuf,
    /// What follows the name of the scene, for example `.labels.png`.
    pub suffix: String,
}

impl LabelFolder {
    /// The label image of `scene`.
    ///
    /// # Errors
    /// [`Error::ReadLabels`] when there is none or it cannot be read, [`Error::Input`] when it is no label image.
    pub fn read(&self, scene: &SceneRef) -> Result<Prediction> {
        let path = self.path.join(format!("{}{}", scene.name, self.suffix));
        let bytes = fs::read(&path).map_err(|reason| {
            let scene = scene.name.clone();
            Error::ReadLabels { scene, path: path.clone(), reason }
        })?;
        let labels = label_image::decode(&bytes).map_err(|error| error.at(&path))?;
        Ok(Prediction { labels, objects: None, stages: None })
    }
}
