//! Synthetic scenes as files: what `synth`, `demo` and `eval` have in common.

use std::path::{Path, PathBuf};

use anyhow::Result;
use objecthood_eval::{Truth, mosd};
use objecthood_io::camera_file::{self as camera_files, CameraFile};
use objecthood_io::images::decode_images;
use objecthood_io::{Capture, Given};
use objecthood_scene::{Exposure, Family, Holes, Rendered, Sensor, World, export, generate};

/// A scene that can be made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Recipe {
    pub(crate) family: Family,
    pub(crate) seed: u64,
    pub(crate) sensor: Sensor,
    pub(crate) holes: Holes,
    /// Columns and rows, if they are not those of the family's camera.
    pub(crate) size_px: Option<(usize, usize)>,
}

impl Recipe {
    /// A scene as its family has it.
    pub(crate) fn new(family: Family, seed: u64, sensor: Sensor) -> Self {
        Self { family, seed, sensor, holes: Holes::None, size_px: None }
    }

    /// The scene, before a picture of it is taken.
    ///
    /// # Errors
    /// When there is no image of this size.
    pub(crate) fn world(&self) -> Result<World> {
        let world = generate(self.family, self.seed);
        Ok(match self.size_px {
            Some(size_px) => world.at_size(size_px)?,
            None => world,
        })
    }

    /// What its files are called: unique among scenes of one sensor.
    pub(crate) fn name(&self) -> String {
        format!("{}{}", self.family, self.seed)
    }

    /// Makes the scene and takes its picture.
    ///
    /// # Errors
    /// When the picture has no such file form.
    pub(crate) fn make(self) -> Result<Made> {
        let world = self.world()?;
        let rendered = Exposure::of(&world)?.seen_by(self.sensor, self.holes)?;
        Made::of(self, world, rendered)
    }
}

/// A number of scenes like `first`, seeds ascending from its own: of one family, or each family of tables in turn.
pub(crate) fn recipes(family: Option<Family>, first: Recipe, scenes: u32) -> Vec<Recipe> {
    let families = Family::TABLES.into_iter().cycle();
    let recipe = |(of_turn, k): (Family, u32)| Recipe {
        family: family.unwrap_or(of_turn),
        seed: first.seed + u64::from(k),
        ..first
    };
    families.zip(0..scenes).map(recipe).collect()
}

/// A scene and its picture.
pub(crate) struct Made {
    pub(crate) recipe: Recipe,
    pub(crate) world: World,
    pub(crate) rendered: Rendered,
    pub(crate) color_png: Vec<u8>,
    pub(crate) depth_png: Vec<u8>,
}

impl Made {
    /// A picture that was taken.
    ///
    /// # Errors
    /// When it has no such file form.
    pub(crate) fn of(recipe: Recipe, world: World, rendered: Rendered) -> Result<Self> {
        let (color_png, depth_png) =
            (export::color_png(&rendered.frame)?, export::depth_png(&rendered.frame)?);
        Ok(Self { recipe, world, rendered, color_png, depth_png })
    }

    /// Every file of the scene but for that of the camera, in `folder`.
    ///
    /// # Errors
    /// When the scene has no such form.
    pub(crate) fn into_files(self, folder: &Path) -> Result<Vec<(PathBuf, Vec<u8>)>> {
        let Self { recipe, world, rendered, color_png, depth_png } = self;
        let name = recipe.name();
        let scene = export::scene_json(recipe.family, recipe.sensor, &world, &rendered)?;
        Ok(vec![
            (color_path(folder, &name), color_png),
            (depth_path(folder, &name), depth_png),
            (folder.join(format!("{name}-truth.png")), export::truth_png(&rendered)?),
            (folder.join(format!("{name}-surfaces.png")), export::surfaces_png(&rendered)?),
            (folder.join(format!("{name}-scene.json")), scene.into_bytes()),
            (
                folder.join(recipe.family.name()).join(format!("{name}.pcd")),
                export::pcd(&world, &rendered, false),
            ),
        ])
    }
}

/// A synthetic scene as it is read back from its files, and the truth about it.
pub(crate) struct Shot {
    pub(crate) made: Made,
    pub(crate) capture: Capture,
    pub(crate) truth: Truth,
}

impl Shot {
    /// # Errors
    /// When the files cannot be read, which is a mistake of this program.
    pub(crate) fn of(made: Made) -> Result<Self> {
        let CameraFile { camera, depth_scale } =
            camera_files::parse(export::camera_json(&made.world)?.as_bytes())?;
        let given = Given { camera: Some(camera), depth_scale, ..Given::default() };
        let capture = decode_images(Some(&made.color_png), &made.depth_png, &given)?;
        let truth = mosd::truth_of(&export::mosd_labels(&made.world, &made.rendered, false))?;
        Ok(Self { made, capture, truth })
    }
}

/// Where the colour image of a scene is, or with `*` for its name those of all.
pub(crate) fn color_path(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}-color.png"))
}

/// Where the depth image of a scene is, or with `*` for its name those of all.
pub(crate) fn depth_path(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}-depth.png"))
}

/// The file of the camera, which all scenes of a folder have in common.
///
/// # Errors
/// When it has no such form.
pub(crate) fn camera_file(world: &World, folder: &Path) -> Result<(PathBuf, Vec<u8>)> {
    Ok((camera_path(folder), export::camera_json(world)?.into_bytes()))
}

/// Where the camera's file is.
pub(crate) fn camera_path(folder: &Path) -> PathBuf {
    folder.join("camera.json")
}
