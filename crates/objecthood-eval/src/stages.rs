//! Diagnostics of the stages before there are objects (docs/EVALUATION.md, Stages): do superpixels, facets and shapes keep to the
//! borders of the truth, and how much of an object does one of them hold?

use std::borrow::Cow;

use objecthood::{Observer, Output, Segments};
use serde::Serialize;

use crate::contingency::{Classes, Contingency};
use crate::error::{Error, Result};
use crate::numpy;
use crate::truth::Truth;

/// How the regions of one stage fit the truth; of one image, or the mean over images.
///
/// Only pixels that count (those the truth does not ignore) are looked at. The background is a region of the truth
/// like the objects, where a figure does not say "object".
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StageMetrics {
    /// Regions with at least one pixel that counts.
    pub regions: f64,
    /// Achievable segmentation accuracy: the share of pixels that would be right if every region had the label of
    /// most of its pixels (the smallest label among equals).
    pub asa: f64,
    /// The same on objects: of the pixels of objects, the share that would be right.
    pub object_asa: f64,
    /// Under-segmentation error: what regions hold of each truth region, or leave of themselves outside, whichever is
    /// less, over all pixels.
    pub ue: f64,
    /// Of the object pixels next to another truth label, the share within two rows and columns of a region border.
    /// `None` where there is no such pixel.
    pub boundary_recall: Option<f64>,
    /// The same for the pixels where two truth regions touch. `None` where none do.
    pub contact_recall: Option<f64>,
    /// Mean over objects, weighted by size, of the best `IoU` with one region.
    pub coverage: f64,
    /// Share of objects whose best `IoU` with one region is at least 0.75.
    pub c75: f64,
}

impl StageMetrics {
    /// Measures `segments` against `truth`, or `None` if the truth has no object.
    ///
    /// # Errors
    /// [`Error::SegmentsSize`] when the sizes differ, [`Error::TooManyRegions`] when segments times truth regions
    /// exceed memory.
    pub fn of(segments: &Segments, truth: &Truth) -> Result<Option<Self>> {
        let size = truth.size();
        if segments.labels().size() != size {
            return Err(Error::SegmentsSize { segments: segments.labels().size(), truth: size });
        }
        let len = segments.labels().len();
        let region_at = |i: usize| truth.label_at(i).and_then(|_| segments.at(i)).map(|s| s.0);
        let regions = Classes::of(len, region_at);
        let truths = Classes::of(len, |i| truth.label_at(i));
        let is_object: Vec<bool> = truths.labels.iter().map(|&l| truth.is_object(l)).collect();
        if !is_object.contains(&true) {
            return Ok(None);
        }
        let table = Contingency::of(&truths, &regions)?;

        let purity = Purity::of(&regions, &table, &is_object);
        let best_iou = |g: usize| {
            let union = |c: usize, common: u32| truths.pixels[g] + regions.pixels[c] - common;
            let ious = table.row(g).iter().enumerate().map(|(c, &n)| f64::from(n) / f64::from(union(c, n)));
            ious.fold(0.0, f64::max)
        };
        let objects: Vec<(f64, f64)> = (0..truths.len())
            .filter(|&g| is_object[g])
            .map(|g| (f64::from(truths.pixels[g]), best_iou(g)))
            .collect();
        let object_px: f64 = objects.iter().map(|o| o.0).sum();
        let total_px = truths.total_px() as f64;
        let recall = Recall::of(segments, truth);
        Ok(Some(Self {
            regions: regions.len() as f64,
            asa: purity.right_px as f64 / total_px,
            object_asa: purity.right_object_px as f64 / object_px,
            ue: purity.leaked_px as f64 / total_px,
            boundary_recall: recall.boundary,
            contact_recall: recall.contact,
            coverage: objects.iter().map(|(px, iou)| px * iou).sum::<f64>() / object_px,
            c75: objects.iter().filter(|o| o.1 >= 0.75).count() as f64 / objects.len() as f64,
        }))
    }

    /// The mean of every figure over the images in which it is defined; `None` of no image.
    pub fn mean<'a>(images: impl IntoIterator<Item = &'a Self>) -> Option<Self> {
        let images: Vec<&Self> = images.into_iter().collect();
        let defined = |figure: fn(&Self) -> Option<f64>| {
            numpy::mean(&images.iter().filter_map(|m| figure(m)).collect::<Vec<_>>())
        };
        Some(Self {
            regions: defined(|m| Some(m.regions))?,
            asa: defined(|m| Some(m.asa))?,
            object_asa: defined(|m| Some(m.object_asa))?,
            ue: defined(|m| Some(m.ue))?,
            boundary_recall: defined(|m| m.boundary_recall),
            contact_recall: defined(|m| m.contact_recall),
            coverage: defined(|m| Some(m.coverage))?,
            c75: defined(|m| Some(m.c75))?,
        })
    }
}

