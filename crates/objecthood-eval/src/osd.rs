//! The Object Segmentation Database as it is published: OSD-0.2 and OSD-0.2-depth.
//!
//! `image_color/`, `annotation/`, and `pcd/` or `disparity/` hold a file of the same name for each scene. Label 0 is no object. Images in
//! `disparity/` are depth in millimetres, in spite of the name. The splits are the beginnings of the names: learn, test.
//!
//! Source: A. Richtsfeld, 2012; how UOIS and `UnseenObjectClustering` of NVIDIA read it.

use std::path::Path;

use crate::dataset::{Layout, SceneRef, list, text};
use crate::error::Result;

/// The scenes under `root`; none if it has another layout.
pub(crate) fn list_scenes(root: &Path) -> Result<Vec<SceneRef>> {
    let folder = |name: &str| Some(root.join(name)).filter(|folder| folder.is_dir());
    let (Some(truth), Some(color)) = (folder("annotation"), folder("image_color")) else {
        return Ok(Vec::new());
    };
    let cloud = folder("pcd");
    let Some(depth) = cloud.clone().or_else(|| folder("disparity")) else { return Ok(Vec::new()) };
    let scene = |path: &Path| {
        let name = text(path.file_stem());
        let (path, color) = match cloud {
            Some(_) => (depth.join(format!("{name}.pcd")), None),
            None => (depth.join(format!("{name}.png")), Some(color.join(format!("{name}.png")))),
        };
        let folder = name.trim_end_matches(|c: char| c.is_ascii_digit()).to_owned();
        let layout = Layout::Painted { color, truth: truth.join(format!("{name}.png")), background: 0 };
        SceneRef { name, folder, path, layout }
    };
    let is_png = |path: &&std::path::PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
    Ok(list(&truth)?.iter().filter(is_png).map(|path| scene(path)).collect())
}
