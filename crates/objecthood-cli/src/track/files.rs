//! The lists that `track` writes: a line of JSON each.

use objecthood_track::{Event, Relation, Rigid, SupportRelation, Tracked};
use serde_json::{Value, json};

/// The lines of all lists.
#[derive(Default)]
pub(super) struct Lines {
    pub(super) tracks: String,
    pub(super) events: String,
    pub(super) support: String,
}

impl Lines {
    /// Adds what is said of a frame.
    pub(super) fn frame(&mut self, tracked: &Tracked) {
        let objects: Vec<_> = tracked
            .objects
            .iter()
            .filter_map(|object| {
                let track = object.track?;
                let area = object.box_px;
                Some(json!({
                    "track": track,
                    "state": object.state,
                    "center_m": object.center_m,
                    "pose": pose(&object.pose),
                    "velocity_m_per_s": object.velocity_m_per_s,
                    "motion": object.motion.map(|motion| json!({
                        "translation_m": motion.rigid.translation_m(),
                        "rotation_xyzw": motion.rigid.rotation_xyzw(),
                        "covariance": motion.covariance,
                        "fit": motion.fit,
                    })),
                    "box_px": [area.u, area.v, area.width, area.height],
                    "box_m": object.box_m.map(|box_m| json!({
                        "center_m": box_m.center_m,
                        "rotation_xyzw": box_m.rotation_xyzw,
                        "extents_m": box_m.extents_m,
                    })),
                    "size_px": object.size_px,
                    "objectness": object.objectness,
                    "parts": object.parts,
                    "held_by": tracked.support.iter().find(|edge| is_held(edge) && edge.child == track).map(|edge| edge.parent),
                    "evidence": object.seen_to,
                }))
            })
            .collect();
        let lost: Vec<_> = tracked
            .lost
            .iter()
            .map(|lost| {
                json!({ "track": lost.track, "state": lost.state, "center_m": lost.center_m, "pose": pose(&lost.pose), "for_s": lost.for_s })
            })
            .collect();
        let agents: Vec<_> = tracked
            .agents
            .iter()
            .map(|agent| {
                let area = agent.box_px;
                json!({ "track": agent.id, "size_px": agent.size_px, "box_px": [area.u, area.v, area.width, area.height] })
            })
            .collect();
        let line = json!({
            "frame": tracked.frame,
            "time": tracked.stamp_s,
            "objects": objects,
            "lost": lost,
            "agents": agents,
            "camera": {
                "translation_m": tracked.world_from_camera.translation_m(),
                "rotation_xyzw": tracked.world_from_camera.rotation_xyzw(),
                "covariance": tracked.camera_covariance,
            },
        });
        push(&mut self.tracks, &line);
        for edge in tracked.support.iter().filter(|edge| !is_held(edge)) {
            let parent = edge.parent.map_or(0, |parent| parent.0);
            let line =
                json!({ "frame": tracked.frame, "child": edge.child, "parent": parent, "kind": edge.kind });
            push(&mut self.support, &line);
        }
        for event in &tracked.events {
            self.event(event);
        }
    }

    /// Adds a frame of which nothing is said; `time_s`: when it was taken, if that is known.
    pub(super) fn blank(&mut self, frame: usize, time_s: Option<f64>) {
        let line = json!({ "frame": frame, "time": time_s, "objects": [], "lost": [], "agents": [], "camera": null });
        push(&mut self.tracks, &line);
    }

    pub(super) fn event(&mut self, event: &Event) {
        push(&mut self.events, &json!(event));
    }
}

/// Whether an agent holds a thing: that is said of the thing, and is no support.
fn is_held(edge: &SupportRelation) -> bool {
    edge.kind == Relation::Held
}

fn pose(rigid: &Rigid) -> Value {
    json!({ "position_m": rigid.translation_m(), "rotation_xyzw": rigid.rotation_xyzw() })
}

/// Lines of JSON.
pub(super) fn lines_of(values: &[Value]) -> String {
    let mut text = String::new();
    values.iter().for_each(|value| push(&mut text, value));
    text
}

fn push(text: &mut String, line: &Value) {
    text.push_str(&line.to_string());
    text.push('\n');
}
