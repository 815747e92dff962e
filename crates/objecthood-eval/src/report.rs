//! The figures of a run over many scenes: per scene, in total, as text and as JSON.

mod families;
mod json;
mod tables;

use std::fmt;

use crate::error::{Error, Result};
use crate::evaluate::Prediction;
use crate::metrics::ImageMetrics;
use crate::numpy;
use crate::ranking::{Ranked, Ranking, ranked};
use crate::score::{ImageScore, score};
use crate::stages::Stages;
use crate::truth::Truth;
use crate::verdict::{ObjectScore, VerdictCounts};

pub use families::{FamiliesTable, FamilyFigures};
pub(crate) use tables::write_table;
pub use tables::{FoldersTable, LossesList, SettingsTable, StagesTable, VerdictsTable};

/// The figures of one scene. Displayed as the line of `tools/score.py --per-scene`.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneReport {
    /// Name of the scene.
    pub name: String,
    /// The folder it lies in.
    pub folder: String,
    /// How the label image fits the truth.
    pub score: ImageScore,
    /// The hypotheses by rank, if more is known of them than their pixels.
    pub ranked: Option<Vec<Ranked>>,
    /// How the stages before it fit the truth, if they were watched.
    pub stages: Option<Stages>,
}

impl SceneReport {
    /// Holds what is said about a scene against its truth.
    ///
    /// # Errors
    /// As [`score`].
    pub fn of(name: String, folder: String, truth: &Truth, prediction: &Prediction) -> Result<Self> {
        let Prediction { labels, objects, stages } = prediction;
        let ranked = objects.as_ref().map(|objects| ranked(labels, objects, truth)).transpose()?;
        Ok(Self { name, folder, score: score(labels, truth)?, ranked, stages: *stages })
    }

    /// How often each verdict was given.
    pub fn counts(&self) -> VerdictCounts {
        self.score.objects.iter().map(|o| o.verdict).collect()
    }
}

impl fmt::Display for SceneReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = self.counts();
        write!(f, "{:<8} {}/{}  ", self.name, counts.correct, counts.total())?;
        match &self.score.metrics {
            Some(ImageMetrics { overlap, boundary, p75 }) => {
                let [overlap, boundary, p75] = [overlap.f, boundary.f, *p75].map(|x| 100.0 * x);
                write!(f, "oF {overlap:.1} bF {boundary:.1} %75 {p75:.1}")
            }
            None => f.write_str("no object in the truth: left out"),
        }
    }
}

/// The figures of all scenes that hold an object. Displayed as the last line of `tools/score.py`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Totals {
    /// Means over the scenes.
    pub metrics: ImageMetrics,
    /// Mean over all objects, weighted by size, of the best `IoU` (`WOv`).
    pub weighted_overlap: f64,
    /// How often each verdict was given, over all objects.
    pub counts: VerdictCounts,
    /// Hypotheses with at least one pixel that counts.
    pub hypotheses: usize,
    /// Hypotheses of which fewer than half of the pixels that count lie on objects.
    pub hypotheses_off_objects: usize,
    /// Scenes that hold an object.
    pub scenes: usize,
    /// How well objectness ranks, over the scenes of which it is known; what is found where there is no object counts as well.
    pub ranking: Option<Ranking>,
    /// Means over the scenes whose stages were watched.
    pub stages: Option<Stages>,
}

impl Totals {
    /// Share of the objects that are correct.
    pub fn correct(&self) -> f64 {
        self.counts.correct as f64 / self.counts.total() as f64
    }

    fn of<'a>(scenes: impl IntoIterator<Item = &'a SceneReport, IntoIter: Clone>) -> Result<Self> {
        let scenes = scenes.into_iter();
        let scored: Vec<(&SceneReport, [f64; 7])> =
            scenes.clone().filter_map(|s| Some((s, s.score.metrics?.values()))).collect();
        let mut means = [0.0; ImageMetrics::KEYS.len()];
        for (k, mean) in means.iter_mut().enumerate() {
            let values: Vec<f64> = scored.iter().map(|(_, values)| values[k]).collect();
            *mean = numpy::mean(&values).ok_or(Error::NoObjects)?;
        }
        let scores = || scored.iter().map(|(scene, _)| &scene.score);
        let objects: Vec<&ObjectScore> = scores().flat_map(|s| &s.objects).collect();
        let weighted: Vec<f64> = objects.iter().map(|o| o.pixels as f64 * o.iou).collect();
        let pixels: usize = objects.iter().map(|o| o.pixels).sum();
        Ok(Self {
            metrics: ImageMetrics::from_values(means),
            weighted_overlap: numpy::sum(&weighted) / pixels as f64,
            counts: objects.iter().map(|o| o.verdict).collect(),
            hypotheses: scores().map(|s| s.hypotheses).sum(),
            hypotheses_off_objects: scores().map(|s| s.hypotheses_off_objects).sum(),
            scenes: scored.len(),
            ranking: Self::ranking(scenes),
            stages: Stages::mean(scored.iter().filter_map(|(scene, _)| scene.stages.as_ref())),
        })
    }

    fn ranking<'a>(scenes: impl Iterator<Item = &'a SceneReport>) -> Option<Ranking> {
        let (mut all, mut objects) = (Vec::new(), 0);
        for (scene, ranked) in scenes.filter_map(|scene| Some((scene, scene.ranked.as_ref()?))) {
            all.extend(ranked);
            objects += scene.score.objects.len();
        }
        Ranking::of(&all, objects)
    }
}

