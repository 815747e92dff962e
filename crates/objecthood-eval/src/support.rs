//! How right a support graph is: edges against the contacts of a synthetic scene.

mod report;
mod truth;

pub use report::{FAMILIES, SceneSupport, SupportReport};
pub use truth::SupportTruth;

use std::collections::{BTreeMap, BTreeSet};
use std::ops::AddAssign;

use objecthood::Segments;
use objecthood::discovery::{NodeKind, SupportGraph, SupportKind};
use serde::Serialize;

use crate::contingency::{Classes, Contingency};
use crate::error::Result;

/// Things of which fewer pixels are seen do not count: an object has at least as many (`objectness.min_size_px`).
pub const LEAST_SEEN_PX: u32 = 200;

/// Right and wrong edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct EdgeCounts {
    /// Edges that are there and were found, whatever their kind.
    pub right: u32,
    /// Edges that were found and are not there.
    pub wrong: u32,
    /// Edges that are there and were not found.
    pub missed: u32,
    /// Edges that are there, but whose things were not both found; neither right nor missed.
    pub unmatched: u32,
}

/// What became of true edges of a kind that were found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct KindCounts {
    /// True edges of the kind between things that were both found.
    pub there: u32,
    /// Of these found, as *on*.
    pub called_on: u32,
    /// As *in*.
    pub called_in: u32,
    /// As *leans*.
    pub called_leans: u32,
}

/// Things, and how many of them something carries by P(O), which is to be at least `objectness.min_p_o`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RecursionCounts {
    /// All of them.
    pub things: u32,
    /// With such a P(O).
    pub with: u32,
    /// With a plane among their parents whose P(S) is as great: without recursion.
    pub without: u32,
}

/// The figures of one graph, or their sum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SupportScore {
    /// All edges.
    pub edges: EdgeCounts,
    /// True edges *on*.
    pub on: KindCounts,
    /// True edges *in*.
    #[serde(rename = "in")]
    pub within: KindCounts,
    /// True edges *leans*.
    pub leans: KindCounts,
    /// The paper's claim: objects found that stand on or lie in other objects.
    pub recursion: RecursionCounts,
    /// Its control: hypotheses that match no object.
    pub control: RecursionCounts,
}

/// Compares a graph over `regions` with the truth.
///
/// A node is a true object when their intersection over union exceeds 0.5; a structure plane is the furniture or wall that
/// more than half of its pixels show, because furniture has several faces. Edges between others are not judged.
/// `min_p_o`: P(O) of what something carries (`objectness.min_p_o`).
///
/// # Errors
/// When there are too many regions.
pub fn support_score(
    graph: &SupportGraph,
    regions: &Segments,
    truth: &SupportTruth,
    min_p_o: f32,
) -> Result<SupportScore> {
    let matched = matches(graph, regions, truth)?;
    let there = truth.edges();
    let mut found: BTreeMap<(u16, u16), SupportKind> = BTreeMap::new();
    for edge in &graph.edges {
        let named = |node: u32| matched.get(&node).copied();
        if let (Some(lower), Some(upper)) = (named(edge.lower.0), named(edge.upper.0)) {
            found.insert((lower, upper), edge.kind);
        }
    }
    let names: BTreeSet<u16> = matched.values().copied().collect();
    let mut score = SupportScore::default();
    for (pair, kind) in &there {
        if !(names.contains(&pair.0) && names.contains(&pair.1)) {
            score.edges.unmatched += 1;
            continue;
        }
        let counts = match kind {
            SupportKind::On => &mut score.on,
            SupportKind::In => &mut score.within,
            SupportKind::Leans => &mut score.leans,
        };
        counts.there += 1;
        match found.get(pair) {
            Some(SupportKind::On) => counts.called_on += 1,
            Some(SupportKind::In) => counts.called_in += 1,
            Some(SupportKind::Leans) => counts.called_leans += 1,
            None => {}
        }
        *(if found.contains_key(pair) { &mut score.edges.right } else { &mut score.edges.missed }) += 1;
    }
    score.edges.wrong = found.keys().filter(|pair| !there.contains_key(pair)).count() as u32;

    let parents = graph.parents();
    let on_object: BTreeSet<u16> = there
        .iter()
        .filter(|(pair, kind)| truth.objects.contains(&pair.0) && **kind != SupportKind::Leans)
        .map(|(pair, _)| pair.1)
        .collect();
    for (k, node) in graph.nodes.iter().enumerate() {
        let counts = match (node.kind, matched.get(&(k as u32))) {
            (NodeKind::Structure { .. }, _) => continue,
            (_, None) if node.size_px > 0 => &mut score.control,
            (_, Some(thing)) if on_object.contains(thing) => &mut score.recursion,
            _ => continue,
        };
        let planes = parents[k].iter().map(|p| &graph.nodes[p.0 as usize]);
        let planes = planes.filter(|p| matches!(p.kind, NodeKind::Structure { .. }));
        counts.things += 1;
        counts.with += u32::from(node.p_o >= min_p_o);
        counts.without += u32::from(planes.map(|p| p.p_s).fold(0.0, f32::max) >= min_p_o);
    }
    Ok(score)
}

