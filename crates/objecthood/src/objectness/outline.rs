//! Outlines: how regions end at each side of their border pixels. Separation and visibility follow from them.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::clusters::borders::REACH_PX;
use crate::color::image::LabImage;
use crate::objectness::contrast::{Across, BLOCK_PX, measure_clearness};
use crate::params;
use crate::raster::{Raster, marked};
use crate::regions::{SegmentId, Segments};
use crate::shapes::border::{Fold, fold_angle_deg};
use crate::shapes::seams::Cuts;
use crate::surface::disparity::DisparitySpace;

/// A larger difference in disparity (quanta) across an outline is a step in depth, as for clusters that touch (docs/CONTEXT.md 4.1).
pub(crate) const STEP_QUANTA: f64 = 6.0;
/// Normals beside an outline are read this far from it (px at 525 px): nearer, windows of 7 px hold both surfaces.
const ASIDE_PX: usize = 5;

/// The outline of a region, in metres of the sides of its pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outline {
    /// Length at which the region ends by itself: in front of something farther, or at something that it touches.
    pub own_m: f64,
    /// Length beyond which something nearer hides the region.
    pub hidden_m: f64,
    /// Length at which the image ends.
    pub cut_m: f64,
    /// The part of `judged_m` that is clearly the border of a thing.
    pub clear_m: f64,
    /// Length at which the border can be judged: steps in depth, and folds with a normal on both sides.
    pub judged_m: f64,
    /// Length at which its colours differ from those of the background beside it, weighted by how clearly
    /// they differ (docs/CONTEXT.md 6.4).
    pub contrast_m: f64,
}

/// One side of a pixel beyond which its region does not go on.
struct OutlineSide {
    region: SegmentId,
    end: End,
    length_m: f64,
    /// The part of `length_m` that a step, a fold, a rise or a seam shows to be the border of a thing; `None` if none can be judged.
    clear_m: Option<f64>,
    /// Where its colours are compared.
    across: Option<Across>,
}

/// How a region ends at a side.
enum End {
    Own,
    Hidden,
    Cut,
}

/// A thing that rises by at least this (m) above the structure beside it is clear too, because the rim of a
/// plate is too low for a step, ...
const RISE_M: f64 = 0.01;
/// ... if it also rises by more than this many quanta, for each time that the sensor's waves exceed a
/// Kinect's: as much as a step.
const RISE_QUANTA: f64 = STEP_QUANTA;
/// The rise is read this far from the outline (px at 525 px): nearer, a pixel may show both surfaces.
const RISE_ASIDE_PX: usize = 2;

/// Rows whose outlines one task collects: a row of blocks of colour.
const BAND_ROWS: usize = BLOCK_PX;

struct View<'a> {
    regions: &'a Segments,
    points_m: &'a Raster<[f32; 3]>,
    normals: &'a Raster<[f32; 3]>,
    space: &'a DisparitySpace,
    params: &'a params::Contraction,
    color: ColorEvidence<'a>,
    /// Farthest distance (px) at which the pixel beyond a hole is searched.
    reach: usize,
    /// Distance (px) from the border at which normals are read.
    aside: usize,
    /// Distance (px) from the border at which heights are read.
    rise_aside: usize,
    /// Regions below this number are structure.
    structure: usize,
}

/// What colour shows about borders.
#[derive(Clone, Copy, Debug, Default)]
pub struct ColorEvidence<'a> {
    /// The colours, if there are any.
    pub lab: Option<&'a LabImage>,
    /// The seams between facets, if there are any.
    pub seams: Option<SeamsAt<'a>>,
}

/// The seams between facets.
#[derive(Clone, Copy, Debug)]
pub struct SeamsAt<'a> {
    /// The facets.
    pub facets: &'a Segments,
    /// The seams that cut them.
    pub cuts: &'a Cuts,
}