impl fmt::Display for Totals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [op, or, of, bp, br, bf, p75] = self.metrics.values().map(|x| 100.0 * x);
        let VerdictCounts { correct, occlusion, over, under, boundary, missed } = self.counts;
        write!(f, "correct {:.3} ({correct}/{})", self.correct(), self.counts.total())?;
        write!(f, "  overlap P {op:.1} R {or:.1} F {of:.1}  boundary P {bp:.1} R {br:.1} F {bf:.1}")?;
        write!(f, "  %75 {p75:.1}  WOv {:.3}", self.weighted_overlap)?;
        write!(f, "  | occl {occlusion} over {over} under {under} bnd {boundary} missed {missed}")
    }
}

/// The figures of a run over scenes.
///
/// Serialized under the keys of `tools/score.py --json`: `total` holds `oP` .. `p75`, `WOv`, `objects`, `correct` (a
/// share), `counts`, `scenes`; `folders` maps each folder to the same of its scenes; `scenes` maps each name, in the order of the scenes, to `oP` .. `p75`, `correct` and
/// `objects` (counts). Added are `hypotheses`, `hypotheses_off_objects`, `ranking` where objectness is known, `stages` where they were watched, and per
/// scene `folder` and `verdicts`, one entry an object.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// All scenes together.
    pub total: Totals,
    /// Each scene, in the order given.
    pub scenes: Vec<SceneReport>,
}

impl Report {
    /// Sums up. A scene without an object is listed but counts for nothing in the totals.
    ///
    /// # Errors
    /// [`Error::NoObjects`] when no scene holds an object.
    pub fn new(scenes: Vec<SceneReport>) -> Result<Self> {
        Ok(Self { total: Totals::of(&scenes)?, scenes })
    }

    /// The scenes of both, summed up anew.
    ///
    /// # Errors
    /// None: both hold an object.
    pub fn joined(mut self, other: Self) -> Result<Self> {
        self.scenes.extend(other.scenes);
        Self::new(self.scenes)
    }

