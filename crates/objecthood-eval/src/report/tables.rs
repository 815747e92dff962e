//! Reports as text tables: Markdown, with the columns aligned.

use std::fmt;

use super::{Report, SceneReport, Totals};
use crate::metrics::Prf;
use crate::mosd;
use crate::verdict::VerdictCounts;

/// The paper's table: what became of the objects, per folder and, where a scene is named as in mOSD, per category.
pub struct VerdictsTable<'a>(
    /// What to show.
    pub &'a Report,
);

impl fmt::Display for VerdictsTable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scenes: Vec<&SceneReport> = self.0.scenes.iter().collect();
        let mut rows = Vec::new();
        let folders: Vec<_> = scenes.chunk_by(|a, b| a.folder == b.folder).collect();
        for &folder in &folders {
            let name = &folder[0].folder;
            let category = |scene: &SceneReport| mosd::category(&scene.name);
            for group in folder.chunk_by(|a, b| category(a) == category(b)) {
                if let Some(category) = category(group[0]) {
                    rows.push(verdicts_row(format!("{name}: {category}"), group));
                }
            }
            rows.push(verdicts_row(name.clone(), folder));
        }
        if folders.len() > 1 {
            rows.push(verdicts_row("all".to_owned(), &scenes));
        }
        let header =
            ["scenes", "correct", "objects", "percent", "occlusion", "over", "under", "boundary", "missed"];
        write_table(f, 1, &header, &rows)
    }
}

fn verdicts_row(name: String, scenes: &[&SceneReport]) -> Vec<String> {
    let counts: VerdictCounts = scenes.iter().flat_map(|s| &s.score.objects).map(|o| o.verdict).collect();
    let VerdictCounts { correct, occlusion, over, under, boundary, missed } = counts;
    let objects = counts.total();
    let percent = match objects {
        0 => "-".to_owned(),
        _ => format!("{:.1}", 100.0 * correct as f64 / objects as f64),
    };
    let numbers = [occlusion, over, under, boundary, missed].map(|n| n.to_string());
    [name, correct.to_string(), objects.to_string(), percent].into_iter().chain(numbers).collect()
}

/// One row a setting: the figures of its objects.
pub struct SettingsTable<'a>(
    /// The settings by name.
    pub &'a [(String, Report)],
);

impl fmt::Display for SettingsTable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows = self.0.iter().map(|(name, Report { total, .. })| {
            let VerdictCounts { correct, occlusion, over, under, boundary, missed } = total.counts;
            let percents = |Prf { precision, recall, f }| {
                format!("{:.1} / {:.1} / {:.1}", 100.0 * precision, 100.0 * recall, 100.0 * f)
            };
            vec![
                name.clone(),
                format!("{correct}/{}", total.counts.total()),
                percents(total.metrics.overlap),
                percents(total.metrics.boundary),
                format!("{:.1}", 100.0 * total.metrics.p75),
                format!("{:.3}", total.weighted_overlap),
                format!("{occlusion}/{over}/{under}/{boundary}/{missed}"),
            ]
        });
        let header = [
            "setting",
            "correct",
            "overlap P/R/F",
            "boundary P/R/F",
            "%75",
            "WOv",
            "occl/over/under/bnd/missed",
        ];
        write_table(f, 1, &header, &rows.collect::<Vec<_>>())
    }
}

/// One row a setting, and in it the figures of every folder: how two sets of scenes take the same change.
pub struct FoldersTable<'a>(
    /// The settings by name, all on the same scenes.
    pub &'a [(String, Report)],
);

impl fmt::Display for FoldersTable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let folders: Vec<_> = self.0.iter().map(|(name, report)| (name, report.folders())).collect();
        let mut header = vec!["setting".to_owned()];
        for (folder, totals) in folders.first().iter().flat_map(|(_, folders)| folders) {
            header.push(format!("{folder}: correct of {}", totals.counts.total()));
            header.extend(["overlap F", "boundary F", "occl/over/under"].map(str::to_owned));
        }
        let rows = folders.iter().map(|(name, folders)| {
            let figures = folders.iter().flat_map(|(_, Totals { metrics, counts, .. })| {
                let VerdictCounts { correct, occlusion, over, under, .. } = counts;
                let percent = |share: f64| format!("{:.1}", 100.0 * share);
                let [overlap, boundary] = [metrics.overlap.f, metrics.boundary.f].map(percent);
                [correct.to_string(), overlap, boundary, format!("{occlusion}/{over}/{under}")]
            });
            std::iter::once((*name).clone()).chain(figures).collect()
        });
        let header: Vec<&str> = header.iter().map(String::as_str).collect();
        write_table(f, 1, &header, &rows.collect::<Vec<_>>())
    }
}

