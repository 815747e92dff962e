//! The pinhole camera behind an organized cloud.

use objecthood::Camera;

use super::is_valid;
use crate::cloud::PointCloud;
use crate::error::{Error, Result};

/// The camera that best explains where the points of a cloud stand in its grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFit {
    /// The camera.
    pub camera: Camera,
    /// Root mean square distance between the pixels of the points and where the camera sees them (px).
    pub residual_px: f64,
    /// Number of points used.
    pub points: usize,
}

/// A camera that misses the pixels by more than this is not the one that saw them (px).
pub const MAX_RESIDUAL_PX: f64 = 0.5;

/// Focal length, as a share of the longer side of the image, where the points leave it open: that of the Kinect.
const NOMINAL_FOCAL_SHARE: f64 = 525.0 / 640.0;

/// Fits u = fx·(x/z) + cx and v = fy·(y/z) + cy to the valid points of an organized cloud by least squares.
///
/// A focal length takes points in two columns (fx) or rows (fy). Where all stand in one, pixels are taken to be
/// square, and the other axis tells it; where neither does (a single pixel), it is 525/640 of the longer side. The
/// principal point then is the one with which the points project to where they stand.
///
/// Three passes over the points in f64; O(pixels).
///
/// # Errors
/// * [`Error::Frame`] with `NoValidDepth` when no point is valid;
/// * [`Error::NotPinhole`] when the columns do not run along x or the rows along y;
/// * [`Error::CameraResidual`] when the points miss their pixels by more than [`MAX_RESIDUAL_PX`].
pub fn fit_camera(cloud: &PointCloud) -> Result<CameraFit> {
    let sights = sights(cloud);
    let mut points = 0_usize;
    let mut axes = [Axis::default(); 2];
    for sights in sights.clone() {
        points += 1;
        axes.iter_mut().zip(sights).for_each(|(axis, sight)| axis.add_to_mean(sight));
    }
    if points == 0 {
        let size = (cloud.width, cloud.height);
        return Err(objecthood::Error::NoValidDepth { size }.into());
    }
    axes.iter_mut().for_each(|axis| axis.finish_mean(points));
    for sights in sights.clone() {
        axes.iter_mut().zip(sights).for_each(|(axis, sight)| axis.add_moments(sight));
    }
    let [columns, rows] = axes;
    let (fx, fy) = match (columns.focal_px()?, rows.focal_px()?) {
        (Some(fx), Some(fy)) => (fx, fy),
        (Some(f), None) | (None, Some(f)) => (f, f),
        (None, None) => {
            let f = NOMINAL_FOCAL_SHARE * cloud.width.max(cloud.height) as f64;
            (f, f)
        }
    };
    let camera = Camera::new(fx, fy, columns.principal_px(fx), rows.principal_px(fy));
    // Points far beside the others make one that nobody has, and the user gave none that could be corrected.
    let camera = camera.map_err(|_| Error::NotPinhole)?;

    let square = |(pixel, slope): Sight, f: f64, c: f64| (f * slope + c - pixel).powi(2);
    let squares = sights.map(|[across, down]| {
        square(across, camera.fx_px, camera.cx_px) + square(down, camera.fy_px, camera.cy_px)
    });
    let residual_px = (squares.sum::<f64>() / points as f64).sqrt();
    if residual_px <= MAX_RESIDUAL_PX {
        Ok(CameraFit { camera, residual_px, points })
    } else {
        Err(Error::CameraResidual { residual_px })
    }
}

/// A pixel coordinate and the slope of the ray through it, x/z or y/z.
type Sight = (f64, f64);

/// Where the valid points stand and are seen, across and down.
fn sights(cloud: &PointCloud) -> impl Iterator<Item = [Sight; 2]> + Clone + '_ {
    let rows = cloud.points_m.chunks(cloud.width).enumerate();
    rows.flat_map(|(v, row)| row.iter().enumerate().map(move |(u, &point)| (u, v, point)))
        .filter(|&(.., point)| is_valid(point))
        .map(|(u, v, point)| {
            let [x, y, z] = point.map(f64::from);
            [(u as f64, x / z), (v as f64, y / z)]
        })
}

/// Means of the sights along one axis, and second moments about them.
#[derive(Clone, Copy, Default)]
struct Axis {
    mean_pixel: f64,
    mean_slope: f64,
    pixel_pixel: f64,
    slope_slope: f64,
    slope_pixel: f64,
}

impl Axis {
    fn add_to_mean(&mut self, (pixel, slope): Sight) {
        self.mean_pixel += pixel;
        self.mean_slope += slope;
    }

    fn finish_mean(&mut self, points: usize) {
        self.mean_pixel /= points as f64;
        self.mean_slope /= points as f64;
    }

    fn add_moments(&mut self, (pixel, slope): Sight) {
        let (pixel, slope) = (pixel - self.mean_pixel, slope - self.mean_slope);
        self.pixel_pixel += pixel * pixel;
        self.slope_slope += slope * slope;
        self.slope_pixel += slope * pixel;
    }

    /// The focal length, `None` when all points stand in one line of pixels.
    fn focal_px(&self) -> Result<Option<f64>> {
        if self.pixel_pixel == 0.0 {
            return Ok(None);
        }
        let focal_px = self.slope_pixel / self.slope_slope;
        if focal_px.is_finite() && focal_px > 0.0 { Ok(Some(focal_px)) } else { Err(Error::NotPinhole) }
    }

