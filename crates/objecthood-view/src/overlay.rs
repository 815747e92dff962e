//! The frame with what was found drawn over it.

use image::{Rgb, RgbImage};
use objecthood::{Frame, Raster};

use crate::labels;
use crate::objects::Objects;
use crate::tiles::percentiles;
use crate::view::NOTHING;

/// Greys of the farthest and the nearest depth: neither black, which is no depth, nor white.
const FAR_GREY: f32 = 50.0;
const NEAR_GREY: f32 = 230.0;

/// The colour image with the outline and the number of every object of `labels` (0 = none), pixel for pixel. A frame
/// without colour shows its depth in grey: what is near is bright, and black has no depth.
///
/// `labels` has the size of the frame. An object has the same colour as in [`panels`](crate::panels()). O(pixels).
pub fn overlay(frame: &Frame, labels: &Raster<u16>) -> RgbImage {
    let (width, height) = frame.size();
    let shades = frame.color().is_none().then(|| shades(frame.depth_m()));
    let objects = Objects::new(labels.clone());
    let line_px = (width.max(height) / 320).max(1) as u32;
    let mut image = RgbImage::from_fn(width as u32, height as u32, |x, y| {
        let (u, v) = (x as usize, y as usize);
        let scenery = shades.as_ref().or(frame.color()).and_then(|pixels| pixels.get(u, v));
        objects.outline(u, v, line_px).unwrap_or_else(|| scenery.map_or(NOTHING, |rgb| Rgb(*rgb)))
    });
    labels::write(&mut image, objects.numbers());
    image
}

/// Depth as grey, from the second to the 98th percentile: one far pixel does not darken the rest.
fn shades(depth_m: &Raster<f32>) -> Raster<[u8; 3]> {
    let mut valid_m: Vec<f32> = depth_m.as_slice().iter().copied().filter(|z| !z.is_nan()).collect();
    valid_m.sort_unstable_by(f32::total_cmp);
    let (near_m, far_m) = percentiles(&valid_m).unwrap_or((0.0, 0.0));
    depth_m.map(|&z| {
        let nearness = if far_m > near_m { ((far_m - z) / (far_m - near_m)).clamp(0.0, 1.0) } else { 0.5 };
        let grey = if z.is_nan() { 0.0 } else { FAR_GREY + (NEAR_GREY - FAR_GREY) * nearness };
        [grey as u8; 3]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::palette::object_color;
    use crate::testing;

    /// 320 x 240 pixels with object 1 on columns 40 to 119 and object 2 on columns 200 to 279, without the rows at the rim.
    fn two_objects() -> Raster<u16> {
        testing::raster(320, 240, |i| match (i % 320, i / 320) {
            (_, 0..20 | 220..) => 0,
            (40..120, _) => 1,
            (200..280, _) => 2,
            _ => 0,
        })
    }

    /// Label images look black in every viewer, so there has to be one that does not.
    #[test]
    fn objects_are_outlined_and_numbered_on_the_colour_image() {
        let color = testing::raster(320, 240, |i| [(i % 320 / 2) as u8, 100, 200]);
        let frame = testing::frame(testing::raster(320, 240, |_| 1.0), Some(color.clone()));
        let picture = overlay(&frame, &two_objects());
        assert_eq!(picture.dimensions(), (320, 240), "pixel for pixel");
        let at = |u: u32, v: u32| *picture.get_pixel(u, v);
        assert_eq!((at(40, 100), at(279, 50)), (object_color(1), object_color(2)), "outlines");
        assert_eq!((at(41, 100), at(278, 50)), (NOTHING, NOTHING), "set off inside");
        let is_as_it_was = |u: u32, v: u32| at(u, v).0 == color[(v * 320 + u) as usize];
        assert!(is_as_it_was(50, 40) && is_as_it_was(10, 10) && is_as_it_was(160, 120));
        let number = (60..100).flat_map(|u| (100..140).map(move |v| (u, v)));
        assert!(number.filter(|&(u, v)| !is_as_it_was(u, v)).count() > 50, "a number in the middle");
    }

    #[test]
    fn without_colour_near_is_bright_and_no_depth_is_black() {
        let depth_m =
            testing::raster(
                320,
                240,
                |i| if i % 320 < 5 { f32::NAN } else { 1.0 + (i % 320) as f32 / 100.0 },
            );
        let picture = overlay(&testing::frame(depth_m, None), &testing::raster(320, 240, |_| 0));
        let grey = |u: u32| picture.get_pixel(u, 9).0[0];
        assert_eq!((grey(0), grey(6), grey(318)), (0, 230, 50));
        assert!(grey(100) > grey(200));
    }

    #[test]
    fn frames_of_any_size_and_depth_have_an_overlay() {
        for (width, height) in [(1, 1), (3, 1), (1, 200), (1300, 7)] {
            for z in [1e-30, 0.5, 1e13] {
                let depth_m = testing::raster(width, height, |i| if i % 3 == 1 { f32::NAN } else { z });
                let frame = testing::frame(depth_m, None);
                let picture = overlay(&frame, &testing::raster(width, height, |i| (i % 3) as u16));
                assert_eq!(picture.dimensions(), (width as u32, height as u32));
            }
        }
    }
}
