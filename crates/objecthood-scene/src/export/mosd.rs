//! Point clouds as in the mOSD data set, which `objecthood eval` reads.

use objecthood::Raster;

use super::lzf;
use crate::render::Rendered;
use crate::solid::Role;
use crate::world::World;

/// Visible pieces of an object smaller than this (px) do not count as parts of their own.
const MIN_PART_PX: usize = 50;
/// Parts that the labels of one object can tell apart.
const MAX_PARTS: usize = 10;
const POINT_BYTES: usize = 20;

/// An organized PCD file, version 0.7, `binary_compressed`, with the fields label, x, y, z and rgba.
///
/// Labels are [`mosd_labels`]; where they are 0 there is no point.
pub fn pcd(world: &World, rendered: &Rendered, crop: bool) -> Vec<u8> {
    let (width, height) = rendered.frame.size();
    let labels = mosd_labels(world, rendered, crop);
    let points = rendered.frame.points_m();

    // One whole field after the other.
    let pixels = width * height;
    let mut block = Vec::with_capacity(pixels * POINT_BYTES);
    labels.as_slice().iter().for_each(|label| block.extend(label.to_le_bytes()));
    for axis in 0..3 {
        for (point, &label) in points.as_slice().iter().zip(labels.as_slice()) {
            let value = if label == 0 { f32::NAN } else { point[axis] };
            block.extend(value.to_le_bytes());
        }
    }
    for i in 0..pixels {
        let [r, g, b] = rendered.frame.color().map_or([0; 3], |color| color[i]);
        block.extend([b, g, r, 255]);
    }

    let packed = lzf::compress(&block);
    let mut file = format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS label x y z rgba\nSIZE 4 4 4 4 4\n\
         TYPE U F F F U\nCOUNT 1 1 1 1 1\nWIDTH {width}\nHEIGHT {height}\nVIEWPOINT 0 0 0 1 0 0 0\n\
         POINTS {pixels}\nDATA binary_compressed\n"
    )
    .into_bytes();
    file.extend((packed.len() as u32).to_le_bytes());
    file.extend((block.len() as u32).to_le_bytes());
    file.extend(packed);
    file
}

/// The truth of every pixel as mOSD has it.
///
/// 0 = no depth; 1 = whatever is no object; 10 (k + 1) and up = the k-th object, k >= 1, one number for each of its disjoint
/// visible parts. With `crop` the room (floor and walls) is 0 too, as in mOSD.
pub fn mosd_labels(world: &World, rendered: &Rendered, crop: bool) -> Raster<u32> {
    let is_kept =
        |instance: u16| world.solid(instance).is_some_and(|solid| !crop || solid.role() != Role::Room);
    mosd_labels_of(&rendered.truth.instance, is_kept, world.objects())
}

/// As [`mosd_labels`] for any map of instances: those in `objects` are the objects in this order, the others that
/// `is_kept` names are no object, the rest is not there.
pub fn mosd_labels_of(
    instances: &Raster<u16>,
    is_kept: impl Fn(u16) -> bool,
    objects: impl Iterator<Item = u16>,
) -> Raster<u32> {
    let mut labels = instances.map(|&k| u32::from(is_kept(k)));
    for (k, object) in objects.enumerate() {
        let mut parts = parts(instances, object);
        parts.sort_by_key(|part| std::cmp::Reverse(part.len()));
        for (number, part) in parts.iter().enumerate() {
            let own = if part.len() >= MIN_PART_PX && number < MAX_PARTS { number } else { 0 };
            part.iter().for_each(|&i| labels.as_mut_slice()[i] = 10 * (k as u32 + 2) + own as u32);
        }
    }
    labels
}

/// The pixels of an instance as 8-connected pieces, in the order of their first pixels.
fn parts(instances: &Raster<u16>, instance: u16) -> Vec<Vec<usize>> {
    let (width, height) = instances.size();
    let mut is_open: Vec<bool> = instances.as_slice().iter().map(|&k| k == instance).collect();
    let mut parts = Vec::new();
    for first in 0..is_open.len() {
        if !std::mem::take(&mut is_open[first]) {
            continue;
        }
        let mut part = vec![first];
        let mut next = 0;
        while let Some(&i) = part.get(next) {
            next += 1;
            let (u, v) = (i % width, i / width);
            for y in v.saturating_sub(1)..(v + 2).min(height) {
                for x in u.saturating_sub(1)..(u + 2).min(width) {
                    if std::mem::take(&mut is_open[y * width + x]) {
                        part.push(y * width + x);
                    }
                }
            }
        }
        parts.push(part);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_connected_over_corners() {
        #[rustfmt::skip]
        let instances = Raster::from_vec(5, 3, vec![
            7, 0, 0, 7, 7,
            0, 7, 0, 0, 7,
            0, 0, 0, 2, 0,
        ]).unwrap();
        assert_eq!(parts(&instances, 7), [vec![0, 6], vec![3, 4, 9]]);
        assert_eq!(parts(&instances, 2), [vec![13]]);
        assert!(parts(&instances, 3).is_empty());
    }
}
