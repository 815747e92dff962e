//! A body: facets that their borders have joined, with their pixels in space.

use std::cmp::Reverse;
use std::ops::Range;

use glam::DVec3;

use crate::color::histogram::ColorHistogram;
use crate::color::image::LabImage;
use crate::facets::Facets;
use crate::regions::{SegmentId, connect};
use crate::shapes::contraction::Shapes;
use crate::shapes::seams::trace::Trace;
use crate::surface::disparity::{DisparitySpace, position};

/// A smaller body is not searched: one of its sides would be too small for an object (px at 525 px).
const LEAST_BODY_PX: usize = 500;
/// A face is flat if its normal turns by less than this on average (degrees); noise turns that of a quadratic
/// by half of it.
const FLAT_DEG: f64 = 10.0;
/// A body with a smaller share of its pixels on flat faces is not searched, so that a can's label or a
/// bottle's cap is no joint.
const FLAT_SHARE: f64 = 0.7;
/// About this many pixels of a face show whether it is flat.
const NORMALS: usize = 32;
/// Two flat facets lie in one plane if their normals are this close (degrees), and the middle of the smaller
/// lies this near (quanta) to the plane of the larger one.
const SAME_PLANE_DEG: f64 = 10.0;
const SAME_PLANE_QUANTA: f64 = 2.0;
/// A face whose normal is within this cosine of an axis lies across it: it shows no trace.
const ACROSS: f64 = 0.8;
/// A smaller connected piece (px at 525 px) is no facet of its own: it is too small for the plane of a border
/// side.
pub(super) const LEAST_PIECE_PX: usize = 40;
/// Depth that is measured over windows of an image reaches at most this far beyond the edge of a near thing
/// (px at 525 px).
const FATTENED_PX: f64 = 16.0;

/// A pixel of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyPixel {
    /// Its place in the image.
    pub(super) i: u32,
    /// The number of its facet.
    pub(super) facet: u32,
    /// Its colour: L\*a\*b\*.
    pub(super) color: [f32; 3],
    /// The point (m) on the surface of its facet, which has less noise than the measured one.
    pub(super) point: DVec3,
}

/// The facets of a body that lie in one plane, or a part of them.
#[derive(Clone, Debug)]
pub(super) struct Face {
    /// Its pixels, facet by facet in scan order; at least one.
    pub(super) pixels: Vec<BodyPixel>,
    /// The mean point (m) of the largest facet, and its unit normal there, towards the camera.
    middle: DVec3,
    pub(super) normal: DVec3,
    /// Whether its normal is nearly the same everywhere.
    pub(super) is_flat: bool,
}

impl Face {
    /// Whether it lies across an axis: then it shows no trace.
    pub(super) fn is_across(&self, axis: DVec3) -> bool {
        self.normal.dot(axis).abs() > ACROSS
    }

    /// Whether another, smaller face lies in its plane.
    fn continues(&self, other: &Self, space: &DisparitySpace) -> bool {
        let is_parallel = self.normal.dot(other.normal) > libm::cos(SAME_PLANE_DEG.to_radians());
        let apart_m = (other.middle - self.middle).dot(self.normal).abs();
        let is_near = apart_m < space.step_m(SAME_PLANE_QUANTA, other.middle.z);
        self.is_flat && other.is_flat && is_parallel && is_near
    }
}

/// The faces of a body.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub(super) faces: Vec<Face>,
}

