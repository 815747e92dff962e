//! What a report says beside its frames: figures, plots, and what happens in a video.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use pulldown_cmark::{Event, Options, Parser, html};
use serde::Serialize;

/// Figures, plots and a film, as the page takes them.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Findings {
    html: String,
    /// Addresses of the images, which hold them.
    plots: Vec<String>,
    pub(crate) film: Option<Film>,
}

/// What happens in a video.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Film {
    /// When each frame of the report was taken (s).
    pub stamps_s: Vec<f64>,
    /// What happened, in the order of time.
    pub happenings: Vec<Happening>,
    /// How long each track is known.
    pub lives: Vec<Life>,
}

/// Something that happened to a track.
#[derive(Clone, Debug, Serialize)]
pub struct Happening {
    /// When (s).
    pub time_s: f64,
    /// To which track.
    pub track: u32,
    /// A sentence.
    pub text: String,
}

/// When a track was seen for the first and for the last time (s).
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Life {
    /// Its number.
    pub track: u32,
    /// The first time.
    pub first_s: f64,
    /// The last time.
    pub last_s: f64,
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
