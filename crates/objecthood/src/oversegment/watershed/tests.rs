use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use proptest::prelude::*;

use super::*;
use crate::oversegment::linked_pairs::count_linked_pairs;
use crate::regions::SegmentId;
use crate::testing::{coarse_disparity, kinect, raster, small_size};

/// Inputs of the watershed, in coarse steps, so that levels and residuals tie.
#[derive(Clone, Debug)]
struct Relief {
    disparity: Raster<f32>,
    slope: Raster<[f32; 2]>,
    residual: Raster<f32>,
    structure: Raster<i32>,
}

fn relief() -> impl Strategy<Value = Relief> {
    // No fit, and residuals from 0 to beyond the highest level.
    let residual = prop_oneof![1 => Just(f32::INFINITY), 6 => (0_u8..6).prop_map(|k| 1.3 * f32::from(k))];
    let slope = prop::array::uniform2(-2_i8..=2).prop_map(|slope| slope.map(|s| 1.5 * f32::from(s)));
    let structure = prop_oneof![7 => Just(-1), 1 => Just(0)];
    // Small images, and images wider than a stretch.
    let size = prop_oneof![4 => small_size(), 1 => (STRETCH - 3..STRETCH + 9, 1_usize..5)];
    size.prop_flat_map(move |size| {
        let disparity = raster(size, coarse_disparity());
        let parts = (
            disparity,
            raster(size, slope.clone()),
            raster(size, residual.clone()),
            raster(size, structure.clone()),
        );
        parts.prop_map(|(disparity, slope, residual, structure)| Relief {
            disparity,
            slope,
            residual,
            structure,
        })
    })
}

/// Links and superpixels.
fn flooded(relief: &Relief, params: &params::Watershed) -> (Links, Segments) {
    let Relief { disparity, slope, residual, structure } = relief;
    let links = Links::new(disparity, slope, structure, &kinect(), params);
    let seeds = find_seeds(residual, &links, &kinect(), params);
    let superpixels = flood(residual, &seeds, &links);
    (links, superpixels)
}

/// The neighbours of a pixel, in the order in which the flood visits them.
fn around(i: usize, (width, height): (usize, usize)) -> Vec<(usize, usize)> {
    let (u, v) = ((i % width) as isize, (i / width) as isize);
    [(1, 0), (-1, 0), (0, 1), (0, -1)]
        .into_iter()
        .map(|(du, dv)| (u + du, v + dv, usize::from(dv != 0)))
        .filter(|&(u, v, _)| (0..width as isize).contains(&u) && (0..height as isize).contains(&v))
        .map(|(u, v, axis)| (v as usize * width + u as usize, axis))
        .collect()
}

/// Whether two measured 4-neighbours outside the structure lie on one surface, written from docs/CONTEXT.md 1.2.
fn linked(relief: &Relief, i: usize, j: usize, axis: usize) -> bool {
    let Relief { disparity, slope, structure, .. } = relief;
    let step = if j > i { 1.0 } else { -1.0 };
    let rise = disparity[j] - disparity[i];
    let slopes = [i, j].map(|k| slope[k][axis] * step);
    let misfit = slopes.map(|slope| (rise - slope).abs());
    let sideways = 0.8 * slopes[0].abs().min(slopes[1].abs());
    structure[i] < 0 && structure[j] < 0 && misfit[0].min(misfit[1]) < 2.5 + 0.5 * sideways
}

/// Floods pixel by pixel, always from the lowest level, and within a level from the pixel reached first.
fn naive(relief: &Relief, block: usize) -> Vec<i32> {
    let Relief { disparity, residual, structure, .. } = relief;
    let size = disparity.size();
    let is_free = |i: usize| !disparity[i].is_nan() && structure[i] < 0;
    let level = |i: usize| {
        if residual[i].is_finite() { (residual[i] * 40.0).floor().min(254.0) as usize } else { 255 }
    };
    let mut seeds: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for i in (0..disparity.len()).filter(|&i| is_free(i)) {
        let seed = seeds.entry((i / size.0 / block, i % size.0 / block)).or_insert(i);
        if residual[i] < residual[*seed] {
            *seed = i;
        }
    }
    let mut labels = vec![-1; disparity.len()];
    let mut queue = BinaryHeap::new();
    let mut reached = 0;
    for (label, &i) in seeds.values().enumerate() {
        labels[i] = label as i32;
        queue.push(Reverse((level(i), reached, i)));
        reached += 1;
    }
    let mut count = seeds.len() as i32;
    loop {
        while let Some(Reverse((now, _, i))) = queue.pop() {
            for (j, axis) in around(i, size) {
                if labels[j] < 0 && linked(relief, i, j, axis) {
                    labels[j] = labels[i];
                    queue.push(Reverse((level(j).max(now), reached, j)));
                    reached += 1;
                }
            }
        }
        let Some(left) = (0..labels.len()).find(|&i| labels[i] < 0 && is_free(i)) else { return labels };
        labels[left] = count;
        count += 1;
        queue.push(Reverse((0, reached, left)));
    }
}

