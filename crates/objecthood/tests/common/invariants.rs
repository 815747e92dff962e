//! What holds for every discovery of either method, whatever the frame.

use objecthood::discovery::NodeKind;
use objecthood::{Discovery, Frame, ObjectnessParts, PixelBox};

/// Up and the structure planes.
pub(crate) fn check_scene(found: &Discovery) {
    let unit = |n: [f32; 3]| (n.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-4;
    assert!(unit(found.up.direction), "{:?}", found.up);
    for plane in &found.structure_planes {
        assert!(unit(plane.normal) && plane.offset_m.is_finite(), "{plane:?}");
        assert!(plane.inlier_share > 0.0 && plane.inlier_share <= 1.0, "{plane:?}");
    }
    for (&label, &plane) in found.labels.as_slice().iter().zip(found.structure.as_slice()) {
        assert!(usize::from(plane) <= found.structure_planes.len());
        assert!(label == 0 || plane == 0, "a pixel is of an object or of the structure");
    }
}

/// The edges of the support graph make no cycle and carry eq. 8.
pub(crate) fn check_edges(found: &Discovery) {
    let nodes = &found.support.nodes;
    let mut p_o = vec![0.0_f32; nodes.len()];
    let mut left = found.support.edges.clone();
    while !left.is_empty() {
        let carried: Vec<_> = left.iter().map(|edge| edge.upper).collect();
        let before = left.len();
        left.retain(|edge| carried.contains(&edge.lower));
        assert!(left.len() < before, "a cycle: {left:?}");
    }
    for edge in &found.support.edges {
        let (lower, upper) = (edge.lower.0 as usize, edge.upper.0 as usize);
        assert!((0.0..=1.0).contains(&edge.confidence), "{edge:?}");
        p_o[upper] = p_o[upper].max(nodes[lower].p_s).max(nodes[lower].p_o);
    }
    assert!(found.support.edges.is_sorted_by(|e, f| (e.lower, e.upper) < (f.lower, f.upper)));
    for (node, p_o) in nodes.iter().zip(p_o) {
        assert!(node.height_m.is_finite() && (0.0..=1.0).contains(&node.p_s) && node.p_o == p_o, "{node:?}");
    }
}

/// The objects, described again from the label image and the support graph.
pub(crate) fn check_descriptions(frame: &Frame, found: &Discovery) {
    let nodes = &found.support.nodes;
    let points = frame.points_m();
    let mut last = (f32::INFINITY, usize::MAX);
    for (k, object) in found.objects.iter().enumerate() {
        assert_eq!(usize::from(object.id.0), k + 1);
        let node = &nodes[object.node.0 as usize];
        assert_eq!(node.kind, NodeKind::Object { object: object.id });
        assert_eq!(node.size_px, object.size_px);
        let is_told = (node.p_o / 2.0..=node.p_o).contains(&object.parts.support);
        assert!(is_told || found.structure_planes.is_empty(), "{object:?} {node:?}");
        let ObjectnessParts { size, support, footing, compactness, separation, visibility } = object.parts;
        for part in [size, support, footing, compactness, separation, visibility, object.objectness] {
            assert!((0.0..=1.0).contains(&part), "{object:?}");
        }
        let rank = (object.objectness, object.size_px);
        assert!(rank.0 < last.0 || rank.0 == last.0 && rank.1 <= last.1, "objects are sorted");
        last = rank;

        let pixels: Vec<usize> = (0..points.len()).filter(|&i| found.labels[i] == object.id.0).collect();
        assert_eq!(object.size_px, pixels.len());
        assert!(pixels.iter().all(|&i| frame.is_valid(i)));
        let range = |f: &dyn Fn(usize) -> usize| {
            let at = || pixels.iter().map(|&i| f(i));
            (at().min().unwrap_or(0), at().max().unwrap_or(0))
        };
        let ((left, right), (top, bottom)) = (range(&|i| i % points.width()), range(&|i| i / points.width()));
        let box_px = PixelBox { u: left, v: top, width: right + 1 - left, height: bottom + 1 - top };
        assert_eq!(object.box_px, box_px);
        for (axis, got) in object.centroid_m.into_iter().enumerate() {
            let mean = pixels.iter().map(|&i| f64::from(points[i][axis])).sum::<f64>() / pixels.len() as f64;
            assert!((f64::from(got) - mean).abs() <= 1e-6 * mean.abs().max(1.0), "{got} {mean}");
        }

        let edges = found.support.edges.iter().filter(|e| e.upper == object.node);
        assert_eq!(object.parents, edges.map(|e| e.lower).collect::<Vec<_>>());
        assert!([object.box_m.center_m, object.box_m.extents_m].concat().iter().all(|x| x.is_finite()));
        let norm: f32 = object.box_m.rotation_xyzw.iter().map(|q| q * q).sum();
        assert!((norm - 1.0).abs() < 1e-4);
    }
}
