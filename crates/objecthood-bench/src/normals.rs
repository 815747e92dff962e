//! How far normals are from that of the plane they lie on.

use objecthood::planes::StructurePlane;
use objecthood::support::gravity::find_dominant_plane;
use objecthood::{Params, Raster};

/// Points no farther than this from the plane are taken to lie on it: what `pcl_normals` takes.
const ON_PLANE_M: f32 = 0.007;

/// The plane that holds most points, found as `pcl_normals` finds it: by RANSAC, then fitted to its points.
pub fn table(points_m: &Raster<[f32; 3]>) -> Option<StructurePlane> {
    let mut params = Params::default().gravity;
    params.inlier_distance_m = f64::from(ON_PLANE_M);
    find_dominant_plane(points_m, &params)
}

/// Median angle (degrees) between the plane's normal and those of the points on it that have one.
pub fn median_angle_deg(
    normals: &Raster<[f32; 3]>,
    points_m: &Raster<[f32; 3]>,
    plane: &StructurePlane,
) -> Option<f64> {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let on_plane = |p: [f32; 3]| (dot(plane.normal, p) + plane.offset_m).abs() <= ON_PLANE_M;
    let pairs = normals.as_slice().iter().zip(points_m.as_slice());
    let mut cosines: Vec<f32> = pairs
        .filter(|&(&normal, &point)| normal != [0.0; 3] && on_plane(point))
        .map(|(&normal, _)| dot(plane.normal, normal).abs().min(1.0))
        .collect();
    cosines.sort_by(f32::total_cmp);
    cosines.get(cosines.len() / 2).map(|cosine| f64::from(*cosine).acos().to_degrees())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_angle_of_normals_turned_by_ten_degrees_is_ten() {
        let plane = StructurePlane { normal: [0.0, 0.0, -1.0], offset_m: 1.0, inlier_share: 1.0 };
        let (sin, cos) = 10_f32.to_radians().sin_cos();
        // Two on the plane are turned, one has no normal, one lies off the plane.
        let normals = [[0.0, sin, -cos], [sin, 0.0, -cos], [0.0; 3], [1.0, 0.0, 0.0]];
        let points = [[0.0, 0.0, 1.0], [0.3, 0.0, 1.005], [0.0, 0.1, 1.0], [0.0, 0.0, 1.2]];
        let [normals, points] = [normals, points].map(|list| Raster::from_vec(4, 1, list.to_vec()).unwrap());
        assert!((median_angle_deg(&normals, &points, &plane).unwrap() - 10.0).abs() < 1e-3);
    }

    #[test]
    fn no_normal_on_the_plane_has_no_angle() {
        let plane = StructurePlane { normal: [0.0, 0.0, -1.0], offset_m: 1.0, inlier_share: 1.0 };
        let none = Raster::filled(2, 2, [0.0; 3]).unwrap();
        assert_eq!(median_angle_deg(&none, &none, &plane), None);
    }
}
