//! How right a support graph is: edges against the contacts of a synthetic scene.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::AddAssign;

use glam::DQuat;
use objecthood::objectness::forest::forest;
use objecthood::objectness::gravity::{StructurePlane, Up, UpSource, fitted_plane};
use objecthood::objectness::support::{NodeKind, SupportGraph, SupportKind};
use objecthood::{Raster, Segments, params};
use objecthood_scene::{Contact, ContactKind, Rendered, World};
use serde::Serialize;

use crate::contingency::{Classes, Contingency};
use crate::error::Result;

/// Things of which fewer pixels are seen do not count: an object has at least as many (`objectness.min_size_px`).
pub const LEAST_SEEN_PX: u32 = 200;
/// P(O) that an object has at least (`objectness.threshold` of the paper).
const CARRIED: f32 = 0.7;

/// What is true of what stands on what.
#[derive(Clone, Debug)]
pub struct SupportTruth {
    /// The thing at every pixel, 0 = none.
    pub instance: Raster<u16>,
    /// The face at every pixel, each of one thing; 0 = none.
    pub surface: Raster<u16>,
    /// Things that can be grasped; all others are furniture or room.
    pub objects: BTreeSet<u16>,
    /// Who stands on what.
    pub contacts: Vec<Contact>,
    /// The direction against gravity in the camera frame.
    pub up: Up,
}

impl SupportTruth {
    /// Of a synthetic scene and its picture.
    pub fn of(world: &World, seen: &Rendered) -> Self {
        let pose = DQuat::from_array(world.viewpoint().pose.rotation_xyzw());
        let up = pose.inverse() * glam::DVec3::Z;
        Self {
            instance: seen.truth.instance.clone(),
            surface: seen.truth.surface.clone(),
            objects: world.objects().collect(),
            contacts: world.contacts().to_vec(),
            up: Up { direction: up.as_vec3().to_array(), source: UpSource::Camera },
        }
    }

    /// Who carries whom, and how; what merely touches carries nothing.
    fn edges(&self) -> BTreeMap<(u16, u16), SupportKind> {
        let kind = |contact: &Contact| match contact.kind {
            ContactKind::StandsOn => Some(SupportKind::On),
            ContactKind::LiesIn => Some(SupportKind::In),
            ContactKind::LeansOn => Some(SupportKind::Leans),
            _ => None,
        };
        self.contacts.iter().filter_map(|c| Some(((c.lower, c.upper), kind(c)?))).collect()
    }

    /// The true segments: first the faces of furniture and room, then the objects, with the planes that fit the faces.
    /// Those of fewer than [`LEAST_SEEN_PX`] pixels are left out. `points_m`: those of the same picture.
    ///
    /// # Errors
    /// When the picture is empty.
    pub fn segments(&self, points_m: &Raster<[f32; 3]>) -> Result<(Segments, Vec<StructurePlane>)> {
        const OBJECTS: i32 = 1 << 16;
        let label = |i: usize| match self.instance[i] {
            0 => -1,
            instance if self.objects.contains(&instance) => OBJECTS + i32::from(instance),
            _ => i32::from(self.surface[i]),
        };
        let mut points: BTreeMap<i32, Vec<[f32; 3]>> = BTreeMap::new();
        for i in (0..points_m.len()).filter(|&i| label(i) >= 0 && !points_m[i][2].is_nan()) {
            points.entry(label(i)).or_default().push(points_m[i]);
        }
        points.retain(|_, points| points.len() >= LEAST_SEEN_PX as usize);
        let planes = points.range(..OBJECTS).filter_map(|(_, points)| fitted_plane(points)).collect();
        let kept = |i: usize| if points.contains_key(&label(i)) { label(i) } else { -1 };
        let labels = (0..points_m.len()).map(kept).collect();
        let labels = Raster::from_vec(points_m.width(), points_m.height(), labels)?;
        Ok((Segments::from_labels(&labels), planes))
    }

    /// The forest over the true segments, with the true gravity.
    ///
    /// # Errors
    /// When the picture is empty.
    pub fn forest(
        &self,
        points_m: &Raster<[f32; 3]>,
        normals: &Raster<[f32; 3]>,
        contact: &params::Contact,
    ) -> Result<(SupportGraph, Segments)> {
        let (segments, planes) = self.segments(points_m)?;
        let graph = forest(&segments, points_m, normals, &planes, &self.up, contact);
        Ok((graph, segments))
    }
}

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
    /// With a P(S) of at least 0.7 of a plane among their parents: without recursion.
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

pub fn explain(graph: &SupportGraph, regions: &Segments, truth: &SupportTruth) -> Vec<[String; 4]> {
    let matched = matches(graph, regions, truth).unwrap();
    let there = truth.edges();
    let mut out = vec![];
    let mut found = BTreeSet::new();
    for e in &graph.edges {
        if let (Some(&l), Some(&u)) = (matched.get(&e.lower.0), matched.get(&e.upper.0)) {
            found.insert((l, u));
            match there.get(&(l, u)) {
                None => out.push([
                    "WRONG".into(),
                    u.to_string(),
                    l.to_string(),
                    format!("{:?} {:.2} hidden {} contacts {}", e.kind, e.confidence, e.hidden, e.contacts),
                ]),
                Some(k) if *k != e.kind => out.push([
                    "KIND".into(),
                    u.to_string(),
                    l.to_string(),
                    format!(
                        "true {k:?} {:?} {:.2} hidden {} contacts {}",
                        e.kind, e.confidence, e.hidden, e.contacts
                    ),
                ]),
                _ => {}
            }
        }
    }
    let names: BTreeSet<u16> = matched.values().copied().collect();
    for (p, k) in &there {
        if names.contains(&p.0) && names.contains(&p.1) && !found.contains(p) {
            let node = matched.iter().find(|(_, i)| **i == p.1).unwrap().0;
            let have: Vec<_> = graph
                .edges
                .iter()
                .filter(|e| e.upper.0 == *node)
                .map(|e| {
                    format!(
                        "{}:{:?} {:.2}",
                        matched.get(&e.lower.0).map_or("?".into(), |i| i.to_string()),
                        e.kind,
                        e.confidence
                    )
                })
                .collect();
            let lo = matched.iter().find(|(_, i)| **i == p.0).unwrap().0;
            out.push([
                "MISSED".into(),
                p.1.to_string(),
                p.0.to_string(),
                format!("{k:?} has {have:?} nodes u{node} l{lo}"),
            ]);
        }
    }
    out
}
