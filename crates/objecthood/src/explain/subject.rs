//! What questions are about: a frame, the parameters, and one run of the method with them.

use std::sync::{Arc, OnceLock};

use crate::explain::run::Run;
use crate::explain::sweep::Sweep;
use crate::frame::Frame;
use crate::params::Params;
use crate::pipeline::Pipeline;
use crate::surface::surfaces::Surfaces;

/// A frame that the method looked at, and what came of it.
pub(super) struct Subject {
    /// Looked at the frame last; other parameters are tried on clones, which share what these do not reach.
    pub(super) pipeline: Pipeline,
    pub(super) frame: Frame,
    pub(super) params: Params,
    pub(super) surfaces: Arc<Surfaces>,
    pub(super) run: Run,
    /// What votes would do with other parameters, once it was asked for.
    pub(super) sweep: OnceLock<Sweep>,
}
