//! Fields of noise with a given width of correlation, one value a pixel.

use rayon::prelude::*;

use crate::random::Field;

/// Normal noise, mean 0 and deviation 1, smoothed by a Gaussian of `sigma_px`: values `d` pixels apart have the
/// correlation exp(-d² / (4 sigma²)).
pub(crate) fn smooth(seed: u64, stream: u64, width: usize, height: usize, sigma_px: f64) -> Vec<f64> {
    let field = Field::new(seed, stream);
    let radius = (3.0 * sigma_px).ceil() as usize;
    let mut weights: Vec<f64> = (0..=2 * radius)
        .map(|k| {
            let x = (k as f64 - radius as f64) / sigma_px;
            libm::exp(-x * x / 2.0)
        })
        .collect();
    let norm = weights.iter().map(|w| w * w).sum::<f64>().sqrt();
    weights.iter_mut().for_each(|w| *w /= norm);

    let rows = height + 2 * radius;
    let mut across = vec![0.0; width * rows];
    across.par_chunks_mut(width.max(1)).enumerate().for_each(|(v, row)| {
        let white: Vec<f64> = (0..width + 2 * radius).map(|u| field.normal(u as i64, v as i64)).collect();
        for (u, value) in row.iter_mut().enumerate() {
            *value = weights.iter().zip(&white[u..]).map(|(w, x)| w * x).sum();
        }
    });
    let mut noise = vec![0.0; width * height];
    noise.par_chunks_mut(width.max(1)).enumerate().for_each(|(v, row)| {
        for (k, w) in weights.iter().enumerate() {
            let from = &across[(v + k) * width..][..width];
            row.iter_mut().zip(from).for_each(|(value, x)| *value += w * x);
        }
    });
    noise
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_noise_has_the_stated_correlation() {
        let (width, height, sigma) = (400, 300, 2.0);
        let noise = smooth(5, 0, width, height, sigma);
        let mean_product = |lag: usize| {
            let pairs = (0..height).flat_map(|v| (0..width - lag).map(move |u| v * width + u));
            pairs.map(|i| noise[i] * noise[i + lag]).sum::<f64>() / (height * (width - lag)) as f64
        };
        for lag in [0, 2, 4, 12] {
            let stated = libm::exp(-((lag * lag) as f64) / (4.0 * sigma * sigma));
            assert!(
                (mean_product(lag) - stated).abs() < 0.04,
                "lag {lag}: {} instead of {stated}",
                mean_product(lag)
            );
        }
    }
}
