//! Facets of `context`: greedy merging under a surface model (docs/CONTEXT.md 2.1).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use crate::facets::facet::Facets;
use crate::oversegment::linked::LinkedSuperpixels;
use crate::oversegment::structure::{Structure, StructureSurface};
use crate::params;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::surface::disparity::DisparitySpace;
use crate::surface::model::{Basis, Fit, Model};
use crate::surface::moments::Moments;
use crate::union_find::UnionFind;

/// Two superpixels are neighbours from this many linked pixel pairs on (px at a focal length of 525 px, never fewer than 2).
const LEAST_BORDER_PX: u32 = 2;
/// A disagreement counts less when the smaller region has fewer pixels than this (px at a focal length of 525 px).
const SMALL_PX: usize = 20;
/// Factor on the disagreement of a region of no pixels; it grows linearly to 1 at `SMALL_PX`.
const LEAST_SAY: f64 = 0.3;
/// While regions are merged, regions with fewer pixels are fitted by a plane.
const QUADRATIC_TRIAL_PX: f64 = 12.0;
/// In the result, facets with fewer pixels have a plane.
const QUADRATIC_PX: f64 = 40.0;

/// A region that grows by merges.
struct Region {
    /// Number of its island: regions that are connected by neighbours form an island.
    island: u32,
    /// The first superpixel of the region; after its merge into another region, the first superpixel of that one.
    superpixel: u32,
    moments: Moments,
    squared_error: f64,
    steepness: f64,
    /// Places of its neighbours in the island, ascending. All of them are alive.
    neighbours: Vec<u32>,
    /// Number of merges of its island when it last changed; `None` after its merge into another region.
    since: Option<u32>,
}

/// A proposed merge on the heap, as one number, so that comparisons need no branch. From the highest bits down: the cost, which is
/// not negative, so its bits sort in the same order; both regions; the number of merges of the island when it was proposed.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Merge(u128);

impl Merge {
    fn new(cost: f32, [a, b]: [u32; 2], when: u32) -> Self {
        Self([cost.to_bits(), a, b, when].into_iter().fold(0, |bits, part| bits << 32 | u128::from(part)))
    }

    fn regions(self) -> [u32; 2] {
        [64, 32].map(|shift| (self.0 >> shift) as u32)
    }

    fn when(self) -> u32 {
        self.0 as u32
    }
}

/// Merges superpixels to facets; the pair with the least disagreement is merged first.
///
/// There are two phases, because quadratics alone would bend across edges. First, regions merge under planes up to
/// `plane_tolerance_quanta`. Then they merge under quadratics up to `quadratic_tolerance_quanta`, which joins the stripes of curved
/// faces. Regions below `min_facet_px` are dropped. The structure comes first, then the facets in the order of their first
/// superpixels.
///
/// O(E log E) for E pairs of neighbours, each a solve of 3 or 6 unknowns, as long as no region has very many neighbours: a merge of
/// a region with D neighbours costs D solves. Merges visit no pixel: they need only the moments of the superpixels. Superpixels
/// that are not linked, directly or through others, cannot merge; groups of linked superpixels are merged in parallel.
pub fn merge_surfaces(
    superpixels: &LinkedSuperpixels,
    structure: &Structure,
    space: &DisparitySpace,
    params: &params::Merging,
) -> Facets {
    let LinkedSuperpixels { segments, linked_pairs, moments } = superpixels;
    let least_border = LEAST_BORDER_PX.max(space.length_px(LEAST_BORDER_PX as usize) as u32);
    let linked = linked_pairs.edges().iter().filter(|e| e.evidence >= least_border);
    let pairs: Vec<[usize; 2]> = linked.map(|e| [e.a.index(), e.b.index()]).collect();
    let costs = Costs { space, small_px: space.area_px(SMALL_PX).max(1) as f64 };
    debug_assert_eq!(moments.len(), segments.count());
    let mut regions = Regions::new(moments, &pairs);
    // One task for each island, because a few islands have nearly all the work.
    regions.islands().into_par_iter().with_max_len(1).for_each(|mut island| {
        island.merge(Basis::Plane, params.plane_tolerance_quanta, &costs);
        island.merge(Basis::Quadratic, params.quadratic_tolerance_quanta, &costs);
    });
    regions.facets(
        segments,
        &structure.surfaces,
        structure.labels.clone(),
        space.area_px(params.min_facet_px),
    )
}

impl Region {
    fn fit(&mut self, basis: Basis) {
        let fit = fit(&self.moments, basis, QUADRATIC_TRIAL_PX);
        self.squared_error = fit.squared_error;
        self.steepness = fit.model.steepness();
    }

    fn add_neighbour(&mut self, k: u32) {
        if let Err(place) = self.neighbours.binary_search(&k) {
            self.neighbours.insert(place, k);
        }
    }

