//! Hypotheses: regions that may be objects, with their objectness.

use glam::Vec3;
use rayon::prelude::*;

use crate::clusters::clustering::Clustering;
use crate::clusters::scene::Scene;
use crate::discovery::join::Join;
use crate::discovery::object::OrientedBox;
use crate::discovery::parts::ObjectnessParts;
use crate::discovery::support_graph::SupportGraph;
use crate::discovery::up::Up;
use crate::objectness::compactness::measure_compactness;
use crate::objectness::outline::{ColorEvidence, SeamsAt, measure_outlines};
use crate::objectness::size::{rate_height, rate_resolution, rate_rise, rate_size, resolved_side_m};
use crate::oriented_box::fit_oriented_box;
use crate::params;
use crate::planes::StructurePlane;
use crate::raster::Raster;
use crate::regions::{SegmentId, Segments};
use crate::support::standing::Standing;
use crate::surface::disparity::DisparitySpace;

/// A thing lies alone if at least this share of its border is with the background: slivers lie beside the
/// surface that they are slivers of.
const ALONE_SHARE: f32 = 0.98;

/// A region that may be an object, with its objectness.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Hypothesis {
    /// The region.
    pub region: SegmentId,
    /// Its pixels with depth, in scan order; at least one.
    pub pixels: Vec<usize>,
    /// Its box.
    pub box_m: OrientedBox,
    /// How likely the region is an object, in [0, 1].
    pub objectness: f32,
    /// The parts of the objectness.
    pub parts: ObjectnessParts,
    /// Height of its top above the support surface (m); `None` in `paper` and without a support.
    pub top_m: Option<f32>,
    /// The joins of its parts that do not touch as one surface. Empty in `paper`.
    pub joins: Vec<Join>,
    /// Whether it is a flat thing on a support (docs/CONTEXT.md 2.4). Never in `paper`.
    pub is_flat: bool,
    /// How clearly its colours differ from the background's, on average over its outline, in [0, 1]; 0 without colour and in `paper`.
    pub(crate) contrast: f32,
}

/// The inputs by which regions are judged.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// The regions, among them those that may be objects.
    pub regions: &'a Segments,
    /// Points (m); `NaN` without depth.
    pub points_m: &'a Raster<[f32; 3]>,
    /// Unit normals; zero where there is none.
    pub normals: &'a Raster<[f32; 3]>,
    /// The support graph; node k is region k.
    pub support: &'a SupportGraph,
    /// The footing of every region; `None` where it is not known (`paper`).
    pub footing: Option<&'a [f32]>,
    /// The direction against gravity.
    pub up: &'a Up,
    /// The camera and the sensor's noise.
    pub space: &'a DisparitySpace,
    /// What colour shows about borders; nothing in `paper`.
    pub color: ColorEvidence<'a>,
}

/// Makes hypotheses of the regions that have at least `objectness.min_size_px` points, in their order. O(pixels + area of the
/// hulls); parallel over rows and regions.
pub fn find_hypotheses(
    evidence: &Evidence<'_>,
    objectness: &params::Objectness,
    contraction: &params::Contraction,
) -> Vec<Hypothesis> {
    let every = Judged { first: 0, min_size_px: objectness.min_size_px };
    judge_regions(evidence, every, objectness, contraction)
}

/// Which regions become hypotheses.
#[derive(Clone, Copy)]
struct Judged {
    /// The first region: those before it are structure.
    first: usize,
    /// Least number of points.
    min_size_px: usize,
}

fn judge_regions(
    evidence: &Evidence<'_>,
    Judged { first, min_size_px }: Judged,
    objectness: &params::Objectness,
    contraction: &params::Contraction,
) -> Vec<Hypothesis> {
    let Evidence { regions, points_m, normals, support, footing, up, space, color } = *evidence;
    let pixels = measured_pixels(regions, first, points_m);
    let (outlines, compactness) = rayon::join(
        || measure_outlines(regions, first, points_m, normals, space, contraction, color),
        || measure_compactness(regions, &pixels, points_m, space),
    );
    let carried = support.carried();
    let judge = |(region, pixels): (usize, Vec<usize>)| {
        if pixels.len() < min_size_px.max(1) {
            return None;
        }
        let points: Vec<[f32; 3]> = pixels.iter().map(|&i| points_m[i]).collect();
        let box_m = fit_oriented_box(&points, up.direction);
        let visibility = outlines[region].visibility();
        let parts = ObjectnessParts {
            size: rate_size(&box_m, objectness.min_second_side_m, visibility, objectness),
            support: carried[region],
            footing: footing.map_or(1.0, |footing| footing[region]),
            compactness: compactness[region],
            separation: outlines[region].separation(),
            visibility,
        };
        let objectness = parts.objectness(objectness);
        Some(Hypothesis {
            region: SegmentId(region as u32),
            pixels,
            box_m,
            objectness,
            parts,
            top_m: None,
            joins: Vec::new(),
            is_flat: false,
            contrast: outlines[region].contrast(),
        })
    };
    pixels.into_par_iter().enumerate().filter_map(judge).collect()
}

