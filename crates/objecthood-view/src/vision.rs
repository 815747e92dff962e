//! How colours look: to whom they look alike, and how bright they are.

use image::Rgb;

/// A colour as `OKLab` of what trichromats, protanopes and deuteranopes see.
pub(crate) type Seen = [[f32; 3]; 3];

/// How a colour looks.
pub(crate) fn seen(color: Rgb<u8>) -> Seen {
    let light = color.0.map(linear);
    [light, through(&PROTANOPE, light), through(&DEUTERANOPE, light)].map(ok_lab)
}

/// How far apart two colours look to the eye that tells them apart worst; 0.02 is just noticeable.
pub(crate) fn difference(a: &Seen, b: &Seen) -> f32 {
    let squared = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum();
    a.iter().zip(b).map(squared).fold(f32::INFINITY, f32::min).sqrt()
}

/// Contrast of two colours in [1, 21], WCAG 2.1: text is well read from 4.5 on.
pub(crate) fn contrast(a: Rgb<u8>, b: Rgb<u8>) -> f32 {
    let (a, b) = (luminance(a) + 0.05, luminance(b) + 0.05);
    a.max(b) / a.min(b)
}

/// What dichromats see of a colour, in linear sRGB: Machado, Oliveira and Fernandes, "A physiologically-based model
/// for simulation of color vision deficiency", IEEE TVCG 15(6), 2009, severity 1.
const PROTANOPE: [[f32; 3]; 3] =
    [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]];
const DEUTERANOPE: [[f32; 3]; 3] =
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]];

fn through(matrix: &[[f32; 3]; 3], x: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2])
}

/// Undoes the gamma of sRGB (IEC 61966-2-1). `libm`, so that the palette is the same on every machine.
fn linear(channel: u8) -> f32 {
    let x = f32::from(channel) / 255.0;
    if x <= 0.04045 { x / 12.92 } else { libm::powf((x + 0.055) / 1.055, 2.4) }
}

/// Relative luminance in [0, 1], WCAG 2.1.
fn luminance(color: Rgb<u8>) -> f32 {
    let [r, g, b] = color.0.map(linear);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Linear sRGB to `OKLab` (B. Ottosson, 2020), in which equal distances look equal.
fn ok_lab(rgb: [f32; 3]) -> [f32; 3] {
    const LMS: [[f32; 3]; 3] = [
        [0.412_221_46, 0.536_332_55, 0.051_445_995],
        [0.211_903_5, 0.680_699_5, 0.107_396_96],
        [0.088_302_46, 0.281_718_85, 0.629_978_7],
    ];
    const LAB: [[f32; 3]; 3] = [
        [0.210_454_26, 0.793_617_8, -0.004_072_047],
        [1.977_998_5, -2.428_592_2, 0.450_593_7],
        [0.025_904_037, 0.782_771_77, -0.808_675_77],
    ];
    through(&LAB, through(&LMS, rgb).map(libm::cbrtf))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oklab_agrees_with_its_definition() {
        // From B. Ottosson's table: D65 white is (1, 0, 0); sRGB red is (0.628, 0.225, 0.126).
        for (rgb, lab) in [([255; 3], [1.0, 0.0, 0.0]), ([255, 0, 0], [0.628, 0.225, 0.126])] {
            let ours = ok_lab(rgb.map(linear));
            assert!(ours.iter().zip(lab).all(|(x, y): (&f32, f32)| (x - y).abs() < 1e-3), "{ours:?}");
        }
        // Dichromats see greys as they are.
        for matrix in [PROTANOPE, DEUTERANOPE] {
            assert!(through(&matrix, [0.5; 3]).iter().all(|x| (x - 0.5).abs() < 1e-5));
        }
    }

    #[test]
    fn the_worst_eye_decides() {
        let (red, green) = (seen(Rgb([200, 60, 40])), seen(Rgb([110, 110, 30])));
        let normal: f32 = (0..3).map(|k| (red[0][k] - green[0][k]).powi(2)).sum::<f32>().sqrt();
        assert!(normal > 0.15 && difference(&red, &green) < 0.07, "{normal} {}", difference(&red, &green));
        assert_eq!(difference(&red, &red), 0.0);
    }

    #[test]
    fn black_on_white_has_the_greatest_contrast() {
        assert!((contrast(Rgb([0; 3]), Rgb([255; 3])) - 21.0).abs() < 1e-3);
        assert_eq!(contrast(Rgb([9; 3]), Rgb([9; 3])), 1.0);
    }
}