    /// The totals of each folder that holds an object, in the order of the scenes.
    pub fn folders(&self) -> Vec<(&str, Totals)> {
        let folders = self.scenes.chunk_by(|a, b| a.folder == b.folder);
        folders.filter_map(|scenes| Some((scenes[0].folder.as_str(), Totals::of(scenes).ok()?))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::Prf;
    use crate::stages::StageMetrics;
    use crate::verdict::Verdict;

    /// A scene `<folder><number>` with an object found and one missed.
    fn scene(name: &str) -> SceneReport {
        let object = |truth_label, pixels, iou, verdict| ObjectScore { truth_label, pixels, iou, verdict };
        let prf = |precision, recall, f| Prf { precision, recall, f };
        let score = ImageScore {
            metrics: Some(ImageMetrics {
                overlap: prf(0.8, 0.4, 1.6 / 3.0),
                boundary: prf(0.5, 0.25, 1.0 / 3.0),
                p75: 0.5,
            }),
            objects: vec![object(2, 300, 0.9, Verdict::Correct), object(3, 100, 0.0, Verdict::Missed)],
            hypotheses: 3,
            hypotheses_off_objects: 1,
        };
        let folder = name.trim_end_matches(|c: char| c.is_ascii_digit()).to_owned();
        SceneReport { name: name.to_owned(), folder, score, ranked: None, stages: None }
    }

    /// A scene in whose truth there is no object.
    pub(super) fn bare(name: &str) -> SceneReport {
        let score =
            ImageScore { metrics: None, objects: Vec::new(), hypotheses: 9, hypotheses_off_objects: 9 };
        SceneReport { score, ..scene(name) }
    }

    pub(super) fn report(names: &[&str]) -> Report {
        Report::new(names.iter().map(|name| scene(name)).collect()).unwrap()
    }

    #[test]
    fn folders_are_summed_up_apart() {
        let joined = report(&["a0", "a1"]).joined(report(&["b0"])).unwrap();
        assert_eq!(joined.total, report(&["a0", "a1", "b0"]).total);
        let folders: Vec<_> =
            joined.folders().into_iter().map(|(name, totals)| (name, totals.counts.total())).collect();
        assert_eq!(folders, [("a", 4), ("b", 2)]);
        assert_eq!(joined.folders()[1].1, report(&["b0"]).total);
        let with_bare = Report::new(vec![bare("a0"), scene("b0")]).unwrap();
        assert_eq!(with_bare.folders().len(), 1, "a folder without objects has no figures");
    }

    pub(super) fn stages() -> Stages {
        let superpixels = StageMetrics {
            regions: 38.9,
            asa: 0.9976,
            object_asa: 0.9868,
            ue: 0.0048,
            boundary_recall: Some(0.982),
            contact_recall: None,
            coverage: 0.3,
            c75: 0.015,
        };
        Stages { superpixels: Some(superpixels), ..Stages::default() }
    }

    #[test]
    fn lines_are_those_of_the_scorer() {
        let report = report(&["learn0", "learn1"]);
        assert_eq!(report.scenes[0].to_string(), "learn0   1/2  oF 53.3 bF 33.3 %75 50.0");
        assert_eq!(
            report.total.to_string(),
            "correct 0.500 (2/4)  overlap P 80.0 R 40.0 F 53.3  boundary P 50.0 R 25.0 F 33.3  %75 50.0  WOv 0.675  \
             | occl 0 over 0 under 0 bnd 0 missed 2"
        );
    }

    #[test]
    fn halves_are_rounded_as_in_python() {
        // '%.1f' of 6.25, 18.75 and 0.25; exact in binary, so the tie goes to the even digit.
        let mut scene = scene("a0");
        let metrics = scene.score.metrics.as_mut().unwrap();
        (metrics.overlap.f, metrics.boundary.f, metrics.p75) = (0.0625, 0.1875, 0.0025);
        assert_eq!(scene.to_string(), "a0       1/2  oF 6.2 bF 18.8 %75 0.2");
    }

    #[test]
    fn a_scene_without_objects_counts_for_nothing() {
        let all = Report::new(vec![scene("a0"), bare("a1"), scene("a2")]).unwrap();
        assert_eq!(all.total, report(&["a0", "a2"]).total);
        assert_eq!(all.scenes[1].to_string(), "a1       0/0  no object in the truth: left out");
        assert!(matches!(Report::new(vec![bare("a1")]), Err(Error::NoObjects)));
        assert!(matches!(Report::new(Vec::new()), Err(Error::NoObjects)));
    }

    #[test]
    fn stages_are_averaged_where_they_were_watched() {
        let watched = |regions| {
            let mut stages = stages();
            stages.superpixels.as_mut().unwrap().regions = regions;
            SceneReport { stages: Some(stages), ..scene("a0") }
        };
        let report = Report::new(vec![watched(10.0), scene("a1"), watched(21.0)]).unwrap();
        let means = report.total.stages.unwrap();
        assert_eq!(means.superpixels.unwrap().regions, 15.5);
        assert_eq!(means.facets, None);
    }

    #[test]
    fn json_has_the_keys_of_the_scorer_in_the_order_of_the_scenes() {
        let mut report = report(&["b2", "a10"]);
        report.total.stages = Some(stages());
        let text = serde_json::to_string(&report).unwrap();
        assert!(text.find("b2") < text.find("a10"), "{text}");
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        let keys = |value: &serde_json::Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
        let metrics = ["bF", "bP", "bR"];
        let expected = ["WOv", "bF", "bP", "bR", "correct", "counts", "hypotheses", "hypotheses_off_objects"];
        assert_eq!(keys(&json["total"])[..8], expected);
        assert_eq!(keys(&json["total"])[8..], ["oF", "oP", "oR", "objects", "p75", "scenes", "stages"]);
        assert_eq!((&json["total"]["correct"], &json["total"]["objects"]), (&0.5.into(), &4.into()));
        assert_eq!(json["total"]["counts"]["missed"], 2);
        assert_eq!(json["total"]["stages"]["superpixels"]["asa"], 0.9976);

        let scene = &json["scenes"]["a10"];
        assert_eq!(keys(scene)[..3], metrics);
        assert_eq!(
            (&scene["correct"], &scene["objects"], &scene["folder"]),
            (&1.into(), &2.into(), &"a".into())
        );
        let object = serde_json::json!({"truth_label": 2, "pixels": 300, "iou": 0.9, "verdict": "correct"});
        assert_eq!(scene["verdicts"][0], object);
        assert_eq!(scene.get("stages"), None);
    }
}
