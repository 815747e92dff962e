//! One picture of a whole frame.

use image::codecs::png::PngEncoder;
use image::{ImageResult, Rgb, RgbImage, imageops};
use objecthood::{Discovery, Frame};

use crate::recording::Recording;
use crate::text::Text;
use crate::tiles::{self, Scale, Tile};
use crate::view::View;

const COLUMNS: usize = 3;
/// Room for a title and a scale [px], however narrow the frame.
const MIN_TILE_WIDTH_PX: u32 = 320;
/// Room for the support tree [px], however low the frame.
const MIN_TREE_HEIGHT_PX: u32 = 240;
const PAGE: Rgb<u8> = Rgb([255; 3]);
const INK: Rgb<u8> = Rgb([30; 3]);

/// Draws every stage of a frame: colour with the outlines of the objects, depth, normals, superpixels, facets, shapes,
/// objectness, objects, and the support tree. Structure (the table, walls) is grey.
///
/// `recording` and `discovery` are what [`objecthood::discover_observed`] gave for `frame`. A stage that was not
/// recorded is left out; black is where there is no depth or no label. Frames up to 960 px keep their pixels (small
/// ones are enlarged by a whole number), larger ones are shrunk: the picture is at most 3000 px wide. Its size depends
/// on nothing but the size of the frame and which stages were recorded. The same input gives the same picture, byte
/// for byte.
///
/// In the support tree a carrier stands below what it carries. Discs are objects, beside them P(O) above P(S); bars are
/// regions that are no objects, beside them P(S), with the letters that they have in the picture of the objectness. Lines
/// lead to the carriers, with the confidence: dark to what something stands on, blue to what it lies in, orange to what it
/// leans on, dashed where the contact is hidden. A legend repeats this.
pub fn panels(frame: &Frame, recording: &Recording, discovery: &Discovery) -> RgbImage {
    let view = View::new(frame, recording, discovery);
    let mut tiles = vec![tiles::color(&view), tiles::depth(&view)];
    tiles.extend(tiles::normals(&view));
    tiles.extend(tiles::superpixels(&view));
    tiles.extend(tiles::facets(&view));
    tiles.extend(tiles::shapes(&view));
    tiles.push(tiles::objectness(&view));
    tiles.push(tiles::objects(&view));

    let page = Page::new(view.tile_size(), tiles.len() + 1, COLUMNS);
    tiles.push(tiles::support(&view, page.rest_of_last_row()));
    page.compose(&tiles)
}

/// A white page with tiles side by side, each under its title. All have the size of the frame but the last, which
/// takes the rest of its row.
pub(crate) struct Page {
    /// Columns and rows of a tile [px].
    tile: (u32, u32),
    tiles: usize,
    columns: usize,
    letters_px: u32,
}

impl Page {
    pub(crate) fn new((width, height): (u32, u32), tiles: usize, columns: usize) -> Self {
        let tile = (width.max(MIN_TILE_WIDTH_PX), height);
        Self { tile, tiles, columns, letters_px: (tile.0 / 28).clamp(15, 30) }
    }

    fn gap(&self) -> u32 {
        self.letters_px
    }

    fn header(&self) -> u32 {
        2 * self.letters_px
    }

    /// Where the image of tile `k` is.
    pub(crate) fn corner(&self, k: usize) -> (u32, u32) {
        let (column, row) = ((k % self.columns) as u32, (k / self.columns) as u32);
        (
            self.gap() + column * (self.tile.0 + self.gap()),
            self.header() + row * (self.header() + self.tile.1),
        )
    }

    /// Columns and rows of the last tile [px].
    fn rest_of_last_row(&self) -> (u32, u32) {
        let columns = (self.columns - (self.tiles - 1) % self.columns) as u32;
        (columns * (self.tile.0 + self.gap()) - self.gap(), self.tile.1.max(MIN_TREE_HEIGHT_PX))
    }

    pub(crate) fn compose(&self, tiles: &[Tile]) -> RgbImage {
        let width = self.columns as u32 * (self.tile.0 + self.gap()) + self.gap();
        let height = self.corner(self.tiles - 1).1 + self.rest_of_last_row().1 + self.gap();
        let mut page = RgbImage::from_pixel(width, height, PAGE);
        for (k, tile) in tiles.iter().enumerate() {
            let (left, top) = self.corner(k);
            let baseline = i64::from(top - self.letters_px / 2);
            let title = Text::new(&tile.title, self.letters_px as f32);
            title.draw(&mut page, (i64::from(left), baseline - title.ascent), INK);
            if let Some(scale) = &tile.scale {
                let right = left + self.tile.0;
                draw_scale(&mut page, scale, (right, baseline), self.tile.0 / 4, self.letters_px);
            }
            imageops::replace(&mut page, &tile.image, i64::from(left), i64::from(top));
        }
        page
    }
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
    use objecthood::{Observer, Output, Raster};

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
        recording.observe(Output::Normals(&testing::raster(width, height, |_| [0.6, 0.0, -0.8])));
        recording.observe(Output::Superpixels((&regions).into()));
        recording.observe(Output::Facets(&regions));
        recording.observe(Output::Shapes((&regions).into()));
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
                assert!((975..=3000).contains(&w) && (300..=3000).contains(&h), "{width}x{height}: {w}x{h}");
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
        // One object fills a frame that keeps its pixels; of five tiles the fourth shows it.
        let (size, gap, header) = (400, 15, 30);
        let frame = testing::frame(Raster::filled(size, size, 2.0).unwrap(), None);
        let discovery = testing::discovery(Raster::filled(size, size, 1).unwrap());
        let picture = panels(&frame, &Recording::default(), &discovery);
        let size = size as u32;
        let step = size + gap;
        assert_eq!(picture.dimensions(), (3 * step + gap, 2 * (size + header) + gap));
        let objects = |x: u32, y: u32| *picture.get_pixel(gap + x, 2 * header + size + y);
        assert_eq!(objects(0, 0), Rgb([0; 3]));
        assert_eq!(objects(10, 10), object_color(1));
        assert_eq!(objects(size - 2, size - 2), object_color(1));
        assert_eq!(objects(size, size), PAGE);
        for (column, top) in [(0, 0), (1, 0), (2, 0), (0, size + header), (1, size + header)] {
            let title = imageops::crop_imm(&picture, gap + column * step, top, 100, header).to_image();
            assert!(title.pixels().any(|p| *p == INK), "column {column}, row at {top}");
        }
        // The tree takes the rest of the last row.
        let right = |x: u32| *picture.get_pixel(x, 2 * header + size + 5);
        assert!(right(gap + step) != PAGE && right(3 * step - 1) != PAGE && right(3 * step) == PAGE);
    }

    #[test]
    fn the_size_does_not_depend_on_what_is_found() {
        for objects in [0, 1, 200] {
            let (frame, recording, discovery) = scene(640, 480, objects, true);
            assert_eq!(panels(&frame, &recording, &discovery).dimensions(), (2008, 1594));
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
