//! What of each solid is seen in a frame.

use crate::view::View;
use crate::world::World;

/// Pieces smaller than this share of what is seen of a thing, or than so many pixels of an image of a quarter of the
/// columns and rows, are crumbs.
const PIECE_SHARE: f64 = 0.1;
const PIECE_PX: usize = 8;

/// What is seen of a solid, counted in an image of a quarter of the columns and rows.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Seen {
    pub(super) seen_px: u32,
    /// Pixels that it would have if it were alone.
    pub(super) alone_px: u32,
    /// Pieces that it is seen in.
    pub(super) pieces: u16,
    /// Whether it goes on beyond the image.
    pub(super) is_cut: bool,
}

impl Seen {
    /// Share of it that is seen of what is in the image.
    pub(super) fn share(self) -> f64 {
        f64::from(self.seen_px) / f64::from(self.alone_px.max(1))
    }
}

/// What is seen of every solid of a world.
pub(super) fn seen(world: &World) -> Vec<Seen> {
    let view = View::of(&world.at_quarter_size());
    let instances: Vec<u16> =
        view.sights.iter().map(|sight| sight.as_ref().map_or(0, |sight| sight.instance)).collect();
    let mut all: Vec<Seen> =
        view.alone_px().iter().map(|&alone_px| Seen { alone_px, ..Seen::default() }).collect();
    for &instance in instances.iter().filter(|&&instance| instance > 0) {
        all[usize::from(instance) - 1].seen_px += 1;
    }
    for sight in view.border().flatten() {
        all[usize::from(sight.instance) - 1].is_cut = true;
    }
    let mut is_open = vec![true; instances.len()];
    for first in 0..instances.len() {
        if instances[first] > 0 && is_open[first] {
            let size = flood(&instances, view.width, first, &mut is_open);
            let own = &mut all[usize::from(instances[first]) - 1];
            let is_piece = size >= PIECE_PX && size as f64 >= PIECE_SHARE * f64::from(own.seen_px);
            own.pieces += u16::from(is_piece);
        }
    }
    all
}

/// Which solid hides most of this one; 0 when nothing does.
pub(super) fn hider(world: &World, instance: u16) -> u16 {
    let world = world.at_quarter_size();
    let alone = View::of(&world.with_only(instance));
    let together = View::of(&world);
    let mut hidden_px = vec![0_u32; world.solids().len() + 1];
    for (alone, seen) in alone.sights.iter().zip(&together.sights) {
        if let (Some(_), Some(seen)) = (alone, seen)
            && seen.instance != instance
        {
            hidden_px[usize::from(seen.instance)] += 1;
        }
    }
    let most = (1..hidden_px.len()).max_by_key(|&k| (hidden_px[k], std::cmp::Reverse(k)));
    most.filter(|&k| hidden_px[k] > 0).unwrap_or(0) as u16
}

/// Closes the pixels of the 4-connected piece around `first`; their number.
fn flood(instances: &[u16], width: usize, first: usize, is_open: &mut [bool]) -> usize {
    let mut piece = vec![first];
    is_open[first] = false;
    let mut next = 0;
    while let Some(&i) = piece.get(next) {
        next += 1;
        let (u, v) = (i % width, i / width);
        let beside = [
            (u > 0).then(|| i - 1),
            (u + 1 < width).then_some(i + 1),
            (v > 0).then(|| i - width),
            (i + width < instances.len()).then_some(i + width),
        ];
        for k in beside.into_iter().flatten() {
            if is_open[k] && instances[k] == instances[first] {
                is_open[k] = false;
                piece.push(k);
            }
        }
    }
    piece.len()
}
