//! Occlusion joins: a surface cut in two by something nearer goes on behind it (METHOD 3.13).

use std::cmp::Reverse;

use glam::DVec3;
use rayon::prelude::*;

use crate::objectness::check::{Bound, Check};
use crate::objectness::clusters::Clusters;
use crate::objectness::history::{Event, Miss, Rule, Source};
use crate::objectness::join::{Continuation, Join, JoinEvidence};
use crate::objectness::spread::{Sample, Spread, Turned};
use crate::params;
use crate::random::Lcg;
use crate::regions::SegmentId;
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::moments::{length, solve};
use crate::union_find::UnionFind;

/// A facet is looked at when it has so many pixels (at a focal length of 525 px) ...
const FACET_PX: usize = 80;
/// ... in small images at least so many (px), because fewer determine no surface ...
const LEAST_FACET_PX: usize = 12;
/// ... and is this share of its cluster.
const FACET_SHARE: f64 = 0.15;
/// Something is in front of a cluster along so many pixel pairs (px at 525 px) before it counts as cut.
const OCCLUDED_PX: usize = 8;
/// Clusters that touch along more pairs (px at 525 px) are neighbours, not parts.
const TOUCH_PX: usize = 6;
/// Facets nearer to each other in the image (px) have no direction between them.
const LEAST_APART_PX: f64 = 3.0;
/// Pixels of a facet that are looked at.
const SAMPLES: usize = 150;
/// Keeps the normal equations solvable, per sample.
const RIDGE: f64 = 1e-6;
/// A facet is curved when its residual falls by this factor with a squared term across the gap: a cylinder that lies along it.
const CURVED_RATIO: f64 = 1.3;
/// Beyond so many times a tolerance nothing else is looked at.
const HOPELESS: f64 = 2.0;
/// The normals by spread and by all samples differ by rounding alone: each by less than a twentieth of this in images 2000 px wide,
/// even of facets one pixel wide (see the tests).
const ROUNDING_DEG: f64 = 0.01;
/// Lines of sight through the gap.
const LINES: usize = 60;
/// What is farther than the surface in the gap by so many quanta is seen through it; nearer by so many, hides it.
const SEEN_THROUGH_QUANTA: f64 = 3.0;
const HIDDEN_QUANTA: f64 = 2.0;
/// The surface may be seen through in less than this share of the gap, and is hidden in more than this share.
const SEEN_THROUGH_SHARE: f64 = 0.15;
const HIDDEN_SHARE: f64 = 0.5;
/// Cosine to the support plane's normal from which a facet is horizontal: tops of equal height are common, so ...
const HORIZONTAL: f64 = 0.92;
/// ... they have to be nearer, by this factor, ...
const HORIZONTAL_DISTANCE: f64 = 0.8;
/// ... and of more alike colour.
const HORIZONTAL_COLOR: f64 = 0.15;
/// Bits of each colour channel in the histograms.
const COLOR_BITS: u32 = 2;

/// Joins clusters of which one facet each continues the other behind something nearer: same surface, same direction, and the gap
/// shows what is nearer, hardly anything that is farther.
///
/// O(F^2 · (samples + pixels of the lines)) for F facets that are large and partly hidden; in parallel over pairs.
pub(crate) fn join_behind_occluders(clusters: &mut Clusters<'_>, params: &params::Occlusion) {
    if !params.enabled {
        return;
    }
    let pieces = pieces(clusters);
    let hopeless_deg = HOPELESS * params.angle_deg + ROUNDING_DEG;
    let hopeless_cosine =
        if hopeless_deg < 180.0 { libm::cos(hopeless_deg.to_radians()) } else { f64::NEG_INFINITY };
    let gap = Gap { clusters, params, hopeless_cosine };
    let looks: Vec<Look> = pieces
        .par_iter()
        .enumerate()
        .flat_map_iter(|(k, a)| pieces[k + 1..].iter().filter_map(|b| gap.compare(a, b)))
        .collect();
    let (mut joins, misses): (Vec<Look>, Vec<Look>) = looks.into_iter().partition(Look::is_join);
    let disagreement = |look: &Look| look.continuation.disagreement_quanta;
    joins.sort_by(|x, y| disagreement(x).total_cmp(&disagreement(y)));
    // As the parts are before the first of them is joined.
    let parts: Vec<_> =
        joins.iter().map(|look| look.clusters.map(|cluster| clusters.part(cluster))).collect();

    let rule = Rule::Occlusion;
    let highest = joins.iter().flat_map(|look| look.clusters).map(|id| id.index() + 1).max();
    let mut sets = UnionFind::new(highest.unwrap_or(0));
    for (Look { clusters: pair, checks, continuation, hider }, parts) in joins.into_iter().zip(parts) {
        let [a, b] = pair.map(|cluster| sets.find(cluster.index()));
        if a != b {
            let (into, from) = (SegmentId(a.min(b) as u32), SegmentId(a.max(b) as u32));
            sets.link(into.index(), from.index());
            let evidence = JoinEvidence::Occlusion(continuation);
            let join = Some((Join { parts, evidence, behind: None }, hider));
            clusters.give(Event { rule, from: Source::Cluster(from), into: Some(into), checks, join });
        }
    }
    clusters.note_misses(misses.into_iter().map(|Look { clusters: [into, from], checks, .. }| Miss {
        rule,
        from: Source::Cluster(from),
        into: Some(into),
        checks,
    }));
}

