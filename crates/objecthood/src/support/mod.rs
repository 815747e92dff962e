//! Gravity, and what stands on what (paper, III-D, eq. 6 to 8).

mod body;
pub mod by_height;
mod cell;
mod feet;
pub mod forest;
pub mod gravity;
mod meeting;
mod piece;
mod plan;
pub mod standing;
