//! Whether memory grows from frame to frame.

use anyhow::{Context, Result};
use objecthood::{Frame, Method, Params, Pipeline};

/// Frames after which memory is looked at first: by then everything that is kept is there.
pub const WARM_FRAMES: usize = 100;

/// Resident memory (MB, 10^6 bytes) after [`WARM_FRAMES`] and after `count` runs over the frames in turn.
///
/// # Errors
/// When a method refuses a frame, or the system does not say how much memory there is.
pub fn growth(frames: &[Frame], method: Method, count: usize) -> Result<[f64; 2]> {
    let params = Params { method, ..Params::default() };
    let (mut pipeline, mut warm) = (Pipeline::default(), 0.0);
    for (k, frame) in frames.iter().cycle().take(count).enumerate() {
        pipeline.forget();
        std::hint::black_box(pipeline.discover(frame, &params)?);
        if k + 1 == WARM_FRAMES.min(count) {
            warm = resident_mb()?;
        }
    }
    Ok([warm, resident_mb()?])
}

/// `VmRSS` of this process in MB.
fn resident_mb() -> Result<f64> {
    let status =
        std::fs::read_to_string("/proc/self/status").context("resident memory is read on Linux only")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).context("no VmRSS")?;
    let kib: f64 = line.trim().trim_end_matches(" kB").parse().context("VmRSS is no number")?;
    Ok(kib * 1024.0 / 1e6)
}
