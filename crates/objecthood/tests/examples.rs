//! The numbered examples run.

#[allow(dead_code, reason = "the example's own main is called below")]
#[path = "../examples/01_one_frame.rs"]
mod one_frame;

#[test]
fn one_frame_runs() {
    one_frame::main().unwrap();
}
