//! Which shapes are objects: by size and by what supports them (paper, III-D).

pub mod compactness;
pub mod conclusion;
pub mod decision;
pub mod hypotheses;
pub mod objects;
pub mod outline;
pub mod size;
