//! Flat things: things 0.2 to 12 mm thick that lie on a support (docs/CONTEXT.md 2.4).
//!
//! A single pixel of such a thing is as near to the support as the noise. But many pixels together show it:
//! the mean over a book of 2 mm lies far outside the noise of such means, and a sheet of paper has another
//! colour than the table, inside a sharp, closed, convex outline.

mod evidence;
mod field;
mod hull;
mod patches;
mod proposals;
mod raised;
mod search;
mod surroundings;

use crate::facets::facet::{Facets, Flat};
use crate::facets::flat::field::Field;
pub use crate::facets::flat::search::FlatParams;
use crate::facets::flat::search::Search;
use crate::oversegment::structure::Structure;
use crate::regions::{SegmentId, Segments};
use crate::surface::model::Basis;
use crate::surface::moments::Moments;
use crate::surface::surfaces::Surfaces;

/// Finds flat things and makes each a facet of its own: the last facets.
///
/// Proposals come from colour (patches of a graph segmentation that differ from their support, and groups of
/// these) and from depth (cells that rise above the support). Each is compared with the ring around it. Among
/// accepted groups that overlap, the larger and more solid one is kept. Source: ours, because the paper
/// divides at steps and folds, and a thing thinner than the noise of a pixel has neither. O(pixels + cells of
/// the proposals · log), without a support O(1).
pub fn find_flats(
    facets: Facets,
    surfaces: &Surfaces,
    structure: &Structure,
    params: FlatParams<'_>,
) -> Facets {
    if !params.flat.enabled || structure.supports.surfaces.is_empty() {
        return facets;
    }
    let field = Field::new(surfaces, structure, &facets);
    let found = Search::new(&field, surfaces, structure, params).run(surfaces.lab.is_some());
    if found.is_empty() {
        return facets;
    }
    let Facets { segments, mut models, structure, .. } = facets;
    let mut labels = segments.into_labels();
    let mut flats = Vec::with_capacity(found.len());
    for group in found {
        let pixels = field.pixels_of(&group.cells, labels.width());
        pixels.iter().for_each(|&i| labels.as_mut_slice()[i as usize] = models.len() as i32);
        flats.push(Flat {
            facet: SegmentId(models.len() as u32),
            is_proven: group.is_proven,
            checks: group.checks,
        });
        models.push(Moments::of(&pixels, &surfaces.disparity).fit(Basis::Plane).model);
    }
    Facets { segments: Segments::from_numbered(labels, models.len()), models, structure, flats }
}

#[cfg(test)]
mod tests;
