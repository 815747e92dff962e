//! What the readers of text files have in common.

use std::path::PathBuf;

/// The text without the mark that some editors put before UTF-8.
pub(crate) fn without_byte_order_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)
}

/// The beginning of `bytes` in a form that fits on a line.
pub(crate) fn preview(bytes: &[u8]) -> String {
    const LONGEST: usize = 40;
    let shown = bytes.get(..LONGEST).unwrap_or(bytes).escape_ascii();
    if bytes.len() > LONGEST { format!("{shown}..") } else { shown.to_string() }
}

/// The path that a file spells. Where paths are bytes, any bytes are one; elsewhere it is UTF-8.
pub(crate) fn path(bytes: &[u8]) -> PathBuf {
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        std::ffi::OsStr::from_bytes(bytes).into()
    }
    #[cfg(not(unix))]
    String::from_utf8_lossy(bytes).into_owned().into()
}
