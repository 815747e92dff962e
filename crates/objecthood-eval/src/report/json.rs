//! Reports under the keys of `tools/score.py`, with ours added.

use serde::ser::{Serialize, SerializeMap, SerializeStruct, Serializer};

use super::{Report, SceneReport, Totals};
use crate::metrics::ImageMetrics;
use crate::ranking::Ranking;
use crate::stages::Stages;
use crate::verdict::{ObjectScore, VerdictCounts};

#[derive(serde::Serialize)]
struct TotalsJson<'a> {
    #[serde(flatten)]
    metrics: &'a ImageMetrics,
    #[serde(rename = "WOv")]
    weighted_overlap: f64,
    objects: usize,
    correct: f64,
    counts: &'a VerdictCounts,
    scenes: usize,
    hypotheses: usize,
    hypotheses_off_objects: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    ranking: Option<&'a Ranking>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stages: Option<&'a Stages>,
}

impl Serialize for Totals {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let json = TotalsJson {
            metrics: &self.metrics,
            weighted_overlap: self.weighted_overlap,
            objects: self.counts.total(),
            correct: self.correct(),
            counts: &self.counts,
            scenes: self.scenes,
            hypotheses: self.hypotheses,
            hypotheses_off_objects: self.hypotheses_off_objects,
            ranking: self.ranking.as_ref(),
            stages: self.stages.as_ref(),
        };
        json.serialize(serializer)
    }
}

#[derive(serde::Serialize)]
struct SceneJson<'a> {
    folder: &'a str,
    #[serde(flatten)]
    metrics: Option<&'a ImageMetrics>,
    correct: usize,
    objects: usize,
    hypotheses: usize,
    hypotheses_off_objects: usize,
    verdicts: &'a [ObjectScore],
    #[serde(skip_serializing_if = "Option::is_none")]
    stages: Option<&'a Stages>,
}

impl Serialize for SceneReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let json = SceneJson {
            folder: &self.folder,
            metrics: self.score.metrics.as_ref(),
            correct: self.counts().correct,
            objects: self.score.objects.len(),
            hypotheses: self.score.hypotheses,
            hypotheses_off_objects: self.score.hypotheses_off_objects,
            verdicts: &self.score.objects,
            stages: self.stages.as_ref(),
        };
        json.serialize(serializer)
    }
}

impl Serialize for Report {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut report = serializer.serialize_struct("Report", 3)?;
        report.serialize_field("total", &self.total)?;
        report.serialize_field("folders", &ByName(self.folders()))?;
        let by_name = self.scenes.iter().map(|scene| (scene.name.as_str(), scene));
        report.serialize_field("scenes", &ByName(by_name.collect()))?;
        report.end()
    }
}

/// Figures as a map, in their own order.
struct ByName<'a, T>(Vec<(&'a str, T)>);

impl<T: Serialize> Serialize for ByName<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, figures) in &self.0 {
            map.serialize_entry(name, figures)?;
        }
        map.end()
    }
}
