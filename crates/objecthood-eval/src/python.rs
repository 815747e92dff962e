//! A Python to compare with, in tests.

use std::io::Write;
use std::process::{Command, Stdio};

/// What `script` prints when it reads `input`; `None` without a Python in `OBJECTHOOD_PYTHON`.
pub(crate) fn run(script: &str, input: &str) -> Option<String> {
    let python = std::env::var_os("OBJECTHOOD_PYTHON")?;
    let mut child = Command::new(python)
        .args(["-c", script])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("OBJECTHOOD_PYTHON runs");
    let mut stdin = child.stdin.take().expect("stdin is piped");
    let output = std::thread::scope(|scope| {
        // Beside the reading, because both pipes are of limited size. Dropping it ends the input.
        scope.spawn(move || stdin.write_all(input.as_bytes()).expect("the script reads its input"));
        child.wait_with_output().expect("the script ends")
    });
    assert!(output.status.success(), "the script failed");
    Some(String::from_utf8(output.stdout).expect("the script prints text"))
}
