//! Chooses the window that gives a pixel its orientation (docs/CONTEXT.md 0.4).
//!
//! Near an edge the window around a pixel mixes two surfaces. Another window that contains the pixel may lie on one of them.

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::params;
use crate::raster::Raster;
use crate::simd::vectorized;
use crate::surface::disparity::DisparitySpace;
use crate::surface::plane_fit::{PlaneFit, PlaneFits};

/// The surface at every pixel.
#[derive(Clone, Debug)]
pub struct Orientation {
    /// Change of disparity along u and v (quanta/px); zero where it is not known.
    pub slope: Raster<[f32; 2]>,
    /// Unit normals towards the camera; zero where there is none.
    pub normal: Raster<[f32; 3]>,
}

/// Weight of the distance between a pixel and a window's plane, against the window's residual.
const MISFIT_WEIGHT: f32 = 0.5;
/// Factor on the score of the pixel's own window, so that it wins near-ties.
const OWN_PREFERENCE: f32 = 0.8;

/// Chooses the best of nine windows that contain each pixel and takes its orientation (Kuwahara et al. 1976).
///
/// The windows are centred at the pixel and at the eight positions `local_fit.radius_px` - 1 away along u, v or both. A pixel keeps
/// its own window if the residual is below `own_window_residual_quanta`. Otherwise the window with the least sum of residual and
/// weighted misfit wins, the first one on ties. Without the choice, normals bend at edges. O(9 pixels); parallel over rows.
pub fn choose_windows(
    disparity: &Raster<f32>,
    fits: &PlaneFits,
    space: &DisparitySpace,
    params: &params::LocalFit,
) -> Orientation {
    let reach = space.length_px(params.radius_px) as isize - 1;
    let limit = space.noise().step_scale() as f32 * params.own_window_residual_quanta;
    let choice = Choice { disparity, fits, space, reach, limit };
    let width = disparity.width();
    let mut slope = Buffer::stale(disparity.len(), [0.0; 2]);
    let mut normal = Buffer::stale(disparity.len(), [0.0; 3]);
    let rows = slope.par_chunks_mut(width).zip(normal.par_chunks_mut(width)).enumerate();
    rows.for_each(|(v, (slope, normal))| {
        vectorized(
            #[inline(always)]
            || choice.take_own(v, slope, normal),
        );
        choice.take_best(v, slope, normal);
    });
    Orientation { slope: disparity.with_data(slope), normal: disparity.with_data(normal) }
}

/// The inputs of the choice.
struct Choice<'a> {
    disparity: &'a Raster<f32>,
    fits: &'a PlaneFits,
    space: &'a DisparitySpace,
    /// Distance (px) of the other windows' centres along u and v.
    reach: isize,
    /// Residual (quanta) below which a pixel keeps its own window.
    limit: f32,
}

impl Choice<'_> {
    /// Gives each pixel of row `v` that keeps its own window the orientation of that window; the other pixels get 0.
    #[inline(always)]
    fn take_own(&self, v: usize, slope: &mut [[f32; 2]], normal: &mut [[f32; 3]]) {
        let row = v * slope.len()..(v + 1) * slope.len();
        let measured = &self.disparity.as_slice()[row.clone()];
        let [value, a, b, residual] = self.fits.images().map(|image| &image.as_slice()[row.clone()]);
        let own = measured.iter().zip(residual).zip(value.iter().zip(a).zip(b));
        let orientation = slope.iter_mut().zip(normal);
        for (u, (((d, residual), ((value, a), b)), (slope, normal))) in own.zip(orientation).enumerate() {
            let own = PlaneFit { value: *value, slope: [*a, *b], residual: *residual };
            let (own_slope, own_normal) = orient(self.space, [u, v], &own);
            let is_kept = (own.residual < self.limit) & !d.is_nan();
            *slope = own_slope.map(|x| if is_kept { x } else { 0.0 });
            *normal = own_normal.map(|x| if is_kept { x } else { 0.0 });
        }
    }

    /// Gives each other measured pixel of row `v` the orientation of its best window.
    fn take_best(&self, v: usize, slope: &mut [[f32; 2]], normal: &mut [[f32; 3]]) {
        let width = slope.len();
        let measured = &self.disparity.as_slice()[v * width..(v + 1) * width];
        let own = &self.fits.residual.as_slice()[v * width..(v + 1) * width];
        let stretches = measured.chunks(STRETCH).zip(own.chunks(STRETCH));
        for (left, (measured, own)) in (0..).step_by(STRETCH).zip(stretches) {
            let is_open = |(d, residual): (&f32, &f32)| !d.is_nan() & (*residual >= self.limit);
            if !measured.iter().zip(own).fold(false, |any, pixel| any | is_open(pixel)) {
                continue;
            }
            let best = vectorized(
                #[inline(always)]
                || BestWindows::find([left, v], measured, self.fits, self.reach),
            );
            for (lane, pixel) in measured.iter().zip(own).enumerate() {
                if is_open(pixel) && best.score[lane].is_finite() {
                    let j = best.middle[lane] as usize;
                    (slope[left + lane], normal[left + lane]) =
                        orient(self.space, [j % width, j / width], &self.fits.at(j));
                }
            }
        }
    }
}

/// Slope and unit normal of the plane fitted around the pixel in this column and row.
#[inline(always)]
fn orient(space: &DisparitySpace, [u, v]: [usize; 2], fit: &PlaneFit) -> ([f32; 2], [f32; 3]) {
    let normal = space.normal([u as f64, v as f64], f64::from(fit.value), fit.slope.map(f64::from));
    (fit.slope, normal.map(|part| part as f32))
}

