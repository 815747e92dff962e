//! Directions along a plane.

use glam::DVec3;

/// Two unit vectors along the plane with this unit normal, at right angles; the first is parallel to the image plane.
pub(crate) fn tangents(normal: DVec3) -> [DVec3; 2] {
    let along = DVec3::new(normal.y, -normal.x, 0.0).try_normalize().unwrap_or(DVec3::X);
    [along, normal.cross(along)]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn tangents_lie_in_the_plane(normal in prop::array::uniform3(-1.0_f64..1.0)) {
            for normal in [DVec3::from(normal).normalize_or(DVec3::Z), DVec3::Z, DVec3::NEG_Y] {
                let [s, t] = tangents(normal);
                let dots = [s.dot(t), s.dot(normal), t.dot(normal), s.length() - 1.0, t.length() - 1.0];
                prop_assert!(dots.iter().all(|dot| dot.abs() < 1e-9), "{normal}: {s} {t}");
            }
        }
    }
}
