//! What a structured-light camera makes of a picture: steps of disparity and the projector's shadow.

use super::canvas::{Canvas, NOTHING};

/// Steps of disparity to a pixel of the device (Konolige and Mihelich 2010).
const STEPS_PER_PX: f64 = 8.0;

/// The measured depth of every pixel (m): the disparity in whole quanta; `NaN` where there is nothing and where the projector,
/// to the right of the camera, does not reach. O(pixels).
///
/// Seen from the projector a pixel lies to the left of where it is by its disparity, d / 8 px; a pixel is lit if it is
/// farther left than all that are to its right.
pub(super) fn measured_m(canvas: &Canvas, quantum_per_m: f64) -> Vec<f32> {
    let mut measured = vec![f32::NAN; canvas.depth_m.len()];
    let rows = canvas.depth_m.chunks(canvas.width).zip(canvas.instance.chunks(canvas.width));
    for ((depths, instances), measured) in rows.zip(measured.chunks_mut(canvas.width)) {
        let mut leftmost_px = f64::INFINITY;
        for (u, ((&depth_m, &instance), measured)) in
            depths.iter().zip(instances).zip(measured).enumerate().rev()
        {
            if depth_m.is_infinite() {
                continue;
            }
            let disparity = 1.0 / (depth_m * quantum_per_m);
            let from_projector_px = u as f64 - disparity / STEPS_PER_PX;
            let is_lit = from_projector_px <= leftmost_px;
            leftmost_px = leftmost_px.min(from_projector_px);
            if is_lit && instance != NOTHING {
                *measured = (1.0 / (disparity.round() * quantum_per_m)) as f32;
            }
        }
    }
    measured
}

#[cfg(test)]
mod tests {
    use objecthood::Camera;

    use super::*;
    use crate::composer::canvas::TABLE;

    const QUANTUM_PER_M: f64 = 0.00285;

    /// A wall at 1.4 m; in columns 300..340 a board at 0.7 m, which is the object 2.
    fn board_and_wall() -> Canvas {
        let is_board = |u: usize| (300..340).contains(&u);
        let camera = Camera::new(525.0, 525.0, 319.5, 239.5).unwrap();
        Canvas {
            width: 640,
            camera,
            depth_m: (0..640).map(|u| if is_board(u) { 0.7 } else { 1.4 }).collect(),
            color: vec![[0; 3]; 640],
            instance: (0..640).map(|u| TABLE + u16::from(is_board(u))).collect(),
        }
    }

    #[test]
    fn the_shadow_is_as_wide_as_the_step_of_disparity() {
        let measured = measured_m(&board_and_wall(), QUANTUM_PER_M);
        let dark: Vec<usize> = (0..640).filter(|&u| measured[u].is_nan()).collect();
        let width_px = (1.0 / 0.7 - 1.0 / 1.4) / QUANTUM_PER_M / 8.0;
        assert!((dark.len() as f64 - width_px).abs() <= 1.0, "{} px but {width_px}", dark.len());
        assert_eq!(
            (dark.last(), dark.len()),
            (Some(&299), 300 - dark[0]),
            "on the left of the board, and nowhere else"
        );
    }

    #[test]
    fn disparity_comes_in_whole_quanta() {
        for z in measured_m(&board_and_wall(), QUANTUM_PER_M).into_iter().filter(|z| !z.is_nan()) {
            let quanta = 1.0 / (f64::from(z) * QUANTUM_PER_M);
            assert!((quanta - quanta.round()).abs() < 1e-4, "{quanta}");
        }
    }

    #[test]
    fn what_is_unknown_hides_but_is_not_measured() {
        let mut canvas = board_and_wall();
        canvas.instance[310] = NOTHING;
        let measured = measured_m(&canvas, QUANTUM_PER_M);
        assert!(measured[310].is_nan() && !measured[309].is_nan() && !measured[311].is_nan());
    }
}
