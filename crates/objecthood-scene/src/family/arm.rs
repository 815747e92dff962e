//! The arm of a robot over a table with things.

use glam::DVec3;

use super::furniture::{bar, board};
use super::setting::{self, TABLE_M};
use super::{tables, views};
use crate::place::Layout;
use crate::pose::Pose;
use crate::random::Rng;
use crate::shape::{Revolved, Shape};
use crate::solid::{Part, Role, Solid};
use crate::texture::Paint;
use crate::thing;
use crate::world::Viewpoint;

/// Radii of base, upper arm, forearm and wrist; of the joints, which the links end in (m).
const BASE_M: f64 = 0.07;
const LINKS_M: [f64; 3] = [0.042, 0.034, 0.028];
const JOINTS_M: [f64; 3] = [0.06, 0.05, 0.04];

/// An arm that stands at the back of the table and reaches over three to seven things. Each link is a solid, so that
/// things may stand below it.
pub(super) fn over_table(rng: &mut Rng) -> (Layout, Viewpoint) {
    let viewpoint = views::at_table(rng);
    let mut layout = setting::with_table(rng, false);
    let side = rng.pick(&[-1.0, 1.0]);
    let base = DVec3::new(side * rng.range(0.30..0.48), rng.range(0.24..0.32), TABLE_M);
    let shoulder = base + DVec3::Z * rng.range(0.14..0.20);
    let tool = DVec3::new(rng.range(-0.16..0.16), rng.range(-0.12..0.08), TABLE_M + rng.range(0.12..0.22));
    let wrist = tool + DVec3::Z * 0.13;
    let elbow = (shoulder + wrist) / 2.0 + DVec3::Z * rng.range(0.12..0.20);
    let paint = Paint::plain(rng.pick(&[[0.72, 0.72, 0.72], [0.75, 0.33, 0.04], [0.12, 0.12, 0.13]]));

    let column = Shape::Revolved(Revolved::cylinder(BASE_M, shoulder.z - base.z));
    layout.furnish(link(Part { shape: column, pose: Pose::at(base.into()), paints: vec![paint] }));
    let joints = [shoulder, elbow, wrist, tool];
    for k in 0..3 {
        let (from, to) = (joints[k], joints[k + 1]);
        layout.furnish(link(bar(LINKS_M[k], from.into(), to.into(), paint)));
        let joint = Shape::Revolved(Revolved::ball(JOINTS_M[k]));
        let pose = Pose::at((from - DVec3::Z * JOINTS_M[k]).into());
        layout.furnish(link(Part { shape: joint, pose, paints: vec![Paint::plain([0.2, 0.2, 0.22])] }));
    }
    layout.furnish(gripper(rng, tool));
    let count = 3 + rng.below(5);
    tables::tabletop(rng, &mut layout, count, tables::MIDDLE);
    (layout, viewpoint)
}

/// A piece of an arm, given in the frame of the world.
fn link(part: Part) -> Solid {
    let paint = part.paints[0];
    let mut link = thing::block("arm", Role::Furniture, [0.1; 3], paint);
    link.parts = vec![part];
    link
}

/// A palm and two fingers that point down.
fn gripper(rng: &mut Rng, tool: DVec3) -> Solid {
    let (dark, apart) = (Paint::plain([0.1, 0.1, 0.11]), rng.range(0.02..0.045));
    let mut gripper = link(board([0.12, 0.05, 0.03], [0.0, 0.0, -0.03], dark));
    for side in [-1.0, 1.0] {
        gripper.parts.push(board([0.012, 0.022, 0.05], [side * apart, 0.0, -0.07], Paint::plain([0.5; 3])));
    }
    gripper.at(Pose::at(tool.into()).turned(2, rng.range(0.0..180.0)))
}
