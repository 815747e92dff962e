//! The native half of the Python package `objecthood`: NumPy arrays in, NumPy arrays out. What Python people see is in
//! `python/objecthood`; it checks arrays and makes columns of what this module returns.
//!
//! Every long call releases the interpreter, and Ctrl-C ends it (`run.rs`). All classes are frozen; what changes lies
//! behind a lock that is taken without the interpreter.

mod arrays;
mod capture;
mod errors;
mod estimates;
mod found;
mod parameters;
mod pipeline;
mod run;
mod score;
mod source;
mod stages;
mod tracker;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::capture::Capture;
    #[pymodule_export]
    use super::estimates::Estimates;
    #[pymodule_export]
    use super::found::{Found, write_together};
    #[pymodule_export]
    use super::parameters::{parameter_table, params_from_toml, params_to_toml, params_with_profile};
    #[pymodule_export]
    use super::pipeline::Pipeline;
    #[pymodule_export]
    use super::score::{score, score_mosd, synthetic};
    #[pymodule_export]
    use super::source::{Source, extensions, read_camera, read_images};
    #[pymodule_export]
    use super::tracker::{Tracked, Tracker};

    /// The version, as Cargo has it.
    #[expect(non_upper_case_globals, reason = "the name that Python modules use")]
    #[pymodule_export]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
