//! How hands and walkers move: from posture to posture, smoothly.

use glam::{DQuat, DVec3};

use crate::pose::Pose;

/// How a hand is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Posture {
    pub(crate) pose: Pose,
    /// Between the pads of thumb and fingers (m).
    pub(crate) opening_m: f64,
}

/// A motion as a function of time: postures that are reached one after the other.
///
/// Between two of them everything follows the polynomial of least jerk, 10 u³ - 15 u⁴ + 6 u⁵, as human hands do (Flash and
/// Hogan, *The coordination of arm movements*, 1985). O(legs) a look.
#[derive(Clone, Debug)]
pub(crate) struct Path {
    start: Posture,
    legs: Vec<Leg>,
}

#[derive(Clone, Debug)]
struct Leg {
    from_s: f64,
    until_s: f64,
    way: Way,
    to: Posture,
}

#[derive(Clone, Debug)]
enum Way {
    /// Along a line, turning about one axis.
    Straight,
    /// About a line through a point.
    Swing { point: DVec3, axis: DVec3, angle_deg: f64 },
}

impl Path {
    pub(crate) fn from(start: Posture) -> Self {
        Self { start, legs: Vec::new() }
    }

    /// Where it ends.
    pub(crate) fn end(&self) -> Posture {
        self.legs.last().map_or(self.start, |leg| leg.to)
    }

    /// When it ends (s).
    pub(crate) fn end_s(&self) -> f64 {
        self.legs.last().map_or(0.0, |leg| leg.until_s)
    }

    /// Stays where it is.
    pub(crate) fn wait(&mut self, during_s: f64) {
        let to = self.end();
        self.push(during_s, Way::Straight, to);
    }

    /// Goes on to another pose.
    pub(crate) fn go(&mut self, during_s: f64, pose: Pose) {
        let to = Posture { pose, ..self.end() };
        self.push(during_s, Way::Straight, to);
    }

    /// Moves without turning.
    pub(crate) fn shift(&mut self, during_s: f64, by: DVec3) {
        let pose = self.end().pose;
        self.go(during_s, Pose { origin: pose.origin + by, ..pose });
    }

    /// Opens or closes the hand.
    pub(crate) fn grip(&mut self, during_s: f64, opening_m: f64) {
        let to = Posture { opening_m, ..self.end() };
        self.push(during_s, Way::Straight, to);
    }

    /// Turns about a line, counterclockwise seen against its direction.
    pub(crate) fn swing(&mut self, during_s: f64, point: DVec3, axis: DVec3, angle_deg: f64) {
        let from = self.end();
        let to = Posture { pose: swung(from.pose, point, axis, angle_deg), ..from };
        self.push(during_s, Way::Swing { point, axis, angle_deg }, to);
    }

    fn push(&mut self, during_s: f64, way: Way, to: Posture) {
        let from_s = self.end_s();
        self.legs.push(Leg { from_s, until_s: from_s + during_s, way, to });
    }

    /// The posture at a time; before and after the path its first and last.
    pub(crate) fn at(&self, time_s: f64) -> Posture {
        let mut from = self.start;
        for leg in &self.legs {
            if time_s < leg.until_s {
                let share = least_jerk(((time_s - leg.from_s) / (leg.until_s - leg.from_s)).clamp(0.0, 1.0));
                let pose = match leg.way {
                    Way::Straight => between(&from.pose, &leg.to.pose, share),
                    Way::Swing { point, axis, angle_deg } => swung(from.pose, point, axis, angle_deg * share),
                };
                let opening_m = from.opening_m + (leg.to.opening_m - from.opening_m) * share;
                return Posture { pose, opening_m };
            }
            from = leg.to;
        }
        from
    }
}

/// From 0 to 1 with velocity and acceleration 0 at both ends.
pub(crate) fn least_jerk(u: f64) -> f64 {
    u * u * u * (10.0 + u * (6.0 * u - 15.0))
}

/// A pose turned about a line of the world.
pub(crate) fn swung(pose: Pose, point: DVec3, axis: DVec3, angle_deg: f64) -> Pose {
    let about = Pose::along([0.0; 3], axis.into());
    let back = Pose { rotation: about.rotation.transpose(), origin: DVec3::ZERO };
    let turn = about.turned(2, angle_deg).after(&back);
    Pose { rotation: turn.rotation * pose.rotation, origin: point + turn.rotation * (pose.origin - point) }
}

/// The pose at a share of the way from one to another.
fn between(from: &Pose, to: &Pose, share: f64) -> Pose {
    let origin = from.origin + (to.origin - from.origin) * share;
    if from.rotation == to.rotation {
        return Pose { origin, ..*from };
    }
    let turn = DQuat::from_mat3(&(to.rotation * from.rotation.transpose()));
    let turn = if turn.w < 0.0 { -turn } else { turn };
    let axis = DVec3::new(turn.x, turn.y, turn.z);
    let angle_deg = 2.0 * libm::atan2(axis.length(), turn.w).to_degrees();
    let turned = swung(Pose { origin: DVec3::ZERO, ..*from }, DVec3::ZERO, axis, angle_deg * share);
    Pose { rotation: turned.rotation, origin }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start() -> Posture {
        Posture { pose: Pose::at([0.1, 0.2, 0.3]).turned(0, 20.0), opening_m: 0.05 }
    }

    #[test]
    fn a_path_passes_its_postures_at_rest() {
        let mut path = Path::from(start());
        path.wait(0.5);
        path.go(1.0, Pose::at([0.5, 0.2, 0.1]).turned(2, 80.0));
        path.grip(0.2, 0.02);
        path.swing(0.8, DVec3::new(0.0, 0.0, 0.1), DVec3::Y, 90.0);
        for (time_s, speed) in [(0.5, 0.0), (1.5, 0.0), (1.7, 0.0), (2.5, 0.0), (1.0, 0.4)] {
            let [a, b] = [time_s - 1e-4, time_s + 1e-4].map(|t| path.at(t).pose.origin);
            let seen = (b - a).length() / 2e-4;
            assert!(if speed == 0.0 { seen < 1e-3 } else { seen > speed }, "{time_s}: {seen}");
        }
        let end = path.at(9.0).pose;
        assert!((end.origin - path.end().pose.origin).length() < 1e-12);
        assert!((end.origin - DVec3::new(0.0, 0.2, -0.4)).length() < 1e-12, "{}", end.origin);
        assert_eq!(path.at(2.0).opening_m, 0.02);
    }

    #[test]
    fn poses_between_are_rotations() {
        let (from, to) = (start().pose, Pose::at([1.0, 0.0, 0.0]).turned(2, 170.0).turned(1, 40.0));
        for k in 0..=10 {
            let pose = between(&from, &to, f64::from(k) / 10.0);
            assert!((pose.rotation.determinant() - 1.0).abs() < 1e-12);
        }
        let end = between(&from, &to, 1.0);
        assert!((end.rotation - to.rotation).abs_diff_eq(glam::DMat3::ZERO, 1e-12));
    }
}
