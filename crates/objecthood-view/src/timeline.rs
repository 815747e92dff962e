//! A frame of a video with its objects, and what happened lately on a line of time below it.

use image::{Rgb, RgbImage, imageops};
use objecthood::{Frame, PixelBox, Raster};

use crate::overlay::overlay;
use crate::text::Text;

/// The line shows so much time (s), up to now.
const SHOWN_S: f64 = 8.0;
/// Rows of text below the line, and their height (px at 640 columns).
const ROWS: usize = 4;
const ROW_PX: f32 = 16.0;
/// Words are this far from each other, and from what they name (px).
const GAP_PX: i64 = 4;
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

/// The frame with its objects, as [`overlay()`] draws them, a box around each of the `agents` with its number, and below the marks of the last 8 s, the
/// newest at the right. Where the words of two marks would lie on each other, the older one has only its tick. `labels` has the size of the frame.
/// O(pixels).
pub fn filmed(
    frame: &Frame,
    labels: &Raster<u16>,
    agents: &[(u16, PixelBox)],
    now_s: f64,
    marks: &[Mark],
) -> RgbImage {
    let mut picture = overlay(frame, labels);
    let (width, height) = picture.dimensions();
    let row_px = ROW_PX * (width as f32 / 640.0).max(0.5);
    for &(number, around) in agents {
        draw_agent(&mut picture, number, around, row_px);
    }
    let strip_px = (row_px * (ROWS as f32 + 1.0)) as u32;
    let mut whole = RgbImage::from_pixel(width, height + strip_px, GROUND);
    imageops::replace(&mut whole, &picture, 0, 0);
    let line_y = height + (row_px / 2.0) as u32;
    (0..width).for_each(|x| whole.put_pixel(x, line_y, LINE));
    let is_recent = |mark: &&Mark| (0.0..=SHOWN_S).contains(&(now_s - mark.time_s));
    let mut recent: Vec<&Mark> = marks.iter().filter(is_recent).collect();
    recent.sort_by(|a, b| b.time_s.total_cmp(&a.time_s));
    // The columns that words occupy in each row (px).
    let mut taken: Vec<Vec<[i64; 2]>> = vec![Vec::new(); ROWS];
    let mut words = Vec::new();
    for mark in recent {
        let x = ((1.0 - (now_s - mark.time_s) / SHOWN_S) * f64::from(width - 1)) as u32;
        let text = Text::new(&mark.text, 0.75 * row_px);
        // Beside its tick, on the side where there is room.
        let left = if i64::from(x) + GAP_PX + text.width <= i64::from(width) {
            i64::from(x) + GAP_PX
        } else {
            (i64::from(x) - GAP_PX - text.width).max(0)
        };
        let is_free = |row: &&mut Vec<[i64; 2]>| {
            row.iter().all(|&[from, to]| left + text.width + GAP_PX <= from || to + GAP_PX <= left)
        };
        let row = taken.iter_mut().enumerate().find(|(_, row)| is_free(row));
        let top = height as f32 + row_px * (1.0 + row.as_ref().map_or(0.0, |(k, _)| *k as f32));
        for y in line_y.saturating_sub(row_px as u32 / 3)..(top as u32 + 2).min(height + strip_px) {
            whole.put_pixel(x, y, LINE);
        }
        if let Some((_, row)) = row {
            row.push([left, left + text.width]);
            words.push((text, (left, top as i64)));
        }
    }
    // Over the ticks of older marks, which go down through the rows of newer ones.
    for (text, at) in words {
        text.draw_with_halo(&mut whole, at, INK, GROUND, 2);
    }
    whole
}

/// Draws a box around an agent, with its number at the upper left corner.
fn draw_agent(picture: &mut RgbImage, number: u16, around: PixelBox, letters_px: f32) {
    let [u, v, width, height] = [around.u, around.v, around.width, around.height].map(|x| x as i64);
    // A dark line on both sides of the light one: on any picture one of them shows.
    for (inset, ink) in [(-1, GROUND), (1, GROUND), (0, INK)] {
        let (left, right) = (u + inset, u + width - 1 - inset);
        let (top, bottom) = (v + inset, v + height - 1 - inset);
        let sides = (left..=right)
            .flat_map(|x| [(x, top), (x, bottom)])
            .chain((top..=bottom).flat_map(|y| [(left, y), (right, y)]));
        for (x, y) in sides {
            let at = u32::try_from(x).ok().zip(u32::try_from(y).ok());
            if let Some(pixel) = at.and_then(|(x, y)| picture.get_pixel_mut_checked(x, y)) {
                *pixel = ink;
            }
        }
    }
    let text = Text::new(&format!("agent {number}"), 0.75 * letters_px);
    text.draw_with_halo(picture, (u + GAP_PX, v + GAP_PX), INK, GROUND, 2);
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
        let drawn = |marks: &[Mark]| filmed(&frame, &labels, &[], 20.0, marks);
        let none = drawn(&[]);
        assert_eq!(none.width(), 160);
        assert!(none.height() > 120);
        assert_eq!(drawn(&[mark(3.0)]), none);
        assert_ne!(drawn(&[mark(19.0)]), none);
    }

    #[test]
    fn words_do_not_lie_on_each_other() {
        let frame = testing::frame(testing::raster(640, 480, |_| 1.0), None);
        let labels = testing::raster(640, 480, |_| 0);
        let mark = |time_s, text: &str| Mark { time_s, text: text.to_owned() };
        let ink = |marks: &[Mark]| {
            let picture = filmed(&frame, &labels, &[], 20.0, marks);
            picture.pixels().filter(|&&pixel| pixel == INK).count()
        };
        let one = ink(&[mark(19.0, "3 picked up")]);
        assert!(one > 0);
        // There are four rows; the oldest of five has no words.
        let five: Vec<Mark> = (0..5).map(|k| mark(19.0 - 0.1 * f64::from(k), "3 picked up")).collect();
        let four = ink(&five[..4]);
        assert!(four > 3 * one, "{four} against {one}");
        assert_eq!(ink(&five), four);
    }

    #[test]
    fn an_agent_is_boxed_and_numbered() {
        let frame = testing::frame(testing::raster(640, 480, |_| 1.0), None);
        let labels = testing::raster(640, 480, |_| 0);
        let around = PixelBox { u: 20, v: 30, width: 100, height: 60 };
        let picture = filmed(&frame, &labels, &[(4, around)], 20.0, &[]);
        let corners = [(20, 30), (119, 30), (20, 89), (119, 89)];
        assert!(corners.into_iter().all(|(x, y)| *picture.get_pixel(x, y) == INK));
        let inside = (24..110).flat_map(|x| (34..60).map(move |y| (x, y)));
        assert!(inside.filter(|&(x, y)| *picture.get_pixel(x, y) == INK).count() > 5, "its number");
    }
}
