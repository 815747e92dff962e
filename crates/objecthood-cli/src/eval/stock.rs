//! The scenes that are scored: those of the data set, then those composed of them.

use std::ops::Range;

use anyhow::Result;
use objecthood::params;
use objecthood_eval::{
    Composer, Prediction, Report, Scene, SceneRef, Setting, evaluate, evaluate_composites, evaluate_settings,
};
use objecthood_io::GridCamera;

/// The scenes of a data set and, if any are asked for, scenes composed of them.
pub(crate) struct Stock {
    scenes: Vec<SceneRef>,
    camera: Option<GridCamera>,
    composed: Option<(Composer, Range<u64>)>,
}

impl Stock {
    /// The scenes, and those that a composer makes of `seeds`; `sensor` took the scenes.
    ///
    /// # Errors
    /// When a scene cannot be read or there is nothing to compose.
    pub(crate) fn new(
        scenes: Vec<SceneRef>,
        camera: Option<GridCamera>,
        seeds: Range<u64>,
        sensor: &params::Sensor,
    ) -> Result<Self> {
        let composed =
            if seeds.is_empty() { None } else { Some((Composer::new(&scenes, camera, sensor)?, seeds)) };
        Ok(Self { scenes, camera, composed })
    }

    /// How many scenes there are.
    pub(crate) fn len(&self) -> usize {
        self.scenes.len() + self.composed.iter().flat_map(|(_, seeds)| seeds.clone()).count()
    }

    /// The scene that a report has at place `k`.
    ///
    /// # Errors
    /// When it cannot be read.
    pub(crate) fn scene(&self, k: usize) -> Result<Scene> {
        match (&self.composed, k.checked_sub(self.scenes.len())) {
            (Some((composer, seeds)), Some(composite)) => {
                Ok(composer.compose(seeds.start + composite as u64)?)
            }
            _ => Ok(self.scenes[k].load(self.camera.as_ref())?),
        }
    }

    /// Scores label images, which there are of the data set's own scenes only.
    ///
    /// # Errors
    /// Of the scenes that fail, what the first one fails with.
    pub(crate) fn evaluate_labels(
        &self,
        read: impl Fn(&SceneRef) -> objecthood_eval::Result<Prediction> + Sync,
    ) -> Result<Report> {
        Ok(evaluate(&self.scenes, self.camera.as_ref(), |_, reference| read(reference))?)
    }

    /// One report a setting; `predict` gets the name of the scene as the user knows it.
    ///
    /// # Errors
    /// Of the scenes that fail, what the first one fails with.
    pub(crate) fn evaluate(
        &self,
        settings: &[Setting],
        predict: impl Fn(&Setting, &Scene, &str) -> Result<Prediction> + Sync,
    ) -> Result<Vec<Report>> {
        let own =
            evaluate_settings(&self.scenes, self.camera.as_ref(), settings, |setting, scene, reference| {
                predict(setting, scene, &reference.path.display().to_string())
            })?;
        let Some((composer, seeds)) = &self.composed else { return Ok(own) };
        let composed = evaluate_composites(composer, seeds.clone(), settings, predict)?;
        let both = own.into_iter().zip(composed);
        Ok(both.map(|(own, composed)| own.joined(composed)).collect::<objecthood_eval::Result<_>>()?)
    }
}
