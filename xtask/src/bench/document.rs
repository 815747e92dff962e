//! The document: what a person wrote, and sections that are measured.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

/// A text with sections between `<!-- NAME: begin -->` and `<!-- NAME: end -->`.
pub(crate) struct Document {
    text: String,
}

impl Document {
    /// Reads the file.
    ///
    /// # Errors
    /// When it cannot be read.
    pub(crate) fn read(file: &Path) -> Result<Self> {
        Ok(Self { text: fs::read_to_string(file).with_context(|| format!("{}", file.display()))? })
    }

    /// Replaces what stands in a section; everything else stays as it is.
    ///
    /// # Errors
    /// When the document has no such section.
    pub(crate) fn set(&mut self, section: &str, content: &str) -> Result<()> {
        let [begin, end] = ["begin", "end"].map(|mark| format!("<!-- {section}: {mark} -->"));
        let lost = || format!("the document has lost its marks {begin} and {end}");
        let (before, rest) = self.text.split_once(&begin).with_context(lost)?;
        let (_, after) = rest.split_once(&end).with_context(lost)?;
        self.text = format!("{before}{begin}\n\n{}\n\n{end}{after}", content.trim());
        Ok(())
    }

    /// Writes the file.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(crate) fn write(&self, file: &Path) -> Result<()> {
        fs::write(file, &self.text).with_context(|| format!("{}", file.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_section_changes() {
        let text = "mine\n<!-- a: begin -->\nold\n<!-- a: end -->\nmine too <!-- b: begin --><!-- b: end -->"
            .to_owned();
        let mut document = Document { text };
        for content in ["new", "newer\n"] {
            document.set("a", content).unwrap();
        }
        let expected =
            "mine\n<!-- a: begin -->\n\nnewer\n\n<!-- a: end -->\nmine too <!-- b: begin --><!-- b: end -->";
        assert_eq!(document.text, expected);
        assert!(document.set("c", "").is_err());
    }
}
