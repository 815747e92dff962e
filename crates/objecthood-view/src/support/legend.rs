//! What the numbers in the picture of a forest mean.

use image::{Rgb, RgbImage};

use crate::text::Text;

const LINES: [&str; 4] = [
    "disc, upper number: P(O), how well something carries it",
    "disc, lower number: P(S), how well it can carry",
    "bar: no object; its number is P(S)",
    "number on a line: how sure it is",
];

/// Height of the letters on a picture of this width [px].
fn letters_px(width_px: u32) -> f32 {
    (width_px as f32 / 40.0).clamp(8.0, 13.0)
}

/// Height of the legend at the foot of a picture of this width [px].
pub(super) fn height_px(width_px: u32) -> f32 {
    (LINES.len() as f32 + 0.5) * 1.3 * letters_px(width_px)
}

/// Writes the legend at the foot of a picture.
pub(super) fn draw(picture: &mut RgbImage, ink: Rgb<u8>) {
    let (width, height) = picture.dimensions();
    let letters_px = letters_px(width);
    let top = height as f32 - height_px(width);
    for (k, line) in LINES.into_iter().enumerate() {
        let text = Text::new(line, letters_px);
        let baseline = top + (k as f32 + 1.0) * 1.3 * letters_px;
        text.draw(picture, (letters_px as i64, baseline as i64 - text.ascent), ink);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_fits_on_the_narrowest_picture() {
        for width in [320, 640, 2000] {
            for line in LINES {
                let text_px = Text::new(line, letters_px(width)).width as f32;
                assert!(letters_px(width) + text_px < width as f32, "{line}: {text_px} px of {width}");
            }
        }
    }
}
