//! One picture of a whole frame.

use image::codecs::png::PngEncoder;
use image::{ImageResult, Rgb, RgbImage, imageops};
use objecthood::{Discovery, Frame};

use crate::recording::Recording;
use crate::text::Text;
use crate::tiles::{self, Scale, Tile};
use crate::view::View;

const COLUMNS: usize = 4;
/// Room for a title and a scale [px], however narrow the frame.
const MIN_TILE_WIDTH_PX: u32 = 320;
const PAGE: Rgb<u8> = Rgb([255; 3]);
const INK: Rgb<u8> = Rgb([30; 3]);

/// Draws every stage of a frame: colour, depth, normals, superpixels; facets, shapes, objectness, objects.
///
/// `recording` and `discovery` are what [`objecthood::discover_observed`] gave for `frame`. Black is where there is
/// no depth, no label, or where a stage was not recorded. Frames up to 960 px keep their pixels (small ones are
/// enlarged by a whole number), larger ones are shrunk: the picture is at most 4000 px wide. The same input gives the
/// same picture, byte for byte.
pub fn panels(frame: &Frame, recording: &Recording, discovery: &Discovery) -> RgbImage {
    let view = View::new(frame, recording, discovery);
    compose(&[
        tiles::color(&view),
        tiles::depth(&view),
        tiles::normals(&view),
        tiles::superpixels(&view),
        tiles::facets(&view),
        tiles::shapes(&view),
        tiles::objectness(&view),
        tiles::objects(&view),
    ])
}

/// Sets the tiles side by side on a white page, each under its title.
fn compose(tiles: &[Tile]) -> RgbImage {
    let widest = tiles.iter().map(|t| t.image.width()).max().unwrap_or(0).max(MIN_TILE_WIDTH_PX);
    let highest = tiles.iter().map(|t| t.image.height()).max().unwrap_or(0);
    let letters_px = (widest / 28).clamp(15, 30);
    let (gap, header) = (letters_px, letters_px * 2);
    let rows = tiles.len().div_ceil(COLUMNS) as u32;

    let width = COLUMNS as u32 * (widest + gap) + gap;
    let height = rows * (header + highest) + gap;
    let mut page = RgbImage::from_pixel(width, height, PAGE);
    for (k, tile) in tiles.iter().enumerate() {
        let left = gap + (k % COLUMNS) as u32 * (widest + gap);
        let top = (k / COLUMNS) as u32 * (header + highest);
        let baseline = i64::from(top + header - letters_px / 2);
        let title = Text::new(&tile.title, letters_px as f32);
        title.draw(&mut page, (i64::from(left), baseline - title.ascent), INK);
        if let Some(scale) = &tile.scale {
            draw_scale(&mut page, scale, (left + widest, baseline), widest / 4, letters_px);
        }
        imageops::replace(&mut page, &tile.image, i64::from(left), i64::from(top + header));
    }
    page
}

/// A bar of colours between its two numbers, ending at (right, baseline).
fn draw_scale(
    page: &mut RgbImage,
    scale: &Scale,
    (right, baseline): (u32, i64),
    bar_px: u32,
    letters_px: u32,
) {
    let space = i64::from(letters_px / 3);
    let high = Text::new(&scale.high, letters_px as f32);
    let high_left = i64::from(right) - high.width;
    high.draw(page, (high_left, baseline - high.ascent), INK);

    let bar_left = high_left - space - i64::from(bar_px);
    let bar =
        RgbImage::from_fn(bar_px, letters_px * 3 / 4, |x, _| (scale.color)(x as f32 / (bar_px - 1) as f32));
    imageops::replace(page, &bar, bar_left, baseline - i64::from(bar.height()));

    let low = Text::new(&scale.low, letters_px as f32);
    low.draw(page, (bar_left - space - low.width, baseline - low.ascent), INK);
}

