//! Colour and depth of one field of view in images of two sizes, as phones record them: 1920x1440 and 256x192 pixels.

use image::imageops::{FilterType, resize};
use image::{ImageBuffer, Rgb};
use objecthood::{Camera, Raster};

use super::error::ImageError;
use crate::error::Result;
use crate::organize::GridCamera;

/// What was done to a colour image that has another size than the depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resized {
    /// Columns and rows of the colour image as it was read.
    pub from: (usize, usize),
    /// Whether the camera is that of the colour image, and was scaled with it.
    pub with_camera: bool,
}

/// Two images show one field of view if the ratios of their sides differ by less than this share: a side of 250 px is rounded by half of it. RealSense's
/// colour of 1280x720 and depth of 848x480, which see differently, differ by 0.6 %.
const SAME_RATIO: f64 = 0.004;

/// Brings larger colour of the same field of view to the size of the depth. `None` for colour that has this size or fewer pixels, or another field of
/// view.
///
/// A pixel gets the mean of the colours that it covers, weighted towards its middle. O(pixels of both).
pub(super) fn resized(
    color: &Raster<[u8; 3]>,
    (width, height): (usize, usize),
) -> Option<Result<Raster<[u8; 3]>>> {
    let from = color.size();
    if from.0 <= width || !is_one_view(from, (width, height)) {
        return None;
    }
    let samples = color.as_slice().as_flattened();
    let image = ImageBuffer::<Rgb<u8>, _>::from_raw(from.0 as u32, from.1 as u32, samples)?;
    let small = resize(&image, width as u32, height as u32, FilterType::Triangle);
    let colors = small.pixels().map(|pixel| pixel.0).collect();
    Some(Raster::from_vec(width, height, colors).map_err(Into::into))
}

/// Whether the sides of two images have one ratio.
fn is_one_view(a: (usize, usize), b: (usize, usize)) -> bool {
    let ratio = (a.0 * b.1) as f64 / (a.1 * b.0) as f64;
    (ratio - 1.0).abs() < SAME_RATIO
}

/// The camera of the depth image, of this `size`, and whether it was scaled because it is that of the colour image, of the size `color`.
/// Without a size it is that of the image whose middle is nearer to the principal point.
///
/// # Errors
/// [`ImageError::CameraSize`] when it is that of neither.
pub(super) fn camera_of_depth(
    given: GridCamera,
    size: (usize, usize),
    color: Option<(usize, usize)>,
) -> Result<(Camera, bool), ImageError> {
    let of_color = match (given.size, color) {
        (None, Some(color)) => off_middle(given.camera, color) < off_middle(given.camera, size),
        (Some(of_camera), _) if of_camera == size => false,
        (Some(of_camera), Some(color)) if of_camera == color => true,
        (Some(of_camera), _) => return Err(ImageError::CameraSize { given: of_camera, image: size }),
        (None, None) => false,
    };
    let scaled = color.filter(|_| of_color).map(|color| scaled(given.camera, color, size));
    Ok((scaled.unwrap_or(given.camera), of_color))
}

/// How far a principal point is from the middle of an image, in shares of its sides.
fn off_middle(camera: Camera, (width, height): (usize, usize)) -> f64 {
    let off = |middle: f64, side: usize| (middle / side as f64 - 0.5).abs();
    off(camera.cx_px, width).max(off(camera.cy_px, height))
}

/// The camera of an image that was resized. Pixels are counted from 0 at their centres.
fn scaled(camera: Camera, from: (usize, usize), to: (usize, usize)) -> Camera {
    let (sx, sy) = (to.0 as f64 / from.0 as f64, to.1 as f64 / from.1 as f64);
    Camera {
        fx_px: camera.fx_px * sx,
        fy_px: camera.fy_px * sy,
        cx_px: (camera.cx_px + 0.5) * sx - 0.5,
        cy_px: (camera.cy_px + 0.5) * sy - 0.5,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_gets_the_colours_that_it_covers() {
        // 8x8 pixels of red on the left and blue on the right become 2x2.
        let halves =
            (0..64).map(|i| if i % 8 < 4 { [200, 0, 0] } else { [0, 0, 200] }).collect::<Vec<[u8; 3]>>();
        let color = Raster::from_vec(8, 8, halves).unwrap();
        let small = resized(&color, (2, 2)).unwrap().unwrap();
        for row in small.as_slice().chunks(2) {
            assert!(row[0][0] > 150 && row[0][2] < 50 && row[1][2] > 150 && row[1][0] < 50, "{row:?}");
        }
        assert!([(8, 8), (16, 16), (4, 3)].iter().all(|&size| resized(&color, size).is_none()));
    }

    #[test]
    fn one_view_is_one_ratio_of_sides() {
        assert!(is_one_view((1920, 1440), (256, 192)) && is_one_view((1280, 720), (424, 239)));
        // A RealSense: colour and depth of other fields of view.
        assert!(!is_one_view((1280, 720), (848, 480)) && !is_one_view((1280, 1024), (640, 480)));
    }

    #[test]
    fn a_camera_of_the_colour_image_is_scaled() {
        let phone = Camera::new(1500.0, 1500.0, 959.5, 719.5).unwrap();
        let small = Camera::new(200.0, 200.0, 127.5, 95.5).unwrap();
        let of = |camera, size, color| camera_of_depth(GridCamera { camera, size }, (256, 192), color);
        let (depth, color) = (Some((256, 192)), Some((1920, 1440)));
        let scaled = of(phone, color, color).unwrap();
        assert_eq!(scaled, (small, true));
        assert_eq!(of(phone, None, color).unwrap(), (small, true));
        assert_eq!(of(small, None, color).unwrap(), (small, false));
        assert_eq!(of(small, depth, color).unwrap(), (small, false));
        assert_eq!(of(phone, None, None).unwrap(), (phone, false));
        assert!(matches!(of(phone, color, None), Err(ImageError::CameraSize { image: (256, 192), .. })));
    }
}
