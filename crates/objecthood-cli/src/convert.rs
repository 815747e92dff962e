//! `objecthood convert`: frames of any source -> a folder of TUM or BOP, an MCAP recording, NPZ files.

use std::path::Path;

use anyhow::{Context, Result};
use objecthood_io::output::frames::{BopScene, Rounding, TumFolder};
use objecthood_io::output::mcap::{McapFile, frame_messages};
use objecthood_io::output::{npz, write_atomically};

use crate::args::{CameraArg, ConvertArgs, Target};
use crate::failure::{Outcome, usage};
use crate::inputs::{Input, Inputs};
use crate::outputs::{make_folder, refuse_file, with_suffix};
use crate::words::counted;
use crate::{inputs, interrupt, terminal};

/// Frames without stamps get one as of a camera with this rate (1/s).
const RATE_HZ: i64 = 30;

/// What is written; it grows frame by frame.
enum Sink<'a> {
    Tum(Box<TumFolder>),
    Bop(BopScene),
    Mcap(Box<McapFile>),
    Npz(&'a Path),
}

/// Converts every frame named on the command line.
///
/// # Errors
/// Of usage; when the output cannot be written. A frame that cannot be read is reported, which is no error.
pub(crate) fn run(args: &ConvertArgs) -> Result<Outcome> {
    let camera = args.frames.camera.as_ref().map(CameraArg::read).transpose()?;
    let inputs = inputs::collect(&args.frames, false, camera.as_ref())?;
    refuse_existing(args)?;
    let scope = args.frames.scope.read(args.frames.images.max_pixels)?;
    let Inputs { frames, unreadable, notices, .. } = &inputs;
    notices.iter().for_each(|notice| terminal::note(notice));
    unreadable.iter().for_each(terminal::error);
    interrupt::catch()?;

    let mut sink = Sink::create(args)?;
    let bar = terminal::progress_bar(frames.len(), false);
    let (mut done, mut failed) = (0, unreadable.len());
    let (mut rounding, mut are_stamps_made_up) = (Rounding::default(), false);
    for (number, input) in frames.iter().enumerate().take_while(|_| !interrupt::is_asked()) {
        let capture = args.frames.read(input, &scope);
        let added = capture.and_then(|capture| {
            are_stamps_made_up |= capture.stamp_ns.is_none();
            let stamp_ns = capture.stamp_ns.unwrap_or(number as i64 * 1_000_000_000 / RATE_HZ);
            sink.add(input, stamp_ns, &capture).with_context(|| input.path.display().to_string())
        });
        match added {
            Ok(of_frame) => (done, rounding) = (done + 1, rounding.and(of_frame)),
            Err(error) => {
                failed += 1;
                bar.suspend(|| terminal::error(&error));
            }
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    sink.finish()?;
    tell(args, rounding, are_stamps_made_up);
    terminal::print(&format!("{} -> {}\n", counted(done, "frame"), args.out.display()))?;
    Ok(match (done + failed < frames.len() + unreadable.len(), failed) {
        (true, _) => Outcome::Interrupted,
        (false, 0) => Outcome::AllDone,
        (false, _) => Outcome::SomeFailed,
    })
}

/// Refuses to write where something is: the frames of two inputs would mix, and an input might be lost.
///
/// # Errors
/// Of usage.
fn refuse_existing(args: &ConvertArgs) -> Result<()> {
    let out = &args.out;
    if args.to != Target::Mcap {
        refuse_file("--out", out)?;
    }
    let is_empty = || out.is_dir() && out.read_dir().is_ok_and(|mut entries| entries.next().is_none());
    if out.exists() && (args.to == Target::Mcap || !is_empty()) {
        return Err(usage(format!("--out {} is there already: name a new one", out.display())));
    }
    Ok(())
}

/// What the user should know of the result.
fn tell(args: &ConvertArgs, Rounding { error_m, lost_px }: Rounding, are_stamps_made_up: bool) {
    if error_m > 0.0 {
        let most_mm = 1000.0 * error_m;
        terminal::note(&format!(
            "depth was rounded by {}: --to mcap and --to npz keep it whole",
            if most_mm < 0.001 {
                "less than 0.001 mm".to_owned()
            } else {
                format!("at most {most_mm:.3} mm")
            }
        ));
    }
    if lost_px > 0 {
        terminal::note(&format!(
            "{lost_px} pixels are too far for 16 bits and have no depth now: --to mcap and --to npz keep them"
        ));
    }
    if are_stamps_made_up && matches!(args.to, Target::Tum | Target::Mcap) {
        terminal::note(&format!(
            "frames without stamps got some as of a camera with {RATE_HZ} frames a second"
        ));
    }
}

impl<'a> Sink<'a> {
    fn create(args: &'a ConvertArgs) -> Result<Self> {
        Ok(match args.to {
            Target::Tum => Self::Tum(Box::new(TumFolder::create(&args.out)?)),
            Target::Bop => Self::Bop(BopScene::create(&args.out)?),
            Target::Mcap => Self::Mcap(Box::new(McapFile::create(&args.out)?)),
            Target::Npz => {
                make_folder(&args.out)?;
                Self::Npz(&args.out)
            }
        })
    }

    fn add(&mut self, input: &Input, stamp_ns: i64, capture: &objecthood_io::Capture) -> Result<Rounding> {
        match self {
            Self::Tum(folder) => return Ok(folder.add(stamp_ns, capture)?),
            Self::Bop(scene) => return Ok(scene.add(capture)?),
            Self::Mcap(file) => file.add(&frame_messages(stamp_ns, capture))?,
            Self::Npz(folder) => {
                write_atomically(&with_suffix(&folder.join(&input.name), ".npz"), &npz::of_capture(capture))?;
            }
        }
        Ok(Rounding::default())
    }

    fn finish(self) -> Result<()> {
        match self {
            Self::Tum(folder) => folder.finish()?,
            Self::Bop(scene) => scene.finish()?,
            Self::Mcap(file) => file.finish()?,
            Self::Npz(_) => {}
        }
        Ok(())
    }
}
