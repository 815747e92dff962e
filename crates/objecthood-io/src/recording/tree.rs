//! Frames of reference that do not move against each other: `tf_static`.

use std::collections::{BTreeMap, VecDeque};

use super::messages::Transform;
use super::rigid::Rigid;
use crate::capture::Pose;

/// Frames whose z axis points up, by REP 103 and REP 105. The camera's own frames are not among them: they tilt with it.
const UPRIGHT: [&[u8]; 5] = [b"world", b"map", b"odom", b"base_footprint", b"base_link"];

/// Which frame lies where in which others, both ways.
#[derive(Default)]
pub(super) struct Tree(BTreeMap<Vec<u8>, Vec<(Vec<u8>, Rigid)>>);

impl Tree {
    /// ROS 1 wrote a slash before names.
    fn name(frame: &[u8]) -> &[u8] {
        frame.strip_prefix(b"/").unwrap_or(frame)
    }

    pub(super) fn add(&mut self, transform: &Transform) {
        let Transform { parent, child, parent_from_child } = transform;
        let (parent, child) = (Self::name(parent).to_vec(), Self::name(child).to_vec());
        self.0.entry(child.clone()).or_default().push((parent.clone(), *parent_from_child));
        self.0.entry(parent).or_default().push((child, parent_from_child.inverse()));
    }

    /// Where frame `of` lies in frame `to`, if a way leads there: of several the shortest.
    pub(super) fn between(&self, to: &[u8], of: &[u8]) -> Option<Rigid> {
        let (to, of) = (Self::name(to), Self::name(of));
        let mut seen = BTreeMap::from([(of.to_vec(), Rigid::IDENTITY)]);
        let mut next = VecDeque::from([of.to_vec()]);
        while let Some(frame) = next.pop_front() {
            let here_from_of = *seen.get(&frame)?;
            if frame == to {
                return Some(here_from_of);
            }
            for (other, other_from_here) in self.0.get(&frame).into_iter().flatten() {
                if !seen.contains_key(other) {
                    seen.insert(other.clone(), other_from_here.after(here_from_of));
                    next.push_back(other.clone());
                }
            }
        }
        None
    }

    /// Where a camera is in a world whose z axis points up, if the frames say so.
    pub(super) fn upright(&self, camera: &[u8]) -> Option<Pose> {
        let world_from_camera = UPRIGHT.iter().find_map(|world| self.between(world, camera))?;
        let Rigid { rotation, translation } = world_from_camera;
        Some(Pose { position_m: translation.to_array(), rotation_xyzw: rotation.to_array() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transform(parent: &str, child: &str, x_m: f64) -> Transform {
        let turn = std::f64::consts::FRAC_1_SQRT_2;
        let parent_from_child = Rigid::new([x_m, 0.0, 0.0], [0.0, 0.0, turn, turn]).unwrap();
        Transform { parent: parent.into(), child: child.into(), parent_from_child }
    }

    #[test]
    fn a_way_leads_up_and_down_the_tree() {
        let mut tree = Tree::default();
        tree.add(&transform("base_link", "mast", 1.0));
        tree.add(&transform("/mast", "depth", 2.0));
        tree.add(&transform("mast", "color", 3.0));
        let [x, y, _] = tree.between(b"color", b"depth").unwrap().translation.to_array();
        // The cameras look alike, and the one is a metre before the other along the x axis of the mast.
        assert!(x.abs() < 1e-12 && (y - 1.0).abs() < 1e-12, "{x} {y}");
        let pose = tree.upright(b"depth").unwrap();
        assert!((pose.position_m[0] - 1.0).abs() < 1e-12 && (pose.position_m[1] - 2.0).abs() < 1e-12);
        assert_eq!(tree.between(b"color", b"nowhere"), None);
        assert_eq!(Tree::default().upright(b"depth"), None);
    }
}
