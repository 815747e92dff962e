//! Plots of the figures.

use std::path::Path;

use anyhow::Result;
use objecthood_eval::{Ranked, Report};
use objecthood_io::output;
use objecthood_view::plot::{DotsRow, curve, dots};

use super::comparison::Comparison;
use crate::outputs::make_folder;

/// Of the settings of a sensitivity those are drawn that change most.
const MOST_CHANGES: usize = 30;

/// Draws what there is of the reports: the settings of a comparison, or precision over recall of a single one.
///
/// # Errors
/// When a plot cannot be written.
pub(crate) fn draw(
    folder: &Path,
    reports: &[(String, Report)],
    comparison: Option<Comparison>,
) -> Result<()> {
    make_folder(folder)?;
    let rows: Vec<DotsRow> = reports.iter().map(row).collect();
    let plot = match (comparison, reports) {
        (Some(Comparison::Ablation), _) => ("ablation.svg", settings("Ablation", &rows)),
        (Some(Comparison::Ladder), _) => ("ladder.svg", settings("Steps of the method", &rows)),
        (Some(Comparison::Sensitivity), _) => {
            ("sensitivity.svg", settings("Changes of one parameter", &most_changed(rows)))
        }
        (None, [(_, report)]) => {
            let points = precision_over_recall(report);
            ("precision-recall.svg", curve("Objects found by objectness", ["recall", "precision"], &points))
        }
        (None, _) => return Ok(()),
    };
    let (name, svg) = plot;
    Ok(output::write_atomically(&folder.join(name), svg.as_bytes())?)
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
    fn the_first_setting_and_those_that_change_most_are_drawn() {
        let row = |k: usize| (format!("{k}"), vec![0.9 - 0.01 * k as f64]);
        let kept = most_changed((0..50).map(row).collect());
        let names: Vec<&str> = kept.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names[..3], ["0", "20", "21"]);
        assert_eq!(names.len(), 1 + MOST_CHANGES);
        assert!(most_changed(Vec::new()).is_empty());
    }
}
