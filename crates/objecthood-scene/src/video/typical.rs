//! Whether a clip came out as its kind is to be.

use super::events::EventKind;
use super::overlap::Forms;
use super::{Clip, Video};

/// Hands come no deeper into things than this (m); into what they hold, whose form for physics is a hull, than the other.
const TOUCH_M: f64 = 0.004;
const GRIP_M: f64 = 0.015;
/// Things come no deeper into each other than this (m).
const OVERLAP_M: f64 = 0.003;
/// Every so many frames are looked at.
const STRIDE: usize = 3;
/// An object shows at least this share of itself at first; long ones behind occluders less.
const SHOWN: f64 = 0.3;

/// What has to happen in a clip of a kind; of what lasts once is enough.
fn promised(clip: Clip) -> &'static [EventKind] {
    match clip {
        Clip::Static | Clip::Empty | Clip::Walker => &[],
        Clip::Pick
        | Clip::Stack
        | Clip::Unstack
        | Clip::SoftToy
        | Clip::Bowl
        | Clip::Twins
        | Clip::TwoAgents => &[EventKind::PickedUp, EventKind::PlacedOn],
        Clip::PushFlush => &[EventKind::Pushed, EventKind::Split],
        Clip::Occluder => &[EventKind::Merged],
        Clip::Throw => &[EventKind::Appeared, EventKind::Airborne],
        Clip::Drop => &[EventKind::PickedUp, EventKind::Fell, EventKind::Landed],
        Clip::Roll => &[],
        Clip::Lid | Clip::Drawer => &[EventKind::Opened],
        Clip::PutIn => &[EventKind::PickedUp, EventKind::PutIn],
        Clip::Pour => &[EventKind::TakenOut],
        Clip::Sweep => &[EventKind::Pushed],
    }
}

/// What no clip of a kind is to contain, because something went wrong then.
fn unwanted(clip: Clip) -> &'static [EventKind] {
    match clip {
        Clip::Static | Clip::Empty => &EventKind::ALL,
        Clip::Throw | Clip::Roll | Clip::Drop | Clip::Pour => &[],
        _ => &[EventKind::Airborne, EventKind::Left, EventKind::Appeared],
    }
}

/// Everything that the kind promises happened, nothing else did, objects are well in sight at first, and neither hands
/// nor things pass through things.
pub(super) fn is_typical(video: &Video) -> bool {
    let (clip, events) = (video.clip(), &video.truth().events);
    let has = |kind: &EventKind| events.iter().any(|event| event.kind == *kind);
    promised(clip).iter().all(has)
        && !unwanted(clip).iter().any(has)
        && is_well_seen(video)
        && is_moved(video)
        && !passes_through(video)
}

/// No object is cut by the border of the image or nearly hidden at first, but may be all outside.
fn is_well_seen(video: &Video) -> bool {
    let mut first = video.objects().map(|k| video.truth().seen(0, k));
    let may_be_cut = video.clip() == Clip::Static;
    let may_be_outside = matches!(video.clip(), Clip::Throw | Clip::Roll | Clip::Pour);
    first.all(|seen| {
        (may_be_outside && seen.alone_px == 0)
            || (seen.seen_px > 0 && (may_be_cut || !seen.is_cut) && (seen.share() > SHOWN || may_be_cut))
            || (matches!(video.clip(), Clip::Pour | Clip::Drawer) && !seen.is_cut)
    })
}

/// Where hands have deeds, all of them left a trace: each agent with a hand is named by an event.
fn is_moved(video: &Video) -> bool {
    let named = |agent: &u16| video.truth().events.iter().any(|event| event.other == Some(*agent));
    match video.clip() {
        Clip::Twins | Clip::TwoAgents => video.truth().agents.iter().all(named),
        Clip::Roll => video.objects().any(|k| {
            let center = |frame: usize| video.recording[frame][k].center;
            (center(video.frames() - 1) - center(0)).length() > 0.1
        }),
        _ => true,
    }
}

fn passes_through(video: &Video) -> bool {
    let forms = Forms::of(video);
    let objects: Vec<usize> = video.objects().collect();
    (0..video.frames()).step_by(STRIDE).any(|frame| {
        let states = &video.recording[frame];
        let overlap = objects.iter().enumerate().any(|(i, &a)| {
            objects[i + 1..].iter().any(|&b| {
                let met = forms.meeting(video, frame, a, b);
                met.is_some_and(|met| -met.distance_m > OVERLAP_M)
            })
        });
        let cut = (0..video.agents().len()).any(|agent| {
            objects.iter().any(|&thing| {
                let handled = video.recording.iter().any(|states| states[thing].holder == Some(agent));
                let allowed = if handled { GRIP_M } else { TOUCH_M };
                let is_pushed = states[thing].pusher.is_some();
                !is_pushed && forms.depth_of_agent(video, frame, agent, thing) > allowed
            })
        });
        overlap || cut
    })
}
