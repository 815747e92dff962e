//! Small linear algebra, with the same bits on every platform.

use glam::{DMat3, DVec3};

/// The range [low, high] that holds nothing.
pub(crate) const NO_RANGE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// The range [low, high] that also holds x. Compared directly: `f64::min` also looks for NaN, which costs more.
#[inline(always)]
pub(crate) fn widened([low, high]: [f64; 2], x: f64) -> [f64; 2] {
    [if x < low { x } else { low }, if x > high { x } else { high }]
}

/// Length of a plane vector. `hypot` would differ between platforms.
#[inline]
pub(crate) fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

/// The angle of the principal axis of a 2x2 covariance [xx, xy, yy], counter-clockwise from x (radians, within a quarter turn).
pub(crate) fn principal_angle([xx, xy, yy]: [f64; 3]) -> f64 {
    0.5 * libm::atan2(2.0 * xy, xx - yy)
}

/// The eigenvalues of a symmetric matrix, each with its unit eigenvector, in no particular order, by cyclic Jacobi rotations (Golub and Van
/// Loan, 8.5). It needs only arithmetic and square roots, so every platform gives the same result.
pub(crate) fn principal_axes(symmetric: DMat3) -> [(f64, DVec3); 3] {
    // Convergence is quadratic: nothing is left off the diagonal after five or six sweeps.
    const SWEEPS: usize = 8;
    let mut a = symmetric.to_cols_array_2d();
    let mut vectors = DMat3::IDENTITY.to_cols_array_2d();
    for (p, q) in [(0, 1), (0, 2), (1, 2)].repeat(SWEEPS) {
        if a[p][q] == 0.0 {
            continue;
        }
        // The rotation by the smaller of the two angles that zero the element (p, q).
        let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
        let tangent = 1.0_f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
        let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
        let sine = tangent * cosine;
        let turn = |x: f64, y: f64| (cosine * x - sine * y, sine * x + cosine * y);
        for row in &mut a {
            (row[p], row[q]) = turn(row[p], row[q]);
        }
        for k in 0..3 {
            (a[p][k], a[q][k]) = turn(a[p][k], a[q][k]);
            (vectors[p][k], vectors[q][k]) = turn(vectors[p][k], vectors[q][k]);
        }
    }
    [0, 1, 2].map(|k| (a[k][k], DVec3::from(vectors[k])))
}

/// Solves `matrix` · x = `right` by Gaussian elimination with partial pivoting. An unknown that no equation determines is 0.
/// O(K^3).
pub(crate) fn solve<const K: usize>(mut matrix: [[f64; K]; K], mut right: [f64; K]) -> [f64; K] {
    for k in 0..K {
        let mut pivot = k;
        for row in k + 1..K {
            if matrix[row][k].abs() > matrix[pivot][k].abs() {
                pivot = row;
            }
        }
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        if matrix[k][k] == 0.0 {
            continue;
        }
        for row in k + 1..K {
            let factor = matrix[row][k] / matrix[k][k];
            let pivot_row = matrix[k];
            for (entry, pivot) in matrix[row][k..].iter_mut().zip(&pivot_row[k..]) {
                *entry -= factor * pivot;
            }
            right[row] -= factor * right[k];
        }
    }
    let mut x = [0.0; K];
    for k in (0..K).rev() {
        if matrix[k][k] != 0.0 {
            let known: f64 = (k + 1..K).map(|column| matrix[k][column] * x[column]).sum();
            x[k] = (right[k] - known) / matrix[k][k];
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn principal_axes_are_eigenvectors_at_right_angles(
            columns in prop::array::uniform3(prop::array::uniform3(-1.0_f64..1.0)),
        ) {
            let root = DMat3::from_cols_array_2d(&columns);
            let symmetric = root.transpose() * root;
            let axes = principal_axes(symmetric);
            for (k, (value, axis)) in axes.iter().enumerate() {
                prop_assert!((symmetric * *axis - *value * *axis).length() < 1e-12);
                prop_assert!((axis.length() - 1.0).abs() < 1e-12);
                prop_assert!(axes[..k].iter().all(|(_, other)| axis.dot(*other).abs() < 1e-12));
            }
        }

        #[test]
        fn the_solution_of_a_system_solves_it(
            // A heavy diagonal, so that every unknown is determined; rows shuffled, so that pivots are sought.
            entries in prop::array::uniform4(prop::array::uniform4(-1.0_f64..1.0)),
            expected in prop::array::uniform4(-5.0_f64..5.0),
            order in Just([0, 1, 2, 3]).prop_shuffle(),
        ) {
            let row = |r: usize| std::array::from_fn(|c| entries[r][c] + if r == c { 6.0 } else { 0.0 });
            let matrix: [[f64; 4]; 4] = order.map(row);
            let right = matrix.map(|row| row.iter().zip(&expected).map(|(a, x)| a * x).sum());
            let got = solve(matrix, right);
            for (got, expected) in got.iter().zip(&expected) {
                prop_assert!((got - expected).abs() < 1e-9, "{} {}", got, expected);
            }
        }
    }

    #[test]
    fn an_unknown_that_nothing_determines_is_0() {
        assert_eq!(solve([[2.0, 0.0], [0.0, 0.0]], [6.0, 0.0]), [3.0, 0.0]);
    }
}
