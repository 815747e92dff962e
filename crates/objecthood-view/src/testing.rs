//! Small frames and discoveries for the tests.

use objecthood::objectness::gravity::{Up, UpSource};
use objecthood::objectness::support::{NodeId, SupportGraph};
use objecthood::{
    Camera, Discovery, Frame, Object, ObjectId, ObjectnessParts, OrientedBox, PixelBox, Raster, Segments,
};

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
    let up = Up { direction: [0.0, -1.0, 0.0], source: UpSource::Camera };
    let objects = (1..=objects).map(object).collect();
    Discovery {
        structure: labels.map(|_| 0),
        labels,
        objects,
        up,
        structure_planes: vec![],
        support: SupportGraph::default(),
        notices: vec![],
    }
}

fn object(id: u16) -> Object {
    Object {
        id: ObjectId(id),
        objectness: 1.0 / f32::from(id),
        parts: ObjectnessParts::Paper { size_ok: true, p_s: 1.0, p_o: 1.0 },
        size_px: 1,
        box_px: PixelBox { u: 0, v: 0, width: 1, height: 1 },
        centroid_m: [0.0; 3],
        box_m: OrientedBox { center_m: [0.0; 3], rotation_xyzw: [0.0, 0.0, 0.0, 1.0], extents_m: [0.1; 3] },
        facets: 1,
        node: NodeId(0),
        parents: vec![],
        joins: vec![],
    }
}
