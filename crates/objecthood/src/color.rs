//! CIE L\*a\*b\* of sRGB pixels.

use std::sync::LazyLock;

/// Linear light of the 256 sRGB values, in [0, 1] (IEC 61966-2-1).
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|value| {
        let c = value as f64 / 255.0;
        let linear = if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) };
        linear as f32
    })
});

/// CIE L\*a\*b\* under D65, 2 degree observer: L in 0..100, a and b about -128..128.
pub fn lab([r, g, b]: [u8; 3]) -> [f32; 3] {
    lab_by([r, g, b], lightness)
}

/// As [`lab`], but for [`NEARLY_LAB_ERROR`], and many times faster: cube roots are read from a table.
pub(crate) fn nearly_lab(rgb: [u8; 3]) -> [f32; 3] {
    let table = &*LIGHTNESS;
    lab_by(rgb, |t| {
        let place = t * CELLS as f32;
        let cell = (place as u32 as usize).min(CELLS - 1);
        table[cell] + (place - cell as f32) * (table[cell + 1] - table[cell])
    })
}

/// No value of [`nearly_lab`] is farther than this from that of [`lab`]: between two entries of the table the cube root
/// departs from a straight line by at most 5e-6, and a is 500 times the difference of two of them.
pub(crate) const NEARLY_LAB_ERROR: f32 = 0.01;

/// Cells of the table of [`lightness`] over [0, 1].
const CELLS: usize = 4096;

static LIGHTNESS: LazyLock<[f32; CELLS + 1]> =
    LazyLock::new(|| std::array::from_fn(|k| lightness(k as f32 / CELLS as f32)));

/// The function f of CIE 15: a cube root, straight near zero.
fn lightness(t: f32) -> f32 {
    const KNEE: f32 = 216.0 / 24389.0;
    if t > KNEE { libm::cbrtf(t) } else { (24389.0 / 27.0 * t + 16.0) / 116.0 }
}

#[inline]
fn lab_by([r, g, b]: [u8; 3], f: impl Fn(f32) -> f32) -> [f32; 3] {
    let linear = &*LINEAR;
    let (r, g, b) = (linear[usize::from(r)], linear[usize::from(g)], linear[usize::from(b)]);
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
                    lab([r, g, b]).into_iter().zip(nearly_lab([r, g, b])).map(|(x, y)| (x - y).abs());
                assert!(errors.fold(0.0, f32::max) < NEARLY_LAB_ERROR, "{r} {g} {b}");
            }
        }
    }
}
