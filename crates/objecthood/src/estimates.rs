//! What a frame shows about its sensor and about gravity, for the next frame.

use crate::noise::{MeasuredNoise, Noise};

/// The running mean goes over about this many frames.
const MOST_FRAMES: u32 = 10;

/// What frames tell of their sensor and of gravity. [`Frame::with_estimates`](crate::Frame::with_estimates) hands it on to the next
/// frame of the same camera.
///
/// The noise of one frame scatters by some per cent with what it shows; the mean over frames scatters less. The direction up decides
/// where the next frame does not show clearly which surface is its ground.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Estimates {
    /// The noise of the sensor: the mean of its logarithm over about ten frames.
    pub noise: Noise,
    /// The frames in that mean, at most 10; 0 when no frame told of the noise.
    pub frames: u32,
    /// The direction against gravity, a unit vector in the camera frame; `None` when no frame told it clearly.
    pub up: Option<[f32; 3]>,
}

impl Estimates {
    /// Estimates of nothing but the noise, a mean over so many frames.
    pub fn of_noise(noise: Noise, frames: u32) -> Self {
        Self { noise, frames, up: None }
    }

    /// The noise after one more frame.
    pub(crate) fn after(&self, measured: &MeasuredNoise) -> Self {
        if !measured.has_waves() {
            return *self;
        }
        let frames = (self.frames + 1).min(MOST_FRAMES);
        let noise = measured.beside(&self.noise, |_| 1.0 / f64::from(frames));
        Self { noise, frames, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Reading;

    #[test]
    fn the_mean_of_the_first_frames_is_that_of_all_and_later_ones_count_a_tenth() {
        let measured = |value: f64| MeasuredNoise {
            white: None,
            blocks_quanta: [Some(Reading { value, samples: 100 }); 3],
        };
        let none = Estimates::of_noise(Noise::KINECT, 0);
        let first = none.after(&measured(0.1));
        assert!((first.noise.blocks_quanta[1] - 0.1).abs() < 1e-12 && first.frames == 1, "{first:?}");
        let second = first.after(&measured(0.4));
        assert!((second.noise.blocks_quanta[1] - 0.2).abs() < 1e-12, "{second:?}");
        assert_eq!(second.after(&MeasuredNoise::default()), second);
        let many = (0..40).fold(second, |mean, _| mean.after(&measured(0.4)));
        assert!(many.frames == 10 && (many.noise.blocks_quanta[1] - 0.4).abs() < 0.02, "{many:?}");
        assert_eq!(many.noise.white, 1.0);
    }
}
