//! Groups superpixels of similar appearance into facets (paper, III-B).

use crate::facets::appearance::Appearance;
use crate::oversegment::Superpixels;
use crate::oversegment::pixel_edge::{STEPS, columns};
use crate::params;
use crate::raster::Raster;
use crate::regions::{RegionGraph, SegmentId, Segments};
use crate::union_find::UnionFind;

/// Counts, for any two superpixels, the pairs of 8-neighbours between them. O(pixels + pairs log pairs).
pub(crate) fn count_neighbours(segments: &Segments) -> RegionGraph<u32> {
    let labels = segments.labels();
    let (width, height) = labels.size();
    let row = |v: usize| &labels.as_slice()[v * width..][..width];
    let id = |l: i32| u32::try_from(l).ok().map(SegmentId);
    let mut pairs = Vec::new();
    for (du, dv) in STEPS {
        let (from, to) = columns(du, width);
        for v in 0..height - dv {
            let ends = row(v)[from.clone()].iter().zip(&row(v + dv)[to.clone()]);
            pairs.extend(ends.filter(|(a, b)| a != b).filter_map(|(&a, &b)| Some((id(a)?, id(b)?))));
        }
    }
    RegionGraph::from_pairs(segments.count(), pairs)
}

/// Joins neighbouring superpixels in ascending order of their difference while it does not exceed the internal
/// variation of either group; every join averages both variations and the difference.
///
/// A superpixel with depth on at most half of its pixels is never joined. Facets are numbered in the order of their roots in the
/// union-find.
///
/// *Differs from the paper:* "the average between the internal variation of the two groups and the edge" is
/// read as the mean of three. Histograms are not recounted after a join (PARITY.md 3). O(E log E) for E pairs.
pub fn group_superpixels(
    superpixels: &Superpixels,
    appearance: &Appearance,
    depth_m: &Raster<f32>,
    params: &params::Grouping,
) -> Segments {
    let segments = &superpixels.segments;
    let measured = find_mostly_measured(segments, depth_m);
    let differences = count_neighbours(segments).map(|e| appearance.difference(e.a.index(), e.b.index()));
    let mut edges: Vec<_> =
        differences.edges().iter().filter(|e| measured[e.a.index()] && measured[e.b.index()]).collect();
    // Stable, so that equal differences stay in the order (a, b).
    edges.sort_by(|x, y| x.evidence.total_cmp(&y.evidence));

    let mut sets = UnionFind::new(segments.count());
    let mut variation = vec![params.initial_variation; segments.count()];
    for edge in edges {
        let (a, b) = (sets.find(edge.a.index()), sets.find(edge.b.index()));
        if a != b && edge.evidence <= variation[a].min(variation[b]) {
            sets.link(a, b);
            variation[a] = (variation[a] + variation[b] + edge.evidence) / 3.0;
        }
    }
    let (group_of, count) = sets.groups();
    segments.grouped(&group_of, count)
}