    fn remove_neighbour(&mut self, k: u32) {
        if let Ok(place) = self.neighbours.binary_search(&k) {
            self.neighbours.remove(place);
        }
    }
}

/// The inputs of the cost of a merge besides the two regions.
struct Costs<'a> {
    space: &'a DisparitySpace,
    small_px: f64,
}

/// All regions.
struct Regions {
    /// The regions, island by island.
    all: Vec<Region>,
    /// The place of each superpixel in `all`.
    places: Vec<usize>,
}

/// A group of connected regions.
struct Island<'a> {
    regions: &'a mut [Region],
    /// Number of merges so far.
    merges: u32,
}

impl Regions {
    /// One region for each superpixel. `moments`: of every superpixel. `pairs`: neighbours, each pair once, sorted.
    fn new(moments: &[Moments], pairs: &[[usize; 2]]) -> Self {
        let mut sets = UnionFind::new(moments.len());
        for pair in pairs {
            let [a, b] = pair.map(|s| sets.find(s));
            sets.link(a.min(b), a.max(b));
        }
        let (island_of, islands) = sets.groups();
        let mut order: Vec<usize> = (0..moments.len()).collect();
        order.sort_by_key(|&s| island_of[s]);
        let (mut places, mut firsts) = (vec![0; moments.len()], vec![0; islands]);
        for (place, &s) in order.iter().enumerate().rev() {
            places[s] = place;
            firsts[island_of[s] as usize] = place;
        }
        let region = |&s: &usize| Region {
            island: island_of[s],
            superpixel: s as u32,
            moments: moments[s].clone(),
            squared_error: 0.0,
            steepness: 0.0,
            neighbours: Vec::new(),
            since: Some(0),
        };
        let mut all: Vec<Region> = order.iter().map(region).collect();
        // The neighbours ascend because the pairs are sorted: first come neighbours with smaller, then with greater numbers.
        for &[a, b] in pairs {
            let first = firsts[island_of[a] as usize];
            for (own, other) in [(a, b), (b, a)] {
                all[places[own]].neighbours.push((places[other] - first) as u32);
            }
        }
        Self { all, places }
    }

    /// The islands of at least two regions.
    fn islands(&mut self) -> Vec<Island<'_>> {
        let islands = self.all.chunk_by_mut(|a, b| a.island == b.island);
        islands.filter(|regions| regions.len() > 1).map(|regions| Island { regions, merges: 0 }).collect()
    }

    fn facets(
        self,
        superpixels: &Segments,
        surfaces: &[StructureSurface],
        mut labels: Raster<i32>,
        min_facet_px: usize,
    ) -> Facets {
        let mut models: Vec<Model> = surfaces.iter().map(|s| s.model).collect();
        let mut facet_of: Vec<i32> = Vec::with_capacity(self.places.len());
        for place in self.places {
            let Region { superpixel, moments, since, .. } = &self.all[place];
            facet_of.push(match since {
                // That superpixel has a smaller number, so its facet is known.
                None => facet_of[*superpixel as usize],
                Some(_) if moments.count() < min_facet_px as f64 => Segments::NONE,
                Some(_) => {
                    models.push(fit(moments, Basis::Quadratic, QUADRATIC_PX).model);
                    models.len() as i32 - 1
                }
            });
        }
        // Superpixels lie outside the structure.
        for (run, s) in superpixels.runs() {
            labels.as_mut_slice()[run].fill(facet_of[s]);
        }
        let segments = Segments::from_numbered(labels, models.len());
        Facets { segments, models, structure: surfaces.len(), flats: Vec::new() }
    }
}

impl Island<'_> {
    fn merge(&mut self, basis: Basis, tolerance: f32, costs: &Costs<'_>) {
        let alive = self.regions.iter_mut().filter(|region| region.since.is_some());
        alive.for_each(|region| region.fit(basis));
        let mut candidates = Vec::new();
        for (a, region) in (0..).zip(&*self.regions) {
            let later = region.neighbours.iter().filter(|&&b| b > a);
            candidates
                .extend(later.filter_map(|&b| self.candidate(a, b, basis, tolerance, costs)).map(Reverse));
        }
        let mut heap = BinaryHeap::from(candidates);
        while let Some(Reverse(merge)) = heap.pop() {
            let [a, b] = merge.regions();
            let is_as_then =
                |k: u32| self.regions[k as usize].since.is_some_and(|since| since <= merge.when());
            if is_as_then(a) & is_as_then(b) {
                self.join(a, b, basis);
                let neighbours = self.regions[a as usize].neighbours.iter();
                heap.extend(
                    neighbours.filter_map(|&t| self.candidate(a, t, basis, tolerance, costs)).map(Reverse),
                );
            }
        }
    }

    /// The merge of two regions that are alive, if it costs less than the tolerance.
    fn candidate(&self, a: u32, b: u32, basis: Basis, tolerance: f32, costs: &Costs<'_>) -> Option<Merge> {
        let pair = [a.min(b), a.max(b)];
        let [x, y] = pair.map(|k| &self.regions[k as usize]);
        debug_assert!(x.since.is_some() && y.since.is_some(), "neighbours are alive");
        let cost = costs.cost(x, y, basis) as f32;
        let side_px = costs.space.length_at_525_px(x.moments.count().min(y.moments.count()).sqrt());
        let tolerance = tolerance * costs.space.noise().merge_scale(side_px) as f32;
        (cost < tolerance).then(|| Merge::new(cost, pair, self.merges))
    }

    /// Merges region `b` into region `a`; `a` < `b`.
    fn join(&mut self, a: u32, b: u32, basis: Basis) {
        self.merges += 1;
        let (before, from_b) = self.regions.split_at_mut(b as usize);
        let (x, y) = (&mut before[a as usize], &mut from_b[0]);
        x.moments = x.moments.merged(&y.moments);
        x.fit(basis);
        x.since = Some(self.merges);
        (y.since, y.superpixel) = (None, x.superpixel);
        let mut others = std::mem::take(&mut y.neighbours);
        others.retain(|&t| t != a);
        x.remove_neighbour(b);
        others.iter().for_each(|&t| x.add_neighbour(t));
        for t in others {
            let region = &mut self.regions[t as usize];
            region.remove_neighbour(b);
            region.add_neighbour(a);
        }
    }
}

