//! Clips in which no thing moves.

use crate::family::setting::TABLE_M;
use crate::family::tables;
use crate::random::Rng;
use crate::video::camera::CameraPath;
use crate::video::draft::{Draft, REACH};
use crate::video::script::{Agent, Script};
use crate::video::walker::Walker;
use glam::DVec3;

/// Things on a table, and a camera that is carried around them.
pub(super) fn seen_around(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    let count = 4 + rng.below(5);
    tables::tabletop(rng, &mut draft.layout, count, REACH);
    if rng.chance(0.4) {
        tables::stacked(rng, &mut draft.layout);
    }
    let during_s = rng.range(3.0..5.0);
    let target_m = [0.0, 0.0, TABLE_M + 0.05];
    let camera = CameraPath::carried(rng, draft.viewpoint.pose, target_m, during_s);
    (!draft.layout.placed().is_empty()).then(|| draft.lasting(during_s, camera))
}

/// A table with nothing on it; the camera stands or is carried.
pub(super) fn empty(rng: &mut Rng) -> Script {
    let draft = Draft::new(rng);
    let pose = draft.viewpoint.pose;
    let during_s = rng.range(3.0..4.0);
    let camera = if rng.chance(0.5) {
        CameraPath::Still(pose)
    } else {
        CameraPath::carried(rng, pose, [0.0, 0.0, TABLE_M], during_s)
    };
    draft.lasting(during_s, camera)
}

/// Someone walks by between the table and the wall behind it.
pub(super) fn walked_by(rng: &mut Rng) -> Script {
    let mut draft = Draft::new(rng);
    draft.bystanders(rng, 4);
    let table = &draft.layout.solids[draft.layout.table()];
    let behind = table.support(DVec3::Y) + rng.range(0.26..0.36);
    let (side, speed) = (rng.pick(&[-1.0, 1.0]), rng.range(0.7..1.3));
    let from = DVec3::new(-1.5 * side, behind, 0.0);
    let walker = Walker::new(rng, from, DVec3::X * side * speed);
    draft.add_agent(Agent::Walker(walker));
    let camera = CameraPath::Still(draft.viewpoint.pose);
    draft.lasting(3.0 / speed + 0.2, camera)
}