impl SeamsAt<'_> {
    /// Whether a seam runs between two pixels.
    fn part(&self, i: usize, j: usize) -> bool {
        let [a, b] = [i, j].map(|pixel| self.facets.at(pixel));
        a.zip(b).is_some_and(|(a, b)| self.cuts.between(a.index(), b.index()).is_some())
    }
}

/// Measures the outline of every region from number `first` on; the other outlines stay empty.
///
/// A step in depth is clear, whichever side is in front. The deeper the valley of a fold, the clearer it is:
/// not clear at all where it votes fully for one shape, wholly clear where it votes fully against
/// (docs/CONTEXT.md 3.2). A seam is clear. Beside the background, a rise is clear, and a fold that can be
/// judged is at least as clear as the colours on both sides differ. Across a hole in the depth the search
/// reaches up to 24 px (at 525 px). A side without a measured pixel in reach does not count. O(pixels +
/// outline · 24); parallel over bands of rows.
pub fn measure_outlines(
    regions: &Segments,
    first: usize,
    points_m: &Raster<[f32; 3]>,
    normals: &Raster<[f32; 3]>,
    space: &DisparitySpace,
    params: &params::Contraction,
    color: ColorEvidence<'_>,
) -> Vec<Outline> {
    let height = regions.labels().height();
    let [reach, aside, rise_aside] = [REACH_PX, ASIDE_PX, RISE_ASIDE_PX].map(|px| space.length_px(px));
    let structure = first;
    let view = View { regions, points_m, normals, space, params, color, reach, aside, rise_aside, structure };
    regions.find_runs();
    let band = |band: usize| view.band(band * BAND_ROWS..height.min((band + 1) * BAND_ROWS), first);
    let bands: Vec<Vec<(OutlineSide, f64)>> =
        (0..height.div_ceil(BAND_ROWS)).into_par_iter().map(band).collect();
    let mut outlines = vec![Outline::default(); regions.count()];
    for (side, clearness) in bands.into_iter().flatten() {
        outlines[side.region.index()].add(&side, clearness);
    }
    outlines
}

/// Marks the border pixels in a run of one region: both ends, and the pixels with another label above or below. In the first and the
/// last row of the image all pixels are marked.
fn mark_border(labels: &Raster<i32>, run: &Range<usize>, label: i32, marks: &mut [i32]) {
    let (width, height) = labels.size();
    let v = run.start / width;
    if v == 0 || v + 1 == height {
        marks.fill(1);
        return;
    }
    let [above, below] = [run.start - width, run.start + width].map(|i| &labels.as_slice()[i..][..run.len()]);
    // Without branches the compiler vectorises the loop. Runs are too short to gain from the wider vectors of some machines.
    for ((mark, above), below) in marks.iter_mut().zip(above).zip(below) {
        *mark = (above ^ label) | (below ^ label);
    }
    (marks[0], marks[run.len() - 1]) = (1, 1);
}

