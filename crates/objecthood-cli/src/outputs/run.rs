//! The files of a run, to which every frame adds.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::Result;
use objecthood::{Camera, Discovery, Params};
use objecthood_io::Capture;
use objecthood_io::output::Growing;
use objecthood_io::output::bop::{BopLists, ImageId, RESULTS};
use objecthood_io::output::coco::CocoFile;
use objecthood_io::output::instances::{self, Instance};
use objecthood_io::output::mcap::{McapFile, Message, found_messages};
use objecthood_page::{Page, Report};

use super::make_folder;
use crate::args::OutputKind;
use crate::shell::words_of_frames;

/// Frames without stamps get one as of a camera with this rate (1/s), which is common.
const RATE_HZ: i64 = 30;

/// The folder of the BOP layout.
pub(crate) const BOP: &str = "bop";

/// Where the file of the run is of which a kind consists, below the folder for outputs. `None` of kinds of files that every frame has.
pub(crate) fn path_of(out: &Path, kind: OutputKind) -> Option<PathBuf> {
    match kind {
        OutputKind::Coco => Some(out.join("instances.coco.json")),
        OutputKind::Bop => Some(out.join(BOP).join(RESULTS)),
        OutputKind::Mcap => Some(out.join("objects.labels.mcap")),
        OutputKind::Report => Some(out.join("report.html")),
        _ => None,
    }
}

/// Which frame of the run it is.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    /// Its number, from 0.
    pub(crate) number: usize,
    /// Its numbers in the BOP layout.
    pub(crate) id: ImageId,
    /// The name of its image, the colour image if it has one.
    pub(crate) image_name: String,
}

/// What a frame adds.
pub(crate) struct Share {
    place: Place,
    size: (usize, usize),
    camera: Camera,
    found: Vec<Instance>,
    messages: Vec<Message>,
    /// Its part of the report.
    pub(crate) page: Option<Page>,
}

impl Share {
    /// What a frame adds to files of these kinds; `None` if there are none.
    pub(crate) fn of(
        kinds: &BTreeSet<OutputKind>,
        place: &Place,
        capture: &Capture,
        discovery: &Discovery,
    ) -> Option<Self> {
        if !kinds.iter().any(|kind| kind.is_of_run()) {
            return None;
        }
        let frame = &capture.frame;
        let found = instances::of_discovery(frame, discovery);
        let stamp_ns = capture.stamp_ns.unwrap_or(place.number as i64 * 1_000_000_000 / RATE_HZ);
        let messages = if kinds.contains(&OutputKind::Mcap) {
            found_messages(stamp_ns, frame, discovery, &found)
        } else {
            Vec::new()
        };
        Some(Self {
            place: place.clone(),
            size: frame.size(),
            camera: frame.camera(),
            found,
            messages,
            page: None,
        })
    }

    /// The objects of the frame.
    pub(crate) fn found(&self) -> &[Instance] {
        &self.found
    }
}

/// The files of a run. None of them is there before [`RunFiles::finish`].
pub(crate) struct RunFiles {
    coco: Option<CocoFile>,
    bop: Option<BopLists>,
    mcap: Option<McapFile>,
    report: Option<Report>,
    paths: Vec<PathBuf>,
}

impl RunFiles {
    /// Begins those of these kinds in a folder that is there; `params` and the words of the command line are for the report.
    ///
    /// # Errors
    /// When one cannot be written.
    pub(crate) fn create(out: &Path, kinds: &BTreeSet<OutputKind>, params: &Params) -> Result<Self> {
        let path = |kind| kinds.get(&kind).and_then(|&kind| path_of(out, kind));
        if kinds.contains(&OutputKind::Bop) {
            make_folder(&out.join(BOP))?;
        }
        let coco = path(OutputKind::Coco).map(|path| CocoFile::create(&path)).transpose()?;
        let bop = path(OutputKind::Bop).map(|_| BopLists::create(&out.join(BOP))).transpose()?;
        let mcap = path(OutputKind::Mcap).map(|path| McapFile::create(&path)).transpose()?;
        let begin = |path: PathBuf| -> Result<Report> {
            let words = words_of_frames("segment");
            Ok(Report::begin(Growing::create(&path)?, words, params)?)
        };
        let report = path(OutputKind::Report).map(begin).transpose()?;
        Ok(Self {
            coco,
            bop,
            mcap,
            report,
            paths: kinds.iter().filter_map(|&kind| path_of(out, kind)).collect(),
        })
    }

    /// Adds what a frame has.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub(crate) fn add(&mut self, share: &Share) -> Result<()> {
        let Share { place, size, camera, found, messages, page } = share;
        if let Some(coco) = &mut self.coco {
            coco.add(&place.image_name, *size, found)?;
        }
        if let Some(bop) = &mut self.bop {
            bop.add(place.id, *camera, found)?;
        }
        if let Some(mcap) = &mut self.mcap {
            mcap.add(messages)?;
        }
        if let (Some(report), Some(page)) = (&mut self.report, page) {
            report.add(page)?;
        }
        Ok(())
    }

    /// Ends the files, which take their names: where they are.
    ///
    /// # Errors
    /// When one cannot be written.
    pub(crate) fn finish(self) -> Result<Vec<PathBuf>> {
        let Self { coco, bop, mcap, report, paths } = self;
        coco.map(CocoFile::finish).transpose()?;
        bop.map(BopLists::finish).transpose()?;
        mcap.map(McapFile::finish).transpose()?;
        report.map(Report::finish).transpose()?;
        Ok(paths)
    }
}
