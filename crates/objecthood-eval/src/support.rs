//! How right a support graph is: edges against the contacts of a synthetic scene.

mod report;
mod truth;

pub use report::{FAMILIES, SceneSupport, SupportReport};
pub use truth::SupportTruth;

use std::collections::{BTreeMap, BTreeSet};
use std::ops::AddAssign;

use objecthood::Segments;
use objecthood::objectness::support::{NodeKind, SupportGraph, SupportKind};
use serde::Serialize;

use crate::contingency::{Classes, Contingency};
use crate::error::Result;

/// Things of which fewer pixels are seen do not count: an object has at least as many (`objectness.min_size_px`).
pub const LEAST_SEEN_PX: u32 = 200;
/// P(O) that an object has at least (`objectness.threshold` of the paper).
const CARRIED: f32 = 0.7;

/// Right and wrong edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct EdgeCounts {
    /// Edges that are there and were found, whatever their kind.
    pub right: u32,
    /// Edges that were found and are not there.
    pub wrong: u32,
    /// Edges that are there and were not found.
    pub missed: u32,
    /// Edges that are there, but whose things were not both found.
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

/// Objects that stand on or lie in other objects, and how many of them something carries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RecursionCounts {
    /// Those that were found.
    pub stacked: u32,
    /// With a P(O) of at least 0.7.
    pub with: u32,
    /// With a plane among their parents whose P(S) is at least 0.7: without recursion.
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
    /// The paper's claim.
    pub recursion: RecursionCounts,
}

/// Compares a graph over `regions` with the truth.
///
/// A node is a true object when their intersection over union exceeds 0.5; a structure plane is the furniture or wall that
/// more than half of its pixels show, because furniture has several faces. Edges between others are not judged.
///
/// # Errors
/// When there are too many regions.
pub fn support_score(graph: &SupportGraph, regions: &Segments, truth: &SupportTruth) -> Result<SupportScore> {
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
    for (&node, &upper) in &matched {
        let on_object = |(pair, kind): (&(u16, u16), &SupportKind)| {
            pair.1 == upper && truth.objects.contains(&pair.0) && *kind != SupportKind::Leans
        };
        if there.iter().any(on_object) {
            let planes = parents[node as usize].iter().map(|p| &graph.nodes[p.0 as usize]);
            let planes = planes.filter(|p| matches!(p.kind, NodeKind::Structure { .. }));
            score.recursion.stacked += 1;
            score.recursion.with += u32::from(graph.nodes[node as usize].p_o >= CARRIED);
            score.recursion.without += u32::from(planes.map(|p| p.p_s).fold(0.0, f32::max) >= CARRIED);
        }
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

    /// Share of the edges there that were found; 1 when there are none.
    pub fn recall(&self) -> f64 {
        share(self.right, self.right + self.missed)
    }
}

fn share(part: u32, whole: u32) -> f64 {
    if whole == 0 { 1.0 } else { f64::from(part) / f64::from(whole) }
}

impl AddAssign for SupportScore {
    fn add_assign(&mut self, other: Self) {
        let Self { edges: e, on, within, leans, recursion: r } = other;
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
        self.recursion.stacked += r.stacked;
        self.recursion.with += r.with;
        self.recursion.without += r.without;
    }
}