impl Costs<'_> {
    /// The disagreement of two regions (quanta): the error that a common surface adds, scaled so that for constant surfaces it is the
    /// offset between the regions, whatever their sizes. It is divided by the noise of the gentler slope.
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

/// Fits the surface of a region, a plane if it has fewer than `least_px` pixels.
fn fit(moments: &Moments, basis: Basis, least_px: f64) -> Fit {
    moments.fit(basis_of(moments.count(), basis, least_px))
}

/// The basis for `count` pixels: a plane for fewer than `least_px`.
fn basis_of(count: f64, basis: Basis, least_px: f64) -> Basis {
    if count < least_px { Basis::Plane } else { basis }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;
    use crate::oversegment::structure::Supports;
    use crate::regions::RegionGraph;
    use crate::regions::SegmentId;
    use crate::surface::disparity::position;
    use crate::testing::{kinect, raster};

    /// A region of the reference: its superpixels and their moments.
    struct Group {
        superpixels: Vec<usize>,
        moments: Moments,
    }

    /// The cost of docs/CONTEXT.md 2.1 for two regions with these moments.
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

    /// Computes the costs of all pairs, merges the cheapest, and starts again. A group has the index of its first
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

    /// Superpixels of 3 x 3 blocks on a few surfaces with noise of a quantum. Some blocks, and parts of the others, are missing.
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

    /// Counts the pairs of 4-neighbours between any two regions.
    fn adjacency(segments: &Segments) -> RegionGraph<u32> {
        let (width, height) = segments.labels().size();
        let right = (0..width * height).filter(|i| i % width + 1 < width).map(|i| (i, i + 1));
        let down = (0..width * (height - 1)).map(|i| (i, i + width));
        let pairs = right.chain(down).filter_map(|(i, j)| Some((segments.at(i)?, segments.at(j)?)));
        RegionGraph::from_pairs(segments.count(), pairs)
    }

    fn no_structure(like: &Segments) -> Structure {
        let labels = like.labels().map(|_| -1);
        Structure {
            surfaces: Vec::new(),
            labels,
            skirts: Vec::new(),
            supports: Supports::default(),
            planes: Vec::new(),
        }
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
            let moments = Moments::of_segments(&superpixels, &disparity);
            let linked = LinkedSuperpixels {
                segments: superpixels.clone(),
                linked_pairs: neighbours.clone(),
                moments,
            };
            let facets = merge_surfaces(&linked, &no_structure(&superpixels), &kinect(), &params);

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
        let linked = LinkedSuperpixels {
            linked_pairs: adjacency(&superpixels),
            moments: Moments::of_segments(&superpixels, &disparity),
            segments: superpixels,
        };
        merge_surfaces(&linked, &structure, &kinect(), params).segments.count()
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
            scale: 1.0,
        };
        let superpixels = Segments::from_numbered(labels.map(|l| -1 - l), 1);
        let linked = LinkedSuperpixels {
            linked_pairs: adjacency(&superpixels),
            moments: Moments::of_segments(&superpixels, &disparity),
            segments: superpixels,
        };
        let structure = Structure {
            surfaces: vec![surface],
            labels: labels.clone(),
            skirts: Vec::new(),
            supports: Supports::default(),
            planes: Vec::new(),
        };
        let facets = merge_surfaces(&linked, &structure, &kinect(), &params::Merging::default());
        assert_eq!((facets.structure, facets.models.len(), facets.models[0]), (1, 2, model));
        assert_eq!(facets.segments.labels(), &labels.map(|l| -l));
    }
}
