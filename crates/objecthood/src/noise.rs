//! The sensor's noise, and the factors by which tolerances follow it (docs/CONTEXT.md 0.5).

mod measured;
mod prior;

pub use measured::{MeasuredNoise, Reading};
pub(crate) use prior::KINECT_RESIDUAL_QUANTA;

/// Sides of the blocks (px at a focal length of 525 px).
pub(crate) const SIDES_PX: [usize; 3] = [8, 16, 32];
/// Disagreement of neighbouring blocks of these sides on a Kinect v1 (quanta), measured on mOSD learn.
pub(crate) const KINECT_QUANTA: [f64; 3] = [0.285, 0.21, 0.15];
/// A sensor whose waves are this many times a Kinect's counts as a Kinect: the surfaces of things raise the estimate as much.
const DEAD_BAND: std::ops::RangeInclusive<f64> = 0.9..=1.5;
/// Tolerances follow the waves with this exponent, because a part of every tolerance is misfit of the model and no noise ...
const WAVES_EXPONENT: f64 = 0.7;
/// ... and never fall below this share.
const LEAST_SCALE: f64 = 0.6;
/// Share of the white noise in the tolerances of structure, which compares single pixels with a surface.
const WHITE_SHARE: f64 = 0.7;
/// The spread of a surface exceeds a Kinect's by at most this many times the waves.
const SPREAD_OF_WAVES: f64 = 1.5;
/// Waves count this many times in the tolerance of a merge ...
const MERGE_SIGMAS: f64 = 5.0;
/// ... beside the misfit of the model (quanta), the tolerance on a Kinect.
const MISFIT_QUANTA: f64 = 1.2;
/// Least share of the tolerance of a merge that is left on a sensor better than a Kinect.
const LEAST_MERGE_SCALE: f64 = 0.32;
/// Sensors that match windows have larger waves than this, relative to a Kinect ...
const MATCHED_WAVES: f64 = 1.8;
/// ... and their waves exceed a Kinect's by this factor more than their blocks of 8 px do. A coarse image has large waves too, but then all
/// blocks disagree more alike.
const MATCHED_GROWTH: f64 = 1.8;

/// The noise of a depth sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation of single pixels, relative to a Kinect v1.
    pub white: f64,
    /// Disagreement (quanta) of neighbouring blocks of 8, 16 and 32 px at a focal length of 525 px.
    pub blocks_quanta: [f64; 3],
}

impl Noise {
    /// A Kinect v1, for which the parameters hold.
    pub const KINECT: Self = Self { white: 1.0, blocks_quanta: KINECT_QUANTA };

    /// Waves of 16 to 40 px, relative to a Kinect v1.
    pub fn waves(&self) -> f64 {
        self.blocks_quanta[1] / KINECT_QUANTA[1]
    }

    /// The same; 1 for a sensor that may be a Kinect.
    pub(crate) fn sure_waves(&self) -> f64 {
        let waves = self.waves();
        if DEAD_BAND.contains(&waves) { 1.0 } else { waves }
    }

    /// Whether its waves are larger than those of a sensor that may be a Kinect.
    pub(crate) fn is_wavy(&self) -> bool {
        self.sure_waves() > 1.0
    }

    /// Whether the sensor matches windows, as stereo does: its waves are large, and larger than its noise over 8 px tells.
    pub(crate) fn is_matched(&self) -> bool {
        let short = self.blocks_quanta[0] / KINECT_QUANTA[0];
        self.waves() > MATCHED_WAVES && self.waves() > MATCHED_GROWTH * short
    }

    /// Factor on tolerances of steps between fits: 1 for a Kinect and for noisier sensors, less for better ones. A larger factor loses
    /// shallow valleys, and with them objects.
    pub(crate) fn step_scale(&self) -> f64 {
        libm::pow(self.sure_waves(), WAVES_EXPONENT).clamp(LEAST_SCALE, 1.0)
    }

    /// Factor on tolerances between single pixels and a surface.
    pub(crate) fn pixel_scale(&self) -> f64 {
        self.step_scale().max(WHITE_SHARE * self.white).clamp(LEAST_SCALE, 1.0)
    }

    /// The most that the spread of a surface may exceed a Kinect's because of waves.
    pub(crate) fn most_spread(&self) -> f64 {
        (SPREAD_OF_WAVES * self.sure_waves()).max(1.0)
    }

    /// Factor on the tolerance with which two regions are merged. `side_px`: the root of the pixels of the smaller one, at a focal length
    /// of 525 px.
    ///
    /// Waves add in quadrature to the misfit of the model. The disagreement at a fold grows with the size of the faces, that of waves
    /// does not; so the factor falls with the size.
    pub(crate) fn merge_scale(&self, side_px: f64) -> f64 {
        if self.sure_waves() == 1.0 {
            return 1.0;
        }
        let place = (libm::log2(side_px / SIDES_PX[0] as f64)).clamp(0.0, 2.0);
        let (k, share) = if place < 1.0 { (0, place) } else { (1, place - 1.0) };
        let at = |quanta: &[f64; 3]| quanta[k] + share * (quanta[k + 1] - quanta[k]);
        let excess = at(&self.blocks_quanta).powi(2) - at(&KINECT_QUANTA).powi(2);
        let square = 1.0 + (MERGE_SIGMAS / MISFIT_QUANTA).powi(2) * excess;
        square.max(LEAST_MERGE_SCALE * LEAST_MERGE_SCALE).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kinect_stays_as_it_is_and_factors_stay_within_their_limits() {
        let of_waves =
            |waves: f64| Noise { white: 1.0, blocks_quanta: KINECT_QUANTA.map(|quanta| waves * quanta) };
        for waves in [0.95, 1.0, 1.4] {
            let noise = of_waves(waves);
            assert_eq!([noise.step_scale(), noise.pixel_scale(), noise.merge_scale(20.0)], [1.0; 3]);
        }
        for waves in [0.0, 0.5, 2.0, 5.0, 50.0] {
            let noise = of_waves(waves);
            assert!((LEAST_SCALE..=1.0).contains(&noise.step_scale()), "{waves}");
            assert!(noise.merge_scale(8.0) >= LEAST_MERGE_SCALE, "{waves}");
            assert_eq!(noise.merge_scale(16.0) > 1.0, waves > 1.5, "{waves}");
        }
    }
}
