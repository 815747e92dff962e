//! What happened, in sentences as a person would tell it.

use objecthood_track::Event;

use super::cast::Count;

/// The events in the order of their frames, a sentence each.
pub(super) fn of(events: &[Event], count: Count) -> String {
    if events.is_empty() {
        return of_nothing(count);
    }
    let mut sorted: Vec<&Event> = events.iter().collect();
    sorted.sort_by_key(|event| (event.frame, event.object, event.kind));
    sorted.iter().map(|event| format!("{:8.2} s  {}\n", event.time, event)).collect()
}

/// Who is there when no event is told.
fn of_nothing(Count { resting, moving, agents }: Count) -> String {
    let told = |count: usize, [one, many]: [&str; 2]| match count {
        0 => None,
        1 => Some(format!("1 {one}")),
        _ => Some(format!("{count} {many}")),
    };
    let sentences = [
        told(agents, ["agent is there", "agents are there"]),
        told(resting, ["object stays where it is", "objects stay where they are"]),
        told(moving, ["object moves", "objects move"]),
        (resting + moving == 0).then(|| "there is no object".to_owned()),
    ];
    let text = sentences.into_iter().flatten().collect::<Vec<_>>().join("; ");
    let begin = if agents + moving == 0 { "Nothing happens" } else { "No event is told" };
    format!("{begin}: {text}.\n")
}

/// An event in a few words, for pictures.
pub(super) fn short(event: &Event) -> String {
    format!("{} {}", event.object.0, event.kind.name().replace('_', " "))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// It said "Nothing happens" although an agent was there from the first frame on.
    #[test]
    fn without_events_it_says_who_is_there() {
        let said = |resting, moving, agents| of(&[], Count { resting, moving, agents });
        assert_eq!(said(0, 0, 0), "Nothing happens: there is no object.\n");
        assert_eq!(said(1, 0, 0), "Nothing happens: 1 object stays where it is.\n");
        assert_eq!(said(2, 0, 1), "No event is told: 1 agent is there; 2 objects stay where they are.\n");
        assert_eq!(said(2, 1, 0), "No event is told: 2 objects stay where they are; 1 object moves.\n");
        assert_eq!(said(0, 0, 2), "No event is told: 2 agents are there; there is no object.\n");
    }
}
