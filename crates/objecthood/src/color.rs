//! CIE L\*a\*b\* of sRGB pixels.

pub mod histogram;
pub mod image;

use std::sync::LazyLock;

use glam::Vec3;

/// Linear light of the 256 sRGB values, in [0, 1] (IEC 61966-2-1).
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|value| {
        let c = value as f64 / 255.0;
        let linear = if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) };
        linear as f32
    })
});

/// CIE L\*a\*b\* under D65, 2 degree observer: L in 0..100, a and b about -128..128.
pub fn lab(rgb: [u8; 3]) -> [f32; 3] {
    lab_by(linear(rgb), libm::cbrtf)
}

/// Weight of lightness in the difference of two colours: light and shading change it more than chroma.
const LIGHTNESS: f32 = 0.6;
/// L\* plus this, a\* and b\* all scale with the cube root of the light (CIE 1976).
pub(crate) const LIGHT_OFFSET: f32 = 16.0;

/// The difference of two colours (L\*a\*b\*), lightness weighted less.
#[inline]
pub(crate) fn difference(one: [f32; 3], other: [f32; 3]) -> f32 {
    let [l, a, b]: [f32; 3] = std::array::from_fn(|k| one[k] - other[k]);
    ((LIGHTNESS * l).powi(2) + a * a + b * b).sqrt()
}

/// Colours differ from this difference on (L\*a\*b\*, lightness weighted): print and light change even faces by less.
pub(crate) const CONTRAST: f32 = 12.0;
/// A difference from this on is wholly clear (L\*a\*b\*, lightness weighted).
pub(crate) const CLEAR_CONTRAST: f64 = 40.0;

/// A darker colour is no shadow of another from this difference from it in less light on (ΔE of chroma): lamp and room light differ a little in
/// colour.
pub(crate) const LEAST_UNLIKE_SHADOW: f64 = 8.0;

/// Difference of a darker colour from another in less light: light that falls scales L + 16, a and b alike. Infinite where it is not
/// darker.
pub(crate) fn unlike_shadow(color: [f32; 3], lit: [f32; 3]) -> f64 {
    if color[0] >= lit[0] {
        return f64::INFINITY;
    }
    let dimming = (color[0] + LIGHT_OFFSET) / (lit[0] + LIGHT_OFFSET);
    let [a, b] = [1, 2].map(|k| f64::from(color[k] - dimming * lit[k]));
    (a * a + b * b).sqrt()
}

/// The difference of the darker of two colours from the other in less light (ΔE of chroma): 0 for paint and its shadow.
pub(crate) fn unlike_in_light(one: Vec3, other: Vec3) -> f64 {
    let (dark, lit) = if one.x < other.x { (one, other) } else { (other, one) };
    unlike_shadow(dark.into(), lit.into())
}

/// The mean of colours; 0 of none.
pub(crate) fn mean(colors: impl Iterator<Item = Vec3>) -> Vec3 {
    let (sum, count) = colors.fold((Vec3::ZERO, 0.0), |(sum, count), color| (sum + color, count + 1.0));
    sum / f32::max(count, 1.0)
}

/// A colour (L\*a\*b\*) as a place whose distance to another is their [`difference`].
pub(crate) fn weighted([l, a, b]: [f32; 3]) -> Vec3 {
    Vec3::new(LIGHTNESS * l, a, b)
}

/// Linear light, in [0, 1].
#[inline]
pub(crate) fn linear(rgb: [u8; 3]) -> [f32; 3] {
    let light = light_of_values();
    rgb.map(|value| light[usize::from(value)])
}

/// The linear light of each value of a channel, for loops that look up many.
pub(crate) fn light_of_values() -> &'static [f32; 256] {
    &LINEAR
}

/// As [`lab`], from [`linear`] light and to within [`NEARLY_LAB_ERROR`]. Many times faster: it has no branch, so vector units convert
/// many pixels at once.
#[inline(always)]
pub(crate) fn nearly_lab(linear: [f32; 3]) -> [f32; 3] {
    lab_by(linear, nearly_cube_root)
}

/// Bound on the difference between [`nearly_lab`] and [`lab`]: the error of a cube root is below 1e-6, and a is 500 times the
/// difference of two cube roots.
pub(crate) const NEARLY_LAB_ERROR: f32 = 0.002;

/// The cube root to within a few units in the last place.
#[inline(always)]
fn nearly_cube_root(t: f32) -> f32 {
    // Dividing the bits by 3 gives the root to within 4 %; each step of Halley's method leaves less than the cube of the error.
    let mut root = f32::from_bits(t.to_bits() / 3 + 0x2a51_19f2);
    for _ in 0..2 {
        let cube = root * root * root;
        root *= (cube + 2.0 * t) / (2.0 * cube + t);
    }
    root
}

/// L\*a\*b\* of linear light, with the given cube root.
#[inline(always)]
fn lab_by([r, g, b]: [f32; 3], cube_root: impl Fn(f32) -> f32) -> [f32; 3] {
    // The function f of CIE 15: a cube root, and a straight line near zero.
    const KNEE: f32 = 216.0 / 24389.0;
    let f = |t: f32| if t > KNEE { cube_root(t) } else { (24389.0 / 27.0 * t + 16.0) / 116.0 };
    // Rows: X, Y, Z relative to the white point 0.95047, 1, 1.08883.
    let fx = f((0.412_456_4 * r + 0.357_576_1 * g + 0.180_437_5 * b) / 0.950_47);
    let fy = f(0.212_672_9 * r + 0.715_152_2 * g + 0.072_175 * b);
    let fz = f((0.019_333_9 * r + 0.119_192 * g + 0.950_304_1 * b) / 1.088_83);
    [116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)]
}

#[cfg(test)]
mod tests {
    use palette::{IntoColor, Lab, Srgb};

    use super::*;

    #[test]
    fn agrees_with_palette() {
        for r in (0..=255).step_by(15) {
            for g in (0..=255).step_by(15) {
                for b in (0..=255).step_by(15) {
                    let [l, a, b_] = lab([r, g, b]);
                    let oracle: Lab = Srgb::new(r, g, b).into_format::<f32>().into_color();
                    let difference =
                        (l - oracle.l).abs().max((a - oracle.a).abs()).max((b_ - oracle.b).abs());
                    assert!(difference < 0.02, "{r} {g} {b}: {:?} against {oracle:?}", [l, a, b_]);
                }
            }
        }
    }

    #[test]
    fn what_is_nearly_lab_is_within_its_error() {
        let every_fifth = || (0..=255).step_by(5);
        for (r, g) in every_fifth().flat_map(|r| every_fifth().map(move |g| (r, g))) {
            for b in 0..=255 {
                let errors =
                    lab([r, g, b]).into_iter().zip(nearly_lab(linear([r, g, b]))).map(|(x, y)| (x - y).abs());
                assert!(errors.fold(0.0, f32::max) < NEARLY_LAB_ERROR, "{r} {g} {b}");
            }
        }
    }
}
