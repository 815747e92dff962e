//! The truth about what stands on what.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DQuat, DVec3};
use objecthood::discovery::{SupportGraph, SupportKind, Up, UpSource};
use objecthood::planes::{StructurePlane, fit_plane};
use objecthood::support::forest::build_forest;
use objecthood::support::scene::SupportScene;
use objecthood::surface::disparity::DisparitySpace;
use objecthood::{Params, Raster, Segments};
use objecthood_scene::{Contact, ContactKind, Rendered, World};

use crate::error::Result;
use crate::support::LEAST_SEEN_PX;

/// What is true of what stands on what.
#[derive(Clone, Debug)]
pub struct SupportTruth {
    /// The thing at every pixel, 0 = none.
    pub instance: Raster<u16>,
    /// The face at every pixel, each of one thing; 0 = none.
    pub surface: Raster<u16>,
    /// Things that can be grasped; all others are furniture or room.
    pub objects: BTreeSet<u16>,
    /// Who stands on what.
    pub contacts: Vec<Contact>,
    /// The direction against gravity in the camera frame.
    pub up: Up,
}

impl SupportTruth {
    /// Of a synthetic scene and its picture.
    pub fn of(world: &World, seen: &Rendered) -> Self {
        let pose = DQuat::from_array(world.viewpoint().pose.rotation_xyzw());
        let up = pose.inverse() * DVec3::Z;
        Self {
            instance: seen.truth.instance.clone(),
            surface: seen.truth.surface.clone(),
            objects: world.objects().collect(),
            contacts: world.contacts().to_vec(),
            up: Up { direction: up.as_vec3().to_array(), source: UpSource::Camera },
        }
    }

    /// Who carries whom, and how; what merely touches carries nothing.
    pub(crate) fn edges(&self) -> BTreeMap<(u16, u16), SupportKind> {
        let kind = |contact: &Contact| match contact.kind {
            ContactKind::StandsOn => Some(SupportKind::On),
            ContactKind::LiesIn => Some(SupportKind::In),
            ContactKind::LeansOn => Some(SupportKind::Leans),
            _ => None,
        };
        self.contacts.iter().filter_map(|c| Some(((c.lower, c.upper), kind(c)?))).collect()
    }

    /// The true segments: first the faces of furniture and room, then the objects, with the planes that fit the faces.
    /// Those of fewer than [`LEAST_SEEN_PX`] pixels are left out. `points_m`: those of the same picture.
    ///
    /// # Errors
    /// When the picture is empty.
    pub fn segments(&self, points_m: &Raster<[f32; 3]>) -> Result<(Segments, Vec<StructurePlane>)> {
        const OBJECTS: i32 = 1 << 16;
        let label = |i: usize| match self.instance[i] {
            0 => -1,
            instance if self.objects.contains(&instance) => OBJECTS + i32::from(instance),
            _ => i32::from(self.surface[i]),
        };
        let mut points: BTreeMap<i32, Vec<[f32; 3]>> = BTreeMap::new();
        for i in (0..points_m.len()).filter(|&i| label(i) >= 0 && !points_m[i][2].is_nan()) {
            points.entry(label(i)).or_default().push(points_m[i]);
        }
        points.retain(|_, points| points.len() >= LEAST_SEEN_PX as usize);
        let planes = points.range(..OBJECTS).filter_map(|(_, points)| fit_plane(points)).collect();
        let kept = |i: usize| if points.contains_key(&label(i)) { label(i) } else { -1 };
        let labels = (0..points_m.len()).map(kept).collect();
        let labels = Raster::from_vec(points_m.width(), points_m.height(), labels)?;
        Ok((Segments::from_labels(&labels), planes))
    }

    /// The forest over the true segments, with the true gravity.
    ///
    /// # Errors
    /// When the picture is empty.
    pub fn forest(
        &self,
        points_m: &Raster<[f32; 3]>,
        normals: &Raster<[f32; 3]>,
        space: &DisparitySpace,
        params: &Params,
    ) -> Result<(SupportGraph, Segments)> {
        let (segments, planes) = self.segments(points_m)?;
        let (regions, planes, up) = (&segments, &planes[..], &self.up);
        let scene = SupportScene { regions, points_m, normals, planes, up, space };
        let graph = build_forest(&scene, &params.contact, &params.objectness);
        Ok((graph, segments))
    }
}
