//! What the common border of two facets tells: how it folds, and where one hides the other (docs/CONTEXT.md 3.1).

use glam::DVec3;
use rayon::prelude::*;

use crate::facets::Facets;
use crate::params;
use crate::raster::{Raster, marked};
use crate::regions::{RegionGraph, SegmentId};
use crate::simd::vectorized;
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::moments::{Model, length};

/// What was seen along the border of two facets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BorderEvidence {
    /// The folds, in scan order.
    pub folds: Vec<Fold>,
    /// How much of the border (m) is a step in depth: one facet hides what lies behind it.
    pub step_m: f64,
    /// How far the first facet is before the second where they meet, summed over all that was looked at.
    pub gaps: Gaps,
}

/// Gaps between two surfaces along their border, weighted by its length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gaps {
    /// Border that was looked at (m).
    pub length_m: f64,
    /// Gap in disparity times length (quanta · m).
    pub quanta_m: f64,
    /// Gap in depth times length (m^2).
    pub depth_m2: f64,
}

/// The fold between two facets at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fold {
    /// Angle between the surfaces (degrees): above 0 = ridge, convex; below 0 = valley, concave.
    pub angle_deg: f64,
    /// Length of border that it stands for (m).
    pub length_m: f64,
}

/// A side with fewer pixels in the window (at a focal length of 525 px) gives no evidence.
const LEAST_SIDE_PX: usize = 15;
/// Keeps a narrow side near the slope of its facet (px^2).
const RIDGE_PX2: f64 = 1.0;
/// The step between two single pixels counts beyond so many times the gap between surfaces.
const RAW_GAPS: f64 = 2.5;
/// It hides something beyond so many times the depth of a step between surfaces.
const RAW_DEPTHS: f64 = 2.0;
/// A small step may be a torn ridge when it folds by more than this (degrees) ...
const TORN_RIDGE_DEG: f64 = 25.0;
/// ... and then counts as so much of its length.
const TORN_RIDGE_SHARE: f64 = 0.5;
/// Every other pair of pixels is looked at, so each stands for two.
const PAIRS_PER_SAMPLE: f64 = 2.0;

/// Marks of a pixel next to which another facet lies.
const RIGHT: i32 = 1;
const BELOW: i32 = 2;

/// One look at a border.
struct Sample {
    look: Look,
    gaps: Gaps,
}

enum Look {
    Fold(Fold),
    Step { length_m: f64 },
}

/// Looks at the border pixels of any two facets that are not both structure, every other one, and fits a plane to either side within
/// `radius_px`: locally, because curved and L-shaped facets have no one direction. O(border pixels · radius^2).
pub fn measure_borders(
    facets: &Facets,
    disparity: &Raster<f32>,
    space: &DisparitySpace,
    params: &params::Border,
) -> RegionGraph<BorderEvidence> {
    let (width, height) = disparity.size();
    let border = Border { facets, disparity, space, params, radius: space.length_px(params.radius_px) };
    let labels = facets.segments.labels().as_slice();
    let row = |v: usize| &labels[v * width..(v + 1) * width];
    let is_border = |a: i32, b: i32| i32::from((a != b) & (a >= 0) & (b >= 0));
    // Horizontal pairs on odd rows, vertical pairs in odd columns.
    let look = |marks: &mut Vec<i32>, v: usize| {
        let (own, below) = (row(v), row((v + 1).min(height - 1)));
        for (u, (mark, (own, below))) in (0..).zip(marks.iter_mut().zip(own.iter().zip(below))) {
            *mark = BELOW * (is_border(*own, *below) & u & 1);
        }
        if v % 2 == 1 {
            for (mark, (own, right)) in marks.iter_mut().zip(own.iter().zip(&own[1..])) {
                *mark |= RIGHT * is_border(*own, *right);
            }
        }
        let mut samples = Vec::new();
        for u in marked(marks) {
            let i = v * width + u;
            if marks[u] & RIGHT != 0 {
                samples.extend(border.sample(i, i + 1));
            }
            if marks[u] & BELOW != 0 {
                samples.extend(border.sample(i, i + width));
            }
        }
        samples
    };
    let rows: Vec<Vec<_>> = (0..height).into_par_iter().map_init(|| vec![0; width], look).collect();
    let add = |evidence: &mut BorderEvidence, Sample { look, gaps }| {
        match look {
            Look::Fold(fold) => evidence.folds.push(fold),
            Look::Step { length_m } => evidence.step_m += length_m,
        }
        evidence.gaps.length_m += gaps.length_m;
        evidence.gaps.quanta_m += gaps.quanta_m;
        evidence.gaps.depth_m2 += gaps.depth_m2;
    };
    RegionGraph::gather(facets.segments.count(), rows.into_iter().flatten(), add)
}

