//! How a part slopes where another may stand on it (docs/CONTEXT.md 4.7.2 and 4.7.7).

use glam::DVec3;

use crate::clusters::scene::{LEVEL_DEG, Scene};

/// A pixel steeper than this is a side (degrees): it says nothing of what stands above it.
const STEEP_DEG: f64 = 65.0;

/// Numbers of pixels, and the cosines that tell them apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlopeCounts {
    level_cosine: f64,
    steep_cosine: f64,
    all: u32,
    level: u32,
    sliding: u32,
}

/// Shares of pixels, in [0, 1].
#[derive(Clone, Copy, Debug)]
pub(super) struct Slopes {
    /// A thing can stand on them.
    pub(super) level: f64,
    /// They are neither level nor steep: a thing slides off them.
    pub(super) sliding: f64,
}

impl SlopeCounts {
    pub(super) fn new() -> Self {
        let [level_cosine, steep_cosine] =
            [LEVEL_DEG, STEEP_DEG].map(|degrees| libm::cos(degrees.to_radians()));
        Self { level_cosine, steep_cosine, all: 0, level: 0, sliding: 0 }
    }

    /// Adds a pixel.
    pub(super) fn add(&mut self, scene: &Scene<'_>, up: DVec3, i: usize) {
        let cosine = up.dot(DVec3::from(scene.normals[i].map(f64::from)));
        self.all += 1;
        self.level += u32::from(cosine > self.level_cosine);
        self.sliding += u32::from(cosine > self.steep_cosine && cosine <= self.level_cosine);
    }

    /// The shares; 0 without pixels.
    pub(super) fn shares(self) -> Slopes {
        let share = |count| f64::from(count) / f64::from(self.all.max(1));
        Slopes { level: share(self.level), sliding: share(self.sliding) }
    }
}
