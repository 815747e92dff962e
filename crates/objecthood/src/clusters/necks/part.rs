//! What the kinds of evidence need to know about a part alone (docs/CONTEXT.md 4.7).

use std::sync::OnceLock;

use glam::DVec3;

use crate::clusters::cluster::Clusters;
use crate::clusters::colors::Colors;
use crate::clusters::necks::ball::Ball;
use crate::clusters::necks::limits::FOOT_SHARE;
use crate::clusters::necks::symmetry::Shaft;
use crate::clusters::necks::underside::Underside;
use crate::regions::SegmentId;

/// A part and its measurements. Each is made once in a round, when the first of its pairs needs it.
pub(super) struct Part<'a> {
    pub(super) id: SegmentId,
    clusters: &'a Clusters<'a>,
    up: DVec3,
    foot_m: OnceLock<f64>,
    underside: OnceLock<Underside>,
    colors: OnceLock<Colors>,
    shaft: OnceLock<Option<Shaft>>,
    ball: OnceLock<Option<Ball>>,
}

impl<'a> Part<'a> {
    /// Measures nothing yet.
    pub(super) fn new(clusters: &'a Clusters<'a>, up: DVec3, id: SegmentId) -> Self {
        let (foot_m, underside, colors) = Default::default();
        Self { id, clusters, up, foot_m, underside, colors, shaft: OnceLock::new(), ball: OnceLock::new() }
    }

    /// Its pixels, in scan order.
    pub(super) fn pixels(&self) -> &'a [u32] {
        &self.clusters.get(self.id).pixels
    }

    /// The height (m) of its foot above its own support.
    pub(super) fn foot_m(&self) -> f64 {
        *self.foot_m.get_or_init(|| self.clusters.scene.own_height_m(self.pixels(), FOOT_SHARE))
    }

    pub(super) fn underside(&self) -> Underside {
        *self.underside.get_or_init(|| Underside::of(self.clusters, self.id))
    }

    pub(super) fn colors(&self) -> &Colors {
        self.colors.get_or_init(|| Colors::of(self.clusters.scene, self.pixels()))
    }

    /// The part as a shaft, if it is slim.
    pub(super) fn shaft(&self) -> Option<&Shaft> {
        self.shaft.get_or_init(|| Shaft::of(self.clusters, self.up, self.id)).as_ref()
    }

    /// The part as a ball, if it is round.
    pub(super) fn ball(&self) -> Option<&Ball> {
        self.ball.get_or_init(|| Ball::of(self.clusters, self.up, self.id)).as_ref()
    }
}
