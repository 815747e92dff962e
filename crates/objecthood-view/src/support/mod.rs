//! The drawing of what stands on what.

pub(crate) mod forest;
mod layout;
pub(crate) mod tree;
