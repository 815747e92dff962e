//! The contents of an explanation: plain data, from which text, JSON and pictures are made.

use serde::{Serialize, Serializer};

use crate::check::Check;
use crate::clusters::history::Rule;

/// The explanation of a pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explanation {
    /// The pixel: column and row.
    pub pixel: [usize; 2],
    /// Its depth (m), if it was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth_m: Option<f32>,
    /// The outcome for the pixel.
    pub outcome: Outcome,
    /// Its facet, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub facet: Option<FacetReport>,
    /// Whether the thing of the facet is an object; for structure, whether the pixel belongs to one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kept: Option<Decision>,
    /// The borders of the facet, the longest first.
    pub borders: Vec<BorderReport>,
    /// The decisions of rules about the thing of the facet.
    pub way: Vec<Decision>,
    /// The decisions of rules that were nearly met.
    pub near_misses: Vec<Decision>,
    /// The object, or the rejected hypothesis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub object: Option<ObjectReport>,
}

impl Explanation {
    /// All decisions, the most important first.
    pub fn decisions(&self) -> impl Iterator<Item = &Decision> {
        let borders = self.borders.iter().filter_map(|border| border.decision.as_ref());
        self.kept.iter().chain(&self.way).chain(&self.near_misses).chain(borders)
    }

    /// All decisions, mutable.
    pub(super) fn decisions_mut(&mut self) -> impl Iterator<Item = &mut Decision> {
        let borders = self.borders.iter_mut().filter_map(|border| border.decision.as_mut());
        self.kept.iter_mut().chain(&mut self.way).chain(&mut self.near_misses).chain(borders)
    }
}

/// The outcome for a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Outcome {
    /// The pixel has no depth.
    NoDepth,
    /// The pixel has depth, but lies on no large enough surface.
    NoFacet,
    /// The pixel belongs to a large plane: table, floor, wall.
    Structure {
        /// The number of the plane in the label image of the structure.
        plane: u32,
    },
    /// The pixel belongs to a thing that a rule gave to the background.
    Background {
        /// The number of the plane in the label image of the structure; 0 = none, because there is no support.
        plane: u16,
    },
    /// The pixel belongs to a thing with too few pixels.
    TooSmall,
    /// The pixel belongs to a thing with too little objectness.
    Unlikely,
    /// The pixel belongs to an object.
    Object {
        /// Its number in the label image.
        object: u16,
    },
}

/// The facet of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FacetReport {
    /// Its number.
    pub facet: u32,
    /// Number of its pixels.
    pub size_px: usize,
    /// How far the pixel lies in front of the facet's surface (quanta of disparity).
    pub residual_quanta: f64,
    /// Root mean square distance of the facet's pixels from its surface (quanta).
    pub mean_residual_quanta: f64,
    /// The number of the structure plane, if it is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub structure_plane: Option<u32>,
}

/// The border of the facet with another one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BorderReport {
    /// The other facet.
    pub facet: u32,
    /// The number of that structure plane, if the other facet is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub structure_plane: Option<u32>,
    /// Mean angle of the folds (degrees): above 0 = ridge, convex; below 0 = valley, concave. `None` without folds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_angle_deg: Option<f64>,
    /// How far this facet lies in front of the other one at the border, on average (quanta of disparity).
    pub gap_quanta: f64,
    /// The same in depth (mm).
    pub gap_mm: f64,
    /// Length of the border that is a fold (mm).
    pub folded_mm: f64,
    /// Length of the border that is a step in depth (mm).
    pub stepped_mm: f64,
    /// Length of the border that runs along a seam of colour (mm).
    pub seam_mm: f64,
    /// Length of the folds (mm), if the two facets have different colours; else 0.
    pub color_change_mm: f64,
    /// Its vote (mm of border): above 0 for one shape, below 0 for two. `None` with structure, whose borders do not vote.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vote_mm: Option<f64>,
    /// Whether both are one thing. `None` with structure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decision: Option<Decision>,
}

/// A question about facets, with the answer and its reason.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Decision {
    /// The question.
    pub question: Question,
    /// The answer.
    pub yes: bool,
    /// The reason for the answer.
    pub reason: Reason,
    /// The measured values with their limits, if a rule or a filter decided.
    pub checks: Vec<Check>,
    /// The parameter value that would turn the answer.
    pub flip: Flip,
}

/// A question about facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Question {
    /// Are these two one thing?
    OneThing {
        /// The facets.
        facets: [u32; 2],
    },
    /// Is the thing of this facet an object?
    Kept {
        /// The facet.
        facet: u32,
    },
    /// Does this pixel of a structure plane belong to an object?
    OfObject {
        /// Its column and row.
        pixel: [usize; 2],
    },
    /// Is a patch of the background the bottom of the thing of this facet?
    Bottom {
        /// The facet.
        facet: u32,
        /// The first pixel of the patch in scan order: column and row.
        patch: [usize; 2],
    },
}

/// The reason for a decision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// The folds of the border: ridges for one shape, valleys for two.
    Folds,
    /// The steps of the border.
    Steps,
    /// Colour changes at a border whose folds and steps alone would vote for one shape.
    Colors,
    /// A seam of colour.
    Seam,
    /// The votes of other borders, against the vote of the common border.
    OtherBorders,
    /// It has too few pixels.
    Size,
    /// It has too little objectness.
    Objectness,
    /// It lies on a large plane that carries or encloses things.
    Structure,
    /// It looks like the large plane beside it, and is nearer to its border than depth can resolve.
    Skirt,
    /// It lies flat on a support, and rises above it or has other colours.
    Flat,
    /// No rule or filter refused it.
    Passed,
    /// A rule of stage 4.
    #[serde(untagged)]
    Rule(Rule),
}

/// Writes a value so that it can be set again: parameters of whole numbers accept no decimal point, not even `.0`.
pub(super) fn as_set<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    let whole = *value as i64;
    if whole as f64 == *value { serializer.serialize_i64(whole) } else { serializer.serialize_f64(*value) }
}

/// A change of one parameter that turns a decision.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Flip {
    /// A run of the whole method with this value decides otherwise.
    At {
        /// The parameter.
        parameter: &'static str,
        /// Its present value.
        #[serde(serialize_with = "as_set")]
        from: f64,
        /// The value that turns the decision.
        #[serde(serialize_with = "as_set")]
        to: f64,
        /// Whether a run with the value half way does not decide otherwise, or there is no value half way. If false, values nearer than
        /// `to` may turn the decision too.
        is_tight: bool,
    },
    /// A run of the whole method with this switch off decides otherwise. It is reported if no number was
    /// found, because a rule has limits that no parameter sets.
    /// sets.
    Off {
        /// The parameter of the switch, which is on.
        parameter: &'static str,
    },
    /// No flip was found: the method did not decide otherwise with any value that the evidence suggested.
    Nowhere {
        /// The parameters that were tried, one at a time; empty when the evidence suggested no value.
        tried: Vec<&'static str>,
    },
    /// The search was not done or not finished, because its budget was spent.
    NotSought,
}

/// The object of a pixel, or a rejected hypothesis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ObjectReport {
    /// Its number in the label image, if it is an object.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub object: Option<u16>,
    /// Its objectness, in [0, 1].
    pub objectness: f32,
    /// The parts of the objectness.
    pub parts: Vec<Part>,
    /// Number of its pixels.
    pub size_px: usize,
    /// Its facets; structure planes among them are its bottom.
    pub facets: Vec<u32>,
}

/// A part of an objectness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Part {
    /// Its name.
    pub name: &'static str,
    /// Its value, in [0, 1].
    pub value: f64,
}
