//! What became of each object, strictly judged (docs/EVALUATION.md, Verdicts).

use std::ops::AddAssign;

use serde::Serialize;

use crate::contingency::{Classes, Contingency};
use crate::error::Result;
use crate::numpy;
use crate::truth::Truth;

/// The outcome for one object; the first rule that holds counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// One hypothesis with `IoU` >= 0.75 that takes less than 10 % of itself from other objects, and no second one that
    /// holds 10 % of the object.
    Correct,
    /// Less than half of the object lies in hypotheses.
    Missed,
    /// An occluder cuts the object in at least two parts, and its main hypothesis takes less than 25 % from others.
    Occlusion,
    /// The main hypothesis takes at least 10 % of itself from other objects, or more than 25 % from no object.
    Under,
    /// At least 10 % of the object lies outside its main hypothesis, in others.
    Over,
    /// None of these: the border is off.
    Boundary,
}

/// How often each verdict was given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize)]
pub struct VerdictCounts {
    /// Of [`Verdict::Correct`].
    pub correct: usize,
    /// Of [`Verdict::Occlusion`].
    pub occlusion: usize,
    /// Of [`Verdict::Over`].
    pub over: usize,
    /// Of [`Verdict::Under`].
    pub under: usize,
    /// Of [`Verdict::Boundary`].
    pub boundary: usize,
    /// Of [`Verdict::Missed`].
    pub missed: usize,
}

impl VerdictCounts {
    /// All verdicts given.
    pub fn total(&self) -> usize {
        let Self { correct, occlusion, over, under, boundary, missed } = self;
        correct + occlusion + over + under + boundary + missed
    }
}

impl AddAssign<Verdict> for VerdictCounts {
    fn add_assign(&mut self, verdict: Verdict) {
        *match verdict {
            Verdict::Correct => &mut self.correct,
            Verdict::Occlusion => &mut self.occlusion,
            Verdict::Over => &mut self.over,
            Verdict::Under => &mut self.under,
            Verdict::Boundary => &mut self.boundary,
            Verdict::Missed => &mut self.missed,
        } += 1;
    }
}

impl FromIterator<Verdict> for VerdictCounts {
    fn from_iter<I: IntoIterator<Item = Verdict>>(verdicts: I) -> Self {
        let mut counts = Self::default();
        verdicts.into_iter().for_each(|v| counts += v);
        counts
    }
}

/// One object of the truth and what became of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ObjectScore {
    /// Its label in the truth.
    pub truth_label: u32,
    /// Its pixels.
    pub pixels: usize,
    /// Intersection over union with the hypothesis for which that is greatest; 0 without hypotheses.
    pub iou: f64,
    /// The verdict.
    pub verdict: Verdict,
}

/// Judges every object; `table` counts the pixels of `objects` in `hypotheses`.
pub(crate) fn judge(
    objects: &Classes,
    hypotheses: &Classes,
    table: &Contingency,
    truth: &Truth,
) -> Result<Vec<ObjectScore>> {
    let large_parts = large_parts(objects, truth)?;
    let on_objects = table.column_sums();
    let judged = (0..objects.len()).map(|g| {
        let pixels = objects.pixels[g];
        let (iou, verdict) = judge_one(pixels, table.row(g), hypotheses, &on_objects, large_parts[g]);
        ObjectScore { truth_label: objects.labels[g], pixels: pixels as usize, iou, verdict }
    });
    Ok(judged.collect())
}

/// How many parts of at least 5 % of its pixels each object has.
fn large_parts(objects: &Classes, truth: &Truth) -> Result<Vec<usize>> {
    let parts = Classes::of(truth.parts().len(), |i| Some(truth.parts()[i]));
    let table = Contingency::of(objects, &parts)?;
    let count = |g: usize| {
        let least = 0.05 * f64::from(objects.pixels[g]);
        let parts = table.row(g).iter().zip(&parts.pixels);
        parts.filter(|&(&common, &part_px)| common > 0 && f64::from(part_px) >= least).count()
    };
    Ok((0..objects.len()).map(count).collect())
}

/// Greatest `IoU` and verdict of an object of `object_px` pixels, `common` of which lie in each hypothesis; `on_objects`
/// are the pixels of each hypothesis on any object.
fn judge_one(
    object_px: u32,
    common: &[u32],
    hypotheses: &Classes,
    on_objects: &[u32],
    large_parts: usize,
) -> (f64, Verdict) {
    let shares: Vec<f64> = common.iter().map(|&n| f64::from(n) / f64::from(object_px)).collect();
    let ious: Vec<f64> = common
        .iter()
        .zip(&hypotheses.pixels)
        .map(|(&n, &px)| f64::from(n) / (f64::from(object_px) + f64::from(px) - f64::from(n)))
        .collect();
    let (Some(best), Some(main)) = (first_greatest(&ious), first_greatest(&shares)) else {
        return (0.0, Verdict::Missed);
    };
    // Shares of a hypothesis on other objects, and on none.
    let alien = |c: usize| f64::from(on_objects[c] - common[c]) / f64::from(hypotheses.pixels[c]);
    let off = |c: usize| f64::from(hypotheses.pixels[c] - on_objects[c]) / f64::from(hypotheses.pixels[c]);
    let second = shares.iter().enumerate().filter(|&(c, _)| c != main).map(|(_, &s)| s).fold(0.0, f64::max);
    let held = numpy::sum(&shares);

    let verdict = if ious[best] >= 0.75 && alien(best) < 0.10 && second < 0.10 {
        Verdict::Correct
    } else if held < 0.5 {
        Verdict::Missed
    } else if large_parts >= 2 && alien(main) < 0.25 {
        Verdict::Occlusion
    } else if alien(main) >= 0.10 || off(main) > 0.25 {
        Verdict::Under
    } else if second >= 0.10 || held - shares[main] >= 0.10 {
        Verdict::Over
    } else {
        Verdict::Boundary
    };
    (ious[best], verdict)
}

/// The place of the greatest value, the first of equals, as `numpy.argmax`.
fn first_greatest(values: &[f64]) -> Option<usize> {
    (0..values.len()).reduce(|best, k| if values[k] > values[best] { k } else { best })
}
