//! A label image held against the truth of its frame.

use objecthood::Raster;

use crate::contingency::{Classes, Contingency};
use crate::error::{Error, Result};
use crate::metrics::ImageMetrics;
use crate::truth::Truth;
use crate::verdict::{ObjectScore, judge};

/// How well one label image agrees with the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageScore {
    /// Overlap, boundary and %75; `None` where the truth has no object.
    pub metrics: Option<ImageMetrics>,
    /// Every object of the truth by ascending label, and what became of it.
    pub objects: Vec<ObjectScore>,
    /// Hypotheses with at least one pixel that counts.
    pub hypotheses: usize,
    /// Hypotheses of which fewer than half of the pixels that count lie on objects.
    pub hypotheses_off_objects: usize,
}

/// Scores `labels` (0 = no object, other values = one object each) against `truth`. O(n log k) for n pixels and k
/// hypotheses, plus the assignment.
///
/// What is predicted where the truth is to be ignored does not count (METHOD 4.1).
///
/// # Errors
/// [`Error::PredictionSize`] when the sizes differ, [`Error::TooManyRegions`] when objects times hypotheses exceed
/// memory.
pub fn score(labels: &Raster<u16>, truth: &Truth) -> Result<ImageScore> {
    let size = truth.size();
    if labels.size() != size {
        return Err(Error::PredictionSize { labels: labels.size(), truth: size });
    }
    let objects = Classes::of(labels.len(), |i| truth.object_at(i));
    let hypothesis_at =
        |i: usize| (labels[i] > 0 && truth.label_at(i).is_some()).then(|| u32::from(labels[i]));
    let hypotheses = Classes::of(labels.len(), hypothesis_at);
    let table = Contingency::of(&objects, &hypotheses)?;

    let on_objects = table.column_sums();
    let off = on_objects.iter().zip(&hypotheses.pixels).filter(|&(&on, &all)| 2 * on < all).count();
    Ok(ImageScore {
        metrics: ImageMetrics::of(&objects, &hypotheses, &table, size),
        objects: judge(&objects, &hypotheses, &table, truth)?,
        hypotheses: hypotheses.len(),
        hypotheses_off_objects: off,
    })
}
