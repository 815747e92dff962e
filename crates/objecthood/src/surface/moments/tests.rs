use proptest::prelude::*;

use super::*;
use crate::testing::{raster, small_size};

/// An image of disparities and two disjoint, non-empty sets of its pixels.
fn two_regions() -> impl Strategy<Value = (Raster<f32>, Vec<u32>, Vec<u32>)> {
    small_size()
        .prop_flat_map(|size| (raster(size, 0.0_f32..20.0), raster(size, 0_u8..3)))
        .prop_map(|(disparity, side)| {
            let of = |k: u8| (0..side.len() as u32).filter(|&i| side[i as usize] == k).collect();
            (disparity, of(0), of(1))
        })
        .prop_filter("both have pixels", |(_, a, b): &(_, Vec<u32>, Vec<u32>)| !a.is_empty() && !b.is_empty())
}

/// The sums over the pixels, from their definition.
fn summed(pixels: &[u32], disparity: &Raster<f32>, center: [f64; 2]) -> Moments {
    let mut moments = Moments::about(center);
    for &i in pixels {
        let [u, v] = position(i as usize, disparity.width());
        let (x, y, d) = (u - center[0], v - center[1], f64::from(disparity[i as usize]));
        for (i, j) in (0..5).flat_map(|i| (0..5 - i).map(move |j| (i, j))) {
            moments.powers[i][j] += x.powi(i as i32) * y.powi(j as i32);
        }
        for (i, j) in (0..3).flat_map(|i| (0..3 - i).map(move |j| (i, j))) {
            moments.products[i][j] += d * x.powi(i as i32) * y.powi(j as i32);
        }
        moments.squares += d * d;
    }
    moments
}

/// Equal except for rounding, which grows with the size of the terms.
fn assert_same(got: &Moments, expected: &Moments) -> Result<(), TestCaseError> {
    let flat = |m: &Moments| {
        let tables = [m.powers.as_flattened(), m.products.as_flattened(), &[m.squares], &m.center];
        tables.concat()
    };
    for (k, (got, expected)) in flat(got).into_iter().zip(flat(expected)).enumerate() {
        prop_assert!((got - expected).abs() <= 1e-6 + 1e-11 * expected.abs(), "{k}: {got} {expected}");
    }
    Ok(())
}

