//! Convex polygons on the ground: the outline of the table, the footprints of objects.

use glam::DVec2;

/// A convex polygon, counterclockwise (m).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Polygon {
    corners: Vec<DVec2>,
}

impl Polygon {
    /// The convex hull of points (Andrew 1979, monotone chain); `None` if they lie on a line. O(n log n).
    pub(super) fn hull(mut points: Vec<DVec2>) -> Option<Self> {
        points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        let mut corners = chain(points.iter());
        corners.extend(chain(points.iter().rev()));
        (corners.len() > 2).then_some(Self { corners })
    }

    /// Turned about the origin by a rotation (cosine, sine), then moved.
    pub(super) fn placed(&self, rotation: DVec2, shift: DVec2) -> Self {
        Self { corners: self.corners.iter().map(|&p| rotation.rotate(p) + shift).collect() }
    }

    /// The largest gap between the shadows of both on any normal of an edge (separating axes): negative exactly if the
    /// polygons have area in common, else at most their distance (m). O(n m).
    pub(super) fn gap_m(&self, other: &Self) -> f64 {
        self.gap_beyond_edges_m(other).max(other.gap_beyond_edges_m(self))
    }

    fn gap_beyond_edges_m(&self, other: &Self) -> f64 {
        let gaps = self.edges().map(|(corner, outward)| {
            other.corners.iter().map(|&p| (p - corner).dot(outward)).fold(f64::INFINITY, f64::min)
        });
        gaps.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Whether all of `other` lies inside. O(n m).
    pub(super) fn contains(&self, other: &Self) -> bool {
        other.corners.iter().all(|&p| self.holds(p))
    }

    /// Whether the point lies inside. O(n).
    pub(super) fn holds(&self, point: DVec2) -> bool {
        self.edges().all(|(corner, outward)| (point - corner).dot(outward) <= 0.0)
    }

    /// Every edge as its first corner and its unit normal outwards.
    fn edges(&self) -> impl Iterator<Item = (DVec2, DVec2)> {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|(&a, &b)| (a, -(b - a).perp().normalize_or_zero()))
    }
}

/// One side of the hull of sorted points, without its last corner.
fn chain<'a>(points: impl Iterator<Item = &'a DVec2>) -> Vec<DVec2> {
    let mut corners: Vec<DVec2> = Vec::new();
    for &p in points {
        while let [.., a, b] = corners[..]
            && (b - a).perp_dot(p - b) <= 0.0
        {
            corners.pop();
        }
        corners.push(p);
    }
    corners.pop();
    corners
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn square(x: f64, y: f64, half: f64) -> Polygon {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (0.3, 0.2), (-1.0, 0.0)];
        Polygon::hull(corners.map(|(a, b)| DVec2::new(x + half * a, y + half * b)).to_vec()).unwrap()
    }

    #[test]
    fn a_hull_has_no_inner_points_and_a_line_has_no_hull() {
        assert_eq!(square(0.0, 0.0, 1.0).corners.len(), 4);
        assert_eq!(Polygon::hull((0..9).map(|k| DVec2::splat(f64::from(k))).collect()), None);
        assert_eq!(Polygon::hull(vec![DVec2::ONE; 7]), None);
        assert_eq!(Polygon::hull(Vec::new()), None);
    }

    #[test]
    fn gaps_of_squares() {
        let gap = |x, y| square(0.0, 0.0, 1.0).gap_m(&square(x, y, 0.5));
        assert!((gap(2.0, 0.3) - 0.5).abs() < 1e-12);
        assert!((gap(0.0, -1.25) + 0.25).abs() < 1e-12);
        assert!(gap(0.0, 0.0) < -1.0, "{}", gap(0.0, 0.0));
        assert!(square(0.0, 0.0, 1.0).contains(&square(0.5, 0.5, 0.5)));
        assert!(!square(0.0, 0.0, 1.0).contains(&square(0.5, 0.51, 0.5)));
    }

    fn cloud() -> impl Strategy<Value = Vec<DVec2>> {
        prop::collection::vec((-1.0..1.0, -1.0..1.0).prop_map(|(x, y)| DVec2::new(x, y)), 4..12)
    }

    proptest! {
        /// Against all pairs of points: every point lies in the hull, no line between two points leaves it, and each
        /// corner is one that some direction reaches first.
        #[test]
        fn a_hull_is_the_least_that_holds_all(points in cloud()) {
            let hull = Polygon::hull(points.clone()).unwrap();
            for p in &points {
                let inwards = hull.edges().map(|(corner, outward)| (*p - corner).dot(outward)).fold(-1e9, f64::max);
                prop_assert!(inwards < 1e-12);
            }
            for &corner in &hull.corners {
                let rest: Vec<DVec2> = points.iter().copied().filter(|&p| p != corner).collect();
                prop_assert!(Polygon::hull(rest).is_none_or(|rest| !rest.holds(corner)));
            }
        }

        /// Against points strewn over one of the polygons.
        #[test]
        fn polygons_with_a_gap_have_no_point_in_common(
            a in cloud(), b in cloud(), angle in 0.0..6.0_f64, x in -2.0..2.0_f64,
        ) {
            let a = Polygon::hull(a).unwrap();
            let b = Polygon::hull(b).unwrap().placed(DVec2::from_angle(angle), DVec2::new(x, 0.5));
            let gap = a.gap_m(&b);
            prop_assert_eq!(gap, b.gap_m(&a));
            for &p in &a.corners {
                for &q in &a.corners {
                    for k in 0..=20 {
                        let point = p.lerp(q, f64::from(k) / 20.0);
                        prop_assert!(gap <= 0.0 || !b.holds(point));
                    }
                }
            }
            if gap > 0.0 {
                let pairs = a.corners.iter().flat_map(|p| b.corners.iter().map(|q| p.distance(*q)));
                prop_assert!(pairs.fold(f64::INFINITY, f64::min) >= gap - 1e-12);
            }
        }
    }
}
