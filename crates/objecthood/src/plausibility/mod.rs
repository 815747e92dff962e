//! What cannot be right in a frame: a camera of another image, depth in another unit, images that do not
//! belong together.
//!
//! The numbers of a frame show much of their origin: the principal point lies near the middle of the image;
//! depth cameras reach some metres; their noise grows with the square of depth; planes are affine in inverse
//! depth; where depth jumps, colour often changes. A frame that contradicts one of these is processed as it
//! is, with a [`Doubt`].
//!
//! Only a grid of pixels is examined, so the cost is 1 to 2 % of that of a method. Source: ours; the limits
//! leave a margin around all frames at hand (docs/INPUTS.md says how that was measured).

mod alignment;
mod doubt;
mod sample;
mod steps;
mod unit;
mod values;
mod view;

pub use doubt::{Doubt, Mirrored};

use self::sample::Sample;
use crate::camera::Camera;
use crate::frame::Frame;
use crate::raster::Raster;

/// Neighbouring pixels tell something about the sensor from this focal length on (px). At a shorter one, such
/// as that of a virtual camera that looks at few points, they lie so far apart that the things themselves
/// look like noise.
const LEAST_FOCAL_PX: f64 = 120.0;

/// Finds what is implausible about a frame. Doubts about the camera come first. Of several doubts about depth
/// only the first is reported, because the others may follow from it.
///
/// O(n) for n pixels, of which a few thousand are examined.
///
/// ```
/// use objecthood::plausibility::{Doubt, find_doubts};
/// use objecthood::{Camera, Frame, Raster};
///
/// let far = Raster::filled(64, 48, 900.0)?; // millimetres that were taken for metres
/// let frame = Frame::new(far, None, Camera::new(52.5, 52.5, 31.5, 23.5)?)?;
/// assert!(matches!(find_doubts(&frame)[..], [Doubt::TooFar { times, .. }] if times == 1000.0));
/// # Ok::<(), objecthood::Error>(())
/// ```
pub fn find_doubts(frame: &Frame) -> Vec<Doubt> {
    let Camera { fx_px, fy_px, .. } = frame.camera();
    let sample = &Sample::of(frame.depth_m(), fx_px.min(fy_px) >= LEAST_FOCAL_PX);
    let depth = sample.is_enough().then(|| depth_doubt(frame.depth_m(), sample)).flatten();
    let color = frame.color().and_then(|color| alignment::doubt(frame.depth_m(), color));
    view::doubt(frame.camera(), frame.size()).into_iter().chain(depth).chain(color).collect()
}

