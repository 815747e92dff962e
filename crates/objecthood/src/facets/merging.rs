//! Facets of `context`: greedy merging under a surface model (METHOD 3.5).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use crate::facets::Facets;
use crate::oversegment::structure::Structure;
use crate::params;
use crate::raster::Raster;
use crate::regions::{RegionGraph, Segments};
use crate::surface::disparity::DisparitySpace;
use crate::surface::moments::{Basis, Fit, Model, Moments};
use crate::union_find::UnionFind;

/// Superpixels are neighbours when so many linked pixel pairs join them (px at a focal length of 525 px).
const LEAST_BORDER_PX: u32 = 2;
/// A region with fewer pixels (at 525 px) has little say: disagreement with it counts less.
const SMALL_PX: usize = 20;
/// Share of the disagreement that a region of no pixels would have.
const LEAST_SAY: f64 = 0.3;
/// Fewer pixels carry no quadratic while regions are merged ...
const QUADRATIC_TRIAL_PX: f64 = 12.0;
/// ... nor, afterwards, in the table of facets.
const QUADRATIC_PX: f64 = 40.0;

/// A region that grows.
struct Region {
    moments: Moments,
    squared_error: f64,
    steepness: f64,
    /// Ascending, all of them alive.
    neighbours: Vec<u32>,
    version: u32,
}

/// A merge on the heap: by cost, then by both regions.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Merge {
    /// The bits of the cost, which are in its order because it is not negative.
    cost: u32,
    a: u32,
    b: u32,
    versions: [u32; 2],
}

/// Merges superpixels to facets, those whose common surface disagrees least with both first.
///
/// Two phases, because quadratics alone would bridge an edge by bending: planes up to `plane_tolerance_quanta`, then
/// quadratics up to `quadratic_tolerance_quanta`, which join the stripes of curved faces. Regions below
/// `min_facet_px` are dropped; the structure comes first, then the facets in the order of the superpixel that stands for
/// each. O(E log E) for E pairs of neighbours, each a solve of 3 or 6 unknowns, as long as no region has very many
/// neighbours: with D of them each of its merges costs D solves. Merges touch no pixel. What does not hang together cannot merge, and
/// is looked at in parallel.
pub fn merge_surfaces(
    superpixels: &Segments,
    structure: &Structure,
    linked_pairs: &RegionGraph<u32>,
    disparity: &Raster<f32>,
    space: &DisparitySpace,
    params: &params::Merging,
) -> Facets {
    let least_border = LEAST_BORDER_PX.max(space.length_px(LEAST_BORDER_PX as usize) as u32);
    let linked = linked_pairs.edges().iter().filter(|e| e.evidence >= least_border);
    let pairs: Vec<[usize; 2]> = linked.map(|e| [e.a.index(), e.b.index()]).collect();
    let costs = Costs { space, small_px: space.area_px(SMALL_PX).max(1) as f64 };
    let mut islands = Islands::new(Moments::of_segments(superpixels, disparity), &pairs);
    islands.all.par_iter_mut().for_each(|island| {
        island.merge(Basis::Plane, params.plane_tolerance_quanta, &costs);
        island.merge(Basis::Quadratic, params.quadratic_tolerance_quanta, &costs);
    });
    islands.into_facets(superpixels, structure, space.area_px(params.min_facet_px))
}

impl Region {
    fn new(moments: Moments) -> Self {
        Self { moments, squared_error: 0.0, steepness: 0.0, neighbours: Vec::new(), version: 0 }
    }
}

/// What decides about merges besides the two regions.
struct Costs<'a> {
    space: &'a DisparitySpace,
    small_px: f64,
}

/// Superpixels that hang together by pairs of neighbours.
struct Island {
    /// Ascending.
    superpixels: Vec<u32>,
    /// The regions that are alive, at the place of the superpixel that stands for each.
    regions: Vec<Option<Region>>,
    sets: UnionFind,
}

/// All superpixels.
struct Islands {
    all: Vec<Island>,
    /// Of each superpixel the island, and its place there.
    places: Vec<[usize; 2]>,
}

