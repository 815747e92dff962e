//! Seams: joints of flush things, which only colour shows (docs/CONTEXT.md 3.4).
//!
//! Two boxes that stand flush share faces: no fold and no step separates them. They meet in a plane, whose
//! trace runs across every face of the joint body. Along the whole trace the colour changes, and the colours
//! on one side do not occur on the other. Print does not do both: it ends within a face, or its colours come
//! back on the other side. Where two things share one face only, the outline of this face shows the joint
//! (`face.rs`).

mod axes;
mod body;
mod face;
mod outline;
mod profile;
mod side_colors;
#[cfg(test)]
mod tests;
mod trace;

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use rayon::prelude::*;

use crate::check::{Bound, Check};
use crate::color::LEAST_UNLIKE_SHADOW;
use crate::color::image::LabImage;
use crate::facets::Facets;
use crate::oversegment::structure::Structure;
use crate::params::{self, Params};
use crate::raster::Raster;
use crate::regions::{RegionGraph, Segments};
use crate::shapes::border::{BorderEvidence, measure_borders};
use crate::shapes::contraction::{Shapes, contract, sum_votes};
use crate::shapes::seams::axes::find_axes;
use crate::shapes::seams::body::{Body, BodyPixel, Face, LEAST_PIECE_PX, connected_pieces};
use crate::shapes::seams::profile::{LEAST_MEASURED, find_traces};
use crate::shapes::seams::side_colors::{SideColors, ToldApart};
use crate::shapes::seams::trace::Trace;
use crate::surface::disparity::DisparitySpace;
use crate::surface::surfaces::Surfaces;

/// A body is divided by at most this many seams.
const MOST_SEAMS: usize = 8;
/// A trace of this clearness is no seam, whatever the colours beside it: print and shading are as clear.
const FAINT: f64 = 0.25;
/// Where less than this share of the stripes of the best measured place is seen, both sides of a body share
/// at most half as many colours.
const WELL_MEASURED: f64 = 0.5;
/// Where colour changes on two faces or more, the colours of both sides may overlap by this multiple: print
/// seldom goes on around an edge, at the same place.
const AROUND_FACTOR: f64 = 5.0 / 3.0;
/// Colour changes on a face on which the colours of both sides overlap by at most this multiple of what they may
/// on the whole body: a face shows a part of each side, so it tells less ...
const FACE_FACTOR: f64 = 3.0;
/// ... and that has at least this many pixels of each side (px of any camera: they are samples of colours).
const LEAST_AROUND_PX: usize = 160;
/// The two sides are even, like things of one colour each, if their colours are confused at most this often
/// (shares of both sides added up).
const MOST_CONFUSED: f64 = 0.05;
/// The change of colour at a joint is at least this share of the difference of its sides: a gradient also
/// changes beside it.
const LEAST_STEP: f64 = 0.3;
/// The darker side follows the light from face to face, as paint does, if the share is at least this; a
/// shadow does not.
const LEAST_FOLLOWED: f64 = 0.75;
/// A narrow side that shares more colours than this with what lies beyond it, twice as many as two things
/// share, is no thing.
const GOES_ON: f64 = 0.25;

/// The plane along which a body of facets was divided.
#[derive(Clone, Debug, PartialEq)]
pub struct Seam {
    /// The checks that it passed: measured values with their limits.
    pub checks: Vec<Check>,
}

/// The seams of a body that lead to one of its pieces: their numbers, and whether the piece lies above each.
type Sides = Vec<(usize, bool)>;

/// The facets after seams divided them, with their borders and shapes.
#[derive(Clone, Debug)]
pub struct Seams {
    /// The facets. A facet that a seam crosses is cut: the first piece keeps its number, the others come
    /// last.
    pub facets: Facets,
    /// Their borders; those that run along seams are marked.
    pub borders: RegionGraph<BorderEvidence>,
    /// Their shapes.
    pub shapes: Shapes,
    /// The seams, and on which side of them each facet lies.
    pub cuts: Cuts,
}

/// The seams, and on which side of them each facet lies.
#[derive(Clone, Debug)]
pub struct Cuts {
    seams: Vec<Seam>,
    /// For each facet the seams along which its body was divided, and its side of each.
    sides: Vec<Sides>,
}

