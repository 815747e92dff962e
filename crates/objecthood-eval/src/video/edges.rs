//! What stands on what, frame by frame.
//!
//! A track stands for the object that it shows. What an agent holds is not asked. Things that count as one do not stand on each
//! other. Ours.

use std::collections::BTreeSet;

use super::clip::{Edge, TrueClip};
use super::counts::Counts;
use super::shows::Shows;

/// What holds a track or an instance that an agent holds.
const HELD: &str = "held";

/// Counts edges of all frames. Edges of things that are not seen are neither asked for nor wrong. Where what holds a thing is not
/// seen itself, the surface (0) is as right. O((e + s) log f) for e true and s said edges.
pub(crate) fn edge_counts(said: &[Edge], clip: &TrueClip, shows: &Shows<'_>) -> Counts {
    let is_below = |edge: &&Edge| edge.kind.as_deref() != Some(HELD) && edge.frame < clip.frames.len();
    let mut there: BTreeSet<(usize, u16, u16)> = BTreeSet::new();
    for edge in clip.edges.iter().filter(is_below) {
        let name = |instance| shows.name_of(instance, edge.frame);
        let (child, parent) = (name(edge.child), if edge.parent == 0 { 0 } else { name(edge.parent) });
        if child != parent && shows.is_seen(edge.child, edge.frame) {
            there.insert((edge.frame, child, parent));
        }
    }
    let mut told: BTreeSet<(usize, u16, u16)> = BTreeSet::new();
    let mut counts = Counts::default();
    for edge in said.iter().filter(is_below) {
        let object = |track| shows.object_of(track, edge.frame);
        let parent = if edge.parent == 0 { Some(0) } else { object(edge.parent) };
        match (object(edge.child), parent) {
            (Some(child), _) if !shows.is_seen(child, edge.frame) => {}
            (Some(child), Some(parent)) if child == parent => {}
            (Some(child), Some(parent)) => _ = told.insert((edge.frame, child, parent)),
            _ if shows.is_unpunished(edge.child, edge.frame) => {}
            _ => counts.wrong += 1,
        }
    }
    for &(frame, child, parent) in &there {
        let on_surface = (frame, child, 0);
        let is_hidden = parent > 0 && !shows.is_seen(parent, frame) && !there.contains(&on_surface);
        let is_told = told.remove(&(frame, child, parent)) || (is_hidden && told.remove(&on_surface));
        *(if is_told { &mut counts.right } else { &mut counts.missed }) += 1;
    }
    counts.wrong += told.len() as u64;
    counts
}
