//! How well objectness ranks: average precision over the hypotheses of many scenes.

use std::fmt;

use objecthood::{Object, Raster};
use serde::Serialize;

use crate::error::Result;
use crate::score::compared;
use crate::truth::Truth;

/// A hypothesis finds an object when their `IoU` is greater; of no object there can be two such.
const FOUND_IOU: f64 = 0.5;

/// A hypothesis, by what it could be ranked, and whether it finds an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ranked {
    /// Its objectness.
    pub objectness: f32,
    /// The part of it that tells of size.
    pub size: f32,
    /// The part of it that tells of support.
    pub support: f32,
    /// Its pixels.
    pub pixels: usize,
    /// Whether its `IoU` with an object is above 0.5.
    pub finds: bool,
}

/// Average precision of rankings by objectness, and by less than that.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ranking {
    /// Hypotheses that were ranked.
    pub hypotheses: usize,
    /// Objects of the truth.
    pub objects: usize,
    /// Objects that are found by a hypothesis, whatever its rank.
    pub found: usize,
    /// By objectness. The most that any ranking of these hypotheses could have is `found / objects`.
    pub average_precision: f64,
    /// By the part that tells of size alone.
    pub by_size: f64,
    /// By the part that tells of support alone.
    pub by_support: f64,
    /// By the number of pixels alone.
    pub by_pixels: f64,
}

impl fmt::Display for Ranking {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { hypotheses, objects, found, average_precision, by_size, by_support, by_pixels } = self;
        write!(f, "average precision {average_precision:.3} of {:.3}", *found as f64 / *objects as f64)?;
        write!(f, " (by size {by_size:.3}, support {by_support:.3}, pixels {by_pixels:.3})")?;
        write!(f, ", {hypotheses} hypotheses find {found} of {objects} objects")
    }
}

/// The hypotheses of a frame; `objects` are those of the label image. What lies wholly where the truth is to be ignored is left out.
/// O(n log k) for n pixels and k objects.
///
/// # Errors
/// As [`score`](crate::score::score).
pub fn ranked(labels: &Raster<u16>, objects: &[Object], truth: &Truth) -> Result<Vec<Ranked>> {
    let (truly, hypotheses, table) = compared(labels, truth)?;
    let finds = |h: usize| {
        (0..truly.len()).any(|g| {
            let common = f64::from(table.row(g)[h]);
            let union = f64::from(truly.pixels[g]) + f64::from(hypotheses.pixels[h]) - common;
            common > FOUND_IOU * union
        })
    };
    let of_object = |object: &Object| {
        let h = hypotheses.labels.binary_search(&u32::from(object.id.0)).ok()?;
        Some(Ranked {
            objectness: object.objectness,
            size: object.parts.size,
            support: object.parts.support,
            pixels: object.size_px,
            finds: finds(h),
        })
    };
    Ok(objects.iter().filter_map(of_object).collect())
}

impl Ranking {
    /// Sums up hypotheses of all scenes, whose truth holds so many objects; `None` without objects.
    pub fn of(ranked: &[Ranked], objects: usize) -> Option<Self> {
        let by = |key: &dyn Fn(&Ranked) -> f64| average_precision(ranked, objects, key);
        (objects > 0).then(|| Self {
            hypotheses: ranked.len(),
            objects,
            found: ranked.iter().filter(|hypothesis| hypothesis.finds).count(),
            average_precision: by(&|h| h.objectness.into()),
            by_size: by(&|h| h.size.into()),
            by_support: by(&|h| h.support.into()),
            by_pixels: by(&|h| h.pixels as f64),
        })
    }
}

/// The area below precision over recall, where precision is the greatest at that recall or more (as in PASCAL VOC since 2010).
/// Hypotheses of equal rank are taken together, so their order does not matter. O(n log n).
fn average_precision(ranked: &[Ranked], objects: usize, key: impl Fn(&Ranked) -> f64) -> f64 {
    let mut order: Vec<(f64, bool)> = ranked.iter().map(|h| (key(h), h.finds)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (mut taken, mut found) = (0, 0);
    let points: Vec<(usize, f64)> = order
        .chunk_by(|a, b| a.0 == b.0)
        .map(|equal| {
            taken += equal.len();
            found += equal.iter().filter(|(_, finds)| *finds).count();
            (found, found as f64 / taken as f64)
        })
        .collect();
    let (mut area, mut best, mut above) = (0.0, 0.0_f64, points.last().map_or(0, |last| last.0));
    for (k, &(_, precision)) in points.iter().enumerate().rev() {
        best = best.max(precision);
        let below = k.checked_sub(1).map_or(0, |before| points[before].0);
        area += best * (above - below) as f64;
        above = below;
    }
    area / objects as f64
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn hypothesis(objectness: f32, finds: bool) -> Ranked {
        Ranked { objectness, size: 1.0, support: 0.5, pixels: 1, finds }
    }

    fn precision(ranked: &[Ranked], objects: usize) -> f64 {
        Ranking::of(ranked, objects).unwrap().average_precision
    }

    #[test]
    fn what_is_found_first_counts_most() {
        let [yes, no] = [true, false].map(|finds| move |objectness| hypothesis(objectness, finds));
        assert_eq!(precision(&[yes(0.9), yes(0.8), no(0.1)], 2), 1.0);
        assert_eq!(precision(&[yes(0.9), yes(0.8)], 4), 0.5, "two are not found");
        // Precision 1 at recall 1/2, then 2/3 at recall 1.
        assert!((precision(&[yes(0.9), no(0.8), yes(0.7)], 2) - (0.5 + 0.5 * 2.0 / 3.0)).abs() < 1e-12);
        // The first is wrong: precision 1/2, then 2/3, which is the better of both.
        assert!((precision(&[no(0.9), yes(0.8), yes(0.7)], 2) - 2.0 / 3.0).abs() < 1e-12);
        assert_eq!(precision(&[], 3), 0.0);
        assert_eq!(Ranking::of(&[yes(1.0)], 0), None);
    }

    #[test]
    fn ties_are_taken_together() {
        let ranked = [hypothesis(0.5, true), hypothesis(0.5, false)];
        assert_eq!(precision(&ranked, 1), 0.5);
        let all = Ranking::of(&ranked, 1).unwrap();
        assert_eq!((all.by_size, all.by_support, all.by_pixels), (0.5, 0.5, 0.5));
    }

    proptest! {
        /// The definition, recall by recall.
        #[test]
        fn the_area_is_that_of_the_definition(
            ranked in prop::collection::vec((0_u8..5, any::<bool>()), 0..20),
            more in 1_usize..4,
        ) {
            let ranked: Vec<_> = ranked.into_iter().map(|(o, f)| hypothesis(f32::from(o), f)).collect();
            let objects = ranked.iter().filter(|h| h.finds).count() + more;
            let at = |least: u8| {
                let taken: Vec<_> = ranked.iter().filter(|h| h.objectness >= f32::from(least)).collect();
                let found = taken.iter().filter(|h| h.finds).count();
                (found, if taken.is_empty() { 0.0 } else { found as f64 / taken.len() as f64 })
            };
            let precision_at =
                |recall| (0..5).map(at).filter(|&(found, _)| found >= recall).map(|(_, p)| p).fold(0.0, f64::max);
            let expected = (1..=objects).map(precision_at).sum::<f64>() / objects as f64;
            prop_assert!((precision(&ranked, objects) - expected).abs() < 1e-12);
        }
    }
}
