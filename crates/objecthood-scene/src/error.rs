//! What can be wrong with what was asked for.

use std::fmt::Display;

/// Result with this crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// Why there is no such scene or picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Not the name of a family of scenes.
    #[error("`{name}` is not a family of scenes: choose {known}")]
    UnknownFamily {
        /// What was given.
        name: String,
        /// What there is.
        known: String,
    },
    /// Not the name of a sensor.
    #[error("`{name}` is not a sensor: choose {known}")]
    UnknownSensor {
        /// What was given.
        name: String,
        /// What there is.
        known: String,
    },
    /// Not the name of a kind of holes.
    #[error("`{name}` is no kind of holes: choose {known}")]
    UnknownHoles {
        /// What was given.
        name: String,
        /// What there is.
        known: String,
    },
    /// Not the name of a kind of videos.
    #[error("`{name}` is not a kind of videos: choose {known}")]
    UnknownClip {
        /// What was given.
        name: String,
        /// What there is.
        known: String,
    },
    /// A frame rate that no video has.
    #[error("{fps} frames a second is too slow or too fast: choose {least} to {most}")]
    FrameRate {
        /// What was asked for (Hz).
        fps: f64,
        /// The slowest there is (Hz).
        least: f64,
        /// The fastest there is (Hz).
        most: f64,
    },
    /// A clip that was drawn many times and never came out as its kind is to be.
    #[error("no clip of the kind {clip} came out of seed {seed}: try another seed")]
    NoClip {
        /// The kind.
        clip: crate::video::Clip,
        /// The seed.
        seed: u64,
    },
    /// A camera that is nowhere near the scene.
    #[error("a camera at {origin_m:?} m sees nothing of the scene: put it within 1000 m along every axis")]
    FarAway {
        /// Where it is.
        origin_m: [f64; 3],
    },
    /// The picture is no frame.
    #[error(transparent)]
    Frame(#[from] objecthood::Error),
    /// The picture has no such file form.
    #[error(transparent)]
    Write(#[from] objecthood_io::Error),
    /// An image without a PNG form.
    #[error("the image has no PNG form ({reason}): this is a mistake in objecthood, please report it")]
    Png {
        /// What the encoder says.
        reason: String,
    },
    /// A scene without a JSON form.
    #[error("the scene has no JSON form ({reason}): this is a mistake in objecthood, please report it")]
    Json {
        /// What is wrong.
        reason: serde_json::Error,
    },
}

/// `a, b or c`.
pub(crate) fn choices<T: Display>(all: impl IntoIterator<Item = T>) -> String {
    let names: Vec<String> = all.into_iter().map(|name| name.to_string()).collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => names.concat(),
    }
}