impl Body {
    /// The bodies that are large enough for a seam, in the order of the shapes. A flat thing was found by its
    /// outline, so colours on it are print. O(pixels).
    pub(super) fn of_shapes(
        facets: &Facets,
        shapes: &Shapes,
        lab: &LabImage,
        space: &DisparitySpace,
    ) -> Vec<Self> {
        let Facets { segments, structure, .. } = facets;
        segments.find_runs();
        let shape_of = |facet: usize| {
            let free = facet.checked_sub(*structure)?;
            let is_flat = facets.is_flat(SegmentId(facet as u32));
            (!is_flat).then(|| shapes.of_facet[free] as usize)
        };
        let mut sizes = vec![0; shapes.count];
        for (run, facet) in segments.runs() {
            shape_of(facet).into_iter().for_each(|shape| sizes[shape] += run.len());
        }
        let least_px = space.area_px(LEAST_BODY_PX);
        let width = segments.labels().width();
        let mut pixels: Vec<Vec<BodyPixel>> = vec![Vec::new(); segments.count()];
        for (run, facet) in segments.runs() {
            if shape_of(facet).is_some_and(|shape| sizes[shape] >= least_px) {
                pixels[facet].extend(run.map(|i| {
                    let at = position(i, width);
                    let point = space.point_m(at, facets.models[facet].value(at)).into();
                    BodyPixel { i: i as u32, facet: facet as u32, color: lab[i], point }
                }));
            }
        }
        let mut bodies = vec![Self { faces: Vec::new() }; shapes.count];
        for (facet, pixels) in pixels.into_iter().enumerate().filter(|(_, pixels)| !pixels.is_empty()) {
            let (normal, is_flat) = direction(&pixels, facet, facets, space);
            let middle = pixels.iter().map(|p| p.point).sum::<DVec3>() / pixels.len() as f64;
            if let Some(shape) = shape_of(facet) {
                bodies[shape].faces.push(Face { pixels, middle, normal, is_flat });
            }
        }
        bodies.iter_mut().for_each(|body| body.join_faces(space));
        bodies.retain(Self::is_flat);
        bodies
    }

    /// Joins the flat facets that lie in one plane to one face: depth may end a facet anywhere, also at the
    /// joint.
    fn join_faces(&mut self, space: &DisparitySpace) {
        let mut faces = std::mem::take(&mut self.faces);
        faces.sort_by_key(|face| Reverse(face.pixels.len()));
        for face in faces {
            match self.faces.iter_mut().find(|other| other.continues(&face, space)) {
                Some(other) => other.pixels.extend(face.pixels),
                None => self.faces.push(face),
            }
        }
    }

    pub(super) fn pixels(&self) -> impl Iterator<Item = &BodyPixel> {
        self.faces.iter().flat_map(|face| &face.pixels)
    }

    /// The number of its pixels.
    pub(super) fn size_px(&self) -> usize {
        self.faces.iter().map(|face| face.pixels.len()).sum()
    }

    /// Whether it has faces, and nearly all are flat.
    pub(super) fn is_flat(&self) -> bool {
        let flat: usize = self.faces.iter().filter(|face| face.is_flat).map(|face| face.pixels.len()).sum();
        flat > 0 && flat as f64 >= FLAT_SHARE * self.size_px() as f64
    }

    /// What lies on one side of a trace.
    pub(super) fn side(&self, trace: &Trace, is_above: bool) -> Self {
        let of_face = |face: &Face| {
            let own = face.pixels.iter().filter(|p| trace.is_above(p.point) == is_above);
            let pixels: Vec<BodyPixel> = own.copied().collect();
            (!pixels.is_empty()).then_some(Face { pixels, ..*face })
        };
        Self { faces: self.faces.iter().filter_map(of_face).collect() }
    }

    /// The pixels of each facet, in scan order.
    pub(super) fn facets(&self) -> impl Iterator<Item = &[BodyPixel]> {
        self.faces.iter().flat_map(|face| face.pixels.chunk_by(|a, b| a.facet == b.facet))
    }

