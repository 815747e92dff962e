//! The support forest on many synthetic scenes.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::AddAssign;

use objecthood::discovery::SupportGraph;
use objecthood::params::UpFrom;
use objecthood::surface::disparity::DisparitySpace;
use objecthood::{Observer, Output, Params, Raster, Segments, discover_observed};
use objecthood_scene::{Family, Rendered, Sensor, generate, render};
use serde::Serialize;

use super::{EdgeCounts, KindCounts, RecursionCounts, SupportScore, SupportTruth, support_score};
use crate::error::Result;
use crate::report::write_table;

/// The scenes that are about support.
pub const FAMILIES: [Family; 5] =
    [Family::Stacked, Family::Vessels, Family::Occluded, Family::Tabletop, Family::Clutter];

/// The figures of one scene, or their sum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SceneSupport {
    /// The forest over what the method found.
    pub own: SupportScore,
    /// The forest over the true segments, with the true gravity.
    pub truth: SupportScore,
    /// As `own`, with the camera held to be horizontal.
    pub horizontal: SupportScore,
}

impl SceneSupport {
    /// Makes a scene, looks at it and compares.
    ///
    /// # Errors
    /// When the scene has no picture or the parameters are out of range.
    pub fn of(family: Family, seed: u64, sensor: Sensor, params: &Params) -> Result<Self> {
        let world = generate(family, seed);
        let seen = render(&world, sensor)?;
        let truth = SupportTruth::of(&world, &seen);
        let (own, normals) = score(&seen, &truth, params)?;
        let mut level = params.clone();
        (level.gravity.up_from, level.gravity.tilt_deg, level.gravity.roll_deg) = (UpFrom::Camera, 0.0, 0.0);
        let (horizontal, _) = score(&seen, &truth, &level)?;
        let space = DisparitySpace::new(seen.frame.camera(), &params.sensor);
        let (graph, segments) = truth.forest(&seen.frame.points_m(), &normals, &space, params)?;
        Ok(Self {
            own,
            truth: support_score(&graph, &segments, &truth, params.objectness.min_p_o)?,
            horizontal,
        })
    }
}

/// The score of what a method finds, and the normals that it saw.
fn score(seen: &Rendered, truth: &SupportTruth, params: &Params) -> Result<(SupportScore, Raster<[f32; 3]>)> {
    let mut watched = Watched {
        normals: seen.frame.depth_m().map(|_| [0.0; 3]),
        score: Ok(SupportScore::default()),
        truth,
        min_p_o: params.objectness.min_p_o,
    };
    discover_observed(&seen.frame, params, &mut watched)?;
    Ok((watched.score?, watched.normals))
}

struct Watched<'a> {
    normals: Raster<[f32; 3]>,
    score: Result<SupportScore>,
    truth: &'a SupportTruth,
    min_p_o: f32,
}

impl Watched<'_> {
    fn judge(&mut self, graph: &SupportGraph, regions: &Segments) {
        self.score = support_score(graph, regions, self.truth, self.min_p_o);
    }
}

impl Observer for Watched<'_> {
    fn observe(&mut self, output: Output<'_>) {
        match output {
            Output::Normals(normals) => self.normals = normals.clone(),
            Output::Support { graph, regions } => self.judge(graph, regions),
            _ => {}
        }
    }
}

impl AddAssign for SceneSupport {
    fn add_assign(&mut self, other: Self) {
        self.own += other.own;
        self.truth += other.truth;
        self.horizontal += other.horizontal;
    }
}

/// The figures of many scenes, with the totals that are read off them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SupportReport {
    /// The first scene.
    pub first_seed: u64,
    /// How many there are.
    pub scenes: u64,
    /// Sums over the scenes of a family, by its name.
    pub families: BTreeMap<&'static str, SceneSupport>,
    /// Sums over all.
    pub total: SceneSupport,
    /// The figures asked for, on our own segments.
    pub own: Figures,
    /// The figures asked for, on true segments.
    pub truth: Figures,
}

