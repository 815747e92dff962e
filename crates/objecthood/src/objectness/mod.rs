//! Stage 4: which shapes are objects, by size and by what supports them (paper, III-D).

pub mod decision;
pub mod gravity;
pub mod objects;
pub mod size;
pub mod support;
