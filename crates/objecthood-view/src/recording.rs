//! What the picture needs of every stage.

use objecthood::{Observer, Raster, Segments, Stage};

/// Watches one frame and keeps what [`panels`](crate::panels()) draws: normals and label maps.
///
/// Take a new one for every frame. Stages that never came, because the method has none such, are left out.
/// A recording takes 28 bytes a pixel.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    pub(crate) normals: Option<Raster<[f32; 3]>>,
    pub(crate) superpixels: Option<Segments>,
    pub(crate) facets: Option<Segments>,
    pub(crate) shapes: Option<Segments>,
    /// The regions that are nodes of the support graph.
    pub(crate) supports: Option<Segments>,
    /// Number of regions that are structure: they come first among superpixels and facets; together they are the first shape.
    pub(crate) structure: usize,
}

impl Observer for Recording {
    fn observe(&mut self, stage: Stage<'_>) {
        match stage {
            Stage::Normals(normals) => self.normals = Some(normals.clone()),
            Stage::Superpixels(map) => self.superpixels = Some(map.segments().into_owned()),
            Stage::Facets(segments) => self.facets = Some(segments.clone()),
            Stage::Shapes(map) => self.shapes = Some(map.segments().into_owned()),
            Stage::Structure(map) => self.structure = map.segments().count(),
            Stage::Support { regions, .. } => self.supports = Some(regions.clone()),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use objecthood::objectness::support::SupportGraph;

    use super::*;

    #[test]
    fn every_stage_is_kept_where_it_belongs() {
        let segments = |count: i32| {
            let labels = (0..4).map(|i| i.min(count - 1)).collect();
            Segments::from_labels(&Raster::from_vec(4, 1, labels).unwrap())
        };
        let normals = Raster::filled(4, 1, [0.0, 0.0, -1.0]).unwrap();
        let mut recording = Recording::default();
        recording.observe(Stage::Normals(&normals));
        recording.observe(Stage::Superpixels((&segments(4)).into()));
        recording.observe(Stage::Facets(&segments(3)));
        recording.observe(Stage::Shapes((&segments(2)).into()));
        recording.observe(Stage::Structure((&segments(3)).into()));
        recording.observe(Stage::Support { graph: &SupportGraph::default(), regions: &segments(1) });
        assert_eq!(recording.structure, 3);
        assert_eq!(recording.supports, Some(segments(1)));
        assert_eq!(recording.normals, Some(normals));
        assert_eq!(recording.superpixels, Some(segments(4)));
        assert_eq!(recording.facets, Some(segments(3)));
        assert_eq!(recording.shapes, Some(segments(2)));
    }
}
