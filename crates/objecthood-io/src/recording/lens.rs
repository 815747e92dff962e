//! Cameras whose lenses bend straight lines.
//!
//! Sources: the models of OpenCV and `sensor_msgs/CameraInfo`: `plumb_bob` and `rational_polynomial` (Brown-Conrady), `equidistant`
//! (Kannala-Brandt).

use glam::{DVec2, DVec3};
use objecthood::Camera;

use super::messages::CameraInfo;
use crate::organize::GridCamera;

/// A camera as it took its images.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lens {
    pub(super) camera: Camera,
    /// Columns and rows, if they are known.
    pub(super) size: Option<(usize, usize)>,
    bend: Bend,
}

/// How a direction is bent on its way through a lens.
#[derive(Clone, Debug, PartialEq)]
enum Bend {
    None,
    /// k1, k2, p1, p2, k3, k4, k5, k6.
    Brown([f64; 8]),
    /// k1 to k4.
    Fisheye([f64; 4]),
}

impl Lens {
    /// The camera of a message; `is_rectified` when the images are already without distortion. `None` when it is not calibrated.
    ///
    /// # Errors
    /// The name of a model that is not known.
    pub(super) fn of(info: &CameraInfo, is_rectified: bool) -> Result<Option<Self>, String> {
        let [fx, _, cx, _, fy, cy, ..] = if is_rectified && info.p[0] > 0.0 {
            let p = info.p;
            [p[0], p[1], p[2], p[4], p[5], p[6], 0.0, 0.0, 1.0]
        } else {
            info.k
        };
        let (binning_x, binning_y) = (f64::from(info.binning.0.max(1)), f64::from(info.binning.1.max(1)));
        let (left, top) = (f64::from(info.offset.0), f64::from(info.offset.1));
        let is_whole = info.binning.0.max(info.binning.1) <= 1 && info.offset == (0, 0);
        let camera =
            Camera::new(fx / binning_x, fy / binning_y, (cx - left) / binning_x, (cy - top) / binning_y);
        let Ok(camera) = camera else { return Ok(None) };
        let size = Some(info.size).filter(|size| is_whole && size.0 > 0 && size.1 > 0);
        let bend = if is_rectified { Bend::None } else { Bend::of(info)? };
        Ok(Some(Self { camera, size, bend }))
    }

    /// A camera that is given: its images are rectified.
    pub(super) fn given(grid: GridCamera) -> Self {
        Self { camera: grid.camera, size: grid.size, bend: Bend::None }
    }

    pub(super) fn is_straight(&self) -> bool {
        self.bend == Bend::None
    }

    /// Where in its image the camera sees a point (px); `None` behind it.
    pub(super) fn project(&self, point_m: DVec3) -> Option<DVec2> {
        (point_m.z > 0.0).then(|| self.pixel(point_m.truncate() / point_m.z))
    }

    /// Where in its image the camera sees the direction (x, y, 1) (px).
    fn pixel(&self, direction: DVec2) -> DVec2 {
        let Camera { fx_px, fy_px, cx_px, cy_px, .. } = self.camera;
        self.bend.apply(direction) * DVec2::new(fx_px, fy_px) + DVec2::new(cx_px, cy_px)
    }

    /// How far it moves a pixel at the border of the image, at most (px); `None` without distortion.
    pub(super) fn distortion_px(&self, (width, height): (usize, usize)) -> Option<f64> {
        let rows = (0..width).flat_map(|u| [(u, 0), (u, height.saturating_sub(1))]);
        let columns = (0..height).flat_map(|v| [(0, v), (width.saturating_sub(1), v)]);
        let moved_px = |(u, v): (usize, usize)| {
            let at = DVec2::new(u as f64, v as f64);
            (self.pixel(self.direction(at)) - at).length()
        };
        (!self.is_straight()).then(|| rows.chain(columns).map(moved_px).fold(0.0, f64::max))
    }

    /// The direction (x, y, 1) that a pinhole sees at a place in the image (px).
    fn direction(&self, at: DVec2) -> DVec2 {
        let Camera { fx_px, fy_px, cx_px, cy_px, .. } = self.camera;
        (at - DVec2::new(cx_px, cy_px)) / DVec2::new(fx_px, fy_px)
    }

    /// For every pixel of the image without distortion the pixel of the image as it was taken, row by row; `None` where that
    /// ends. O(pixels).
    pub(super) fn straightened(&self, (width, height): (usize, usize)) -> Vec<Option<u32>> {
        let of = |i: usize| {
            let at = DVec2::new((i % width) as f64, (i / width) as f64);
            nearest(self.pixel(self.direction(at)), (width, height)).map(|pixel| pixel as u32)
        };
        (0..width * height).map(of).collect()
    }
}

/// The index of the pixel nearest to a place in an image; `None` outside.
pub(super) fn nearest(at: DVec2, (width, height): (usize, usize)) -> Option<usize> {
    let (u, v) = (at.x.round(), at.y.round());
    let is_inside = u >= 0.0 && v >= 0.0 && u < width as f64 && v < height as f64;
    is_inside.then(|| v as usize * width + u as usize)
}

