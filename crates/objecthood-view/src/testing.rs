//! Small frames and discoveries for the tests.

use objecthood::discovery::{NodeId, NodeKind, SupportEdge, SupportGraph, SupportNode};
use objecthood::{Camera, Discovery, Frame, Object, ObjectId, OrientedBox, PixelBox, Raster, Segments};

pub(crate) fn raster<T>(width: usize, height: usize, value: impl FnMut(usize) -> T) -> Raster<T> {
    Raster::from_vec(width, height, (0..width * height).map(value).collect()).unwrap()
}

pub(crate) fn segments(width: usize, height: usize, label: impl FnMut(usize) -> i32) -> Segments {
    Segments::from_labels(&raster(width, height, label))
}

/// A frame with this depth, and with colour or without.
pub(crate) fn frame(depth_m: Raster<f32>, color: Option<Raster<[u8; 3]>>) -> Frame {
    let camera = Camera::new(525.0, 525.0, 0.0, 0.0).unwrap();
    Frame::new(depth_m, color, camera).unwrap()
}

/// One object per label above 0; object k has objectness 1 / k.
pub(crate) fn discovery(labels: Raster<u16>) -> Discovery {
    let objects = labels.as_slice().iter().copied().max().unwrap_or(0);
    Discovery::new((1..=objects).map(object).collect(), labels)
}

fn object(id: u16) -> Object {
    let box_px = PixelBox { u: 0, v: 0, width: 1, height: 1 };
    let box_m = OrientedBox { center_m: [0.0; 3], rotation_xyzw: [0.0, 0.0, 0.0, 1.0], extents_m: [0.1; 3] };
    let mut object = Object::new(ObjectId(id), box_px, box_m);
    object.objectness = 1.0 / f32::from(id);
    object
}

/// A support graph of `nodes` nodes and the edges (lower, upper, contacts). The nodes in `objects` are objects 1, 2, .. from right
/// to left in the image.
pub(crate) fn standing(nodes: u32, objects: &[u32], edges: &[(u32, u32, u32)]) -> Discovery {
    let mut discovery = discovery(raster(1, 1, |_| objects.len() as u16));
    let node = |n: u32| SupportNode {
        kind: match objects.iter().position(|&o| o == n) {
            Some(k) => NodeKind::Object { object: ObjectId(k as u16 + 1) },
            None => NodeKind::Surface,
        },
        p_s: 0.5,
        p_o: 0.25,
        height_m: 0.0,
        size_px: 100 + n as usize,
    };
    let edge = |&(lower, upper, contacts)| SupportEdge::seen(NodeId(lower), NodeId(upper), contacts);
    discovery.support =
        SupportGraph { nodes: (0..nodes).map(node).collect(), edges: edges.iter().map(edge).collect() };
    let rightmost = 10 * objects.len();
    for (k, object) in discovery.objects.iter_mut().enumerate() {
        object.box_px.u = rightmost - 10 * k;
    }
    discovery
}

/// A graph of `nodes` nodes, about half of them objects, and `edges` random edges: upwards only, or any at all.
pub(crate) fn random_support(seed: u32, nodes: u32, edges: u32, upwards: bool) -> Discovery {
    // A linear congruential generator (Numerical Recipes); its high bits are the random ones.
    let mut state = seed;
    let mut below = |n: u32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        ((u64::from(state) * u64::from(n)) >> 32) as u32
    };
    let objects: Vec<u32> = (0..nodes).filter(|_| below(2) == 0).collect();
    let mut pairs: Vec<(u32, u32)> = (0..edges).map(|_| (below(nodes), below(nodes))).collect();
    if upwards {
        pairs.retain(|(lower, upper)| lower < upper);
    }
    pairs.sort_unstable();
    pairs.dedup();
    let edges: Vec<_> = pairs.into_iter().map(|(lower, upper)| (lower, upper, below(1000))).collect();
    standing(nodes, &objects, &edges)
}
