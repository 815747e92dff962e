//! The decision: a shape is an object when it has a graspable size and something carries it (METHOD 2.7).

use crate::discovery::{ObjectnessParts, OrientedBox};
use crate::objectness::gravity::Up;
use crate::objectness::join::Join;
use crate::objectness::size::{longest_side_m, oriented_box};
use crate::objectness::support::SupportGraph;
use crate::params;
use crate::raster::Raster;
use crate::regions::{SegmentId, Segments};

/// A shape that is taken for an object, and why.
#[derive(Clone, Debug)]
pub struct Hypothesis {
    /// The shape.
    pub shape: SegmentId,
    /// Its pixels with depth, in scan order; at least one.
    pub pixels: Vec<usize>,
    /// Its box.
    pub box_m: OrientedBox,
    /// How sure it is, in [0, 1].
    pub objectness: f32,
    /// What the objectness is made of.
    pub parts: ObjectnessParts,
    /// Which of its parts were joined although they do not touch as one surface.
    pub joins: Vec<Join>,
}

/// The shapes that are objects: with at least `min_size_px` points, a longest side within
/// `min_side_m..=max_side_m` and a P(O) of at least `threshold`, which is their objectness. In the order of the shapes.
///
/// *Differs from the paper:* it prints neither the limits of size nor the threshold. O(pixels + edges).
pub fn decide(
    shapes: &Segments,
    points_m: &Raster<[f32; 3]>,
    support: &SupportGraph,
    up: &Up,
    params: &params::Objectness,
) -> Vec<Hypothesis> {
    let mut pixels: Vec<Vec<usize>> = vec![Vec::new(); shapes.count()];
    for (i, s) in shapes.members().filter(|&(i, _)| !points_m[i][2].is_nan()) {
        pixels[s].push(i);
    }
    let parents = support.parents();
    let graspable = params.min_side_m..=params.max_side_m;
    let judge = |(s, pixels): (usize, Vec<usize>)| {
        let p_o = support.nodes[s].p_o;
        if pixels.len() < params.min_size_px || p_o < params.threshold {
            return None;
        }
        let points: Vec<[f32; 3]> = pixels.iter().map(|&i| points_m[i]).collect();
        let box_m = oriented_box(&points, up.direction);
        let size_ok = graspable.contains(&longest_side_m(&box_m));
        let p_s = parents[s].iter().map(|p| support.nodes[p.0 as usize].p_s).fold(0.0, f32::max);
        let parts = ObjectnessParts::Paper { size_ok, p_s, p_o };
        let shape = SegmentId(s as u32);
        size_ok.then_some(Hypothesis { shape, pixels, box_m, objectness: p_o, parts, joins: Vec::new() })
    };
    pixels.into_iter().enumerate().filter_map(judge).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objectness::gravity::UpSource;
    use crate::objectness::support::{NodeId, NodeKind, SupportEdge, SupportNode};

    /// Shape 0 carries shapes 1 and 2. Shape s has a point every centimetre of a bar of `lengths_cm[s]`.
    fn decided(lengths_cm: [usize; 3], p_o: f32, params: &params::Objectness) -> Vec<Hypothesis> {
        let labels: Vec<i32> = (0..3).flat_map(|s| vec![s as i32; lengths_cm[s] + 1]).collect();
        let along = lengths_cm.into_iter().flat_map(|length| 0..=length);
        let points = along.map(|x| [x as f32 / 100.0, 0.0, 1.0]).collect();
        let shapes = Segments::from_labels(&Raster::from_vec(labels.len(), 1, labels).unwrap());
        let points = shapes.labels().with_data(points);
        let node = |p_s, p_o| SupportNode { kind: NodeKind::Surface, p_s, p_o, height_m: 0.0, size_px: 1 };
        let edge = |upper| SupportEdge::seen(NodeId(0), NodeId(upper), 1);
        let support = SupportGraph {
            nodes: vec![node(0.9, 0.0), node(0.2, p_o), node(0.3, p_o)],
            edges: vec![edge(1), edge(2)],
        };
        let up = Up { direction: [0.0, -1.0, 0.0], source: UpSource::Camera };
        decide(&shapes, &points, &support, &up, params)
    }

    fn shapes_of(hypotheses: &[Hypothesis]) -> Vec<u32> {
        hypotheses.iter().map(|h| h.shape.0).collect()
    }

    #[test]
    fn size_pixels_and_support_decide_and_limits_are_included() {
        let lax = params::Objectness { min_size_px: 1, ..Default::default() };
        let found = decided([200, 30, 40], 0.9, &lax);
        assert_eq!(shapes_of(&found), [1, 2], "the first one is too long and nothing carries it");
        assert_eq!(found[0].parts, ObjectnessParts::Paper { size_ok: true, p_s: 0.9, p_o: 0.9 });
        assert_eq!((found[0].objectness, found[0].pixels.len()), (0.9, 31));

        assert_eq!(shapes_of(&decided([200, 90, 40], 0.9, &lax)), [2], "too long");
        assert_eq!(shapes_of(&decided([200, 30, 40], 0.7, &lax)), [1, 2], "P(O) on the threshold");
        assert!(decided([200, 30, 40], 0.69, &lax).is_empty());
        let pixels = |min_size_px| params::Objectness { min_size_px, ..Default::default() };
        assert_eq!(shapes_of(&decided([200, 30, 40], 0.9, &pixels(31))), [1, 2]);
        assert_eq!(shapes_of(&decided([200, 30, 40], 0.9, &pixels(32))), [2]);
    }
}
