//! What happened, in sentences as a person would tell it.

use objecthood_track::Event;

/// The events in the order of their frames, a sentence each.
pub(super) fn of(events: &[Event], objects: usize) -> String {
    let mut sorted: Vec<&Event> = events.iter().collect();
    sorted.sort_by_key(|event| (event.frame, event.object, event.kind));
    let mut text = String::new();
    if sorted.is_empty() {
        return match objects {
            0 => "Nothing happens: there is no object.\n".to_owned(),
            1 => "Nothing happens: there is 1 object, and it stays where it is.\n".to_owned(),
            _ => format!("Nothing happens: there are {objects} objects, and they stay where they are.\n"),
        };
    }
    for event in sorted {
        text.push_str(&format!("{:8.2} s  {}\n", event.time, event));
    }
    text
}

/// An event in a few words, for pictures.
pub(super) fn short(event: &Event) -> String {
    format!("{} {}", event.object.0, event.kind.name().replace('_', " "))
}
