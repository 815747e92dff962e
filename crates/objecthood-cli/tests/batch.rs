//! `objecthood batch` without its engine. With it: `python/tests/test_ray.py`.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

/// The engine is missing: there is no such Python, or it has no such package.
#[test]
fn it_says_what_to_install() {
    // `false` fails whatever it is told.
    for python in ["no-such-python", "false"] {
        let mut command = common::command();
        let output =
            command.env("OBJECTHOOD_PYTHON", python).args(["batch", "in", "--out", "out"]).output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.starts_with("error: the Python package "), "{stderr}");
        assert!(stderr.contains("-m pip install 'objecthood[ray]'"), "{stderr}");
    }
}