impl Islands {
    /// Of superpixels with these moments. `pairs` of neighbours, each once, sorted.
    fn new(moments: Vec<Moments>, pairs: &[[usize; 2]]) -> Self {
        let mut sets = UnionFind::new(moments.len());
        for pair in pairs {
            let [a, b] = pair.map(|s| sets.find(s));
            sets.link(a.min(b), a.max(b));
        }
        let (island_of, count) = sets.groups();
        let mut members: Vec<(Vec<u32>, Vec<Option<Region>>)> =
            (0..count).map(|_| Default::default()).collect();
        let mut places = Vec::with_capacity(moments.len());
        for ((s, moments), island) in (0..).zip(moments).zip(island_of) {
            let (superpixels, regions) = &mut members[island as usize];
            places.push([island as usize, regions.len()]);
            superpixels.push(s);
            regions.push(Some(Region::new(moments)));
        }
        // Sorted, because the pairs are: first those with smaller, then those with greater numbers.
        for &[a, b] in pairs {
            let ([island, a], [_, b]) = (places[a], places[b]);
            for (own, other) in [(a, b), (b, a)] {
                if let Some(region) = &mut members[island].1[own] {
                    region.neighbours.push(other as u32);
                }
            }
        }
        let island = |(superpixels, regions): (Vec<u32>, Vec<_>)| {
            let sets = UnionFind::new(regions.len());
            Island { superpixels, regions, sets }
        };
        Self { all: members.into_iter().map(island).collect(), places }
    }

    fn into_facets(self, superpixels: &Segments, structure: &Structure, min_facet_px: usize) -> Facets {
        let Self { mut all, places } = self;
        let is_large = |r: &&Region| r.moments.count() >= min_facet_px as f64;
        let mut models: Vec<Model> = structure.surfaces.iter().map(|s| s.model).collect();
        let mut facets = models.len() as i32;
        let mut facet_of_root = vec![Segments::NONE; places.len()];
        for (facet, &[island, place]) in facet_of_root.iter_mut().zip(&places) {
            if let Some(region) = all[island].regions[place].as_ref().filter(is_large) {
                *facet = facets;
                facets += 1;
                models.push(fit(&region.moments, Basis::Quadratic, QUADRATIC_PX).model);
            }
        }
        let mut facet = |[island, place]: [usize; 2]| {
            let Island { superpixels, sets, .. } = &mut all[island];
            facet_of_root[superpixels[sets.find(place)] as usize]
        };
        let facet_of: Vec<i32> = places.iter().map(|&place| facet(place)).collect();
        let label = |(&surface, &s): (&i32, &i32)| match (surface, s) {
            (0.., _) => surface,
            (_, 0..) => facet_of[s as usize],
            _ => Segments::NONE,
        };
        let labels = structure.labels.as_slice().par_iter().zip(superpixels.labels().as_slice());
        let labels = structure.labels.with_data(labels.map(label).collect());
        let segments = Segments::from_numbered(labels, models.len());
        Facets { segments, models, structure: structure.surfaces.len() }
    }
}

impl Island {
    fn merge(&mut self, basis: Basis, tolerance: f32, costs: &Costs<'_>) {
        for region in self.regions.iter_mut().flatten() {
            let fit = fit(&region.moments, basis, QUADRATIC_TRIAL_PX);
            region.squared_error = fit.squared_error;
            region.steepness = fit.model.steepness();
            region.version = 0;
        }
        let mut candidates = Vec::new();
        for a in 0..self.regions.len() as u32 {
            let Some(region) = &self.regions[a as usize] else { continue };
            let later = region.neighbours.iter().filter(|&&b| b > a);
            candidates
                .extend(later.filter_map(|&b| self.candidate(a, b, basis, tolerance, costs)).map(Reverse));
        }
        let mut heap = BinaryHeap::from(candidates);
        while let Some(Reverse(Merge { a, b, versions, .. })) = heap.pop() {
            if [a, b].map(|k| self.regions[k as usize].as_ref().map(|r| r.version)) != versions.map(Some) {
                continue;
            }
            self.join(a, b, basis);
            let Some(region) = &self.regions[a as usize] else { continue };
            let candidates = region.neighbours.iter();
            heap.extend(
                candidates.filter_map(|&t| self.candidate(a, t, basis, tolerance, costs)).map(Reverse),
            );
        }
    }

