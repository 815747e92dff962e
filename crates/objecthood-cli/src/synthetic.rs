//! Synthetic scenes as files: what `synth` and `demo` have in common.

use std::path::{Path, PathBuf};

use anyhow::Result;
use objecthood_scene::{Family, Rendered, Sensor, World, export, generate, render};

/// A scene that can be made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Recipe {
    pub(crate) family: Family,
    pub(crate) seed: u64,
    pub(crate) sensor: Sensor,
}

impl Recipe {
    /// What its files are called: unique among scenes of one sensor.
    pub(crate) fn name(&self) -> String {
        format!("{}{}", self.family, self.seed)
    }

    /// Makes the scene and takes its picture.
    ///
    /// # Errors
    /// When the picture has no such file form.
    pub(crate) fn make(self) -> Result<Made> {
        let world = generate(self.family, self.seed);
        let rendered = render(&world, self.sensor)?;
        let (color_png, depth_png) =
            (export::color_png(&rendered.frame)?, export::depth_png(&rendered.frame)?);
        Ok(Made { recipe: self, world, rendered, color_png, depth_png })
    }
}

/// A number of scenes, seeds ascending: of one family, or each family in turn.
pub(crate) fn recipes(family: Option<Family>, sensor: Sensor, seed: u32, scenes: u32) -> Vec<Recipe> {
    let families = Family::ALL.into_iter().cycle();
    let recipe = |(of_turn, k): (Family, u32)| Recipe {
        family: family.unwrap_or(of_turn),
        seed: u64::from(seed) + u64::from(k),
        sensor,
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
