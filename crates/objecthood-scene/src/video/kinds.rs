//! The kinds of clips: each draws a scene and what happens in it.

mod carry;
mod flight;
mod open;
mod push;
mod still;
mod vessel;

use super::clip::Clip;
use super::script::Script;
use crate::random::Rng;

/// Draws a script of a kind; `None` when there was no room for it.
pub(super) fn draw(clip: Clip, rng: &mut Rng) -> Option<Script> {
    match clip {
        Clip::Static => still::seen_around(rng),
        Clip::Empty => Some(still::empty(rng)),
        Clip::Walker => Some(still::walked_by(rng)),
        Clip::Pick => carry::pick(rng),
        Clip::Twins => carry::twins(rng),
        Clip::Stack => carry::stack(rng),
        Clip::Unstack => carry::unstack(rng),
        Clip::TwoAgents => carry::two_agents(rng),
        Clip::SoftToy => carry::soft_toy(rng),
        Clip::Occluder => carry::occluder(rng),
        Clip::PushFlush => push::flush(rng),
        Clip::Sweep => push::sweep(rng),
        Clip::Throw => flight::throw(rng),
        Clip::Drop => flight::drop(rng),
        Clip::Roll => flight::roll(rng),
        Clip::Lid => open::lid(rng),
        Clip::Drawer => open::drawer(rng),
        Clip::Bowl => vessel::bowl(rng),
        Clip::PutIn => vessel::put_in(rng),
        Clip::Pour => vessel::pour(rng),
    }
}
