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

/// Bytes in hexadecimal, two digits each.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
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

/// The lines that are left.
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    /// All lines of a file.
    pub(crate) fn of(text: &'a [u8]) -> Self {
        Self { rest: text, number: 0 }
    }

    /// What follows the line that was taken last.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Bytes that are left.
    pub(crate) fn bytes_left(&self) -> usize {
        self.rest.len()
    }
}

/// Each line that is not blank, without the blanks around it, with its number from 1.
impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        while !self.rest.is_empty() {
            let end = self.rest.iter().position(|&b| b == b'\n').unwrap_or(self.rest.len());
            let (line, rest) = self.rest.split_at(end);
            self.rest = rest.get(1..).unwrap_or_default();
            self.number += 1;
            let line = line.trim_ascii();
            if !line.is_empty() {
                return Some((self.number, line));
            }
        }
        None
    }
}
