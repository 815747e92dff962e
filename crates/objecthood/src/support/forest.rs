//! The support forest of `context`: which thing stands on, lies in or leans on which other, even if the
//! contact is hidden.
//!
//! In the paper, the lower of two shapes in contact is the carrier (eq. 6). Here the place of the contact and the direction of
//! gravity decide: a thing stands on another if its foot touches the other from above.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use glam::Vec3;

use crate::discovery::ids::NodeId;
use crate::discovery::support_graph::{NodeKind, SupportEdge, SupportGraph, SupportKind, SupportNode};
use crate::params;
use crate::shapes::contact::{Nearness, find_touching_pairs};
use crate::support::acyclic::Acyclic;
use crate::support::body::{Bodies, Body, SECTORS};
use crate::support::feet::{Foot, find_feet};
use crate::support::meeting::{Meeting, UNDER_M, find_meetings};
use crate::support::scene::SupportScene;

/// Least number of pairs of points that make a contact: fewer are chance (the 4 touching pixels of docs/CONTEXT.md 4.2 give as many).
const LEAST_CONTACTS: u32 = 8;
/// Least share of the foot's contacts that a carrier has. Also the least share of these contacts behind which the carrier goes on, and
/// the least share of the foot that hangs over an edge.
const LEAST_SHARE: f64 = 0.2;
/// A vessel is seen around a thing inside it in at least this many of the [`SECTORS`]: a far wall alone is seen in half of them.
const LEAST_ENCLOSED: usize = 8;
/// Least cosine between a thing's direction of lean and the direction to the thing that it leans on (60 degrees).
const TOWARD: f64 = 0.5;
/// Confidence of a hidden contact, relative to a visible one.
const HIDDEN: f64 = 0.5;

/// Finds the support relations among the regions of any label map: our own, or the true one. Node k of the
/// graph is region k.
///
/// Two regions meet where points are in contact (`contact`). The foot of a thing is its lowest visible 10 mm.
/// Beyond 1.9 m, where the sensor resolves less, it is the lowest visible quantum. A thing
///
/// * stands *on* another if its foot touches the other from above, level with a top of the other. But a thing
///   does not stand on another that merely stands before it and hides its lower part. So one of these must
///   hold: the lower is a plane, or goes on 3 cm behind the contact, or holds the middle of the upper; or the
///   foot of the upper hangs over an edge. `confidence`: the share of the foot's contacts;
/// * lies *in* another whose rim surrounds it. The outer one is graspable (`objectness.max_side_m`). In at
///   least two thirds of the directions around the middle of the inner one, it rises by 1 cm or by the
///   resolution of the sensor. The rise is measured from the floor seen under the middle, or from the foot if
///   no floor is seen. `confidence`: the share of directions; half of it if the two are not seen to touch
///   (`hidden`);
/// * *leans* on another if its side touches it in the direction of the lean, and the other is no plane that faces up. The leaning
///   thing must be flat, tilted by 8 degrees or more, 7 cm long up its slope and 40 cm² large: thin or small things lean by noise.
///   `confidence`: the share of its tilted pixels that are tilted alike;
/// * otherwise merely touches the other side by side, which gives no edge.
///
/// A thing that then neither stands on nor lies in anything has a hidden contact; it may lean. It is extended
/// along gravity behind its occluder: to the highest thing below that holds its middle, or over which it
/// hangs level with its top; else to the plane there; else to the highest plane below. Or it lies in the
/// thing around it. `confidence`: a half if it is level with its carrier or lies in it; else half the share
/// of its foot below which it is not seen to end, 0 if it floats.
///
/// Edges are added in this order: *on* and *in*, *leans*, hidden contacts. Within each, the surest come
/// first. An edge is left out if its upper already carries its lower, directly or through others, so there
/// are no cycles. P(S) is eq. 7; a plane has the P(S) of its own normal. P(O) is eq. 8 over the edges,
/// without their confidence: the confidence measures the choice of the carrier, and eq. 8 the ability of the
/// carrier to carry. `contact.reach_px` holds at a focal length of 525 px.
///
/// Source: ours, because it replaces eq. 6. O(pixels · `reach_px` + n log n + pairs · cells + edges · (regions + edges)) for n pixels
/// of things, pairs of things, and cells of 1 cm² of the outer thing of a pair; the last term is the search for cycles.
pub fn build_forest(
    scene: &SupportScene<'_>,
    contact: &params::Contact,
    objectness: &params::Objectness,
) -> SupportGraph {
    let &SupportScene { regions, points_m, space, .. } = scene;
    let nearness = Nearness::of_sensor(contact, space);
    let (bodies, touching) =
        rayon::join(|| Bodies::new(scene), || find_touching_pairs(regions, points_m, nearness));
    let (feet, meetings) = rayon::join(
        || find_feet(regions, points_m, &bodies, nearness),
        || find_meetings(&touching, regions, points_m, &bodies),
    );
    let max_side_m = f64::from(objectness.max_side_m);
    let relations = Relations { bodies: &bodies, feet: &feet, meetings: &meetings, max_side_m };

    let mut edges = Acyclic::new(regions.count());
    relations.find_seen().into_iter().for_each(|edge| _ = edges.add(edge));
    for upper in from_above(&bodies, |thing| !edges.is_held(thing)) {
        relations.find_hidden(upper).into_iter().any(|edge| edges.add(edge));
    }
    let p_s = measure_p_s(scene, &bodies);
    let p_o = edges.hand_up(&p_s);
    let nodes = bodies.all.iter().enumerate().map(|(region, body)| SupportNode {
        kind: match region {
            plane if plane < scene.planes.len() => NodeKind::Structure { plane },
            _ => NodeKind::Surface,
        },
        p_s: p_s[region],
        p_o: p_o[region],
        height_m: body.mean_m as f32,
        size_px: body.size_px,
    });
    SupportGraph { nodes: nodes.collect(), edges: edges.into_sorted() }
}

