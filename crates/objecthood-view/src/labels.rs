//! Numbers and letters on a picture, each on what it names and none on another.

use image::{Rgb, RgbImage};

use crate::distance::Anchor;
use crate::drawing::{disc, line};
use crate::palette::ink_on;
use crate::text::Text;

/// A name that is to be written on a region.
pub(crate) struct Label {
    pub(crate) text: String,
    /// Of the region.
    pub(crate) color: Rgb<u8>,
    /// Where the region has most room.
    pub(crate) anchor: Anchor,
}

/// Width of the halo around letters [px].
const HALO_PX: i64 = 2;
/// How far a label may be moved off its region, in heights of its letters.
const REACH: i64 = 3;

/// Writes labels on an image, those of large regions first. One that would cover another is moved a little and
/// tied to its region by a line; where there is no room near by, it is covered in part by more important ones.
pub(crate) fn write(image: &mut RgbImage, mut labels: Vec<Label>) {
    labels.sort_by(|a, b| {
        b.anchor.radius_px.total_cmp(&a.anchor.radius_px).then(a.anchor.id.cmp(&b.anchor.id))
    });
    let mut taken = Taken::new(image.dimensions());
    let longest = image.width().max(image.height()) as f32;
    let (smallest_px, largest_px) = ((longest / 50.0).max(13.0), longest / 22.0);
    let placed: Vec<(Label, Text, Place)> = labels
        .into_iter()
        .map(|label| {
            let text =
                Text::new(&label.text, (1.6 * label.anchor.radius_px).min(largest_px).max(smallest_px));
            let place = taken.place(&label.anchor, &text);
            (label, text, place)
        })
        .collect();
    for (label, text, place) in placed.iter().rev() {
        let (anchor, middle) = ([label.anchor.u, label.anchor.v].map(|x| x as f32 + 0.5), place.middle());
        if !place.holds(anchor) {
            line(image, &[anchor, middle], 1.5, label.color);
            disc(image, anchor, 2.5, label.color);
        }
        // Digits that reach beyond a small region keep their contrast and show whose they are.
        let at = (place.left + HALO_PX, place.top + HALO_PX);
        text.draw_with_halo(image, at, ink_on(label.color), label.color, HALO_PX);
    }
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug)]
struct Place {
    left: i64,
    top: i64,
    width: i64,
    height: i64,
}

impl Place {
    fn middle(&self) -> [f32; 2] {
        [self.left as f32 + self.width as f32 / 2.0, self.top as f32 + self.height as f32 / 2.0]
    }

    fn holds(&self, [x, y]: [f32; 2]) -> bool {
        let inside = |x: f32, from: i64, length: i64| x >= from as f32 && x <= (from + length) as f32;
        inside(x, self.left, self.width) && inside(y, self.top, self.height)
    }
}

/// Which pixels of an image hold a label.
struct Taken {
    width: i64,
    height: i64,
    pixels: Vec<bool>,
}

impl Taken {
    fn new((width, height): (u32, u32)) -> Self {
        let pixels = vec![false; width as usize * height as usize];
        Self { width: i64::from(width), height: i64::from(height), pixels }
    }

    /// Takes the first free place: on the anchor, then around it at rising distance; if none is free the anchor.
    fn place(&mut self, anchor: &Anchor, text: &Text) -> Place {
        let (width, height) = (text.width + 2 * HALO_PX, text.height + 2 * HALO_PX);
        let (left, top) = (anchor.u as i64 - width / 2, anchor.v as i64 - height / 2);
        let home = Place { left, top, width, height };
        let step = (height / 2).max(1);
        let rings = (1..=2 * REACH).flat_map(|ring| {
            let sides = [(1, 0), (-1, 0), (0, -1), (0, 1), (1, -1), (-1, -1), (1, 1), (-1, 1)];
            sides.map(|(du, dv)| Place { left: left + du * ring * step, top: top + dv * ring * step, ..home })
        });
        let place = std::iter::once(home).chain(rings).find(|b| self.is_free(b)).unwrap_or(home);
        self.rows(&place).for_each(|row| self.pixels[row].fill(true));
        place
    }

