//! `track --smooth`: what the whole video proved, written into what was said of its earlier frames.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context, Result};
use objecthood::{PixelBox, Raster};
use objecthood_io::{label_image, output};
use objecthood_track::{Hindsight, TrackId};
use serde_json::{Value, json};

use super::files::Lines;
use super::{Plan, Told};

impl Plan<'_> {
    /// Rewrites the label images, from the last to the first, and the lists.
    ///
    /// # Errors
    /// When a label image or a list that this run wrote cannot be read or written.
    pub(super) fn smooth(&self, told: &mut Told, lines: &mut Lines, mut hindsight: Hindsight) -> Result<()> {
        let (mut tracks, support) = (lines.tracks.values()?, lines.support.values()?);
        let mut with_new: BTreeMap<u64, Vec<(TrackId, TrackId)>> = BTreeMap::new();
        for line in tracks.iter_mut().rev() {
            let frame = line["frame"].as_u64().unwrap_or(0);
            let path = self.label_image(&self.inputs.frames[frame as usize].name);
            let named = || path.display().to_string();
            let mut labels = label_image::decode(&std::fs::read(&path).with_context(named)?)?;
            let before = labels.clone();
            let parted = hindsight.rewrite(frame, &mut labels);
            if labels != before {
                output::write_atomically(&path, &label_image::encode(&labels)?)?;
                smooth_objects(line, &labels, &before, &hindsight, &parted);
            }
            with_new.insert(frame, parted);
        }
        lines.tracks.replace(&tracks)?;
        lines.support.replace(&smooth_support(&support, &hindsight, &with_new))?;
        told.cast = std::mem::take(&mut told.cast).renumbered(|track| hindsight.whole_of(track));
        Ok(())
    }
}

/// Gives the objects of a line the numbers, pixels and boxes that the rewritten labels have; what those have anew has no more than that.
fn smooth_objects(
    line: &mut Value,
    labels: &Raster<u16>,
    before: &Raster<u16>,
    hindsight: &Hindsight,
    parted: &[(TrackId, TrackId)],
) {
    let changed: BTreeSet<u16> = labels
        .as_slice()
        .iter()
        .zip(before.as_slice())
        .filter(|(is, was)| is != was)
        .flat_map(|(&is, &was)| [is, was])
        .collect();
    let mut objects: Vec<Value> = Vec::new();
    for mut object in line["objects"].as_array().cloned().unwrap_or_default() {
        let Some(track) = track_of(&object["track"]).map(|track| hindsight.whole_of(track)) else { continue };
        if objects.iter().any(|known| known["track"] == json!(track)) {
            continue;
        }
        object["track"] = json!(track);
        objects.push(object);
    }
    objects.extend(parted.iter().map(|(new, _)| json!({ "track": new, "state": "confirmed" })));
    for object in &mut objects {
        let Some(track) = track_of(&object["track"]).filter(|track| changed.contains(&track.0)) else {
            continue;
        };
        let (size_px, area) = extent(labels, track);
        object["size_px"] = json!(size_px);
        object["box_px"] = json!([area.u, area.v, area.width, area.height]);
    }
    line["objects"] = Value::Array(objects);
}

/// The edges under the numbers in the end. What stood as one with another stood on the same.
fn smooth_support(
    support: &[Value],
    hindsight: &Hindsight,
    parted: &BTreeMap<u64, Vec<(TrackId, TrackId)>>,
) -> Vec<Value> {
    let mut known = BTreeSet::new();
    let mut edges = Vec::new();
    for edge in support {
        let (Some(child), Some(frame)) = (track_of(&edge["child"]), edge["frame"].as_u64()) else { continue };
        let child = hindsight.whole_of(child);
        let parent = track_of(&edge["parent"]).map_or(0, |parent| hindsight.whole_of(parent).0);
        let of_frame = parted.get(&frame).map_or(&[][..], Vec::as_slice);
        let new = of_frame.iter().filter(|(_, old)| *old == child).map(|(new, _)| *new);
        for child in std::iter::once(child).chain(new).filter(|child| child.0 != parent) {
            if known.insert((frame, child)) {
                let mut edge = edge.clone();
                (edge["child"], edge["parent"]) = (json!(child), json!(parent));
                edges.push(edge);
            }
        }
    }
    edges
}

fn track_of(value: &Value) -> Option<TrackId> {
    let number = u16::try_from(value.as_u64()?).ok()?;
    (number > 0).then_some(TrackId(number))
}

/// The number of pixels of a track, and the smallest box that holds them.
fn extent(labels: &Raster<u16>, track: TrackId) -> (usize, PixelBox) {
    let width = labels.size().0;
    let mut size_px = 0;
    let [mut left, mut top, mut right, mut bottom] = [usize::MAX, usize::MAX, 0, 0];
    for (pixel, _) in labels.as_slice().iter().enumerate().filter(|&(_, &label)| label == track.0) {
        let (u, v) = (pixel % width, pixel / width);
        size_px += 1;
        (left, top, right, bottom) = (left.min(u), top.min(v), right.max(u), bottom.max(v));
    }
    let span = |first: usize, last: usize| (last + 1).saturating_sub(first);
    let (u, v) = (left.min(right), top.min(bottom));
    (size_px, PixelBox { u, v, width: span(left, right), height: span(top, bottom) })
}