/// One line a folder: the setting in which most objects are lost against the first one.
pub struct LossesList<'a>(
    /// The settings by name, all on the same scenes.
    pub &'a [(String, Report)],
);

impl fmt::Display for LossesList<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [(_, first), others @ ..] = self.0 else { return Ok(()) };
        for (k, (folder, totals)) in first.folders().into_iter().enumerate() {
            let lost = |report: &Report| {
                let correct = report.folders().get(k).map_or(0, |(_, totals)| totals.counts.correct);
                totals.counts.correct.saturating_sub(correct)
            };
            // The first of equals.
            let worst = others.iter().rev().max_by_key(|(_, report)| lost(report));
            let new_line = if k > 0 { "\n" } else { "" };
            match worst.map(|(name, report)| (name, lost(report))) {
                Some((name, lost)) if lost > 0 => {
                    let objects = totals.counts.total();
                    let percent = 100.0 * lost as f64 / objects as f64;
                    write!(
                        f,
                        "{new_line}{folder}: at most {lost} of {objects} objects lost ({percent:.1} %), by {name}"
                    )?;
                }
                _ => write!(f, "{new_line}{folder}: no object lost")?,
            }
        }
        Ok(())
    }
}

/// One row a setting and stage: how its regions fit the truth. Settings whose stages were not watched have no row.
pub struct StagesTable<'a>(
    /// The settings by name.
    pub &'a [(String, Report)],
);

impl fmt::Display for StagesTable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Vec::new();
        for (name, report) in self.0 {
            for (stage, metrics) in report.total.stages.iter().flat_map(|stages| stages.by_name()) {
                let Some(m) = metrics else { continue };
                let recall = |share: Option<f64>| share.map_or("-".to_owned(), |x| format!("{x:.3}"));
                rows.push(vec![
                    name.clone(),
                    stage.to_owned(),
                    format!("{:.1}", m.regions),
                    format!("{:.4}", m.asa),
                    format!("{:.4}", m.object_asa),
                    format!("{:.4}", m.ue),
                    recall(m.boundary_recall),
                    recall(m.contact_recall),
                    format!("{:.3}", m.coverage),
                    format!("{:.3}", m.c75),
                ]);
            }
        }
        let header = [
            "setting",
            "stage",
            "regions",
            "ASA",
            "object ASA",
            "UE",
            "boundary recall",
            "contact recall",
            "coverage",
            "c75",
        ];
        write_table(f, 2, &header, &rows)
    }
}

/// A Markdown table without a newline at its end. The first `names` columns are flush left, the others flush right.
pub(crate) fn write_table(
    f: &mut fmt::Formatter<'_>,
    names: usize,
    header: &[&str],
    rows: &[Vec<String>],
) -> fmt::Result {
    let chars = |cell: &str| cell.chars().count();
    let widths: Vec<usize> = (0..header.len())
        .map(|k| rows.iter().map(|row| chars(&row[k])).fold(chars(header[k]), usize::max))
        .collect();
    let rule = |(k, &width): (usize, &usize)| {
        if k < names { "-".repeat(width) } else { "-".repeat(width - 1) + ":" }
    };
    let rules: Vec<String> = widths.iter().enumerate().map(rule).collect();

    write_row(f, names, &widths, header)?;
    for row in std::iter::once(&rules).chain(rows) {
        f.write_str("\n")?;
        write_row(f, names, &widths, row)?;
    }
    Ok(())
}

