//! What an explanation says: plain data, from which text, JSON and pictures are made.

use serde::{Serialize, Serializer};

use crate::clusters::check::Check;
use crate::clusters::history::Rule;

/// Why a pixel is what it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explanation {
    /// The pixel: column and row.
    pub pixel: [usize; 2],
    /// Its depth (m), if it was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth_m: Option<f32>,
    /// What it is.
    pub outcome: Outcome,
    /// Its facet, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub facet: Option<FacetReport>,
    /// Whether the thing that the facet belongs to is an object; of structure, whether the pixel is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kept: Option<Decision>,
    /// The borders of the facet, the longest first.
    pub borders: Vec<BorderReport>,
    /// What rules did with the thing that the facet belongs to.
    pub way: Vec<Decision>,
    /// What rules nearly did with it.
    pub near_misses: Vec<Decision>,
    /// The object, or what might have been one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub object: Option<ObjectReport>,
}

impl Explanation {
    /// Everything that was decided, what matters most first.
    pub fn decisions(&self) -> impl Iterator<Item = &Decision> {
        let borders = self.borders.iter().filter_map(|border| border.decision.as_ref());
        self.kept.iter().chain(&self.way).chain(&self.near_misses).chain(borders)
    }

    /// The same, to change.
    pub(super) fn decisions_mut(&mut self) -> impl Iterator<Item = &mut Decision> {
        let borders = self.borders.iter_mut().filter_map(|border| border.decision.as_mut());
        self.kept.iter_mut().chain(&mut self.way).chain(&mut self.near_misses).chain(borders)
    }
}

/// What a pixel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Outcome {
    /// Nothing was measured here.
    NoDepth,
    /// It was measured, but lies on no surface that is large enough.
    NoFacet,
    /// Of a large plane: table, floor, wall.
    Structure {
        /// Which one: its number in the label image of the structure.
        plane: u32,
    },
    /// Of a thing that was taken for a part of the structure.
    Background {
        /// Of which plane; 0 = of none, because there is none to stand on.
        plane: u16,
    },
    /// Of a thing that has too few pixels.
    TooSmall,
    /// Of a thing for which too little speaks.
    Unlikely,
    /// Of an object.
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
    /// Its pixels (px).
    pub size_px: usize,
    /// How far the pixel is before the facet's surface (quanta of disparity).
    pub residual_quanta: f64,
    /// How far its pixels are from the surface, root mean square (quanta).
    pub mean_residual_quanta: f64,
    /// Which structure plane it is, if it is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub structure_plane: Option<u32>,
}

/// What the border of the facet with another one tells.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BorderReport {
    /// The other facet.
    pub facet: u32,
    /// Which structure plane that is, if it is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub structure_plane: Option<u32>,
    /// Mean angle of the folds (degrees): above 0 = ridge, convex; below 0 = valley, concave. `None` without folds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_angle_deg: Option<f64>,
    /// How far this facet is before the other one where they meet, on average (quanta of disparity).
    pub gap_quanta: f64,
    /// The same in depth (mm).
    pub gap_mm: f64,
    /// How much of the border is a fold (mm).
    pub folded_mm: f64,
    /// How much of it is a step in depth (mm).
    pub stepped_mm: f64,
    /// Its vote (mm of border): above 0 for one shape, below 0 for two. `None` with structure, which is not asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vote_mm: Option<f64>,
    /// Whether both are one thing. `None` with structure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decision: Option<Decision>,
}

/// Something that was decided.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Decision {
    /// What.
    pub question: Question,
    /// The answer.
    pub yes: bool,
    /// What decided.
    pub reason: Reason,
    /// What was measured, if a rule or a filter decided.
    pub checks: Vec<Check>,
    /// What it would take to decide otherwise.
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
    /// Is the thing that this one belongs to an object?
    Kept {
        /// The facet.
        facet: u32,
    },
    /// Is this pixel of a structure plane of an object?
    OfObject {
        /// Its column and row.
        pixel: [usize; 2],
    },
    /// Is a patch of the background the bottom of the thing that this one belongs to?
    Bottom {
        /// The facet.
        facet: u32,
        /// The first pixel of the patch in scan order: column and row.
        patch: [usize; 2],
    },
}

/// What decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// The folds of the border: ridges for one shape, valleys for two.
    Folds,
    /// The steps of the border.
    Steps,
    /// The votes of other borders, against that of their own.
    OtherBorders,
    /// It has too few pixels.
    Size,
    /// Too little speaks for it.
    Objectness,
    /// It lies on a large plane that carries or encloses things.
    Structure,
    /// Nothing spoke against it.
    Passed,
    /// A rule of stage 4.
    #[serde(untagged)]
    Rule(Rule),
}

/// A value in the form in which it can be set: parameters that count take no fraction, not even of 0.
fn as_set<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    let whole = *value as i64;
    if whole as f64 == *value { serializer.serialize_i64(whole) } else { serializer.serialize_f64(*value) }
}

/// Which single parameter decides otherwise, and where.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Flip {
    /// With this value the whole method decides otherwise: that was tried.
    At {
        /// The parameter.
        parameter: &'static str,
        /// Its value now.
        #[serde(serialize_with = "as_set")]
        from: f64,
        /// Its value then.
        #[serde(serialize_with = "as_set")]
        to: f64,
        /// Whether half way to it the method does not decide otherwise yet: that was tried, or there is no value half way. If
        /// not, values nearer than `to` may do the same.
        is_tight: bool,
    },
    /// No flip was found: the method did not decide otherwise with the values that the evidence named.
    Nowhere {
        /// The parameters with which it was run, one at a time; none when the evidence named no value of any parameter.
        tried: Vec<&'static str>,
    },
    /// It was not looked for, or not to the end: more was asked than can be tried in a short time.
    NotSought,
}

/// The object of a pixel, or what might have been one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ObjectReport {
    /// Its number in the label image, if it is an object.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub object: Option<u16>,
    /// How sure it is, in [0, 1].
    pub objectness: f32,
    /// What that is made of.
    pub parts: Vec<Part>,
    /// Its pixels (px).
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
