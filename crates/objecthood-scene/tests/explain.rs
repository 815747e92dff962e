//! Explanations on synthetic scenes: twenty cases of every kind of decision, and whether what they say of parameters is true.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or is counted is reported so")]

use std::collections::BTreeMap;

use objecthood::clusters::history::Rule;
use objecthood::discovery::JoinEvidence;
use objecthood::explain::{Decision, Explainer, Explanation, Flip, Question, Reason};
use objecthood::{Camera, Discovery, Frame, Params, Pipeline, discover};
use objecthood_scene::{Family, Sensor, Viewpoint, generate, render};

/// So many cases of every kind.
const CASES: usize = 20;
/// Of one scene at most so many.
const CASES_OF_A_SCENE: usize = 2;
/// Scenes that are looked at, at most.
const SCENES: u64 = 300;

/// The first scenes of the family `clutter` in which something is joined behind something else.
const HIDDEN: [u64; 27] = [
    2, 4, 17, 24, 33, 35, 39, 45, 46, 51, 56, 65, 66, 70, 86, 88, 96, 99, 113, 120, 122, 123, 126, 128, 131,
    135, 136,
];

/// The kinds of decisions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    ConvexityJoined,
    ConvexityCut,
    StepCut,
    Fragment,
    Low,
    TooSmall,
    Unlikely,
    OcclusionJoined,
    OcclusionMissed,
    VesselJoined,
    VesselMissed,
    VesselBottom,
    NeckJoined,
    NeckMissed,
    SeamCut,
    Flat,
    Kept,
}

/// What is asked of a kind: so many cases, and flips for so many of them at least.
type Asked = (Kind, usize, usize);

/// Of a step that is deep, or of a fragment that another rule would join, no single parameter decides otherwise.
const KINDS: [Asked; 10] = [
    (Kind::ConvexityJoined, CASES, 15),
    (Kind::ConvexityCut, CASES, 18),
    (Kind::StepCut, CASES, 8),
    (Kind::Fragment, CASES, 10),
    (Kind::Low, CASES, 18),
    (Kind::TooSmall, CASES, 18),
    (Kind::Unlikely, CASES, 20),
    (Kind::VesselJoined, CASES, 16),
    (Kind::VesselBottom, CASES, 18),
    (Kind::Kept, CASES, 20),
];

/// The same of what is looked for where things are hidden, in full resolution; what was nearly joined mostly fails by a fixed limit, or
/// by two.
const HIDDEN_KINDS: [Asked; 3] =
    [(Kind::OcclusionJoined, CASES, 16), (Kind::OcclusionMissed, 5, 0), (Kind::VesselMissed, 5, 0)];

/// The same of what colour tells where depth is silent, on scenes of these families; a joint of necks has its limits, or a switch.
const SILENT_KINDS: [Asked; 4] =
    [(Kind::NeckJoined, 10, 9), (Kind::NeckMissed, 5, 0), (Kind::SeamCut, 5, 5), (Kind::Flat, 10, 8)];
const SILENT: [Family; 3] = [Family::Parts, Family::Flush, Family::Thin];

fn kind(decision: &Decision) -> Option<Kind> {
    Some(match (decision.reason, decision.question, decision.yes) {
        (Reason::Folds, _, true) => Kind::ConvexityJoined,
        (Reason::Folds, _, false) => Kind::ConvexityCut,
        (Reason::Steps, ..) => Kind::StepCut,
        (Reason::Rule(Rule::Fragment), Question::OneThing { .. }, true) => Kind::Fragment,
        (Reason::Rule(Rule::Low), Question::Kept { .. }, false) => Kind::Low,
        (Reason::Size, ..) => Kind::TooSmall,
        (Reason::Objectness, ..) => Kind::Unlikely,
        (Reason::Rule(Rule::Occlusion), _, true) => Kind::OcclusionJoined,
        (Reason::Rule(Rule::Occlusion), _, false) => Kind::OcclusionMissed,
        (Reason::Rule(Rule::VesselBottom), Question::Bottom { .. }, true) => Kind::VesselBottom,
        (Reason::Rule(Rule::VesselRim | Rule::OpenBox | Rule::BoxWalls | Rule::VesselBottom), _, true) => {
            return None;
        }
        (Reason::Rule(rule), _, true) if rule.is_of_vessels() => Kind::VesselJoined,
        (Reason::Rule(rule), _, false) if rule.is_of_vessels() => Kind::VesselMissed,
        (Reason::Rule(Rule::Neck), _, true) => Kind::NeckJoined,
        (Reason::Rule(Rule::Neck), _, false) => Kind::NeckMissed,
        (Reason::Seam, ..) => Kind::SeamCut,
        (Reason::Flat, ..) => Kind::Flat,
        (Reason::Passed, ..) => Kind::Kept,
        _ => return None,
    })
}