proptest! {
    #[test]
    fn the_flood_is_the_naive_one(relief in relief(), block in 1_usize..6) {
        let params = params::Watershed { seed_block_px: block, link_jump_quanta: 2.5 };
        let (_, superpixels) = flooded(&relief, &params);
        let expected = naive(&relief, block);
        prop_assert_eq!(superpixels.labels().as_slice(), expected.as_slice());
        prop_assert_eq!(superpixels.count() as i32, expected.iter().max().map_or(0, |most| most + 1));
    }

    #[test]
    fn superpixels_cover_what_is_free_and_hang_together_by_links(relief in relief()) {
        let params = params::Watershed { seed_block_px: 3, link_jump_quanta: 2.5 };
        let (links, superpixels) = flooded(&relief, &params);
        let Relief { disparity, structure, .. } = &relief;
        let size = disparity.size();
        let mut pairs: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        let mut parts = crate::union_find::UnionFind::new(disparity.len());
        for i in 0..disparity.len() {
            let is_free = !disparity[i].is_nan() && structure[i] < 0;
            prop_assert_eq!(superpixels.at(i).is_some(), is_free, "{}", i);
            for (j, axis) in around(i, size) {
                let is_linked = links.neighbours(i).any(|k| k == j);
                prop_assert_eq!(is_linked, linked(&relief, i, j, axis), "{} {}", i, j);
                prop_assert_eq!(is_linked, linked(&relief, j, i, axis), "{} {}", i, j);
                let (Some(a), Some(b)) = (superpixels.at(i), superpixels.at(j)) else { continue };
                if a == b && is_linked {
                    let [p, q] = [i, j].map(|k| parts.find(k));
                    parts.link(p, q);
                } else if a < b && is_linked {
                    *pairs.entry((a.0, b.0)).or_default() += 1;
                }
            }
        }
        // Each superpixel is connected.
        let mut root: BTreeMap<SegmentId, usize> = BTreeMap::new();
        for i in (0..disparity.len()).filter(|&i| superpixels.at(i).is_some()) {
            let found = parts.find(i);
            let expected = superpixels.at(i).map(|s| *root.entry(s).or_insert(found));
            prop_assert_eq!(expected, Some(found), "{}", i);
        }
        let graph = count_linked_pairs(&superpixels, &links);
        let got: Vec<_> = graph.edges().iter().map(|e| ((e.a.0, e.b.0), e.evidence)).collect();
        prop_assert_eq!(got, pairs.into_iter().collect::<Vec<_>>());
    }
}

#[test]
fn a_step_parts_and_a_slope_does_not() {
    let params = params::Watershed::default();
    let disparity = Raster::from_vec(4, 1, vec![200.0, 207.0, 214.0, 230.0]).unwrap();
    let linked = |slope: f32| {
        let slopes = Raster::filled(4, 1, [slope, 0.0]).unwrap();
        let structure = Raster::filled(4, 1, -1).unwrap();
        let links = Links::new(&disparity, &slopes, &structure, &kinect(), &params);
        [0, 1, 2].map(|i| links.neighbours(i).any(|j| j == i + 1))
    };
    assert_eq!(linked(0.0), [false, false, false]);
    assert_eq!(linked(7.0), [true, true, false]);
    // 0.8 px of sideways noise on a slope of 12 quanta/px are 4.8 quanta more to either side.
    assert_eq!(linked(12.0), [true, true, true]);
}
