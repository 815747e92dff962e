//! How deep a pixel lies inside its region, and where a region is deepest: there its number is read best.

use objecthood::Raster;

/// Length of a step to a side, in the unit of [`to_border`]; a diagonal step is [`DIAGONAL`] long.
pub(crate) const SIDE: u32 = 3;
const DIAGONAL: u32 = 4;

/// The distance from every pixel to the nearest pixel of another label, or to the outside of the image, in
/// thirds of a pixel: at most 8 % from the Euclidean one.
///
/// Chamfer 3-4: G. Borgefors, "Distance transformations in digital images", CVGIP 34, 1986. Two passes, O(n).
pub(crate) fn to_border<T: Copy + PartialEq>(labels: &Raster<T>) -> Vec<u32> {
    let (width, height) = labels.size();
    let mut distance = vec![u32::MAX; labels.len()];
    let mut relax = |u: usize, v: usize, sign: isize| {
        let i = v * width + u;
        for (du, dv, step) in [(-1, 0, SIDE), (-1, -1, DIAGONAL), (0, -1, SIDE), (1, -1, DIAGONAL)] {
            let neighbour = u.checked_add_signed(sign * du).zip(v.checked_add_signed(sign * dv));
            let beyond = match neighbour {
                Some((nu, nv)) if labels.get(nu, nv) == Some(&labels[i]) => distance[nv * width + nu],
                _ => 0,
            };
            distance[i] = distance[i].min(beyond + step);
        }
    };
    for v in 0..height {
        for u in 0..width {
            relax(u, v, 1);
        }
    }
    for v in (0..height).rev() {
        for u in (0..width).rev() {
            relax(u, v, -1);
        }
    }
    distance
}

/// Where to write the number of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Anchor {
    /// The object's number, 1 or more.
    pub(crate) id: u16,
    /// Column of a pixel of the object.
    pub(crate) u: usize,
    /// Row of that pixel.
    pub(crate) v: usize,
    /// Radius of the disc around it that the object holds [px].
    pub(crate) radius_px: f32,
}