/// What the overlaps of regions and truth regions say.
#[derive(Default)]
struct Purity {
    right_px: u64,
    right_object_px: u64,
    leaked_px: u64,
}

impl Purity {
    /// `table` counts the pixels of truth regions (rows) in `regions`.
    fn of(regions: &Classes, table: &Contingency, is_object: &[bool]) -> Self {
        let mut purity = Self::default();
        for (c, &region_px) in regions.pixels.iter().enumerate() {
            let (mut most, mut of_object) = (0, false);
            for (g, &object) in is_object.iter().enumerate() {
                let common = table.row(g)[c];
                if common > most {
                    (most, of_object) = (common, object);
                }
                purity.leaked_px += u64::from(common.min(region_px - common));
            }
            purity.right_px += u64::from(most);
            purity.right_object_px += if of_object { u64::from(most) } else { 0 };
        }
        purity
    }
}

/// How much of the contours in the truth lies near region borders.
struct Recall {
    boundary: Option<f64>,
    contact: Option<f64>,
}

impl Recall {
    fn of(segments: &Segments, truth: &Truth) -> Self {
        let (width, height) = truth.size();
        let near_border = near_borders(segments, width, height);
        let share = |on_contour: &dyn Fn(usize) -> bool| {
            let (mut all, mut near) = (0, 0);
            for i in (0..near_border.len()).filter(|&i| on_contour(i)) {
                all += 1;
                near += usize::from(near_border[i]);
            }
            (all > 0).then(|| near as f64 / all as f64)
        };
        let labels = truth.labels();
        let has_neighbour = |i: usize, fits: &dyn Fn(usize) -> bool| neighbours(i, width, height).any(fits);
        Self {
            boundary: share(&|i| {
                truth.object_at(i).is_some() && has_neighbour(i, &|j| labels[j] != labels[i])
            }),
            contact: share(&|i| {
                truth.label_at(i).is_some()
                    && has_neighbour(i, &|j| labels[j] != labels[i] && truth.label_at(j).is_some())
            }),
        }
    }
}

/// The pixels to the left, right, top and bottom of pixel `i` that are in the image.
fn neighbours(i: usize, width: usize, height: usize) -> impl Iterator<Item = usize> {
    let (u, v) = (i % width, i / width);
    [
        (u > 0).then(|| i - 1),
        (u + 1 < width).then(|| i + 1),
        (v > 0).then(|| i - width),
        (v + 1 < height).then(|| i + width),
    ]
    .into_iter()
    .flatten()
}

/// Whether the 5 x 5 square around each pixel holds one with a 4-neighbour of another segment or of none.
fn near_borders(segments: &Segments, width: usize, height: usize) -> Vec<bool> {
    const REACH: usize = 2;
    let labels = segments.labels();
    let mut near = vec![false; labels.len()];
    for i in 0..labels.len() {
        if neighbours(i, width, height).any(|j| labels[j] != labels[i]) {
            let (u, v) = (i % width, i / width);
            for row in v.saturating_sub(REACH)..(v + REACH + 1).min(height) {
                let (left, right) = (u.saturating_sub(REACH), (u + REACH + 1).min(width));
                near[row * width + left..row * width + right].fill(true);
            }
        }
    }
    near
}

/// The diagnostics of the three stages that make regions; `None` where a stage was not seen.
#[derive(Clone, Copy, Debug, PartialEq, Default, Serialize)]
pub struct Stages {
    /// Of stage 1.
    pub superpixels: Option<StageMetrics>,
    /// Of stage 2.
    pub facets: Option<StageMetrics>,
    /// Of stage 3.
    pub shapes: Option<StageMetrics>,
}

impl Stages {
    /// The stages by name, in their order.
    pub fn by_name(&self) -> [(&'static str, Option<&StageMetrics>); 3] {
        [
            ("superpixels", self.superpixels.as_ref()),
            ("facets", self.facets.as_ref()),
            ("shapes", self.shapes.as_ref()),
        ]
    }

    /// The mean of each stage over the images in which it was seen; `None` if it was seen in none.
    pub fn mean<'a>(images: impl IntoIterator<Item = &'a Self>) -> Option<Self> {
        let images: Vec<&Self> = images.into_iter().collect();
        let mean = |stage: fn(&Self) -> Option<&StageMetrics>| {
            StageMetrics::mean(images.iter().filter_map(|s| stage(s)))
        };
        let means = Self {
            superpixels: mean(|s| s.superpixels.as_ref()),
            facets: mean(|s| s.facets.as_ref()),
            shapes: mean(|s| s.shapes.as_ref()),
        };
        (means != Self::default()).then_some(means)
    }
}

/// Measures the stages of one frame while a method runs.
pub struct StageObserver<'a> {
    truth: &'a Truth,
    stages: Result<Stages>,
}