fn write_row(
    f: &mut fmt::Formatter<'_>,
    names: usize,
    widths: &[usize],
    cells: &[impl AsRef<str>],
) -> fmt::Result {
    for (k, (cell, &width)) in cells.iter().zip(widths).enumerate() {
        let cell = cell.as_ref();
        if k < names { write!(f, "| {cell:<width$} ")? } else { write!(f, "| {cell:>width$} ")? }
    }
    f.write_str("|")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::tests::{report, stages};
    use crate::verdict::Verdict;

    #[test]
    fn verdicts_are_grouped_by_folder_and_category() {
        let table = VerdictsTable(&report(&["learn0", "learn17", "learn18", "mine1"])).to_string();
        let expected = "\
| scenes               | correct | objects | percent | occlusion | over | under | boundary | missed |
| -------------------- | ------: | ------: | ------: | --------: | ---: | ----: | -------: | -----: |
| learn: boxes         |       1 |       2 |    50.0 |         0 |    0 |     0 |        0 |      1 |
| learn: stacked boxes |       2 |       4 |    50.0 |         0 |    0 |     0 |        0 |      2 |
| learn                |       3 |       6 |    50.0 |         0 |    0 |     0 |        0 |      3 |
| mine                 |       1 |       2 |    50.0 |         0 |    0 |     0 |        0 |      1 |
| all                  |       4 |       8 |    50.0 |         0 |    0 |     0 |        0 |      4 |";
        assert_eq!(table, expected);
    }

    #[test]
    fn settings_have_a_row_each() {
        let reports = [("both".to_owned(), report(&["a0"])), ("colour, off".to_owned(), report(&["a0"]))];
        let expected = "\
| setting     | correct |      overlap P/R/F |     boundary P/R/F |  %75 |   WOv | occl/over/under/bnd/missed |
| ----------- | ------: | -----------------: | -----------------: | ---: | ----: | -------------------------: |
| both        |     1/2 | 80.0 / 40.0 / 53.3 | 50.0 / 25.0 / 33.3 | 50.0 | 0.675 |                  0/0/0/0/1 |
| colour, off |     1/2 | 80.0 / 40.0 / 53.3 | 50.0 / 25.0 / 33.3 | 50.0 | 0.675 |                  0/0/0/0/1 |";
        assert_eq!(SettingsTable(&reports).to_string(), expected);
    }

    #[test]
    fn folders_stand_side_by_side() {
        let reports = [("all".to_owned(), report(&["a0", "b1"])), ("less".to_owned(), report(&["a0", "b1"]))];
        let expected = "\
| setting | a: correct of 2 | overlap F | boundary F | occl/over/under | b: correct of 2 | overlap F | boundary F | occl/over/under |
| ------- | --------------: | --------: | ---------: | --------------: | --------------: | --------: | ---------: | --------------: |
| all     |               1 |      53.3 |       33.3 |           0/0/0 |               1 |      53.3 |       33.3 |           0/0/0 |
| less    |               1 |      53.3 |       33.3 |           0/0/0 |               1 |      53.3 |       33.3 |           0/0/0 |";
        assert_eq!(FoldersTable(&reports).to_string(), expected);
    }

    #[test]
    fn the_greatest_loss_of_every_folder_is_named() {
        let lose = |names: &[&str]| {
            let mut scenes = report(&["a0", "b1", "b2"]).scenes;
            for scene in scenes.iter_mut().filter(|scene| names.contains(&scene.name.as_str())) {
                scene.score.objects[0].verdict = Verdict::Over;
            }
            Report::new(scenes).unwrap()
        };
        let reports =
            [("as is", vec![]), ("x", vec!["b1"]), ("y", vec!["b1", "b2"]), ("z", vec!["b1", "b2"])]
                .map(|(name, lost)| (name.to_owned(), lose(&lost)));
        let expected = "a: no object lost\nb: at most 2 of 4 objects lost (50.0 %), by y";
        assert_eq!(LossesList(&reports).to_string(), expected);
        assert_eq!(LossesList(&[]).to_string(), "");
    }

    #[test]
    fn only_watched_stages_have_a_row() {
        let mut watched = report(&["a0"]);
        watched.total.stages = Some(stages());
        let reports = [("blind".to_owned(), report(&["a0"])), ("watched".to_owned(), watched)];
        let expected = "\
| setting | stage       | regions |    ASA | object ASA |     UE | boundary recall | contact recall | coverage |   c75 |
| ------- | ----------- | ------: | -----: | ---------: | -----: | --------------: | -------------: | -------: | ----: |
| watched | superpixels |    38.9 | 0.9976 |     0.9868 | 0.0048 |           0.982 |              - |    0.300 | 0.015 |";
        assert_eq!(StagesTable(&reports).to_string(), expected);
    }
}