/// What was counted of one kind.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    cases: usize,
    flipped: usize,
    /// Of those, after which half way does not suffice.
    tight: usize,
}

/// One pixel of every object.
fn of_objects(explainer: &Explainer) -> Vec<[usize; 2]> {
    explainer.discovery().objects.iter().filter_map(|object| explainer.pixel_of(object.id)).collect()
}

/// One pixel of every facet.
fn of_facets(explainer: &Explainer) -> Vec<[usize; 2]> {
    let labels = explainer.facets().labels();
    let mut first = vec![None; explainer.facets().count()];
    for (i, &facet) in labels.as_slice().iter().enumerate() {
        if let Some(first) = usize::try_from(facet).ok().and_then(|facet| first.get_mut(facet)) {
            first.get_or_insert([i % labels.width(), i / labels.width()]);
        }
    }
    first.into_iter().flatten().collect()
}

/// A decision agrees with what its explanation says beside it.
fn check_consistent(explainer: &Explainer, explanation: &Explanation) {
    for border in &explanation.borders {
        let Some(decision) = &border.decision else { continue };
        let vote_mm = border.vote_mm.unwrap();
        match (decision.reason, decision.yes) {
            (Reason::Folds, true) => assert!(vote_mm > 0.0 && border.mean_angle_deg.is_some(), "{border:?}"),
            (Reason::Folds, false) => assert!(vote_mm <= 0.0 && border.folded_mm > 0.0, "{border:?}"),
            (Reason::Steps, yes) => assert!(!yes && vote_mm <= 0.0 && border.stepped_mm > 0.0, "{border:?}"),
            (Reason::Colors, yes) => {
                assert!(!yes && vote_mm <= 0.0 && border.color_change_mm > 0.0, "{border:?}");
            }
            (Reason::Seam, yes) => {
                assert!(!yes && border.seam_mm > 0.0 && !decision.checks.is_empty(), "{border:?}");
            }
            (Reason::OtherBorders, yes) => assert_eq!(yes, vote_mm <= 0.0, "{border:?}"),
            (Reason::Rule(_), yes) => assert!(yes, "{border:?}"),
            (
                Reason::Size
                | Reason::Objectness
                | Reason::Structure
                | Reason::Skirt
                | Reason::Passed
                | Reason::Flat,
                _,
            ) => {
                panic!("{border:?}")
            }
        }
    }
    for decision in explanation.decisions() {
        assert_eq!(decision.flip, Flip::NotSought);
        assert_eq!(explainer.answer(decision.question), decision.yes);
        let all_hold = decision.checks.iter().all(|check| check.holds());
        match kind(decision) {
            Some(Kind::OcclusionMissed | Kind::VesselMissed | Kind::NeckMissed) => {
                assert!(!all_hold, "{decision:?}");
            }
            // What speaks against an object is named, and nothing of it holds.
            Some(Kind::Kept) => {
                let any_holds = decision.checks.iter().any(|check| check.holds());
                assert!(!any_holds && !decision.checks.is_empty() && decision.yes, "{decision:?}");
            }
            _ => assert!(all_hold, "{decision:?}"),
        }
    }
}

/// With the value that the flip names the whole method decides otherwise, half way it does not.
fn check_flip(frame: &Frame, explainer: &Explainer, decision: &Decision, flip: &Flip) {
    let default = Params::default();
    let answer_with = |params: &Params| {
        // Seams and flat things are found before facets have their numbers.
        if matches!(decision.reason, Reason::Seam | Reason::Flat) {
            return shown(explainer, &discover(frame, params).unwrap(), decision.question);
        }
        let other = Explainer::new(&Pipeline::default(), frame, params).unwrap();
        check_labels(explainer, other.discovery(), decision.question, other.answer(decision.question));
        other.answer(decision.question)
    };
    if let Flip::Off { parameter } = flip {
        let off = default.with_choice(parameter, "false").unwrap();
        assert_ne!(answer_with(&off), decision.yes, "{decision:?} {flip:?}");
    }
    let &Flip::At { parameter, from, to, is_tight } = flip else { return };
    assert_eq!(default.number(parameter), Some(from));
    let answer = |value: f64| answer_with(&default.with_number(parameter, value).unwrap());
    assert_ne!(answer(to), decision.yes, "{decision:?} {flip:?}");
    let half = (from + to) / 2.0;
    let is_whole = default.with_number(parameter, from + 0.5).is_none() && from.fract() == 0.0 && from > 10.0;
    let half = if is_whole { half.round() } else { half };
    if is_tight && half != to && half != from {
        assert_eq!(answer(half), decision.yes, "{decision:?} {flip:?}");
    }
}

