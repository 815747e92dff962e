//! Clusters: shapes are joined to things by their surroundings (`context`, first half of stage 4).
//!
//! Every shape begins as a cluster. The [`rules`] join clusters or give them to the background: fragments, height, vessels, bottoms,
//! occlusion. A rule decides by [`check`]s. The [`history`] records its joins and its refusals. The clusters that remain and are
//! large enough are candidates for objects.

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