/// A facet that something may cut.
struct Piece {
    /// Its label.
    facet: SegmentId,
    cluster: SegmentId,
    /// In scan order.
    pixels: Vec<u32>,
    centroid: [f64; 2],
    /// Column, row and disparity of some of them, evenly spaced.
    samples: Vec<Sample>,
    spread: Spread,
    /// Share of its pixels in each cell of colour; empty without colour.
    colors: Vec<f64>,
}

impl Piece {
    /// Overlap of the histograms of colours. Shares add up to 1 but for rounding.
    fn color_overlap(&self, other: &Self) -> f64 {
        let common = |(x, y): (&f64, &f64)| x.min(*y);
        self.colors.iter().zip(&other.colors).map(common).sum::<f64>().min(1.0)
    }
}

/// The large facets of clusters before which something stands.
fn pieces(clusters: &Clusters<'_>) -> Vec<Piece> {
    let scene = clusters.scene;
    let facets = scene.facets;
    let hidden_along = |id: SegmentId| {
        let real = clusters.get(id).neighbours.iter().filter(|(other, _)| other.is_some());
        real.map(|(_, borders)| borders.behind).sum::<u32>()
    };
    let least_px = scene.space.area_px(FACET_PX).max(LEAST_FACET_PX);
    let least_hidden = scene.space.length_px(OCCLUDED_PX) as u32;
    let mut pixels: Vec<Vec<u32>> = vec![Vec::new(); facets.segments.count() - facets.structure];
    for id in clusters.alive().into_iter().filter(|&id| hidden_along(id) >= least_hidden) {
        for &i in &clusters.get(id).pixels {
            // Also patches of the background may be of a cluster.
            let facet =
                facets.segments.at(i as usize).and_then(|facet| facet.index().checked_sub(facets.structure));
            facet.into_iter().for_each(|free| pixels[free].push(i));
        }
    }
    let judge = |(free, pixels): (usize, Vec<u32>)| {
        let cluster = clusters.of_facet(free)?;
        let share = pixels.len() as f64 / clusters.get(cluster).pixels.len() as f64;
        if pixels.len() < least_px || share < FACET_SHARE {
            return None;
        }
        let sum = pixels.iter().fold([0.0; 2], |[x, y], &i| {
            let [u, v] = position(i as usize, scene.disparity.width());
            [x + u, y + v]
        });
        let centroid = sum.map(|sum| sum / pixels.len() as f64);
        let sample = |q: usize| {
            let i = pixels[q * pixels.len() / SAMPLES] as usize;
            (position(i, scene.disparity.width()), f64::from(scene.disparity[i]))
        };
        let samples: Vec<Sample> = (0..SAMPLES).map(sample).collect();
        let spread = Spread::of(&samples);
        let colors = scene.color.map(|color| histogram(&pixels, |i| color[i])).unwrap_or_default();
        let facet = SegmentId((facets.structure + free) as u32);
        Some(Piece { facet, cluster, pixels, centroid, samples, spread, colors })
    };
    pixels.into_iter().enumerate().filter_map(judge).collect()
}

