//! What can go wrong between a browser and the method.

/// The result of an operation of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What went wrong. The text is shown on the page.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No connections can be accepted at the address.
    #[error("cannot listen on 127.0.0.1:{port} ({reason}): choose another port")]
    Listen {
        /// The port that was asked for.
        port: u16,
        /// What the system says.
        reason: std::io::Error,
    },
    /// The system gives no random numbers, so that the address would be no secret.
    #[error("the system gives no random numbers ({0})")]
    NoRandom(getrandom::Error),
    /// A frame that is not there.
    #[error("there is no frame {frame}: the frames are 0 to {last}")]
    NoFrame {
        /// The frame that was asked for.
        frame: usize,
        /// The last one.
        last: usize,
    },
    /// A frame that cannot be read.
    #[error("{0}")]
    Unreadable(String),
    /// A parameter that does not exist, or does not take the value.
    #[error("{name}: {why}")]
    Parameter {
        /// Its name.
        name: String,
        /// What is wrong with it.
        why: String,
    },
    /// A map that does not exist.
    #[error("there is no map `{0}`")]
    NoMap(String),
    /// The method fails.
    #[error(transparent)]
    Method(#[from] objecthood::Error),
    /// Objects cannot be followed into the frame.
    #[error(transparent)]
    Track(#[from] objecthood_track::Error),
    /// A frame of a video that is too long for the page.
    #[error("the page follows objects through the first {most} frames: `objecthood track` takes any number")]
    TooLong {
        /// Frames that are followed.
        most: usize,
    },
    /// The truth cannot be compared.
    #[error(transparent)]
    Truth(#[from] objecthood_eval::Error),
    /// Something has no form that can be sent.
    #[error(transparent)]
    Form(#[from] objecthood_io::Error),
    /// A picture cannot be compressed.
    #[error("a picture cannot be compressed: {0}")]
    Picture(#[from] image::ImageError),
    /// Bytes cannot be compressed.
    #[error("what a frame shows cannot be compressed: {0}")]
    Deflate(#[from] std::io::Error),
    /// Something has no JSON form.
    #[error("no JSON form: {0}")]
    Json(#[from] serde_json::Error),
}
