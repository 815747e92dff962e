//! The figures in words.

use std::fmt::Write;

use objecthood_eval::evaluate::COMPOSITE;
use objecthood_eval::settings::changes_choice;
use objecthood_eval::{FoldersTable, LossesList, Report, SettingsTable, StagesTable, VerdictsTable};

use super::comparison::Comparison;

/// What is printed of the reports of a comparison, or of a single one.
pub(crate) fn of(reports: &[(String, Report)], comparison: Option<Comparison>, per_scene: bool) -> String {
    let mut text = String::new();
    for (setting, report) in reports.iter().filter(|_| per_scene) {
        if comparison.is_some() {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{setting}");
        }
        report.scenes.iter().for_each(|scene| {
            let _ = writeln!(text, "{scene}");
        });
    }
    let _ = match comparison {
        None => reports.iter().try_for_each(|(_, report)| one(&mut text, reports, report)),
        Some(Comparison::Ablation) => {
            writeln!(text, "{}\n\n{}", SettingsTable(reports), StagesTable(reports))
        }
        Some(Comparison::Ladder) => writeln!(text, "{}", FoldersTable(reports)),
        Some(Comparison::Sensitivity) => {
            // To do without a rule is no change of 30 %.
            let numbers: Vec<_> = reports.iter().filter(|(name, _)| !changes_choice(name)).cloned().collect();
            writeln!(text, "{}\n\nnumbers alone:\n{}", FoldersTable(reports), LossesList(&numbers))
        }
    };
    text
}

/// One report: the line of `tools/score.py`, what became of the objects, and the stages if a method ran.
fn one(text: &mut String, reports: &[(String, Report)], report: &Report) -> std::fmt::Result {
    writeln!(text, "{}", report.total)?;
    // Real and composed scenes are of two kinds, so their mean says little.
    let folders = report.folders();
    let has_composites = folders.iter().any(|(folder, _)| *folder == COMPOSITE);
    for (folder, totals) in folders.iter().filter(|_| has_composites) {
        writeln!(text, "{folder}: {totals}")?;
    }
    if let Some(ranking) = &report.total.ranking {
        writeln!(text, "{ranking}")?;
    }
    writeln!(text, "\n{}", VerdictsTable(report))?;
    if report.total.stages.is_some() {
        writeln!(text, "\n{}", StagesTable(reports))?;
    }
    Ok(())
}
