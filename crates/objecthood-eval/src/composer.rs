//! Harder scenes with exact truth, composed from the scenes of a data set (docs/EVALUATION.md, Composed scenes).
//!
//! The scenes of mOSD *learn* hold two or three objects each, and `context` finds all of them. Composed scenes hold the
//! same objects more densely: they test clutter, contact and occlusion, not new shapes.
//!
//! 1. Every object that nothing hides and that stands on the table becomes a specimen: its points, colours, footprint.
//! 2. The table of one scene is cleared: where its objects were, the table goes on.
//! 3. Specimens are drawn, turned and moved a little, put on the table or on a flat top, their footprints apart by
//!    0, 5 or 30 mm at least; half of those on the table are pushed towards a neighbour until just that gap is left.
//! 4. All are drawn into one picture, the nearest surface in front.
//! 5. The picture is measured: disparity in whole quanta, no depth in the projector's shadow. Objects of which too little
//!    is seen are taken out with their pixels, as if nothing had been measured there.
//!
//! A seed gives the same scene on every machine. Scenes are made when they are needed and never stored: they are made
//! of the data set, which is not ours to publish.

mod canvas;
mod morphology;
mod placement;
mod polygon;
mod sensor;
mod specimen;
mod table;
#[cfg(test)]
mod tests;

use objecthood::surface::disparity::DisparitySpace;
use objecthood::{Frame, Raster, params};
use objecthood_io::GridCamera;
use objecthood_scene::export::mosd_labels_of;
use objecthood_scene::random::Rng;
use rayon::prelude::*;

use crate::dataset::{Scene, SceneRef};
use crate::error::{Error, Result};
use crate::mosd;
use canvas::{Canvas, NOTHING, TABLE};
use placement::{Placement, place};
use specimen::{Specimen, specimens};
use table::Table;

/// The category of mOSD whose objects are open, so that their inside shows.
const VESSELS: &str = "cylindric objects";
/// Objects with fewer pixels with depth are not in the truth.
const MIN_VISIBLE_PX: usize = 250;
/// Streams of random numbers of a seed.
const PLACES: u64 = 0;
const SURFACES: u64 = 1;

/// Makes scenes of the tables and objects of other scenes.
pub struct Composer {
    /// Those with a table.
    scenes: Vec<SceneRef>,
    camera: Option<GridCamera>,
    sensor: params::Sensor,
    specimens: Vec<Specimen>,
}

impl Composer {
    /// Learns the objects and tables of `scenes`; `camera` is that of [`SceneRef::load`], `sensor` that of the data set.
    ///
    /// # Errors
    /// Of the scenes that cannot be read, what the first one fails with; [`Error::NothingToCompose`] when no scene has a
    /// table with an object on it that is seen whole.
    pub fn new(scenes: &[SceneRef], camera: Option<GridCamera>, sensor: &params::Sensor) -> Result<Self> {
        let of_scene = |reference: &SceneRef| -> Result<Option<(SceneRef, Vec<Specimen>)>> {
            let scene = reference.load(camera.as_ref())?;
            let space = DisparitySpace::new(scene.frame.camera(), sensor);
            let disparity = space.disparity(scene.frame.depth_m());
            let vessels = mosd::category(&reference.name) == Some(VESSELS);
            Ok(Table::of(&scene, &disparity, &space)
                .map(|table| (reference.clone(), specimens(&scene, &disparity, &space, &table, vessels))))
        };
        let parts = scenes.par_iter().map(of_scene).collect::<Result<Vec<_>>>()?;
        let (scenes, specimens): (Vec<_>, Vec<_>) = parts.into_iter().flatten().unzip();
        let specimens: Vec<Specimen> = specimens.into_iter().flatten().collect();
        if specimens.is_empty() {
            return Err(Error::NothingToCompose);
        }
        Ok(Self { scenes, camera, sensor: sensor.clone(), specimens })
    }

    /// The scene of a seed.
    ///
    /// # Errors
    /// As [`SceneRef::load`] for the scene whose table it is.
    pub fn compose(&self, seed: u64) -> Result<Scene> {
        Ok(self.composition(seed)?.0)
    }

    /// The scene of a seed, the instance of every pixel (0 nothing, 1 the table, 2 + k placement k), and the placements.
    fn composition(&self, seed: u64) -> Result<(Scene, Raster<u16>, Vec<Placement<'_>>)> {
        let mut rng = Rng::new(seed, PLACES);
        let scene = self.scenes[rng.below(self.scenes.len())].load(self.camera.as_ref())?;
        let space = DisparitySpace::new(scene.frame.camera(), &self.sensor);
        let disparity = space.disparity(scene.frame.depth_m());
        let table = Table::of(&scene, &disparity, &space).ok_or(Error::NothingToCompose)?;

        let placed = place(&self.specimens, &table, &mut rng);
        let mut canvas = table.cleared(&scene, &disparity, &space, &mut Rng::new(seed, SURFACES));
        for (object, instance) in placed.iter().zip(TABLE + 1..) {
            canvas.draw(object, instance, table.ground, &space);
        }
        let depth_m = sensor::measured_m(&canvas, self.sensor.disparity_quantum_per_m);
        let (scene, instances) = finished(canvas, depth_m, scene.frame.color().is_some(), placed.len())?;
        Ok((scene, instances, placed))
    }
}

/// Frame and truth, without the objects of which too little is seen.
fn finished(
    canvas: Canvas,
    mut depth_m: Vec<f32>,
    has_color: bool,
    objects: usize,
) -> Result<(Scene, Raster<u16>)> {
    let Canvas { width, camera, color, mut instance, .. } = canvas;
    let mut size_px = vec![0; usize::from(TABLE) + objects + 1];
    for (instance, depth_m) in instance.iter_mut().zip(&depth_m) {
        if depth_m.is_nan() {
            *instance = NOTHING;
        }
        size_px[usize::from(*instance)] += 1;
    }
    for (instance, depth_m) in instance.iter_mut().zip(&mut depth_m) {
        if *instance > TABLE && size_px[usize::from(*instance)] < MIN_VISIBLE_PX {
            (*instance, *depth_m) = (NOTHING, f32::NAN);
        }
    }
    let height = depth_m.len() / width;
    let instances = Raster::from_vec(width, height, instance)?;
    let labels = mosd_labels_of(&instances, |k| k == TABLE, TABLE + 1..=TABLE + objects as u16);
    let color = if has_color { Some(Raster::from_vec(width, height, color)?) } else { None };
    let frame = Frame::new(Raster::from_vec(width, height, depth_m)?, color, camera)?;
    Ok((Scene { frame, truth: mosd::truth_of(&labels)? }, instances))
}
