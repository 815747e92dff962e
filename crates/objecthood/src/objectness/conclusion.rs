//! The end of both methods: assembles the discovery.

use crate::clusters::scene::Scene;
use crate::discovery::support_graph::SupportGraph;
use crate::discovery::{Discovery, Notice, UpSource};
use crate::error::Result;
use crate::estimates::Estimates;
use crate::frame::Frame;
use crate::objectness::decision::decide;
use crate::objectness::hypotheses::Hypothesis;
use crate::objectness::objects::{make_objects, mark_objects};
use crate::params::{self, Method, UpFrom};
use crate::planes::StructurePlane;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::support::gravity::{Ground, mark_plane};
use crate::support::standing::Standing;

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
    let missing_plane = gravity.up_from == UpFrom::Plane && ground.up.source == UpSource::Camera;
    let missing_color = frame.color().is_none();
    let notices = [(missing_plane, Notice::NoPlane), (missing_color, Notice::NoColor)];
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

/// Assembles the discovery of `context`: the objects, the structure and the support graph. O(pixels log pixels).
///
/// # Errors
/// As [`make_objects`].
pub fn conclude_context(
    scene: &Scene<'_>,
    standing: &Standing,
    hypotheses: &[Hypothesis],
    gravity: &params::Gravity,
    objectness: &params::Objectness,
) -> Result<Discovery> {
    let Standing { candidates, planes, up, graph, .. } = standing;
    let kept = decide(hypotheses, Method::Context, objectness);
    let (objects, labels) = make_objects(kept, &scene.facets.segments, scene.points_m, graph)?;
    let missing_plane =
        planes.is_empty() && gravity.up_from == UpFrom::Plane && up.source == UpSource::Camera;
    let no_plane = missing_plane.then_some(Notice::NoPlane);
    let told = match up.source {
        UpSource::Measured | UpSource::Earlier => true,
        UpSource::Plane => scene.is_ground_clear,
        UpSource::Camera => false,
    };
    let turned = (scene.turned_deg != 0).then_some(Notice::Turned { degrees: scene.turned_deg });
    let ground = scene.ground_facet().map(|facet| &planes[facet.index()]);
    let in_doubt = ground.filter(|_| !scene.is_ground_clear).map(ground_in_doubt);
    let missed = scene.missed_gravity_deg.map(|angle_deg| Notice::GravityMissed { angle_deg });
    let holes = (scene.bridged_share > 0.0).then_some(Notice::HoleGrid { share: scene.bridged_share });
    let smeared = (scene.sharpened_share > 0.0).then_some(Notice::Smeared { share: scene.sharpened_share });
    Ok(Discovery {
        support: mark_objects(graph, &objects),
        objects,
        labels,
        up: *up,
        structure: candidates.structure_labels(scene.points_m),
        structure_planes: planes.clone(),
        estimates: Some(Estimates {
            noise: *scene.space.noise(),
            frames: scene.noise_frames,
            up: told.then_some(up.direction),
        }),
        notices: [no_plane, turned, in_doubt, missed, holes, smeared].into_iter().flatten().collect(),
    })
}

/// The notice that names the plane that was taken for the ground.
fn ground_in_doubt(plane: &StructurePlane) -> Notice {
    let tilt_deg = libm::asin(f64::from(-plane.normal[2]).clamp(-1.0, 1.0)).to_degrees();
    Notice::GroundInDoubt { distance_m: plane.offset_m, tilt_deg: tilt_deg as f32, share: plane.inlier_share }
}
