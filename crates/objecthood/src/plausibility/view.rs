//! Checks the camera against the size of the image.

use super::doubt::Doubt;
use crate::camera::Camera;

/// Angles that depth cameras see (degrees).
const SEEN_DEG: std::ops::RangeInclusive<f64> = 8.0..=140.0;

/// A principal point may be away from the middle by this share of the image.
const OFF_CENTER: f64 = 0.2;

/// A principal point is in the middle if it is away by less than this share.
const CENTERED: f64 = 0.06;

/// Exchanged, its coordinates have to be nearer to the middle by this factor.
const NEARER_EXCHANGED: f64 = 2.0;

/// Focal lengths differ by this factor at most.
const FOCAL_RATIO: f64 = 1.3;

/// Images with a shorter side than this (px) are not judged.
const SMALLEST_PX: f64 = 48.0;

/// Below this focal length (px) the numbers are not in pixels.
const SHORTEST_PX: f64 = 30.0;

/// Both coordinates of the center imply the size of an image. They agree when they differ by less than this share.
const ONE_SIZE: f64 = 0.1;

/// What is implausible about a camera whose image has this size.
pub(super) fn doubt(camera: Camera, (width, height): (usize, usize)) -> Option<Doubt> {
    let Camera { fx_px, fy_px, cx_px, cy_px } = camera;
    let (w, h) = (width as f64, height as f64);
    if w.min(h) < SMALLEST_PX {
        return None;
    }
    let middle_px = [(w - 1.0) / 2.0, (h - 1.0) / 2.0];
    let off = |cx: f64, cy: f64| ((cx - middle_px[0]) / w).abs().max(((cy - middle_px[1]) / h).abs());
    if fx_px.max(fy_px) < SHORTEST_PX {
        return Some(not_in_pixels(camera, [w, h], middle_px));
    }
    let given = off(cx_px, cy_px);
    let exchanged = off(cy_px, cx_px);
    if given > CENTERED && exchanged < CENTERED && given > NEARER_EXCHANGED * exchanged {
        return Some(Doubt::CenterSwapped { center_px: [cx_px, cy_px] });
    }
    if given > OFF_CENTER {
        return Some(
            other_size(camera, [w, h]).unwrap_or(Doubt::CenterOff { center_px: [cx_px, cy_px], middle_px }),
        );
    }
    let degrees = [angle_deg(w, fx_px), angle_deg(h, fy_px)];
    if !degrees.iter().all(|angle| SEEN_DEG.contains(angle)) {
        return Some(Doubt::FieldOfView { degrees });
    }
    let ratio = (fx_px / fy_px).max(fy_px / fx_px);
    (ratio > FOCAL_RATIO).then_some(Doubt::FocalLengths { focal_px: [fx_px, fy_px] })
}

/// The angle that so many pixels see at this focal length (degrees).
fn angle_deg(extent_px: f64, focal_px: f64) -> f64 {
    2.0 * libm::atan(extent_px / (2.0 * focal_px)).to_degrees()
}

/// What the intrinsics are if they are too short for pixels.
fn not_in_pixels(camera: Camera, [w, h]: [f64; 2], [u, v]: [f64; 2]) -> Doubt {
    let Camera { fx_px, fy_px, cx_px, cy_px } = camera;
    if [cx_px, cy_px].iter().all(|c| (c - 0.5).abs() < OFF_CENTER) {
        let likely = Camera { fx_px: fx_px * w, fy_px: fy_px * h, cx_px: cx_px * w, cy_px: cy_px * h };
        return Doubt::CameraNormalized { likely };
    }
    // A principal point that is a length gives the size of a pixel. One that is 0, or in pixels, does not.
    let pixels = u / cx_px;
    let likely = Camera { fx_px: fx_px * pixels, fy_px: fy_px * pixels, cx_px: u, cy_px: v };
    let is_camera = cx_px > 0.0 && SEEN_DEG.contains(&angle_deg(w, likely.fx_px));
    let likely = is_camera.then_some(likely);
    Doubt::CameraNotInPixels { focal: [fx_px, fy_px], likely }
}

/// The camera of an image of another size, if both coordinates of its principal point imply the same one.
fn other_size(camera: Camera, [w, h]: [f64; 2]) -> Option<Doubt> {
    let Camera { fx_px, fy_px, cx_px, cy_px } = camera;
    let [times, by_row] = [2.0 * cx_px / w, 2.0 * cy_px / h];
    let is_one = cx_px > 1.0 && cy_px > 1.0 && (times - by_row).abs() < ONE_SIZE * times;
    let likely =
        Camera { fx_px: fx_px / times, fy_px: fy_px / times, cx_px: cx_px / times, cy_px: cy_px / times };
    (is_one && SEEN_DEG.contains(&angle_deg(w, likely.fx_px)))
        .then_some(Doubt::CameraOfOtherSize { times, likely })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(camera: [f64; 4]) -> String {
        let [fx, fy, cx, cy] = camera;
        let doubt = doubt(Camera::new(fx, fy, cx, cy).unwrap(), (640, 480));
        doubt.map(|doubt| doubt.to_string()).unwrap_or_default()
    }

    #[test]
    fn cameras_of_sensors_are_plausible() {
        for camera in [
            [525.0, 525.0, 319.5, 239.5],
            [612.9, 613.2, 322.5, 248.2],
            [1066.8, 1067.5, 313.0, 241.3],
            [517.3, 516.5, 318.6, 255.3],
            [385.0, 385.0, 320.0, 240.0],
            [250.0, 250.0, 330.0, 200.0],
        ] {
            assert_eq!(told(camera), "");
        }
        assert_eq!(doubt(Camera::new(4.0, 4.0, 1.5, 1.0).unwrap(), (4, 3)), None);
    }

    #[test]
    fn the_cause_is_named_with_the_likely_camera() {
        for (camera, said) in [
            (
                [0.82, 1.09, 0.499, 0.498],
                "shares of the image, not in pixels: in pixels it is 524.8,523.2,319.4,239.0",
            ),
            ([1.88, 1.88, 1.15, 0.86], "millimetres: in pixels the camera is about 522.3,522.3,319.5,239.5"),
            (
                [1.88, 1.88, 0.0, 0.0],
                "focal lengths of 1.88 and 1.88 px are too short, they may be in millimetres: divide them",
            ),
            ([3.6, 3.6, 319.5, 239.5], "millimetres: divide them by the width of a pixel on the sensor"),
            (
                [262.5, 262.5, 159.5, 119.5],
                "of 0.5 times this size: for this one it is about 526.6,526.6,320.0,239.7",
            ),
            ([1050.0, 1050.0, 639.5, 479.5], "of 2.0 times this size"),
            ([525.0, 525.0, 239.5, 319.5], "turned on its side"),
            (
                [525.0, 525.0, 0.0, 0.0],
                "far from the middle of the image, near which cameras have it: is (319.5, 239.5) meant, or is the image cut out",
            ),
            ([525.0, 525.0, 99999.0, 239.5], "far from the middle"),
            ([319.5, 239.5, 525.0, 525.0], "far from the middle"),
            ([52500.0, 52500.0, 319.5, 239.5], "1 x 1 degrees"),
            ([52.5, 52.5, 319.5, 239.5], "161 x 155 degrees"),
            ([525.0, 319.5, 319.5, 239.5], "pixels are square"),
        ] {
            let told = told(camera);
            assert!(told.contains(said), "{camera:?}: {told}");
        }
    }
}
