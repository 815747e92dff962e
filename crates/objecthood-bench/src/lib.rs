//! What objecthood costs, for `cargo xtask bench`.
//!
//! The program `measure` takes times and counts allocations and writes a line for every figure ([`figure`]). `cargo bench -p objecthood-bench` times single kernels.

pub mod figure;
pub mod graph;
pub mod growth;
pub mod laps;
pub mod normals;
pub mod peer;
pub mod reading;
pub mod recomputed;
pub mod scenes;
pub mod times;
pub mod track;