    /// Whether a box lies inside the image and holds no pixel that is taken.
    fn is_free(&self, place: &Place) -> bool {
        let inside = place.left >= 0
            && place.top >= 0
            && place.left + place.width <= self.width
            && place.top + place.height <= self.height;
        inside && self.rows(place).all(|row| self.pixels[row].iter().all(|taken| !taken))
    }

    /// The part of a box that lies inside the image, row by row.
    fn rows(&self, place: &Place) -> impl Iterator<Item = std::ops::Range<usize>> + use<> {
        let clip = |x: i64, most: i64| x.clamp(0, most);
        let (left, right) = (clip(place.left, self.width), clip(place.left + place.width, self.width));
        let (top, bottom) = (clip(place.top, self.height), clip(place.top + place.height, self.height));
        let width = self.width;
        (top..bottom).map(move |y| (y * width + left) as usize..(y * width + right) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (320, 240);

    fn label(id: u16, u: usize, v: usize, radius_px: f32) -> Label {
        let color = Rgb([id as u8, 200, 255 - id as u8]);
        Label { text: id.to_string(), color, anchor: Anchor { id, u, v, radius_px } }
    }

    fn place(taken: &mut Taken, label: &Label) -> Place {
        taken.place(&label.anchor, &Text::new(&label.text, 14.0))
    }

    fn overlap(a: &Place, b: &Place) -> bool {
        let apart = |a: i64, a_length: i64, b: i64, b_length: i64| a + a_length <= b || b + b_length <= a;
        !apart(a.left, a.width, b.left, b.width) && !apart(a.top, a.height, b.top, b.height)
    }

    #[test]
    fn labels_do_not_cover_each_other() {
        // Objects 9 px apart, two digits 18 px wide.
        let mut taken = Taken::new(SIZE);
        let crowd = (0..16)
            .map(|k| label(10 + k, 140 + 9 * (usize::from(k) % 4), 100 + 9 * (usize::from(k) / 4), 4.0));
        let places: Vec<Place> = crowd.map(|l| place(&mut taken, &l)).collect();
        for (k, a) in places.iter().enumerate() {
            assert!(a.left >= 0 && a.top >= 0, "{a:?}");
            assert!(places[..k].iter().all(|b| !overlap(a, b)), "{a:?} covers another");
        }
        let (first, home) = (&places[0], [140.0, 100.0]);
        assert!((0..2).all(|k| (first.middle()[k] - home[k]).abs() <= 1.0), "the first one stays: {first:?}");
    }

    #[test]
    fn a_label_at_the_border_moves_inside() {
        for (u, v) in [(0, 0), (319, 0), (0, 239), (319, 239)] {
            let place = place(&mut Taken::new(SIZE), &label(88, u, v, 1.0));
            assert!(place.left >= 0 && place.left + place.width <= 320, "{place:?}");
            assert!(place.top >= 0 && place.top + place.height <= 240, "{place:?}");
        }
    }

    #[test]
    fn without_room_a_label_stays_where_it_belongs() {
        let mut taken = Taken::new(SIZE);
        taken.pixels.fill(true);
        let middle = place(&mut taken, &label(1, 100, 100, 9.0)).middle();
        assert!(
            middle.iter().all(|x| (x - 100.5).abs() <= 0.5),
            "{middle:?} is not the middle of pixel 100, 100"
        );
        for size in [(1, 1), (320, 1), (1, 240)] {
            let mut image = RgbImage::new(size.0, size.1);
            write(&mut image, (1..200).map(|id| label(id, 0, 0, 0.3)).collect());
        }
    }

    #[test]
    fn a_moved_label_is_tied_to_its_region() {
        let mut image = RgbImage::new(SIZE.0, SIZE.1);
        write(&mut image, vec![label(1, 160, 120, 9.0), label(2, 160, 120, 2.0)]);
        let count = |id| image.pixels().filter(|p| **p == label(id, 0, 0, 0.0).color).count();
        assert!(count(1) > 20 && count(2) > 20, "{} {}", count(1), count(2));
    }
}
