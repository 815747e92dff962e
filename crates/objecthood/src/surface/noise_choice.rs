//! The noise by which tolerances are set: from the frame, and from what is known about its sensor
//! (docs/CONTEXT.md 0.5, 0.6).

use crate::buffers::Buffer;
use crate::estimates::Estimates;
use crate::noise::{MeasuredNoise, Noise};
use crate::params::{NoiseFrom, Sensor};
use crate::quantile::element_at;
use crate::raster::Raster;
use crate::surface::disparity::DisparitySpace;

/// A profile weighs as much as this many samples of a frame.
const PROFILE_SAMPLES: f64 = 100.0;
/// One pixel in this many is read for the median depth, at which a profile is evaluated.
const DEPTH_STEP_PX: usize = 64;
/// Depth at which a profile holds for a frame without any (m).
const USUAL_M: f64 = 1.0;

/// What is known about the noise apart from the frame.
pub(super) struct KnownNoise<'a> {
    source: NoiseFrom,
    earlier: Option<&'a Estimates>,
    profile: Option<Noise>,
}

impl<'a> KnownNoise<'a> {
    /// Collects what the parameters say and what earlier frames showed. O(pixels / 64).
    pub(super) fn of(
        sensor: &Sensor,
        earlier: Option<&'a Estimates>,
        disparity: &Raster<f32>,
        space: &DisparitySpace,
    ) -> Self {
        let earlier = earlier.filter(|earlier| earlier.frames > 0);
        Self { source: sensor.noise, earlier, profile: profile_noise(sensor, disparity, space) }
    }

    /// Chooses the noise: the given one, or that of the frame averaged with earlier frames, or that of the
    /// frame averaged with its sensor's profile.
    pub(super) fn with(&self, measured: &MeasuredNoise) -> Estimates {
        match (self.source, self.earlier) {
            (NoiseFrom::Given, _) => Estimates::of_noise(self.profile.unwrap_or(Noise::KINECT), 0),
            (NoiseFrom::Estimated, Some(earlier)) => earlier.after(measured),
            (NoiseFrom::Estimated, None) => {
                Estimates::of_noise(by_one_frame(measured, self.profile), measured.has_waves().into())
            }
        }
    }
}

/// The noise by one frame and the profile of its sensor. The more the frame shows, the more it overrules the
/// profile.
fn by_one_frame(measured: &MeasuredNoise, profile: Option<Noise>) -> Noise {
    let share = |samples: f64| samples / (samples + PROFILE_SAMPLES);
    profile.map_or_else(
        || measured.alone(),
        |profile| measured.beside(&profile, |reading| share(reading.samples as f64)),
    )
}

/// The noise of the profile at the median depth of a frame.
fn profile_noise(sensor: &Sensor, disparity: &Raster<f32>, space: &DisparitySpace) -> Option<Noise> {
    let figures = sensor.profile.figures()?;
    let sampled = disparity.as_slice().iter().step_by(DEPTH_STEP_PX).copied().map(f64::from);
    let mut sampled: Buffer<f64> = sampled.filter(|d| !d.is_nan()).collect();
    let z_m = if sampled.is_empty() { USUAL_M } else { space.depth_m(element_at(&mut sampled, 0.5)) };
    let deviation_quanta = figures.deviation_m(z_m) / space.step_m(1.0, z_m);
    Some(Noise::of_sensor(deviation_quanta, figures.correlation_px))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Reading;
    use crate::params::Profile;
    use crate::testing::kinect;

    fn noise_at(profile: Profile, z_m: f64) -> Noise {
        let sensor = Sensor::of(profile);
        let disparity = 1.0 / (z_m * sensor.disparity_quantum_per_m);
        profile_noise(&sensor, &Raster::filled(64, 48, disparity as f32).unwrap(), &kinect()).unwrap()
    }

    /// The table of docs/CONTEXT.md 0.6: a Kinect is a Kinect, and the others are as recordings show them.
    #[test]
    fn profiles_have_the_noise_of_their_sensors() {
        let waves = |profile, z_m| noise_at(profile, z_m).waves();
        assert!((0.9..1.1).contains(&waves(Profile::Kinect, 1.0)));
        assert!((waves(Profile::Kinect, 2.5) / waves(Profile::Kinect, 0.7) - 1.0).abs() < 1e-6);
        assert!((1.95..4.5).contains(&waves(Profile::Stereo, 1.0)), "{}", waves(Profile::Stereo, 1.0));
        assert!((0.1..0.2).contains(&waves(Profile::Tof, 1.0)), "{}", waves(Profile::Tof, 1.0));
        assert!((2.0..3.5).contains(&waves(Profile::Phone, 1.0)), "{}", waves(Profile::Phone, 1.0));
        // Time of flight: twice as far, half as much disparity.
        assert!((waves(Profile::Tof, 2.0) / waves(Profile::Tof, 1.0) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn a_frame_overrules_a_profile_when_it_shows_enough() {
        let profile = noise_at(Profile::Stereo, 1.0);
        let noise = |samples| {
            let reading = Some(Reading { value: 0.2, samples });
            by_one_frame(&MeasuredNoise { white: None, blocks_quanta: [reading; 3] }, Some(profile))
        };
        let [few, many] = [50, 5000].map(|samples| noise(samples).blocks_quanta[1]);
        assert!(
            (0.2..0.21).contains(&many) && (0.3..profile.blocks_quanta[1]).contains(&few),
            "{few} {many}"
        );
        assert_eq!(by_one_frame(&MeasuredNoise::default(), Some(profile)), profile);
        assert_eq!(by_one_frame(&MeasuredNoise::default(), None), Noise::KINECT);
    }
}
