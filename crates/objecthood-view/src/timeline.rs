//! A frame of a video with its objects, and what happened lately on a line of time below it.

use image::{Rgb, RgbImage, imageops};
use objecthood::{Frame, Raster};

use crate::overlay::overlay;
use crate::text::Text;

/// The line shows so much time (s), up to now.
const SHOWN_S: f64 = 8.0;
/// Rows of text below the line, and their height (px at 640 columns).
const ROWS: usize = 4;
const ROW_PX: f32 = 16.0;
const GROUND: Rgb<u8> = Rgb([24, 24, 28]);
const LINE: Rgb<u8> = Rgb([130, 130, 140]);
const INK: Rgb<u8> = Rgb([235, 235, 235]);

/// A mark on the line of time.
#[derive(Clone, Debug)]
pub struct Mark {
    /// When it was (s).
    pub time_s: f64,
    /// What, in a few words.
    pub text: String,
}

/// The frame with its objects, as [`overlay()`] draws them, and below it the marks of the last 8 s, the newest at the right.
/// `labels` has the size of the frame. O(pixels).
pub fn filmed(frame: &Frame, labels: &Raster<u16>, now_s: f64, marks: &[Mark]) -> RgbImage {
    let picture = overlay(frame, labels);
    let (width, height) = picture.dimensions();
    let row_px = ROW_PX * (width as f32 / 640.0).max(0.5);
    let strip_px = (row_px * (ROWS as f32 + 1.0)) as u32;
    let mut whole = RgbImage::from_pixel(width, height + strip_px, GROUND);
    imageops::replace(&mut whole, &picture, 0, 0);
    let line_y = height + (row_px / 2.0) as u32;
    (0..width).for_each(|x| whole.put_pixel(x, line_y, LINE));
    let recent = marks.iter().filter(|mark| (0.0..=SHOWN_S).contains(&(now_s - mark.time_s)));
    for (k, mark) in recent.enumerate() {
        let x = ((1.0 - (now_s - mark.time_s) / SHOWN_S) * f64::from(width - 1)) as u32;
        let row = height as f32 + row_px * (1.0 + (k % ROWS) as f32);
        for y in line_y.saturating_sub(row_px as u32 / 3)..(row as u32 + 2).min(height + strip_px) {
            whole.put_pixel(x, y, LINE);
        }
        let text = Text::new(&mark.text, 0.75 * row_px);
        // Beside its tick, on the side where there is room.
        let left = if i64::from(x) + 4 + text.width <= i64::from(width) {
            i64::from(x) + 4
        } else {
            (i64::from(x) - 4 - text.width).max(0)
        };
        text.draw(&mut whole, (left, row as i64), INK);
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn marks_of_the_last_seconds_are_drawn_and_older_ones_are_not() {
        let frame = testing::frame(testing::raster(160, 120, |_| 1.0), None);
        let labels = testing::raster(160, 120, |_| 0);
        let mark = |time_s| Mark { time_s, text: "3 picked up".to_owned() };
        let drawn = |marks: &[Mark]| filmed(&frame, &labels, 20.0, marks);
        let none = drawn(&[]);
        assert_eq!(none.width(), 160);
        assert!(none.height() > 120);
        assert_eq!(drawn(&[mark(3.0)]), none);
        assert_ne!(drawn(&[mark(19.0)]), none);
    }
}