    /// The overlap of the colours of a narrow side of a trace with those that the image shows beyond that
    /// side. `beyond` gives the colour that is seen at a point, `None` where the whole body is seen itself. If they are
    /// alike, the side is depth that was measured too far beyond the edge. 0 if both sides are too wide for that.
    pub(super) fn overlap_beyond(
        &self,
        trace: &Trace,
        space: &DisparitySpace,
        beyond: impl Fn(DVec3) -> Option<[f32; 3]>,
    ) -> f64 {
        let of_side = |sign: f64| {
            let height_m = |p: &BodyPixel| sign * trace.height_m(p.point);
            let side: Vec<&BodyPixel> = self.pixels().filter(|p| height_m(p) > 0.0).collect();
            if side.is_empty() {
                return 0.0;
            }
            let mean =
                |of: &dyn Fn(&BodyPixel) -> f64| side.iter().map(|p| of(p)).sum::<f64>() / side.len() as f64;
            // A band is on average twice as wide as it is high.
            let (width_m, depth_m) = (2.0 * mean(&height_m), mean(&|p| p.point.z));
            let width_px = space.length_at_525_px(space.camera().fx_px * width_m / depth_m);
            if width_px > FATTENED_PX {
                return 0.0;
            }
            let outer = || side.iter().filter(|p| height_m(p) > width_m / 2.0);
            let beyond = |p: &&BodyPixel| beyond(p.point + trace.axis * (sign * width_m));
            let beyond: Vec<[f32; 3]> = outer().filter_map(beyond).collect();
            // Few pixels are those at the edge of the body itself.
            if 2 * beyond.len() < outer().count() {
                return 0.0;
            }
            ColorHistogram::of(outer().map(|p| p.color)).overlap(&ColorHistogram::of(beyond.into_iter()))
        };
        of_side(-1.0).max(of_side(1.0))
    }
}

/// The connected pieces of some pixels of an image of this width, which are in scan order; the largest first.
/// Those of fewer than `least_px` pixels stay with the largest. O(pixels · log pixels).
pub(super) fn connected_pieces(pixels: &[BodyPixel], width: usize, least_px: usize) -> Vec<Vec<BodyPixel>> {
    let is_next = |a: &BodyPixel, b: &BodyPixel| a.i + 1 == b.i && !(b.i as usize).is_multiple_of(width);
    let start = |run: &[BodyPixel]| run[0].i as usize;
    let runs: Vec<(Range<usize>, usize)> =
        pixels.chunk_by(is_next).map(|run| (start(run)..start(run) + run.len(), 0)).collect();
    let (piece_of, count) = connect(&runs, width);
    let mut pieces = vec![Vec::new(); count];
    for (run, piece) in pixels.chunk_by(is_next).zip(piece_of) {
        pieces[piece as usize].extend_from_slice(run);
    }
    pieces.sort_by_key(|piece| Reverse(piece.len()));
    let large = pieces.iter().take_while(|piece| piece.len() >= least_px).count().max(1);
    let small = pieces.split_off(large.min(pieces.len()));
    pieces.iter_mut().take(1).for_each(|largest| largest.extend(small.iter().flatten()));
    pieces
}

/// The normal of a facet in the middle of its pixels, and whether it is nearly the same everywhere.
fn direction(pixels: &[BodyPixel], facet: usize, facets: &Facets, space: &DisparitySpace) -> (DVec3, bool) {
    let width = facets.segments.labels().width();
    let model = &facets.models[facet];
    let normal_at = |at: [f64; 2]| DVec3::from(space.normal(at, model.value(at), model.slope(at)));
    let sum = pixels.iter().fold([0.0; 2], |sum, p| {
        let at = position(p.i as usize, width);
        [sum[0] + at[0], sum[1] + at[1]]
    });
    let normal = normal_at(sum.map(|x| x / pixels.len() as f64));
    let sample = pixels.iter().step_by(pixels.len().div_ceil(NORMALS));
    let turn = |p: &BodyPixel| {
        let cosine = normal_at(position(p.i as usize, width)).dot(normal);
        libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees()
    };
    let (turns, count) = sample.map(turn).fold((0.0, 0), |(sum, n), turn| (sum + turn, n + 1));
    (normal, turns < FLAT_DEG * f64::from(count))
}