    fn principal_px(&self, focal_px: f64) -> f64 {
        self.mean_pixel - focal_px * self.mean_slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(camera: Camera, width: usize, height: usize, z_m: impl Fn(usize, usize) -> f32) -> PointCloud {
        let points_m = (0..width * height)
            .map(|i| camera.back_project(i % width, i / width, z_m(i % width, i / width)))
            .collect();
        PointCloud { width, height, points_m, color: None, label: None, viewpoint: None }
    }

    fn kinect() -> Camera {
        Camera::new(525.0, 520.0, 31.5, 20.25).unwrap()
    }

    fn assert_projects_exactly(fit: &CameraFit, cloud: &PointCloud) {
        for (i, &point) in cloud.points_m.iter().enumerate().filter(|(_, p)| is_valid(**p)) {
            let (u, v) = fit.camera.project(point);
            let (du, dv) = (u - (i % cloud.width) as f64, v - (i / cloud.width) as f64);
            assert!(du.abs() < 1e-4 && dv.abs() < 1e-4, "{fit:?}");
        }
    }

    proptest::proptest! {
        #[test]
        fn the_camera_is_recovered(
            fx in 20.0..2000.0, fy in 20.0..2000.0, cx in -50.0..90.0, cy in -50.0..90.0,
            z in 0.2_f32..8.0, slant in -0.01_f32..0.01, hole in 0_usize..600,
        ) {
            let camera = Camera::new(fx, fy, cx, cy).unwrap();
            let mut cloud = seen(camera, 30, 20, |u, v| z * (1.0 + slant * (u as f32 - v as f32)));
            cloud.points_m[hole] = [f32::NAN; 3];
            let fit = fit_camera(&cloud).unwrap();
            proptest::prop_assert!((fit.camera.fx_px / fx - 1.0).abs() < 1e-5, "{fit:?}");
            proptest::prop_assert!((fit.camera.fy_px / fy - 1.0).abs() < 1e-5, "{fit:?}");
            proptest::prop_assert!((fit.camera.cx_px - cx).abs() < 2e-3, "{fit:?}");
            proptest::prop_assert!((fit.camera.cy_px - cy).abs() < 2e-3, "{fit:?}");
            proptest::prop_assert!(fit.residual_px < 1e-3);
            proptest::prop_assert_eq!(fit.points, 599);
        }
    }

    #[test]
    fn one_column_or_row_takes_the_focal_length_of_the_other_axis() {
        let only = |keep: fn(usize, usize) -> bool| {
            seen(kinect(), 40, 30, move |u, v| if keep(u, v) { 1.0 } else { f32::NAN })
        };
        for (cloud, focal_px) in [
            (only(|u, _| u == 7), 520.0),
            (only(|_, v| v == 11), 525.0),
            (seen(kinect(), 1, 30, |_, v| 1.0 + v as f32), 520.0),
        ] {
            let fit = fit_camera(&cloud).unwrap();
            assert!((fit.camera.fx_px - focal_px).abs() < 0.01, "{fit:?}");
            assert_eq!(fit.camera.fx_px, fit.camera.fy_px);
            assert_projects_exactly(&fit, &cloud);
        }
    }

    #[test]
    fn one_pixel_takes_the_nominal_focal_length() {
        let one_of_many = seen(kinect(), 40, 30, |u, v| if (u, v) == (3, 4) { 0.8 } else { 0.0 });
        let alone = PointCloud {
            width: 1,
            height: 1,
            points_m: vec![[0.3, -0.2, 1.5]],
            color: None,
            label: None,
            viewpoint: None,
        };
        for (cloud, focal_px) in [(one_of_many, 40.0 * 525.0 / 640.0), (alone, 525.0 / 640.0)] {
            let fit = fit_camera(&cloud).unwrap();
            assert_eq!((fit.camera.fx_px, fit.camera.fy_px, fit.points), (focal_px, focal_px, 1));
            assert_projects_exactly(&fit, &cloud);
        }
    }

    #[test]
    fn other_axes_are_refused() {
        let mirrored = |turn: fn([f32; 3]) -> [f32; 3]| {
            let mut cloud = seen(kinect(), 40, 30, |_, _| 1.0);
            cloud.points_m.iter_mut().for_each(|point| *point = turn(*point));
            fit_camera(&cloud).unwrap_err()
        };
        assert!(matches!(mirrored(|[x, y, z]| [-x, y, z]), Error::NotPinhole));
        assert!(matches!(mirrored(|[x, y, z]| [x, -y, z]), Error::NotPinhole));
        assert!(matches!(mirrored(|[_, y, z]| [0.0, y, z]), Error::NotPinhole));
    }

    /// It was told that `fx 0.000..` is no camera, though it had given none.
    #[test]
    fn a_point_far_beside_makes_no_camera() {
        let mut cloud = seen(kinect(), 40, 30, |_, _| 1.0);
        cloud.points_m[40 * 30 - 1] = [1e20, 1e20, 1e-10];
        let error = fit_camera(&cloud).unwrap_err();
        assert!(matches!(error, Error::NotPinhole), "{error}");
    }

    #[test]
    fn points_that_no_pinhole_sees_are_refused() {
        let mut cloud = seen(kinect(), 40, 30, |_, _| 1.0);
        for (i, point) in cloud.points_m.iter_mut().enumerate() {
            point[0] += (i % 7) as f32 * 0.001;
        }
        let error = fit_camera(&cloud).unwrap_err();
        assert!(matches!(error, Error::CameraResidual { residual_px } if residual_px > 0.9), "{error}");
    }
}
