//! The outputs of the stages of a method. Each is kept until one of its inputs changes.

use std::sync::Arc;

use crate::clusters::clustering::Clustering;
use crate::discovery::Discovery;
use crate::discovery::support_graph::SupportGraph;
use crate::error::Result;
use crate::facets::Facets;
use crate::objectness::hypotheses::Hypothesis;
use crate::oversegment::Superpixels;
use crate::oversegment::linked::LinkedSuperpixels;
use crate::oversegment::structure::Structure;
use crate::plausibility::Doubt;
use crate::raster::Raster;
use crate::regions::{RegionGraph, Segments};
use crate::shapes::border::BorderEvidence;
use crate::shapes::contraction::Shapes;
use crate::shapes::seams::Seams;
use crate::stage::Stage;
use crate::support::gravity::Ground;
use crate::support::standing::Standing;
use crate::surface::surfaces::Surfaces;

/// An output, once its stage has run. Clones of a pipeline share it.
pub(crate) type Slot<T> = Option<Arc<T>>;

/// The output in a slot. If the slot is empty, `run` computes it first.
pub(crate) fn recall<T>(slot: &mut Slot<T>, run: impl FnOnce() -> T) -> &T {
    slot.get_or_insert_with(|| Arc::new(run()))
}

/// As [`recall`], for a stage that may fail.
///
/// # Errors
/// As `run`.
pub(crate) fn try_recall<T>(slot: &mut Slot<T>, run: impl FnOnce() -> Result<T>) -> Result<&T> {
    Ok(match slot {
        Some(output) => output,
        None => slot.insert(Arc::new(run()?)),
    })
}

/// A struct with the slots of a method, in the order in which the method fills them. A stage may have several.
macro_rules! outputs {
    ($(#[$doc:meta])* $Outputs:ident { $($(#[$slot_doc:meta])* $slot:ident: $Type:ty, of $stage:ident;)+ }) => {
        $(#[$doc])*
        #[derive(Clone, Debug, Default)]
        pub(crate) struct $Outputs {
            $($(#[$slot_doc])* pub(crate) $slot: Slot<$Type>,)+
        }

        impl $Outputs {
            /// Drops the outputs of a stage and of all after it.
            pub(crate) fn forget_from(&mut self, first: Stage) {
                $(if Stage::$stage >= first {
                    self.$slot = None;
                })+
            }
        }
    };
}

outputs! {
    /// The outputs of `context`.
    ContextOutputs {
        surfaces: Surfaces, of Normals;
        structure: Structure, of Structure;
        superpixels: LinkedSuperpixels, of Superpixels;
        /// The facets, borders and shapes before seams cut them.
        facets: Facets, of Facets;
        borders: RegionGraph<BorderEvidence>, of Borders;
        shapes: Shapes, of Shapes;
        seams: Option<Seams>, of Shapes;
        /// The facets after the gaps between them are filled.
        filled: Facets, of Clusters;
        points_m: Raster<[f32; 3]>, of Normals;
        clusters: Clustering, of Clusters;
        standing: Standing, of Support;
        hypotheses: Vec<Hypothesis>, of Hypotheses;
        doubts: Vec<Doubt>, of Normals;
        discovery: Discovery, of Objects;
    }
}

outputs! {
    /// The outputs of `paper`.
    PaperOutputs {
        points_m: Raster<[f32; 3]>, of Normals;
        normals: Raster<[f32; 3]>, of Normals;
        curvature: Raster<f32>, of Curvature;
        superpixels: Superpixels, of Superpixels;
        facets: Segments, of Facets;
        shapes: Segments, of Shapes;
        ground: Ground, of Support;
        support: SupportGraph, of Support;
        hypotheses: Vec<Hypothesis>, of Hypotheses;
        doubts: Vec<Doubt>, of Normals;
        discovery: Discovery, of Objects;
    }
}