/// The wanted things, the one with the highest foot first.
fn from_above(bodies: &Bodies<'_>, is_wanted: impl Fn(usize) -> bool) -> Vec<usize> {
    let mut things: Vec<usize> = bodies.things().filter(|&thing| is_wanted(thing)).collect();
    things.sort_by(|&a, &b| {
        let [a, b] = [a, b].map(|thing| &bodies.all[thing]);
        b.foot_m.total_cmp(&a.foot_m).then(a.first.cmp(&b.first))
    });
    things
}

/// P(S) of every region (eq. 7): the component of its normal along up.
fn measure_p_s(scene: &SupportScene<'_>, bodies: &Bodies<'_>) -> Vec<f32> {
    let up = Vec3::from(scene.up.direction).as_dvec3();
    let p_s = |(region, body): (usize, &Body)| {
        let plane = scene.planes.get(region);
        let normal = plane.map_or(body.normal, |plane| Vec3::from(plane.normal).as_dvec3());
        // Adding 0 turns a negative zero into zero.
        (normal.dot(up).clamp(0.0, 1.0) + 0.0) as f32
    };
    bodies.all.iter().enumerate().map(p_s).collect()
}

fn node(region: usize) -> NodeId {
    NodeId(region as u32)
}

/// Decides the support relations between the bodies of a scene.
struct Relations<'a> {
    bodies: &'a Bodies<'a>,
    /// One for each region.
    feet: &'a [Foot],
    /// By (lower, upper).
    meetings: &'a BTreeMap<(usize, usize), Meeting>,
    /// The longest side of something graspable (m).
    max_side_m: f64,
}

/// A possible carrier of a thing whose contact is hidden.
struct Carrier {
    region: usize,
    /// Whether the middle or an edge of the upper is over it.
    is_under: bool,
    /// Height at which the upper would stand on it (m).
    height_m: f64,
    kind: SupportKind,
}

