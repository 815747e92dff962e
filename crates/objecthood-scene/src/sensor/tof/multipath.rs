//! Light that comes by way of another surface: the longer path makes concave corners round.
//!
//! A pixel's range is the mean over its paths, weighted by their light: the shift of a phase by paths that are much shorter
//! than the modulation's wave. Paths have one bounce more than the direct one. The lamp sits in the lens, so what lights a
//! surface is what the camera sees of it. Surfaces return light evenly (Lambert).

use std::f64::consts::TAU;

use glam::DVec3;
use rayon::prelude::*;

use crate::random::Field;
use crate::ray::Ray;
use crate::view::View;
use crate::world::{SKIN_M, Sight, World};

/// Paths that are followed from a place, and how far (m): beyond that hardly any light comes back.
const PATHS: i64 = 24;
const REACH_M: f64 = 1.0;
/// The error changes slowly, so it is found once in so many pixels of a row and of a column, and averaged over the
/// surface around.
const CELL_PX: usize = 4;
const AROUND_CELLS: usize = 2;
/// What lights a surface less than this hardly returns light at all.
const DARK: f64 = 1e-6;

/// How much the depth (m) of every pixel is too long.
pub(super) fn errors_m(world: &World, view: &View) -> Vec<f64> {
    let field = Field::new(world.noise_seed(), 43);
    let own = |i: usize| {
        let sight = view.sights[i].as_ref()?;
        Some((
            sight.surface,
            error_m(world, sight, field, ((i % view.width) as i64, (i / view.width) as i64)),
        ))
    };
    let columns = view.width.div_ceil(CELL_PX);
    let rows = view.height.div_ceil(CELL_PX);
    let middle = |cell: usize, size: usize| (cell * CELL_PX + CELL_PX / 2).min(size - 1);
    let cell =
        |k: usize| own(middle(k / columns, view.height) * view.width + middle(k % columns, view.width));
    let cells: Vec<Option<(u16, f64)>> = (0..columns * rows).into_par_iter().map(cell).collect();

    let pixel = |i: usize| {
        let Some(sight) = &view.sights[i] else { return 0.0 };
        let (x, y) = (i % view.width / CELL_PX, i / view.width / CELL_PX);
        let (mut sum, mut count) = (0.0, 0.0);
        for row in y.saturating_sub(AROUND_CELLS)..(y + AROUND_CELLS + 1).min(rows) {
            for column in x.saturating_sub(AROUND_CELLS)..(x + AROUND_CELLS + 1).min(columns) {
                if let Some((_, error)) = cells[row * columns + column].filter(|c| c.0 == sight.surface) {
                    sum += error;
                    count += 1.0;
                }
            }
        }
        if count > 0.0 { sum / count } else { own(i).map_or(0.0, |(_, error)| error) }
    };
    (0..view.sights.len()).into_par_iter().map(pixel).collect()
}

/// Follows paths from a place in directions spread by the cosine law.
fn error_m(world: &World, sight: &Sight, field: Field, (u, v): (i64, i64)) -> f64 {
    let eye = world.viewpoint().pose.origin;
    let (own, range) = lit(eye, sight);
    if own < DARK {
        return 0.0;
    }
    let (a, b) = sight.normal.any_orthonormal_pair();
    let mut alone = vec![0; world.solids().len()];
    let (mut light, mut longer) = (0.0, 0.0);
    for k in 0..PATHS {
        let radius = ((k as f64 + field.unit(u * 64 + k, v)) / PATHS as f64).sqrt();
        let (sin, cos) = libm::sincos(TAU * field.unit(u * 64 + 32 + k, v));
        let up = (1.0 - radius * radius).sqrt();
        let direction = a * (radius * cos) + b * (radius * sin) + sight.normal * up;
        let ray = Ray { origin: sight.point + sight.normal * SKIN_M, direction };
        let Some(other) = world.first(ray, &mut alone).filter(|other| other.t < REACH_M) else { continue };
        if world.sees(other.point, other.normal, eye) {
            let (its, its_range) = lit(eye, &other);
            let share = world.albedo(&other).iter().sum::<f64>() / 3.0 * its / own / PATHS as f64;
            light += share;
            longer += share * (its_range + other.t - range) / 2.0;
        }
    }
    longer / (1.0 + light) * sight.t / range
}

/// Light of the lamp on a surface, 1 at 1 m where it faces the lamp; and the distance (m).
fn lit(eye: DVec3, sight: &Sight) -> (f64, f64) {
    let toward = eye - sight.point;
    let range = toward.length();
    (sight.normal.dot(toward).max(0.0) / (range * range * range), range)
}
