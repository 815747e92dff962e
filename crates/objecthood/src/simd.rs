//! Loops over pixels, compiled for the vector units that the machine has.

/// Runs `work`, which is compiled once for every width of vectors; which one runs the machine decides.
///
/// The result is the same with all of them, and without: Rust neither contracts nor reorders floating-point operations.
/// What `work` calls has to be inlined into it, else it is compiled for the smallest machine only. With the feature
/// `scalar` nothing is chosen at run time, so that instructions can be counted and compared between machines.
#[inline(always)]
pub(crate) fn vectorized<R>(work: impl FnOnce() -> R) -> R {
    if cfg!(feature = "scalar") { work() } else { pulp::Arch::new().dispatch(work) }
}