/// The share of pixels in each cell of a coarse RGB histogram.
fn histogram(pixels: &[u32], color: impl Fn(usize) -> [u8; 3]) -> Vec<f64> {
    let mut shares = vec![0.0; 1 << (3 * COLOR_BITS)];
    for &i in pixels {
        let cell = color(i as usize)
            .iter()
            .fold(0, |cell, &c| cell << COLOR_BITS | usize::from(c >> (8 - COLOR_BITS)));
        shares[cell] += 1.0 / pixels.len() as f64;
    }
    shares
}

/// A frame that lies along the gap between two pieces: S from one centroid to the other, T across, in units of their distance.
#[derive(Clone, Copy)]
struct Along {
    middle: [f64; 2],
    /// How S grows in the image (1/px).
    axis: [f64; 2],
    /// Disparities are counted from here.
    origin: f64,
}

impl Along {
    /// From one piece to another, with disparities counted from `origin`; `None` when they are too near for a direction.
    fn between([from, to]: [[f64; 2]; 2], origin: f64) -> Option<Self> {
        let apart = [0, 1].map(|k| to[k] - from[k]);
        let length_px = length(apart);
        (length_px >= LEAST_APART_PX).then(|| Self {
            middle: [0, 1].map(|k| (from[k] + to[k]) / 2.0),
            axis: apart.map(|x| x / (length_px * length_px)),
            origin,
        })
    }

    fn coordinates(&self, at: [f64; 2]) -> [f64; 2] {
        let [x, y] = [0, 1].map(|k| at[k] - self.middle[k]);
        let [along, across] = self.axis;
        [x * along + y * across, y * along - x * across]
    }

    /// Pixels with their disparities in this frame.
    fn take(&self, samples: &[Sample]) -> Vec<Sample> {
        samples.iter().map(|&(at, d)| (self.coordinates(at), d - self.origin)).collect()
    }

    /// The plane through samples that spread like this, but for rounding what [`Surface::fit`] finds from all of them. O(1).
    fn plane(&self, spread: &Spread) -> Surface<3> {
        let Turned { mean: [s, t, d], products: [ss, st, tt, sd, td] } =
            spread.turned(self.middle, self.axis, self.origin);
        let matrix = [[1.0 + RIDGE, s, t], [s, ss + RIDGE, st], [t, st, tt + RIDGE]];
        Surface { weights: solve(matrix, [d, sd, td]) }
    }

    /// Slope of a plane in the image (quanta/px).
    fn slope(&self, plane: &Surface<3>) -> [f64; 2] {
        let ([_, s, t], [along, across]) = (plane.weights, self.axis);
        [s * along - t * across, s * across + t * along]
    }

    /// Normal of a plane, in the middle.
    fn normal(&self, plane: &Surface<3>, space: &DisparitySpace) -> DVec3 {
        space.normal(self.middle, self.origin + plane.weights[0], self.slope(plane))
    }
}

/// Disparity over 1, S, T and T^2, the first K of them.
struct Surface<const K: usize> {
    weights: [f64; K],
}

impl<const K: usize> Surface<K> {
    fn terms([s, t]: [f64; 2]) -> [f64; K] {
        let all = [1.0, s, t, t * t];
        std::array::from_fn(|k| all[k])
    }

    fn fit<'a>(samples: impl Iterator<Item = &'a Sample>) -> Self {
        let (mut matrix, mut right, mut n) = ([[0.0; K]; K], [0.0; K], 0.0);
        for &(at, d) in samples {
            let terms = Self::terms(at);
            for r in 0..K {
                for c in 0..=r {
                    matrix[r][c] += terms[r] * terms[c];
                }
                right[r] += terms[r] * d;
            }
            n += 1.0;
        }
        let whole = std::array::from_fn(|r| {
            let ridge = |c| if r == c { RIDGE * n } else { 0.0 };
            std::array::from_fn(|c| matrix[r.max(c)][r.min(c)] + ridge(c))
        });
        Self { weights: solve(whole, right) }
    }

    fn value(&self, at: [f64; 2]) -> f64 {
        Self::terms(at).iter().zip(&self.weights).map(|(term, weight)| term * weight).sum()
    }

    fn mean_squared_error<'a>(&self, samples: impl Iterator<Item = &'a Sample>) -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        for &(at, d) in samples {
            let residual = d - self.value(at);
            sum += residual * residual;
            n += 1.0;
        }
        sum / n
    }
}

