//! Colours that colour-blind eyes, too, can tell apart, and that stay the same for the same number.

use std::sync::LazyLock;

use image::Rgb;

use crate::vision::{Seen, contrast, difference, seen};

/// Okabe and Ito, "Color universal design", 2008, without their black: black is where nothing is. (The grey that R
/// adds looks like the last of these to deuteranopes.)
const OKABE_ITO: [[u8; 3]; 7] = [
    [230, 159, 0],
    [86, 180, 233],
    [0, 158, 115],
    [240, 228, 66],
    [0, 114, 178],
    [213, 94, 0],
    [204, 121, 167],
];

/// Colours before they repeat.
const COLORS: usize = 256;

/// The colour of object `id`, counted from 1: the same in every picture. Repeats after 256 objects.
pub fn object_color(id: u16) -> Rgb<u8> {
    PALETTE[usize::from(id.saturating_sub(1)) % COLORS].rgb
}

/// Black or white, whichever is read better on `background`: a contrast of at least 4.5.
pub(crate) fn ink_on(background: Rgb<u8>) -> Rgb<u8> {
    let (black, white) = (Rgb([0; 3]), Rgb([255; 3]));
    if contrast(black, background) >= contrast(white, background) { black } else { white }
}

/// A colour, and how it looks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swatch {
    pub(crate) rgb: Rgb<u8>,
    seen: Seen,
}

impl Swatch {
    fn new(rgb: Rgb<u8>) -> Self {
        Self { rgb, seen: seen(rgb) }
    }

    /// How far apart the two look to the eye that tells them apart worst.
    pub(crate) fn difference(&self, other: &Self) -> f32 {
        difference(&self.seen, &other.seen)
    }

    /// Neither dark (nothing) nor white (the page), not grey (the image behind objects), and no harsher than Okabe
    /// and Ito's.
    fn is_calm(&self) -> bool {
        let [l, a, b] = self.seen[0];
        (0.45..0.93).contains(&l) && (0.06..0.19).contains(&libm::hypotf(a, b))
    }
}

/// Okabe and Ito's colours, then one by one the colour that differs most from all before it.
pub(crate) static PALETTE: LazyLock<Vec<Swatch>> = LazyLock::new(|| {
    let levels = || (0..=u8::MAX).step_by(17);
    let grid = levels().flat_map(|r| levels().flat_map(move |g| levels().map(move |b| Rgb([r, g, b]))));
    let mut candidates: Vec<(Swatch, f32)> =
        grid.map(Swatch::new).filter(Swatch::is_calm).map(|swatch| (swatch, f32::INFINITY)).collect();
    let mut palette: Vec<Swatch> = Vec::with_capacity(COLORS);
    for k in 0..COLORS {
        let farthest = || candidates.iter().reduce(|best, next| if next.1 > best.1 { next } else { best });
        let next = match OKABE_ITO.get(k) {
            Some(&rgb) => Swatch::new(Rgb(rgb)),
            None => farthest().expect("the grid of candidates is not empty").0,
        };
        for (candidate, difference) in &mut candidates {
            *difference = difference.min(candidate.difference(&next));
        }
        palette.push(next);
    }
    palette
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_objects_look_alike() {
        assert_eq!(object_color(1), Rgb(OKABE_ITO[0]));
        assert_eq!(object_color(7), Rgb(OKABE_ITO[6]));
        assert_eq!(object_color(257), object_color(1));
        let nearest = |n: usize| {
            let pairs = (0..n).flat_map(|a| (0..a).map(move |b| PALETTE[a].difference(&PALETTE[b])));
            pairs.fold(f32::INFINITY, f32::min)
        };
        // Differences for the eye that sees least of them; 0.02 is just noticeable.
        for (n, least) in [(7, 0.07), (16, 0.07), (32, 0.05), (64, 0.03), (256, 0.01)] {
            assert!(nearest(n) > least, "the first {n} colours differ by {}", nearest(n));
        }
    }

    #[test]
    fn every_id_is_legible_on_its_object() {
        for id in 1..=u16::MAX {
            let color = object_color(id);
            assert!(contrast(color, ink_on(color)) >= 4.5, "{id}: {color:?}");
            assert!(contrast(color, Rgb([0; 3])) >= 2.0, "{id} {color:?} looks like nothing");
        }
        for grey in 0..=255 {
            assert!(contrast(Rgb([grey; 3]), ink_on(Rgb([grey; 3]))) >= 4.5, "{grey}");
        }
    }
}
