//! The places in colour space that part the colours of a facet in two.

use glam::{DMat3, Vec3};

use crate::color::{CONTRAST, mean};
use crate::linear::principal_axes;

/// Parts colours by a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Split {
    /// Across the plane.
    axis: Vec3,
    threshold: f32,
}

impl Split {
    #[inline]
    pub(super) fn is_above(&self, color: Vec3) -> bool {
        self.axis.dot(color) > self.threshold
    }
}

/// The best split along each principal axis of the colours, if its sides differ by [`CONTRAST`] or more.
/// Things of several colours need not differ most along the axis of greatest variance. Axes along which no two
/// sides can differ so much are left out: the smaller side is expected to have `least_share` of the colours or
/// more. O(n log n).
pub(super) fn find_splits(colors: &[Vec3], least_share: f32) -> Vec<Split> {
    let middle = mean(colors.iter().copied());
    let mut covariance = DMat3::ZERO;
    for color in colors {
        let from = (*color - middle).as_dvec3();
        covariance += DMat3::from_cols(from * from.x, from * from.y, from * from.z);
    }
    covariance /= colors.len().max(1) as f64;
    // The variance between the sides, which is a part of the whole variance.
    let least_variance = f64::from(least_share * (1.0 - least_share) * CONTRAST * CONTRAST);
    let total = covariance.x_axis.x + covariance.y_axis.y + covariance.z_axis.z;
    if total < least_variance {
        return Vec::new();
    }
    let axes = principal_axes(covariance).into_iter().filter(|(variance, _)| *variance >= least_variance);
    axes.filter_map(|(_, axis)| split_along(colors, axis.as_vec3())).collect()
}

/// The threshold of greatest variance between both sides (Otsu 1979).
fn split_along(colors: &[Vec3], axis: Vec3) -> Option<Split> {
    let mut places: Vec<f32> = colors.iter().map(|color| axis.dot(*color)).collect();
    places.sort_unstable_by(f32::total_cmp);
    let total: f32 = places.iter().sum();
    let (mut below, mut most, mut best) = (0.0, 0.0, None);
    for k in 1..places.len() {
        below += places[k - 1];
        let [n_below, n_above] = [k, places.len() - k].map(|n| n as f32);
        let apart = (total - below) / n_above - below / n_below;
        let variance = n_below * n_above * apart * apart;
        if variance > most {
            most = variance;
            best = Some((apart, f32::midpoint(places[k - 1], places[k])));
        }
    }
    let (apart, threshold) = best?;
    (apart >= CONTRAST).then_some(Split { axis, threshold })
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Vec3 = Vec3::new(30.0, 50.0, 20.0);
    const BLUE: Vec3 = Vec3::new(20.0, 0.0, -40.0);

    #[test]
    fn two_colours_are_parted_between_them() {
        let colors: Vec<Vec3> = (0..90).map(|k| if k % 3 == 0 { RED } else { BLUE }).collect();
        let splits = find_splits(&colors, 0.1);
        assert_eq!(splits.len(), 1, "the other axes see one place");
        assert_ne!(splits[0].is_above(RED), splits[0].is_above(BLUE));
    }

    #[test]
    fn one_colour_with_noise_is_not_parted() {
        let noise = |k: usize| Vec3::new((k % 7) as f32, (k % 5) as f32, (k % 3) as f32);
        assert_eq!(find_splits(&(0..200).map(|k| RED + noise(k)).collect::<Vec<_>>(), 0.1), []);
        assert_eq!(find_splits(&[], 0.1), []);
        assert_eq!(find_splits(&[RED], 0.1), []);
    }

    /// A striped thing on a plain one: the stripes differ most.
    #[test]
    fn an_axis_of_less_variance_parts_a_striped_thing_from_another() {
        let [white, black, red] = [Vec3::X * 60.0, Vec3::ZERO, Vec3::new(30.0, 40.0, 0.0)];
        let colors: Vec<Vec3> = (0..300).map(|k| [white, black, red][k % 3]).collect();
        let parts_red = |split: &Split| {
            split.is_above(white) == split.is_above(black) && split.is_above(white) != split.is_above(red)
        };
        assert!(find_splits(&colors, 0.1).iter().any(parts_red));
    }
}
