//! The subject of questions: a frame, the parameters, and one run of the method with them.

use std::sync::{Arc, OnceLock};

use crate::explain::run::Run;
use crate::explain::sweep::Sweep;
use crate::frame::Frame;
use crate::params::Params;
use crate::pipeline::Pipeline;
use crate::surface::surfaces::Surfaces;

/// A frame, the parameters, and the outputs of the method.
pub(super) struct Subject {
    /// Holds the outputs for the frame. Other parameters are tried on clones, which share the outputs that do not change.
    pub(super) pipeline: Pipeline,
    pub(super) frame: Frame,
    pub(super) params: Params,
    pub(super) surfaces: Arc<Surfaces>,
    pub(super) run: Run,
    /// The shapes with other parameters; computed on first use.
    pub(super) sweep: OnceLock<Sweep>,
}
