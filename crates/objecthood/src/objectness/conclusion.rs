//! The end of both methods: assembles the discovery.

use crate::discovery::support_graph::SupportGraph;
use crate::discovery::{Discovery, Notice, Up, UpSource};
use crate::error::Result;
use crate::estimates::Estimates;
use crate::facets::Facets;
use crate::frame::Frame;
use crate::objectness::decision::decide;
use crate::objectness::hypotheses::Hypothesis;
use crate::objectness::objects::{make_objects, mark_objects};
use crate::oversegment::structure::{Structure, Supports};
use crate::params::{self, Method, UpFrom};
use crate::planes::StructurePlane;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::support::gravity::{Ground, mark_plane};
use crate::support::standing::Standing;
use crate::surface::surfaces::Surfaces;

/// The outputs of `paper` of which its discovery is made.
#[derive(Clone, Copy, Debug)]
pub struct PaperScene<'a> {
    /// The facets.
    pub facets: &'a Segments,
    /// Points (m); `NaN` without depth.
    pub points_m: &'a Raster<[f32; 3]>,
    /// The ground, and the direction up.
    pub ground: &'a Ground,
    /// The support graph of the shapes.
    pub support: &'a SupportGraph,
}

/// Assembles the discovery of `paper`: the objects, the ground and the support graph. O(pixels log pixels).
///
/// # Errors
/// As [`make_objects`].
pub fn conclude_paper(
    frame: &Frame,
    scene: &PaperScene<'_>,
    hypotheses: &[Hypothesis],
    gravity: &params::Gravity,
    objectness: &params::Objectness,
) -> Result<Discovery> {
    let &PaperScene { facets, points_m, ground, support } = scene;
    let kept = decide(hypotheses, Method::Paper, objectness);
    let (objects, labels) = make_objects(kept, facets, points_m, support)?;
    let plane = ground.plane.as_ref();
    let missing_color = frame.color().is_none();
    let notices = [(misses_plane(gravity, &ground.up), Notice::NoPlane), (missing_color, Notice::NoColor)];
    Ok(Discovery {
        support: mark_objects(support, &objects),
        objects,
        up: ground.up,
        structure: mark_plane(plane, &labels, points_m, gravity),
        structure_planes: plane.copied().into_iter().collect(),
        labels,
        estimates: None,
        notices: notices.into_iter().filter_map(|(holds, notice)| holds.then_some(notice)).collect(),
    })
}

/// The outputs of `context` of which its discovery is made.
#[derive(Clone, Copy, Debug)]
pub struct ContextScene<'a> {
    /// The surface at every pixel.
    pub surfaces: &'a Surfaces,
    /// The structure.
    pub structure: &'a Structure,
    /// Facets and structure after [`fill_facets`](crate::clusters::fill::fill_facets).
    pub facets: &'a Facets,
    /// Points (m); `NaN` without depth.
    pub points_m: &'a Raster<[f32; 3]>,
    /// The candidates, their planes, up and the support graph.
    pub standing: &'a Standing,
}

/// Assembles the discovery of `context`: the objects, the structure and the support graph. O(pixels log pixels).
///
/// # Errors
/// As [`make_objects`].
pub fn conclude_context(
    scene: &ContextScene<'_>,
    hypotheses: &[Hypothesis],
    gravity: &params::Gravity,
    objectness: &params::Objectness,
) -> Result<Discovery> {
    let &ContextScene { surfaces, structure, facets, points_m, standing } = scene;
    let Standing { candidates, planes, up, graph, .. } = standing;
    let kept = decide(hypotheses, Method::Context, objectness);
    let (objects, labels) = make_objects(kept, &facets.segments, points_m, graph)?;
    let no_plane = misses_plane(gravity, up).then_some(Notice::NoPlane);
    let told = match up.source {
        UpSource::Measured | UpSource::Earlier => true,
        UpSource::Plane => structure.supports.is_clear,
        UpSource::Camera => false,
    };
    let notices =
        no_plane.into_iter().chain(of_ground(structure, planes)).chain(of_depth(surfaces)).collect();
    Ok(Discovery {
        support: mark_objects(graph, &objects),
        objects,
        labels,
        up: *up,
        structure: candidates.structure_labels(points_m),
        structure_planes: planes.clone(),
        estimates: Some(Estimates {
            noise: *surfaces.space.noise(),
            frames: surfaces.noise_frames,
            up: told.then_some(up.direction),
        }),
        notices,
    })
}

/// What is to be said of the ground. `planes`: those of the structure.
fn of_ground(structure: &Structure, planes: &[StructurePlane]) -> impl Iterator<Item = Notice> {
    let Supports { turned_deg, is_clear, missed_gravity_deg, .. } = structure.supports;
    let turned = (turned_deg != 0).then_some(Notice::Turned { degrees: turned_deg });
    let ground = structure.supports.surfaces.first().map(|&ground| &planes[ground]);
    let in_doubt = ground.filter(|_| !is_clear).map(ground_in_doubt);
    let missed = missed_gravity_deg.map(|angle_deg| Notice::GravityMissed { angle_deg });
    turned.into_iter().chain(in_doubt).chain(missed)
}

/// Whether up is the camera's own because no plane could be the ground.
fn misses_plane(gravity: &params::Gravity, up: &Up) -> bool {
    gravity.up_from == UpFrom::Plane && up.source == UpSource::Camera
}

/// What the depth lacks, and what was mended in it.
fn of_depth(surfaces: &Surfaces) -> impl Iterator<Item = Notice> {
    let &Surfaces { bands, bridged_share, sharpened_share, .. } = surfaces;
    let bands = bands.told(surfaces.disparity.size()).map(Notice::EmptyBands);
    let holes = (bridged_share > 0.0).then_some(Notice::HoleGrid { share: bridged_share });
    let smeared = (sharpened_share > 0.0).then_some(Notice::Smeared { share: sharpened_share });
    bands.into_iter().chain(holes).chain(smeared)
}

/// The notice that names the plane that was taken for the ground.
fn ground_in_doubt(plane: &StructurePlane) -> Notice {
    let tilt_deg = libm::asin(f64::from(-plane.normal[2]).clamp(-1.0, 1.0)).to_degrees();
    Notice::GroundInDoubt { distance_m: plane.offset_m, tilt_deg: tilt_deg as f32, share: plane.inlier_share }
}
