//! Saves a tracker to a file, so that a stopped run can continue.

use objecthood::{Estimates, Noise, Params};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::error::{Error, Result};
use crate::memory::Memory;
use crate::numbering::Numbering;
use crate::tracker::Tracker;

/// The beginning of a state. The number changes with what the tracker remembers.
const HEAD: &[u8] = b"objecthood tracker, state 16\n";
/// Bytes of the checksum that follows.
const SUM: usize = 32;

/// What is saved. The estimates of noise and up are saved by their parts.
#[derive(Serialize, Deserialize)]
struct State<M> {
    version: String,
    noise: Option<(f64, [f64; 3], u32)>,
    up: Option<[f32; 3]>,
    numbering: Numbering,
    memory: M,
}

impl Tracker {
    /// Everything that the tracker remembers, but not its parameters. It has about 25 bytes a pixel, and 20
    /// kB and at most 1 MB of surface a track, however long the video is.
    ///
    /// # Errors
    /// [`Error::Save`] if the state cannot be written.
    pub fn save(&self) -> Result<Vec<u8>> {
        let noise = self.estimates.map(|e| (e.noise.white, e.noise.blocks_quanta, e.frames));
        let up = self.estimates.and_then(|e| e.up);
        let (version, numbering) = (env!("CARGO_PKG_VERSION").to_owned(), self.numbering.clone());
        let body = postcard::to_stdvec(&State { version, noise, up, numbering, memory: &self.memory });
        let body = body.map_err(|e| Error::Save { reason: e.to_string() })?;
        Ok([HEAD, Sha256::digest(&body).as_slice(), &body].concat())
    }

    /// A tracker that continues from a state that [`Self::save`] wrote. With the same parameters it gives the
    /// same results for the next frames as the saved one would have.
    ///
    /// # Errors
    /// [`Error::State`] if the bytes are not a complete state of this version.
    pub fn restore(params: Params, bytes: &[u8]) -> Result<Self> {
        let broken = |reason: &str| Error::State { reason: reason.to_owned() };
        let rest = bytes.strip_prefix(HEAD).ok_or_else(|| broken("it is none, or of another version"))?;
        let (sum, body) = rest.split_at_checked(SUM).ok_or_else(|| broken("its end is missing"))?;
        if Sha256::digest(body).as_slice() != sum {
            return Err(broken("it was damaged or cut off"));
        }
        let state: State<Option<Memory>> =
            postcard::from_bytes(body).map_err(|e| broken(&format!("it cannot be read: {e}")))?;
        if state.version != env!("CARGO_PKG_VERSION") {
            return Err(broken(&format!("it is of version {}", state.version)));
        }
        let mut tracker = Self::new(params);
        tracker.without = state.memory.as_ref().map(|memory| memory.without.clone()).unwrap_or_default();
        (tracker.memory, tracker.numbering) = (state.memory, state.numbering);
        tracker.estimates = state.noise.map(|(white, blocks_quanta, frames)| {
            let mut estimates = Estimates::of_noise(Noise { white, blocks_quanta }, frames);
            estimates.up = state.up;
            estimates
        });
        Ok(tracker)
    }
}