struct Border<'a> {
    facets: &'a Facets,
    disparity: &'a Raster<f32>,
    space: &'a DisparitySpace,
    params: &'a params::Border,
    radius: usize,
}

/// The plane of one side, about the middle of the pair.
struct Side {
    /// Disparity at the middle (quanta).
    value: f64,
    slope: [f64; 2],
    /// Mean position of its pixels (px), and the disparity there.
    mean: [f64; 2],
    mean_disparity: f64,
}

/// Number and sums of x, y, d, xx, xy, yy, xd and yd of some pixels.
#[derive(Clone, Copy, Default)]
struct Sums {
    n: usize,
    terms: [f64; 8],
}

/// Columns of a window that are summed at once.
const LANES: usize = 16;

/// Column by column the number and the sums of y, yy, d and yd.
#[derive(Clone, Copy, Default)]
struct Columns {
    n: [f64; LANES],
    y: [f64; LANES],
    yy: [f64; LANES],
    d: [f64; LANES],
    yd: [f64; LANES],
}

impl Columns {
    /// Adds what of a row is of one facet.
    #[inline(always)]
    fn add_row(&mut self, y: f64, is_own: &[bool; LANES], disparity: &[f32; LANES]) {
        for k in 0..LANES {
            let (own, d) = if is_own[k] { (1.0, f64::from(disparity[k])) } else { (0.0, 0.0) };
            self.n[k] += own;
            self.y[k] += own * y;
            self.yy[k] += own * (y * y);
            self.d[k] += d;
            self.yd[k] += y * d;
        }
    }
}

impl Sums {
    /// Adds columns, the first of which is at x.
    #[inline(always)]
    fn add(&mut self, x: f64, Columns { n, y, yy, d, yd }: &Columns) {
        let x: [f64; LANES] = std::array::from_fn(|k| x + k as f64);
        let times = |a: &[f64; LANES], b: &[f64; LANES]| std::array::from_fn(|k| a[k] * b[k]);
        let xn = times(&x, n);
        let terms = [&xn, y, d, &times(&x, &xn), &times(&x, y), yy, &times(&x, d), yd].map(total);
        self.n += total(n) as usize;
        self.terms.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
    }
}

/// The sum of all, by halves.
#[inline(always)]
fn total(values: &[f64; LANES]) -> f64 {
    let mut sums = *values;
    let mut half = LANES / 2;
    while half > 0 {
        for k in 0..half {
            sums[k] += sums[k + half];
        }
        half /= 2;
    }
    sums[0]
}

/// The first values of a row; of a shorter one as many as there are, and then others.
#[inline(always)]
fn first<T: Copy + Default>(row: &[T]) -> [T; LANES] {
    row.first_chunk().copied().unwrap_or_else(|| {
        let mut padded = [T::default(); LANES];
        padded[..row.len()].copy_from_slice(row);
        padded
    })
}

