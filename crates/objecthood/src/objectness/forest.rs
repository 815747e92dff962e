//! The support forest of `context`: what stands on, lies in or leans on what, also where the contact is hidden.
//!
//! The paper takes the lower one of any two shapes in contact for the carrier (eq. 6). Here the place of the contact and the
//! direction of gravity decide: what stands on something touches it with its foot, from above.

use glam::{DVec2, DVec3, Vec3};

use crate::objectness::body::{Body, Plan, Relief, bodies};
use crate::objectness::feet::{Foot, feet};
use crate::objectness::gravity::{StructurePlane, Up};
use crate::objectness::support::{NodeId, NodeKind, SupportEdge, SupportGraph, SupportKind, SupportNode};
use crate::oversegment::structure::UPWARD;
use crate::params;
use crate::raster::Raster;
use crate::regions::{RegionGraph, SegmentId, Segments};
use crate::shapes::contact::touching_pairs;
use crate::shapes::descriptor::descriptors;

/// Heights that differ by less (m) are the same: what stands less high than this above its surroundings is not told from
/// them either (`height.min_top_m`).
const LEVEL_M: f64 = 0.01;
/// Fewer pairs of points in contact are chance (METHOD 3.10: 4 touching pixels, each here in up to four directions).
const LEAST_CONTACTS: u32 = 8;
/// A rim is at least this much (m) above the foot of what lies within: three times the noise of a height at 1 m.
const LEAST_RIM_M: f64 = 0.005;
/// So many sectors are looked at around what may lie in something ...
const SECTORS: usize = 12;
/// ... and the rim is seen in this share of them: a far wall alone encloses nothing.
const LEAST_ENCLOSED: f64 = 0.75;
/// What is leant on is where the upper one leans, up to this angle (cosine, 60 degrees).
const TOWARD: f64 = 0.5;
/// A contact that is not seen is half as sure as one that is.
const HIDDEN: f64 = 0.5;

/// How two regions touch, from both sides: [0] = the one with the smaller number upon the other, [1] = the reverse.
#[derive(Clone, Copy, Debug, Default)]
struct Meeting {
    /// Pairs in which the foot of the upper is on a top of the lower.
    foot: [u32; 2],
    /// Pairs in which the upper is above its foot.
    side: [u32; 2],
    /// Sum of the ways from the middle of the upper to the lower where it is above its foot (m).
    side_way_m: [DVec2; 2],
}