impl<'a> StageObserver<'a> {
    /// Will measure against `truth`, which belongs to the frame that is looked at.
    pub fn new(truth: &'a Truth) -> Self {
        Self { truth, stages: Ok(Stages::default()) }
    }

    /// What was measured.
    ///
    /// # Errors
    /// The first of [`StageMetrics::of`].
    pub fn into_stages(self) -> Result<Stages> {
        self.stages
    }
}

impl Observer for StageObserver<'_> {
    fn observe(&mut self, output: Output<'_>) {
        let Ok(stages) = &mut self.stages else { return };
        let (segments, metrics) = match output {
            Output::Superpixels(map) => (map.segments(), &mut stages.superpixels),
            Output::Facets(segments) => (Cow::Borrowed(segments), &mut stages.facets),
            Output::Shapes(map) => (map.segments(), &mut stages.shapes),
            _ => return,
        };
        match StageMetrics::of(&segments, self.truth) {
            Ok(measured) => *metrics = measured,
            Err(error) => self.stages = Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use objecthood::Raster;
    use proptest::prelude::*;

    use super::*;
    use crate::truth::Roles;

    const MOSD: Roles = Roles { ignore: Some(0), background: Some(1) };

    /// docs/EVALUATION.md, Stages, read literally: every count by a loop over all pixels, `t[v][u]` the truth, `r[v][u]` the region.
    fn by_force(r: &[Vec<i32>], t: &[Vec<u32>], roles: Roles) -> Option<StageMetrics> {
        let (height, width) = (r.len() as i32, r[0].len() as i32);
        let pixels: Vec<(i32, i32)> = (0..height).flat_map(|v| (0..width).map(move |u| (u, v))).collect();
        let region = |(u, v): (i32, i32)| r[v as usize][u as usize];
        let truth = |(u, v): (i32, i32)| t[v as usize][u as usize];
        let inside = |(u, v): &(i32, i32)| (0..width).contains(u) && (0..height).contains(v);
        let counts = |p: (i32, i32)| Some(truth(p)) != roles.ignore;
        let is_object = |l: u32| Some(l) != roles.ignore && Some(l) != roles.background;
        let four = |(u, v): (i32, i32)| {
            [(u - 1, v), (u + 1, v), (u, v - 1), (u, v + 1)].into_iter().filter(inside).collect::<Vec<_>>()
        };
        let count = |fits: &dyn Fn((i32, i32)) -> bool| pixels.iter().filter(|&&p| fits(p)).count() as f64;

        let labelled = count(&counts);
        let object_px = count(&|p| is_object(truth(p)));
        if object_px == 0.0 {
            return None;
        }
        let (mut regions, mut asa, mut object_asa, mut ue) = (0.0, 0.0, 0.0, 0.0);
        for c in 0..10 {
            let size = count(&|p| counts(p) && region(p) == c);
            regions += f64::from(u8::from(size > 0.0));
            let (mut most, mut best) = (0.0, None);
            for g in (0..10).filter(|&g| Some(g) != roles.ignore) {
                let common = count(&|p| region(p) == c && truth(p) == g);
                if common > most {
                    (most, best) = (common, Some(g));
                }
                ue += common.min(size - common);
            }
            asa += most;
            object_asa += if best.is_some_and(is_object) { most } else { 0.0 };
        }
        let is_border = |p: (i32, i32)| four(p).into_iter().any(|q| region(q) != region(p));
        let near = |(u, v): (i32, i32)| {
            (-2..=2).any(|dv| (-2..=2).any(|du| inside(&(u + du, v + dv)) && is_border((u + du, v + dv))))
        };
        let recall = |contour: &dyn Fn((i32, i32)) -> bool| {
            let all = count(contour);
            (all > 0.0).then(|| count(&|p| contour(p) && near(p)) / all)
        };
        let (mut coverage, mut c75, mut objects) = (0.0, 0.0, 0.0);
        for g in (0..10).filter(|&g| is_object(g)) {
            let size = count(&|p| truth(p) == g);
            if size == 0.0 {
                continue;
            }
            let best = (0..10).fold(0.0, |best: f64, c| {
                let common = count(&|p| region(p) == c && truth(p) == g);
                let union = count(&|p| counts(p) && (region(p) == c || truth(p) == g));
                if union > 0.0 { best.max(common / union) } else { best }
            });
            objects += 1.0;
            coverage += size * best;
            c75 += f64::from(u8::from(best >= 0.75));
        }
        Some(StageMetrics {
            regions,
            asa: asa / labelled,
            object_asa: object_asa / object_px,
            ue: ue / labelled,
            boundary_recall: recall(&|p| {
                is_object(truth(p)) && four(p).into_iter().any(|q| truth(q) != truth(p))
            }),
            contact_recall: recall(&|p| {
                counts(p) && four(p).into_iter().any(|q| counts(q) && truth(q) != truth(p))
            }),
            coverage: coverage / object_px,
            c75: c75 / objects,
        })
    }

    fn measured(r: &[Vec<i32>], t: &[Vec<u32>], roles: Roles) -> Option<StageMetrics> {
        let (width, height) = (r[0].len(), r.len());
        let labels = Raster::from_vec(width, height, t.concat()).unwrap();
        let truth = Truth::new(labels.clone(), labels, roles).unwrap();
        let segments = Segments::from_labels(&Raster::from_vec(width, height, r.concat()).unwrap());
        StageMetrics::of(&segments, &truth).unwrap()
    }

    /// Images of blocks, so that regions have insides.
    fn image<T: Clone + std::fmt::Debug>(
        label: impl Strategy<Value = T>,
    ) -> impl Strategy<Value = Vec<Vec<T>>> {
        prop::collection::vec(label, 16).prop_map(|cells| {
            (0..13).map(|v| (0..17).map(|u| cells[v / 4 * 4 + (u / 5).min(3)].clone()).collect()).collect()
        })
    }

    proptest! {
        #[test]
        fn figures_are_those_of_the_definition(
            r in image(-1..5_i32),
            t in image(0..4_u32),
            noise in prop::collection::vec((0..13_usize, 0..17_usize, 0..4_u32), 0..9),
            ignore in prop::option::of(0..2_u32),
            background in prop::option::of(0..2_u32),
        ) {
            let mut t = t;
            for (v, u, label) in noise {
                t[v][u] = label;
            }
            let roles = Roles { ignore, background };
            prop_assert_eq!(measured(&r, &t, roles), by_force(&r, &t, roles));
        }
    }

    #[test]
    fn the_truth_itself_is_perfect() {
        let t: Vec<Vec<u32>> =
            (0..8).map(|v| (0..8).map(|u| 1 + u32::from(u > 3) + u32::from(v > 3)).collect()).collect();
        let r: Vec<Vec<i32>> = t.iter().map(|row| row.iter().map(|&l| l as i32).collect()).collect();
        let metrics = measured(&r, &t, MOSD).unwrap();
        let (regions, perfect) = (3.0, Some(1.0));
        let expected = StageMetrics {
            regions,
            asa: 1.0,
            object_asa: 1.0,
            ue: 0.0,
            boundary_recall: perfect,
            contact_recall: perfect,
            coverage: 1.0,
            c75: 1.0,
        };
        assert_eq!(metrics, expected);
    }

    #[test]
    fn a_mean_leaves_out_the_images_without_contours() {
        let filled = measured(&[vec![0, 0]], &[vec![2, 2]], MOSD).unwrap();
        assert_eq!((filled.boundary_recall, filled.contact_recall), (None, None));
        let two = measured(&[vec![0, 1, 1]], &[vec![2, 1, 0]], MOSD).unwrap();
        let mean = StageMetrics::mean([&filled, &two]).unwrap();
        assert_eq!((mean.regions, mean.boundary_recall), (1.5, Some(1.0)));
        assert_eq!(StageMetrics::mean([]), None);
        assert_eq!(measured(&[vec![0, 0]], &[vec![0, 1]], MOSD), None, "no object");
    }

    #[test]
    fn a_region_of_equal_halves_is_background() {
        let metrics = measured(&[vec![0, 0, 1]], &[vec![2, 1, 2]], MOSD).unwrap();
        assert_eq!((metrics.asa, metrics.object_asa, metrics.ue), (2.0 / 3.0, 0.5, 2.0 / 3.0));
    }

    #[test]
    fn the_observer_keeps_the_three_stages_apart() {
        let labels = Raster::from_vec(2, 1, vec![1, 2]).unwrap();
        let truth = Truth::new(labels.clone(), labels, MOSD).unwrap();
        let [one, two] =
            [[0, 0], [0, 1]].map(|r| Segments::from_labels(&Raster::from_vec(2, 1, r.to_vec()).unwrap()));
        let mut observer = StageObserver::new(&truth);
        observer.observe(Output::Superpixels((&two).into()));
        observer.observe(Output::Shapes((&one).into()));
        let stages = observer.into_stages().unwrap();
        let regions = stages.by_name().map(|(_, metrics)| metrics.map(|m| m.regions));
        assert_eq!(regions, [Some(2.0), None, Some(1.0)]);

        let wide = Segments::from_labels(&Raster::from_vec(3, 1, vec![0; 3]).unwrap());
        let mut observer = StageObserver::new(&truth);
        observer.observe(Output::Facets(&wide));
        observer.observe(Output::Shapes((&one).into()));
        assert!(matches!(observer.into_stages(), Err(Error::SegmentsSize { .. })));
    }
}