impl Relations<'_> {
    /// The edges that are seen, the surest first; ties do not depend on the numbers of regions.
    fn find_seen(&self) -> Vec<SupportEdge> {
        let mut in_contact = vec![0; self.bodies.all.len()];
        self.meetings.iter().for_each(|(&(_, upper), meeting)| in_contact[upper] += meeting.foot);
        let mut seen = self.find_enclosed();
        let within: BTreeSet<(NodeId, NodeId)> = seen.iter().map(|edge| (edge.lower, edge.upper)).collect();
        for (&(lower, upper), meeting) in self.meetings {
            let [a, b] = [node(lower), node(upper)];
            if !within.contains(&(a, b)) && !within.contains(&(b, a)) {
                let on = self.on((lower, upper), meeting, in_contact[upper]);
                seen.extend(on.or_else(|| self.leans((lower, upper), meeting)));
            }
        }
        seen.sort_by_key(|edge| {
            let first = |node: NodeId| self.bodies.all[node.0 as usize].first;
            let leans = edge.kind == SupportKind::Leans;
            (leans, Reverse(edge.confidence.to_bits()), first(edge.upper), first(edge.lower))
        });
        seen
    }

    /// The edges of things that lie in others. O(pairs of things + cells of the outer things that may hold the inner).
    fn find_enclosed(&self) -> Vec<SupportEdge> {
        let things = || self.bodies.things();
        let pairs = things().flat_map(|upper| things().map(move |lower| (lower, upper)));
        pairs.filter(|(lower, upper)| lower != upper).filter_map(|pair| self.within(pair)).collect()
    }

    /// The edge for an upper that lies in the lower, if it does.
    fn within(&self, (lower, upper): (usize, usize)) -> Option<SupportEdge> {
        let (outer, inner) = (&self.bodies.all[lower], &self.bodies.all[upper]);
        let may_hold = outer.foot_m <= inner.foot_m && self.is_cavity(lower, upper);
        if !may_hold {
            return None;
        }
        // The lowest that is seen of a ball on a plate is higher than the plate's rim, so the floor is asked first.
        let floor_m = self.bodies.top_near_m(lower, inner.middle_m).unwrap_or(inner.foot_m);
        let rim_m = floor_m + inner.level_m;
        let sectors = self.bodies.sectors_above(lower, inner.middle_m, rim_m);
        let contacts = self.meetings.get(&(lower, upper)).map_or(0, |meeting| meeting.foot + meeting.side);
        let seen = if contacts == 0 { HIDDEN } else { 1.0 };
        (sectors >= LEAST_ENCLOSED).then(|| SupportEdge {
            kind: SupportKind::In,
            confidence: (seen * sectors as f64 / SECTORS as f64) as f32,
            hidden: contacts == 0,
            ..SupportEdge::seen(node(lower), node(upper), contacts)
        })
    }

    /// Whether the lower may hold the upper. It is graspable, as vessels are; its outline holds the middle of the upper; and no part of it
    /// is seen there above the foot of the upper, else it would be solid.
    fn is_cavity(&self, lower: usize, upper: usize) -> bool {
        let (bodies, body) = (self.bodies, &self.bodies.all[upper]);
        let may_hold = bodies.length_m(lower) <= self.max_side_m && bodies.holds(lower, body.middle_m);
        let floor_m = || bodies.top_near_m(lower, body.middle_m);
        may_hold && floor_m().is_none_or(|floor_m| floor_m <= body.foot_m + body.level_m)
    }

    /// The edge for an upper that stands on the lower, if the meeting shows it. `in_contact`: all contacts of the upper's foot.
    fn on(&self, (lower, upper): (usize, usize), meeting: &Meeting, in_contact: u32) -> Option<SupportEdge> {
        let bodies = self.bodies;
        let is_share = |part: u32, whole: u32| f64::from(part) >= LEAST_SHARE * f64::from(whole);
        let goes_on = || {
            lower < bodies.planes.len()
                || is_share(meeting.under, meeting.on)
                || self.feet[upper].open_share() >= LEAST_SHARE
                || bodies.holds(lower, bodies.all[upper].middle_m)
        };
        let is_on = meeting.on >= LEAST_CONTACTS && is_share(meeting.on, in_contact) && goes_on();
        is_on.then(|| {
            let confidence = (f64::from(meeting.on) / f64::from(in_contact)) as f32;
            SupportEdge { confidence, ..SupportEdge::seen(node(lower), node(upper), meeting.on) }
        })
    }

    /// The edge for an upper that leans on the lower, if the meeting shows it.
    fn leans(&self, (lower, upper): (usize, usize), meeting: &Meeting) -> Option<SupportEdge> {
        if self.bodies.planes.get(lower).is_some_and(|plane| self.bodies.faces_up(plane)) {
            return None;
        }
        let tilt = self.bodies.all[upper].tilt?;
        let way = meeting.side_way_m.try_normalize()?;
        (meeting.side >= LEAST_CONTACTS && way.dot(tilt.toward) > TOWARD).then(|| SupportEdge {
            kind: SupportKind::Leans,
            confidence: tilt.alike as f32,
            ..SupportEdge::seen(node(lower), node(upper), meeting.side)
        })
    }

    /// The edges to the possible carriers of a thing with a hidden contact, the likeliest first: the carriers under it before others, and
    /// among these the highest first.
    fn find_hidden(&self, upper: usize) -> Vec<SupportEdge> {
        let (bodies, body) = (self.bodies, &self.bodies.all[upper]);
        let others = (0..bodies.all.len()).filter(|&lower| lower != upper && bodies.all[lower].size_px > 0);
        let mut carriers: Vec<Carrier> = others.filter_map(|lower| self.carrier(lower, upper)).collect();
        carriers.sort_by(|a, b| {
            let first = |carrier: &Carrier| bodies.all[carrier.region].first;
            let by_height = || b.height_m.total_cmp(&a.height_m);
            b.is_under.cmp(&a.is_under).then_with(by_height).then_with(|| first(a).cmp(&first(b)))
        });
        let edge = |carrier: Carrier| {
            // A thing that is level with its carrier does not float, even if something farther is seen below its foot.
            let is_level = body.foot_m - carrier.height_m <= body.level_m;
            let ended = if is_level { 1.0 } else { 1.0 - self.feet[upper].open_share() };
            SupportEdge {
                kind: carrier.kind,
                confidence: (HIDDEN * ended) as f32,
                hidden: true,
                ..SupportEdge::seen(node(carrier.region), node(upper), 0)
            }
        };
        carriers.into_iter().map(edge).collect()
    }

    /// The lower as a possible carrier of the upper, whose contact is hidden.
    fn carrier(&self, lower: usize, upper: usize) -> Option<Carrier> {
        let (bodies, body, other) = (self.bodies, &self.bodies.all[upper], &self.bodies.all[lower]);
        let holds_middle = bodies.holds(lower, body.middle_m);
        let carrier = |is_under, height_m, kind| Carrier { region: lower, is_under, height_m, kind };
        if let Some(plane) = bodies.planes.get(lower) {
            let height_m = bodies.height_of_m(plane, body.middle_m);
            let is_below = bodies.faces_up(plane) && height_m <= body.foot_m + body.level_m;
            return is_below.then(|| carrier(holds_middle, height_m, SupportKind::On));
        }
        // A thing may also hang over a carrier that does not hold its middle.
        let hangs_over =
            || (other.top_m - body.foot_m).abs() <= body.level_m && bodies.overlap_m(lower, upper) >= UNDER_M;
        if other.top_m <= body.foot_m + body.level_m && (holds_middle || hangs_over()) {
            return Some(carrier(true, other.top_m, SupportKind::On));
        }
        let is_around = other.foot_m < body.foot_m && self.is_cavity(lower, upper);
        is_around.then(|| carrier(true, body.foot_m, SupportKind::In))
    }
}

#[cfg(test)]
mod tests;
