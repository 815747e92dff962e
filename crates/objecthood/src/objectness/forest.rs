//! The support forest of `context`: what stands on, lies in or leans on what, also where the contact is hidden.
//!
//! The paper takes the lower one of any two shapes in contact for the carrier (eq. 6). Here the place of the contact and the
//! direction of gravity decide: what stands on something touches it with its foot, from above.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use glam::Vec3;

use crate::objectness::body::{Bodies, Body, SECTORS};
use crate::objectness::feet::{Foot, feet};
use crate::objectness::gravity::{StructurePlane, Up};
use crate::objectness::meeting::{Meeting, UNDER_M, meetings};
use crate::objectness::support::{NodeId, NodeKind, SupportEdge, SupportGraph, SupportKind, SupportNode};
use crate::params::{self, Params};
use crate::raster::Raster;
use crate::regions::Segments;
use crate::shapes::contact::find_touching_pairs;
use crate::surface::disparity::DisparitySpace;

/// Fewer pairs of points in contact are chance (METHOD 3.10: 4 touching pixels, each here in up to four directions).
const LEAST_CONTACTS: u32 = 8;
/// What carries has this share of the contacts of the foot; this share of them is where it goes on below, or of the foot is
/// over the edge.
const LEAST_SHARE: f64 = 0.2;
/// It is seen in so many of [`SECTORS`]: a far wall alone, half of them, encloses nothing.
const LEAST_ENCLOSED: usize = 8;
/// What is leant on is where the upper one leans, up to this angle (cosine, 60 degrees).
const TOWARD: f64 = 0.5;
/// A contact that is not seen is half as sure as one that is.
const HIDDEN: f64 = 0.5;

/// What carries what, of any label map: our own, or the true one.
///
/// `regions`: first the structure, of which region k lies on `planes[k]`, then the things that stand about; all rasters are of one
/// size. Node k of the graph is region k. Two regions meet where points are in contact (`params`). The foot of a thing is
/// the lowest 10 mm of what is seen of it, beyond 1.9 m as much as the sensor resolves. It
///
/// * stands *on* what its foot is level with, from above. So that what merely stands behind something and is hidden by it
///   below does not stand on it: the lower goes on 3 cm behind the contact, or holds the middle of the upper, or the foot hangs
///   over. `confidence`: share of the contacts of the foot;
/// * lies *in* what has a rim around it: is graspable (`objectness.max_side_m`), and rises by 1 cm, far away by what the
///   sensor resolves, above its foot and above the floor seen under its middle, in two of three directions around that.
///   `confidence`: the share of directions, half of it if the two are not seen to touch (`hidden`);
/// * *leans* on what its side touches, in the direction in which it leans, if it is flat, tilted by 8 degrees or more, 7 cm
///   long up its slope and 40 cm² large, and the other is no plane that faces up: what is thin or small leans by chance of
///   noise. `confidence`: the share of what is tilted in it that is tilted alike;
/// * else the two touch side by side, which is no edge.
///
/// What then stands on and lies in nothing has a hidden contact: behind what ends its foot it goes on along gravity, to the
/// highest thing below that holds its middle or that it hangs over level with its top, else to the plane there, else to the
/// highest plane below; or it lies in what is around it. `confidence`: a half, if it is level with that or lies in it; else
/// half the share of its foot that something ends, 0 of what floats.
///
/// Edges are taken in the order *on* and *in*, *leans*, then what stands on and lies in nothing yet, of each the surest
/// first, and each unless the upper already carries the lower, directly or by others: there are no cycles. P(S) is eq. 7, of a
/// plane by its own normal; P(O) is eq. 8 over the edges. Confidence does not weigh in: it says which carrier it is, and eq. 8
/// asks what that could carry. `contact.reach_px` holds at a focal length of 525 px.
///
/// Source: ours, in the place of eq. 6. O(pixels · `reach_px` + n log n + pairs · cells + edges · (regions + edges)): n, the
/// pixels of things; pairs, of things; cells, 1 cm² each, of the outer one of a pair; the last, the search for cycles.
pub fn forest(
    regions: &Segments,
    points_m: &Raster<[f32; 3]>,
    normals: &Raster<[f32; 3]>,
    planes: &[StructurePlane],
    up: &Up,
    space: &DisparitySpace,
    params: &Params,
) -> SupportGraph {
    let contact = params::Contact { reach_px: space.length_px(params.contact.reach_px), ..params.contact };
    let (bodies, touching) = rayon::join(
        || Bodies::new(regions, points_m, normals, planes, up, space),
        || find_touching_pairs(regions, points_m, &contact),
    );
    let (feet, meetings) = rayon::join(
        || feet(regions, points_m, &bodies, &contact),
        || meetings(&touching, regions, points_m, &bodies),
    );
    let max_side_m = f64::from(params.objectness.max_side_m);

    let mut edges = Acyclic::new(regions.count());
    seen(&bodies, &feet, &meetings, max_side_m).into_iter().for_each(|edge| _ = edges.add(edge));
    // From above downwards.
    let mut hanging: Vec<usize> = bodies.things().filter(|&thing| !edges.stands[thing]).collect();
    hanging.sort_by(|&a, &b| {
        let [a, b] = [a, b].map(|thing| &bodies.all[thing]);
        b.foot_m.total_cmp(&a.foot_m).then(a.first.cmp(&b.first))
    });
    for upper in hanging {
        let carriers = below(&bodies, upper, &feet[upper], max_side_m);
        carriers.into_iter().any(|edge| edges.add(edge));
    }

    let up = Vec3::from(up.direction).as_dvec3();
    let p_s = |(region, body): (usize, &Body)| {
        let normal = planes.get(region).map_or(body.normal, |plane| Vec3::from(plane.normal).as_dvec3());
        // The sum takes the sign from a negative zero.
        (normal.dot(up).clamp(0.0, 1.0) + 0.0) as f32
    };
    let p_s: Vec<f32> = bodies.all.iter().enumerate().map(p_s).collect();
    let p_o = edges.handed_up(&p_s);
    let nodes = bodies.all.iter().enumerate().map(|(region, body)| SupportNode {
        kind: if region < planes.len() { NodeKind::Structure { plane: region } } else { NodeKind::Surface },
        p_s: p_s[region],
        p_o: p_o[region],
        height_m: body.mean_m as f32,
        size_px: body.size_px,
    });
    SupportGraph { nodes: nodes.collect(), edges: edges.into_sorted() }
}

