//! A label image held against the truth of its frame.

use objecthood::Raster;

use crate::contingency::{Classes, Contingency};
use crate::error::{Error, Result};
use crate::metrics::{ImageMetrics, matched};
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
/// What is predicted where the truth is to be ignored does not count (docs/EVALUATION.md, Preparation).
///
/// # Errors
/// [`Error::PredictionSize`] when the sizes differ, [`Error::TooManyRegions`] when objects times hypotheses exceed
/// memory.
pub fn score(labels: &Raster<u16>, truth: &Truth) -> Result<ImageScore> {
    let (objects, hypotheses, table) = compared(labels, truth)?;
    let on_objects = table.column_sums();
    let off = on_objects.iter().zip(&hypotheses.pixels).filter(|&(&on, &all)| 2 * on < all).count();
    Ok(ImageScore {
        metrics: ImageMetrics::of(&objects, &hypotheses, &table, truth.size()),
        objects: judge(&objects, &hypotheses, &table, truth)?,
        hypotheses: hypotheses.len(),
        hypotheses_off_objects: off,
    })
}

/// `labels` with the numbers that `truth` has: what is matched with the k-th object is k, other hypotheses follow, in their
/// order, after the objects. Numbers that 16 bits do not hold become 0.
///
/// So that pictures of both show what belongs together in one colour. Where the truth is to be ignored nothing shows.
///
/// # Errors
/// As [`score`].
pub fn numbered_as_truth(labels: &Raster<u16>, truth: &Truth) -> Result<Raster<u16>> {
    let (objects, hypotheses, table) = compared(labels, truth)?;
    let mut numbers = vec![None; hypotheses.len()];
    if objects.len() > 0 && hypotheses.len() > 0 {
        for pair in matched(&objects, &hypotheses, &table).iter().filter(|pair| pair.f > 0.0) {
            numbers[pair.c] = Some(1 + pair.g);
        }
    }
    let more = numbers.iter_mut().filter(|number| number.is_none());
    more.zip(objects.len() + 1..).for_each(|(number, next)| *number = Some(next));
    let number = |class: &u32| numbers.get(*class as usize).copied().flatten().unwrap_or(0);
    let numbered = hypotheses.at.iter().map(|class| u16::try_from(number(class)).unwrap_or(0));
    let (width, height) = labels.size();
    Ok(Raster::from_vec(width, height, numbered.collect())?)
}

/// The objects of the truth, 1.. by ascending label, 0 where there is none.
///
/// # Errors
/// As [`score`].
pub fn object_map(truth: &Truth) -> Result<Raster<u16>> {
    let objects = Classes::of(truth.labels().len(), |i| truth.object_at(i));
    let numbered = objects.at.iter().map(|&class| u16::try_from(class.wrapping_add(1)).unwrap_or(0));
    let (width, height) = truth.size();
    Ok(Raster::from_vec(width, height, numbered.collect())?)
}

/// The objects, the hypotheses where they count, and their pixels in common.
pub(crate) fn compared(labels: &Raster<u16>, truth: &Truth) -> Result<(Classes, Classes, Contingency)> {
    if labels.size() != truth.size() {
        return Err(Error::PredictionSize { labels: labels.size(), truth: truth.size() });
    }
    let objects = Classes::of(labels.len(), |i| truth.object_at(i));
    let hypothesis_at =
        |i: usize| (labels[i] > 0 && truth.label_at(i).is_some()).then(|| u32::from(labels[i]));
    let hypotheses = Classes::of(labels.len(), hypothesis_at);
    let table = Contingency::of(&objects, &hypotheses)?;
    Ok((objects, hypotheses, table))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mosd::truth_of;

    #[test]
    fn hypotheses_get_the_numbers_of_their_objects() {
        let raster = |values: &[u32]| Raster::from_vec(values.len(), 1, values.to_vec()).unwrap();
        // Objects 20 (3 px), 30 (4 px) and 40, which nothing finds; 9 is cut in two, 3 lies on the table.
        let truth = truth_of(&raster(&[20, 20, 20, 30, 30, 30, 30, 1, 1, 40, 0])).unwrap();
        let labels = Raster::from_vec(11, 1, vec![7, 7, 0, 9, 9, 9, 4, 3, 0, 0, 7]).unwrap();
        let numbered = numbered_as_truth(&labels, &truth).unwrap();
        assert_eq!(numbered.as_slice(), [1, 1, 0, 2, 2, 2, 5, 4, 0, 0, 0]);
        assert_eq!(object_map(&truth).unwrap().as_slice(), [1, 1, 1, 2, 2, 2, 2, 0, 0, 3, 0]);
        let none = Raster::filled(11, 1, 0).unwrap();
        assert_eq!(numbered_as_truth(&none, &truth).unwrap(), none);
        assert!(numbered_as_truth(&Raster::filled(3, 1, 0).unwrap(), &truth).is_err());
    }
}
