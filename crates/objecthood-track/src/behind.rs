//! Arms that reach behind a thing: what is seen of them comes in several regions (ours).

use std::collections::BTreeMap;

use crate::agent::{Agent, Things};
use crate::bits::Bits;
use crate::scene::{BESIDE_BACKGROUND_PER_M, Key, Scene};
use crate::track::RESTING_CHANGE;
use crate::view::View;

/// A region goes on behind a thing if this many rows and columns lead from one to the other (px at VGA size):
/// as many pixels as an agent has at least on the border.
const LEAST_MET_PX: f64 = 8.0;
/// The shadow of a thing is at most this wide (px at VGA size): a Kinect's is 26 px if the thing is at 0.6 m,
/// and what lies behind it at 1 m.
const SHADOW_PX: f64 = 32.0;
/// A region comes out as a part of an arm if at most this share of its pixels is that of known or free things.
const MOST_OF_THINGS: f64 = 0.5;
/// It stays a part if more than this share of its pixels was one: by then the hand may hold a thing.
const STAYS: f64 = 0.5;

/// Pixels that are nearer than the rested scene.
pub(crate) struct Region {
    /// Whether they touch the border of the image.
    pub(crate) is_at_border: bool,
    pub(crate) pixels: Vec<usize>,
}

/// What is known of agents and things before their regions are.
pub(crate) struct Before<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) things: &'a Things,
    pub(crate) agents: &'a [Agent],
    /// The regions that were joined to arms.
    pub(crate) joined: &'a Bits,
    /// Where this frame differs from the last.
    pub(crate) changed: &'a Bits,
}

impl Before<'_> {
    /// Joins regions that do not touch the border to arms that do, if both go on behind the same known thing.
    /// Returns the regions, and the pixels of those that were joined. O(n).
    pub(crate) fn join(&self, regions: Vec<Region>, view: &View) -> (Vec<Region>, Bits) {
        let (mut regions, mut inner): (Vec<Region>, Vec<Region>) =
            regions.into_iter().partition(|region| region.is_at_border);
        let at_border = regions.len();
        let arms: Vec<usize> = (0..at_border).filter(|&k| self.is_arm(&regions[k].pixels)).collect();
        let may_join: Vec<bool> = inner.iter().map(|region| self.may_join(&region.pixels)).collect();
        let mut joined = Bits::none(view.size);
        if !arms.is_empty() && may_join.contains(&true) {
            let all: Vec<&[usize]> =
                regions.iter().chain(&inner).map(|region| region.pixels.as_slice()).collect();
            let behind = self.go_behind(&all, view);
            for (k, region) in inner.iter_mut().enumerate().filter(|(k, _)| may_join[*k]) {
                let meets = |&arm: &usize| behind[arm].iter().any(|key| behind[at_border + k].contains(key));
                let largest = arms.iter().copied().filter(meets).max_by_key(|&arm| regions[arm].pixels.len());
                if let Some(arm) = largest {
                    region.pixels.iter().for_each(|&pixel| joined.insert(pixel));
                    regions[arm].pixels.append(&mut region.pixels);
                }
            }
            inner.retain(|region| !region.pixels.is_empty());
        }
        regions.append(&mut inner);
        (regions, joined)
    }

    /// Whether a region shows an agent that is sure.
    fn is_arm(&self, pixels: &[usize]) -> bool {
        let mut agents = self.agents.iter().filter(|agent| agent.number > 0);
        agents.any(|agent| pixels.iter().any(|&pixel| agent.mask.has(pixel)))
    }

    /// Whether a region can be a part of an arm. What an arm has put down rests.
    fn may_join(&self, pixels: &[usize]) -> bool {
        let share = |holds: &dyn Fn(usize) -> bool| {
            pixels.iter().filter(|&&pixel| holds(pixel)).count() as f64 / pixels.len() as f64
        };
        let is_of_thing = |pixel: usize| {
            let key = self.scene.seen[pixel];
            self.things.known.contains(&key) || self.things.free.contains(&key)
        };
        let moves = share(&|pixel| self.changed.has(pixel)) > RESTING_CHANGE;
        share(&|pixel| self.joined.has(pixel)) > STAYS || moves && share(&is_of_thing) <= MOST_OF_THINGS
    }

    /// The known things behind which each region goes on: in a row or column the next measured pixel is that
    /// of the thing in the last frame, and nearer. O(n).
    fn go_behind(&self, regions: &[&[usize]], view: &View) -> Vec<Vec<Key>> {
        let (width, height) = view.size;
        let mut region_at = vec![0_usize; width * height];
        for (k, pixels) in regions.iter().enumerate() {
            // Closing has filled gaps, in which the rested scene is seen.
            let own = pixels.iter().filter(|&&pixel| self.scene.is_in_front(view, pixel));
            own.for_each(|&pixel| region_at[pixel] = k + 1);
        }
        let (shadow, least) = (view.length_px(SHADOW_PX), view.length_px(LEAST_MET_PX));
        let nearer = BESIDE_BACKGROUND_PER_M * view.noise;
        let mut met: Vec<BTreeMap<Key, usize>> = vec![BTreeMap::new(); regions.len()];
        let mut meet = |behind: usize, before: usize| {
            let (region, key) = (region_at[behind], self.scene.seen[before]);
            if region > 0
                && region_at[before] != region
                && view.inverse[before] - view.inverse[behind] > nearer
                && self.things.known.contains(&key)
            {
                *met[region - 1].entry(key).or_default() += 1;
            }
        };
        let mut follow = |start: usize, step: usize, length: usize| {
            let mut last: Option<usize> = None;
            for k in (0..length).filter(|k| view.inverse[start + k * step] > 0.0) {
                if let Some(last) = last.filter(|last| k - last <= shadow) {
                    let [a, b] = [last, k].map(|k| start + k * step);
                    meet(a, b);
                    meet(b, a);
                }
                last = Some(k);
            }
        };
        (0..height).for_each(|v| follow(v * width, 1, width));
        (0..width).for_each(|u| follow(u, width, height));
        let enough = |met: BTreeMap<Key, usize>| {
            met.into_iter().filter(|&(_, count)| count >= least).map(|(key, _)| key).collect()
        };
        met.into_iter().map(enough).collect()
    }
}
