//! Labels the pixels of each surface (docs/CONTEXT.md 1.1.2).

use glam::DVec3;
use rayon::prelude::*;

use super::stretches::{STRETCH, Stretches, range_in_row};
use super::surface::StructureSurface;
use super::tilt::{Alike, Tilt, squared_between};
use crate::buffers::Buffer;
use crate::raster::{Raster, marked};
use crate::regions::Segments;
use crate::simd::vectorized;
use crate::surface::window_choice::Orientation;

/// Labels every pixel with the first surface that lies within `tolerance_quanta` of it and has its tilt; -1 = none. A pixel without
/// a normal needs no equal tilt. O(pixels · surfaces); parallel over rows.
pub(super) fn label_pixels(
    surfaces: &[StructureSurface],
    disparity: &Raster<f32>,
    stretches: &Stretches,
    orientation: &Orientation,
    alike: &Alike,
    tolerance_quanta: f64,
) -> Raster<i32> {
    let width = disparity.width();
    let mut labels = Buffer::filled(disparity.len(), Segments::NONE);
    let label_row = |unsure: &mut Vec<i32>, (v, labels): (usize, &mut [i32])| {
        let row = v * width..(v + 1) * width;
        let (disparity, slopes) =
            (&disparity.as_slice()[row.clone()], &orientation.slope.as_slice()[row.clone()]);
        for (s, surface) in surfaces.iter().enumerate() {
            let is_any_unsure = vectorized(
                #[inline(always)]
                || {
                    let mut is_any_unsure = false;
                    let pixels = labels.chunks_mut(STRETCH).zip(unsure.chunks_mut(STRETCH));
                    let seen = disparity.chunks(STRETCH).zip(slopes.chunks(STRETCH));
                    for ((left, range), ((labels, unsure), (disparity, slopes))) in
                        stretches.of_row(v).zip(pixels.zip(seen))
                    {
                        let quanta = surface.scale * tolerance_quanta;
                        if surface.is_far([left, v], unsure.len(), range, quanta) {
                            unsure.fill(0);
                            continue;
                        }
                        surface.mark_near(labels, disparity, [left, v], quanta, unsure);
                        if unsure.iter().fold(0, |any, near| any | near) != 0 {
                            let slope_squared = alike.slope_squared * surface.scale * surface.scale;
                            surface.claim(s, labels, slopes, [left, v], slope_squared, unsure);
                            is_any_unsure |= unsure.iter().fold(0, |any, near| any | near) != 0;
                        }
                    }
                    is_any_unsure
                },
            );
            for u in marked(if is_any_unsure { unsure } else { &[] }) {
                let tilt = Tilt::at(row.start + u, orientation);
                let slope = surface.model.slope([u as f64, v as f64]);
                let own = Tilt { normal: surface.normal, slope };
                if tilt.normal == DVec3::ZERO || alike.are(&own, &tilt, surface.scale) {
                    labels[u] = s as i32;
                }
            }
        }
    };
    labels.par_chunks_mut(width).enumerate().for_each_init(|| vec![0; width], label_row);
    disparity.with_data(labels)
}

impl StructureSurface {
    /// Whether no pixel of a stretch lies near this surface. (u, v): its first pixel; `least` and `greatest`: its disparities.
    #[inline(always)]
    fn is_far(&self, [u, v]: [usize; 2], pixels: usize, [least, greatest]: [f64; 2], quanta: f64) -> bool {
        let value = |u: f64| self.model.value([u, v as f64]);
        let [low, high] = range_in_row(value, self.model.bend_in_rows(), u, pixels);
        low - greatest >= quanta || least - high >= quanta
    }

