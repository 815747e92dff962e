//! What is painted on a surface.

mod patterns;

use std::f64::consts::TAU;

use crate::random::Field;

/// Share of red, green and blue light that a surface returns, linear, 0..1.
pub(crate) type Albedo = [f64; 3];

/// A texture in two inks. Lengths are metres on the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paint {
    pub(crate) base: Albedo,
    pub(crate) ink: Albedo,
    pub(crate) texture: Texture,
    /// Share of the lamp's light that a spot returns in which the surface mirrors the lamp; 0 when it is dull.
    pub(crate) gloss: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Texture {
    Plain,
    /// Across u or v, half base, half ink.
    Stripes {
        period_m: f64,
        upright: bool,
    },
    /// Like a package: a band, a disc, lines of text.
    Print {
        seed: u64,
    },
    /// Boards with grain along u.
    Wood {
        seed: u64,
        board_m: f64,
    },
    /// Ink where v, or when upright u, lies between two lines: a band or block of colour right across the face.
    Band {
        low_m: f64,
        high_m: f64,
        upright: bool,
    },
    /// A field of ink of this half size in the middle of the face, with rows as of text in it.
    Label {
        seed: u64,
        half_m: [f64; 2],
    },
    /// From base to ink along v within this length about the middle of the face.
    Gradient {
        length_m: f64,
    },
    /// Squares, each of a tone of its own, with ink between them.
    Tiles {
        seed: u64,
        side_m: f64,
    },
    /// Stripes across stripes, as on a table cloth.
    Checks {
        period_m: f64,
    },
    /// Base and ink mixed in clouds of this size: marble, wear, fur.
    Clouds {
        seed: u64,
        cell_m: f64,
    },
    /// Round stains of ink, about one in a square of this side.
    Stains {
        seed: u64,
        side_m: f64,
    },
}

impl Paint {
    pub(crate) fn plain(base: Albedo) -> Self {
        Self { base, ink: base, texture: Texture::Plain, gloss: 0.0 }
    }

    /// The colour at a place of the surface.
    pub(crate) fn albedo(&self, [u, v]: [f64; 2]) -> Albedo {
        match self.texture {
            Texture::Plain => self.base,
            Texture::Stripes { period_m, upright } => {
                let phase = (if upright { u } else { v }) / period_m;
                self.mixed(f64::from(u8::from(phase - phase.floor() < 0.5)))
            }
            Texture::Print { seed } => self.print(seed, u, v),
            Texture::Wood { seed, board_m } => self.wood(seed, u, v, board_m),
            Texture::Band { low_m, high_m, upright } => {
                self.mixed(f64::from(u8::from((low_m..high_m).contains(if upright { &u } else { &v }))))
            }
            Texture::Label { seed, half_m } => self.label(seed, [u, v], half_m),
            Texture::Gradient { length_m } => self.mixed((v / length_m + 0.5).clamp(0.0, 1.0)),
            Texture::Tiles { seed, side_m } => self.tiles(seed, [u, v], side_m),
            Texture::Checks { period_m } => self.checks([u, v], period_m),
            Texture::Clouds { seed, cell_m } => self.clouds(seed, [u, v], cell_m),
            Texture::Stains { seed, side_m } => self.stains(seed, [u, v], side_m),
        }
    }

    fn mixed(&self, ink: f64) -> Albedo {
        [0, 1, 2].map(|k| self.base[k] + (self.ink[k] - self.base[k]) * ink)
    }

    fn print(&self, seed: u64, u: f64, v: f64) -> Albedo {
        const PAGE_M: f64 = 0.11;
        const LINE_M: f64 = 0.007;
        const WHITE: Albedo = [0.8, 0.8, 0.78];
        let field = Field::new(seed, 0);
        let (x, y) = (u / PAGE_M + 0.5, v / PAGE_M + 0.5);
        let page = (x.floor() as i64, y.floor() as i64);
        let (x, y) = (x - x.floor(), y - y.floor());
        let own = |k: i64| field.unit(page.0 * 16 + k, page.1);

        let (disc_x, disc_y, disc_r) = (0.3 + 0.4 * own(0), 0.35 + 0.4 * own(1), 0.12 + 0.12 * own(2));
        let disc = (x - disc_x) * (x - disc_x) + (y - disc_y) * (y - disc_y);
        if disc < disc_r * disc_r {
            return if disc < disc_r * disc_r * 0.6 { WHITE } else { self.ink };
        }
        let band = 0.06 + 0.7 * own(3);
        if (band..band + 0.16).contains(&y) {
            return self.ink;
        }
        let (line, column) = ((v / LINE_M).floor(), (u / (LINE_M * 0.4)).floor());
        let in_text = own(4) < 0.8 && y < 0.35 && (0.12..0.88).contains(&x) && v / LINE_M - line < 0.5;
        let is_letter = field.unit(column as i64, 1000 + line as i64) < 0.75;
        if in_text && is_letter { [0.06, 0.06, 0.07] } else { self.base }
    }

    fn wood(&self, seed: u64, u: f64, v: f64, board_m: f64) -> Albedo {
        let board = (v / board_m).floor();
        let field = Field::new(seed, board as i64 as u64);
        let wander = field.slow(u, v * 4.0, 0.25) * 0.012;
        let rings = libm::sin((v + wander) * TAU / 0.011 + 3.0 * field.slow(u, v * 6.0, 0.4));
        let tone = 0.22 * field.normal(0, 0);
        self.mixed((0.35 + 0.16 * rings + tone).clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLACK: Albedo = [0.0; 3];
    const GREY: Albedo = [0.5; 3];

    #[test]
    fn stripes_have_their_period() {
        let paint = Paint {
            ink: GREY,
            texture: Texture::Stripes { period_m: 0.02, upright: true },
            ..Paint::plain(BLACK)
        };
        let seen: Vec<Albedo> = [0.005, 0.015, 0.025, -0.005].map(|u| paint.albedo([u, 9.0])).into();
        assert_eq!(seen, [GREY, BLACK, GREY, BLACK]);
    }

    #[test]
    fn every_texture_returns_no_more_light_than_falls_on_it() {
        for texture in [
            Texture::Plain,
            Texture::Print { seed: 3 },
            Texture::Wood { seed: 3, board_m: 0.1 },
            Texture::Band { low_m: 0.0, high_m: 0.02, upright: true },
            Texture::Label { seed: 3, half_m: [0.03, 0.02] },
            Texture::Gradient { length_m: 0.1 },
            Texture::Tiles { seed: 3, side_m: 0.05 },
            Texture::Checks { period_m: 0.03 },
            Texture::Clouds { seed: 3, cell_m: 0.02 },
            Texture::Stains { seed: 3, side_m: 0.1 },
        ] {
            let paint = Paint { ink: [0.1, 1.0, 0.2], texture, ..Paint::plain([0.9, 0.5, 0.0]) };
            let mut colors = Vec::new();
            for i in 0..10_000 {
                let albedo =
                    paint.albedo([f64::from(i % 100) * 0.003 - 0.1, f64::from(i / 100) * 0.003 - 0.2]);
                assert!(albedo.iter().all(|c| (0.0..=1.0).contains(c)), "{albedo:?}");
                colors.push(albedo.map(f64::to_bits));
            }
            colors.sort_unstable();
            colors.dedup();
            assert_eq!(colors.len() == 1, matches!(texture, Texture::Plain));
        }
    }
}
