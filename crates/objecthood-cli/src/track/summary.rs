//! What happened, in sentences as a person would tell it.

use objecthood_track::{Event, EventKind};

/// The events in the order of their frames, a sentence each.
pub(super) fn of(events: &[Event], objects: usize) -> String {
    let mut sorted: Vec<&Event> = events.iter().collect();
    sorted.sort_by_key(|event| (event.frame, event.object, event.kind));
    let mut text = String::new();
    if sorted.is_empty() {
        let things = if objects == 1 { "1 object, and it stays" } else { "objects, and they stay" };
        let count = if objects == 1 { String::new() } else { format!("{objects} ") };
        return format!("Nothing happens: there are {count}{things} where they are.\n");
    }
    for event in sorted {
        text.push_str(&format!("{:8.2} s  {}\n", event.time, sentence(event)));
    }
    text
}

/// An event as a person would tell it.
pub(super) fn sentence(event: &Event) -> String {
    let object = format!("object {}", event.object.0);
    let thing = |nobody: &str| match event.other {
        None => nobody.to_owned(),
        Some(0) => "the table".to_owned(),
        Some(other) => format!("object {other}"),
    };
    let agent = event.other.map_or_else(|| "Someone".to_owned(), |agent| format!("Agent {agent}"));
    let said = match event.kind {
        EventKind::Appeared => format!("{object} appears"),
        EventKind::Left => format!("{object} leaves the view"),
        EventKind::PickedUp => format!("{agent} picks up {object}"),
        EventKind::PlacedOn => format!("{object} is put down on {}", thing("something")),
        EventKind::PutIn => format!("{object} is put into {}", thing("something")),
        EventKind::TakenOut => format!("{object} is taken out of {}", thing("something")),
        EventKind::Pushed => format!("{agent} pushes {object}"),
        EventKind::Airborne => {
            let frames = event.start.zip(event.end).map_or(0, |(start, end)| end + 1 - start);
            format!("{object} flies for {frames} frames")
        }
        EventKind::Landed => format!("{object} lands"),
        EventKind::Fell => format!("{object} falls"),
        EventKind::Occluded => format!("{object} goes behind {}", thing("something")),
        EventKind::Split => format!("{object} comes apart from {}", thing("what it was one with")),
        EventKind::Merged => format!("{object} and {} turn out to be one", thing("another part")),
        EventKind::Opened => format!("{object} opens {}", thing("something")),
        _ => format!("{object}: {}", event.kind),
    };
    let mut letters = said.chars();
    let first = letters.next().map_or_else(String::new, |letter| letter.to_uppercase().collect());
    format!("{first}{}.", letters.as_str())
}

/// An event in a few words, for pictures.
pub(super) fn short(event: &Event) -> String {
    format!("{} {}", event.object.0, event.kind.name().replace('_', " "))
}
