//! A table seen from straight above, with things drawn on it.

use glam::DVec3;

use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Event, Rule, Source};
use crate::clusters::scene::Scene;
use crate::clusters::steps::StepLimits;
use crate::color::image::LabImage;
use crate::facets::Facets;
use crate::oversegment::structure::StructureSurface;
use crate::params;
use crate::raster::Raster;
use crate::regions::{SegmentId, Segments};
use crate::shapes::contraction::Shapes;
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::model::{Basis, Model};
use crate::surface::moments::Moments;
use crate::surface::plane_fit::fit_planes;
use crate::surface::window_choice::choose_windows;
use crate::testing::space;

/// Distance of the table below the camera (m).
const TABLE_M: f64 = 1.0;

/// The image of the camera: facet 0 is the table and the only structure.
#[derive(Debug)]
pub(crate) struct Table {
    pub(crate) facets: Facets,
    pub(crate) disparity: Raster<f32>,
    pub(crate) color: Option<Raster<[u8; 3]>>,
    pub(crate) lab: Option<LabImage>,
    normals: Raster<[f32; 3]>,
    points_m: Raster<[f32; 3]>,
    space: DisparitySpace,
    support: StructureSurface,
}

impl Table {
    /// An image in which pixel (u, v) shows a facet at a height above the table (m), or nothing.
    pub(crate) fn new(
        (width, height): (usize, usize),
        at: impl Fn(usize, usize) -> Option<(i32, f64)>,
    ) -> Self {
        let seen = (0..width * height).map(|i| at(i % width, i / width)).collect();
        let seen: Raster<Option<(i32, f64)>> = Raster::from_vec(width, height, seen).unwrap();
        let space = space([525.0, 525.0], [width as f64 / 2.0 - 0.5, height as f64 / 2.0 - 0.5]);
        let depth_m = seen.map(|seen| seen.map_or(f32::NAN, |(_, height_m)| (TABLE_M - height_m) as f32));
        let disparity = space.disparity(&depth_m);
        let labels = seen.map(|seen| seen.map_or(Segments::NONE, |(facet, _)| facet));
        let count = labels.as_slice().iter().max().map_or(0, |most| most + 1).max(1) as usize;
        let mut pixels = vec![Vec::new(); count];
        let segments = Segments::from_numbered(labels, count);
        segments.members().for_each(|(i, facet)| pixels[facet].push(i as u32));
        let level = |d: f64| {
            let mut moments = Moments::about([0.0; 2]);
            moments.add([0.0; 2], d);
            moments.fit(Basis::Plane).model
        };
        let table = level(1.0 / (TABLE_M * params::Sensor::default().disparity_quantum_per_m));
        let fitted =
            |pixels: &Vec<u32>| -> Model { Moments::of(pixels, &disparity).fit(Basis::Quadratic).model };
        let models = std::iter::once(table).chain(pixels[1..].iter().map(fitted)).collect();
        let point = |i: usize| {
            let [u, v] = position(i, width).map(|x| x as usize);
            space.camera().back_project(u, v, depth_m[i])
        };
        let points_m = depth_m.with_data((0..width * height).map(point).collect());
        let params = params::LocalFit::default();
        let fits = fit_planes(&disparity, params.radius_px);
        let normals = choose_windows(&disparity, &fits, &space, &params).normal;
        let support = StructureSurface { model: table, normal: DVec3::NEG_Z, offset_m: TABLE_M, scale: 1.0 };
        let facets = Facets { segments, models, structure: 1, flats: Vec::new() };
        Self { facets, disparity, color: None, lab: None, normals, points_m, space, support }
    }

    /// Drawn as text: `.` = nothing, `_` = the table, the letters a, b, .. are facets of these heights (m).
    pub(crate) fn drawn(rows: &[&str], heights_m: &[f64]) -> Self {
        Self::new((rows[0].len(), rows.len()), |u, v| match rows[v].as_bytes()[u] {
            b'.' => None,
            b'_' => Some((0, 0.0)),
            letter => {
                let k = usize::from(letter - b'a');
                Some((k as i32 + 1, heights_m[k]))
            }
        })
    }

    pub(crate) fn scene(&self) -> Scene<'_> {
        Scene {
            facets: &self.facets,
            disparity: &self.disparity,
            normals: &self.normals,
            points_m: &self.points_m,
            color: self.color.as_ref(),
            lab: self.lab.as_ref(),
            space: &self.space,
            surfaces: std::slice::from_ref(&self.support),
            planes: &[],
            supports: &[0],
            steps: StepLimits::of(&params::Watershed::default(), &self.space),
            is_smeared: false,
            cuts: None,
        }
    }
}

/// Every facet but the table a cluster.
pub(crate) fn single<'a>(scene: &'a Scene<'a>) -> Clusters<'a> {
    let count = scene.facets.segments.count() - 1;
    let shapes = Shapes { of_facet: (0..count as u32).collect(), count };
    Clusters::new(scene, &shapes)
}

/// Merges a cluster into another or into the background, without checks.
pub(crate) fn merge(clusters: &mut Clusters<'_>, into: Option<SegmentId>, from: SegmentId) {
    let event =
        Event { rule: Rule::Fragment, from: Source::Cluster(from), into, checks: Vec::new(), join: None };
    clusters.give(event);
}

/// The cluster of every facet but the table, as the number of the facet that it is named after; `None` = background.
pub(crate) fn named(clusters: &Clusters<'_>) -> Vec<Option<u32>> {
    let facets = clusters.scene.facets;
    (0..facets.segments.count() - 1).map(|facet| clusters.of_facet(facet).map(|id| id.0)).collect()
}
