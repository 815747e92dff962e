//! Words that several commands say.

/// A number of things: `1 frame`, `3 frames`.
pub(crate) fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
