//! What a report says beside its frames: figures, plots, and what happens in a video.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use pulldown_cmark::{Event, Options, Parser, html};
use serde::Serialize;

use crate::film::Film;

/// Figures, plots and a film, as the page takes them.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Findings {
    html: String,
    /// Addresses of the images, which hold them.
    plots: Vec<String>,
    pub(crate) film: Option<Film>,
}

impl Findings {
    /// Appends Markdown as HTML. A line stays a line, and tags are text.
    pub(crate) fn tell(&mut self, markdown: &str) {
        let events = Parser::new_ext(markdown, Options::ENABLE_TABLES).map(|event| match event {
            Event::SoftBreak => Event::HardBreak,
            Event::Html(tag) | Event::InlineHtml(tag) => Event::Text(tag),
            other => other,
        });
        html::push_html(&mut self.html, events);
    }

    /// Appends a plot.
    pub(crate) fn plot(&mut self, svg: &str) {
        self.plots.push(format!("data:image/svg+xml;base64,{}", STANDARD.encode(svg)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_tables_lines_stay_and_tags_are_text() {
        let mut findings = Findings::default();
        findings.tell("one\ntwo <script>\n\n| a | b |\n|---|---|\n| 1 | 2 |\n");
        let html = &findings.html;
        assert!(html.contains("one<br />\ntwo &lt;script&gt;"), "{html}");
        assert!(html.contains("<td>1</td><td>2</td>"), "{html}");
    }
}