/// The labels of the pixels of a facet.
fn labels_in<'a>(
    explainer: &'a Explainer,
    found: &'a Discovery,
    facet: u32,
) -> impl Iterator<Item = u16> + 'a {
    let facets = explainer.facets().labels().as_slice().iter();
    let own = facets.zip(found.labels.as_slice()).filter(move |(f, _)| **f == facet as i32);
    own.map(|(_, &label)| label)
}

/// What the label image says: most pixels of both facets have one label, or those of the facet have any.
fn shown(explainer: &Explainer, found: &Discovery, question: Question) -> bool {
    let most = |facet: u32| {
        let mut pixels = BTreeMap::<u16, usize>::new();
        labels_in(explainer, found, facet).for_each(|label| *pixels.entry(label).or_default() += 1);
        pixels.into_iter().max_by_key(|(_, pixels)| *pixels).map_or(0, |(label, _)| label)
    };
    match question {
        Question::OneThing { facets: [a, b] } => most(a) == most(b),
        Question::Kept { facet } => most(facet) > 0,
        Question::OfObject { .. } | Question::Bottom { .. } => panic!("{question:?}"),
    }
}

/// The label image says the same, as far as it shows what is asked.
fn check_labels(explainer: &Explainer, found: &Discovery, question: Question, answer: bool) {
    let labels_of = |facet: u32| {
        let mut labels: Vec<u16> = labels_in(explainer, found, facet).collect();
        labels.sort_unstable();
        labels.dedup();
        labels
    };
    match question {
        Question::OneThing { facets } => {
            let [a, b] = facets.map(labels_of);
            // Neither of what is no object nor of what is filled can it be said.
            if a.len() == 1 && b.len() == 1 && a[0] > 0 && b[0] > 0 {
                assert_eq!(a == b, answer, "{question:?}");
            }
        }
        Question::Kept { facet } => {
            assert_eq!(labels_of(facet).iter().any(|label| *label > 0), answer, "{question:?}");
        }
        Question::OfObject { .. } | Question::Bottom { .. } => {}
    }
}

/// What is no object but would be with another value is explained by that filter.
fn check_filter(
    frame: &Frame,
    explainer: &Explainer,
    params: &Params,
    kind: Kind,
    cases: &mut Vec<Decision>,
) {
    let with = discover(frame, params).unwrap();
    let now = &explainer.discovery().labels;
    for object in &with.objects {
        let own: Vec<usize> = (0..now.len()).filter(|&i| with.labels[i] == object.id.0).collect();
        // What is flat is found by its rise or colour, not spared by a filter.
        if object.is_flat || own.iter().any(|&i| now[i] > 0) {
            continue;
        }
        let pixel = [own[0] % now.width(), own[0] / now.width()];
        let explanation = explainer.describe(pixel).unwrap();
        let kept = explanation.kept.expect("it is no structure");
        // A thing that is too small or too low may carry another, which is unlikely without it.
        if [Kind::TooSmall, Kind::Low].contains(&kind) && self::kind(&kept) == Some(Kind::Unlikely) {
            continue;
        }
        assert_eq!(self::kind(&kept), Some(kind), "{pixel:?}: {kept:?}");
        cases.push(kept);
    }
}

/// What was decided in a frame, by kind, each question once.
fn decisions(frame: &Frame, explainer: &Explainer, pixels: &[[usize; 2]]) -> BTreeMap<Kind, Vec<Decision>> {
    let mut cases: BTreeMap<Kind, Vec<Decision>> = BTreeMap::new();
    let mut lax = Params::default();
    lax.height.min_top_m = -1.0;
    check_filter(frame, explainer, &lax, Kind::Low, cases.entry(Kind::Low).or_default());
    let mut lax = Params::default();
    lax.objectness.min_size_px = 1;
    check_filter(frame, explainer, &lax, Kind::TooSmall, cases.entry(Kind::TooSmall).or_default());
    let mut lax = Params::default();
    lax.objectness.every_hypothesis = true;
    check_filter(frame, explainer, &lax, Kind::Unlikely, cases.entry(Kind::Unlikely).or_default());
    let filters = [Kind::Low, Kind::TooSmall, Kind::Unlikely];
    for &pixel in pixels {
        let explanation = explainer.describe(pixel).unwrap();
        check_consistent(explainer, &explanation);
        for decision in explanation.decisions() {
            let Some(kind) = kind(decision).filter(|kind| !filters.contains(kind)) else {
                continue;
            };
            let cases = cases.entry(kind).or_default();
            if cases.iter().all(|case| subject(case) != subject(decision)) {
                cases.push(decision.clone());
            }
        }
    }
    cases
}

/// What a question is about, whoever asks.
fn subject(decision: &Decision) -> [u32; 2] {
    match decision.question {
        Question::OneThing { facets: [a, b] } => [a.min(b), a.max(b)],
        Question::Kept { facet } => [facet, facet],
        Question::OfObject { pixel: patch } | Question::Bottom { patch, .. } => patch.map(|at| at as u32),
    }
}

