//! Patterns of files, as a shell expands them: `*`, `?` and `[ab]` within a name, `**` for any folders.

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use glob::{MatchOptions, Pattern};

use super::walk;

/// Whether an argument is a pattern: it has a character that means one, and no file is called so.
pub(super) fn is_pattern(argument: &Path) -> bool {
    has_wildcard(argument) && !argument.exists()
}

/// The files of a pattern, in natural order, spelled as the shell would.
///
/// # Errors
/// When it is no pattern; when a folder cannot be listed.
pub(super) fn expand(pattern: &Path) -> Result<Vec<PathBuf>> {
    // What comes before the first wildcard is where to look.
    let base: PathBuf = pattern.components().take_while(|part| !has_wildcard(part.as_ref())).collect();
    let below = pattern.strip_prefix(&base).unwrap_or(pattern);
    let glob = Pattern::new(&below.to_string_lossy())
        .map_err(|e| anyhow!("{}: not a pattern ({}): correct it", pattern.display(), e.msg))?;
    let options = MatchOptions { require_literal_separator: true, ..MatchOptions::new() };

    let any_depth = below.components().any(|part| part.as_os_str() == "**");
    let depth = if any_depth { usize::MAX } else { below.components().count() };
    let mut files = walk(&base, depth)?;
    // A name that is not UTF-8 is matched as if a replacement character stood for each part that is not.
    let is_match = |path: &Path| glob.matches_with(&path.to_string_lossy(), options);
    files.retain(|path| is_match(path.strip_prefix(&base).unwrap_or(path)));
    Ok(files)
}

fn has_wildcard(path: &Path) -> bool {
    path.to_string_lossy().contains(['*', '?', '['])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_as_in_a_shell() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["1-color.png", "10-color.png", "2-depth.png", "a/b/2-color.png", "a/x.png", "b/é.png"] {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, b"").unwrap();
        }
        let expanded = |pattern: &str| -> Vec<String> {
            let files = expand(&folder.path().join(pattern)).unwrap();
            let below = files.iter().map(|file| file.strip_prefix(folder.path()).unwrap());
            below.map(|file| file.to_str().unwrap().to_owned()).collect()
        };
        for (pattern, names) in [
            ("*-color.png", &["1-color.png", "10-color.png"][..]),
            ("?-color.png", &["1-color.png"]),
            ("[12]*.png", &["1-color.png", "2-depth.png", "10-color.png"]),
            ("*/?.png", &["a/x.png", "b/é.png"]),
            // It was the name of a folder, which was not there.
            ("**/*-color.png", &["1-color.png", "10-color.png", "a/b/2-color.png"]),
            ("a/**/*.png", &["a/b/2-color.png", "a/x.png"]),
            ("*.jpg", &[]),
        ] {
            assert_eq!(expanded(pattern), names, "{pattern}");
        }
        assert!(expand(Path::new("a[")).unwrap_err().to_string().starts_with("a[: not a pattern"));
        assert!(expand(&folder.path().join("nowhere/*.png")).is_err());
    }
}
