//! The numbered examples run.
#![allow(clippy::duplicate_mod, reason = "each example has the same small world")]

#[allow(dead_code, reason = "the example's own main is called below")]
#[path = "../examples/01_one_frame.rs"]
mod one_frame;

#[test]
fn one_frame_runs() {
    one_frame::main().unwrap();
}

#[allow(dead_code, reason = "the example's own main is called below")]
#[path = "../examples/02_own_superpixels.rs"]
mod own_superpixels;

#[test]
fn own_superpixels_run() {
    own_superpixels::main().unwrap();
}

#[allow(dead_code, reason = "the example's own main is called below")]
#[path = "../examples/03_facets_only.rs"]
mod facets_only;

#[test]
fn facets_only_runs() {
    facets_only::main().unwrap();
}
