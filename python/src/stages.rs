//! What the stages of a method put out, as images.

use objecthood::{Observer, Output, Raster, Segments};

/// The image of a stage.
pub(crate) enum StageImage {
    /// The region of every pixel, -1 = none.
    Labels(Raster<i32>),
    /// A number a pixel.
    Numbers(Raster<f32>),
    /// A vector a pixel.
    Vectors(Raster<[f32; 3]>),
}

/// The images of the stages that have one, with the names of the stages.
#[derive(Default)]
pub(crate) struct StageImages(pub(crate) Vec<(&'static str, StageImage)>);

impl Observer for StageImages {
    fn observe(&mut self, output: Output<'_>) {
        let labels = |segments: &Segments| StageImage::Labels(segments.labels().clone());
        let image = match output {
            Output::Normals(normals) => StageImage::Vectors(normals.clone()),
            Output::Curvature(curvature) => StageImage::Numbers(curvature.clone()),
            Output::Structure(map) | Output::Superpixels(map) | Output::Shapes(map) => {
                labels(&map.segments())
            }
            Output::Facets(segments) | Output::Support { regions: segments, .. } => labels(segments),
            _ => return,
        };
        self.0.push((output.stage().name(), image));
    }
}
