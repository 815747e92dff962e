//! Commands that the user can copy into a shell.

use std::path::{Path, PathBuf};

/// The name of this program as the user called it: `objecthood` alone runs only where it is on the path.
pub(crate) fn program() -> String {
    let called = std::env::args_os().next().map_or_else(|| "objecthood".into(), PathBuf::from);
    word(&called)
}

/// A word of a command line: as it is, or in quotes where a POSIX shell would read it otherwise.
pub(crate) fn word(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+,:=@%".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) {
        return text;
    }
    format!("'{}'", text.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read_back() {
        for (path, expected) in [
            ("a/b-1.png", "a/b-1.png"),
            ("a/*-color.png", "'a/*-color.png'"),
            ("my scenes", "'my scenes'"),
            ("it's", r"'it'\''s'"),
            ("", "''"),
        ] {
            assert_eq!(word(Path::new(path)), expected);
        }
    }
}