/// The pixels with depth of each region from number `first` on, in scan order; empty for the other regions.
fn measured_pixels(regions: &Segments, first: usize, points_m: &Raster<[f32; 3]>) -> Vec<Vec<usize>> {
    let runs = || regions.runs().filter(|&(_, region)| region >= first);
    let mut most = vec![0; regions.count()];
    runs().for_each(|(run, region)| most[region] += run.len());
    let mut pixels: Vec<Vec<usize>> = most.into_iter().map(Vec::with_capacity).collect();
    for (run, region) in runs() {
        pixels[region].extend(run.filter(|&i| !points_m[i][2].is_nan()));
    }
    pixels
}

/// Makes hypotheses of the candidates of `context`, with their tops and joins. See [`find_hypotheses`].
pub fn find_cluster_hypotheses(
    scene: &Scene<'_>,
    clusters: &Clustering,
    standing: &Standing,
    objectness: &params::Objectness,
    contraction: &params::Contraction,
) -> Vec<Hypothesis> {
    let Standing { candidates, planes, up, graph, footing } = standing;
    let &Scene { points_m, normals, space, .. } = scene;
    let evidence = Evidence {
        regions: &candidates.regions,
        points_m,
        normals,
        support: graph,
        footing: Some(&footing.held),
        up,
        space,
        color: ColorEvidence {
            lab: scene.lab,
            seams: scene.cuts.map(|cuts| SeamsAt { facets: &scene.facets.segments, cuts }),
        },
    };
    // All candidates are large enough.
    let candidates_only = Judged { first: planes.len(), min_size_px: 1 };
    let mut hypotheses = judge_regions(&evidence, candidates_only, objectness, contraction);
    let hidden = graph.hidden_carriers();
    for hypothesis in &mut hypotheses {
        let region = hypothesis.region.index();
        if !scene.is_smeared && candidates.alone(hypothesis.region, clusters) >= ALONE_SHARE {
            let least_m = resolved_side_m(&hypothesis.box_m, space, objectness);
            let parts = &mut hypothesis.parts;
            parts.size = rate_size(&hypothesis.box_m, least_m, parts.visibility, objectness);
        }
        if let Some(plane) = hidden[region].and_then(|carrier| planes.get(carrier.0 as usize)) {
            let rise_m = top_above_m(&hypothesis.box_m, plane);
            let parts = &mut hypothesis.parts;
            let rise = rate_rise(&hypothesis.box_m, rise_m, footing.cut[region], objectness);
            parts.size = parts.size.min(rise).min(rate_height(rise_m));
        }
        if scene.supports.is_empty() {
            // No level surface is seen, so it is unknown what carries the thing.
            hypothesis.parts.support = 1.0;
        }
        hypothesis.top_m = candidates.top_m(hypothesis.region, clusters);
        hypothesis.joins = candidates.joins(hypothesis.region, clusters);
        if let Some(flat) = candidates.flat(hypothesis.region, clusters, scene.facets) {
            hypothesis.is_flat = true;
            let parts = &mut hypothesis.parts;
            parts.separation = parts.separation.max(flat.separation());
        } else if scene.is_smeared {
            hypothesis.parts.size *= rate_resolution(hypothesis.pixels.len(), hypothesis.contrast, space);
        }
        hypothesis.objectness = hypothesis.parts.objectness(objectness);
    }
    hypotheses
}

/// Height (m) of the top of a box, whose z is along up, above a plane.
fn top_above_m(box_m: &OrientedBox, plane: &StructurePlane) -> f32 {
    let [.., height_m] = box_m.extents_m;
    plane.height_m(Vec3::from(box_m.center_m).as_dvec3()) as f32 + height_m / 2.0
}
