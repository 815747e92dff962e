//! The histogram bins of colours and of normals (paper, eq. 3).

use std::f32::consts::{FRAC_PI_2, PI};

use crate::color::{NEARLY_LAB_ERROR, lab, linear, nearly_lab};
use crate::params;
use crate::simd::vectorized;

/// Marks a pixel that is not counted.
pub(super) const NONE: i32 = -1;
/// Marks a pixel whose approximate value lies too near to the limit of a bin; the exact value then decides.
const UNSURE: i32 = -2;

/// Finds the bins of colours: L over [0, 100], a and b over [-64, 64]; values beyond fall into the outermost bins.
///
/// A fast approximation is used where its error cannot change the bin, which is nearly always.
pub(super) fn find_color_bins(colors: &[[u8; 3]], lab_bins: usize, bins: &mut [i32]) {
    let side = lab_bins as i32;
    let (error_l, error_ab) = (NEARLY_LAB_ERROR / 100.0, NEARLY_LAB_ERROR / 128.0);
    for (bins, colors) in bins.chunks_mut(SIDE_BY_SIDE).zip(colors.chunks(SIDE_BY_SIDE)) {
        let mut light = [[0.0; 3]; SIDE_BY_SIDE];
        light.iter_mut().zip(colors).for_each(|(light, rgb)| *light = linear(*rgb));
        vectorized(
            #[inline(always)]
            || {
                for (bin, light) in bins.iter_mut().zip(&light) {
                    let [l, a, b] = shares(nearly_lab(*light));
                    let [l, a, b] = [
                        sure_bin(l, error_l, side),
                        sure_bin(a, error_ab, side),
                        sure_bin(b, error_ab, side),
                    ];
                    *bin = if (l | a | b) < 0 { UNSURE } else { (l * side + a) * side + b };
                }
            },
        );
        for (bin, rgb) in bins.iter_mut().zip(colors).filter(|(bin, _)| **bin == UNSURE) {
            *bin = lab_bin(lab(*rgb), lab_bins) as i32;
        }
    }
}

/// Colours that are converted side by side.
const SIDE_BY_SIDE: usize = 64;

/// The bin of a colour.
pub(super) fn lab_bin(lab: [f32; 3], bins: usize) -> usize {
    let [l, a, b] = shares(lab);
    (bin_of(l, bins) * bins + bin_of(a, bins)) * bins + bin_of(b, bins)
}

/// The place of a colour in the range of each axis: 0 at its start, 1 at its end.
#[inline(always)]
fn shares([l, a, b]: [f32; 3]) -> [f32; 3] {
    [l / 100.0, (a + 64.0) / 128.0, (b + 64.0) / 128.0]
}

/// Finds the bins of normals by their inclination from the camera's up (acos of -y) and their azimuth around it; [`NONE`] for a
/// normal of zero.
///
/// Polynomials are used where their error cannot change the bin, which is nearly always.
pub(super) fn find_direction_bins(normals: &[[f32; 3]], params: &params::Appearance, bins: &mut [i32]) {
    let (inclination_bins, azimuth_bins) = (params.inclination_bins as i32, params.azimuth_bins as i32);
    vectorized(
        #[inline(always)]
        || {
            for (bin, &[x, y, z]) in bins.iter_mut().zip(normals) {
                let [inclination, azimuth] =
                    [nearly_acos(up(y)) / PI, (nearly_atan2(x, -z) + PI) / (2.0 * PI)];
                let inclination = sure_bin(inclination, ANGLE_ERROR, inclination_bins);
                let azimuth = sure_bin(azimuth, ANGLE_ERROR, azimuth_bins);
                let sure = inclination * azimuth_bins + azimuth;
                let is_some = (x != 0.0) | (y != 0.0) | (z != 0.0);
                let or_unsure = if (inclination | azimuth) < 0 { UNSURE } else { sure };
                *bin = if is_some { or_unsure } else { NONE };
            }
        },
    );
    for (bin, normal) in bins.iter_mut().zip(normals).filter(|(bin, _)| **bin == UNSURE) {
        *bin = direction_bin(*normal, params) as i32;
    }
}

/// The bin of a normal other than zero.
pub(super) fn direction_bin([x, y, z]: [f32; 3], params: &params::Appearance) -> usize {
    let inclination = libm::acosf(up(y)) / PI;
    let azimuth = (libm::atan2f(x, -z) + PI) / (2.0 * PI);
    bin_of(inclination, params.inclination_bins) * params.azimuth_bins + bin_of(azimuth, params.azimuth_bins)
}

