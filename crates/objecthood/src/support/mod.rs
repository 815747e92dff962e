//! Support: the direction up and the support graph (paper, III-D, eq. 6 to 8).
//!
//! `paper`: [`by_height`]. `context`: the [`forest`], from bodies described against gravity, their feet and their meetings.

mod acyclic;
mod body;
pub mod by_height;
mod cell;
mod feet;
pub mod forest;
pub mod gravity;
mod meeting;
pub mod paper;
mod pixel_block;
mod plan;
pub mod scene;
pub mod standing;