/// Facets with their borders and shapes.
pub(crate) type Shaped<'a> = (&'a Facets, &'a RegionGraph<BorderEvidence>, &'a Shapes);

impl Seams {
    /// The final facets, borders and shapes: those `before` seams if there is no seam.
    pub(crate) fn or<'a>(seams: &'a Option<Self>, before: Shaped<'a>) -> Shaped<'a> {
        seams.as_ref().map_or(before, |seams| (&seams.facets, &seams.borders, &seams.shapes))
    }
}

impl Cuts {
    /// The seam between two facets; `None` if there is none, or they are of two bodies. O(seams of the body).
    pub fn between(&self, a: usize, b: usize) -> Option<&Seam> {
        let mut ways = self.sides[a].iter().zip(&self.sides[b]);
        let ((seam, _), _) = ways.find(|(a, b)| a != b).filter(|(a, b)| a.0 == b.0)?;
        Some(&self.seams[*seam])
    }

    /// The evidence of the borders of the facets, with those marked that run along seams. O(borders).
    pub(crate) fn mark(&self, borders: RegionGraph<BorderEvidence>) -> RegionGraph<BorderEvidence> {
        borders.update(|[a, b], evidence| {
            if self.between(a.index(), b.index()).is_some() {
                evidence.seam_m = evidence.gaps.length_m;
                // A seam is this change of colour.
                evidence.color_change_m = 0.0;
            }
        })
    }

    /// Cuts the facets at the seams of all bodies. What seams leave of a facet in several places, of at least
    /// `least_px` pixels each, becomes several facets: the wall of a tray is one face with two things that
    /// stand behind it. O(pixels of the bodies).
    fn make(partings: Vec<Parting>, facets: &Facets, least_px: usize) -> (Self, Facets) {
        let mut labels = facets.segments.labels().clone();
        let width = labels.width();
        let mut models = facets.models.clone();
        let mut cuts = Self { seams: Vec::new(), sides: vec![Sides::new(); models.len()] };
        for parting in partings {
            let first = cuts.seams.len();
            let mut seen = BTreeSet::new();
            for (pixels, sides) in parting.parts_of_facets(width, least_px) {
                let sides: Sides = sides.iter().map(|&(seam, is_above)| (first + seam, is_above)).collect();
                let facet = pixels[0].facet as usize;
                if seen.insert(facet) {
                    cuts.sides[facet] = sides;
                    continue;
                }
                let number = models.len() as i32;
                pixels.iter().for_each(|p| labels.as_mut_slice()[p.i as usize] = number);
                models.push(models[facet]);
                cuts.sides.push(sides);
            }
            cuts.seams.extend(parting.seams);
        }
        let segments = Segments::from_numbered(labels, models.len());
        (cuts, Facets { segments, models, structure: facets.structure, flats: facets.flats.clone() })
    }
}

/// Finds seams in the bodies that borders have made (the `shapes` of the `facets`), cuts the facets that they
/// cross, and joins the resulting pieces into shapes.
///
/// Planes across the body are compared, perpendicular to its axes. The clearest is a seam if colour changes
/// along at least `cross_share` of its trace, and the colours of its two sides overlap little. Then both
/// sides are searched, and finally each face by itself. `None` if there is no seam, or no colour. Source:
/// ours, because the paper has no colour in this stage. O(pixels of bodies · axes of a body); parallel over
/// bodies.
pub fn find_seams(
    (facets, shapes): (&Facets, &Shapes),
    structure: &Structure,
    surfaces: &Surfaces,
    params: &Params,
) -> Option<Seams> {
    let (space, up) = (&surfaces.space, structure.ground_normal());
    let lab = surfaces.lab_for_shapes().filter(|_| params.seams.enabled)?;
    let size = facets.segments.labels().size();
    let disparity = &surfaces.disparity;
    let search = Search { facets, shapes, lab, space, disparity, params: &params.seams, up, size };
    let partings = search.part_all();
    if partings.is_empty() {
        return None;
    }
    let (cuts, facets) = Cuts::make(partings, facets, space.area_px(LEAST_PIECE_PX));
    let borders = cuts.mark(measure_borders(&facets, surfaces, &params.border));
    let shapes = contract(&sum_votes(&borders, facets.structure, &params.contraction));
    Some(Seams { facets, borders, shapes, cuts })
}