/// The bytes of a PNG file that holds `picture`.
///
/// # Errors
/// [`image::ImageError`] when `picture` has no pixels, which those of [`panels`] have.
pub fn png(picture: &RgbImage) -> ImageResult<Vec<u8>> {
    let mut bytes = Vec::new();
    picture.write_with_encoder(PngEncoder::new(&mut bytes))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use objecthood::{Observer, Raster, Stage};

    use super::*;
    use crate::palette::object_color;
    use crate::testing;

    /// Depth with holes, a few regions, and as many objects as asked for side by side.
    fn scene(width: usize, height: usize, objects: usize, color: bool) -> (Frame, Recording, Discovery) {
        let hole = |i: usize| i % 11 == 5 && width * height > 11;
        let depth_m = testing::raster(width, height, |i| if hole(i) { f32::NAN } else { 1.0 + i as f32 });
        let color = color.then(|| testing::raster(width, height, |i| [i as u8, (i / 7) as u8, 90]));
        let pixels = width * height;
        let label = |i: usize| if hole(i) { 0 } else { (i * (objects + 1) / pixels) as u16 };
        let regions = testing::segments(width, height, |i| (i % 97 / 3) as i32 - 1);
        let mut recording = Recording::default();
        recording.observe(Stage::Normals(&testing::raster(width, height, |_| [0.6, 0.0, -0.8])));
        recording.observe(Stage::Superpixels(&regions));
        recording.observe(Stage::Facets(&regions));
        recording.observe(Stage::Shapes(&regions));
        let discovery = testing::discovery(testing::raster(width, height, label));
        (testing::frame(depth_m, color), recording, discovery)
    }

    #[test]
    fn frames_of_any_size_give_a_picture_of_reasonable_size() {
        let sizes =
            [(1, 1), (2, 1), (3, 5), (101, 67), (640, 480), (1281, 721), (1, 3000), (3000, 1), (8192, 33)];
        for (width, height) in sizes {
            for (objects, color) in [(0, false), (0, true), (3, true), (1500, true), (1500, false)] {
                let (frame, recording, discovery) = scene(width, height, objects, color);
                let picture = panels(&frame, &recording, &discovery);
                let (w, h) = picture.dimensions();
                assert!((1280..=4000).contains(&w) && (60..=2200).contains(&h), "{width}x{height}: {w}x{h}");
                assert!(picture.pixels().any(|p| *p == INK), "titles are written");
            }
        }
    }

    #[test]
    fn the_same_frame_gives_the_same_picture() {
        let (frame, recording, discovery) = scene(331, 207, 40, true);
        let bytes = || png(&panels(&frame, &recording, &discovery)).unwrap();
        assert_eq!(bytes(), bytes());
    }

    #[test]
    fn results_of_another_frame_are_no_reason_to_panic() {
        let (_, recording, discovery) = scene(64, 48, 9, true);
        for (width, height) in [(1, 1), (640, 480), (48, 64), (1300, 2)] {
            let (frame, ..) = scene(width, height, 0, false);
            panels(&frame, &recording, &discovery);
        }
        let (frame, recording, mut discovery) = scene(64, 48, 9, true);
        discovery.objects.truncate(1);
        discovery.objects[0].objectness = f32::NAN;
        panels(&frame, &recording, &discovery);
    }

    #[test]
    fn every_tile_stands_under_its_title() {
        // One object fills a frame that keeps its pixels; the last tile shows it.
        let (size, gap, header) = (400, 15, 30);
        let frame = testing::frame(Raster::filled(size, size, 2.0).unwrap(), None);
        let discovery = testing::discovery(Raster::filled(size, size, 1).unwrap());
        let picture = panels(&frame, &Recording::default(), &discovery);
        let step = size as u32 + gap;
        assert_eq!(picture.dimensions(), (4 * step + gap, 2 * (size as u32 + header) + gap));
        let last = |x: u32, y: u32| *picture.get_pixel(gap + 3 * step + x, 2 * header + size as u32 + y);
        assert_eq!(last(0, 0), Rgb([0; 3]));
        assert_eq!(last(10, 10), object_color(1));
        assert_eq!(last(size as u32 - 2, size as u32 - 2), object_color(1));
        assert_eq!(last(size as u32, size as u32), PAGE);
        for column in 0..4 {
            for top in [0, size as u32 + header] {
                let title = imageops::crop_imm(&picture, gap + column * step, top, 100, header).to_image();
                assert!(title.pixels().any(|p| *p == INK), "column {column}, row at {top}");
            }
        }
    }

    #[test]
    fn a_png_holds_the_picture() {
        let picture = RgbImage::from_fn(7, 5, |x, y| Rgb([x as u8, y as u8, 77]));
        let decoded = image::load_from_memory(&png(&picture).unwrap()).unwrap();
        assert_eq!(decoded.into_rgb8(), picture);
        assert!(png(&RgbImage::new(0, 0)).is_err());
    }
}
