//! Planes of the scene in metres, fitted to points by total least squares.

use glam::{DMat3, DVec3, Vec3};

use crate::linear::principal_axes;

/// A large plane of the scene: normal · X + offset = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StructurePlane {
    /// Unit normal in the camera frame, towards the side of the camera.
    pub normal: [f32; 3],
    /// Distance of the camera from the plane (m).
    pub offset_m: f32,
    /// Share of the frame's valid points that lie on the plane, in [0, 1].
    pub inlier_share: f32,
}

impl StructurePlane {
    /// The unit normal, towards the side of the camera.
    pub(crate) fn normal(&self) -> DVec3 {
        Vec3::from(self.normal).as_dvec3()
    }

    /// Height (m) of a point above the plane: positive on the side of the camera.
    pub(crate) fn height_m(&self, point: DVec3) -> f64 {
        self.normal().dot(point) + f64::from(self.offset_m)
    }
}

/// Fits a plane to points by total least squares, with an inlier share of 1. `None` for fewer than three points. O(points).
pub fn fit_plane(points_m: &[[f32; 3]]) -> Option<StructurePlane> {
    let mut sums = PointSums::default();
    points_m.iter().for_each(|&p| sums.add(Vec3::from(p).as_dvec3()));
    sums.fit_plane()
}

/// normal · X + offset = 0 with offset >= 0, so that the normal points to the side of the camera.
pub(crate) struct Plane {
    pub normal: DVec3,
    pub offset_m: f64,
}

impl Plane {
    fn new(normal: DVec3, point: DVec3) -> Self {
        let offset_m = -normal.dot(point);
        if offset_m < 0.0 { Self { normal: -normal, offset_m: -offset_m } } else { Self { normal, offset_m } }
    }

    pub(crate) fn through([a, b, c]: [DVec3; 3]) -> Option<Self> {
        (b - a).cross(c - a).try_normalize().map(|normal| Self::new(normal, a))
    }

    /// Total least squares: the normal is the direction in which the points vary least.
    pub(crate) fn fit(points: impl Iterator<Item = DVec3>) -> Option<Self> {
        let mut sums = PointSums::default();
        points.for_each(|p| sums.add(p));
        sums.plane()
    }

    pub(crate) fn distance_m(&self, p: DVec3) -> f64 {
        (self.normal.dot(p) + self.offset_m).abs()
    }
}

/// Sums over points that determine their best plane: their number, x, y, z, and the products of these.
#[derive(Clone, Copy, Default)]
pub(crate) struct PointSums {
    n: f64,
    sum: DVec3,
    /// xx, yy, zz.
    squares: DVec3,
    /// xy, yz, zx.
    mixed: DVec3,
}

impl PointSums {
    /// The sums of `n` points; `mixed`: xy, yz, zx.
    pub(crate) fn new(n: f64, sum: DVec3, squares: DVec3, mixed: DVec3) -> Self {
        Self { n, sum, squares, mixed }
    }

    #[inline]
    pub(crate) fn add(&mut self, p: DVec3) {
        self.n += 1.0;
        self.sum += p;
        self.squares += p * p;
        self.mixed += p * DVec3::new(p.y, p.z, p.x);
    }

    /// Fits a plane to the points; `None` for fewer than three.
    pub(crate) fn fit_plane(&self) -> Option<StructurePlane> {
        let plane = self.plane()?;
        Some(StructurePlane {
            normal: plane.normal.as_vec3().to_array(),
            offset_m: plane.offset_m as f32,
            inlier_share: 1.0,
        })
    }

    fn plane(&self) -> Option<Plane> {
        let &Self { n, sum, squares, mixed } = self;
        let ([xx, yy, zz], [xy, yz, zx]) = (squares.to_array(), mixed.to_array());
        if n < 3.0 {
            return None;
        }
        let products = DMat3::from_cols_array_2d(&[[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]);
        let mean = sum / n;
        let covariance = products / n - DMat3::from_cols(mean * mean.x, mean * mean.y, mean * mean.z);
        Some(Plane::new(least_eigenvector(covariance), mean))
    }
}

/// The unit eigenvector of the least eigenvalue of a symmetric matrix.
fn least_eigenvector(symmetric: DMat3) -> DVec3 {
    let axes = principal_axes(symmetric).into_iter();
    axes.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(DVec3::Z, |(_, axis)| axis.normalize_or(DVec3::Z))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_least_eigenvector_is_one_and_least(
            columns in prop::array::uniform3(prop::array::uniform3(-1.0_f64..1.0)),
            scale in prop::sample::select(vec![1e-6, 1.0, 1e4]),
        ) {
            let root = DMat3::from_cols_array_2d(&columns);
            let symmetric = root.transpose() * root * scale;
            let vector = least_eigenvector(symmetric);
            let value = vector.dot(symmetric * vector);
            let size = symmetric.x_axis.length() + symmetric.y_axis.length() + symmetric.z_axis.length();
            prop_assert!((symmetric * vector - value * vector).length() <= 1e-12 * size);
            for other in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE.normalize()] {
                prop_assert!(other.dot(symmetric * other) >= value - 1e-12 * size);
            }
        }
    }

    #[test]
    fn a_plane_is_fitted_to_all_its_points() {
        let n = DVec3::new(0.1, -0.8, -0.6).normalize();
        let (s, t) = n.any_orthonormal_pair();
        let point = |k: usize| s * (k % 23) as f64 / 11.0 + t * (k / 23) as f64 / 11.0 - n;
        let points: Vec<[f32; 3]> = (0..500).map(|k| point(k).as_vec3().to_array()).collect();
        let plane = fit_plane(&points).unwrap();
        assert!(
            Vec3::from(plane.normal).as_dvec3().dot(n) > 0.999_999 && (plane.offset_m - 1.0).abs() < 1e-5
        );
        assert_eq!(fit_plane(&points[..2]), None);
    }
}