impl View<'_> {
    /// The outline sides in some rows, for regions from number `first` on, and how clearly the colours at each differ.
    fn band(&self, rows: Range<usize>, first: usize) -> Vec<(OutlineSide, f64)> {
        let labels = self.regions.labels();
        let mut sides = Vec::new();
        let mut marks = vec![0; labels.width()];
        for (run, region) in self.regions.runs_in(rows).filter(|&(_, region)| region >= first) {
            let marks = &mut marks[..run.len()];
            mark_border(labels, &run, region as i32, marks);
            let region = SegmentId(region as u32);
            marked(marks).for_each(|k| self.sides(run.start + k, region, &mut sides));
        }
        let across: Vec<_> = sides.iter().map(|side| (side.region, side.across)).collect();
        let clearness = self.color.lab.map(|lab| measure_clearness(lab, labels.width(), &across));
        let clearness = clearness.unwrap_or_else(|| vec![0.0; sides.len()]);
        sides.into_iter().zip(clearness).collect()
    }

    /// Adds the sides of pixel `i` that belong to the outline of its region, if the pixel is measured.
    fn sides(&self, i: usize, region: SegmentId, sides: &mut Vec<OutlineSide>) {
        let (width, height) = self.regions.labels().size();
        let (u, v) = (i % width, i / width);
        let camera = self.space.camera();
        let z_m = f64::from(self.points_m[i][2]);
        if z_m.is_nan() {
            return;
        }
        // The left and the right side of a pixel are vertical.
        let (tall_m, wide_m) = (z_m / camera.fy_px, z_m / camera.fx_px);
        let directions = [
            (width - 1 - u, 1, tall_m),
            (u, -1, tall_m),
            (height - 1 - v, width as isize, wide_m),
            (v, -(width as isize), wide_m),
        ];
        sides.extend(
            directions
                .into_iter()
                .filter_map(|(room, step, length_m)| self.side(i, region, room, step, length_m)),
        );
    }

    /// How the region of pixel `i` ends on one side; `None` when the region goes on or nothing is measured in reach.
    fn side(
        &self,
        i: usize,
        region: SegmentId,
        room: usize,
        step: isize,
        length_m: f64,
    ) -> Option<OutlineSide> {
        let own_m = f64::from(self.points_m[i][2]);
        let side = |end, clear_m, across| Some(OutlineSide { region, end, length_m, clear_m, across });
        for t in 1..=self.reach {
            if t > room {
                return side(End::Cut, None, None);
            }
            let j = i.checked_add_signed(step * t as isize)?;
            if self.regions.at(j) == Some(region) {
                return None;
            }
            let z_m = f64::from(self.points_m[j][2]);
            if z_m.is_nan() {
                continue;
            }
            let is_step = (z_m - own_m).abs() > self.space.step_m(STEP_QUANTA, own_m.min(z_m));
            if is_step && z_m < own_m {
                return side(End::Hidden, Some(length_m), None);
            }
            let across = self.across(i, j, step);
            if is_step {
                return side(End::Own, Some(length_m), across);
            }
            let clear_m = || {
                if self.color.seams.is_some_and(|seams| seams.part(i, j)) {
                    return Some(length_m);
                }
                let beyond = self.surface(j, step)?;
                if self.rises(i, -step, j, beyond) {
                    return Some(length_m);
                }
                let fold = Fold { angle_deg: fold_angle_deg(self.surface(i, -step)?, beyond), length_m };
                Some((length_m - fold.vote_m(self.params)) / 2.0)
            };
            return side(End::Own, clear_m(), across);
        }
        None
    }

    /// Whether the region of `i` rises above the structure at `j`, whose point and normal are given.
    fn rises(&self, i: usize, step: isize, j: usize, (point, normal): (DVec3, DVec3)) -> bool {
        if self.regions.at(j).is_none_or(|region| region.index() >= self.structure) {
            return false;
        }
        let inside = i.checked_add_signed(step * self.rise_aside as isize);
        let is_own = |&k: &usize| k < self.points_m.len() && self.regions.at(k) == self.regions.at(i);
        let own = DVec3::from(self.points_m[inside.filter(is_own).unwrap_or(i)].map(f64::from));
        let quanta = RISE_QUANTA * self.space.noise().waves();
        normal.dot(own - point) > self.space.step_m(quanta, own.z).max(RISE_M)
    }

    /// Where the colours of the region of `i` are compared with those of the background at `j` beside it.
    /// Other neighbours are not compared: parts of one printed thing differ in colour too.
    fn across(&self, i: usize, j: usize, step: isize) -> Option<Across> {
        if self.color.lab.is_none()
            || self.regions.at(j).is_some_and(|beyond| beyond.index() >= self.structure)
        {
            return None;
        }
        let colors_at = [self.inwards(i, -step).next()?, self.inwards(j, step).next()?];
        Some(Across { side: i, step, colors_at })
    }

    /// Pixels of the region of `i`, the farthest from the border first, at most `aside` away.
    fn inwards(&self, i: usize, step: isize) -> impl Iterator<Item = usize> {
        let own = self.regions.at(i);
        let width = self.regions.labels().width();
        // Left and right of the image the next row begins.
        let is_inside =
            move |&j: &usize| j < self.points_m.len() && (step.abs() != 1 || j / width == i / width);
        let along = move |t: usize| i.checked_add_signed(step * t as isize).filter(is_inside);
        let is_own = |&t: &usize| along(t).is_some_and(|j| self.regions.at(j) == own);
        let width = (0..=self.aside).take_while(is_own).count();
        (0..width).rev().filter_map(along)
    }

    /// Point and normal in the region of `i`, where there is a normal.
    fn surface(&self, i: usize, step: isize) -> Option<(DVec3, DVec3)> {
        let is_known = |&j: &usize| self.normals[j] != [0.0; 3] && !self.points_m[j][2].is_nan();
        let j = self.inwards(i, step).find(is_known)?;
        let [point, normal] = [self.points_m[j], self.normals[j]].map(|p| DVec3::from(p.map(f64::from)));
        Some((point, normal))
    }
}