impl Border<'_> {
    /// What is seen between the 4-neighbours i and j, if they lie on two facets that are not both structure.
    fn sample(&self, i: usize, j: usize) -> Option<(SegmentId, SegmentId, Sample)> {
        let (i, j, a, b) = match (self.facets.segments.at(i)?, self.facets.segments.at(j)?) {
            (a, b) if a == b => return None,
            (a, b) if a < b => (i, j, a, b),
            (a, b) => (j, i, b, a),
        };
        if b.index() < self.facets.structure {
            return None;
        }
        let width = self.disparity.width();
        let (at_i, at_j) = (position(i, width), position(j, width));
        let middle = [0, 1].map(|k| ((at_i[k] + at_j[k]) / 2.0).floor());
        let [sums_a, sums_b] = self.sums([a, b], middle);
        let side_a = self.side(a, middle, &sums_a)?;
        let side_b = self.side(b, middle, &sums_b)?;

        let (di, dj) = (f64::from(self.disparity[i]), f64::from(self.disparity[j]));
        let z_m = self.space.depth_m(0.5 * (di + dj));
        let camera = self.space.camera();
        // A pair along a row stands for border along the column.
        let focal_px = if i.abs_diff(j) == 1 { camera.fy_px } else { camera.fx_px };
        let length_m = PAIRS_PER_SAMPLE * z_m / focal_px;

        let before = side_a.value - side_b.value;
        let gaps = Gaps {
            length_m,
            quanta_m: before * length_m,
            depth_m2: self.space.step_m(before, z_m) * length_m,
        };
        let gap = before.abs();
        let raw = (di - dj).abs();
        let (slope_a, slope_b) = (side_a.slope, side_b.slope);
        let turn = length([slope_a[0] - slope_b[0], slope_a[1] - slope_b[1]]);
        let gentler = length(slope_a).min(length(slope_b));
        let is_step = gap > self.params.gap_quanta + self.space.lateral_noise_px() * turn
            || raw > RAW_GAPS * self.params.gap_quanta + gentler;
        let hides = self.space.step_m(gap, z_m) > self.params.step_depth_m
            || self.space.step_m(raw, z_m) > RAW_DEPTHS * self.params.step_depth_m;
        if is_step && hides {
            return Some((a, b, Sample { look: Look::Step { length_m }, gaps }));
        }
        let angle_deg = self.angle_deg(&side_a, &side_b, middle);
        let look = match is_step {
            true if angle_deg < TORN_RIDGE_DEG => Look::Step { length_m },
            true => Look::Fold(Fold { angle_deg, length_m: TORN_RIDGE_SHARE * length_m }),
            false => Look::Fold(Fold { angle_deg, length_m }),
        };
        Some((a, b, Sample { look, gaps }))
    }

    /// The sums over the pixels of two facets around `middle`. Many columns at once, which changes no bit: places are whole numbers,
    /// and disparities of 24 bits differ by less than a factor of 200, so that in windows of up to 100 px to either side nothing is
    /// rounded, whatever is added first.
    fn sums(&self, facets: [SegmentId; 2], middle: [f64; 2]) -> [Sums; 2] {
        let (width, height) = self.disparity.size();
        let [u, v] = middle.map(|x| x as usize);
        let rows = v.saturating_sub(self.radius)..(v + self.radius + 1).min(height);
        let end = (u + self.radius + 1).min(width);
        let (labels, disparity) = (self.facets.segments.labels().as_slice(), self.disparity.as_slice());
        let mut sums = [Sums::default(); 2];
        vectorized(
            #[inline(always)]
            || {
                for start in (u.saturating_sub(self.radius)..end).step_by(LANES) {
                    let inside: [bool; LANES] = std::array::from_fn(|k| start + k < end);
                    let mut columns = [Columns::default(); 2];
                    for v_row in rows.clone() {
                        // What follows the row is not inside.
                        let i = v_row * width + start;
                        let (labels, disparity) = (first(&labels[i..]), first(&disparity[i..]));
                        for (columns, facet) in columns.iter_mut().zip(facets) {
                            let is_own = |k| inside[k] & (labels[k] == facet.0 as i32);
                            let is_own = std::array::from_fn(is_own);
                            columns.add_row(v_row as f64 - v as f64, &is_own, &disparity);
                        }
                    }
                    let x = start as f64 - u as f64;
                    sums.iter_mut().zip(&columns).for_each(|(sums, columns)| sums.add(x, columns));
                }
            },
        );
        sums
    }

    /// The plane through the pixels of one facet around `middle`; `None` when they are few.
    fn side(&self, facet: SegmentId, middle: [f64; 2], sums: &Sums) -> Option<Side> {
        let &Sums { n, terms: sums } = sums;
        if n < self.space.area_px(LEAST_SIDE_PX).max(1) {
            return None;
        }
        let [mx, my, md, xx, xy, yy, xd, yd] = sums.map(|sum| sum / n as f64);
        let model: &Model = &self.facets.models[facet.index()];
        let [gx, gy] = model.slope([middle[0] + mx, middle[1] + my]);
        let (xx, xy, yy) = (xx - mx * mx + RIDGE_PX2, xy - mx * my, yy - my * my + RIDGE_PX2);
        let (xd, yd) = (xd - mx * md + RIDGE_PX2 * gx, yd - my * md + RIDGE_PX2 * gy);
        let determinant = xx * yy - xy * xy;
        let slope = [(xd * yy - yd * xy) / determinant, (yd * xx - xd * xy) / determinant];
        let value = md - slope[0] * mx - slope[1] * my;
        Some(Side { value, slope, mean: [mx, my], mean_disparity: md })
    }

    /// Angle between the normals (degrees), below 0 when they lean towards each other.
    fn angle_deg(&self, a: &Side, b: &Side, middle: [f64; 2]) -> f64 {
        let normal = |side: &Side| self.space.normal(middle, side.value, side.slope);
        let point = |side: &Side| {
            let at = [middle[0] + side.mean[0], middle[1] + side.mean[1]];
            self.space.point_m(at, side.mean_disparity)
        };
        fold_angle_deg((point(a), normal(a)), (point(b), normal(b)))
    }
}