/// One anchor per label above 0, by rising label.
///
/// It is a pixel of the object far from its border, never outside as the centroid of a bent object may be. Of the
/// pixels at nine tenths of the greatest distance or more, the one nearest to the centroid: the middle of a long
/// box, not an arbitrary point of its axis.
pub(crate) fn anchors(labels: &Raster<u16>, distance: &[u32]) -> Vec<Anchor> {
    #[derive(Clone, Copy, Default)]
    struct Extent {
        pixels: u64,
        sum_u: u64,
        sum_v: u64,
        deepest: u32,
    }
    let highest = labels.as_slice().iter().copied().max().map_or(0, usize::from);
    let mut extents = vec![Extent::default(); highest + 1];
    let width = labels.width();
    for (i, (&label, &depth)) in labels.as_slice().iter().zip(distance).enumerate() {
        let extent = &mut extents[usize::from(label)];
        extent.pixels += 1;
        extent.sum_u += (i % width) as u64;
        extent.sum_v += (i / width) as u64;
        extent.deepest = extent.deepest.max(depth);
    }

    let mut nearest: Vec<Option<(u64, Anchor)>> = vec![None; highest + 1];
    for (i, (&id, &depth)) in labels.as_slice().iter().zip(distance).enumerate() {
        let Extent { pixels, sum_u, sum_v, deepest } = extents[usize::from(id)];
        if id == 0 || depth * 10 < deepest * 9 {
            continue;
        }
        let (u, v) = (i % width, i / width);
        let from_centroid = |x: usize, sum: u64| (x as u64 * pixels).abs_diff(sum) / pixels;
        let (du, dv) = (from_centroid(u, sum_u), from_centroid(v, sum_v));
        let off_center = du * du + dv * dv;
        let best = &mut nearest[usize::from(id)];
        if best.is_none_or(|(least, _)| off_center < least) {
            *best = Some((off_center, Anchor { id, u, v, radius_px: depth as f32 / SIDE as f32 }));
        }
    }
    nearest.into_iter().flatten().map(|(_, anchor)| anchor).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The Euclidean distance by trying every pixel, the ring outside included.
    fn naive(labels: &Raster<u16>, i: usize) -> f64 {
        let (w, h) = (labels.width() as isize, labels.height() as isize);
        let (u, v) = (i as isize % w, i as isize / w);
        let mut least = f64::INFINITY;
        for y in -1..=h {
            for x in -1..=w {
                let inside = (0..w).contains(&x) && (0..h).contains(&y);
                if !inside || labels[(y * w + x) as usize] != labels[i] {
                    least = least.min((((x - u).pow(2) + (y - v).pow(2)) as f64).sqrt());
                }
            }
        }
        least
    }

    fn blobs(width: usize, height: usize, labels: u32) -> Raster<u16> {
        let label = |i: usize| {
            let (x, y) = (i % width / 7, i / width / 5);
            ((x as u32 * 7919 + y as u32 * 104_729).wrapping_mul(2_654_435_769) >> 16) % labels
        };
        Raster::from_vec(width, height, (0..width * height).map(|i| label(i) as u16).collect()).unwrap()
    }

    #[test]
    fn distances_are_nearly_euclidean() {
        let uniform = Raster::filled(23, 31, 1).unwrap();
        for labels in [blobs(61, 47, 2), blobs(40, 1, 3), blobs(1, 40, 3), uniform] {
            for (i, &d) in to_border(&labels).iter().enumerate() {
                let (ours, exact) = (f64::from(d) / f64::from(SIDE), naive(&labels, i));
                assert!((ours - exact).abs() <= 0.081 * exact, "pixel {i}: {ours} for {exact}");
            }
        }
    }

    #[test]
    fn every_anchor_is_a_deep_pixel_of_its_object() {
        for labels in [blobs(97, 61, 6), blobs(300, 200, 60_000), Raster::filled(1, 1, u16::MAX).unwrap()] {
            let distance = to_border(&labels);
            let anchors = anchors(&labels, &distance);
            let mut ids: Vec<u16> = labels.as_slice().iter().copied().filter(|&l| l > 0).collect();
            ids.sort_unstable();
            ids.dedup();
            assert_eq!(anchors.iter().map(|a| a.id).collect::<Vec<_>>(), ids);
            for a in anchors {
                assert_eq!(labels.get(a.u, a.v), Some(&a.id));
                let deepest =
                    (0..labels.len()).filter(|&i| labels[i] == a.id).map(|i| distance[i]).max().unwrap();
                assert!(a.radius_px * SIDE as f32 >= 0.9 * deepest as f32 - 1e-3);
            }
        }
    }

    #[test]
    fn a_ring_is_labelled_on_the_ring_and_a_bar_in_its_middle() {
        let (size, centre) = (101_usize, 50_i32);
        let ring = |i: usize| {
            let (x, y) = ((i % size) as i32 - centre, (i / size) as i32 - centre);
            u16::from((30 * 30..45 * 45).contains(&(x * x + y * y)))
        };
        let labels = Raster::from_vec(size, size, (0..size * size).map(ring).collect()).unwrap();
        let found = anchors(&labels, &to_border(&labels));
        assert_eq!(labels.get(found[0].u, found[0].v), Some(&1));
        assert!(found[0].radius_px > 6.0, "{found:?}");

        let bar = |i: usize| u16::from((10..90).contains(&(i % 100)) && (4..15).contains(&(i / 100)));
        let labels = Raster::from_vec(100, 20, (0..2000).map(bar).collect()).unwrap();
        let found = anchors(&labels, &to_border(&labels));
        assert!(found[0].u.abs_diff(49) <= 1 && found[0].v == 9, "{found:?}");
    }

    #[test]
    fn no_object_no_anchor() {
        let labels = Raster::filled(5, 4, 0_u16).unwrap();
        assert!(anchors(&labels, &to_border(&labels)).is_empty());
    }
}
