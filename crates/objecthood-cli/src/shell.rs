//! Commands that the user can copy into a shell.

use std::path::{Path, PathBuf};

/// Options that say nothing about the frames, each with a value.
const OF_SETTINGS: [&str; 8] =
    ["--port", "--set", "--config", "--profile", "--threads", "--method", "--out", "--write"];
/// Those without.
const SWITCHES: [&str; 7] = ["--all", "--verbose", "-v", "--report", "--keep-tree", "--resume", "--summary"];

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

/// The words of the command line of this subcommand that name the frames, as a shell reads them.
pub(crate) fn words_of_frames(subcommand: &str) -> Vec<String> {
    those_of_frames(std::env::args().skip_while(|word| word != subcommand).skip(1))
}

fn those_of_frames(arguments: impl Iterator<Item = String>) -> Vec<String> {
    let mut words = Vec::new();
    let mut arguments = arguments;
    while let Some(argument) = arguments.next() {
        let name = argument.split_once('=').map_or(argument.as_str(), |(name, _)| name);
        if OF_SETTINGS.contains(&name) {
            if !argument.contains('=') {
                arguments.next();
            }
        } else if !SWITCHES.contains(&name) {
            words.push(word(Path::new(&argument)));
        }
    }
    words
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

    #[test]
    fn settings_are_not_a_part_of_what_names_the_frames() {
        let words = |line: &str| those_of_frames(line.split(' ').map(str::to_owned)).join(" ");
        assert_eq!(words("learn --port 80 --set a.b=1 --all"), "learn");
        assert_eq!(
            words("--set=a.b=1 --camera 1,2,3,4 --depth d*.png -v"),
            "--camera 1,2,3,4 --depth 'd*.png'"
        );
    }
}
