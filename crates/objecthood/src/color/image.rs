//! The colour of a frame as `context` compares it: L\*a\*b\*, smoothed.

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::color::{linear, nearly_lab};
use crate::raster::Raster;
use crate::simd::vectorized;

/// Converts an sRGB image to L\*a\*b\* (L in 0..100, a and b about -128..128) and smooths it with the weights 1, 2, 1 along both axes.
///
/// Nine pixels take a third of the noise of single pixels away (σ 0.7 px), and an edge stays sharp to 2 px. At the border of the
/// image the border pixel is repeated. Source: ours, because the paper smooths RGB by its own eq. 1, and a comparison of colours
/// needs a space of equal steps. O(pixels); parallel over rows.
pub fn lab_image(color: &Raster<[u8; 3]>) -> Raster<[f32; 3]> {
    let (width, height) = color.size();
    let mut smoothed = Buffer::stale(color.len(), [0.0; 3]);
    smoothed.par_chunks_mut(width).enumerate().for_each_init(
        || vec![[0.0; 3]; width],
        |down, (v, row)| {
            let rows = [v.saturating_sub(1), v, (v + 1).min(height - 1)];
            let [above, own, below] = rows.map(|v| &color.as_slice()[v * width..(v + 1) * width]);
            for (sum, ((a, b), c)) in down.iter_mut().zip(above.iter().zip(own).zip(below)) {
                let [a, b, c] = [a, b, c].map(|rgb| linear(*rgb));
                *sum = std::array::from_fn(|k| 0.25 * (a[k] + 2.0 * b[k] + c[k]));
            }
            vectorized(
                #[inline(always)]
                || {
                    for (u, pixel) in row.iter_mut().enumerate() {
                        let [left, own, right] =
                            [u.saturating_sub(1), u, (u + 1).min(width - 1)].map(|u| down[u]);
                        *pixel =
                            nearly_lab(std::array::from_fn(|k| 0.25 * (left[k] + 2.0 * own[k] + right[k])));
                    }
                },
            );
        },
    );
    color.with_data(smoothed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::lab;

    #[test]
    fn an_even_image_keeps_its_color_and_an_edge_is_two_pixels_wide() {
        let (left, right) = ([200, 30, 60], [20, 90, 160]);
        let pixels = (0..8 * 5).map(|i| if i % 8 < 4 { left } else { right }).collect();
        let image = lab_image(&Raster::from_vec(8, 5, pixels).unwrap());
        for i in 0..40 {
            let distance = |rgb| -> f32 { lab(rgb).iter().zip(image[i]).map(|(x, y)| (x - y).abs()).sum() };
            match i % 8 {
                0..=2 => assert!(distance(left) < 0.01, "{i}"),
                5..=7 => assert!(distance(right) < 0.01, "{i}"),
                _ => assert!(distance(left) > 5.0 && distance(right) > 5.0, "{i}"),
            }
        }
    }
}
