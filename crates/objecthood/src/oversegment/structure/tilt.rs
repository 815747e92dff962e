//! The tilt of surfaces, and which tilts count as equal (docs/CONTEXT.md 1.1.1 and 1.1.2).

use glam::{DVec3, Vec3};

use crate::surface::window_choice::Orientation;

/// The tilt of a surface at a pixel.
pub(super) struct Tilt {
    /// Unit normal, towards the camera; zero where it is not known.
    pub(super) normal: DVec3,
    /// Change of disparity along u and v (quanta/px).
    pub(super) slope: [f64; 2],
}

impl Tilt {
    pub(super) fn at(i: usize, orientation: &Orientation) -> Self {
        let normal = Vec3::from(orientation.normal[i]).as_dvec3();
        Self { normal, slope: orientation.slope[i].map(f64::from) }
    }
}

/// The tolerances within which two tilts count as equal: either their normals or their slopes differ little.
///
/// Normals distinguish the sides of low objects from the table below. Where depth is coarse, noise turns normals by any angle: with
/// normals alone a wall 2 m away broke into pieces. The noise of slopes in disparity is the same at any distance.
pub(super) struct Alike {
    /// Least cosine of the angle between the normals.
    pub(super) least_cosine: f64,
    /// Limit on the squared difference of the slopes ((quanta/px)^2).
    pub(super) slope_squared: f64,
}

impl Alike {
    /// Whether two tilts count as equal. `scale`: factor on the tolerance of the slopes.
    pub(super) fn are(&self, a: &Tilt, b: &Tilt, scale: f64) -> bool {
        a.normal.dot(b.normal) > self.least_cosine
            || squared_between(a.slope, b.slope) < self.slope_squared * scale * scale
    }
}

/// Squared length of the difference of two slopes.
#[inline(always)]
pub(super) fn squared_between(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = [0, 1].map(|k| a[k] - b[k]);
    x * x + y * y
}

/// The least number whose square root is not below `length`. Comparing squares with it gives the same as comparing lengths with
/// `length`.
pub(super) fn least_square(length: f64) -> f64 {
    let mut square = length * length;
    while square.next_down().sqrt() >= length {
        square = square.next_down();
    }
    while square.sqrt() < length {
        square = square.next_up();
    }
    square
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn squares_below_the_least_are_those_of_shorter_lengths(length in 0.0_f64..3.0, steps in -4_i64..5) {
            let near = f64::from_bits(((length * length).to_bits() as i64).saturating_add(steps).max(0) as u64);
            prop_assert_eq!(near < least_square(length), near.sqrt() < length);
        }
    }
}