/// What carries what, of any label map: our own, or the true one.
///
/// `regions`: first the structure, of which region k lies on `planes[k]`, then whatever stands about; node k of the graph is
/// region k. For two regions in contact (`params`):
///
/// * *on*: pairs of points at the foot of the upper (the lowest 10 mm of what is seen of it) that are level with the
///   lower, where the lower is not higher. Its confidence is the share of the visible foot, walked along gravity, that meets it;
/// * *in*: the foot is below the lower's rim, which is seen in three of four directions around it; its
///   confidence is that share;
/// * *leans*: a flat thing that is tilted by 8 degrees or more touches the other with its side, in the direction in which
///   it leans. Its confidence is the share of its sides that are tilted alike;
/// * else they touch side by side, which is no edge.
///
/// What has no edge *on* or *in* yet must have a hidden one: it goes on along gravity behind what hides its foot, to the
/// highest thing below it within whose outline it is, else to the plane there. Its confidence is half the share of
/// its foot that is hidden: what floats has none.
///
/// Edges are taken in the order of seen before hidden, then of falling confidence, each unless what it carries already carries its
/// carrier: so there are no cycles. Planes stand on nothing. P(S) is eq. 7, of a plane by its own normal; P(O) is eq. 8 over
/// these edges. Confidence does not weigh in: it says which carrier it is, and eq. 8 asks what any carrier can carry.
///
/// Source: ours, after eq. 6 of the paper. O(pixels log pixels + regions^2).
pub fn forest(
    regions: &Segments,
    points_m: &Raster<[f32; 3]>,
    normals: &Raster<[f32; 3]>,
    planes: &[StructurePlane],
    up: &Up,
    params: &params::Contact,
) -> SupportGraph {
    let plan = Plan::new(up);
    let scene = Scene {
        bodies: bodies(regions, points_m, normals, &plan),
        relief: Relief::new(regions, points_m, &plan, planes.len()),
        planes,
        plan,
    };
    let feet = feet(regions, points_m, &scene.bodies, &scene.plan, (planes.len(), LEVEL_M), params);

    let mut found = scene.seen(regions, points_m, &feet, params);
    found.sort_by(|a, b| {
        let key = |e: &SupportEdge| {
            let first = |node: NodeId| scene.bodies[node.0 as usize].first;
            (first(e.upper), first(e.lower), e.kind)
        };
        b.confidence.total_cmp(&a.confidence).then_with(|| key(a).cmp(&key(b)))
    });
    let mut edges = Acyclic::new(regions.count());
    found.into_iter().for_each(|edge| {
        edges.add(edge);
    });
    // Downwards: what is hidden behind something lower may be carried by that.
    let mut hanging: Vec<usize> = (planes.len()..regions.count())
        .filter(|&r| scene.bodies[r].size_px > 0 && !edges.stands(r))
        .collect();
    hanging.sort_by(|&a, &b| {
        let key = |r: usize| (scene.bodies[r].foot_m, scene.bodies[r].first);
        key(b).partial_cmp(&key(a)).unwrap_or(std::cmp::Ordering::Equal)
    });
    for upper in hanging {
        let confidence = (HIDDEN * feet[upper].hidden_share()) as f32;
        let below = scene.below(upper);
        below.into_iter().find(|&lower| {
            edges.add(SupportEdge {
                lower: node(lower),
                upper: node(upper),
                kind: SupportKind::On,
                confidence,
                hidden: true,
                contacts: 0,
            })
        });
    }

    let described = descriptors(regions, &regions.labels().map(|_| true), points_m, normals);
    let p_s = |region: usize| {
        let normal = planes
            .get(region)
            .map_or(DVec3::from(described[region].normal), |plane| Vec3::from(plane.normal).as_dvec3());
        // The sum takes the sign from a negative zero.
        normal.dot(Vec3::from(up.direction).as_dvec3()).clamp(0.0, 1.0) + 0.0
    };
    let p_s: Vec<f32> = (0..regions.count()).map(|region| p_s(region) as f32).collect();
    let p_o = edges.handed_up(&p_s);
    let nodes = (0..regions.count()).map(|region| SupportNode {
        kind: if region < planes.len() { NodeKind::Structure { plane: region } } else { NodeKind::Surface },
        p_s: p_s[region],
        p_o: p_o[region],
        height_m: scene.bodies[region].mean_m as f32,
        size_px: scene.bodies[region].size_px,
    });
    SupportGraph { nodes: nodes.collect(), edges: edges.into_sorted() }
}

fn node(region: usize) -> NodeId {
    NodeId(region as u32)
}

/// What the edges are read from.
struct Scene<'a> {
    plan: Plan,
    bodies: Vec<Body>,
    relief: Relief,
    planes: &'a [StructurePlane],
}

