//! Objects: ranks, numbers and describes hypotheses, and paints the label image.

use glam::{DVec3, Vec3};

use crate::discovery::ids::{NodeId, ObjectId};
use crate::discovery::object::Object;
use crate::discovery::support_graph::{NodeKind, SupportGraph};
use crate::error::{Error, Result};
use crate::objectness::hypotheses::Hypothesis;
use crate::raster::{PixelBox, Raster};
use crate::regions::Segments;

/// Makes objects of hypotheses, numbered from 1 by descending objectness, then descending pixel count, then ascending first pixel.
/// Also returns the label image, 0 = none. `facets`: the facets of which the regions consist. Node k of `support` is region k.
/// O(pixels log pixels + edges).
///
/// # Errors
/// [`Error::TooManyObjects`] beyond 65535.
pub fn make_objects(
    mut hypotheses: Vec<&Hypothesis>,
    facets: &Segments,
    points_m: &Raster<[f32; 3]>,
    support: &SupportGraph,
) -> Result<(Vec<Object>, Raster<u16>)> {
    if hypotheses.len() > usize::from(u16::MAX) {
        return Err(Error::TooManyObjects { found: hypotheses.len() });
    }
    hypotheses.sort_by(|a, b| {
        let by_size = || b.pixels.len().cmp(&a.pixels.len());
        b.objectness.total_cmp(&a.objectness).then_with(by_size).then_with(|| a.pixels[0].cmp(&b.pixels[0]))
    });
    let parents = support.parents();
    let mut labels = vec![0; points_m.len()];
    let mut objects = Vec::with_capacity(hypotheses.len());
    let mut seen = vec![0; facets.count() + 1];
    for (number, hypothesis) in (1..=u16::MAX).zip(hypotheses) {
        let &Hypothesis {
            region,
            ref pixels,
            box_m,
            objectness,
            parts,
            top_m,
            ref joins,
            is_flat,
            contrast: _,
        } = hypothesis;
        pixels.iter().for_each(|&i| labels[i] = number);
        objects.push(Object {
            id: ObjectId(number),
            objectness,
            parts,
            size_px: pixels.len(),
            box_px: PixelBox::around(pixels.iter().copied(), points_m.width()),
            centroid_m: centroid_m(pixels, points_m),
            box_m,
            facets: facets_among(pixels, facets, number, &mut seen),
            top_m,
            joins: joins.clone(),
            is_flat,
            node: NodeId(region.0),
            parents: parents.get(region.index()).cloned().unwrap_or_default(),
        });
    }
    Ok((objects, points_m.with_data(labels.into())))
}

/// A copy of the graph in which the nodes of objects are marked. O(nodes + edges).
pub(crate) fn mark_objects(support: &SupportGraph, objects: &[Object]) -> SupportGraph {
    let mut marked = support.clone();
    for object in objects {
        marked.nodes[object.node.0 as usize].kind = NodeKind::Object { object: object.id };
    }
    marked
}

fn centroid_m(pixels: &[usize], points_m: &Raster<[f32; 3]>) -> [f32; 3] {
    let sum: DVec3 = pixels.iter().map(|&i| Vec3::from(points_m[i]).as_dvec3()).sum();
    (sum / pixels.len() as f64).as_vec3().to_array()
}

/// The number of facets among some pixels; pixels without a facet count as one more. `seen[k + 1]`: the last object in which facet k
/// was seen; `seen[0]`: the last object in which a pixel without a facet was seen.
fn facets_among(pixels: &[usize], facets: &Segments, now: u16, seen: &mut [u16]) -> usize {
    let mut count = 0;
    for &i in pixels {
        let last = &mut seen[facets.at(i).map_or(0, |facet| facet.index() + 1)];
        count += usize::from(*last != now);
        *last = now;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discovery::object::OrientedBox;
    use crate::discovery::parts::ObjectnessParts;
    use crate::discovery::support_graph::SupportEdge;
    use crate::regions::SegmentId;

    const BOX: OrientedBox =
        OrientedBox { center_m: [0.0; 3], rotation_xyzw: [0.0, 0.0, 0.0, 1.0], extents_m: [0.1; 3] };

    fn hypothesis(region: u32, pixels: &[usize], objectness: f32) -> Hypothesis {
        let parts = ObjectnessParts {
            size: 1.0,
            support: 1.0,
            footing: 1.0,
            compactness: 1.0,
            separation: 1.0,
            visibility: 1.0,
        };
        Hypothesis {
            region: SegmentId(region),
            pixels: pixels.to_vec(),
            box_m: BOX,
            objectness,
            parts,
            top_m: None,
            joins: vec![],
            is_flat: false,
            contrast: 0.0,
        }
    }

    /// A 4 x 3 image whose point (u, v) lies at (u, v, 1); every column is a facet.
    fn found(hypotheses: &[Hypothesis]) -> (Vec<Object>, Raster<u16>) {
        let columns = Raster::from_vec(4, 3, (0..12).map(|i| i % 4).collect()).unwrap();
        let points = columns.with_data((0..12).map(|i| [(i % 4) as f32, (i / 4) as f32, 1.0]).collect());
        let support =
            SupportGraph { nodes: Vec::new(), edges: vec![SupportEdge::seen(NodeId(0), NodeId(7), 1)] };
        make_objects(hypotheses.iter().collect(), &Segments::from_labels(&columns), &points, &support)
            .unwrap()
    }

    #[test]
    fn an_object_is_described_by_its_pixels() {
        let (objects, labels) = found(&[hypothesis(7, &[1, 5, 6, 9], 0.8)]);
        let object = &objects[0];
        assert_eq!(labels.as_slice(), [0, 1, 0, 0, 0, 1, 1, 0, 0, 1, 0, 0]);
        assert_eq!(object.box_px, PixelBox { u: 1, v: 0, width: 2, height: 3 });
        assert_eq!((object.size_px, object.facets), (4, 2));
        assert_eq!(object.centroid_m, [1.25, 1.0, 1.0]);
        assert_eq!((object.node, object.parents.as_slice()), (NodeId(7), &[NodeId(0)][..]));
    }

    #[test]
    fn objects_are_ranked_by_objectness_then_size_then_place() {
        let (objects, labels) = found(&[
            hypothesis(0, &[8, 9], 0.8),
            hypothesis(1, &[4, 5], 0.8),
            hypothesis(2, &[0, 1, 2], 0.8),
            hypothesis(3, &[11], 0.9),
        ]);
        assert_eq!(objects.iter().map(|o| o.node.0).collect::<Vec<_>>(), [3, 2, 1, 0]);
        assert_eq!(labels.as_slice(), [2, 2, 2, 0, 3, 3, 0, 0, 4, 4, 0, 1]);
    }

    #[test]
    fn more_than_a_label_image_can_number_is_an_error() {
        let one = Raster::filled(1, 1, 0).unwrap();
        let points = one.with_data(vec![[0.0, 0.0, 1.0]].into());
        let facets = Segments::from_labels(&one);
        let one_of_many = hypothesis(0, &[0], 0.9);
        let many = |n| vec![&one_of_many; n];
        let support = SupportGraph::default();
        assert!(make_objects(many(65535), &facets, &points, &support).is_ok());
        let refused = make_objects(many(65536), &facets, &points, &support);
        assert!(matches!(refused, Err(Error::TooManyObjects { found: 65536 })));
    }
}
