//! Objectness: which regions are objects, by size, support and the look of their borders (paper, III-D).
//!
//! [`hypotheses`] judges every region by its parts: [`size`], support, [`compactness`], and the [`outline`] for separation and
//! visibility. [`decision`] keeps those that are objects, [`objects`] numbers and describes them.

pub mod compactness;
pub mod conclusion;
pub mod decision;
pub mod hypotheses;
pub mod objects;
pub mod outline;
pub mod size;
