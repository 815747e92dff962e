//! Facets of `context`: greedy merging under a surface model (METHOD 3.5).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

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

/// An order on the heap: by cost, then by both regions.
#[derive(Clone, Copy, PartialEq)]
struct Merge {
    cost: f32,
    a: u32,
    b: u32,
    versions: [u32; 2],
}

impl Eq for Merge {}

impl Ord for Merge {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let by_regions = || (self.a, self.b, self.versions).cmp(&(other.a, other.b, other.versions));
        self.cost.total_cmp(&other.cost).then_with(by_regions)
    }
}

impl PartialOrd for Merge {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// Merges superpixels to facets, those whose common surface disagrees least with both first.
///
/// Two phases, because quadratics alone would bridge an edge by bending: planes up to `plane_tolerance_quanta`, then
/// quadratics up to `quadratic_tolerance_quanta`, which join the stripes of curved faces. Regions below
/// `min_facet_px` are dropped; the structure comes first, then the facets in the order of the superpixel that stands for
/// each. O(E log E) for E pairs of neighbours, each a solve of 3 or 6 unknowns; no pixel is touched.
pub fn merge_surfaces(
    superpixels: &Segments,
    structure: &Structure,
    linked_pairs: &RegionGraph<u32>,
    disparity: &Raster<f32>,
    space: &DisparitySpace,
    params: &params::Merging,
) -> Facets {
    let mut pixels: Vec<Vec<u32>> = vec![Vec::new(); superpixels.count()];
    superpixels.members().for_each(|(i, s)| pixels[s].push(i as u32));
    let mut forest = Forest {
        regions: pixels.iter().map(|pixels| Some(Region::new(Moments::of(pixels, disparity)))).collect(),
        sets: UnionFind::new(superpixels.count()),
        space,
        small_px: space.area_px(SMALL_PX).max(1) as f64,
    };
    let least_border = LEAST_BORDER_PX.max(space.length_px(LEAST_BORDER_PX as usize) as u32);
    for edge in linked_pairs.edges().iter().filter(|e| e.evidence >= least_border) {
        for (a, b) in [(edge.a, edge.b), (edge.b, edge.a)] {
            if let Some(region) = &mut forest.regions[a.index()] {
                region.neighbours.push(b.0);
            }
        }
    }
    // Sorted, because the edges are: first those with smaller, then those with greater numbers.
    forest.merge(Basis::Plane, params.plane_tolerance_quanta);
    forest.merge(Basis::Quadratic, params.quadratic_tolerance_quanta);
    forest.into_facets(superpixels, structure, space.area_px(params.min_facet_px))
}

impl Region {
    fn new(moments: Moments) -> Self {
        Self { moments, squared_error: 0.0, steepness: 0.0, neighbours: Vec::new(), version: 0 }
    }
}

/// The regions that are alive, at the index of the superpixel that stands for each.
struct Forest<'a> {
    regions: Vec<Option<Region>>,
    sets: UnionFind,
    space: &'a DisparitySpace,
    small_px: f64,
}

impl Forest<'_> {
    fn merge(&mut self, basis: Basis, tolerance: f32) {
        for region in self.regions.iter_mut().flatten() {
            let fit = fit(&region.moments, basis, QUADRATIC_TRIAL_PX);
            region.squared_error = fit.squared_error;
            region.steepness = fit.model.steepness();
            region.version = 0;
        }
        let mut heap = BinaryHeap::new();
        for a in 0..self.regions.len() as u32 {
            let Some(region) = &self.regions[a as usize] else { continue };
            let later = region.neighbours.iter().filter(|&&b| b > a);
            heap.extend(later.filter_map(|&b| self.candidate(a, b, basis, tolerance)).map(Reverse));
        }
        while let Some(Reverse(Merge { a, b, versions, .. })) = heap.pop() {
            if [a, b].map(|k| self.regions[k as usize].as_ref().map(|r| r.version)) != versions.map(Some) {
                continue;
            }
            self.join(a, b, basis);
            let Some(region) = &self.regions[a as usize] else { continue };
            let candidates = region.neighbours.iter();
            heap.extend(candidates.filter_map(|&t| self.candidate(a, t, basis, tolerance)).map(Reverse));
        }
    }

    /// The merge of two living regions, if it costs less than the tolerance.
    fn candidate(&self, a: u32, b: u32, basis: Basis, tolerance: f32) -> Option<Merge> {
        let (a, b) = (a.min(b), a.max(b));
        let (x, y) = (self.regions[a as usize].as_ref()?, self.regions[b as usize].as_ref()?);
        let cost = self.cost(x, y, basis) as f32;
        (cost < tolerance).then_some(Merge { cost, a, b, versions: [x.version, y.version] })
    }

    /// The disagreement (quanta) that a common surface adds, per degree of freedom of the smaller region: were the
    /// surface a constant, the offset of one region from the other, whatever their sizes.
    fn cost(&self, x: &Region, y: &Region, basis: Basis) -> f64 {
        let (n, m) = (x.moments.count(), y.moments.count());
        let union = fit(&x.moments.merged(&y.moments), basis, QUADRATIC_TRIAL_PX);
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

    fn into_facets(mut self, superpixels: &Segments, structure: &Structure, min_facet_px: usize) -> Facets {
        let is_large = |r: &&Region| r.moments.count() >= min_facet_px as f64;
        let mut models: Vec<Model> = structure.surfaces.iter().map(|s| s.model).collect();
        let mut facets = 0;
        let mut facet_of_root = vec![Segments::NONE; self.regions.len()];
        for (root, region) in self.regions.iter().enumerate() {
            if let Some(region) = region.as_ref().filter(is_large) {
                facet_of_root[root] = facets;
                facets += 1;
                models.push(fit(&region.moments, Basis::Quadratic, QUADRATIC_PX).model);
            }
        }
        let label =
            |&s: &i32| usize::try_from(s).map_or(Segments::NONE, |s| facet_of_root[self.sets.find(s)]);
        let labels = superpixels.labels().map(label);
        let facets = Segments::from_numbered(labels, facets as usize);
        Facets { segments: structure.with(&facets), models, structure: structure.surfaces.len() }
    }
}

/// The surface of a region: with fewer than `least_px` pixels a plane.
fn fit(moments: &Moments, basis: Basis, least_px: f64) -> Fit {
    moments.fit(if moments.count() < least_px { Basis::Plane } else { basis })
}
