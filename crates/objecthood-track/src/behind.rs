//! Arms that reach behind a thing: what is seen of them comes in several regions (ours).

use std::collections::BTreeMap;

use crate::agent::Things;
use crate::scene::{BESIDE_BACKGROUND_PER_M, Key, Scene};
use crate::view::View;

/// A region goes on behind a thing if this many rows and columns lead from one to the other (px at VGA size).
const LEAST_MET_PX: f64 = 8.0;
/// The shadow of the thing is at most this wide (px at VGA size): 0.6 m before 1 m, a Kinect's is 26 px.
const SHADOW_PX: f64 = 32.0;
/// A region is that of a known thing if more than this share of its pixels is.
const OF_THING: f64 = 0.5;

/// What is nearer than the rested scene: pixels that hang together, and whether they touch the border of the
/// image.
pub(crate) type Region = (bool, Vec<usize>);

/// Joins each region that does not touch the border to one that does, if both go on behind the same known
/// thing. A region of known things is no part of an arm. O(n).
pub(crate) fn join_behind(
    regions: Vec<Region>,
    (view, scene): (&View, &Scene),
    things: &Things,
) -> Vec<Region> {
    let (mut regions, mut inner): (Vec<_>, Vec<_>) = regions.into_iter().partition(|&(touches, _)| touches);
    let is_known = |&&pixel: &&usize| things.known.contains(&scene.seen[pixel]);
    let is_thing =
        |pixels: &[usize]| pixels.iter().filter(is_known).count() as f64 > OF_THING * pixels.len() as f64;
    let arms = regions.len();
    if arms > 0 && inner.iter().any(|(_, pixels)| !is_thing(pixels)) {
        let candidates = regions.iter().chain(&inner).map(|(_, pixels)| pixels.as_slice());
        let behind = go_behind(candidates, (view, scene), things);
        let arm_of = |k: usize| {
            let same = (0..arms).filter(|&arm| behind[arm].iter().any(|key| behind[k].contains(key)));
            same.max_by_key(|&arm| regions[arm].1.len())
        };
        let joins: Vec<Option<usize>> =
            (0..inner.len()).map(|k| arm_of(arms + k).filter(|_| !is_thing(&inner[k].1))).collect();
        for ((_, pixels), arm) in inner.iter_mut().zip(&joins) {
            if let &Some(arm) = arm {
                regions[arm].1.append(pixels);
            }
        }
        inner.retain(|(_, pixels)| !pixels.is_empty());
    }
    regions.append(&mut inner);
    regions
}

/// The known things behind which each region goes on: in a row or column the next measured pixel is the
/// thing's, and nearer. O(n).
fn go_behind<'a>(
    regions: impl Iterator<Item = &'a [usize]>,
    (view, scene): (&View, &Scene),
    things: &Things,
) -> Vec<Vec<Key>> {
    let (width, height) = view.size;
    let mut region_at = vec![0_usize; width * height];
    let mut count = 0;
    for pixels in regions {
        count += 1;
        pixels.iter().for_each(|&pixel| region_at[pixel] = count);
    }
    let (shadow, least) = (view.length_px(SHADOW_PX), view.length_px(LEAST_MET_PX));
    let nearer = BESIDE_BACKGROUND_PER_M * view.noise;
    let mut met: Vec<BTreeMap<Key, usize>> = vec![BTreeMap::new(); count];
    let mut meet = |behind: usize, before: usize| {
        let (region, key) = (region_at[behind], scene.seen[before]);
        if region > 0
            && region_at[before] != region
            && view.inverse[before] - view.inverse[behind] > nearer
            && things.known.contains(&key)
        {
            *met[region - 1].entry(key).or_default() += 1;
        }
    };
    let mut follow = |start: usize, step: usize, length: usize| {
        let measured = (0..length).filter(|k| view.inverse[start + k * step] > 0.0);
        let mut last: Option<usize> = None;
        for k in measured {
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
