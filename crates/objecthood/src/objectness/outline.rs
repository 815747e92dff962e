//! What lies beyond the outline of a region: nothing of it, something behind it, before it, or beside it.

use glam::DVec3;
use rayon::prelude::*;

use crate::objectness::clusters::REACH_PX;
use crate::params;
use crate::raster::{Raster, marked, part};
use crate::regions::{SegmentId, Segments};
use crate::shapes::border::{Fold, fold_angle_deg};
use crate::surface::disparity::DisparitySpace;

/// A larger difference in disparity (quanta) between both sides is a step in depth, as between side by side (METHOD 3.9).
pub(crate) const STEP_QUANTA: f64 = 6.0;
/// The surfaces of both sides are looked at so far from the border (px at 525 px): nearer, windows of 7 px hold both.
const ASIDE_PX: usize = 5;

/// The outline of a region, in metres of the sides of its pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outline {
    /// Where the region ends by itself: before something farther, or at something that it touches.
    pub own_m: f64,
    /// Where something nearer hides how it goes on.
    pub hidden_m: f64,
    /// Where the image ends.
    pub cut_m: f64,
    /// Of what is judged: how much is the border of a thing.
    pub clear_m: f64,
    /// Steps in depth, and folds of which both sides have a normal.
    pub judged_m: f64,
}

/// What lies beyond one side of a pixel.
enum Beyond {
    Image,
    /// Something at another depth.
    Step {
        is_nearer: bool,
    },
    /// Something else at the same depth, at the pixel with this index.
    Touching {
        pixel: usize,
    },
}

struct View<'a> {
    regions: &'a Segments,
    first: usize,
    points_m: &'a Raster<[f32; 3]>,
    normals: &'a Raster<[f32; 3]>,
    space: &'a DisparitySpace,
    params: &'a params::Contraction,
    reach: usize,
    aside: usize,
}

/// The outline of every region from number `first` on; nothing of the others.
///
/// A step in depth is clear, whoever is in front. A fold is as clear as its valley is deep: not at all from
/// `full_vote_deg` above the neutral valley of `reflex_offset_deg`, wholly from `full_vote_deg` below it, as borders vote
/// (METHOD 3.8). What lies beyond a hole in the depth is looked for up to 24 px away; a side beyond which nothing is
/// seen tells nothing. O(pixels + outline · 24); parallel over rows.
pub fn outlines(
    regions: &Segments,
    first: usize,
    points_m: &Raster<[f32; 3]>,
    normals: &Raster<[f32; 3]>,
    space: &DisparitySpace,
    params: &params::Contraction,
) -> Vec<Outline> {
    let (width, height) = regions.labels().size();
    let view = View {
        regions,
        first,
        points_m,
        normals,
        space,
        params,
        reach: space.length_px(REACH_PX),
        aside: space.length_px(ASIDE_PX),
    };
    let labels = regions.labels().as_slice();
    let of_row = |v: usize| {
        let row = |v: usize| &labels[v * width..(v + 1) * width];
        let (own, above, below) = (row(v), row(v.saturating_sub(1)), row((v + 1).min(height - 1)));
        // Within a region there is no outline; all pixels at the edge of the image may have one.
        let mut marks = vec![1; width];
        let inner = width.saturating_sub(2);
        let (left, right) = (part(own, 0, inner), part(own, 2, inner));
        let [above, own, below] = [above, own, below].map(|row| part(row, 1, inner));
        let is_edge = v == 0 || v + 1 == height;
        // Of slices of one length and without branches, so that many are told at once.
        for (k, mark) in marks[1.min(width)..][..inner].iter_mut().enumerate() {
            let label = own[k];
            let differs = (left[k] ^ label) | (right[k] ^ label) | (above[k] ^ label) | (below[k] ^ label);
            *mark = i32::from(label >= first as i32) & i32::from((differs != 0) | is_edge);
        }
        marked(&marks).flat_map(|u| view.sides(u, v)).collect()
    };
    let rows: Vec<Vec<(SegmentId, Outline)>> = (0..height).into_par_iter().map(of_row).collect();
    let mut outlines = vec![Outline::default(); regions.count()];
    for (region, side) in rows.into_iter().flatten() {
        outlines[region.index()].add(side);
    }
    outlines
}

