//! The colour picture: shaded, seen through a lens, noisy, in sRGB.

use objecthood::Raster;
use rayon::prelude::*;

use crate::random::Field;
use crate::view::View;
use crate::world::World;

/// What a lens and the interpolation of a Bayer pattern blur a picture by: weights of the pixel and its neighbours.
const BLUR: [f64; 3] = [0.25, 0.5, 0.25];
/// Deviation of a channel (grey levels).
const NOISE: f64 = 1.6;

/// The light of every pixel, blurred and exposed such that the brightest hundredth is just not white.
pub(crate) fn picture(world: &World, view: &View) -> objecthood::Result<Raster<[u8; 3]>> {
    let (width, height) = (view.width, view.height);
    let light = light(world, view);
    let exposure = world.exposure().unwrap_or_else(|| exposure(&light));
    let fields = [51, 52, 53].map(|stream| Field::new(world.noise_seed(), stream));

    let pixel = |i: usize| {
        let (u, v) = (i % width, i / width);
        let mut sum = [0.0; 3];
        for (b, wv) in BLUR.into_iter().enumerate() {
            for (a, wu) in BLUR.into_iter().enumerate() {
                let near = |at: usize, k: usize, size: usize| (at + k).saturating_sub(1).min(size - 1);
                let neighbor = light[near(v, b, height) * width + near(u, a, width)];
                (0..3).for_each(|k| sum[k] += wu * wv * neighbor[k]);
            }
        }
        [0, 1, 2].map(|k| {
            let noise = NOISE * fields[k].normal(u as i64, v as i64);
            (srgb(sum[k] * exposure) * 255.0 + noise).round().clamp(0.0, 255.0) as u8
        })
    };
    Raster::from_vec(width, height, (0..width * height).into_par_iter().map(pixel).collect())
}

/// The exposure that lets the brightest hundredth of a world's picture be just not white.
pub(crate) fn exposure_of(world: &World) -> f64 {
    exposure(&light(world, &View::of(world)))
}

/// What comes from every pixel, linear.
fn light(world: &World, view: &View) -> Vec<[f64; 3]> {
    let pixel = |i: usize| match &view.sights[i] {
        Some(sight) => world.shade(sight, ((i % view.width) as i64, (i / view.width) as i64)),
        None => [0.0; 3],
    };
    (0..view.sights.len()).into_par_iter().map(pixel).collect()
}

fn exposure(light: &[[f64; 3]]) -> f64 {
    let mut green: Vec<f64> = light.iter().map(|rgb| rgb[1]).collect();
    let last = green.len() * 99 / 100;
    let (_, bright, _) = green.select_nth_unstable_by(last, f64::total_cmp);
    0.9 / bright.max(1e-3)
}

/// IEC 61966-2-1.
fn srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 }
}
