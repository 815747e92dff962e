//! What the picture needs of every stage.

use objecthood::{Observer, Output, Raster, Segments};

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
    fn observe(&mut self, output: Output<'_>) {
        match output {
            Output::Normals(normals) => self.normals = Some(normals.clone()),
            Output::Superpixels(map) => self.superpixels = Some(map.segments().into_owned()),
            Output::Facets(segments) => self.facets = Some(segments.clone()),
            Output::Shapes(map) => self.shapes = Some(map.segments().into_owned()),
            Output::Structure(map) => self.structure = map.segments().count(),
            Output::Support { regions, .. } => self.supports = Some(regions.clone()),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use objecthood::discovery::SupportGraph;

    use super::*;

    #[test]
    fn every_stage_is_kept_where_it_belongs() {
        let segments = |count: i32| {
            let labels = (0..4).map(|i| i.min(count - 1)).collect();
            Segments::from_labels(&Raster::from_vec(4, 1, labels).unwrap())
        };
        let normals = Raster::filled(4, 1, [0.0, 0.0, -1.0]).unwrap();
        let mut recording = Recording::default();
        recording.observe(Output::Normals(&normals));
        recording.observe(Output::Superpixels((&segments(4)).into()));
        recording.observe(Output::Facets(&segments(3)));
        recording.observe(Output::Shapes((&segments(2)).into()));
        recording.observe(Output::Structure((&segments(3)).into()));
        recording.observe(Output::Support { graph: &SupportGraph::default(), regions: &segments(1) });
        assert_eq!(recording.structure, 3);
        assert_eq!(recording.supports, Some(segments(1)));
        assert_eq!(recording.normals, Some(normals));
        assert_eq!(recording.superpixels, Some(segments(4)));
        assert_eq!(recording.facets, Some(segments(3)));
        assert_eq!(recording.shapes, Some(segments(2)));
    }
}
