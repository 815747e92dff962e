//! Figures of scenes that need not hold an object: rooms, tables, by what they show and what sees them.

use std::fmt;

use serde::Serialize;

use super::{SceneReport, Totals, write_table};

/// Sums over scenes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sums {
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

impl Sums {
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
pub struct SumsTable<'a>(
    /// Family, sensor, figures.
    pub &'a [(String, String, Sums)],
);

impl fmt::Display for SumsTable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let or_none = |figure: Option<String>| figure.unwrap_or_else(|| "-".to_owned());
        let row = |(family, sensor, sums): &(String, String, Sums)| {
            let share = (sums.objects > 0).then(|| sums.correct as f64 / sums.objects as f64);
            let false_objects = (sums.scenes > 0).then(|| sums.false_objects as f64 / sums.scenes as f64);
            vec![
                family.clone(),
                sensor.clone(),
                or_none(share.map(|share| format!("{share:.3}"))),
                sums.objects.to_string(),
                sums.hypotheses.to_string(),
                or_none(false_objects.map(|count| format!("{count:.2}"))),
                or_none(sums.average_precision.map(|precision| format!("{precision:.3}"))),
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
        let sums = Sums::of(&scenes);
        assert_eq!((sums.scenes, sums.objects, sums.correct, sums.hypotheses), (2, 4, 2, 6));
        let empty = Sums::of(&[bare("b0"), bare("b1")]);
        assert_eq!((empty.objects, empty.false_objects, empty.average_precision), (0, 18, None));
        let expected = "\
| family | sensor | correct | objects | hypotheses | false an image | average precision |
| ------ | ------ | ------: | ------: | ---------: | -------------: | ----------------: |
| a      | kinect |   0.500 |       4 |          6 |           1.00 |                 - |
| b      | kinect |       - |       0 |         18 |           9.00 |                 - |";
        let rows =
            [("a", sums), ("b", empty)].map(|(name, sums)| (name.to_owned(), "kinect".to_owned(), sums));
        assert_eq!(SumsTable(&rows).to_string(), expected);
    }
}
