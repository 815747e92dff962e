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
    let [r, g, b] = [r, g, b].map(|c| LINEAR[usize::from(c)]);
    // Rows: X, Y, Z relative to the white point 0.95047, 1, 1.08883.
    let x = (0.412_456_4 * r + 0.357_576_1 * g + 0.180_437_5 * b) / 0.950_47;
    let y = 0.212_672_9 * r + 0.715_152_2 * g + 0.072_175 * b;
    let z = (0.019_333_9 * r + 0.119_192 * g + 0.950_304_1 * b) / 1.088_83;
    let [fx, fy, fz] = [x, y, z].map(|t| {
        const KNEE: f32 = 216.0 / 24389.0;
        if t > KNEE { libm::cbrtf(t) } else { (24389.0 / 27.0 * t + 16.0) / 116.0 }
    });
    [116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)]
}

#[cfg(test)]
mod tests {
    use palette::{IntoColor, Lab, Srgb};

    use super::lab;

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
}
