//! The decision: a shape is an object when it has a graspable size and something carries it (METHOD 2.7).

use glamx::Vec3;

use crate::discovery::{Object, ObjectId, ObjectnessParts, PixelBox};
use crate::error::{Error, Result};
use crate::objectness::gravity::Up;
use crate::objectness::size::{longest_side_m, oriented_box};
use crate::objectness::support::{NodeId, NodeKind, SupportGraph};
use crate::params;
use crate::raster::Raster;
use crate::regions::Segments;

/// The objects, numbered by falling objectness, then falling pixel count, then first pixel; and the label
/// image. The nodes of `support` that are objects are marked as such.
///
/// A shape is an object when it has at least `min_size_px` points, its longest side is within
/// `min_side_m..=max_side_m` and its P(O) reaches `threshold`; its objectness is P(O). O(pixels log pixels).
///
/// # Errors
/// [`Error::TooManyObjects`] beyond 65535.
pub fn hypotheses(
    shapes: &Segments,
    facets: &Segments,
    points_m: &Raster<[f32; 3]>,
    support: &mut SupportGraph,
    up: &Up,
    params: &params::Objectness,
) -> Result<(Vec<Object>, Raster<u16>)> {
    let mut pixels: Vec<Vec<usize>> = vec![Vec::new(); shapes.count()];
    for (i, s) in shapes.members().filter(|&(i, _)| !points_m[i][2].is_nan()) {
        pixels[s].push(i);
    }

    let graspable = params.min_side_m..=params.max_side_m;
    let mut found = Vec::new();
    for (s, pixels) in pixels.iter().enumerate() {
        let node = &support.nodes[s];
        if pixels.len() < params.min_size_px || node.p_o < params.threshold {
            continue;
        }
        let points: Vec<[f32; 3]> = pixels.iter().map(|&i| points_m[i]).collect();
        let box_m = oriented_box(&points, up.direction);
        if graspable.contains(&longest_side_m(&box_m)) {
            found.push((s, points, box_m));
        }
    }
    found.sort_by(|(a, ..), (b, ..)| {
        let p_o = |s: usize| support.nodes[s].p_o;
        let by_size = || pixels[*b].len().cmp(&pixels[*a].len());
        p_o(*b).total_cmp(&p_o(*a)).then_with(by_size).then_with(|| pixels[*a][0].cmp(&pixels[*b][0]))
    });
    if found.len() > usize::from(u16::MAX) {
        return Err(Error::TooManyObjects { found: found.len() });
    }

    let mut labels = vec![0; shapes.labels().len()];
    let mut objects = Vec::with_capacity(found.len());
    for (number, (s, points, box_m)) in (1..).zip(found) {
        let (id, node, pixels) = (ObjectId(number), NodeId(s as u32), &pixels[s]);
        pixels.iter().for_each(|&i| labels[i] = number);
        support.nodes[s].kind = NodeKind::Object { object: id };
        let parents: Vec<NodeId> = support.parents(node).collect();
        let p_s = parents.iter().map(|p| support.nodes[p.0 as usize].p_s).fold(0.0, f32::max);
        let p_o = support.nodes[s].p_o;
        let mut facets: Vec<i32> = pixels.iter().map(|&i| facets.labels()[i]).collect();
        facets.sort_unstable();
        facets.dedup();
        objects.push(Object {
            id,
            objectness: p_o,
            parts: ObjectnessParts::Paper { size_ok: true, p_s, p_o },
            size_px: pixels.len(),
            box_px: pixel_box(pixels, shapes.labels().width()),
            centroid_m: centroid(&points),
            box_m,
            facets: facets.len(),
            node,
            parents,
        });
    }
    Ok((objects, points_m.with_data(labels)))
}

/// The smallest upright rectangle around pixels given by index, of which there is at least one.
fn pixel_box(pixels: &[usize], width: usize) -> PixelBox {
    let (mut left, mut right) = (usize::MAX, 0);
    for u in pixels.iter().map(|i| i % width) {
        left = left.min(u);
        right = right.max(u);
    }
    // Pixels come in scan order.
    let (top, bottom) = (pixels[0] / width, pixels[pixels.len() - 1] / width);
    PixelBox { u: left, v: top, width: right - left + 1, height: bottom - top + 1 }
}

fn centroid(points_m: &[[f32; 3]]) -> [f32; 3] {
    let sum: glamx::DVec3 = points_m.iter().map(|&p| Vec3::from(p).as_dvec3()).sum();
    (sum / points_m.len() as f64).as_vec3().to_array()
}
