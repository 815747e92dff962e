//! Figures of scenes that need not hold an object: rooms, tables, by what they show and what sees them.

use std::fmt;

use serde::Serialize;

use super::{SceneReport, Totals, write_table};

/// Figures over the scenes of a family, seen by one sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FamilyFigures {
    /// How many scenes there are.
    pub scenes: usize,
    /// Objects of the truth.
    pub objects: usize,
    /// Of these the correct ones, strictly judged.
    pub correct: usize,
    /// Hypotheses with at least one pixel that counts.
    pub hypotheses: usize,
    /// Hypotheses of which fewer than half of the pixels that count lie on objects.
    pub false_objects: usize,
    /// How well objectness ranks, of 1; `None` without objects.
    pub average_precision: Option<f64>,
}

impl FamilyFigures {
    /// Of some scenes. O(n log n) for n hypotheses.
    pub fn of<'a>(scenes: impl IntoIterator<Item = &'a SceneReport, IntoIter: Clone>) -> Self {
        let scenes = scenes.into_iter();
        let sum = |of: fn(&SceneReport) -> usize| scenes.clone().map(of).sum();
        Self {
            scenes: scenes.clone().count(),
            objects: sum(|scene| scene.score.objects.len()),
            correct: sum(|scene| scene.counts().correct),
            hypotheses: sum(|scene| scene.score.hypotheses),
            false_objects: sum(|scene| scene.score.hypotheses_off_objects),
            average_precision: Totals::ranking(scenes).map(|ranking| ranking.average_precision),
        }
    }
}

/// One row for each family of scenes and sensor.
pub struct FamiliesTable<'a>(
    /// Family, sensor, figures.
    pub &'a [(String, String, FamilyFigures)],
);

impl fmt::Display for FamiliesTable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let or_none = |figure: Option<String>| figure.unwrap_or_else(|| "-".to_owned());
        let row = |(family, sensor, figures): &(String, String, FamilyFigures)| {
            let share = (figures.objects > 0).then(|| figures.correct as f64 / figures.objects as f64);
            let false_objects =
                (figures.scenes > 0).then(|| figures.false_objects as f64 / figures.scenes as f64);
            vec![
                family.clone(),
                sensor.clone(),
                or_none(share.map(|share| format!("{share:.3}"))),
                figures.objects.to_string(),
                figures.hypotheses.to_string(),
                or_none(false_objects.map(|count| format!("{count:.2}"))),
                or_none(figures.average_precision.map(|precision| format!("{precision:.3}"))),
            ]
        };
        let header =
            ["family", "sensor", "correct", "objects", "hypotheses", "false an image", "average precision"];
        write_table(f, 2, &header, &self.0.iter().map(row).collect::<Vec<_>>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::tests::{bare, report};

    #[test]
    fn scenes_without_objects_count_too() {
        let scenes = report(&["a0", "a1"]).scenes;
        let figures = FamilyFigures::of(&scenes);
        assert_eq!((figures.scenes, figures.objects, figures.correct, figures.hypotheses), (2, 4, 2, 6));
        let empty = FamilyFigures::of(&[bare("b0"), bare("b1")]);
        assert_eq!((empty.objects, empty.false_objects, empty.average_precision), (0, 18, None));
        let expected = "\
| family | sensor | correct | objects | hypotheses | false an image | average precision |
| ------ | ------ | ------: | ------: | ---------: | -------------: | ----------------: |
| a      | kinect |   0.500 |       4 |          6 |           1.00 |                 - |
| b      | kinect |       - |       0 |         18 |           9.00 |                 - |";
        let rows = [("a", figures), ("b", empty)]
            .map(|(name, figures)| (name.to_owned(), "kinect".to_owned(), figures));
        assert_eq!(FamiliesTable(&rows).to_string(), expected);
    }
}
