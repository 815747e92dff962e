//! The noise of a kind of sensor, from its published figures (docs/CONTEXT.md 0.6).

use super::{Noise, SIDES_PX};

/// Median residual of a plane in a window of 7 x 7 px on a Kinect v1 (quanta), measured on mOSD learn.
pub(crate) const KINECT_RESIDUAL_QUANTA: f64 = 0.525;
/// First quartile of the sum of squares of three normal values.
const QUARTILE_OF_THREE: f64 = 1.2125;

impl Noise {
    /// The noise of a sensor whose pixels deviate by `deviation_quanta` from the truth. `correlation_px`: values d px apart have the
    /// correlation exp(-d² / (4 `correlation_px`²)), at a focal length of 525 px; 0 = none.
    ///
    /// Two blocks disagree in three ways: by a step, by a fold, and by a twist. The disagreement is the root of the mean square of
    /// these, and its quartile that of three normal values. O(sides²).
    pub(crate) fn of_sensor(deviation_quanta: f64, correlation_px: f64) -> Self {
        let blocks_quanta = SIDES_PX.map(|side| deviation_quanta * disagreement(side, correlation_px));
        Self { white: deviation_quanta / KINECT_RESIDUAL_QUANTA, blocks_quanta }
    }
}

/// First quartile of the disagreement of neighbouring blocks of this side, for noise of deviation 1.
fn disagreement(side: usize, correlation_px: f64) -> f64 {
    let place = |k: usize, size: usize| k as f64 - (size as f64 - 1.0) / 2.0;
    let along: Vec<f64> = (0..2 * side).map(|k| place(k, 2 * side)).collect();
    let across: Vec<f64> = (0..side).map(|k| place(k, side)).collect();
    let sign: Vec<f64> = along.iter().map(|x| x.signum()).collect();
    // A plane through both blocks takes the slope out of the step, and the mean out of the fold.
    let slope = dot(&sign, &along) / dot(&along, &along);
    let step: Vec<f64> = sign.iter().zip(&along).map(|(sign, x)| sign - slope * x).collect();
    let fold: Vec<f64> = along.iter().map(|x| x.abs() - side as f64 / 2.0).collect();
    let even = vec![1.0; side];
    let of = |x: &[f64], y: &[f64]| variance(x, correlation_px) * variance(y, correlation_px);
    let sum = of(&step, &even) + of(&fold, &even) + of(&sign, &across);
    let pixels = (side * side) as f64;
    (2.0 / pixels * QUARTILE_OF_THREE * sum / 3.0).sqrt()
}

/// Variance of the mean of correlated noise of deviation 1 under these weights, as if their squares summed to 1.
fn variance(weights: &[f64], correlation_px: f64) -> f64 {
    let correlation = |lag: usize| {
        if lag == 0 {
            1.0
        } else {
            libm::exp(-((lag * lag) as f64) / (4.0 * correlation_px * correlation_px))
        }
    };
    let products = |lag: usize| dot(weights, &weights[lag..]) * if lag == 0 { 1.0 } else { 2.0 };
    let sum: f64 = (0..weights.len()).map(|lag| correlation(lag) * products(lag)).sum();
    sum / dot(weights, weights)
}

/// Sum of products, as far as both reach.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What blocks of noise disagree by, drawn at random: the table of docs/CONTEXT.md 0.6.
    #[test]
    fn the_disagreement_is_that_of_drawn_noise() {
        for (correlation_px, expected) in [
            (0.0, [0.195, 0.097, 0.049]),
            (1.5, [0.590, 0.404, 0.231]),
            (3.5, [0.472, 0.604, 0.448]),
            (6.0, [0.246, 0.530, 0.584]),
        ] {
            let Noise { blocks_quanta, .. } = Noise::of_sensor(1.0, correlation_px);
            for (quanta, expected) in blocks_quanta.into_iter().zip(expected) {
                assert!((quanta - expected).abs() < 0.001, "{correlation_px}: {blocks_quanta:?}");
            }
        }
    }
}