impl Scene<'_> {
    /// The edges that can be seen.
    fn seen(
        &self,
        regions: &Segments,
        points_m: &Raster<[f32; 3]>,
        feet: &[Foot],
        params: &params::Contact,
    ) -> Vec<SupportEdge> {
        let meetings = self.meetings(regions, points_m, params);
        let mut found = Vec::new();
        for edge in meetings.edges() {
            let [a, b] = [edge.a.index(), edge.b.index()];
            for (order, upper, lower) in [(0, a, b), (1, b, a)] {
                found.extend(self.carried(upper, lower, order, &edge.evidence, &feet[upper]));
            }
        }
        for upper in self.planes.len()..self.bodies.len() {
            for lower in (self.planes.len()..self.bodies.len()).filter(|&lower| lower != upper) {
                if let Some(enclosed) = self.enclosed(upper, lower) {
                    found.retain(|e| {
                        [e.lower, e.upper] != [node(lower), node(upper)]
                            && [e.lower, e.upper] != [node(upper), node(lower)]
                    });
                    found.push(SupportEdge {
                        lower: node(lower),
                        upper: node(upper),
                        kind: SupportKind::In,
                        confidence: enclosed as f32,
                        hidden: false,
                        contacts: 0,
                    });
                }
            }
        }
        found
    }

    /// How regions touch.
    fn meetings(
        &self,
        regions: &Segments,
        points_m: &Raster<[f32; 3]>,
        params: &params::Contact,
    ) -> RegionGraph<Meeting> {
        let pairs = touching_pairs(regions, points_m, params)
            .filter_map(|(p, q)| Some((regions.at(p)?, regions.at(q)?, [p, q])))
            .map(|(a, b, [p, q])| if a < b { (a, b, [p, q]) } else { (b, a, [q, p]) });
        let located = pairs.map(|(a, b, pixels)| (a, b, (a, b, pixels)));
        RegionGraph::gather(
            regions.count(),
            located,
            |sum: &mut Meeting, (a, b, pixels): (SegmentId, SegmentId, [usize; 2])| {
                let [at_a, at_b] = pixels.map(|i| points_m[i]);
                for (order, (upper, lower), (p, q)) in
                    [(0, (a.index(), b.index()), (at_a, at_b)), (1, (b.index(), a.index()), (at_b, at_a))]
                {
                    if upper < self.planes.len() {
                        continue;
                    }
                    let (height_m, below_m) = (self.plan.height_m(p), self.plan.height_m(q));
                    if height_m > self.bodies[upper].foot_m + LEVEL_M {
                        sum.side[order] += 1;
                        sum.side_way_m[order] += self.plan.place_m(q) - self.bodies[upper].middle_m;
                    } else if (height_m - below_m).abs() <= LEVEL_M && self.is_top(lower, q, height_m) {
                        sum.foot[order] += 1;
                    }
                }
            },
        )
    }

    /// Whether a region ends upwards at this height, where it is at `point_m`.
    fn is_top(&self, region: usize, point_m: [f32; 3], height_m: f64) -> bool {
        match self.planes.get(region) {
            Some(plane) => self.faces_up(plane),
            None => {
                let top_m = self.relief.top_near_m(region, self.plan.place_m(point_m));
                top_m.is_none_or(|top_m| top_m <= height_m + LEVEL_M)
            }
        }
    }

    fn faces_up(&self, plane: &StructurePlane) -> bool {
        self.plan.upward(plane.normal) > UPWARD
    }

    /// The edge that a meeting shows, if any.
    fn carried(
        &self,
        upper: usize,
        lower: usize,
        order: usize,
        meeting: &Meeting,
        foot: &Foot,
    ) -> Option<SupportEdge> {
        let (on, side) = (meeting.foot[order], meeting.side[order]);
        let seen = SupportEdge::seen(node(lower), node(upper), on);
        if on >= LEAST_CONTACTS {
            return Some(SupportEdge { confidence: foot.share_on(lower) as f32, ..seen });
        }
        let tilt = self.bodies[upper].tilt?;
        let way = meeting.side_way_m[order].try_normalize()?;
        let leans = side >= LEAST_CONTACTS && way.dot(tilt.toward) > TOWARD;
        leans.then_some(SupportEdge {
            kind: SupportKind::Leans,
            confidence: tilt.alike as f32,
            contacts: side,
            ..seen
        })
    }

    /// The share of directions in which the rim of `lower` is seen around `upper`, if it lies in it.
    fn enclosed(&self, upper: usize, lower: usize) -> Option<f64> {
        let (inner, outer) = (&self.bodies[upper], &self.bodies[lower]);
        let rim_m = inner.foot_m + LEAST_RIM_M;
        if inner.size_px == 0
            || outer.top_m < rim_m
            || outer.foot_m > inner.foot_m
            || !outer.contains(inner.middle_m, 0.0)
        {
            return None;
        }
        let mut seen = [false; SECTORS];
        for (place_m, _) in self.relief.of(lower).filter(|&(_, height_m)| height_m > rim_m) {
            let way = place_m - inner.middle_m;
            let turn = libm::atan2(way.y, way.x) / std::f64::consts::TAU + 0.5;
            seen[((turn * SECTORS as f64) as usize).min(SECTORS - 1)] = true;
        }
        let share = seen.iter().filter(|&&seen| seen).count() as f64 / SECTORS as f64;
        (share >= LEAST_ENCLOSED).then_some(share)
    }

    /// What may carry something whose contact is hidden, the likeliest first: the highest thing below within whose outline it
    /// is, then the plane there, then the highest plane below at all.
    fn below(&self, upper: usize) -> Vec<usize> {
        let body = &self.bodies[upper];
        let mut below: Vec<(bool, f64, usize)> = Vec::new();
        for (lower, other) in
            self.bodies.iter().enumerate().filter(|&(lower, other)| lower != upper && other.size_px > 0)
        {
            let is_within = other.contains(body.middle_m, 0.0);
            let top_m = match self.planes.get(lower) {
                Some(plane) if self.faces_up(plane) => self.height_of(plane, body.middle_m),
                Some(_) => continue,
                None if is_within => other.top_m,
                None => continue,
            };
            if top_m <= body.foot_m + LEVEL_M {
                below.push((is_within, top_m, lower));
            }
        }
        below.sort_by(|a, b| {
            let rest = |&(_, _, lower): &(bool, f64, usize)| self.bodies[lower].first;
            (b.0, b.1)
                .partial_cmp(&(a.0, a.1))
                .unwrap_or(std::cmp::Ordering::Equal)
                .then(rest(a).cmp(&rest(b)))
        });
        below.into_iter().map(|(.., lower)| lower).collect()
    }

    /// Height of a plane at a place (m).
    fn height_of(&self, plane: &StructurePlane, place_m: DVec2) -> f64 {
        let normal = Vec3::from(plane.normal).as_dvec3();
        let at_zero = self.plan.point_m(place_m, 0.0);
        -(normal.dot(at_zero) + f64::from(plane.offset_m)) / self.plan.upward(plane.normal)
    }
}