fn node(region: usize) -> NodeId {
    NodeId(region as u32)
}

/// The edges that are seen, those to be believed first before the others, by what does not depend on the numbers of regions.
fn seen(
    bodies: &Bodies<'_>,
    feet: &[Foot],
    meetings: &BTreeMap<(usize, usize), Meeting>,
    max_side_m: f64,
) -> Vec<SupportEdge> {
    let mut in_contact = vec![0; bodies.all.len()];
    meetings.iter().for_each(|(&(_, upper), meeting)| in_contact[upper] += meeting.foot);
    let mut seen = enclosed(bodies, meetings, max_side_m);
    let within: BTreeSet<(NodeId, NodeId)> = seen.iter().map(|edge| (edge.lower, edge.upper)).collect();
    for (&(lower, upper), meeting) in meetings {
        let [a, b] = [node(lower), node(upper)];
        if !within.contains(&(a, b)) && !within.contains(&(b, a)) {
            seen.extend(stands(bodies, (lower, upper), meeting, (&feet[upper], in_contact[upper])));
        }
    }
    seen.sort_by_key(|edge| {
        let first = |node: NodeId| bodies.all[node.0 as usize].first;
        let leans = edge.kind == SupportKind::Leans;
        (leans, Reverse(edge.confidence.to_bits()), first(edge.upper), first(edge.lower))
    });
    seen
}

/// What lies in what. O(pairs of things + cells of the outer one of those that may).
fn enclosed(
    bodies: &Bodies<'_>,
    meetings: &BTreeMap<(usize, usize), Meeting>,
    max_side_m: f64,
) -> Vec<SupportEdge> {
    let enclosed = |lower: usize, upper: usize| {
        let (outer, inner) = (&bodies.all[lower], &bodies.all[upper]);
        let may = outer.foot_m <= inner.foot_m && is_cavity(bodies, lower, upper, max_side_m);
        if !may {
            return None;
        }
        // Above its foot, and above the floor around it as far as that is seen.
        let floor_m = bodies.top_near_m(lower, inner.middle_m).unwrap_or(inner.foot_m);
        let rim_m = inner.foot_m.max(floor_m) + inner.level_m;
        let sectors = bodies.sectors_above(lower, inner.middle_m, rim_m);
        let contacts = meetings.get(&(lower, upper)).map_or(0, |meeting| meeting.foot + meeting.side);
        let seen = if contacts == 0 { HIDDEN } else { 1.0 };
        (sectors >= LEAST_ENCLOSED).then(|| SupportEdge {
            kind: SupportKind::In,
            confidence: (seen * sectors as f64 / SECTORS as f64) as f32,
            hidden: contacts == 0,
            ..SupportEdge::seen(node(lower), node(upper), contacts)
        })
    };
    let pairs = bodies.things().flat_map(|upper| bodies.things().map(move |lower| (lower, upper)));
    pairs
        .filter(|(lower, upper)| lower != upper)
        .filter_map(|(lower, upper)| enclosed(lower, upper))
        .collect()
}

