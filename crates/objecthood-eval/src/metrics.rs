//! Overlap, boundary and %75 of one image (docs/EVALUATION.md, Metrics): the protocol of unseen-object segmentation.

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use crate::assignment::maximize;
use crate::boundary::{Nearness, boundaries};
use crate::contingency::{Classes, Contingency};

/// Precision, recall and their harmonic mean F, each in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Prf {
    /// Share of what was said that is right.
    pub precision: f64,
    /// Share of what is there that was said.
    pub recall: f64,
    /// 2PR / (P + R); 0 where both are 0.
    pub f: f64,
}

impl Prf {
    fn new(precision: f64, recall: f64) -> Self {
        let sum = precision + recall;
        let f = if sum == 0.0 { 0.0 } else { 2.0 * precision * recall / sum };
        Self { precision, recall, f }
    }
}

/// The figures of one image, or their means over images.
///
/// Objects and hypotheses are paired so that the sum of the pairs' F is greatest. Serialized under the keys
/// [`ImageMetrics::KEYS`].
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct ImageMetrics {
    /// Pixels of matched pairs in common, over the pixels of all hypotheses (P) and of all objects (R).
    pub overlap: Prf,
    /// Boundary pixels of matched pairs near each other, over the boundary pixels of all hypotheses and all objects.
    pub boundary: Prf,
    /// Share of the objects whose match has F > 0.75.
    pub p75: f64,
}

impl ImageMetrics {
    /// The names of the figures in a report, as in `tools/score.py`.
    pub const KEYS: [&'static str; 7] = ["oP", "oR", "oF", "bP", "bR", "bF", "p75"];

    /// The figures in the order of [`Self::KEYS`].
    pub fn values(&self) -> [f64; 7] {
        let Self { overlap: o, boundary: b, p75 } = *self;
        [o.precision, o.recall, o.f, b.precision, b.recall, b.f, p75]
    }

    /// The inverse of [`Self::values`]; F is taken as given, because the mean of F is not the F of the means.
    pub(crate) fn from_values([op, or, of, bp, br, bf, p75]: [f64; 7]) -> Self {
        Self {
            overlap: Prf { precision: op, recall: or, f: of },
            boundary: Prf { precision: bp, recall: br, f: bf },
            p75,
        }
    }

    /// The figures of an image of `size` (columns, rows); `table` counts the pixels of `objects` in `hypotheses`.
    /// `None` without objects, all zero without hypotheses.
    pub(crate) fn of(
        objects: &Classes,
        hypotheses: &Classes,
        table: &Contingency,
        (width, height): (usize, usize),
    ) -> Option<Self> {
        if objects.len() == 0 {
            return None;
        }
        if hypotheses.len() == 0 {
            return Some(Self::default());
        }
        let pairs = matched(objects, hypotheses, table);
        let common: u64 = pairs.iter().map(|p| u64::from(table.row(p.g)[p.c])).sum();
        let share = |total: u64| common as f64 / total as f64;
        let close = pairs.iter().filter(|p| p.f > 0.75).count();
        Some(Self {
            overlap: Prf::new(share(hypotheses.total_px()), share(objects.total_px())),
            boundary: boundary(objects, hypotheses, &pairs, width, height),
            p75: close as f64 / objects.len() as f64,
        })
    }
}

impl Serialize for ImageMetrics {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(Self::KEYS.len()))?;
        for (key, value) in Self::KEYS.iter().zip(self.values()) {
            map.serialize_entry(key, &value)?;
        }
        map.end()
    }
}

/// An object and the hypothesis assigned to it.
pub(crate) struct Pair {
    /// The object.
    pub(crate) g: usize,
    /// The hypothesis.
    pub(crate) c: usize,
    /// Harmonic mean of the shares that they have of each other.
    pub(crate) f: f64,
}

/// Objects and hypotheses, at least one of each, paired so that the sum of the pairs' F is greatest.
pub(crate) fn matched(objects: &Classes, hypotheses: &Classes, table: &Contingency) -> Vec<Pair> {
    let f = pairwise_f(objects, hypotheses, table);
    let pairs = maximize(&f, objects.len(), hypotheses.len()).into_iter();
    pairs.map(|(g, c)| Pair { g, c, f: f[g * hypotheses.len() + c] }).collect()
}

/// F of every object (row) with every hypothesis (column); 0 where they have no pixel in common.
fn pairwise_f(objects: &Classes, hypotheses: &Classes, table: &Contingency) -> Vec<f64> {
    let mut f = Vec::with_capacity(objects.len() * hypotheses.len());
    for (g, &object_px) in objects.pixels.iter().enumerate() {
        let row = table.row(g).iter().zip(&hypotheses.pixels);
        f.extend(row.map(|(&common, &hypothesis_px)| pair_f(common, object_px, hypothesis_px)));
    }
    f
}

/// F of an object with a hypothesis: the harmonic mean of the shares of their common pixels.
pub(crate) fn pair_f(common: u32, object_px: u32, hypothesis_px: u32) -> f64 {
    let precision = f64::from(common) / f64::from(hypothesis_px);
    let recall = f64::from(common) / f64::from(object_px);
    if common > 0 { 2.0 * precision * recall / (precision + recall).max(1e-12) } else { 0.0 }
}

fn boundary(objects: &Classes, hypotheses: &Classes, pairs: &[Pair], width: usize, height: usize) -> Prf {
    let of_objects = boundaries(objects, width);
    let of_hypotheses = boundaries(hypotheses, width);
    let mut nearness = Nearness::new(width, height);
    let (mut right, mut found) = (0, 0);
    for &Pair { g, c, .. } in pairs.iter().filter(|p| p.f > 0.0) {
        right += nearness.count(&of_hypotheses[c], &of_objects[g]);
        found += nearness.count(&of_objects[g], &of_hypotheses[c]);
    }
    let share = |count: usize, all: &[Vec<u32>]| {
        let total: usize = all.iter().map(Vec::len).sum();
        count as f64 / total.max(1) as f64
    };
    Prf::new(share(right, &of_hypotheses), share(found, &of_objects))
}