impl Outline {
    /// Separation: the clear share of the judged border, in [0, 1]; 1 when no part of it could be judged.
    pub fn separation(&self) -> f32 {
        if self.judged_m > 0.0 { (self.clear_m / self.judged_m) as f32 } else { 1.0 }
    }

    /// Contrast: how clearly colours differ from the background's, in [0, 1], on average over the outline
    /// where the region ends by itself. Beside other things it counts as 0. 0 for an empty outline.
    pub fn contrast(&self) -> f32 {
        if self.own_m > 0.0 { (self.contrast_m / self.own_m) as f32 } else { 0.0 }
    }

    /// Visibility: the share of the outline that is the region's own, in [0, 1]; 1 for an empty outline.
    pub fn visibility(&self) -> f32 {
        let all_m = self.own_m + self.hidden_m + self.cut_m;
        if all_m > 0.0 { (self.own_m / all_m) as f32 } else { 1.0 }
    }

    fn add(&mut self, side: &OutlineSide, clearness: f64) {
        let length_m = match side.end {
            End::Own => &mut self.own_m,
            End::Hidden => &mut self.hidden_m,
            End::Cut => &mut self.cut_m,
        };
        *length_m += side.length_m;
        let contrast_m = clearness * side.length_m;
        self.contrast_m += contrast_m;
        if let Some(clear_m) = side.clear_m {
            self.clear_m += clear_m.max(contrast_m);
            self.judged_m += side.length_m;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::clusters::scene::Scene;
    use crate::clusters::testing::Table;
    use crate::noise::Noise;
    use crate::testing::{raster, small_size};

    /// The outlines of the table and the things of a drawing, in sides of pixels at the depth of the table.
    fn drawn(rows: &[&str], heights_m: &[f64]) -> Vec<Outline> {
        let table = Table::drawn(rows, heights_m);
        let scene = table.scene();
        by_depth(&scene, 0, scene.space)
    }

    /// The outlines in a scene, for regions from number `first` on, as depth alone shows them.
    fn by_depth(scene: &Scene<'_>, first: usize, space: &DisparitySpace) -> Vec<Outline> {
        let (segments, params) = (&scene.facets.segments, params::Contraction::default());
        measure_outlines(
            segments,
            first,
            scene.points_m,
            scene.normals,
            space,
            &params,
            ColorEvidence::default(),
        )
    }

    fn sides(length_m: f64, height_m: f64) -> f64 {
        length_m * 525.0 / (1.0 - height_m)
    }

    #[test]
    fn what_stands_before_the_table_has_an_outline_of_its_own() {
        let found = drawn(&["________", "__aaa___", "__aaa___", "________"], &[0.2]);
        let thing = found[1];
        assert!(
            (sides(thing.own_m, 0.2) - 10.0).abs() < 1e-3 && thing.hidden_m + thing.cut_m == 0.0,
            "{thing:?}"
        );
        assert_eq!((thing.separation(), thing.visibility()), (1.0, 1.0));
        let table = found[0];
        assert!((sides(table.hidden_m, 0.0) - 10.0).abs() < 1e-3, "{table:?}");
        assert!((sides(table.cut_m, 0.0) - 24.0).abs() < 1e-3, "the border of the image: {table:?}");
        assert_eq!((table.own_m, table.separation()), (0.0, 1.0));
    }

    #[test]
    fn what_lies_behind_a_hole_is_looked_for() {
        let wide = ["a......b"; 3];
        let [_, a, b] = drawn(&wide, &[0.3, 0.1])[..] else { panic!("three regions") };
        assert!((sides(a.own_m, 0.3) - 3.0).abs() < 1e-3 && a.hidden_m == 0.0, "{a:?}");
        assert!((sides(b.hidden_m, 0.1) - 3.0).abs() < 1e-3 && b.own_m == 0.0, "{b:?}");
        // Beyond 24 px nothing is found; a hole in a thing is not a part of its outline.
        let apart = format!("a{}b", ".".repeat(24));
        let [_, a, _] = drawn(&[apart.as_str(); 2], &[0.3, 0.1])[..] else { panic!("three regions") };
        assert_eq!((a.own_m, a.hidden_m, a.judged_m, a.separation()), (0.0, 0.0, 0.0, 1.0));
        let [_, ring] = drawn(&["aaaa", "a..a", "aaaa"], &[0.3])[..] else { panic!("two regions") };
        assert_eq!((ring.own_m, ring.visibility()), (0.0, 0.0), "only the border of the image cuts it");
    }

    #[test]
    fn what_is_too_low_for_a_step_is_clear_where_the_sensor_has_small_waves() {
        let mut rows = vec!["_".repeat(40); 10];
        rows.extend(vec![["_".repeat(10), "a".repeat(20), "_".repeat(10)].concat(); 20]);
        rows.extend(vec!["_".repeat(40); 10]);
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        let table = Table::drawn(&rows, &[0.014]);
        let scene = table.scene();
        let separation = |noise: Noise| by_depth(&scene, 1, &scene.space.with_noise(noise))[1].separation();
        let fine =
            Noise { blocks_quanta: Noise::KINECT.blocks_quanta.map(|wave| wave / 3.0), ..Noise::KINECT };
        assert!(separation(Noise::KINECT) < 0.6, "{}", separation(Noise::KINECT));
        assert_eq!(separation(fine), 1.0);
    }

    /// Cans on a floor 2 m away were no objects of a stereo camera, which sees no step there.
    #[test]
    fn where_depth_shows_no_border_color_does() {
        let rows =
            ["________________"; 4].into_iter().chain(["________aaaa____"; 4]).chain(["________________"; 4]);
        let mut table = Table::drawn(&rows.collect::<Vec<_>>(), &[0.0]);
        let outline = |table: &Table| {
            let Scene { facets, points_m, normals, space, lab, .. } = table.scene();
            let color = ColorEvidence { lab, seams: None };
            let params = params::Contraction::default();
            measure_outlines(&facets.segments, 1, points_m, normals, space, &params, color)[1]
        };
        let depth_only = outline(&table);
        assert_eq!(depth_only.contrast(), 0.0);
        // What is blue lies beyond the right side of the image.
        let [red, gray, blue] = [[50.0, 60.0, 30.0], [50.0, 0.0, 0.0], [50.0, 60.0, 29.0]];
        table.lab = Some(LabImage::drawn((16, 12), |u, v| {
            if (8..12).contains(&u) && (4..8).contains(&v) {
                red
            } else if u < 2 {
                blue
            } else {
                gray
            }
        }));
        let by_color = outline(&table);
        assert_eq!((by_color.separation(), by_color.contrast()), (1.0, 1.0));
        assert!(depth_only.separation() < 0.3, "{depth_only:?}");
        table.lab = Some(LabImage::drawn((16, 12), |_, _| red));
        assert_eq!(outline(&table), depth_only, "colours that do not differ take nothing away");
        let mut printed = Table::drawn(&["aaaaaabbbbbb"; 12], &[0.2, 0.2]);
        let depth_only = outline(&printed);
        printed.lab = Some(LabImage::drawn((12, 12), |u, _| if u < 6 { red } else { gray }));
        assert_eq!(outline(&printed), depth_only, "print");
    }

    #[test]
    fn two_halves_of_one_surface_are_not_parted() {
        let rows = ["aaaaaaaaabbbbbbbbb"; 12];
        let [_, a, b] = drawn(&rows, &[0.2, 0.2])[..] else { panic!("three regions") };
        for half in [a, b] {
            assert!((sides(half.own_m, 0.2) - 12.0).abs() < 1e-2, "{half:?}");
            // A flat border is 12 degrees from the neutral valley; a full vote takes 15.
            let expected = (1.0 - 12.0 / 15.0) / 2.0;
            assert!((f64::from(half.separation()) - expected).abs() < 0.02, "{half:?}");
        }
    }

    #[test]
    fn a_valley_parts_and_a_ridge_does_not() {
        // A roof seen from above, and a trough of the same shape: 0.4 m wide at 1 m, with sides of 45 degrees.
        let bent = |sign: f64| {
            let table = Table::new((210, 60), |u, _| {
                let x = (u as f64 - 104.5).abs() / 525.0;
                Some((if u < 105 { 1 } else { 2 }, 0.25 - sign * x))
            });
            let scene = table.scene();
            by_depth(&scene, 0, scene.space)[1].separation()
        };
        assert!(bent(1.0) < 0.05 && bent(-1.0) > 0.95, "{} {}", bent(1.0), bent(-1.0));
    }

    proptest! {
        #[test]
        fn marked_pixels_are_all_that_have_an_outline(
            cells in small_size().prop_flat_map(|size| raster(size, (prop::option::weighted(0.8, 0_i32..4), 0_u8..3))),
            first in 0_usize..3,
        ) {
            let table = Table::new(cells.size(), |u, v| {
                let (facet, level) = cells.get(u, v)?;
                Some(((*facet)?, [0.0, 0.02, 0.2][usize::from(*level)]))
            });
            let Scene { facets, points_m, normals, space, .. } = table.scene();
            let (regions, params) = (&facets.segments, &params::Contraction::default());
            let [reach, aside] = [REACH_PX, ASIDE_PX].map(|px| space.length_px(px));
            let (rise_aside, structure) = (RISE_ASIDE_PX, first);
            let view = View { regions, points_m, normals, space, params, color: ColorEvidence::default(), reach, aside, rise_aside, structure };
            let mut expected = vec![Outline::default(); regions.count()];
            for (i, region) in regions.members().filter(|&(_, region)| region >= first) {
                let mut sides = Vec::new();
                view.sides(i, SegmentId(region as u32), &mut sides);
                sides.iter().for_each(|side| expected[region].add(side, 0.0));
            }
            prop_assert_eq!(measure_outlines(regions, first, points_m, normals, space, params, ColorEvidence::default()), expected);
        }
    }

    #[test]
    fn outlines_are_the_same_on_any_number_of_threads() {
        // More rows than a band.
        let rows = ["__aaa___bb", "__aa_.._bb", "cccc....bb", "cccc______"].repeat(12);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| drawn(&rows, &[0.1, 0.3, 0.1]))
        };
        assert!([2, 8].into_iter().all(|threads| on(threads) == on(1)));
    }
}
