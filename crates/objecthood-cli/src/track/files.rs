//! The lists that `track` writes: a line of JSON each.

use std::collections::BTreeSet;

use objecthood_track::{Event, TrackId, Tracked};
use serde_json::json;

/// The lines of all lists.
#[derive(Default)]
pub(super) struct Lines {
    pub(super) tracks: String,
    pub(super) events: String,
    pub(super) support: String,
    pub(super) seen: BTreeSet<TrackId>,
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
                    "evidence": object.seen_to,
                }))
            })
            .collect();
        self.seen.extend(tracked.objects.iter().filter_map(|object| object.track));
        let lost: Vec<_> = tracked
            .lost
            .iter()
            .map(|lost| json!({ "track": lost.track, "state": lost.state, "center_m": lost.center_m, "for_s": lost.for_s }))
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
        for edge in &tracked.support {
            let parent = edge.parent.map_or(0, |parent| parent.0);
            let line =
                json!({ "frame": tracked.frame, "child": edge.child, "parent": parent, "kind": edge.kind });
            push(&mut self.support, &line);
        }
        for event in &tracked.events {
            self.event(event);
        }
    }

    pub(super) fn event(&mut self, event: &Event) {
        push(&mut self.events, &json!(event));
    }

    /// Number of objects that were seen.
    pub(super) fn objects(&self) -> usize {
        self.seen.len()
    }
}

fn push(text: &mut String, line: &serde_json::Value) {
    text.push_str(&line.to_string());
    text.push('\n');
}
