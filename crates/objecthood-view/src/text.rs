//! Words and digits on a picture.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};
use image::{Rgb, RgbImage};

static FONT: LazyLock<FontRef<'static>> = LazyLock::new(|| {
    FontRef::try_from_slice(dejavu::sans::bold()).expect("DejaVu Sans Bold is compiled in and is a font")
});

/// A line of text, rasterized: how much of each pixel the ink covers.
pub(crate) struct Text {
    /// Columns of the box around the ink [px].
    pub(crate) width: i64,
    /// Rows of that box [px].
    pub(crate) height: i64,
    /// From the baseline up to the top of that box [px].
    pub(crate) ascent: i64,
    /// In [0, 1], row by row.
    coverage: Vec<f32>,
}

impl Text {
    /// Sets `text` in letters `size_px` high, from the lowest descender to the highest ascender.
    pub(crate) fn new(text: &str, size_px: f32) -> Self {
        let outlines: Vec<_> =
            layout(text, size_px).into_iter().filter_map(|g| FONT.outline_glyph(g)).collect();
        let bounds: Vec<[i64; 4]> = outlines
            .iter()
            .map(|outline| {
                let b = outline.px_bounds();
                [b.min.x as i64, b.min.y as i64, b.max.x as i64, b.max.y as i64]
            })
            .collect();
        let least = |k: usize| bounds.iter().map(|b| b[k]).min().unwrap_or(0);
        let most = |k: usize| bounds.iter().map(|b| b[k]).max().unwrap_or(0);
        let (left, top) = (least(0), least(1));
        let (width, height) = (most(2) - left, most(3) - top);
        let mut coverage = vec![0.0; (width * height) as usize];
        for (outline, b) in outlines.iter().zip(&bounds) {
            outline.draw(|x, y, c| {
                let (x, y) = (i64::from(x) + b[0] - left, i64::from(y) + b[1] - top);
                if let Some(covered) = coverage.get_mut((y * width + x) as usize) {
                    *covered = f32::min(1.0, *covered + c);
                }
            });
        }
        Self { width, height, ascent: -top, coverage }
    }

    /// Draws it with its box at (left, top). What lies outside the picture is cut off.
    pub(crate) fn draw(&self, picture: &mut RgbImage, (left, top): (i64, i64), ink: Rgb<u8>) {
        for y in 0..self.height {
            for x in 0..self.width {
                blend(picture, (left + x, top + y), ink, self.covered(x, y));
            }
        }
    }

    /// As [`Self::draw`], with a halo of `radius_px` around every letter.
    pub(crate) fn draw_with_halo(
        &self,
        picture: &mut RgbImage,
        at: (i64, i64),
        ink: Rgb<u8>,
        halo: Rgb<u8>,
        radius_px: i64,
    ) {
        let r = radius_px;
        let square = || (-r..=r).flat_map(|dy| (-r..=r).map(move |dx| (dx, dy)));
        let disc: Vec<(i64, i64)> = square().filter(|(dx, dy)| dx * dx + dy * dy <= r * r + r).collect();
        for y in -r..self.height + r {
            for x in -r..self.width + r {
                let near = disc.iter().map(|(dx, dy)| self.covered(x + dx, y + dy)).fold(0.0, f32::max);
                blend(picture, (at.0 + x, at.1 + y), halo, near);
            }
        }
        self.draw(picture, at, ink);
    }

    fn covered(&self, x: i64, y: i64) -> f32 {
        let inside = (0..self.width).contains(&x) && (0..self.height).contains(&y);
        if inside { self.coverage[(y * self.width + x) as usize] } else { 0.0 }
    }
}

/// The letters side by side, the pen starting on the baseline at (0, 0).
fn layout(text: &str, size_px: f32) -> Vec<Glyph> {
    let scale = PxScale::from(size_px);
    let font = FONT.as_scaled(scale);
    let mut pen_px = 0.0;
    let mut last = None;
    text.chars()
        .map(|c| {
            let id = font.glyph_id(c);
            pen_px += last.map_or(0.0, |last| font.kern(last, id));
            let glyph = id.with_scale_and_position(scale, point(pen_px, 0.0));
            pen_px += font.h_advance(id);
            last = Some(id);
            glyph
        })
        .collect()
}