impl Surface<3> {
    /// The same surface with a squared term, of weight 0.
    fn curved(self) -> Surface<4> {
        let [value, along, across] = self.weights;
        Surface { weights: [value, along, across, 0.0] }
    }
}

/// What goes through two pieces.
struct Common {
    surface: Surface<4>,
    /// Of the first piece.
    normal: DVec3,
    /// How far it is from both (quanta), and the angle between them.
    disagreement_quanta: f64,
    angle_deg: f64,
}

/// What lies in the gap between two pieces.
struct Seen {
    hidden: f64,
    through: f64,
    /// The facet that hides most.
    hider: Option<SegmentId>,
}

/// The pixels nearest to the line between two, without its ends: a pixel for each step along the longer side.
struct Line {
    /// Column and row of the last pixel, in units of 2^-32 px, and half a pixel more.
    at: [i64; 2],
    /// From one to the next. Rounded up, so that what lies between two pixels goes to the one behind, as exactly half does.
    step: [i64; 2],
    /// How many pixels are left.
    steps: usize,
}

impl Line {
    fn between([from, to]: [[i64; 2]; 2]) -> Self {
        let reach = [0, 1].map(|k| to[k] - from[k]);
        let steps = reach[0].abs().max(reach[1].abs()).max(1);
        Self {
            at: from.map(|x| (x << 32) + (1 << 31)),
            step: reach.map(|reach| -((-reach << 32).div_euclid(steps))),
            steps: steps as usize - 1,
        }
    }
}

impl Iterator for Line {
    type Item = [usize; 2];

    fn next(&mut self) -> Option<[usize; 2]> {
        self.steps = self.steps.checked_sub(1)?;
        self.at = [0, 1].map(|k| self.at[k] + self.step[k]);
        Some(self.at.map(|x| (x >> 32) as usize))
    }
}

/// What was found out about two pieces of different clusters.
struct Look {
    clusters: [SegmentId; 2],
    checks: Vec<Check>,
    /// How one continues the other.
    continuation: Continuation,
    /// The facet that hides most of what is between them.
    hider: Option<SegmentId>,
}

impl Look {
    fn is_join(&self) -> bool {
        self.checks.iter().all(Check::holds)
    }
}

struct Gap<'a> {
    clusters: &'a Clusters<'a>,
    params: &'a params::Occlusion,
    /// Of an angle that is hopeless even if it is measured with rounding.
    hopeless_cosine: f64,
}