/// The seams of a body, and its pieces.
struct Parting {
    seams: Vec<Seam>,
    pieces: Vec<Piece>,
}

impl Parting {
    /// The parts of the facets of all pieces: a facet that no seam crosses is one part.
    fn parts_of_facets(&self, width: usize, least_px: usize) -> Vec<(Cow<'_, [BodyPixel]>, &Sides)> {
        let facets = || self.pieces.iter().flat_map(|piece| piece.body.facets().map(|p| (p, &piece.sides)));
        let mut pieces_with = BTreeMap::new();
        facets().for_each(|(pixels, _)| *pieces_with.entry(pixels[0].facet).or_insert(0) += 1);
        let parts = facets().flat_map(|(pixels, sides)| {
            let parts = match pieces_with[&pixels[0].facet] {
                1 => vec![Cow::Borrowed(pixels)],
                _ => connected_pieces(pixels, width, least_px).into_iter().map(Cow::Owned).collect(),
            };
            parts.into_iter().map(move |part| (part, sides))
        });
        parts.collect()
    }

    /// Records a seam, with what lies below and above it.
    fn cut(&mut self, body: &Body, sides: &Sides, trace: &Trace, seam: Seam) -> [Piece; 2] {
        let number = self.seams.len();
        self.seams.push(seam);
        [false, true].map(|is_above| Piece {
            body: body.side(trace, is_above),
            sides: sides.iter().copied().chain([(number, is_above)]).collect(),
        })
    }
}

/// A piece of a body; its seams are numbered from 0.
struct Piece {
    body: Body,
    sides: Sides,
}

/// The inputs of the search.
struct Search<'a> {
    facets: &'a Facets,
    shapes: &'a Shapes,
    lab: &'a LabImage,
    space: &'a DisparitySpace,
    /// Disparity (quanta) of the image.
    disparity: &'a Raster<f32>,
    params: &'a params::Seams,
    up: Option<DVec3>,
    /// Columns and rows of the image.
    size: (usize, usize),
}

