//! The figures of clips as tables.

use std::fmt;

use serde::Serialize;

use super::counts::{Cases, Counts};
use super::score::{ClipScore, VideoFigures};
use crate::report::write_table;

/// The figures of every clip, and over all of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VideoReport {
    /// Clips in the order given.
    pub clips: Vec<NamedFigures>,
    /// Over all clips: counts are summed, as `TrackEval` combines sequences.
    pub total: VideoFigures,
}

/// The figures of a clip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedFigures {
    /// The name of its folder.
    pub clip: String,
    /// What they are.
    #[serde(flatten)]
    pub figures: VideoFigures,
}

impl VideoReport {
    /// Sums up.
    pub fn new(scores: &[(String, ClipScore)]) -> Self {
        let mut total = ClipScore::default();
        for (_, score) in scores {
            total += score;
        }
        let named = |(clip, score): &(String, ClipScore)| NamedFigures {
            clip: clip.clone(),
            figures: score.figures(),
        };
        Self { clips: scores.iter().map(named).collect(), total: total.figures() }
    }
}

impl fmt::Display for VideoReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows: Vec<(&str, &VideoFigures)> =
            self.clips.iter().map(|named| (named.clip.as_str(), &named.figures)).collect();
        if rows.len() != 1 {
            rows.push(("all", &self.total));
        }
        tracks_table(f, &rows)?;
        f.write_str("\n\n")?;
        understood_table(f, &rows)?;
        if let Some(events) = &self.total.events {
            f.write_str("\n\n")?;
            events_table(f, events.by_kind.iter())?;
        }
        Ok(())
    }
}

/// How well things are found and followed.
fn tracks_table(f: &mut fmt::Formatter<'_>, rows: &[(&str, &VideoFigures)]) -> fmt::Result {
    let row = |(name, figures): &(&str, &VideoFigures)| {
        vec![
            (*name).to_owned(),
            figures.frames.to_string(),
            percent(figures.hota),
            percent(figures.det_a),
            percent(figures.ass_a),
            percent(figures.owta),
            percent(figures.idf1),
            percent(figures.mota),
            figures.id_switches.to_string(),
            figures.interruptions.to_string(),
            percent(figures.unbroken),
            percent(figures.p75),
            hundredths(figures.flicker),
            hundredths(figures.flicker_on_objects),
        ]
    };
    let header = [
        "clip",
        "frames",
        "HOTA",
        "DetA",
        "AssA",
        "OWTA",
        "IDF1",
        "MOTA",
        "switches",
        "breaks",
        "unbroken",
        "%75",
        "flicker",
        "on objects",
    ];
    write_table(f, 1, &header, &rows.iter().map(row).collect::<Vec<_>>())
}

/// What is understood: precision/recall, and cases right/all.
fn understood_table(f: &mut fmt::Formatter<'_>, rows: &[(&str, &VideoFigures)]) -> fmt::Result {
    let row = |(name, figures): &(&str, &VideoFigures)| {
        let kept = &figures.kept;
        let airborne = figures.airborne;
        vec![
            (*name).to_owned(),
            both(figures.all_events),
            cases(figures.events.as_ref().map(|events| events.other_named).unwrap_or_default()),
            both(figures.support),
            both(figures.flights),
            both(airborne.map(|counts| counts.frames)),
            airborne.map_or_else(|| "-".to_owned(), |counts| counts.in_still_clips.to_string()),
            cases(kept.split),
            cases(kept.opened),
            cases(kept.merged),
            cases(kept.together),
            cases(kept.returned),
        ]
    };
    let header = [
        "clip",
        "events P/R",
        "other",
        "support P/R",
        "flights P/R",
        "airborne P/R",
        "false flights",
        "split",
        "opened",
        "merged",
        "together",
        "returned",
    ];
    write_table(f, 1, &header, &rows.iter().map(row).collect::<Vec<_>>())
}

fn events_table<'a>(
    f: &mut fmt::Formatter<'_>,
    by_kind: impl Iterator<Item = (&'a String, &'a Counts)>,
) -> fmt::Result {
    let row = |(kind, counts): (&String, &Counts)| {
        let numbers = [counts.right, counts.wrong, counts.missed].map(|n| n.to_string());
        let shares = [percent(counts.precision()), percent(counts.recall())];
        [kind.clone()].into_iter().chain(numbers).chain(shares).collect()
    };
    let header = ["event", "right", "wrong", "missed", "precision", "recall"];
    write_table(f, 1, &header, &by_kind.map(row).collect::<Vec<Vec<String>>>())
}

fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "-".to_owned(), |share| format!("{:.1}", 100.0 * share))
}

/// Percent of what is small.
fn hundredths(share: Option<f64>) -> String {
    share.map_or_else(|| "-".to_owned(), |share| format!("{:.2}", 100.0 * share))
}

fn both(counts: Option<Counts>) -> String {
    counts.map_or_else(
        || "-".to_owned(),
        |counts| format!("{}/{}", percent(counts.precision()), percent(counts.recall())),
    )
}

fn cases(cases: Cases) -> String {
    if cases.all == 0 { "-".to_owned() } else { format!("{}/{}", cases.right, cases.all) }
}

#[cfg(test)]
mod tests {
    use super::super::EventCounts;
    use super::*;

    /// It was counted, and no table showed it.
    #[test]
    fn who_else_had_part_in_events_is_shown() {
        let events = EventCounts { other_named: Cases { right: 2, all: 3 }, ..EventCounts::default() };
        let score = ClipScore { frames: 1, events: Some(events), ..ClipScore::default() };
        let text = VideoReport::new(&[("pick1".to_owned(), score)]).to_string();
        assert!(text.contains("other") && text.contains("2/3"), "{text}");
    }
}