    /// The merge of two living regions, if it costs less than the tolerance.
    fn candidate(&self, a: u32, b: u32, basis: Basis, tolerance: f32, costs: &Costs<'_>) -> Option<Merge> {
        let (a, b) = (a.min(b), a.max(b));
        let (x, y) = (self.regions[a as usize].as_ref()?, self.regions[b as usize].as_ref()?);
        let cost = costs.cost(x, y, basis) as f32;
        (cost < tolerance).then_some(Merge { cost: cost.to_bits(), a, b, versions: [x.version, y.version] })
    }

    /// Merges region `b` into region `a`.
    fn join(&mut self, a: u32, b: u32, basis: Basis) {
        let (Some(mut x), Some(y)) = (self.regions[a as usize].take(), self.regions[b as usize].take())
        else {
            return;
        };
        x.moments = x.moments.merged(&y.moments);
        let fit = fit(&x.moments, basis, QUADRATIC_TRIAL_PX);
        x.squared_error = fit.squared_error;
        x.steepness = fit.model.steepness();
        x.version += 1;
        x.neighbours.extend(y.neighbours.iter().filter(|&&t| t != a));
        x.neighbours.retain(|&t| t != b);
        x.neighbours.sort_unstable();
        x.neighbours.dedup();
        for &t in &y.neighbours {
            if let Some(region) = &mut self.regions[t as usize] {
                region.neighbours.retain(|&k| k != a && k != b);
                let place = region.neighbours.partition_point(|&k| k < a);
                region.neighbours.insert(place, a);
            }
        }
        self.regions[a as usize] = Some(x);
        self.sets.link(a as usize, b as usize);
    }
}

impl Costs<'_> {
    /// The disagreement (quanta) that a common surface adds, per degree of freedom of the smaller region: were the
    /// surface a constant, the offset of one region from the other, whatever their sizes.
    fn cost(&self, x: &Region, y: &Region, basis: Basis) -> f64 {
        let (n, m) = (x.moments.count(), y.moments.count());
        let union = x.moments.fit_with(&y.moments, basis_of(n + m, basis, QUADRATIC_TRIAL_PX));
        let added = (union.squared_error - x.squared_error - y.squared_error).max(0.0);
        let disagreement = (added * (n + m) / (n * m)).sqrt();
        let smaller = n.min(m);
        let say = if smaller < self.small_px {
            LEAST_SAY + (1.0 - LEAST_SAY) * smaller / self.small_px
        } else {
            1.0
        };
        disagreement * say / self.space.slope_noise(x.steepness.min(y.steepness))
    }
}

/// The surface of a region: with fewer than `least_px` pixels a plane.
fn fit(moments: &Moments, basis: Basis, least_px: f64) -> Fit {
    moments.fit(basis_of(moments.count(), basis, least_px))
}