/// The true thing of every node that is one.
fn matches(graph: &SupportGraph, regions: &Segments, truth: &SupportTruth) -> Result<BTreeMap<u32, u16>> {
    let len = truth.instance.len();
    let ours = Classes::of(len, |i| regions.at(i).map(|region| region.0));
    let theirs = Classes::of(len, |i| Some(u32::from(truth.instance[i])).filter(|&instance| instance > 0));
    let common = Contingency::of(&ours, &theirs)?;
    let mut matched = BTreeMap::new();
    for (k, &region) in ours.labels.iter().enumerate() {
        let is_plane =
            graph.nodes.get(region as usize).is_some_and(|n| matches!(n.kind, NodeKind::Structure { .. }));
        for (t, &instance) in theirs.labels.iter().enumerate() {
            let (both, own, other) = (common.row(k)[t], ours.pixels[k], theirs.pixels[t]);
            let is_object = truth.objects.contains(&(instance as u16));
            let whole = if is_plane { own } else { own + other - both };
            if is_plane != is_object && 2 * both > whole && other >= LEAST_SEEN_PX {
                matched.insert(region, instance as u16);
            }
        }
    }
    Ok(matched)
}

impl EdgeCounts {
    /// Share of the edges found that are there; 1 when none was found.
    pub fn precision(&self) -> f64 {
        share(self.right, self.right + self.wrong)
    }

    /// Share of the edges between things that were both found that were found; 1 when there are none.
    pub fn recall(&self) -> f64 {
        share(self.right, self.right + self.missed)
    }

    /// Share of all edges there that were found, also those of things that were not; 1 when there are none.
    pub fn recall_of_all(&self) -> f64 {
        share(self.right, self.right + self.missed + self.unmatched)
    }
}

fn share(part: u32, whole: u32) -> f64 {
    if whole == 0 { 1.0 } else { f64::from(part) / f64::from(whole) }
}

impl AddAssign for SupportScore {
    fn add_assign(&mut self, other: Self) {
        let Self { edges: e, on, within, leans, recursion, control } = other;
        self.edges.right += e.right;
        self.edges.wrong += e.wrong;
        self.edges.missed += e.missed;
        self.edges.unmatched += e.unmatched;
        for (sum, add) in [(&mut self.on, on), (&mut self.within, within), (&mut self.leans, leans)] {
            sum.there += add.there;
            sum.called_on += add.called_on;
            sum.called_in += add.called_in;
            sum.called_leans += add.called_leans;
        }
        for (sum, add) in [(&mut self.recursion, recursion), (&mut self.control, control)] {
            sum.things += add.things;
            sum.with += add.with;
            sum.without += add.without;
        }
    }
}

#[cfg(test)]
mod tests {
    use objecthood::discovery::{NodeId, SupportEdge, SupportNode, Up, UpSource};
    use objecthood::{Raster, SegmentId};
    use objecthood_scene::{Contact, ContactKind};

    use super::*;

    const UP: Up = Up { direction: [0.0, -1.0, 0.0], source: UpSource::Camera };

    fn contact(lower: u16, upper: u16, kind: ContactKind) -> Contact {
        Contact { upper, lower, kind, point_m: [0.0; 3], normal: [0.0, 0.0, 1.0] }
    }

    /// One row a thing of 250 pixels: the table 1, a bowl 2 on it with a ball 3 in it, a box 4 on it with a board 5 against it.
    fn truth() -> SupportTruth {
        let instance = Raster::from_vec(250, 5, (0..1250).map(|i| (i / 250 + 1) as u16).collect()).unwrap();
        use ContactKind::{LeansOn, LiesIn, StandsOn, Touches};
        let contacts = [
            (1, 2, StandsOn),
            (2, 3, LiesIn),
            (1, 4, StandsOn),
            (1, 5, StandsOn),
            (4, 5, LeansOn),
            (2, 4, Touches),
        ];
        SupportTruth {
            surface: instance.clone(),
            instance,
            objects: (2..=5).collect(),
            contacts: contacts.map(|(lower, upper, kind)| contact(lower, upper, kind)).into(),
            up: UP,
        }
    }