impl Bend {
    fn of(info: &CameraInfo) -> Result<Self, String> {
        if info.d.iter().all(|&d| d == 0.0) {
            return Ok(Self::None);
        }
        let d = |k: usize| info.d.get(k).copied().unwrap_or(0.0);
        // The names of ROS, of RealSense's bags, and of Azure's driver.
        match &info.distortion_model.to_ascii_lowercase()[..] {
            b"plumb_bob" | b"rational_polynomial" | b"brown conrady" | b"brown_conrady" | b"" => {
                Ok(Self::Brown(std::array::from_fn(d)))
            }
            b"equidistant" | b"fisheye" | b"kannala brandt4" => Ok(Self::Fisheye(std::array::from_fn(d))),
            other => Err(crate::text::preview(other)),
        }
    }

    fn apply(&self, at: DVec2) -> DVec2 {
        let DVec2 { x, y } = at;
        let r2 = x * x + y * y;
        match *self {
            Self::None => at,
            Self::Brown([k1, k2, p1, p2, k3, k4, k5, k6]) => {
                let radial =
                    (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1.0 + r2 * (k4 + r2 * (k5 + r2 * k6)));
                let (xy, x2, y2) = (2.0 * x * y, r2 + 2.0 * x * x, r2 + 2.0 * y * y);
                at * radial + DVec2::new(p1 * xy + p2 * x2, p1 * y2 + p2 * xy)
            }
            Self::Fisheye([k1, k2, k3, k4]) => {
                let r = r2.sqrt();
                if r == 0.0 {
                    return at;
                }
                let angle = libm::atan(r);
                let a2 = angle * angle;
                at * (angle * (1.0 + a2 * (k1 + a2 * (k2 + a2 * (k3 + a2 * k4)))) / r)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::messages::Header;

    fn info(model: &str, d: &[f64]) -> CameraInfo {
        CameraInfo {
            header: Header { stamp_ns: 0, frame_id: Vec::new() },
            size: (640, 480),
            distortion_model: model.as_bytes().to_vec(),
            d: d.to_vec(),
            k: [500.0, 0.0, 320.0, 0.0, 510.0, 240.0, 0.0, 0.0, 1.0],
            p: [450.0, 0.0, 310.0, 0.0, 0.0, 460.0, 230.0, 0.0, 0.0, 0.0, 1.0, 0.0],
            binning: (0, 0),
            offset: (0, 0),
        }
    }

    /// What `cv2.projectPoints` and `cv2.fisheye.projectPoints` of OpenCV give, worked out from its documentation by hand.
    #[test]
    fn points_are_seen_where_opencv_sees_them() {
        let point = DVec3::new(0.4, -0.2, 1.0);
        let at = |lens: Lens| lens.project(point).unwrap();
        let plain = Lens::of(&info("", &[]), false).unwrap().unwrap();
        assert!(plain.is_straight());
        assert_eq!(at(plain), DVec2::new(520.0, 138.0));
        // r2 = 0.2; radial = 1 + 0.1 * 0.2 = 1.02.
        let k1 = Lens::of(&info("plumb_bob", &[0.1, 0.0, 0.0, 0.0, 0.0]), false).unwrap().unwrap();
        assert!((at(k1) - DVec2::new(320.0 + 204.0, 240.0 - 104.04)).length() < 1e-9);
        // x' = 0.4 + 2 p1 x y + p2 (r2 + 2 x2), y' = -0.2 + p1 (r2 + 2 y2) + 2 p2 x y.
        let p = Lens::of(&info("plumb_bob", &[0.0, 0.0, 0.01, 0.02, 0.0]), false).unwrap().unwrap();
        let expected = DVec2::new(0.4 - 0.0016 + 0.0104, -0.2 + 0.0028 - 0.0032);
        assert!((at(p) - (expected * DVec2::new(500.0, 510.0) + DVec2::new(320.0, 240.0))).length() < 1e-9);
        let fisheye = Lens::of(&info("equidistant", &[0.05, 0.0, 0.0, 0.0]), false).unwrap().unwrap();
        let r = 0.2_f64.sqrt();
        let angle = r.atan();
        let scale = angle * (1.0 + 0.05 * angle * angle) / r;
        assert!((at(fisheye) - DVec2::new(320.0 + 200.0 * scale, 240.0 - 102.0 * scale)).length() < 1e-9);
    }

    #[test]
    fn images_without_distortion_have_the_camera_of_rectified_ones() {
        let lens = Lens::of(&info("plumb_bob", &[0.1]), true).unwrap().unwrap();
        assert!(lens.is_straight());
        assert_eq!((lens.camera.fx_px, lens.camera.cy_px), (450.0, 230.0));
        assert_eq!(Lens::of(&info("spline", &[0.1]), false), Err("spline".to_owned()));
        let binned = CameraInfo { binning: (2, 2), offset: (100, 0), ..info("", &[]) };
        let lens = Lens::of(&binned, false).unwrap().unwrap();
        assert_eq!((lens.camera.fx_px, lens.camera.cx_px, lens.size), (250.0, 110.0, None));
        let none = CameraInfo { k: [0.0; 9], ..info("", &[]) };
        assert_eq!(Lens::of(&none, false), Ok(None));
    }

    #[test]
    fn a_straightened_image_takes_pixels_from_where_the_lens_put_them() {
        let lens = Lens::of(&info("plumb_bob", &[-0.2, 0.05]), false).unwrap().unwrap();
        let from = lens.straightened((640, 480));
        assert_eq!(from[240 * 640 + 320], Some(240 * 640 + 320), "the middle stays");
        let corner = from[0].unwrap() as usize;
        assert!(corner % 640 > 5 && corner / 640 > 5, "a barrel draws corners inwards: {corner}");
    }
}
