//! What joins shapes (`context`): the surroundings of a shape tell what is one object.
//!
//! A cluster is a shape on its way to an object. The rules, in their order: [`fragments`], what hardly rises above the support
//! ([`height`]), [`vessels`], [`bottoms`], [`occlusion`]. Each rule is a list of [`check`]s, and what it did is the [`history`].

pub(crate) mod borders;
pub(crate) mod bottoms;
pub(crate) mod candidates;
pub mod check;
pub(crate) mod cluster;
pub mod clustering;
mod convexity;
pub mod fill;
pub(crate) mod fragments;
pub(crate) mod height;
pub mod history;
pub(crate) mod occlusion;
mod rim;
pub mod rules;
pub mod scene;
pub mod steps;
#[cfg(test)]
pub(crate) mod testing;
pub(crate) mod vessels;