proptest! {
    #[test]
    fn moments_of_a_union_are_the_merged_ones(
        (disparity, a, b) in two_regions(),
        [center_a, center_b] in prop::array::uniform2(prop::array::uniform2(-5.0..20.0)),
    ) {
        let union = [a.as_slice(), &b].concat();
        let [of_a, of_b] = [&a, &b].map(|pixels| Moments::of(pixels, &disparity));
        let merged = of_a.merged(&of_b);
        let expected = Moments::of(&union, &disparity);
        assert_same(&merged, &expected)?;
        // For any centres of the parts.
        assert_same(&of_a.shifted(center_a).merged(&of_b.shifted(center_b)), &expected)?;
        prop_assert_eq!(merged.count(), union.len() as f64);
        for basis in [Basis::Plane, Basis::Quadratic] {
            let (merged, scratch) = (merged.fit(basis), expected.fit(basis));
            prop_assert!((merged.squared_error - scratch.squared_error).abs() < 1e-4);
            for &i in &union {
                let at = position(i as usize, disparity.width());
                prop_assert!((merged.model.value(at) - scratch.model.value(at)).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn moments_of_segments_and_trial_surfaces_are_the_same_bit_for_bit((disparity, a, b) in two_regions()) {
        let labels = (0..disparity.len() as u32).map(|i| if a.contains(&i) { 0 } else if b.contains(&i) { 2 } else { -1 });
        let segments = Segments::from_numbered(disparity.with_data(labels.collect()), 3);
        let [of_a, of_none, of_b] = &Moments::of_segments(&segments, &disparity)[..] else { panic!("three") };
        prop_assert_eq!([of_a, of_b], [&Moments::of(&a, &disparity), &Moments::of(&b, &disparity)]);
        prop_assert_eq!(of_none.count(), 0.0);
        for basis in [Basis::Plane, Basis::Quadratic] {
            let (trial, whole) = (of_a.fit_with(of_b, basis), of_a.merged(of_b).fit(basis));
            prop_assert_eq!((trial.model, trial.squared_error), (whole.model, whole.squared_error));
        }
    }

    #[test]
    fn the_sums_for_a_plane_fit_the_same_plane((disparity, pixels, _) in two_regions()) {
        let all = Moments::of(&pixels, &disparity);
        let mut some = Moments::about(all.center);
        for &i in &pixels {
            some.add_for_plane(position(i as usize, disparity.width()), disparity[i as usize].into());
        }
        let [all, some] = [all, some].map(|moments| moments.fit(Basis::Plane));
        prop_assert_eq!((some.model, some.squared_error), (all.model, all.squared_error));
    }

    #[test]
    fn moments_are_shifted_as_if_summed_there(
        (disparity, pixels, _) in two_regions(),
        center in prop::array::uniform2(-20.0..20.0),
    ) {
        let own = Moments::of(&pixels, &disparity);
        assert_same(&own, &summed(&pixels, &disparity, own.center))?;
        assert_same(&own.shifted(center), &summed(&pixels, &disparity, center))?;
        assert_same(&own.shifted(center).shifted(own.center), &own)?;
    }

    /// A fit is best when the residuals are orthogonal to every term. Only the ridge, in normalised
    /// coordinates, pulls the weights a little towards 0.
    #[test]
    fn a_fit_has_the_least_squared_error((disparity, pixels, _) in two_regions()) {
        let moments = Moments::of(&pixels, &disparity);
        let n = moments.count();
        let spread_px = ((moments.powers[2][0] + moments.powers[0][2]) / n).max(LEAST_SPREAD).sqrt();
        for (basis, terms) in [(Basis::Plane, 3), (Basis::Quadratic, 6)] {
            let Fit { model, squared_error } = moments.fit(basis);
            let residuals = pixels.iter().map(|&i| {
                let at = position(i as usize, disparity.width());
                (at, f64::from(disparity[i as usize]) - model.value(at))
            });
            let (mut left, mut drawn) = (residuals.clone().map(|(_, r)| r * r).sum::<f64>(), 0.0);
            for (k, &(p, q)) in TERMS[..terms].iter().enumerate() {
                let term = |[u, v]: [f64; 2]| {
                    let [x, y] = [u - model.center[0], v - model.center[1]].map(|x| x / spread_px);
                    x.powi(p as i32) * y.powi(q as i32)
                };
                let weight = model.weights[k] * spread_px.powi((p + q) as i32);
                let along: f64 = residuals.clone().map(|(at, r)| r * term(at)).sum();
                prop_assert!((along - n * RIDGE * weight).abs() < 1e-6 * n, "{along}");
                drawn += n * RIDGE * weight * weight;
            }
            left += drawn;
            prop_assert!((squared_error - left).abs() < 1e-6 * n, "{squared_error} {left}");
        }
    }

    #[test]
    fn planes_and_quadratics_are_recovered(
        corner in prop::array::uniform2(0_usize..600),
        [a, b] in prop::array::uniform2(-3.0..3.0),
        [xx, xy, yy] in prop::array::uniform3(-0.1..0.1),
        side in 3_usize..12,
    ) {
        let at = |k: usize| [(corner[0] + k % side) as f64, (corner[1] + k / side) as f64];
        for (basis, bend) in [(Basis::Plane, 0.0), (Basis::Quadratic, 1.0)] {
            let surface = |[u, v]: [f64; 2]| {
                let (x, y) = (u - corner[0] as f64, v - corner[1] as f64);
                300.0 + a * x + b * y + bend * (xx * x * x + xy * x * y + yy * y * y)
            };
            // About a centre other than the centroid, as for the structure.
            let mut moments = Moments::about(at(0));
            (0..side * side).for_each(|k| moments.add(at(k), surface(at(k))));
            let Fit { model, squared_error } = moments.fit(basis);
            prop_assert!(squared_error < 0.02 * moments.count(), "{squared_error}");
            for at in (0..side * side).map(at) {
                prop_assert!((model.value(at) - surface(at)).abs() < 0.02);
                let rise = [[0.5, 0.0], [0.0, 0.5]].map(|[du, dv]| {
                    surface([at[0] + du, at[1] + dv]) - surface([at[0] - du, at[1] - dv])
                });
                let slope = model.slope(at);
                prop_assert!((slope[0] - rise[0]).abs() < 0.02 && (slope[1] - rise[1]).abs() < 0.02);
            }
            let about_center = model.slope(model.center);
            prop_assert!((model.steepness() - about_center[0].hypot(about_center[1])).abs() < 1e-9);
        }
    }
}

#[test]
fn what_determines_no_surface_is_fitted_all_the_same() {
    let disparity = Raster::from_vec(9, 9, (0..81).map(|i| 200.0 + (i % 9) as f32).collect()).unwrap();
    let row: Vec<u32> = (36..45).collect();
    let column: Vec<u32> = (0..9).map(|v| 9 * v + 4).collect();
    let diagonal: Vec<u32> = (0..9).map(|v| 10 * v).collect();
    for pixels in [&row[..1], &row[..2], &row, &column, &diagonal, &[0, 1, 9]] {
        for basis in [Basis::Plane, Basis::Quadratic] {
            let fit = Moments::of(pixels, &disparity).fit(basis);
            for &i in pixels {
                let expected = f64::from(disparity[i as usize]);
                let got = fit.model.value(position(i as usize, 9));
                assert!((got - expected).abs() < 0.01, "{basis:?} {pixels:?}: {got} {expected}");
            }
            let elsewhere = fit.model.value([20.0, 20.0]);
            assert!(elsewhere.is_finite() && fit.squared_error.is_finite(), "{basis:?} {pixels:?}");
        }
    }
    // No pixels: no panic.
    let none = Moments::about([3.0, 4.0]);
    assert_eq!((none.count(), none.shifted([0.0; 2]).count(), none.merged(&none).count()), (0.0, 0.0, 0.0));
    none.fit(Basis::Quadratic);
}