/// Finds the segments with depth on more than half of their pixels.
fn find_mostly_measured(segments: &Segments, depth_m: &Raster<f32>) -> Vec<bool> {
    let mut balance = vec![0_i64; segments.count()];
    for (i, s) in segments.members() {
        balance[s] += if depth_m[i].is_nan() { -1 } else { 1 };
    }
    balance.into_iter().map(|b| b > 0).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn neighbours_are_the_brute_force_ones(
            (width, labels) in (1_usize..9, 1_usize..9).prop_flat_map(|(w, h)| (Just(w), prop::collection::vec(-1_i32..5, w * h))),
        ) {
            let height = labels.len() / width;
            let segments = Segments::from_labels(&Raster::from_vec(width, height, labels).unwrap());
            let mut expected = BTreeMap::new();
            for p in 0..width * height {
                for q in p + 1..width * height {
                    let near = (p % width).abs_diff(q % width) <= 1 && (p / width).abs_diff(q / width) <= 1;
                    if let (true, Some(a), Some(b)) = (near, segments.at(p), segments.at(q)) && a != b {
                        *expected.entry((a.min(b), a.max(b))).or_insert(0) += 1;
                    }
                }
            }
            let got: Vec<_> = count_neighbours(&segments).edges().iter().map(|e| ((e.a, e.b), e.evidence)).collect();
            prop_assert_eq!(got, expected.into_iter().collect::<Vec<_>>());
        }
    }

    /// Four superpixels in a row, each of one grey level.
    fn scene(greys: [u8; 4]) -> (Superpixels, Appearance, Raster<f32>) {
        let labels = Raster::from_vec(8, 1, vec![0, 0, 1, 1, 2, 2, 3, 3]).unwrap();
        let superpixels =
            Superpixels { core: labels.map(|_| true), segments: Segments::from_labels(&labels) };
        let color = labels.map(|&l| [greys[l as usize]; 3]);
        let normals = labels.map(|_| [0.0, 0.0, -1.0]);
        let appearance =
            Appearance::new(&superpixels, Some(&color), &normals, &params::Appearance::default());
        (superpixels, appearance, labels.map(|_| 1.0))
    }

    #[test]
    fn what_looks_alike_is_joined_and_variation_is_averaged() {
        let (superpixels, appearance, depth) = scene([0, 0, 255, 0]);
        let joined = |c: f64, depth: &Raster<f32>| {
            let params = params::Grouping { initial_variation: c };
            group_superpixels(&superpixels, &appearance, depth, &params).labels().as_slice().to_vec()
        };
        // Colours that share no bin differ by 0.5; equal ones by 0.
        assert_eq!(joined(0.4, &depth), [0, 0, 0, 0, 1, 1, 2, 2]);
        // With c = 0.5 the pair 0-1 has averaged to (0.5 + 0.5 + 0) / 3 before the edge 1-2 is visited; 2-3 still joins.
        assert_eq!(joined(0.5, &depth), [0, 0, 0, 0, 1, 1, 1, 1]);
        // A superpixel with depth on half of its pixels is not joined.
        let mut holes = depth;
        holes.as_mut_slice()[3] = f32::NAN;
        assert_eq!(joined(0.4, &holes), [0, 0, 1, 1, 2, 2, 3, 3]);
    }

    proptest! {
        #[test]
        fn facets_are_those_of_explicit_groups(
            (width, pixels) in (1_usize..9, 1_usize..9).prop_flat_map(|(w, h)| {
                (Just(w), prop::collection::vec((-1_i32..9, 0_u8..3, 0_usize..3, 0_u8..5), w * h))
            }),
            initial_variation in 0.0_f64..1.0,
            color_weight in 0.0_f64..1.0,
        ) {
            let n = pixels.len();
            let labels = Raster::from_vec(width, n / width, pixels.iter().map(|p| p.0).collect()).unwrap();
            let segments = Segments::from_labels(&labels);
            let superpixels = Superpixels { core: labels.map(|_| true), segments: segments.clone() };
            let color = labels.with_data(pixels.iter().map(|p| [100 * p.1; 3]).collect());
            let facing = [[0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [0.0; 3]];
            let normals = labels.with_data(pixels.iter().map(|p| facing[p.2]).collect());
            let depth = labels.with_data(pixels.iter().map(|p| if p.3 < 2 { f32::NAN } else { 1.0 }).collect());
            let looks = params::Appearance { color_weight, ..Default::default() };
            let params = params::Grouping { initial_variation };
            let appearance = Appearance::new(&superpixels, Some(&color), &normals, &looks);

            let pixels_of = |s: i32| (0..n).filter(|&i| segments.labels()[i] == s).collect::<Vec<_>>();
            let of: Vec<_> = (0..segments.count() as i32).map(pixels_of).collect();
            let near = |p: usize, q: usize| {
                (p % width).abs_diff(q % width) <= 1 && (p / width).abs_diff(q / width) <= 1
            };
            let measured = |s: usize| 2 * of[s].iter().filter(|&&i| !depth[i].is_nan()).count() > of[s].len();
            let touch = |a: usize, b: usize| of[a].iter().any(|&p| of[b].iter().any(|&q| near(p, q)));
            let mut pairs = Vec::new();
            for b in (0..segments.count()).filter(|&b| measured(b)) {
                for a in (0..b).filter(|&a| measured(a) && touch(a, b)) {
                    pairs.push((appearance.difference(a, b), a, b));
                }
            }
            pairs.sort_by(|x, y| x.partial_cmp(y).unwrap());
            // The first member of a group is its root.
            let mut groups: Vec<(Vec<usize>, f64)> =
                (0..segments.count()).map(|s| (vec![s], initial_variation)).collect();
            for (difference, a, b) in pairs {
                let home = |s: usize| groups.iter().position(|g| g.0.contains(&s)).unwrap();
                let (a, b) = (home(a), home(b));
                if a != b && difference <= groups[a].1 && difference <= groups[b].1 {
                    let (members, variation) = groups[b].clone();
                    groups[a].0.extend(members);
                    groups[a].1 = (groups[a].1 + variation + difference) / 3.0;
                    groups.remove(b);
                }
            }
            groups.sort_by_key(|g| g.0[0]);
            let group = |&s: &i32| groups.iter().position(|g| g.0.contains(&(s as usize))).map_or(-1, |g| g as i32);
            let found = group_superpixels(&superpixels, &appearance, &depth, &params);
            prop_assert_eq!(found.count(), groups.len());
            prop_assert_eq!(found.labels(), &segments.labels().map(group));
        }
    }
}