/// Angle (degrees) between two surfaces, each given by a point and the normal there, below 0 when they lean towards each other.
pub(crate) fn fold_angle_deg(
    (point_a, normal_a): (DVec3, DVec3),
    (point_b, normal_b): (DVec3, DVec3),
) -> f64 {
    let turn = normal_a - normal_b;
    let angle = libm::acos(normal_a.dot(normal_b).clamp(-1.0, 1.0)).to_degrees();
    if turn.dot(point_a - point_b) < 0.0 { -angle } else { angle }
}

impl Fold {
    /// Its signed vote (m): the whole length for one shape or against, from `full_vote_deg` on either side of the valley of
    /// `reflex_offset_deg`.
    pub fn vote_m(&self, params: &params::Contraction) -> f64 {
        let signed = (self.angle_deg + params.reflex_offset_deg) / params.full_vote_deg;
        self.length_m * signed.clamp(-1.0, 1.0)
    }
}

impl BorderEvidence {
    /// How much of the border (m) is a fold.
    pub fn fold_m(&self) -> f64 {
        // A sum of nothing is -0.0.
        self.folds.iter().fold(0.0, |sum, fold| sum + fold.length_m)
    }

    /// The signed vote of a border (m): above 0 for one shape, below 0 for two. Its folds vote; a step speaks against by
    /// `occlusion_weight`.
    pub fn vote_m(&self, params: &params::Contraction) -> f64 {
        let folds = self.folds.iter().map(|fold| fold.vote_m(params)).sum::<f64>();
        folds - params.occlusion_weight * self.step_m
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::regions::Segments;
    use crate::surface::moments::{Basis, Moments};
    use crate::testing::{kinect, raster, space};

    const WIDTH: usize = 80;
    const HEIGHT: usize = 60;

    /// Two walls that meet at the upright line through the principal point, each turned by half of `fold_deg`; the right
    /// one stands `step_m` farther back. `scale`: the focal length over 525 px.
    struct Walls {
        facets: Facets,
        disparity: Raster<f32>,
        space: DisparitySpace,
    }

    impl Walls {
        fn new(fold_deg: f64, step_m: f64, scale: usize) -> Self {
            let (width, height) = (WIDTH * scale, HEIGHT * scale);
            let f = 525.0 * scale as f64;
            let space = space([f, f], [width as f64 / 2.0 - 0.5, height as f64 / 2.0 - 0.5]);
            let (sin, cos) = libm::sincos((fold_deg / 2.0).to_radians());
            let is_right = |i: usize| i % width >= width / 2;
            let depth_m = |i: usize| {
                let side = if is_right(i) { 1.0 } else { -1.0 };
                let ray = DVec3::from(space.camera().ray((i % width) as f64, (i / width) as f64));
                // Through (0, 0, 1 + step), its normal leaning to its own side when the fold is a ridge.
                let normal = DVec3::new(side * sin, 0.0, -cos);
                let foot_m = 1.0 + if is_right(i) { step_m } else { 0.0 };
                (normal.z * foot_m / normal.dot(ray)) as f32
            };
            let depth_m =
                Raster::from_vec(width, height, (0..width * height).map(depth_m).collect()).unwrap();
            let disparity = space.disparity(&depth_m);
            let of = |right: bool| {
                (0..(width * height) as u32).filter(|&i| is_right(i as usize) == right).collect()
            };
            let pixels: [Vec<u32>; 2] = [of(false), of(true)];
            let models = pixels.map(|pixels| Moments::of(&pixels, &disparity).fit(Basis::Quadratic).model);
            let labels = depth_m.with_data((0..width * height).map(|i| i32::from(is_right(i))).collect());
            let facets = Facets {
                segments: Segments::from_numbered(labels, 2),
                models: models.to_vec(),
                structure: 0,
            };
            Self { facets, disparity, space }
        }

        fn seen(&self, step_depth_m: f64) -> BorderEvidence {
            let params = params::Border { step_depth_m, ..Default::default() };
            let graph = measure_borders(&self.facets, &self.disparity, &self.space, &params);
            let [edge] = graph.edges() else { panic!("one border: {graph:?}") };
            edge.evidence.clone()
        }
    }

    proptest! {
        /// Pixel by pixel, term by term.
        #[test]
        fn sums_of_both_sides_are_the_naive_ones(
            (labels, disparity) in (1_usize..20, 1_usize..20)
                .prop_flat_map(|size| (raster(size, -1_i32..3), raster(size, 17.0_f32..3500.0))),
            at in 0_usize..400,
            radius in 0_usize..8,
        ) {
            let (space, params) = (kinect(), params::Border::default());
            let facets = Facets { segments: Segments::from_numbered(labels.clone(), 3), models: Vec::new(), structure: 0 };
            let border = Border { facets: &facets, disparity: &disparity, space: &space, params: &params, radius };
            let width = labels.width();
            let middle = position(at % labels.len(), width);
            let got = border.sums([SegmentId(0), SegmentId(2)], middle);
            for (label, got) in [0, 2].into_iter().zip(got) {
                let mut expected = Sums::default();
                for i in (0..labels.len()).filter(|&i| labels[i] == label) {
                    let [x, y] = [0, 1].map(|k| position(i, width)[k] - middle[k]);
                    if x.abs().max(y.abs()) > radius as f64 {
                        continue;
                    }
                    let d = f64::from(disparity[i]);
                    let terms = [x, y, d, x * x, x * y, y * y, x * d, y * d];
                    expected.terms.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
                    expected.n += 1;
                }
                prop_assert_eq!((got.n, got.terms), (expected.n, expected.terms));
            }
        }
    }

    /// The length of the border (m).
    fn border_m(evidence: &BorderEvidence) -> f64 {
        evidence.folds.iter().map(|fold| fold.length_m).sum()
    }

    /// The true length of the border at 1 m (m).
    const TRUE_M: f64 = HEIGHT as f64 / 525.0;

    #[test]
    fn the_angle_and_the_length_of_a_fold_are_measured() {
        for scale in [1, 2] {
            for fold_deg in [90.0, 40.0, 5.0, 0.0, -5.0, -40.0, -90.0] {
                let evidence = Walls::new(fold_deg, 0.0, scale).seen(0.013);
                assert_eq!(evidence.step_m, 0.0, "{fold_deg}");
                for fold in &evidence.folds {
                    // The ridge draws the slopes of a narrow side to the facet's own, which here are the same.
                    assert!((fold.angle_deg - fold_deg).abs() < 1.0, "{fold_deg} at {scale}: {fold:?}");
                }
                let length_m = border_m(&evidence);
                assert!((length_m / TRUE_M - 1.0).abs() < 0.05, "{fold_deg} at {scale}: {length_m}");
            }
        }
    }

    #[test]
    fn a_deep_step_hides_something() {
        for fold_deg in [0.0, 60.0] {
            let evidence = Walls::new(fold_deg, 0.05, 1).seen(0.013);
            assert!(evidence.folds.is_empty(), "{fold_deg}: {evidence:?}");
            assert!((evidence.step_m / TRUE_M - 1.0).abs() < 0.08, "{fold_deg}: {}", evidence.step_m);
        }
    }

    #[test]
    fn a_small_step_at_a_ridge_is_a_torn_ridge() {
        // 16 mm are 5.6 quanta: a step, but here not one that hides anything.
        let torn = Walls::new(60.0, 0.016, 1).seen(0.02);
        assert!(torn.step_m == 0.0 && (border_m(&torn) / TRUE_M - 0.5).abs() < 0.05, "{torn:?}");
        assert!(torn.folds.iter().all(|fold| fold.angle_deg > 50.0), "{torn:?}");
        for fold_deg in [0.0, -60.0] {
            let step = Walls::new(fold_deg, 0.016, 1).seen(0.02);
            assert!(
                step.folds.is_empty() && (step.step_m / TRUE_M - 1.0).abs() < 0.05,
                "{fold_deg}: {step:?}"
            );
        }
    }

    #[test]
    fn what_noise_explains_is_no_step() {
        // 6 mm are 2.1 quanta: within the noise, even where such a step would hide something.
        let level = Walls::new(60.0, 0.006, 1).seen(0.001);
        assert!(level.step_m == 0.0 && (border_m(&level) / TRUE_M - 1.0).abs() < 0.05, "{level:?}");
        // 13 mm are 4.6 quanta: a step, unless the surfaces turn so much that sideways noise makes it.
        assert!(Walls::new(0.0, 0.013, 1).seen(0.02).folds.is_empty());
        let folded = Walls::new(60.0, 0.013, 1).seen(0.02);
        assert!(folded.step_m == 0.0 && (border_m(&folded) / TRUE_M - 1.0).abs() < 0.05, "{folded:?}");
    }

    #[test]
    fn two_surfaces_of_the_structure_have_no_border() {
        let mut walls = Walls::new(90.0, 0.0, 1);
        let count = |walls: &Walls| {
            let params = params::Border::default();
            measure_borders(&walls.facets, &walls.disparity, &walls.space, &params).edges().len()
        };
        walls.facets.structure = 1;
        assert_eq!(count(&walls), 1, "one surface of the structure and a facet have one");
        walls.facets.structure = 2;
        assert_eq!(count(&walls), 0);
    }

    #[test]
    fn a_vote_is_in_metres_of_border() {
        let params =
            params::Contraction { reflex_offset_deg: 12.0, full_vote_deg: 15.0, occlusion_weight: 0.15 };
        let vote = |folds: &[(f64, f64)], step_m: f64| {
            let folds = folds.iter().map(|&(angle_deg, length_m)| Fold { angle_deg, length_m }).collect();
            BorderEvidence { folds, step_m, ..Default::default() }.vote_m(&params)
        };
        for (angle_deg, share) in
            [(90.0, 1.0), (3.0, 1.0), (0.0, 0.8), (-12.0, 0.0), (-19.5, -0.5), (-90.0, -1.0)]
        {
            assert!((vote(&[(angle_deg, 0.2)], 0.0) - 0.2 * share).abs() < 1e-12, "{angle_deg}");
        }
        assert!((vote(&[(90.0, 0.1), (-90.0, 0.3)], 0.2) - (0.1 - 0.3 - 0.03)).abs() < 1e-12);
        assert_eq!(vote(&[], 0.0), 0.0);
    }
}
