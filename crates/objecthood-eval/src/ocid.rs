//! The Object Clutter Indoor Dataset: sequences of tables and floors on which things are put one after the other.
//!
//! `ARID20/table/top/seq05/` and the like hold `rgb/`, `label/` and `pcd/` with a file of the same name for each view. Labels 0 and 1 are no
//! objects, on tables 2 neither: the table. The splits are the first folders: ARID10, ARID20, YCB10.
//!
//! Source: M. Suchi et al., ICRA 2019; how `UnseenObjectClustering` of NVIDIA reads it.

use std::path::Path;

use crate::dataset::{Layout, SceneRef, folders_below, list, text, way};
use crate::error::Result;

/// The scenes under `root`; none if it has another layout.
pub(crate) fn list_scenes(root: &Path) -> Result<Vec<SceneRef>> {
    let is_sequence = |folder: &Path| ["rgb", "label", "pcd"].iter().all(|part| folder.join(part).is_dir());
    let mut scenes = Vec::new();
    for folder in folders_below(root, is_sequence)? {
        let way = way(root, &folder);
        let background = if way.iter().any(|part| part == "table") { 2 } else { 1 };
        for truth in list(&folder.join("label"))? {
            let stem = text(truth.file_stem());
            let path = folder.join("pcd").join(format!("{stem}.pcd"));
            let name = way.iter().chain([&stem]).cloned().collect::<Vec<_>>().join("-");
            let folder = way.first().cloned().unwrap_or_default();
            scenes.push(SceneRef {
                name,
                folder,
                path,
                layout: Layout::Painted { color: None, truth, background },
            });
        }
    }
    Ok(scenes)
}