/// Joins of the result have to be in the explanations of its objects.
fn check_joins(explainer: &Explainer) {
    for object in &explainer.discovery().objects {
        let explanation = explainer.describe(explainer.pixel_of(object.id).unwrap()).unwrap();
        let is_occlusion = |evidence: &JoinEvidence| matches!(evidence, JoinEvidence::Occlusion(_));
        let joins = object.joins.iter().filter(|join| is_occlusion(&join.evidence)).count();
        let told =
            explanation.way.iter().filter(|decision| kind(decision) == Some(Kind::OcclusionJoined)).count();
        assert_eq!(told, joins, "{object:?}");
    }
}

/// Adds the cases of one frame, as far as they are not enough, and tries their flips.
fn count(
    frame: &Frame,
    kinds: &[Asked],
    pixels: fn(&Explainer) -> Vec<[usize; 2]>,
    counts: &mut BTreeMap<Kind, Count>,
) {
    let params = Params::default();
    let explainer = Explainer::new(&Pipeline::default(), frame, &params).unwrap();
    check_joins(&explainer);
    for (kind, cases) in decisions(frame, &explainer, &pixels(&explainer)) {
        let Some(&(_, enough, _)) = kinds.iter().find(|(known, ..)| *known == kind) else { continue };
        let count = counts.entry(kind).or_default();
        // Spread over the frame.
        let step = cases.len().div_ceil(CASES_OF_A_SCENE).max(1);
        for decision in cases.iter().step_by(step).take(enough.saturating_sub(count.cases)) {
            let flip = explainer.flip(decision);
            check_flip(frame, &explainer, decision, &flip);
            count.cases += 1;
            count.flipped += usize::from(matches!(flip, Flip::At { .. } | Flip::Off { .. }));
            count.tight += usize::from(matches!(flip, Flip::At { is_tight: true, .. }));
        }
    }
}

/// Whether there are enough cases of each of these kinds.
fn is_enough(kinds: &[Asked], counts: &BTreeMap<Kind, Count>) -> bool {
    kinds.iter().all(|(kind, cases, _)| counts.get(kind).is_some_and(|count| count.cases >= *cases))
}

fn report(kinds: &[Asked], counts: &BTreeMap<Kind, Count>) {
    for (kind, _, least) in kinds {
        let Count { cases, flipped, tight } = counts.get(kind).copied().unwrap_or_default();
        println!("{kind:?}: {flipped} of {cases} cases have a flip, and it is true; {tight} are tight");
        assert!(flipped >= *least, "{kind:?}: {flipped} of {cases}");
    }
}

#[test]
fn twenty_cases_of_every_kind_are_explained_and_their_flips_are_true() {
    let mut counts = BTreeMap::new();
    for seed in 0..SCENES {
        let family = Family::ALL[(seed % 6) as usize];
        let world = generate(family, seed);
        // In half the resolution of a Kinect: parameters in pixels and their limits are not the same then.
        let camera = Camera { fx_px: 262.5, fy_px: 262.5, cx_px: 159.5, cy_px: 119.5 };
        let viewpoint = Viewpoint { camera, size_px: (320, 240), pose: world.viewpoint().pose };
        let seen = render(&world.with_viewpoint(viewpoint).unwrap(), Sensor::Kinect).unwrap();
        count(&seen.frame, &KINDS, of_facets, &mut counts);
        if is_enough(&KINDS, &counts) {
            break;
        }
    }
    report(&KINDS, &counts);
    assert!(is_enough(&KINDS, &counts), "{counts:?}");
}

#[test]
fn what_goes_on_behind_something_is_explained_and_its_flips_are_true() {
    let mut counts = BTreeMap::new();
    for seed in HIDDEN {
        let seen = render(&generate(Family::Clutter, seed), Sensor::Kinect).unwrap();
        count(&seen.frame, &HIDDEN_KINDS, of_objects, &mut counts);
        if is_enough(&HIDDEN_KINDS, &counts) {
            break;
        }
    }
    report(&HIDDEN_KINDS, &counts);
    assert!(is_enough(&HIDDEN_KINDS, &counts), "{counts:?}");
}

#[test]
fn what_color_tells_where_depth_is_silent_is_explained_and_its_flips_are_true() {
    let mut counts = BTreeMap::new();
    for seed in 0..SCENES {
        let seen = render(&generate(SILENT[(seed % 3) as usize], seed), Sensor::Kinect).unwrap();
        count(&seen.frame, &SILENT_KINDS, of_facets, &mut counts);
        if is_enough(&SILENT_KINDS, &counts) {
            break;
        }
    }
    report(&SILENT_KINDS, &counts);
    assert!(is_enough(&SILENT_KINDS, &counts), "{counts:?}");
}