impl View<'_> {
    /// What the four sides of a pixel add to the outline of its region.
    fn sides(&self, u: usize, v: usize) -> Vec<(SegmentId, Outline)> {
        let (width, height) = self.regions.labels().size();
        let i = v * width + u;
        let is_asked = |region: &SegmentId| region.index() >= self.first && !self.points_m[i][2].is_nan();
        let Some(region) = self.regions.at(i).filter(is_asked) else { return Vec::new() };
        let camera = self.space.camera();
        let z_m = f64::from(self.points_m[i][2]);
        // A side of a pixel in a row is a piece of a column.
        let (tall_m, wide_m) = (z_m / camera.fy_px, z_m / camera.fx_px);
        let directions = [
            (width - 1 - u, 1, tall_m),
            (u, -1, tall_m),
            (height - 1 - v, width as isize, wide_m),
            (v, -(width as isize), wide_m),
        ];
        let side = |(room, step, length_m): (usize, isize, f64)| {
            let beyond = self.beyond(i, region, room, step)?;
            Some((region, self.side(i, step, &beyond, length_m)))
        };
        directions.into_iter().filter_map(side).collect()
    }

    /// What lies beyond a side; `None` when the region goes on there or nothing is seen.
    fn beyond(&self, i: usize, region: SegmentId, room: usize, step: isize) -> Option<Beyond> {
        for t in 1..=self.reach {
            if t > room {
                return Some(Beyond::Image);
            }
            let j = i.checked_add_signed(step * t as isize)?;
            if self.regions.at(j) == Some(region) {
                return None;
            }
            let z_m = f64::from(self.points_m[j][2]);
            if !z_m.is_nan() {
                let own_m = f64::from(self.points_m[i][2]);
                let is_step = (z_m - own_m).abs() > self.space.step_m(STEP_QUANTA, own_m.min(z_m));
                return Some(if is_step {
                    Beyond::Step { is_nearer: z_m < own_m }
                } else {
                    Beyond::Touching { pixel: j }
                });
            }
        }
        None
    }

    fn side(&self, i: usize, step: isize, beyond: &Beyond, length_m: f64) -> Outline {
        match *beyond {
            Beyond::Image => Outline { cut_m: length_m, ..Outline::default() },
            Beyond::Step { is_nearer } => {
                let seen = Outline { clear_m: length_m, judged_m: length_m, ..Outline::default() };
                if is_nearer {
                    Outline { hidden_m: length_m, ..seen }
                } else {
                    Outline { own_m: length_m, ..seen }
                }
            }
            Beyond::Touching { pixel } => {
                let own = Outline { own_m: length_m, ..Outline::default() };
                let surfaces = [self.surface(i, -step), self.surface(pixel, step)];
                let [Some(a), Some(b)] = surfaces else { return own };
                let fold = Fold { angle_deg: fold_angle_deg(a, b), length_m };
                let clear_m = (length_m - fold.vote_m(self.params)) / 2.0;
                Outline { clear_m, judged_m: length_m, ..own }
            }
        }
    }

    /// Point and normal some pixels away from the border within the region of `i`; nearer when the region is narrow.
    fn surface(&self, i: usize, step: isize) -> Option<(DVec3, DVec3)> {
        let own = self.regions.at(i);
        let along = (0..=self.aside).map_while(|t| {
            let j = i.checked_add_signed(step * t as isize).filter(|&j| j < self.points_m.len())?;
            (self.regions.at(j) == own).then_some(j)
        });
        let j = along.filter(|&j| self.normals[j] != [0.0; 3] && !self.points_m[j][2].is_nan()).last()?;
        let [point, normal] = [self.points_m[j], self.normals[j]].map(|p| DVec3::from(p.map(f64::from)));
        Some((point, normal))
    }
}

