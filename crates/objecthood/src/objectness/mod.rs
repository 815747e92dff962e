//! Stage 4: which shapes are objects, by size and by what supports them (paper, III-D).
//!
//! `paper`: [`gravity`], [`support`], [`size`], [`decision`]. `context` first lets the surroundings of shapes tell what is one object:
//! fragments, what hardly rises above the support, vessels, and surfaces that go on behind something nearer ([`join`]). Each rule
//! is a list of [`check`]s, and what it did is the [`history`] of the clusters. What stands on what is then its [`forest`]; what
//! speaks for each [`hypotheses`](hypotheses::hypotheses) is the same for both.

mod body;
mod bottoms;
mod cell;
pub mod check;
pub mod clustering;
mod clusters;
pub mod compactness;
pub(crate) mod conclusion;
pub mod decision;
mod feet;
pub mod forest;
mod fragments;
pub mod gravity;
mod height;
pub mod history;
pub mod hypotheses;
pub mod join;
mod meeting;
pub mod objects;
mod occlusion;
pub(crate) mod outcome;
pub mod outline;
pub mod parts;
mod piece;
mod plan;
mod rim;
pub mod size;
mod spread;
pub(crate) mod standing;
pub mod support;
#[cfg(test)]
mod testing;
mod vessels;

pub(crate) use clusters::fill;
pub use clusters::{Scene, Steps};
pub(crate) use fragments::small;
pub(crate) use outcome::too_small;