/// Pixels of a row whose windows are compared side by side.
const STRETCH: usize = 16;

/// The window of least score for each pixel of a stretch; the first one on ties.
struct BestWindows {
    /// Score (quanta), from the residual and the misfit of the pixel; infinite when there is no window.
    score: [f32; STRETCH],
    /// The pixel at the centre of the window.
    middle: [i32; STRETCH],
}

impl BestWindows {
    /// Compares the windows of pixels with these disparities. (u, v): the first pixel.
    #[inline(always)]
    fn find([u, v]: [usize; 2], disparity: &[f32], fits: &PlaneFits, reach: isize) -> Self {
        let (width, height) = fits.residual.size();
        let mut best = Self { score: [f32::INFINITY; STRETCH], middle: [0; STRETCH] };
        for dv in [-reach, 0, reach] {
            let Some(row) = v.checked_add_signed(dv).filter(|row| *row < height) else { continue };
            for du in [-reach, 0, reach] {
                // The pixels for which the centre of this window lies in the image.
                let start = u.max(du.min(0).unsigned_abs());
                let end = (u + disparity.len()).min(width.saturating_sub(du.max(0).unsigned_abs()));
                if start < end {
                    let first = row * width + start.wrapping_add_signed(du);
                    best.prefer(start - u, &disparity[start - u..end - u], fits, first, [du, dv]);
                }
            }
        }
        best
    }

    /// Replaces the best windows so far by the windows around the pixels from `first` on, where these have a lower score. The
    /// windows are compared for the pixels from `lane` on, with these disparities; their centres lie (du, dv) away.
    #[inline(always)]
    fn prefer(
        &mut self,
        lane: usize,
        disparity: &[f32],
        fits: &PlaneFits,
        first: usize,
        [du, dv]: [isize; 2],
    ) {
        let [value, a, b, residual] =
            fits.images().map(|image| &image.as_slice()[first..][..disparity.len()]);
        let windows = value.iter().zip(a).zip(b).zip(residual).zip(disparity);
        let best = self.score[lane..].iter_mut().zip(&mut self.middle[lane..]);
        let preference = if du == 0 && dv == 0 { OWN_PREFERENCE } else { 1.0 };
        let (du, dv) = (du as f32, dv as f32);
        for (k, ((least, middle), ((((value, a), b), residual), d))) in best.zip(windows).enumerate() {
            let at_pixel = value - a * du - b * dv;
            // Infinite when the window has no fit.
            let score = (residual + MISFIT_WEIGHT * (at_pixel - d).abs()) * preference;
            let is_less = score < *least;
            *least = if is_less { score } else { *least };
            *middle = if is_less { (first + k) as i32 } else { *middle };
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::surface::disparity::position;
    use crate::testing::{coarse_disparity, kinect, plane_fits, raster, small_size};

    /// Fits in coarse steps, so that scores tie; one in five is missing.
    fn fit() -> impl Strategy<Value = PlaneFit> {
        let some =
            (200_u8..=208, prop::array::uniform2(-1_i8..=1), 0_u8..4).prop_map(|(value, slope, rest)| {
                PlaneFit {
                    value: f32::from(value),
                    slope: slope.map(f32::from),
                    residual: f32::from(rest) / 2.0,
                }
            });
        prop_oneof![1 => Just(PlaneFit::NONE), 4 => some]
    }

    /// Small images, and some that are wider than a stretch.
    fn size() -> impl Strategy<Value = (usize, usize)> {
        prop_oneof![4 => small_size(), 1 => (STRETCH - 3..STRETCH + 9, 1_usize..5)]
    }

    proptest! {
        #[test]
        fn the_window_is_the_naive_one(
            (disparity, fits) in
                size().prop_flat_map(|size| (raster(size, coarse_disparity()), raster(size, fit()))),
            radius_px in 1_usize..6,
        ) {
            let (space, width) = (kinect(), disparity.width());
            let params = params::LocalFit { radius_px, own_window_residual_quanta: 0.8 };
            let got = choose_windows(&disparity, &plane_fits(&fits), &space, &params);
            for i in 0..disparity.len() {
                // All windows centred at one of the nine places, in scan order.
                let place = |d: usize| d == 0 || d == radius_px - 1;
                let mut windows = Vec::new();
                for j in 0..disparity.len() {
                    let [u, v] = position(i, width).map(|x| x as f32);
                    let [x, y] = position(j, width).map(|x| x as f32);
                    let near = place((u - x).abs() as usize) && place((v - y).abs() as usize);
                    if near && fits[j].is_some() {
                        let PlaneFit { value, slope, residual } = fits[j];
                        let misfit = value + slope[0] * (u - x) + slope[1] * (v - y) - disparity[i];
                        let score = residual + 0.5 * misfit.abs();
                        windows.push((if i == j { 0.8 * score } else { score }, j));
                    }
                }
                let best = windows.into_iter().reduce(|best, next| if next.0 < best.0 { next } else { best });
                let chosen = if fits[i].residual < 0.8 { Some(i) } else { best.map(|(_, j)| j) };
                let expected = match chosen.filter(|_| !disparity[i].is_nan()) {
                    None => ([0.0; 2], [0.0; 3]),
                    Some(j) => {
                        let PlaneFit { value, slope, .. } = fits[j];
                        let normal = space.normal(position(j, width), value.into(), slope.map(f64::from));
                        (slope, normal.map(|part| part as f32))
                    }
                };
                prop_assert_eq!((got.slope[i], got.normal[i]), expected, "{}", i);
            }
        }
    }
}
