//! A stream of frames.

use crate::buffers::Keeper;
use crate::discovery::Discovery;
use crate::error::Result;
use crate::frame::Frame;
use crate::method;
use crate::observe::Observer;
use crate::params::{Method, Params};

/// Keeps the memory of images from one frame to the next, which saves about a tenth of the time.
///
/// What is found never depends on what was looked at before.
///
/// ```
/// # use objecthood::{Camera, Frame, Params, Raster, Workspace};
/// # let camera = Camera::new(52.5, 52.5, 31.5, 23.5)?;
/// # let stream = vec![Frame::new(Raster::filled(64, 48, 1.2)?, None, camera)?];
/// let mut workspace = Workspace::default();
/// for frame in stream {
///     let found = workspace.discover(&frame, &Params::default())?;
///     assert!(found.objects.is_empty());
/// }
/// # Ok::<(), objecthood::Error>(())
/// ```
#[derive(Debug, Default)]
pub struct Workspace {
    _keeper: Keeper,
}

impl Workspace {
    /// As [`discover`](crate::discover).
    ///
    /// # Errors
    /// As [`discover`](crate::discover).
    pub fn discover(&mut self, frame: &Frame, params: &Params) -> Result<Discovery> {
        self.discover_observed(frame, params, &mut ())
    }

    /// As [`discover_observed`](crate::discover_observed).
    ///
    /// # Errors
    /// As [`discover`](crate::discover).
    pub fn discover_observed(
        &mut self,
        frame: &Frame,
        params: &Params,
        observer: &mut dyn Observer,
    ) -> Result<Discovery> {
        params.validate()?;
        match params.method {
            Method::Paper => method::paper(frame, params, observer),
            Method::Context => method::context(frame, params, observer),
        }
    }
}
