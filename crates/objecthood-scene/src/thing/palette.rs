//! Colours that things share in real life: things of one brand, wood on wood, white on white.

use super::COLORS;
use crate::random::Rng;
use crate::texture::{Albedo, Paint, Texture};

/// Colours that go together, and whether they are those of wood.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Palette {
    colors: [Albedo; 4],
    is_wood: bool,
}

const PALETTES: [Palette; 6] = [
    Palette::WOOD,
    // White on white.
    painted([[0.80, 0.80, 0.79], [0.70, 0.70, 0.68], [0.78, 0.75, 0.68], [0.66, 0.69, 0.72]]),
    // Cardboard and paper.
    painted([[0.52, 0.37, 0.23], [0.60, 0.46, 0.30], [0.42, 0.29, 0.18], [0.72, 0.66, 0.55]]),
    // Two brands: their colour, a light and a dark tone of it, and white.
    painted([[0.55, 0.05, 0.05], [0.75, 0.30, 0.22], [0.25, 0.03, 0.04], [0.78, 0.76, 0.72]]),
    painted([[0.05, 0.18, 0.50], [0.25, 0.45, 0.70], [0.03, 0.07, 0.20], [0.76, 0.77, 0.79]]),
    // Grey and black plastic.
    painted([[0.06, 0.06, 0.065], [0.16, 0.16, 0.17], [0.30, 0.30, 0.31], [0.48, 0.48, 0.47]]),
];
/// Two colours are the same to the eye when no channel differs by more than this share of the lighter one.
const ALIKE: f64 = 0.12;

const fn painted(colors: [Albedo; 4]) -> Palette {
    Palette { colors, is_wood: false }
}

impl Palette {
    pub(crate) const WOOD: Self = Self {
        colors: [[0.62, 0.47, 0.33], [0.50, 0.34, 0.21], [0.70, 0.60, 0.47], [0.34, 0.20, 0.12]],
        is_wood: true,
    };

    /// Half of them are loud colours that have nothing in common.
    pub(crate) fn any(rng: &mut Rng) -> Self {
        if rng.chance(0.5) {
            return painted([0; 4].map(|_| rng.pick(&COLORS)));
        }
        Self::shared(rng)
    }

    /// Colours that have much in common.
    pub(crate) fn shared(rng: &mut Rng) -> Self {
        rng.pick(&PALETTES)
    }

    /// One of its colours, a little lighter or darker.
    fn color(&self, rng: &mut Rng) -> Albedo {
        let tone = rng.range(0.85..1.1);
        rng.pick(&self.colors).map(|c| (c * tone).min(0.85))
    }

    /// Any surface in its colours; with this probability one with print.
    pub(crate) fn paint(&self, rng: &mut Rng, printed: f64) -> Paint {
        let (base, ink) = (self.color(rng), self.color(rng));
        let seed = rng.bits();
        let texture = if rng.chance(printed) {
            Texture::Print { seed }
        } else if self.is_wood {
            Texture::Wood { seed, board_m: rng.range(0.05..0.25) }
        } else {
            match rng.below(6) {
                0 => Texture::Gradient { length_m: rng.range(0.08..0.25) },
                1 => Texture::Clouds { seed, cell_m: rng.range(0.005..0.03) },
                _ => Texture::Plain,
            }
        };
        let gloss = if rng.chance(0.3) { rng.range(0.1..0.5) } else { 0.0 };
        Paint { base, ink, texture, gloss }
    }

    /// A surface whose colour is not that of `other`; both may be of this palette.
    pub(crate) fn paint_unlike(&self, rng: &mut Rng, printed: f64, other: &Paint) -> Paint {
        const TRIES: usize = 20;
        let mut paint = self.paint(rng, printed);
        for _ in 0..TRIES {
            if differ(paint.base, other.base) {
                break;
            }
            paint = self.paint(rng, printed);
        }
        paint
    }
}

fn differ(a: Albedo, b: Albedo) -> bool {
    (0..3).any(|k| (a[k] - b[k]).abs() > ALIKE * a[k].max(b[k]))
}