/// What fits the surface of `count` pixels: fewer than `least_px` are a plane.
fn basis_of(count: f64, basis: Basis, least_px: f64) -> Basis {
    if count < least_px { Basis::Plane } else { basis }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;
    use crate::regions::SegmentId;
    use crate::surface::disparity::position;
    use crate::testing::{kinect, raster};

    /// A region of the twin: the superpixels in it and their moments.
    struct Group {
        superpixels: Vec<usize>,
        moments: Moments,
    }

    /// The cost of METHOD 3.5, of two regions with these moments.
    fn cost(a: &Moments, b: &Moments, basis: Basis) -> f32 {
        let fit = |m: &Moments| m.fit(if m.count() < 12.0 { Basis::Plane } else { basis });
        let (one, other, union) = (fit(a), fit(b), fit(&a.merged(b)));
        let added = (union.squared_error - one.squared_error - other.squared_error).max(0.0);
        let (n, m) = (a.count(), b.count());
        let mut cost = (added * (n + m) / (n * m)).sqrt();
        if n.min(m) < 20.0 {
            cost *= 0.3 + (1.0 - 0.3) * n.min(m) / 20.0;
        }
        let sideways = 0.8 * one.model.steepness().min(other.model.steepness());
        (cost / (1.0 + sideways * sideways).sqrt()) as f32
    }

    /// Computes the costs of all pairs, merges the cheapest, and begins anew. Group k stands at the index of its first
    /// superpixel.
    fn naive(
        mut groups: BTreeMap<usize, Group>,
        neighbours: &RegionGraph<u32>,
        params: &params::Merging,
    ) -> BTreeMap<usize, Group> {
        let limits = [params.plane_tolerance_quanta, params.quadratic_tolerance_quanta];
        for (basis, limit) in [Basis::Plane, Basis::Quadratic].into_iter().zip(limits) {
            loop {
                let home =
                    |s: SegmentId| *groups.iter().find(|g| g.1.superpixels.contains(&s.index())).unwrap().0;
                let touching =
                    neighbours.edges().iter().filter(|e| e.evidence >= 2).map(|e| (home(e.a), home(e.b)));
                let mut pairs: Vec<_> = touching
                    .filter(|(a, b)| a != b)
                    .map(|(a, b)| (a.min(b), a.max(b)))
                    .map(|(a, b)| (cost(&groups[&a].moments, &groups[&b].moments, basis), a, b))
                    .filter(|&(cost, ..)| cost < limit)
                    .collect();
                pairs.sort_by(|x, y| x.partial_cmp(y).unwrap());
                let Some(&(_, a, b)) = pairs.first() else { break };
                let from = groups.remove(&b).unwrap();
                let into = groups.get_mut(&a).unwrap();
                into.superpixels.extend(from.superpixels);
                into.moments = into.moments.merged(&from.moments);
            }
        }
        groups
    }

    /// Superpixels of 3 x 3 blocks, some missing and a part of each, on a few surfaces with noise of a quantum.
    fn patchwork() -> impl Strategy<Value = (Segments, Raster<f32>)> {
        (1_usize..7, 1_usize..7).prop_flat_map(|(across, down)| {
            let size = (3 * across, 3 * down);
            let kinds = prop::collection::vec(0_usize..4, across * down);
            (raster(size, prop::bool::weighted(0.9)), raster(size, -0.7_f32..0.7), kinds).prop_map(
                move |(present, noise, kinds)| {
                    let block = |i: usize| i / size.0 / 3 * across + i % size.0 / 3;
                    let is_there = |i: usize| present[i] && kinds[block(i)] < 3;
                    let label = |i: usize| if is_there(i) { block(i) as i32 } else { -1 };
                    let surface = |i: usize| {
                        let [u, v] = position(i, size.0).map(|x| x as f32);
                        [200.0 + 0.5 * u, 203.0 - 0.3 * v, 200.0 + 0.05 * u * u, 0.0][kinds[block(i)]]
                    };
                    let labels = noise.with_data((0..noise.len()).map(label).collect());
                    let disparity =
                        noise.with_data((0..noise.len()).map(|i| surface(i) + noise[i]).collect());
                    (Segments::from_labels(&labels), disparity)
                },
            )
        })
    }

    /// How many pairs of 4-neighbours join any two regions.
    fn adjacency(segments: &Segments) -> RegionGraph<u32> {
        let (width, height) = segments.labels().size();
        let right = (0..width * height).filter(|i| i % width + 1 < width).map(|i| (i, i + 1));
        let down = (0..width * (height - 1)).map(|i| (i, i + width));
        let pairs = right.chain(down).filter_map(|(i, j)| Some((segments.at(i)?, segments.at(j)?)));
        RegionGraph::from_pairs(segments.count(), pairs)
    }

    fn no_structure(like: &Segments) -> Structure {
        Structure { surfaces: Vec::new(), labels: like.labels().map(|_| -1), support: None }
    }

    proptest! {
        #[test]
        fn heap_merging_is_the_naive_one(
            (superpixels, disparity) in patchwork(),
            quadratic_tolerance_quanta in prop::sample::select(vec![0.0_f32, 0.8, 1.5]),
            min_facet_px in 0_usize..30,
        ) {
            let params = params::Merging { quadratic_tolerance_quanta, min_facet_px, ..Default::default() };
            let neighbours = adjacency(&superpixels);
            let structure = no_structure(&superpixels);
            let facets = merge_surfaces(&superpixels, &structure, &neighbours, &disparity, &kinect(), &params);

            let single = |s: usize| {
                let pixels: Vec<u32> = superpixels.members().filter(|m| m.1 == s).map(|m| m.0 as u32).collect();
                (s, Group { superpixels: vec![s], moments: Moments::of(&pixels, &disparity) })
            };
            let mut groups = naive((0..superpixels.count()).map(single).collect(), &neighbours, &params);
            groups.retain(|_, group| group.moments.count() >= min_facet_px as f64);
            let facet_of = |&s: &i32| {
                groups.values().position(|g| g.superpixels.contains(&(s as usize))).map_or(-1, |k| k as i32)
            };
            prop_assert_eq!(facets.segments.labels(), &superpixels.labels().map(facet_of));
            let model = |group: &Group| {
                let few = group.moments.count() < 40.0;
                group.moments.fit(if few { Basis::Plane } else { Basis::Quadratic }).model
            };
            prop_assert_eq!(facets.models, groups.values().map(model).collect::<Vec<_>>());
        }
    }

    /// Facets of a row of 4 x 8 blocks on these surfaces.
    fn merged(surface: impl Fn(f64, f64) -> f64, params: &params::Merging) -> usize {
        let at = |i: usize| position(i, 40);
        let disparity = (0..320).map(|i| surface(at(i)[0], at(i)[1]) as f32).collect();
        let disparity = Raster::from_vec(40, 8, disparity).unwrap();
        let superpixels =
            Segments::from_numbered(disparity.with_data((0..320).map(|i| i % 40 / 4).collect()), 10);
        let structure = no_structure(&superpixels);
        let neighbours = adjacency(&superpixels);
        merge_surfaces(&superpixels, &structure, &neighbours, &disparity, &kinect(), params).segments.count()
    }

    #[test]
    fn a_plane_is_one_facet_and_a_fold_or_a_step_are_two() {
        let params = params::Merging::default();
        assert_eq!(merged(|u, v| 300.0 + 0.5 * u - 0.2 * v, &params), 1);
        assert_eq!(merged(|u, _| 300.0 + 0.6 * (u - 19.5).abs(), &params), 2);
        assert_eq!(merged(|u, _| if u < 20.0 { 300.0 } else { 310.0 }, &params), 2);
        assert_eq!(merged(|u, _| if u < 20.0 { 300.0 } else { 301.0 }, &params), 1, "within the tolerance");
    }

    #[test]
    fn quadratics_join_the_stripes_of_a_curved_face() {
        let curved = |u: f64, _: f64| 300.0 - 0.06 * (u - 19.5).powi(2);
        let planes_only = params::Merging { quadratic_tolerance_quanta: 0.0, ..Default::default() };
        assert!(merged(curved, &planes_only) > 1);
        assert_eq!(merged(curved, &params::Merging::default()), 1);
    }

    #[test]
    fn the_structure_comes_first() {
        let disparity = Raster::from_vec(8, 8, vec![300.0; 64]).unwrap();
        let labels = disparity.with_data((0..64).map(|i| if i < 32 { 0 } else { -1 }).collect());
        let model = Moments::of(&[0, 1, 8], &disparity).fit(Basis::Plane).model;
        let surface = crate::oversegment::structure::StructureSurface {
            model,
            normal: glam::DVec3::NEG_Z,
            offset_m: 1.0,
        };
        let structure = Structure { surfaces: vec![surface], labels: labels.clone(), support: Some(0) };
        let superpixels = Segments::from_numbered(labels.map(|l| -1 - l), 1);
        let neighbours = adjacency(&superpixels);
        let params = params::Merging::default();
        let facets = merge_surfaces(&superpixels, &structure, &neighbours, &disparity, &kinect(), &params);
        assert_eq!((facets.structure, facets.models.len(), facets.models[0]), (1, 2, model));
        assert_eq!(facets.segments.labels(), &labels.map(|l| -l));
    }
}