/// Whether `upper` is within the outline of `lower`, which is graspable, as a vessel is, and is not seen above the foot of
/// `upper` where that is: else it would be solid there.
fn is_cavity(bodies: &Bodies<'_>, lower: usize, upper: usize, max_side_m: f64) -> bool {
    let body = &bodies.all[upper];
    let may_hold = bodies.length_m(lower) <= max_side_m && bodies.holds(lower, body.middle_m);
    let floor_m = || bodies.top_near_m(lower, body.middle_m);
    may_hold && floor_m().is_none_or(|floor_m| floor_m <= body.foot_m + body.level_m)
}

/// The edge that a meeting shows, if any. With the foot of the upper, and all contacts that it has.
fn stands(
    bodies: &Bodies<'_>,
    (lower, upper): (usize, usize),
    meeting: &Meeting,
    (foot, in_contact): (&Foot, u32),
) -> Option<SupportEdge> {
    let is_share = |part: u32, whole: u32| f64::from(part) >= LEAST_SHARE * f64::from(whole);
    let goes_on = || {
        lower < bodies.planes.len()
            || is_share(meeting.under, meeting.on)
            || foot.open_share() >= LEAST_SHARE
            || bodies.holds(lower, bodies.all[upper].middle_m)
    };
    if meeting.on >= LEAST_CONTACTS && is_share(meeting.on, in_contact) && goes_on() {
        let confidence = (f64::from(meeting.on) / f64::from(in_contact)) as f32;
        return Some(SupportEdge { confidence, ..SupportEdge::seen(node(lower), node(upper), meeting.on) });
    }
    if bodies.planes.get(lower).is_some_and(|plane| bodies.faces_up(plane)) {
        return None;
    }
    let tilt = bodies.all[upper].tilt?;
    let way = meeting.side_way_m.try_normalize()?;
    (meeting.side >= LEAST_CONTACTS && way.dot(tilt.toward) > TOWARD).then(|| SupportEdge {
        kind: SupportKind::Leans,
        confidence: tilt.alike as f32,
        ..SupportEdge::seen(node(lower), node(upper), meeting.side)
    })
}

/// The edges to what may carry something whose contact is hidden, the likeliest first.
fn below(bodies: &Bodies<'_>, upper: usize, foot: &Foot, max_side_m: f64) -> Vec<SupportEdge> {
    let body = &bodies.all[upper];
    // Whether it is over the other, how high it stands there (m), and how.
    let candidate = |lower: usize| {
        let other = &bodies.all[lower];
        let is_over = bodies.holds(lower, body.middle_m);
        if let Some(plane) = bodies.planes.get(lower) {
            let height_m = bodies.height_of_m(plane, body.middle_m);
            let is_below = bodies.faces_up(plane) && height_m <= body.foot_m + body.level_m;
            return is_below.then_some((is_over, height_m, SupportKind::On));
        }
        // What it hangs over does not hold its middle.
        let hangs_over =
            || (other.top_m - body.foot_m).abs() <= body.level_m && bodies.overlap_m(lower, upper) >= UNDER_M;
        if other.top_m <= body.foot_m + body.level_m && (is_over || hangs_over()) {
            return Some((true, other.top_m, SupportKind::On));
        }
        let is_around = other.foot_m < body.foot_m && is_cavity(bodies, lower, upper, max_side_m);
        is_around.then_some((true, body.foot_m, SupportKind::In))
    };
    let others = (0..bodies.all.len()).filter(|&lower| lower != upper && bodies.all[lower].size_px > 0);
    let mut below: Vec<_> = others.filter_map(|lower| Some((candidate(lower)?, lower))).collect();
    below.sort_by(|((over_a, height_a, _), a), ((over_b, height_b, _), b)| {
        let first = |lower: usize| bodies.all[lower].first;
        over_b.cmp(over_a).then(height_b.total_cmp(height_a)).then(first(*a).cmp(&first(*b)))
    });
    let edge = |((_, height_m, kind), lower): ((bool, f64, SupportKind), usize)| {
        // What is as low as it would stand there does not float, whatever is seen below.
        let ended = if body.foot_m - height_m <= body.level_m { 1.0 } else { 1.0 - foot.open_share() };
        SupportEdge {
            kind,
            confidence: (HIDDEN * ended) as f32,
            hidden: true,
            ..SupportEdge::seen(node(lower), node(upper), 0)
        }
    };
    below.into_iter().map(edge).collect()
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

    /// P(O) of every node, eq. 8, carriers before what they carry. O(nodes + edges).
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

#[cfg(test)]
mod tests;
