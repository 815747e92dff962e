//! The noise that a frame shows, and how it is combined with what was known before (docs/CONTEXT.md 0.5).

use super::{KINECT_QUANTA, Noise};

/// Readings of noise below this share of a Kinect's count as this share in means of logarithms: depth without noise shows none.
const LEAST_SHARE: f64 = 1e-3;

/// A number that was read from a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// The number.
    pub value: f64,
    /// The samples that it was read from: pairs of blocks, or residuals.
    pub samples: usize,
}

/// The noise that a frame shows. Each part is `None` where too little of the frame is measured to tell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeasuredNoise {
    /// Standard deviation of single pixels, relative to a Kinect v1.
    pub white: Option<Reading>,
    /// Disagreement (quanta) of neighbouring blocks of 8, 16 and 32 px at a focal length of 525 px.
    pub blocks_quanta: [Option<Reading>; 3],
}

impl MeasuredNoise {
    /// The noise by this frame alone. A size of blocks that tells nothing follows the next smaller size as on a Kinect; where none
    /// tells, a Kinect is assumed.
    pub fn alone(&self) -> Noise {
        let mut last = 1.0;
        let blocks_quanta = std::array::from_fn(|k| {
            last = self.blocks_quanta[k].map_or(last, |reading| reading.value / KINECT_QUANTA[k]);
            last * KINECT_QUANTA[k]
        });
        Noise { white: self.white.map_or(1.0, |reading| reading.value), blocks_quanta }
    }

    /// The mean of the logarithms of the noise known before and of this frame's. What the frame does not tell stays as it was known.
    /// `weight`: the weight of a reading in the mean, from 0 to 1.
    pub fn beside(&self, known: &Noise, weight: impl Fn(&Reading) -> f64) -> Noise {
        let mean = |known: f64, reading: Option<Reading>, kinect: f64| {
            let Some(reading) = reading else { return known };
            let [before, now] =
                [known, reading.value].map(|value| libm::log(value.max(LEAST_SHARE * kinect)));
            libm::exp(before + weight(&reading) * (now - before))
        };
        Noise {
            white: mean(known.white, self.white, 1.0),
            blocks_quanta: std::array::from_fn(|k| {
                mean(known.blocks_quanta[k], self.blocks_quanta[k], KINECT_QUANTA[k])
            }),
        }
    }

    /// Whether the frame tells of the waves of its surfaces.
    pub fn has_waves(&self) -> bool {
        self.blocks_quanta.iter().any(Option::is_some)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(value: f64) -> Option<Reading> {
        Some(Reading { value, samples: 300 })
    }

    #[test]
    fn what_a_frame_does_not_tell_stays_as_it_was_known() {
        let known = Noise { white: 2.0, blocks_quanta: [0.5, 0.4, 0.3] };
        assert_eq!(MeasuredNoise::default().beside(&known, |_| 1.0), known);
        assert!(!MeasuredNoise::default().has_waves());
        let small = MeasuredNoise { white: reading(1.0), blocks_quanta: [reading(0.125), None, None] };
        let mean = small.beside(&known, |reading| reading.samples as f64 / 600.0);
        assert!((mean.white - 2.0_f64.sqrt()).abs() < 1e-12 && (mean.blocks_quanta[0] - 0.25).abs() < 1e-12);
        assert_eq!(mean.blocks_quanta[1..], [0.4, 0.3]);
    }

    #[test]
    fn depth_without_noise_leaves_numbers_in_the_mean() {
        let none = MeasuredNoise { white: reading(0.0), blocks_quanta: [reading(0.0); 3] };
        let mean = (0..20).fold(none.alone(), |mean, _| none.beside(&mean, |_| 0.1));
        let least = [mean.white, mean.blocks_quanta[0], mean.blocks_quanta[2]];
        assert!(least.iter().all(|number| (0.0..2e-3).contains(number)), "{mean:?}");
    }
}
