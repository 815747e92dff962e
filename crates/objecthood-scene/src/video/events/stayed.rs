//! Put in, taken out.

use super::{Event, EventKind, Tape, joined_runs, runs};
use crate::video::SupportKind;

/// What hops in a vessel is in it all the while (s).
const HOP_S: f64 = 0.3;
/// What is in a vessel for less than this only passes it (s).
const STAY_S: f64 = 0.2;

pub(super) fn events(tape: &Tape<'_>, object: usize) -> Vec<Event> {
    if tape.is_jointed(object) {
        return Vec::new();
    }
    let vessel = |k: usize| {
        let edge = tape.truth.edge(k, object).filter(|edge| edge.kind == SupportKind::In);
        edge.map(|edge| outermost(tape, k, edge.parent))
    };
    let mut vessels: Vec<u16> = (0..tape.frames()).filter_map(vessel).collect();
    vessels.sort_unstable();
    vessels.dedup();
    let mut events = Vec::new();
    for parent in vessels {
        let inside = joined_runs(runs(tape.frames(), |k| vessel(k) == Some(parent)), tape.during(HOP_S));
        for (first, last) in inside.into_iter().filter(|(first, last)| last - first >= tape.during(STAY_S)) {
            if first > 0 {
                events.push(tape.event(EventKind::PutIn, first, object, Some(parent)));
            }
            if last + 1 + tape.during(HOP_S) < tape.frames() {
                events.push(tape.event(EventKind::TakenOut, last + 1, object, Some(parent)));
            }
        }
    }
    events
}

/// What lies on something that lies in a vessel is in the vessel.
fn outermost(tape: &Tape<'_>, frame: usize, parent: u16) -> u16 {
    let edge = tape.truth.edge(frame, usize::from(parent) - 1).filter(|edge| edge.kind == SupportKind::In);
    edge.map_or(parent, |edge| edge.parent)
}