/// Covers the share `alpha` of a pixel with `color`. Outside the picture nothing happens.
pub(crate) fn blend(picture: &mut RgbImage, (x, y): (i64, i64), color: Rgb<u8>, alpha: f32) {
    let at = u32::try_from(x).ok().zip(u32::try_from(y).ok());
    if let Some(pixel) = at.and_then(|(x, y)| picture.get_pixel_mut_checked(x, y)) {
        *pixel = mix(*pixel, color, alpha);
    }
}

/// `a` and `b` mixed: the share `t` of `b`, in [0, 1].
pub(crate) fn mix(a: Rgb<u8>, b: Rgb<u8>, t: f32) -> Rgb<u8> {
    let channel = |k: usize| f32::from(a.0[k]) + (f32::from(b.0[k]) - f32::from(a.0[k])) * t;
    Rgb([0, 1, 2].map(|k| channel(k).round() as u8))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: Rgb<u8> = Rgb([255; 3]);
    const BLACK: Rgb<u8> = Rgb([0; 3]);
    const RED: Rgb<u8> = Rgb([255, 0, 0]);

    #[test]
    fn text_fills_its_box_and_nothing_else() {
        let text = Text::new("depth 12", 20.0);
        assert!(text.width > 60 && (14..=22).contains(&text.height) && text.ascent <= text.height);
        let mut picture = RgbImage::from_pixel(200, 40, WHITE);
        text.draw(&mut picture, (10, 5), BLACK);
        let inked: Vec<(i64, i64)> = picture
            .enumerate_pixels()
            .filter(|(.., p)| **p != WHITE)
            .map(|(x, y, _)| (i64::from(x), i64::from(y)))
            .collect();
        let columns = inked.iter().map(|(x, _)| *x);
        let rows = inked.iter().map(|(_, y)| *y);
        // The box of the outlines may exceed the ink by a faint pixel.
        assert!((10..=11).contains(&columns.clone().min().unwrap()));
        assert!((8 + text.width..=9 + text.width).contains(&columns.max().unwrap()));
        assert!((5..=6).contains(&rows.clone().min().unwrap()));
        assert!((3 + text.height..=4 + text.height).contains(&rows.max().unwrap()));
    }

    #[test]
    fn a_halo_surrounds_the_ink() {
        let text = Text::new("8", 30.0);
        let mut picture = RgbImage::from_pixel(60, 60, WHITE);
        text.draw_with_halo(&mut picture, (15, 15), BLACK, RED, 2);
        let black: Vec<(u32, u32)> =
            picture.enumerate_pixels().filter(|(.., p)| **p == BLACK).map(|(x, y, _)| (x, y)).collect();
        assert!(black.len() > 50);
        for (x, y) in black {
            for (nx, ny) in [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)] {
                assert_eq!(
                    picture.get_pixel(nx, ny)[1],
                    picture.get_pixel(nx, ny)[2],
                    "no white beside the ink"
                );
                assert_eq!(picture.get_pixel(nx, ny)[1], 0, "no white beside the ink");
            }
        }
    }

    #[test]
    fn text_beyond_the_picture_is_cut_off() {
        let mut picture = RgbImage::new(5, 5);
        for at in [(-100, -100), (-3, -3), (4, 4), (i64::from(u32::MAX), 0)] {
            Text::new("123", 14.0).draw_with_halo(&mut picture, at, BLACK, WHITE, 2);
        }
        let nothing = Text::new("", 14.0);
        assert_eq!((nothing.width, nothing.height), (0, 0));
        nothing.draw(&mut picture, (0, 0), WHITE);
    }

    #[test]
    fn mixing_ends_at_either_colour() {
        assert_eq!((mix(RED, WHITE, 0.0), mix(RED, WHITE, 1.0)), (RED, WHITE));
        assert_eq!(mix(BLACK, WHITE, 0.5), Rgb([128; 3]));
    }
}
