//! Plots of the figures.

use std::path::Path;

use anyhow::Result;
use objecthood_eval::{Ranked, Report};
use objecthood_io::output;
use objecthood_view::plot::{DotsRow, bars, curve, dots};

use super::comparison::Comparison;
use super::subject::Scored;
use crate::outputs::make_folder;

/// Of the settings of a sensitivity those are drawn that change most.
const MOST_CHANGES: usize = 30;

/// A plot as a file: its name, and SVG.
pub(crate) type Plot = (&'static str, String);

/// Writes plots into a folder, which is made if it is not there.
///
/// # Errors
/// When one cannot be written.
pub(crate) fn write(folder: &Path, plots: &[Plot]) -> Result<()> {
    make_folder(folder)?;
    let files: Vec<_> =
        plots.iter().map(|(name, svg)| (folder.join(name), svg.clone().into_bytes())).collect();
    Ok(output::write_together(&files)?)
}

/// What there is to draw: the settings of a comparison; or precision over recall, and the time of each stage, of a single one.
pub(crate) fn of(scored: &Scored, comparison: Option<Comparison>) -> Vec<Plot> {
    let rows: Vec<DotsRow> = scored.reports.iter().map(row).collect();
    match (comparison, &scored.reports[..]) {
        (Some(Comparison::Ablation), _) => vec![("ablation.svg", settings("Ablation", &rows))],
        (Some(Comparison::Ladder), _) => vec![("ladder.svg", settings("Steps of the method", &rows))],
        (Some(Comparison::Sensitivity), _) => {
            vec![("sensitivity.svg", settings("Changes of one parameter", &most_changed(rows)))]
        }
        (None, [(_, report)]) => {
            let points = precision_over_recall(report);
            let found = curve("Objects found by objectness", ["recall", "precision"], &points);
            let times = bars("Time of each stage", "ms, median of the scenes", &median_laps(&scored.laps));
            let times = (!scored.laps.is_empty()).then_some(("times.svg", times));
            [Some(("precision-recall.svg", found)), times].into_iter().flatten().collect()
        }
        (None, _) => Vec::new(),
    }
}

/// The median time (ms) of each stage, in the order of the stages.
fn median_laps(scenes: &[Vec<(&'static str, f64)>]) -> Vec<(String, f64)> {
    let Some(first) = scenes.first() else { return Vec::new() };
    let median = |k: usize| {
        let mut times: Vec<f64> = scenes.iter().filter_map(|laps| laps.get(k)).map(|lap| lap.1).collect();
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied().unwrap_or(0.0)
    };
    first.iter().enumerate().map(|(k, (stage, _))| ((*stage).to_owned(), median(k))).collect()
}

fn settings(title: &str, rows: &[DotsRow]) -> String {
    dots(title, &["correct objects", "overlap F", "boundary F"], rows)
}

fn row((name, Report { total, .. }): &(String, Report)) -> DotsRow {
    (name.clone(), vec![total.correct(), total.metrics.overlap.f, total.metrics.boundary.f])
}

/// The first row, with which the others are compared, and those that differ most from it, in their order.
fn most_changed(mut rows: Vec<DotsRow>) -> Vec<DotsRow> {
    let Some((_, usual)) = rows.first().cloned() else { return rows };
    let change = |(_, shares): &DotsRow| shares.iter().zip(&usual).map(|(a, b)| (a - b).abs()).sum::<f64>();
    let mut changes: Vec<f64> = rows.iter().skip(1).map(change).collect();
    changes.sort_by(|a, b| b.total_cmp(a));
    let least = changes.get(MOST_CHANGES - 1).copied().unwrap_or(0.0);
    let mut place = 0;
    rows.retain(|row| {
        place += 1;
        place == 1 || change(row) >= least
    });
    rows
}

/// Recall and precision of the hypotheses down to each objectness.
fn precision_over_recall(report: &Report) -> Vec<[f64; 2]> {
    let mut ranked: Vec<&Ranked> =
        report.scenes.iter().filter_map(|scene| scene.ranked.as_ref()).flatten().collect();
    ranked.sort_by(|a, b| b.objectness.total_cmp(&a.objectness));
    let objects = report.total.counts.total().max(1) as f64;
    let (mut taken, mut found) = (0, 0);
    let points = ranked.chunk_by(|a, b| a.objectness == b.objectness).map(|equal| {
        taken += equal.len();
        found += equal.iter().filter(|hypothesis| hypothesis.finds).count();
        [found as f64 / objects, found as f64 / taken as f64]
    });
    points.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_has_its_median() {
        let scene = |a, b| vec![("normals", a), ("facets", b)];
        let laps = median_laps(&[scene(3.0, 10.0), scene(1.0, 30.0), scene(2.0, 20.0)]);
        assert_eq!(laps, [("normals".to_owned(), 2.0), ("facets".to_owned(), 20.0)]);
        assert!(median_laps(&[]).is_empty());
    }

    #[test]
    fn the_first_setting_and_those_that_change_most_are_drawn() {
        let row = |k: usize| (format!("{k}"), vec![0.9 - 0.01 * k as f64]);
        let kept = most_changed((0..50).map(row).collect());
        let names: Vec<&str> = kept.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names[..3], ["0", "20", "21"]);
        assert_eq!(names.len(), 1 + MOST_CHANGES);
        assert!(most_changed(Vec::new()).is_empty());
    }
}