/// The cosine of a normal's inclination.
#[inline(always)]
fn up(y: f32) -> f32 {
    (-y).clamp(-1.0, 1.0)
}

fn bin_of(share: f32, bins: usize) -> usize {
    ((share * bins as f32).max(0.0) as usize).min(bins - 1)
}

/// The bin of a value whose error is at most `error`; [`UNSURE`] if a limit of the bin is nearer than that. Value and error are
/// shares of the range.
#[inline(always)]
fn sure_bin(share: f32, error: f32, bins: i32) -> i32 {
    let place = share * bins as f32;
    let bin = place as i32;
    let (past, margin) = (place - bin as f32, error * bins as f32);
    let is_sure = (past > margin) & (past < 1.0 - margin) & (bin < bins);
    if is_sure { bin } else { UNSURE }
}

/// Bound on the error of [`nearly_acos`] as a share of π, and of [`nearly_atan2`] as a share of 2π.
const ANGLE_ERROR: f32 = 3e-5;

/// The arc cosine to within 6.8e-5 (Abramowitz and Stegun 4.4.45).
#[inline(always)]
fn nearly_acos(x: f32) -> f32 {
    let t = x.abs();
    let positive = (1.0 - t).sqrt() * (1.570_728_8 + t * (-0.212_114_4 + t * (0.074_261 - 0.018_729_3 * t)));
    if x < 0.0 { PI - positive } else { positive }
}

/// The angle of (x, y) in -π..π to within 1.2e-5 (Abramowitz and Stegun 4.4.49); `NaN` for (0, 0).
#[inline(always)]
fn nearly_atan2(y: f32, x: f32) -> f32 {
    let ratio = x.abs().min(y.abs()) / x.abs().max(y.abs());
    let s = ratio * ratio;
    let first =
        ratio * (0.999_866 + s * (-0.330_299_5 + s * (0.180_141 + s * (-0.085_133 + s * 0.020_835_1))));
    let steep = if y.abs() > x.abs() { FRAC_PI_2 - first } else { first };
    let right = if x < 0.0 { PI - steep } else { steep };
    right.copysign(y)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn bins_are_the_exact_ones(
            rgb in any::<[u8; 3]>(),
            // Also along the axes, where angles are the limits of bins.
            normal in prop::array::uniform3(prop_oneof![-1.0_f32..1.0, Just(0.0), Just(-0.0), Just(1.0), Just(-1.0)]),
            lab_bins in 1_usize..=32,
            inclination_bins in 1_usize..=180,
            azimuth_bins in 1_usize..=360,
        ) {
            let mut bins = [0];
            find_color_bins(&[rgb], lab_bins, &mut bins);
            prop_assert_eq!(bins[0], lab_bin(lab(rgb), lab_bins) as i32);
            let params = params::Appearance { inclination_bins, azimuth_bins, ..Default::default() };
            let unit = glam::Vec3::from(normal).normalize_or_zero().to_array();
            find_direction_bins(&[unit], &params, &mut bins);
            prop_assert_eq!(bins[0], if unit == [0.0; 3] { NONE } else { direction_bin(unit, &params) as i32 });
        }
    }

    #[test]
    fn polynomials_are_within_their_error() {
        for k in -100_000..=100_000 {
            let x = k as f32 / 100_000.0;
            assert!((nearly_acos(x) - libm::acosf(x)).abs() < ANGLE_ERROR * PI, "{x}");
            let (y, x) = (libm::sinf(x * PI), libm::cosf(x * PI));
            assert!((nearly_atan2(y, x) - libm::atan2f(y, x)).abs() < ANGLE_ERROR * 2.0 * PI, "{x} {y}");
        }
    }

    #[test]
    fn bins_of_known_colours_and_directions() {
        assert_eq!(lab_bin([0.0, -64.0, -64.0], 8), 0);
        assert_eq!(lab_bin([100.0, 200.0, 200.0], 8), 511);
        assert_eq!(lab_bin([50.0, 0.0, 0.0], 8), (4 * 8 + 4) * 8 + 4);
        let params = params::Appearance::default();
        // Up (camera -y) is inclination 0; the camera's own direction (-z) is azimuth 0, the middle.
        assert_eq!(direction_bin([0.0, -1.0, 0.0], &params) / 16, 0);
        assert_eq!(direction_bin([0.0, 1.0, 0.0], &params) / 16, 7);
        // A normal tilted a little downwards is just past the middle inclination.
        assert_eq!(direction_bin([0.0, 0.1, -0.99], &params), 4 * 16 + 8);
    }
}