/// What is read off counts; 1 where there is nothing to be read off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Share of the edges found that are there.
    pub precision: f64,
    /// Share of the edges between things that were both found that were found.
    pub recall: f64,
    /// Share of all edges there that were found.
    pub recall_of_all: f64,
    /// Share of the edges *on* and *in* that were found and are of the right one of the two kinds.
    pub in_against_on: f64,
    /// The same of the edges *in* alone.
    pub called_in: f64,
}

impl Figures {
    fn of(score: &SupportScore) -> Self {
        let share = |part: u32, whole: u32| if whole == 0 { 1.0 } else { f64::from(part) / f64::from(whole) };
        let (on, within) = (score.on, score.within);
        let told = [on, within].map(|kind| kind.called_on + kind.called_in);
        Self {
            precision: score.edges.precision(),
            recall: score.edges.recall(),
            recall_of_all: score.edges.recall_of_all(),
            in_against_on: share(on.called_on + within.called_in, told[0] + told[1]),
            called_in: share(within.called_in, told[1]),
        }
    }
}

impl SupportReport {
    /// Sums up the scenes from `first_seed` on, of which the families have these figures.
    pub fn new(first_seed: u64, scenes: u64, families: BTreeMap<&'static str, SceneSupport>) -> Self {
        let mut total = SceneSupport::default();
        families.values().for_each(|family| total += *family);
        let (own, truth) = (Figures::of(&total.own), Figures::of(&total.truth));
        Self { first_seed, scenes, families, total, own, truth }
    }
}

impl fmt::Display for SupportReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let last = self.first_seed + self.scenes.saturating_sub(1);
        writeln!(f, "support forest, synthetic scenes {} to {last}\n", self.first_seed)?;
        let scores = |of: fn(&SceneSupport) -> &SupportScore| {
            let families = self.families.iter().map(move |(name, scene)| ((*name).to_owned(), *of(scene)));
            families.chain([("all".to_owned(), *of(&self.total))])
        };
        let own = scores(|scene| &scene.own).map(|(name, score)| edges_row(format!("own, {name}"), &score));
        let truth =
            scores(|scene| &scene.truth).map(|(name, score)| edges_row(format!("true, {name}"), &score));
        let header = [
            "segments",
            "precision",
            "recall",
            "of all",
            "right",
            "wrong",
            "missed",
            "unmatched",
            "on: on/in/leans",
            "in",
            "leans",
        ];
        write_table(f, 1, &header, &own.chain(truth).collect::<Vec<_>>())?;
        let Figures { in_against_on, called_in, .. } = self.own;
        let of_truth = self.truth;
        writeln!(
            f,
            "\n\nin against on: {in_against_on:.3} own ({called_in:.3} of what lies in something), {:.3} true ({:.3})\n",
            of_truth.in_against_on, of_truth.called_in
        )?;
        let [plane, camera] =
            [("of the plane", self.total.own), ("of a horizontal camera", self.total.horizontal)];
        let claim = [plane, camera].map(|(up, score)| claim_row(up, "things on things", score.recursion));
        let control = [plane, camera].map(|(up, score)| claim_row(up, "no objects", score.control));
        let header = ["P(O) carries, with up", "what", "all", "with recursion", "planes alone"];
        write_table(f, 2, &header, &[claim, control].concat())
    }
}

fn edges_row(name: String, score: &SupportScore) -> Vec<String> {
    let EdgeCounts { right, wrong, missed, unmatched } = score.edges;
    let shares = [score.edges.precision(), score.edges.recall(), score.edges.recall_of_all()]
        .map(|share| format!("{share:.3}"));
    let counts = [right, wrong, missed, unmatched].map(|n| n.to_string());
    let kind = |KindCounts { there, called_on, called_in, called_leans }: KindCounts| {
        format!("{called_on}/{called_in}/{called_leans} of {there}")
    };
    let kinds = [score.on, score.within, score.leans].map(kind);
    std::iter::once(name).chain(shares).chain(counts).chain(kinds).collect()
}

fn claim_row(
    up: &str,
    what: &str,
    RecursionCounts { things, with, without }: RecursionCounts,
) -> Vec<String> {
    let share = |n: u32| format!("{n} ({:.3})", f64::from(n) / f64::from(things.max(1)));
    vec![up.to_owned(), what.to_owned(), things.to_string(), share(with), share(without)]
}