/// Edges without cycles.
struct Acyclic {
    edges: Vec<SupportEdge>,
    /// What each node carries.
    carries: Vec<Vec<usize>>,
    /// Whether each stands on or lies in something.
    stands: Vec<bool>,
}

impl Acyclic {
    fn new(nodes: usize) -> Self {
        Self { edges: Vec::new(), carries: vec![Vec::new(); nodes], stands: vec![false; nodes] }
    }

    /// Whether a node stands on or lies in something.
    fn stands(&self, node: usize) -> bool {
        self.stands[node]
    }

    /// Adds an edge unless it closes a cycle; whether it did. O(nodes + edges).
    fn add(&mut self, edge: SupportEdge) -> bool {
        let (lower, upper) = (edge.lower.0 as usize, edge.upper.0 as usize);
        let mut open = vec![upper];
        let mut is_seen = vec![false; self.carries.len()];
        while let Some(node) = open.pop() {
            if node == lower {
                return false;
            }
            if !std::mem::replace(&mut is_seen[node], true) {
                open.extend(&self.carries[node]);
            }
        }
        self.stands[upper] |= edge.kind != SupportKind::Leans;
        self.carries[lower].push(upper);
        self.edges.push(edge);
        true
    }

    /// P(O) of every node, eq. 8. O(nodes + edges).
    fn handed_up(&self, p_s: &[f32]) -> Vec<f32> {
        let mut carriers = vec![0_usize; p_s.len()];
        self.carries.iter().flatten().for_each(|&upper| carriers[upper] += 1);
        let mut ready: Vec<usize> = (0..p_s.len()).filter(|&node| carriers[node] == 0).collect();
        let mut p_o = vec![0.0_f32; p_s.len()];
        while let Some(lower) = ready.pop() {
            for &upper in &self.carries[lower] {
                p_o[upper] = p_o[upper].max(p_s[lower]).max(p_o[lower]);
                carriers[upper] -= 1;
                if carriers[upper] == 0 {
                    ready.push(upper);
                }
            }
        }
        p_o
    }

    fn into_sorted(mut self) -> Vec<SupportEdge> {
        self.edges.sort_by_key(|e| (e.lower, e.upper));
        self.edges
    }
}
