//! The drawing of what stands on what.

pub(crate) mod forest;
mod layout;
mod legend;
pub(crate) mod tree;