    /// Our regions are the true things, in their order; plane 0 is the table.
    fn scored(edges: &[(u32, u32, SupportKind)], label: impl Fn(i32) -> i32) -> SupportScore {
        let truth = truth();
        let regions = Segments::from_labels(&truth.instance.map(|&k| label(i32::from(k) - 1)));
        let node = |k: usize| SupportNode {
            kind: if k == 0 { NodeKind::Structure { plane: 0 } } else { NodeKind::Surface },
            p_s: if k == 0 { 0.9 } else { 0.1 },
            p_o: if k == 0 { 0.0 } else { 0.9 },
            height_m: 0.0,
            size_px: 250,
        };
        let edge = |&(lower, upper, kind): &(u32, u32, SupportKind)| SupportEdge {
            kind,
            ..SupportEdge::seen(NodeId(lower), NodeId(upper), 9)
        };
        let graph = SupportGraph {
            nodes: (0..regions.count()).map(node).collect(),
            edges: edges.iter().map(edge).collect(),
        };
        assert_eq!(regions.at(0), Some(SegmentId(0)));
        support_score(&graph, &regions, &truth, 0.7).unwrap()
    }

    use SupportKind::{In, Leans, On};

    #[test]
    fn what_is_true_is_right_and_what_touches_is_not_asked_for() {
        let all = [(0, 1, On), (1, 2, In), (0, 3, On), (0, 4, On), (3, 4, Leans)];
        let score = scored(&all, |k| k);
        assert_eq!(score.edges, EdgeCounts { right: 5, wrong: 0, missed: 0, unmatched: 0 });
        assert_eq!((score.within.called_in, score.leans.called_leans, score.on.called_on), (1, 1, 3));
        // The ball alone stands on an object; the board leans on one.
        assert_eq!(score.recursion, RecursionCounts { things: 1, with: 1, without: 0 });
        assert_eq!((score.edges.precision(), score.edges.recall()), (1.0, 1.0));
        assert_eq!(score.control, RecursionCounts::default());
    }

    #[test]
    fn edges_are_directed_and_kinds_are_told_apart() {
        // The ball on the bowl and on the table too, the bowl on the box beside it, the box on the board.
        let score = scored(&[(0, 1, On), (1, 2, On), (0, 2, On), (3, 1, On), (4, 3, On)], |k| k);
        assert_eq!(score.edges, EdgeCounts { right: 2, wrong: 3, missed: 3, unmatched: 0 });
        assert_eq!((score.within.there, score.within.called_on, score.within.called_in), (1, 1, 0));
        assert_eq!(score.recursion, RecursionCounts { things: 1, with: 1, without: 1 });
        assert_eq!((score.edges.precision(), score.edges.recall()), (0.4, 0.4));
    }

    #[test]
    fn what_was_not_found_is_not_judged() {
        // Box and board are one region, which is neither by more than half.
        let score = scored(&[(0, 1, On), (1, 2, In), (0, 3, On)], |k| k.min(3));
        assert_eq!(score.edges, EdgeCounts { right: 2, wrong: 0, missed: 0, unmatched: 3 });
        assert_eq!((score.edges.recall(), score.edges.recall_of_all()), (1.0, 0.4));
        // That region is the control: something carries it, and a plane does.
        assert_eq!(score.control, RecursionCounts { things: 1, with: 1, without: 1 });
        let none = scored(&[], |k| if k == 0 { 0 } else { -1 });
        assert_eq!(none.edges, EdgeCounts { unmatched: 5, ..EdgeCounts::default() });
        assert_eq!((none.edges.precision(), none.edges.recall()), (1.0, 1.0));
    }

    #[test]
    fn true_segments_are_faces_first_and_then_objects_of_some_size() {
        let truth = truth();
        let point = |i: usize| [(i % 250) as f32, (i / 250) as f32, (i % 7) as f32];
        let points = Raster::from_vec(250, 5, (0..1250).map(point).collect()).unwrap();
        let (segments, planes) = truth.segments(&points).unwrap();
        assert_eq!((segments.count(), planes.len()), (5, 1));
        assert_eq!([0, 250, 1249].map(|i| segments.at(i)), [0, 1, 4].map(|k| Some(SegmentId(k))));
        // The first row lies at y = 0.
        assert!(planes[0].normal[1].abs() > 0.999, "{planes:?}");
        let small = SupportTruth { instance: truth.instance.map(|&k| k.min(2)), ..truth };
        assert_eq!(small.segments(&points).unwrap().0.count(), 2);
    }
}
