//! Predicts where tracks will be seen.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::align::{Motion, SurfacePoint, align, gain};
use crate::bits::Bits;
use crate::rigid::Rigid;
use crate::scene::{Key, Scene, THERE_M};
use crate::surface::expect;
use crate::track::Track;
use crate::view::{View, block};

/// A track may have moved if more than this share of its pixels changed.
const CHANGED_SHARE: f64 = 0.06;
/// At least this many points are needed to find a motion.
const MOST_POINTS: usize = 700;
/// A motion counts if more than this share of its points fits,
const LEAST_FIT: f64 = 0.35;
/// if it is more than noise (shift (m), turn (rad) in a thirtieth of a second; in shorter frames a motion is
/// smaller, and in longer ones noise is not larger),
const LEAST_SHIFT_M: f64 = 0.0025;
const LEAST_TURN_RAD: f64 = 0.02;
const LEAST_IN_S: f64 = 1.0 / 30.0;
/// and if it explains what is seen better than rest does, by this mean square of standard deviations: a thing
/// that a hand passes only seems to move.
const LEAST_GAIN: f64 = 1.0;

/// Finds the motion of every track that may have moved, and predicts the pixels of all tracks. O(n), and
/// O(points) for each moving track.
pub(crate) fn predict(
    scene: &Scene,
    view: &View,
    changed: &Bits,
    tracks: &mut BTreeMap<Key, Track>,
    frame_s: f64,
) -> Vec<Key> {
    let mut px: BTreeMap<Key, (usize, usize)> = BTreeMap::new();
    for (pixel, &key) in scene.seen.iter().enumerate() {
        if key > 0 {
            let count = px.entry(key).or_default();
            count.0 += 1;
            count.1 += usize::from(changed.has(pixel));
        }
    }
    let mut moving: BTreeMap<Key, Rigid> = BTreeMap::new();
    let mut points: BTreeMap<Key, (usize, Vec<SurfacePoint>)> = BTreeMap::new();
    for (&key, &(all, some)) in &px {
        let Some(track) = tracks.get_mut(&key) else { continue };
        let may_move = some as f64 > CHANGED_SHARE * all as f64 || track.is_moving;
        (track.is_moving, track.motion) = (false, None);
        if may_move {
            points.insert(key, (all.div_ceil(MOST_POINTS), Vec::new()));
        }
    }
    collect(scene, view, &mut points);
    for (key, (_, points)) in &points {
        let Some(track) = tracks.get_mut(key) else { continue };
        let Some(motion) = best_motion(points, view, track.velocity * frame_s) else { continue };
        let center = points.iter().map(|point| point.at).sum::<DVec3>() / points.len().max(1) as f64;
        let least = f64::from(view.noise) * (frame_s / LEAST_IN_S).min(1.0);
        let is_more = motion.rigid.displacement_m(center) > LEAST_SHIFT_M * least
            || motion.rigid.angle_rad() > LEAST_TURN_RAD * least;
        let gain = gain(points, view, &motion.rigid, &Rigid::IDENTITY);
        let is_more = is_more && gain.is_none_or(|gain| gain > LEAST_GAIN);
        if motion.fit > LEAST_FIT {
            if is_more {
                moving.insert(*key, motion.rigid);
            }
            // Small motions add up, and the hidden part of a surface is not measured again.
            if track.rest_s == 0.0 {
                track.surface.carry(&motion.rigid);
            }
            (track.is_moving, track.motion) = (is_more, Some(motion));
        }
    }
    let mut predicted = splat(scene, view, &moving);
    expect(&mut predicted, scene, view, tracks);
    predicted
}

/// Points of tracks, without the pixels at their outlines.
fn collect(scene: &Scene, view: &View, points: &mut BTreeMap<Key, (usize, Vec<SurfacePoint>)>) {
    if points.is_empty() {
        return;
    }
    let (width, height) = view.size;
    let mut counts: BTreeMap<Key, usize> = BTreeMap::new();
    for v in 1..height.saturating_sub(1) {
        for pixel in v * width + 1..(v + 1) * width - 1 {
            let key = scene.seen[pixel];
            if key == 0
                || [pixel - 1, pixel + 1, pixel - width, pixel + width]
                    .iter()
                    .any(|&at| scene.seen[at] != key)
            {
                continue;
            }
            let Some((stride, points)) = points.get_mut(&key) else { continue };
            let count = counts.entry(key).or_default();
            *count += 1;
            if (*count - 1).is_multiple_of(*stride)
                && let Some(point) = scene.point(view, pixel)
            {
                points.push(point);
            }
        }
    }
}

/// The better of two motions: the one found from rest, and the one found from the last velocity, which is in
/// the world.
fn best_motion(points: &[SurfacePoint], view: &View, step: DVec3) -> Option<Motion> {
    let from_rest = align(points, view, &Rigid::IDENTITY);
    if step.length() < LEAST_SHIFT_M {
        return from_rest;
    }
    let guess = Rigid::step(DVec3::ZERO, step, DVec3::ZERO);
    match (from_rest, align(points, view, &guess)) {
        (Some(a), Some(b)) => Some(if b.fit > a.fit { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// The predicted track of each pixel. Moving tracks are predicted where the depth agrees; elsewhere the track
/// is that of the last frame.
fn splat(scene: &Scene, view: &View, moving: &BTreeMap<Key, Rigid>) -> Vec<Key> {
    let mut predicted: Vec<Key> = scene.seen.clone();
    if moving.is_empty() {
        return predicted;
    }
    let is_moving = |key: Key| moving.contains_key(&key);
    predicted.iter_mut().filter(|key| **key > 0 && is_moving(**key)).for_each(|key| *key = 0);
    for (pixel, &key) in scene.seen.iter().enumerate().filter(|&(_, &key)| key > 0) {
        let Some(rigid) = moving.get(&key) else { continue };
        let Some(point) = scene.point(view, pixel) else { continue };
        let now = rigid.point(point.at);
        let Some((u, v)) = view.project(now) else { continue };
        for to in block((u as usize, v as usize), view.size) {
            let is_there = view.inverse[to] > 0.0
                && (1.0 / f64::from(view.inverse[to]) - now.z).abs() < f64::from(THERE_M);
            if is_there {
                predicted[to] = key;
            }
        }
    }
    predicted
}