impl Search<'_> {
    /// The divisions of the bodies that have seams, in the order of the shapes.
    fn part_all(&self) -> Vec<Parting> {
        let bodies = Body::of_shapes(self.facets, self.shapes, self.lab, self.space);
        let bodies = bodies.into_par_iter().with_max_len(1);
        bodies.map(|body| self.part(body)).filter(|parting| !parting.seams.is_empty()).collect()
    }

    /// Divides a body along its seams, the clearest first.
    fn part(&self, body: Body) -> Parting {
        let mut parting = Parting { seams: Vec::new(), pieces: Vec::new() };
        let mut open = vec![Piece { body, sides: Vec::new() }];
        while let Some(piece) = open.pop() {
            if parting.seams.len() == MOST_SEAMS {
                parting.pieces.push(piece);
                continue;
            }
            let traces = self.find_traces(&piece.body);
            match clearest(&traces, |trace| self.passed(&piece.body, trace)) {
                Some((trace, seam)) => open.extend(parting.cut(&piece.body, &piece.sides, trace, seam)),
                None => self.part_faces(piece, traces, &mut parting),
            }
        }
        parting
    }

    /// The traces along which the colour of a body changes.
    fn find_traces(&self, body: &Body) -> Vec<Trace> {
        let axes = find_axes(body, self.up).into_iter();
        axes.flat_map(|axis| find_traces(body, axis, self.params.cross_share, self.space)).collect()
    }

    /// The shape of a label of the facets; `None` of structure, and where there is no facet.
    fn shape_of(&self, label: i32) -> Option<u32> {
        let free = usize::try_from(label).ok()?.checked_sub(self.facets.structure)?;
        Some(self.shapes.of_facet[free])
    }

    /// The checks of a seam that passes them. The clearer it is, the more colours its sides may share. If
    /// their colours are hardly ever confused, they may share as many as at the clearest.
    fn passed(&self, body: &Body, trace: &Trace) -> Option<Vec<Check>> {
        let clear = (trace.clearness - FAINT) / (1.0 - FAINT);
        // No overlap is below 0.
        if clear < 0.0 {
            return None;
        }
        let colors = SideColors::of(body, trace);
        let overlap = colors.overlap();
        // Most traces fail here, before all pixels of their sides are examined.
        if overlap > AROUND_FACTOR * self.params.color_overlap {
            return None;
        }
        let most = self.params.color_overlap * self.overlap_factor(body, trace, &colors);
        if overlap > most {
            return None;
        }
        let is_clear = overlap <= clear * most;
        let mut checks = self.check_colors(trace, overlap, if is_clear { clear * most } else { most });
        match colors.tell_apart() {
            Some(ToldApart { confused, difference }) => {
                let what = "contrast at the joint, as a share of the difference of both sides";
                let step = trace.contrast / difference;
                checks.push(Check::new(what, "", step, Bound::AtLeast, LEAST_STEP));
                let what = "share of colours that are taken for those of the other side";
                let even = Check::new(what, "", confused, Bound::AtMost, MOST_CONFUSED);
                checks.extend((!is_clear).then_some(even));
            }
            None if is_clear => {}
            None => return None,
        }
        checks.extend(self.check_light(body, trace, &colors, GOES_ON));
        if trace.measured < WELL_MEASURED {
            let what = "stripes that show it, as a share of those of the best place";
            checks.push(Check::new(what, "", trace.measured, Bound::AtLeast, LEAST_MEASURED));
        }
        checks.iter().all(Check::holds).then_some(checks)
    }

    /// How many times as much the colours of both sides may overlap: where little of the section is seen, they
    /// have to say more, and where colour changes on several faces, less. O(sampled pixels).
    fn overlap_factor(&self, body: &Body, trace: &Trace, colors: &SideColors) -> f64 {
        if trace.measured < WELL_MEASURED {
            return 0.5;
        }
        let most = FACE_FACTOR * self.params.color_overlap;
        let changes = |(k, face): &(usize, &Face)| {
            let overlap = || colors.overlap_of_face(*k, LEAST_AROUND_PX);
            face.is_flat && !face.is_across(trace.axis) && overlap().is_some_and(|overlap| overlap <= most)
        };
        if body.faces.iter().enumerate().filter(changes).count() > 1 { AROUND_FACTOR } else { 1.0 }
    }

    /// Checks that colour changes along a trace, and that its two sides share at most this many colours.
    fn check_colors(&self, trace: &Trace, overlap: f64, most: f64) -> Vec<Check> {
        let (share, least) = (trace.share, self.params.cross_share);
        vec![
            Check::new("share of the section where colour changes", "", share, Bound::AtLeast, least)
                .set_by("seams.cross_share"),
            Check::new("overlap of the colours of both sides", "", overlap, Bound::AtMost, most)
                .set_by("seams.color_overlap"),
        ]
    }

    /// Checks that a trace is no edge of a shadow, and that a narrow side of it shares at most this many
    /// colours with what lies beyond.
    fn check_light(&self, body: &Body, trace: &Trace, colors: &SideColors, most: f64) -> [Check; 2] {
        let own = body.faces.first().and_then(|face| self.shape_of(face.pixels[0].facet as i32));
        let beyond = body.overlap_beyond(trace, self.space, |point| {
            let i = self.space.camera().pixel_at(point, self.size)?;
            (self.shape_of(self.facets.segments.labels()[i]) != own).then(|| self.lab[i])
        });
        let darker = "difference of the darker side from the other in less light";
        let follows = "share of the light's differences between faces that the darker side follows";
        let unlike = Check::new(darker, "ΔE", colors.unlike_shadow(), Bound::AtLeast, LEAST_UNLIKE_SHADOW);
        let shadow = if unlike.holds() {
            unlike
        } else {
            Check::new(follows, "", colors.follows_light(), Bound::AtLeast, LEAST_FOLLOWED)
        };
        let what = "overlap of the colours of a narrow side and beyond it";
        [shadow, Check::new(what, "", beyond, Bound::AtMost, most)]
    }
}

/// The clearest of the traces that pass these checks; on ties the first.
fn clearest(traces: &[Trace], passed: impl Fn(&Trace) -> Option<Vec<Check>>) -> Option<(&Trace, Seam)> {
    let passed = traces.iter().filter_map(|trace| Some((trace, Seam { checks: passed(trace)? })));
    passed.reduce(|best, next| if next.0.clearness > best.0.clearness { next } else { best })
}
