use proptest::prelude::*;

use super::*;
use crate::testing::{raster, small_size};

/// The plane in the window around pixel `i`, from its pixels.
fn naive(disparity: &Raster<f32>, i: usize, radius: usize) -> PlaneFit {
    let width = disparity.width();
    let (u, v) = (i % width, i / width);
    let window: Vec<[f64; 3]> = (0..disparity.len())
        .filter(|&j| (j % width).abs_diff(u) <= radius && (j / width).abs_diff(v) <= radius)
        .filter(|&j| !disparity[j].is_nan())
        .map(|j| [(j % width) as f64 - u as f64, (j / width) as f64 - v as f64, f64::from(disparity[j])])
        .collect();
    let n = window.len() as f64;
    if disparity[i].is_nan() || n < 0.4 * ((2 * radius + 1) * (2 * radius + 1)) as f64 {
        return PlaneFit::NONE;
    }
    let mean = [0, 1, 2].map(|k| window.iter().map(|p| p[k]).sum::<f64>() / n);
    let moment = |j: usize, k: usize| window.iter().map(|p| (p[j] - mean[j]) * (p[k] - mean[k])).sum::<f64>();
    // Cramer's rule.
    let spread = moment(0, 0) * moment(1, 1) - moment(0, 1) * moment(0, 1);
    let slope = [
        (moment(0, 2) * moment(1, 1) - moment(1, 2) * moment(0, 1)) / spread,
        (moment(1, 2) * moment(0, 0) - moment(0, 2) * moment(0, 1)) / spread,
    ];
    let at = |p: &[f64; 3]| mean[2] + slope[0] * (p[0] - mean[0]) + slope[1] * (p[1] - mean[1]);
    let squared: f64 = window.iter().map(|p| (p[2] - at(p)).powi(2)).sum();
    PlaneFit {
        value: at(&[0.0; 3]) as f32,
        slope: slope.map(|s| s as f32),
        residual: (squared / (n - 3.0)).sqrt() as f32,
    }
}

/// Small images, and images higher or wider than a tile.
fn size() -> impl Strategy<Value = (usize, usize)> {
    let (short, long) = (4_usize..9, TILE - 4..2 * TILE + 9);
    prop_oneof![3 => small_size(), 1 => (short.clone(), long.clone()), 1 => (long, short)]
}

proptest! {
    #[test]
    fn sliding_sums_give_the_planes_of_single_windows(
        disparity in size().prop_flat_map(|size| {
            raster(size, prop_oneof![1 => Just(f32::NAN), 4 => 20.0_f32..700.0])
        }),
        radius in 1_usize..=5,
    ) {
        let fits = fit_planes(&disparity, radius);
        for i in 0..disparity.len() {
            let (got, expected) = (fits.at(i), naive(&disparity, i, radius));
            prop_assert_eq!(got.is_some(), expected.is_some(), "{}", i);
            if expected.is_some() {
                let off = [
                    got.value - expected.value,
                    got.slope[0] - expected.slope[0],
                    got.slope[1] - expected.slope[1],
                    got.residual - expected.residual,
                ];
                prop_assert!(off.iter().all(|off| off.abs() < 2e-3), "{}: {:?} {:?}", i, got, expected);
            }
        }
    }
}

proptest! {
    /// With any vector units, and with each band fitted alone.
    #[test]
    fn vector_units_give_the_same_bits(
        disparity in (1_usize..90, 1_usize..90).prop_flat_map(|size| {
            raster(size, prop_oneof![1 => Just(f32::NAN), 4 => 20.0_f32..700.0])
        }),
        radius in 1_usize..=5,
    ) {
        let mut scalar = [0; 4].map(|_| vec![f32::NAN; disparity.len()]);
        let pixels: Vec<usize> = (0..disparity.len()).collect();
        for (band, pixels) in pixels.chunks(TILE * disparity.width()).enumerate() {
            let fits = scalar.each_mut().map(|image| &mut image[pixels[0]..][..pixels.len()]);
            fit_band(&disparity, band * TILE, radius, &mut SlidingWindows::default(), fits);
        }
        let PlaneFits { value, slope: [a, b], residual } =
            fit_planes(&disparity, radius);
        let bits = |image: Vec<f32>| image.into_iter().map(f32::to_bits).collect::<Vec<_>>();
        let got = [value, a, b, residual].map(|image| bits(image.into_vec()));
        prop_assert_eq!(got, scalar.map(bits));
    }
}

/// A regression: rounded sums of whole numbers gave a flat surface a residual.
#[test]
fn wide_windows_round_nothing_away() {
    let plane = |i: usize| 250.0 + 0.5 * (i % 200) as f32 - 0.25 * (i / 200) as f32;
    let disparity = Raster::from_vec(200, 200, (0..200 * 200).map(plane).collect()).unwrap();
    let fit = fit_planes(&disparity, 90).at(100 * 200 + 100);
    assert!(fit.residual < 1e-3 && fit.slope == [0.5, -0.25], "{fit:?}");
}

/// Sums of squares must not overflow at any radius.
#[test]
fn windows_grow_to_a_limit() {
    let side = 420;
    let plane = |i: usize| 450.0 + 0.5 * (i % side) as f32 - 0.25 * (i / side) as f32;
    let disparity = Raster::from_vec(side, side, (0..side * side).map(plane).collect()).unwrap();
    let [largest, larger] =
        [MOST_RADIUS_PX, MOST_RADIUS_PX + 50].map(|radius_px| fit_planes(&disparity, radius_px));
    let fit = larger.at(side * side / 2);
    assert!(fit.residual < 1e-2 && fit.slope.map(|s| (s * 1e3).round()) == [500.0, -250.0], "{fit:?}");
    assert_eq!(larger.images(), largest.images());
}

#[test]
fn a_plane_is_its_own_fit() {
    let plane = |i: usize| 250.0 + 0.5 * (i % 20) as f32 - 0.25 * (i / 20) as f32;
    let disparity = Raster::from_vec(20, 16, (0..320).map(plane).collect()).unwrap();
    let fits = fit_planes(&disparity, 3);
    for (i, fit) in (0..320).map(|i| fits.at(i)).enumerate() {
        // In a corner a window has 16 of its 49 pixels.
        let near_corner =
            [i % 20, 19 - i % 20].iter().min() == Some(&0) && [i / 20, 15 - i / 20].iter().min() == Some(&0);
        assert_eq!(fit.is_some(), !near_corner, "{i}");
        if fit.is_some() {
            assert!((fit.value - plane(i)).abs() < 1e-4 && fit.residual < 1e-4, "{i}: {fit:?}");
            assert!((fit.slope[0] - 0.5).abs() < 1e-5 && (fit.slope[1] + 0.25).abs() < 1e-5, "{i}");
        }
    }
}
