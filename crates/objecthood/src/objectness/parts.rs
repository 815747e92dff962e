//! Objectness: what its parts are, and how they make one figure.

use crate::params;

/// What an objectness is made of; each in [0, 1], 1 = speaks for an object, or at least not against one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectnessParts {
    /// Whether its longest side has the size of something graspable.
    pub size: f32,
    /// P(O), eq. 8: whether something carries it.
    pub support: f32,
    /// How much of its hull in the image it fills, as far as nothing hides it.
    pub compactness: f32,
    /// How clear its borders are: steps in depth and valleys, not flat or convex folds.
    pub separation: f32,
    /// How much of its outline is its own, and neither something nearer's nor the border of the image.
    pub visibility: f32,
}

impl ObjectnessParts {
    /// The objectness, in [0, 1]: the product of 1 - weight · (1 - part). Each part can take away its weight at most, so a
    /// weight of 1 makes it necessary and 0 leaves it out.
    pub fn objectness(&self, params: &params::Objectness) -> f32 {
        let weighted = [
            (params.size_weight, self.size),
            (params.support_weight, self.support),
            (params.compactness_weight, self.compactness),
            (params.separation_weight, self.separation),
            (params.visibility_weight, self.visibility),
        ];
        weighted.into_iter().map(|(weight, part)| 1.0 - weight * (1.0 - part)).product()
    }
}