/// The first doubt about depth: first whether the numbers are depth at all, then their unit.
fn depth_doubt(depth_m: &Raster<f32>, sample: &Sample) -> Option<Doubt> {
    values::doubt(depth_m, sample)
        .or_else(|| values::disparity_doubt(depth_m, sample))
        .or_else(|| unit::doubt(depth_m, sample))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Lcg;

    const SIZE: [usize; 2] = [320, 240];

    /// A table that ends at a wall, with two boxes in the left half, seen by a sensor with steps of disparity of 0.0029 1/m.
    fn depth_m(u: usize, v: usize) -> f32 {
        let [x, y] = [(u as f64 - 159.5) / 262.5, (v as f64 - 119.5) / 262.5];
        let box_front = |from: f64, to: f64| (from..to).contains(&x) && (0.0..0.15).contains(&y);
        let inverse = if box_front(-0.4, -0.2) {
            1.2
        } else if box_front(-0.1, 0.05) {
            1.35
        } else {
            (0.55 + 1.6 * (y + 0.2) + 0.1 * x).max(0.4)
        };
        (1.0 / ((inverse / 0.0029).round() * 0.0029)) as f32
    }

    fn color(u: usize, v: usize) -> [u8; 3] {
        if (depth_m(u, v) - 1.0 / 1.2).abs() < 0.01 || (depth_m(u, v) - 1.0 / 1.35).abs() < 0.01 {
            [200, 40, 40]
        } else {
            [90; 3]
        }
    }

    /// The frame with changed depth, and its colour seen from another place.
    fn doubts(change: impl Fn(f32) -> f32, color_at: impl Fn(usize, usize) -> [usize; 2]) -> Vec<Doubt> {
        let [width, height] = SIZE;
        let pixels = || (0..width * height).map(|i| [i % width, i / width]);
        let depths = pixels().map(|[u, v]| change(depth_m(u, v))).collect();
        let colors = pixels().map(|[u, v]| color_at(u, v)).map(|[u, v]| color(u, v)).collect();
        let camera = Camera::new(262.5, 262.5, 159.5, 119.5).unwrap();
        let depths = Raster::from_vec(width, height, depths).unwrap();
        let colors = Raster::from_vec(width, height, colors).unwrap();
        find_doubts(&Frame::new(depths, Some(colors), camera).unwrap())
    }

    fn in_place(u: usize, v: usize) -> [usize; 2] {
        [u, v]
    }

    #[test]
    fn nothing_is_doubted_in_a_plain_frame() {
        assert_eq!(doubts(|z| z, in_place), []);
        assert_eq!(doubts(|z| (1000.0 * z).round() / 1000.0, in_place), []);
    }

    /// A table seen from this height (m), with noise of this deviation (mm), in these units a metre; 0 = none.
    fn seen_from_near(height_m: f64, noise_mm: f64, per_m: f64) -> Vec<Doubt> {
        let [width, height] = [640, 480];
        let mut random = Lcg::new(5);
        let depth = |i: usize| {
            let inverse = (1.0 + 1e-3 * ((i / width) as f64 - 240.0)) / height_m;
            // The sum of twelve even numbers is nearly normal.
            let normal = (0..12).map(|_| random.below(1000) as f64 / 1000.0).sum::<f64>() - 6.0;
            let z = 1.0 / inverse + 0.001 * noise_mm * normal;
            (if per_m > 0.0 { (z * per_m).round() / per_m } else { z }) as f32
        };
        let depths = Raster::from_vec(width, height, (0..width * height).map(depth).collect()).unwrap();
        find_doubts(&Frame::new(depths, None, Camera::new(525.0, 525.0, 319.5, 239.5).unwrap()).unwrap())
    }

    /// A regression: for a good sensor and a near scene, depth was reported as twice too small.
    #[test]
    fn a_near_sensor_may_have_steps_of_a_millimetre_and_noise() {
        assert_eq!(seen_from_near(0.33, 0.3, 1000.0), []);
        assert_eq!(seen_from_near(0.4, 0.7, 1000.0), []);
        assert_eq!(seen_from_near(0.4, 0.7, 0.0), []);
        assert!(matches!(seen_from_near(0.4, 2.0, 1000.0)[..], [Doubt::TooNear { .. }]));
    }

    /// A regression: without noise the floor below a camera was taken for the number that stands for no depth.
    #[test]
    fn a_floor_seen_straight_from_above_is_no_greatest_depth() {
        let seen = |floor_m: f32| {
            let is_box = |i: usize| (60..200).contains(&(i % 320)) && (50..150).contains(&(i / 320));
            let depths = (0..320 * 240).map(|i| if is_box(i) { 0.75 } else { floor_m }).collect();
            let camera = Camera::new(262.5, 262.5, 159.5, 119.5).unwrap();
            find_doubts(&Frame::new(Raster::from_vec(320, 240, depths).unwrap(), None, camera).unwrap())
        };
        assert_eq!(seen(1.0), []);
        assert!(matches!(seen(4.0)[..], [Doubt::DepthSaturated { .. }]));
    }

    #[test]
    fn other_units_are_doubted() {
        for times in [5.0, 10.0, 100.0, 1000.0] {
            let found = doubts(|z| z * times as f32, in_place);
            assert!(matches!(found[..], [Doubt::TooFar { times: told, .. }] if told == times), "{found:?}");
        }
        for times in [10.0, 100.0, 1000.0] {
            let found = doubts(|z| z / times as f32, in_place);
            assert!(matches!(found[..], [Doubt::TooNear { times: told, .. }] if told == times), "{found:?}");
        }
    }

    /// Few points, as a virtual camera sees them: neighbours are centimetres apart, and nothing is wrong with their unit.
    #[test]
    fn of_a_coarse_image_only_the_unit_is_doubted() {
        let [width, height] = [64, 48];
        let coarse = |times: f32| {
            let mut random = Lcg::new(3);
            let depths = (0..width * height).map(|i| {
                let across = random.below(10) as f32 / 50.0;
                times * (depth_m(5 * (i % width), 5 * (i / width)) + across)
            });
            let camera = Camera::new(52.5, 52.5, 31.5, 23.5).unwrap();
            find_doubts(
                &Frame::new(Raster::from_vec(width, height, depths.collect()).unwrap(), None, camera)
                    .unwrap(),
            )
        };
        assert_eq!(coarse(1.0), []);
        assert!(matches!(coarse(1000.0)[..], [Doubt::TooFar { times: 1000.0, .. }]), "{:?}", coarse(1000.0));
        assert!(matches!(coarse(0.001)[..], [Doubt::TooNear { times: 1000.0, .. }]), "{:?}", coarse(0.001));
    }

    /// Depth of a small image, enlarged by repeating its pixels.
    #[test]
    fn enlarged_depth_is_no_disparity() {
        let [width, height] = [640, 480];
        for block in [2, 3, 4, 5, 8, 10] {
            let at = |x: usize| (x / block * block) as f64 + 0.5 * (block - 1) as f64;
            // A floor that a camera looks down on, with a slope to the side.
            let depth = |i: usize| (1.0 / (0.55 + 1.5e-3 * at(i / width) + 4e-4 * at(i % width))) as f32;
            let depths = (0..width * height).map(depth).collect();
            let camera = Camera::new(525.0, 525.0, 319.5, 239.5).unwrap();
            let found = find_doubts(
                &Frame::new(Raster::from_vec(width, height, depths).unwrap(), None, camera).unwrap(),
            );
            assert_eq!(found, [], "{block}");
        }
    }

    #[test]
    fn other_numbers_are_doubted() {
        let found = doubts(|z| 0.7 / z, in_place);
        assert!(matches!(found[..], [Doubt::DisparityAsDepth { .. }]), "{found:?}");
        for per_m in [1000.0, 4000.0] {
            let found = doubts(|z| f32::from(((per_m * z) as u16).swap_bytes()) / per_m, in_place);
            assert!(matches!(found[0], Doubt::BytesSwapped { .. }), "{found:?}");
        }
        let found = doubts(|z| if z > 2.0 { 9.0 } else { z }, in_place);
        assert!(matches!(found[..], [Doubt::DepthSaturated { .. }]), "{found:?}");
        // Along a row, depth hardly changes in this scene.
        let found = doubts(|z| 1.0 + (1e5 * z).sin().abs(), in_place);
        assert!(matches!(found[0], Doubt::RowsScrambled { .. }), "{found:?}");
    }

    #[test]
    fn depth_without_order_is_doubted() {
        let mut random = Lcg::new(7);
        let depths = (0..320 * 240).map(|_| 0.5 + random.below(1000) as f32 / 500.0).collect();
        let camera = Camera::new(262.5, 262.5, 159.5, 119.5).unwrap();
        let found =
            find_doubts(&Frame::new(Raster::from_vec(320, 240, depths).unwrap(), None, camera).unwrap());
        assert!(matches!(found[0], Doubt::DepthScrambled { .. }), "{found:?}");
    }

    #[test]
    fn mirrored_colour_is_doubted() {
        let [width, height] = SIZE;
        for (color_at, mirrored) in [
            (&(|u, v| [width - 1 - u, v]) as &dyn Fn(usize, usize) -> [usize; 2], Mirrored::Sideways),
            (&|u, v| [u, height - 1 - v], Mirrored::UpsideDown),
            (&|u, v| [width - 1 - u, height - 1 - v], Mirrored::Turned),
        ] {
            assert_eq!(doubts(|z| z, color_at), [Doubt::ColorMirrored(mirrored)]);
        }
    }

    #[test]
    fn small_and_empty_images_are_taken_as_they_are() {
        for (width, height) in [(1, 1), (2, 1), (1, 7), (3, 3), (9, 2), (31, 40)] {
            let depth = Raster::from_vec(width, height, vec![1.0; width * height]).unwrap();
            let color = Raster::filled(width, height, [7; 3]).unwrap();
            let camera = Camera::new(30.0, 30.0, width as f64 / 2.0, height as f64 / 2.0).unwrap();
            find_doubts(&Frame::new(depth, Some(color), camera).unwrap());
        }
    }
}
