//! The parts of the objectness, and their product.

use crate::params;

/// The parts of an objectness, each in [0, 1]: 1 = no evidence against an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectnessParts {
    /// How graspable its size is: not too long, and not thin in two directions.
    pub size: f32,
    /// How surely it is carried: P(O) of eq. 8, halved when the confidence in the carrier is 0.
    pub support: f32,
    /// How surely it stands on the structure, itself or on what carries it: 0 when it is seen to hang in the air.
    pub footing: f32,
    /// The share of its hull in the image that it fills, where nothing hides it.
    pub compactness: f32,
    /// How clear its borders are: steps in depth, valleys, and colours unlike the background's are clear; flat or convex folds are not.
    pub separation: f32,
    /// The share of its outline that is its own: neither something nearer nor the border of the image cuts it there.
    pub visibility: f32,
}

impl ObjectnessParts {
    /// The objectness, in [0, 1]: the product of 1 - weight · (1 - part) over all parts. A part lowers the objectness by at most the share
    /// `weight`: with weight 1 the part is necessary, with weight 0 it is ignored.
    pub fn objectness(&self, params: &params::Objectness) -> f32 {
        let weighted = [
            (params.size_weight, self.size),
            (params.support_weight, self.support),
            (params.footing_weight, self.footing),
            (params.compactness_weight, self.compactness),
            (params.separation_weight, self.separation),
            (params.visibility_weight, self.visibility),
        ];
        weighted.into_iter().map(|(weight, part)| 1.0 - weight * (1.0 - part)).product()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn parts([size, support, footing, compactness, separation, visibility]: [f32; 6]) -> ObjectnessParts {
        ObjectnessParts { size, support, footing, compactness, separation, visibility }
    }

    proptest! {
        /// With any weights, a better part never lowers the objectness.
        #[test]
        fn objectness_is_a_share_and_grows_with_every_part(
            values in prop::array::uniform6(0.0_f32..=1.0),
            weights in prop::array::uniform6(0.0_f32..=1.0),
            better in 0_usize..6,
            gain in 0.0_f32..=1.0,
        ) {
            let [size_weight, support_weight, footing_weight, compactness_weight, separation_weight, visibility_weight] =
                weights;
            let params = params::Objectness {
                size_weight, support_weight, footing_weight, compactness_weight, separation_weight, visibility_weight,
                ..Default::default()
            };
            let before = parts(values).objectness(&params);
            prop_assert!((0.0..=1.0).contains(&before));
            let mut improved = values;
            improved[better] += gain * (1.0 - values[better]);
            prop_assert!(parts(improved).objectness(&params) >= before - 1e-6);
        }
    }

    #[test]
    fn a_part_takes_away_its_weight_at_most() {
        let params = params::Objectness::default();
        assert_eq!(parts([1.0; 6]).objectness(&params), 1.0);
        let weights = [
            params.size_weight,
            params.support_weight,
            params.footing_weight,
            params.compactness_weight,
            params.separation_weight,
            params.visibility_weight,
        ];
        for (k, weight) in weights.into_iter().enumerate() {
            let mut values = [1.0; 6];
            values[k] = 0.0;
            assert_eq!(parts(values).objectness(&params), 1.0 - weight);
        }
    }
}