impl Outline {
    /// How clear the border is, in [0, 1]; 1 when nothing of it could be judged.
    pub fn separation(&self) -> f32 {
        if self.judged_m > 0.0 { (self.clear_m / self.judged_m) as f32 } else { 1.0 }
    }

    /// The share of the outline that is the region's own, in [0, 1]; 1 when nothing is seen beyond it.
    pub fn visibility(&self) -> f32 {
        let all_m = self.own_m + self.hidden_m + self.cut_m;
        if all_m > 0.0 { (self.own_m / all_m) as f32 } else { 1.0 }
    }

    fn add(&mut self, other: Self) {
        self.own_m += other.own_m;
        self.hidden_m += other.hidden_m;
        self.cut_m += other.cut_m;
        self.clear_m += other.clear_m;
        self.judged_m += other.judged_m;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objectness::testing::Table;

    /// The outlines of the table and the things of a drawing, in sides of pixels at the depth of the table.
    fn drawn(rows: &[&str], heights_m: &[f64]) -> Vec<Outline> {
        let table = Table::drawn(rows, heights_m);
        let scene = table.scene();
        let params = params::Contraction::default();
        outlines(&scene.facets.segments, 0, scene.points_m, scene.normals, scene.space, &params)
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
        // Farther than 24 px nothing is known; a hole in a thing is none of its outline.
        let apart = format!("a{}b", ".".repeat(24));
        let [_, a, _] = drawn(&[apart.as_str(); 2], &[0.3, 0.1])[..] else { panic!("three regions") };
        assert_eq!((a.own_m, a.hidden_m, a.judged_m, a.separation()), (0.0, 0.0, 0.0, 1.0));
        let [_, ring] = drawn(&["aaaa", "a..a", "aaaa"], &[0.3])[..] else { panic!("two regions") };
        assert_eq!((ring.own_m, ring.visibility()), (0.0, 0.0), "only the border of the image cuts it");
    }

    #[test]
    fn two_halves_of_one_surface_are_not_parted() {
        let rows = ["aaaaaaaaabbbbbbbbb"; 12];
        let [_, a, b] = drawn(&rows, &[0.2, 0.2])[..] else { panic!("three regions") };
        for half in [a, b] {
            assert!((sides(half.own_m, 0.2) - 12.0).abs() < 1e-2, "{half:?}");
            // A flat border is 12 degrees from the valley that is neutral, of 15 to a full vote.
            let expected = (1.0 - 12.0 / 15.0) / 2.0;
            assert!((f64::from(half.separation()) - expected).abs() < 0.02, "{half:?}");
        }
    }

    #[test]
    fn a_valley_parts_and_a_ridge_does_not() {
        // A roof seen from above, and the same as a trough: 0.4 m wide at 1 m, with sides of 45 degrees.
        let bent = |sign: f64| {
            let table = Table::new((210, 60), |u, _| {
                let x = (u as f64 - 104.5).abs() / 525.0;
                Some((if u < 105 { 1 } else { 2 }, 0.25 - sign * x))
            });
            let scene = table.scene();
            let params = params::Contraction::default();
            outlines(&scene.facets.segments, 0, scene.points_m, scene.normals, scene.space, &params)[1]
                .separation()
        };
        assert!(bent(1.0) < 0.05 && bent(-1.0) > 0.95, "{} {}", bent(1.0), bent(-1.0));
    }

    #[test]
    fn outlines_are_the_same_on_any_number_of_threads() {
        let rows = ["__aaa___bb", "__aa_.._bb", "cccc....bb", "cccc______"];
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| drawn(&rows, &[0.1, 0.3, 0.1]))
        };
        assert!([2, 8].into_iter().all(|threads| on(threads) == on(1)));
    }
}