impl Gap<'_> {
    /// How piece `b` continues piece `a`: `None` when they are of one cluster, touch, are too far apart or hopelessly unlike.
    fn compare(&self, a: &Piece, b: &Piece) -> Option<Look> {
        let scene = self.clusters.scene;
        let touch = || self.clusters.borders(a.cluster, b.cluster).touch as usize;
        if a.cluster == b.cluster || touch() > scene.space.length_px(TOUCH_PX) {
            return None;
        }
        let origin = f64::from(scene.disparity[a.pixels[0] as usize]);
        let along = Along::between([a.centroid, b.centroid], origin)?;
        let distance_m = self.distance_m(a, b);
        if distance_m > self.params.max_distance_m {
            return None;
        }
        let color_overlap = scene.color.map(|_| a.color_overlap(b));
        if color_overlap.is_some_and(|overlap| HOPELESS * overlap < self.params.color_overlap) {
            return None;
        }
        let Common { surface, normal, disagreement_quanta, angle_deg } = self.common(a, b, &along)?;
        let Seen { hidden, through, hider } =
            self.look(a, b, |at| along.origin + surface.value(along.coordinates(at)))?;
        let continuation = Continuation {
            disagreement_quanta,
            angle_deg,
            distance_m,
            hidden_share: hidden,
            seen_through_share: through,
            color_overlap,
        };
        let is_horizontal =
            scene.support.is_some_and(|support| normal.dot(support.normal).abs() > HORIZONTAL);
        let checks = self.checks(&continuation, is_horizontal);
        Some(Look { clusters: [a.cluster, b.cluster], checks, continuation, hider })
    }

    /// From the middle of one piece to that of the other.
    fn distance_m(&self, a: &Piece, b: &Piece) -> f64 {
        let scene = self.clusters.scene;
        let [point_a, point_b] = [a, b].map(|piece| {
            let model = &scene.facets.models[piece.facet.index()];
            scene.space.point_m(piece.centroid, model.value(piece.centroid).max(1.0))
        });
        point_a.distance(point_b)
    }

    /// The surface that goes through both pieces; `None` when they are hopelessly unlike.
    fn common(&self, a: &Piece, b: &Piece, along: &Along) -> Option<Common> {
        let space = self.clusters.scene.space;
        // Most are not alike at all, which their spread tells.
        let [rough_a, rough_b] = [a, b].map(|piece| along.normal(&along.plane(&piece.spread), space));
        if rough_a.dot(rough_b) < self.hopeless_cosine {
            return None;
        }
        let [of_a, of_b] = [a, b].map(|piece| along.take(&piece.samples));
        let flat = [&of_a, &of_b].map(|samples| Surface::<3>::fit(samples.iter()));
        let normals = flat.each_ref().map(|surface| along.normal(surface, space));
        let angle_deg = libm::acos(normals[0].dot(normals[1]).clamp(-1.0, 1.0)).to_degrees();
        if angle_deg > HOPELESS * self.params.angle_deg {
            return None;
        }
        let steepness = flat.each_ref().map(|surface| length(along.slope(surface)));
        let noise = space.slope_noise(steepness[0].min(steepness[1]));
        let (surface, disagreement_quanta) = Self::joint(&of_a, &of_b, &flat, noise);
        let is_hopeless = disagreement_quanta > HOPELESS * self.params.disagreement_quanta;
        (!is_hopeless).then_some(Common { surface, normal: normals[0], disagreement_quanta, angle_deg })
    }

    /// What decides whether one piece continues the other.
    fn checks(&self, found: &Continuation, is_horizontal: bool) -> Vec<Check> {
        let &params::Occlusion { max_distance_m, disagreement_quanta, angle_deg, color_overlap, .. } =
            self.params;
        let share = |what, share, bound, limit| Check::new(what, "", share, bound, limit);
        let no_farther = |what, limit_m| {
            Check::new(what, "m", found.distance_m, Bound::AtMost, limit_m).set_by("occlusion.max_distance_m")
        };
        let (disagreement, angle) = (found.disagreement_quanta, found.angle_deg);
        let mut checks = vec![
            no_farther("distance of the parts", max_distance_m),
            Check::new(
                "disagreement of the surfaces",
                "quanta",
                disagreement,
                Bound::Below,
                disagreement_quanta,
            )
            .set_by("occlusion.disagreement_quanta"),
            Check::new("angle between the surfaces", "degrees", angle, Bound::Below, angle_deg)
                .set_by("occlusion.angle_deg"),
            share(
                "share of the gap seen through",
                found.seen_through_share,
                Bound::Below,
                SEEN_THROUGH_SHARE,
            ),
            share("share of the gap that is hidden", found.hidden_share, Bound::Above, HIDDEN_SHARE),
        ];
        checks.extend(found.color_overlap.map(|overlap| {
            share("overlap of their colours", overlap, Bound::Above, color_overlap)
                .set_by("occlusion.color_overlap")
        }));
        if is_horizontal {
            let limit_m = HORIZONTAL_DISTANCE * max_distance_m;
            checks.push(no_farther("distance of the parts, which are level", limit_m));
            checks.extend(found.color_overlap.map(|overlap| {
                let what = "overlap of their colours, as they are level";
                share(what, overlap, Bound::AtLeast, HORIZONTAL_COLOR)
            }));
        }
        checks
    }

    /// The surface of two pieces together, and by how much it fits each of them worse than one of its own (in `noise`, quanta).
    fn joint(of_a: &[Sample], of_b: &[Sample], flat: &[Surface<3>; 2], noise: f64) -> (Surface<4>, f64) {
        let of = [of_a, of_b];
        let both = || of_a.iter().chain(of_b);
        let flat_error = [0, 1].map(|k| flat[k].mean_squared_error(of[k].iter()));
        let curved_error =
            of.map(|samples| Surface::<4>::fit(samples.iter()).mean_squared_error(samples.iter()));
        let is_curved = flat_error
            .iter()
            .zip(&curved_error)
            .all(|(flat, curved)| flat.sqrt() > CURVED_RATIO * curved.sqrt());
        let (joint, single) = if is_curved {
            (Surface::<4>::fit(both()), curved_error)
        } else {
            (Surface::<3>::fit(both()).curved(), flat_error)
        };
        let added = joint.mean_squared_error(both()) - (single[0] + single[1]) / 2.0;
        (joint, added.max(0.0).sqrt() / noise)
    }

    /// What is seen along lines from random pixels of one piece to random pixels of the other, as shares of the measured pixels on
    /// them that are of neither piece; `None` when it is hopelessly much that is seen through, or little that is hidden, whatever
    /// the lines that are left would show.
    fn look(&self, a: &Piece, b: &Piece, surface: impl Fn([f64; 2]) -> f64) -> Option<Seen> {
        let scene = self.clusters.scene;
        let width = scene.disparity.width();
        let (labels, disparity) = (scene.facets.segments.labels().as_slice(), scene.disparity.as_slice());
        let [own_a, own_b] = [a, b].map(|piece| piece.facet.0 as i32);
        let mut random = Lcg::new(777);
        let lines = [(); LINES].map(|()| {
            let ends = [a, b].map(|piece| piece.pixels[random.below(piece.pixels.len())] as usize);
            Line::between(ends.map(|i| [i % width, i / width].map(|x| x as i64)))
        });
        let mut left = lines.iter().map(|line| line.steps).sum::<usize>();
        let (mut through, mut on, mut hidden) = (0_u32, 0_u32, 0_u32);
        let mut before = vec![0_u32; scene.facets.segments.count()];
        for line in lines {
            left -= line.steps;
            for [u, v] in line {
                let i = v * width + u;
                let (label, d) = (labels[i], f64::from(disparity[i]));
                if (label == own_a) | (label == own_b) | d.is_nan() {
                    continue;
                }
                let expected = surface([u as f64, v as f64]);
                if d < expected - SEEN_THROUGH_QUANTA {
                    through += 1;
                    continue;
                }
                let facet = usize::try_from(label).ok();
                let free = facet.and_then(|facet| facet.checked_sub(scene.facets.structure));
                let cluster = || free.and_then(|free| self.clusters.of_facet(free));
                let is_own = || cluster().is_some_and(|cluster| cluster == a.cluster || cluster == b.cluster);
                if d <= expected + HIDDEN_QUANTA || is_own() {
                    on += 1;
                } else {
                    hidden += 1;
                    facet.into_iter().for_each(|facet| before[facet] += 1);
                }
            }
            // Were something nearer seen in all that is left.
            let most = f64::from(through + on + hidden) + left as f64;
            let too_much = f64::from(through) > HOPELESS * SEEN_THROUGH_SHARE * most;
            let too_little = f64::from(through + on) > (1.0 - HIDDEN_SHARE / HOPELESS) * most;
            if too_much || too_little {
                return None;
            }
        }
        let share = |part: u32| f64::from(part) / f64::from((through + on + hidden).max(1));
        // The first of equal ones.
        let hider = before.iter().zip(0..).max_by_key(|&(&count, facet)| (count, Reverse(facet)));
        let hider = hider.filter(|(count, _)| **count > 0).map(|(_, facet)| SegmentId(facet));
        Some(Seen { hidden: share(hidden), through: share(through), hider })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::objectness::testing::{Table, named, single};
    use crate::testing::space;

    /// A plank, facets 1 and 2 at these heights (m), below a bar, facet 3, that cuts it: `bar_m` is the bar's height in a row,
    /// if there is any of it.
    struct Cut {
        plank_m: [f64; 2],
        bar_m: fn(usize) -> Option<f64>,
    }

    const CUT: Cut = Cut { plank_m: [0.05, 0.05], bar_m: |_| Some(0.15) };

    impl Cut {
        fn seen(&self) -> Table {
            Table::new((120, 80), |u, v| {
                let is_plank = (20..100).contains(&u) && (30..50).contains(&v);
                let bar_m = (self.bar_m)(v).filter(|_| (50..65).contains(&u) && (10..70).contains(&v));
                Some(match bar_m {
                    Some(height_m) => (3, height_m),
                    None if is_plank && u < 50 => (1, self.plank_m[0]),
                    None if is_plank && u >= 65 => (2, self.plank_m[1]),
                    None => (0, 0.0),
                })
            })
        }
    }

    /// The clusters of the plank's two parts and of the bar, and the joins of the first, each with its hider.
    struct Joined {
        clusters: Vec<Option<u32>>,
        joins: Vec<(Join, Option<SegmentId>)>,
    }

    fn joined(table: &Table, params: &params::Occlusion) -> Joined {
        let scene = table.scene();
        let mut clusters = single(&scene);
        join_behind_occluders(&mut clusters, params);
        Joined { clusters: named(&clusters), joins: clusters.joins(SegmentId(0)).cloned().collect() }
    }

    const PARTED: [Option<u32>; 3] = [Some(0), Some(1), Some(2)];

    #[test]
    fn a_line_goes_through_the_nearest_pixels() {
        let from = [17_i64, 9];
        for to in (0..40 * 40).map(|k| [k % 40, k / 40]) {
            let reach = [0, 1].map(|k| (to[k] - from[k]) as f64);
            let steps = reach[0].abs().max(reach[1].abs());
            let nearest =
                |t: usize| [0, 1].map(|k| (from[k] as f64 + reach[k] * t as f64 / steps).round() as usize);
            let expected: Vec<_> = (1..steps as usize).map(nearest).collect();
            assert_eq!(Line::between([from, to]).collect::<Vec<_>>(), expected, "to {to:?}");
        }
    }

    proptest! {
        #[test]
        fn the_plane_by_spread_is_that_of_all_samples(
            samples in prop::collection::vec((prop::array::uniform2(0.0_f64..640.0), 100.0_f64..900.0), 3..40),
            axis in prop::array::uniform2(-0.1_f64..0.1),
            middle in prop::array::uniform2(0.0_f64..640.0),
        ) {
            let along = Along { middle, axis, origin: samples[0].1 };
            let expected = Surface::<3>::fit(along.take(&samples).iter());
            let got = along.plane(&Spread::of(&samples));
            for at in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] {
                let (got, expected) = (got.value(at), expected.value(at));
                prop_assert!((got - expected).abs() <= 1e-6 * expected.abs().max(1.0), "{} {}", got, expected);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        /// Also where hardly anything says how a facet is turned: it is one pixel wide, and as near to the other as may be.
        #[test]
        fn normals_by_spread_differ_by_rounding(
            [from, to] in prop::array::uniform2(prop::array::uniform2(0_u16..2000)),
            (value, slope) in (100.0_f64..1000.0, prop::array::uniform2(-0.5_f64..0.5)),
            noise in prop::collection::vec(-1.0_f64..1.0, SAMPLES),
            (turn, length_px) in (0.0_f64..6.3, prop_oneof![Just(LEAST_APART_PX), LEAST_APART_PX..2000.0]),
        ) {
            let longer = [0, 1].map(|k| from[k].abs_diff(to[k])).into_iter().max().unwrap();
            prop_assume!(usize::from(longer) >= LEAST_FACET_PX - 1);
            let sample = |(q, noise): (usize, &f64)| {
                let share = q as f64 / (SAMPLES - 1) as f64;
                let at = [0, 1].map(|k| f64::from(from[k]) * (1.0 - share) + f64::from(to[k]) * share).map(f64::round);
                let off = [0, 1].map(|k| at[k] - f64::from(from[k]));
                (at, f64::from((value + slope[0] * off[0] + slope[1] * off[1] + noise) as f32))
            };
            let samples: Vec<Sample> = noise.iter().enumerate().map(sample).collect();
            let centroid = samples.iter().fold([0.0; 2], |sum, (at, _)| [0, 1].map(|k| sum[k] + at[k] / SAMPLES as f64));
            let other = [centroid[0] + length_px * libm::cos(turn), centroid[1] + length_px * libm::sin(turn)];
            let Some(along) = Along::between([centroid, other], samples[0].1) else { return Ok(()) };
            let space = space([1640.0; 2], [999.5; 2]);
            let by_spread = along.normal(&along.plane(&Spread::of(&samples)), &space);
            let by_samples = along.normal(&Surface::<3>::fit(along.take(&samples).iter()), &space);
            // Both normals of a pair may be off.
            let apart_deg = (by_spread - by_samples).length().to_degrees();
            prop_assert!(apart_deg < ROUNDING_DEG / 20.0, "{} degrees", apart_deg);
        }
    }

    /// It was curved along the gap, where a lying can is straight.
    #[test]
    fn a_curved_surface_is_a_cylinder_along_the_gap() {
        let samples = |bend: fn([f64; 2]) -> f64| -> Vec<([f64; 2], f64)> {
            let grid = (0..100).map(|k| [f64::from(k % 10) / 10.0 - 0.5, f64::from(k / 10) / 10.0 - 0.5]);
            grid.map(|at| (at, 3.0 + 2.0 * at[0] - at[1] + 5.0 * bend(at))).collect()
        };
        let error = |samples: &[([f64; 2], f64)]| {
            Surface::<4>::fit(samples.iter()).mean_squared_error(samples.iter())
        };
        assert!(error(&samples(|[_, t]| t * t)) < 1e-6, "across");
        assert!(error(&samples(|[s, _]| s * s)) > 0.1, "along");
    }

    #[test]
    fn a_plank_goes_on_below_a_bar() {
        let Joined { clusters, joins } = joined(&CUT.seen(), &params::Occlusion::default());
        assert_eq!(clusters, [Some(0), Some(0), Some(2)]);
        let [(join, hider)] = &joins[..] else { panic!("one join: {joins:?}") };
        assert_eq!(*hider, Some(SegmentId(3)));
        assert_eq!(join.parts.map(|part| part.size_px), [600, 700]);
        let JoinEvidence::Occlusion(continuation) = join.evidence else { panic!("{join:?}") };
        assert!(
            continuation.hidden_share == 1.0 && continuation.seen_through_share == 0.0,
            "{continuation:?}"
        );
        // From the middle of the left part, column 34.5, to that of the right one, 82, at 0.95 m.
        assert!((continuation.distance_m - 47.5 * 0.95 / 525.0).abs() < 1e-3, "{continuation:?}");
        assert!(continuation.angle_deg < 0.1 && continuation.color_overlap.is_none(), "{continuation:?}");
    }

    #[test]
    fn parts_on_two_levels_are_two() {
        let cut = Cut { plank_m: [0.05, 0.08], ..CUT };
        assert_eq!(joined(&cut.seen(), &params::Occlusion::default()).clusters, PARTED);
    }

    #[test]
    fn what_is_seen_through_is_no_occluder() {
        // A hole of a third of the plank's width, through which the table shows.
        let cut = Cut { bar_m: |v| (!(36..43).contains(&v)).then_some(0.15), ..CUT };
        assert_eq!(joined(&cut.seen(), &params::Occlusion::default()).clusters, PARTED);
    }

    #[test]
    fn what_is_level_with_the_parts_hides_nothing() {
        // In 11 of the plank's 20 rows the bar is no higher than the plank.
        let cut = Cut { bar_m: |v| Some(if (34..45).contains(&v) { 0.05 } else { 0.15 }), ..CUT };
        assert_eq!(joined(&cut.seen(), &params::Occlusion::default()).clusters, PARTED);
    }

    #[test]
    fn parts_of_other_colour_are_two() {
        let mut table = CUT.seen();
        let painted = |left: [u8; 3], right: [u8; 3]| {
            let pixels = (0..table.disparity.len()).map(|i| if i % 120 < 57 { left } else { right });
            table.disparity.with_data(pixels.collect())
        };
        let [same, other] = [[200, 30, 30], [30, 30, 200]].map(|right| painted([200, 30, 30], right));
        table.color = Some(same);
        let Joined { clusters, joins } = joined(&table, &params::Occlusion::default());
        assert_eq!(clusters, [Some(0), Some(0), Some(2)]);
        let JoinEvidence::Occlusion(continuation) = joins[0].0.evidence else { panic!("{joins:?}") };
        let overlap = continuation.color_overlap.unwrap();
        assert!(overlap <= 1.0 && overlap > 0.999_999, "no share exceeds 1: {overlap}");
        table.color = Some(other);
        assert_eq!(joined(&table, &params::Occlusion::default()).clusters, PARTED);
    }

    #[test]
    fn parameters_part_what_would_be_joined() {
        let table = CUT.seen();
        let default = params::Occlusion::default;
        for params in [
            params::Occlusion { enabled: false, ..default() },
            params::Occlusion { max_distance_m: 0.09, ..default() },
            params::Occlusion { disagreement_quanta: 0.0, ..default() },
        ] {
            assert_eq!(joined(&table, &params).clusters, PARTED, "{params:?}");
        }
    }
}
