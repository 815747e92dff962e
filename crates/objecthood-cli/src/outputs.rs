//! The files that are written, and where they go.

pub(crate) mod run;

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use objecthood::{Discovery, Params};
use objecthood_io::output::{npz, ply};
use objecthood_io::scene::SceneFile;
use objecthood_io::{Capture, label_image, point_labels};
use objecthood_view::{Recording, overlay, panels, png};

use crate::args::OutputKind;
use crate::failure::usage;

/// A frame and what was found in it.
pub(crate) struct Found<'a> {
    /// The frame, as the user would name it.
    pub(crate) source: &'a str,
    pub(crate) capture: &'a Capture,
    pub(crate) params: &'a Params,
    pub(crate) discovery: &'a Discovery,
    /// What the panels are drawn from.
    pub(crate) recording: Option<&'a Recording>,
}

impl Found<'_> {
    /// The names and contents of the files of the frame alone: each name is `stem` and a suffix.
    ///
    /// # Errors
    /// When the frame has no such form.
    pub(crate) fn files(&self, kinds: &BTreeSet<OutputKind>, stem: &Path) -> Result<Vec<(PathBuf, Vec<u8>)>> {
        let Self { source, capture, params, discovery, recording } = *self;
        let mut files = Vec::new();
        for kind in kinds {
            let Some(suffix) = kind.suffix() else { continue };
            let bytes = match kind {
                OutputKind::Labels => label_image::encode(&discovery.labels)?,
                OutputKind::Points => {
                    let Some(list) = &capture.list else { continue };
                    point_labels::encode(list, &discovery.labels)
                }
                OutputKind::Json => {
                    SceneFile::new(source, capture, params, discovery).to_json()?.into_bytes()
                }
                OutputKind::Structure => label_image::encode(&discovery.structure)?,
                OutputKind::Overlay => png(&overlay(&capture.frame, &discovery.labels))?,
                OutputKind::Panels => {
                    let Some(recording) = recording else { continue };
                    png(&panels(&capture.frame, recording, discovery))?
                }
                OutputKind::Npz => npz::of_discovery(capture, discovery),
                OutputKind::Ply => ply::of_scene(&capture.frame, discovery),
                OutputKind::PlyObjects => {
                    let clouds = discovery.objects.iter().map(|object| object.id.0).map(|id| {
                        let path = with_suffix(stem, &format!(".object{id}.labels.ply"));
                        (path, ply::of_object(&capture.frame, discovery, id))
                    });
                    files.extend(clouds);
                    continue;
                }
                OutputKind::Coco | OutputKind::Bop | OutputKind::Mcap | OutputKind::Report => continue,
            };
            files.push((with_suffix(stem, suffix), bytes));
        }
        Ok(files)
    }
}

/// A stem and a suffix: `a.b` -> `a.b.json`, which `Path::with_extension` would make `a.json`.
pub(crate) fn with_suffix(stem: &Path, suffix: &str) -> PathBuf {
    let mut name = OsString::from(stem);
    name.push(suffix);
    name.into()
}

/// Refuses a file as folder for outputs, before anything is done.
///
/// # Errors
/// Of usage.
pub(crate) fn refuse_file(option: &str, out: &Path) -> Result<()> {
    if out.exists() && !out.is_dir() {
        return Err(usage(format!("{option} {} is a file: name a folder", out.display())));
    }
    Ok(())
}

/// Makes a folder for outputs, if it is not there.
///
/// # Errors
/// When it cannot be made.
pub(crate) fn make_folder(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder)
        .map_err(|e| anyhow!("cannot make the folder {} ({e}): choose another", folder.display()))
}

/// Makes the folders in which files are to be written, where they are not there.
///
/// # Errors
/// When one cannot be made.
pub(crate) fn make_folders_of(files: &[(PathBuf, Vec<u8>)]) -> Result<()> {
    files.iter().filter_map(|(path, _)| path.parent()).try_for_each(make_folder)
}
