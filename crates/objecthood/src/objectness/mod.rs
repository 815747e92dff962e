//! Objectness: decides which regions are objects, by their size, support and borders (paper, III-D).
//!
//! [`hypotheses`] rates every region in five parts: [`size`], support, [`compactness`], and from the [`outline`] separation and
//! visibility. [`decision`] keeps the hypotheses that are objects, [`objects`] numbers and describes them.

pub mod compactness;
pub mod conclusion;
pub mod decision;
pub mod hypotheses;
pub mod objects;
pub mod outline;
pub mod size;