    /// Marks the unlabelled pixels near this surface. (u, v): the first pixel.
    #[inline(always)]
    fn mark_near(
        &self,
        labels: &[i32],
        disparity: &[f32],
        [u, v]: [usize; 2],
        quanta: f64,
        near: &mut [i32],
    ) {
        for (u, ((near, label), d)) in (u as i32..).zip(near.iter_mut().zip(labels).zip(disparity)) {
            let misfit = f64::from(*d) - self.model.value([u.into(), v as f64]);
            *near = i32::from((misfit.abs() < quanta) & (*label < 0));
        }
    }

    /// Labels the marked pixels whose slope agrees with the surface's, and removes their marks. `slope_squared`: the squared tolerance.
    #[inline(always)]
    fn claim(
        &self,
        label: usize,
        labels: &mut [i32],
        slopes: &[[f32; 2]],
        [u, v]: [usize; 2],
        slope_squared: f64,
        near: &mut [i32],
    ) {
        for (u, ((near, own), slope)) in (u as i32..).zip(near.iter_mut().zip(labels).zip(slopes)) {
            let steepness = self.model.slope([u.into(), v as f64]);
            let is_alike = squared_between(steepness, slope.map(f64::from)) < slope_squared;
            *own = if (*near != 0) & is_alike { label as i32 } else { *own };
            *near &= i32::from(!is_alike);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::surface::disparity::position;
    use crate::surface::model::Basis;
    use crate::surface::moments::Moments;
    use crate::testing::raster;

    proptest! {
        #[test]
        fn each_pixel_is_of_the_first_surface_it_lies_on(
            pixels in (1_usize..3 * STRETCH / 2, 1_usize..4).prop_flat_map(|size| raster(size, (
                // Disparities near the surfaces below, or none.
                prop_oneof![9 => 97.0_f32..106.0, 1 => Just(f32::NAN)],
                prop::array::uniform2(-0.4_f32..0.4),
                // Orientations like those of the surfaces, others, or none.
                prop::sample::select(vec![[0.0, 0.0, -1.0], [0.0, -0.6, -0.8], [1.0, 0.0, 0.0], [0.0; 3]]),
            ))),
            slope_squared in 0.0_f64..0.2,
            far_stretch in 0_usize..3,
        ) {
            let of_stretch = |i: usize| position(i, pixels.width())[0] as usize / STRETCH;
            let far = |i: usize| if of_stretch(i) == far_stretch { 60.0 } else { 0.0 };
            let seen = (0..pixels.len()).map(|i| pixels[i].0 + far(i)).collect();
            let disparity = pixels.with_data(seen);
            let orientation = Orientation { slope: pixels.map(|p| p.1), normal: pixels.map(|p| p.2) };
            let surface = |middle: f64, normal: [f64; 3]| {
                let mut moments = Moments::about([0.0; 2]);
                for at in [[0.0, 0.0], [40.0, 0.0], [0.0, 4.0]] {
                    moments.add(at, middle + 0.1 * at[0] - 0.05 * at[1]);
                }
                let model = moments.fit(Basis::Plane).model;
                StructureSurface { model, normal: normal.into(), offset_m: 1.0, scale: 1.0 }
            };
            let surfaces = [surface(100.0, [0.0, 0.0, -1.0]), surface(103.0, [0.0, -0.6, -0.8])];
            let alike = Alike { least_cosine: 0.9, slope_squared };
            let labels = label_pixels(&surfaces, &disparity, &Stretches::of(&disparity), &orientation, &alike, 2.0);
            let width = disparity.width();
            for i in 0..disparity.len() {
                let at = position(i, width);
                let tilt = Tilt::at(i, &orientation);
                let lies_on = |s: &StructureSurface| {
                    let own = Tilt { normal: s.normal, slope: s.model.slope(at) };
                    (f64::from(disparity[i]) - s.model.value(at)).abs() < 2.0
                        && (tilt.normal == DVec3::ZERO || alike.are(&own, &tilt, s.scale))
                };
                let expected = surfaces.iter().position(lies_on).map_or(-1, |s| s as i32);
                prop_assert_eq!(labels[i], expected);
            }
        }
    }
}
