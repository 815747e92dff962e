//! Flat patches before a wall, with the labels that a perfect discovery would give: what the tracker makes of noise and of what hides.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod agents;
mod camera;
mod handled;
mod hands;
mod memory;
mod pieces;

use objecthood::discovery::{Object, OrientedBox, PixelBox};
use objecthood::{Camera, Discovery, Frame, ObjectId, Raster};
use objecthood_track::{Tracked, Tracker};

const SIZE: (usize, usize) = (160, 120);

/// A rectangle that faces the camera. At depth 0 it hides what is behind it and is not measured; at an infinite one nothing is in reach.
#[derive(Clone, Copy)]
struct Patch {
    left: i32,
    top: i32,
    width: i32,
    height: i32,
    depth_m: f32,
    color: [u8; 3],
}

impl Patch {
    fn has(&self, u: i32, v: i32) -> bool {
        (self.left..self.left + self.width).contains(&u) && (self.top..self.top + self.height).contains(&v)
    }

    /// Spots that show how it moves in its plane.
    fn color_at(&self, u: i32, v: i32) -> [u8; 3] {
        let is_dark = (u - self.left) / 6 % 3 == (v - self.top) / 5 % 2;
        self.color.map(|level| if is_dark { level - level / 4 } else { level })
    }
}

/// A frame of patches, the nearer before the farther, with noise of a Kinect's size; its discovery has a label for each of `found` that is
/// seen.
fn frame(patches: &[Patch], found: &[usize], number: u64) -> (Frame, Discovery) {
    const WALL: ([u8; 3], f32) = ([180, 180, 175], 1.3);
    let (mut depth_m, mut color, mut owners) = (Vec::new(), Vec::new(), Vec::new());
    for v in 0..SIZE.1 as i32 {
        for u in 0..SIZE.0 as i32 {
            let seen = patches.iter().enumerate().filter(|(_, patch)| patch.has(u, v));
            let nearest = seen.min_by(|a, b| a.1.depth_m.total_cmp(&b.1.depth_m));
            let (rgb, z) = nearest.map_or(WALL, |(_, patch)| (patch.color_at(u, v), patch.depth_m));
            let measured = z + 0.0012 * z * z * noise(u as u64, v as u64, number);
            depth_m.push(if z.is_finite() { measured } else { 0.0 });
            color.push(rgb);
            owners.push(nearest.map(|(k, _)| k).filter(|k| found.contains(k)));
        }
    }
    let seen: Vec<usize> = (0..patches.len()).filter(|&k| owners.contains(&Some(k))).collect();
    let label = |owner: &Option<usize>| {
        owner.and_then(|k| seen.iter().position(|&other| other == k)).map_or(0, |k| k as u16 + 1)
    };
    let labels = Raster::from_vec(SIZE.0, SIZE.1, owners.iter().map(label).collect()).unwrap();
    let object = |k: usize| {
        let area = PixelBox { u: 0, v: 0, width: 1, height: 1 };
        let metres =
            OrientedBox { center_m: [0.0; 3], rotation_xyzw: [0.0, 0.0, 0.0, 1.0], extents_m: [0.1; 3] };
        Object::new(ObjectId(k as u16 + 1), area, metres)
    };
    let found = Discovery::new((0..seen.len()).map(object).collect(), labels);
    let raster = |depth_m| Raster::from_vec(SIZE.0, SIZE.1, depth_m).unwrap();
    let color = Raster::from_vec(SIZE.0, SIZE.1, color).unwrap();
    let camera = Camera::new(131.0, 131.0, 79.5, 59.5).unwrap();
    (Frame::new(raster(depth_m), Some(color), camera).unwrap(), found)
}

/// Nearly normal, of variance 1, the same every time: the sum of twelve hashes.
fn noise(u: u64, v: u64, number: u64) -> f32 {
    let mut state = u.wrapping_mul(0x9e37_79b9)
        ^ v.wrapping_mul(0x85eb_ca6b_1234)
        ^ number.wrapping_mul(0xc2b2_ae35_77ff);
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        ((mixed ^ (mixed >> 27)) >> 40) as f32 / (1_u64 << 24) as f32
    };
    (0..12).map(|_| next()).sum::<f32>() - 6.0
}

const THING: Patch = Patch { left: 60, top: 40, width: 36, height: 30, depth_m: 1.0, color: [200, 60, 40] };

fn follow(tracker: &mut Tracker, patches: &[Patch], number: u64) -> Tracked {
    let all: Vec<usize> = (0..patches.len()).collect();
    follow_found(tracker, patches, &all, number)
}

/// As [`follow`], with frames that find these patches alone.
fn follow_found(tracker: &mut Tracker, patches: &[Patch], found: &[usize], number: u64) -> Tracked {
    let (frame, found) = frame(patches, found, number);
    tracker.update_found(&frame, &found, number as f64 / 30.0, None).unwrap()
}

fn numbers(tracked: &Tracked) -> Vec<u16> {
    tracked.objects.iter().filter_map(|object| object.track).map(|track| track.0).collect()
}
