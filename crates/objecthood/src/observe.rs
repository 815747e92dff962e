//! The outputs of the stages, as observers see them: pictures, timings, tests.

use std::borrow::Cow;

use crate::clusters::clustering::Clustering;
use crate::discovery::Discovery;
use crate::discovery::support_graph::SupportGraph;
use crate::facets::Facets;
use crate::objectness::hypotheses::Hypothesis;
use crate::oversegment::structure::Structure as Planes;
use crate::raster::Raster;
use crate::regions::{RegionGraph, Segments};
use crate::shapes::border::BorderEvidence;
use crate::shapes::contraction::Shapes as Grouping;
use crate::stage::Stage;

/// A view of the output of a stage: one variant for each [`Stage`], in the same order.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Output<'a> {
    /// Unit normals towards the camera, zero where there is none.
    Normals(&'a Raster<[f32; 3]>),
    /// Curvature of every pixel, eq. 2 (`paper`).
    Curvature(&'a Raster<f32>),
    /// Large planes that carry or enclose the objects (`context`). They come first among superpixels and facets.
    Structure(LabelMap<'a>),
    /// Stage 1: small regions of one surface, in `paper` also of one colour.
    Superpixels(LabelMap<'a>),
    /// Stage 2: one face each of a convex shape.
    Facets(&'a Segments),
    /// The evidence from the common borders of facets (`context`), the input of stage 3.
    Borders {
        /// The facets of stage 2, with their surfaces.
        facets: &'a Facets,
        /// The evidence between any two neighbouring facets that are not both structure.
        evidence: &'a RegionGraph<BorderEvidence>,
    },
    /// Stage 3: facets joined across convex edges. In `context` shape 0 is all structure.
    Shapes(LabelMap<'a>),
    /// The shapes after the rules on their surroundings (`context`).
    Clusters {
        /// The facets after the gaps between them are filled.
        facets: &'a Facets,
        /// The clusters, the events that joined them, and the joins that rules refused.
        clusters: &'a Clustering,
    },
    /// Stage 4: the support graph. Objects are not decided yet.
    Support {
        /// Which region stands on which.
        graph: &'a SupportGraph,
        /// Node k of the graph is region k. The regions are the shapes in `paper`, structure and clusters in `context`.
        regions: &'a Segments,
    },
    /// Stage 4: the regions that may be objects, with their scores.
    Hypotheses(&'a [Hypothesis]),
    /// Stage 4: the outcome.
    Objects(&'a Discovery),
}

impl Output<'_> {
    /// The stage whose output this is.
    pub fn stage(&self) -> Stage {
        match self {
            Self::Normals(_) => Stage::Normals,
            Self::Curvature(_) => Stage::Curvature,
            Self::Structure(_) => Stage::Structure,
            Self::Superpixels(_) => Stage::Superpixels,
            Self::Facets(_) => Stage::Facets,
            Self::Borders { .. } => Stage::Borders,
            Self::Shapes(_) => Stage::Shapes,
            Self::Clusters { .. } => Stage::Clusters,
            Self::Support { .. } => Stage::Support,
            Self::Hypotheses(_) => Stage::Hypotheses,
            Self::Objects(_) => Stage::Objects,
        }
    }
}

/// A label map that is assembled on demand. The method itself stores structure and superpixels apart.
#[derive(Clone, Copy, Debug)]
pub struct LabelMap<'a>(Parts<'a>);

#[derive(Clone, Copy, Debug)]
enum Parts<'a> {
    Whole(&'a Segments),
    Structure(&'a Planes),
    Superpixels(&'a Planes, &'a Segments),
    Shapes(&'a Facets, &'a Grouping),
}

impl<'a> LabelMap<'a> {
    /// Of the structure alone.
    pub(crate) fn structure(structure: &'a Planes) -> Self {
        Self(Parts::Structure(structure))
    }

    /// First the structure, then the superpixels of the other pixels.
    pub(crate) fn superpixels(structure: &'a Planes, superpixels: &'a Segments) -> Self {
        Self(Parts::Superpixels(structure, superpixels))
    }

    /// First all structure, then the shapes of the other facets.
    pub(crate) fn shapes(facets: &'a Facets, shapes: &'a Grouping) -> Self {
        Self(Parts::Shapes(facets, shapes))
    }

    /// The label map. O(pixels), or O(1) when it is stored as a whole.
    pub fn segments(self) -> Cow<'a, Segments> {
        match self.0 {
            Parts::Whole(segments) => Cow::Borrowed(segments),
            Parts::Structure(structure) => Cow::Owned(structure.segments()),
            Parts::Superpixels(structure, superpixels) => Cow::Owned(structure.with(superpixels)),
            Parts::Shapes(facets, shapes) => Cow::Owned(shapes.with_structure(facets)),
        }
    }
}

impl<'a> From<&'a Segments> for LabelMap<'a> {
    fn from(segments: &'a Segments) -> Self {
        Self(Parts::Whole(segments))
    }
}

/// Receives the output of every stage.
pub trait Observer {
    /// Called once for every stage of the method, in the order of the stages, as soon as its output exists.
    fn observe(&mut self, output: Output<'_>);
}

/// Ignores all outputs.
impl Observer for () {
    fn observe(&mut self, _: Output<'_>) {}
}
