//! A pipeline that looks at a frame again after a change of parameters says what a fresh one says, and each parameter names the
//! first stage that reads it.
#![allow(clippy::unwrap_used, reason = "what fails is reported so")]

mod common;

use std::collections::{BTreeMap, BTreeSet};
use std::hash::{DefaultHasher, Hash, Hasher};

use objecthood::{
    Discovery, Frame, Method, Observer, Output, Params, Pipeline, Raster, Stage, discover, discover_observed,
};
use objecthood_eval::sensitivity;
use objecthood_scene::{Family, Sensor, generate, render};

/// For these parameters no tested value changes the output of the stage that they name. So the test cannot notice if that stage is
/// named too early: the code alone says that it reads them.
const UNCHANGED: [&str; 15] = [
    "context color_cuts.least_against",
    "context contraction.occlusion_weight",
    "context contraction.seam_weight",
    "context flat.color_overlap",
    "context flat.offset_sigmas",
    "context objectness.max_side_m",
    "context seams.color_overlap",
    "context seams.cross_share",
    "context seams.enabled",
    "context sensor.color",
    "context sensor.lateral_noise_px",
    "context sensor.noise",
    "context sensor.profile",
    "paper contact.distance_m",
    "paper gravity.min_inlier_share",
];

const METHODS: [Method; 2] = [Method::Context, Method::Paper];

/// All that was found, for comparison: the two maps as they are, because as text they would take a fifth of the time.
fn said(mut found: Discovery) -> ([Raster<u16>; 2], String) {
    let maps = [&mut found.labels, &mut found.structure];
    let maps = maps.map(|map| std::mem::replace(map, Raster::filled(1, 1, 0).unwrap()));
    (maps, format!("{found:?}"))
}

/// Looks at a frame with default parameters, then with every setting of the sensitivity analysis, in one pipeline.
fn check_frame(name: &str, frame: &Frame, method: Method) {
    let params = Params { method, ..Params::default() };
    let mut pipeline = Pipeline::default();
    let mut asked = BTreeSet::new();
    for setting in sensitivity(&params).unwrap() {
        // One other value of every parameter: back and forth would look at all twice.
        if !asked.insert(setting.name.split(" = ").next().unwrap().to_owned()) {
            continue;
        }
        let again = said(pipeline.discover(frame, &setting.params).unwrap().clone());
        let fresh = said(discover(frame, &setting.params).unwrap());
        assert!(again == fresh, "{name}, {method}, {}: not what a fresh run finds", setting.name);
    }
    assert!(asked.len() > 20, "{asked:?}");
}

#[test]
fn after_any_change_of_parameters_a_pipeline_finds_what_a_fresh_run_finds() {
    for method in METHODS {
        for (seed, family) in (1..).zip([Family::Vessels, Family::Clutter]) {
            let frame = render(&generate(family, seed), Sensor::Kinect).unwrap().frame;
            check_frame(&format!("{family:?} {seed}"), &frame, method);
        }
    }
}

#[test]
fn after_any_change_of_parameters_labels_of_real_scenes_are_those_of_a_fresh_run() {
    let Some(data) = common::data() else {
        println!("skipped: no mOSD here (set OBJECTHOOD_DATA)");
        return;
    };
    for scene in (0..=40).step_by(5) {
        let name = format!("learn{scene}");
        let path = data.join("mosd/learn").join(&name).with_extension("pcd");
        let frame = objecthood_io::open_frame(&path, &objecthood_io::Given::default()).unwrap().frame;
        check_frame(&name, &frame, Method::Context);
        if scene == 0 {
            check_frame(&name, &frame, Method::Paper);
        }
    }
}

/// What every stage put out, as a number.
#[derive(Default)]
struct Digests(BTreeMap<Stage, u64>);

fn digest(value: impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    value.hash(&mut hasher);
    hasher.finish()
}

fn digest_of(value: &impl std::fmt::Debug) -> u64 {
    digest(format!("{value:?}"))
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|x| x.to_bits()).collect()
}

impl Observer for Digests {
    fn observe(&mut self, output: Output<'_>) {
        let digest = match output {
            Output::Normals(normals) => digest(bits(normals.as_slice().as_flattened())),
            Output::Curvature(curvature) => digest(bits(curvature.as_slice())),
            Output::Structure(map) | Output::Superpixels(map) | Output::Shapes(map) => {
                digest(map.segments().labels().as_slice())
            }
            Output::Facets(facets) => digest(facets.labels().as_slice()),
            Output::Borders { evidence, .. } => digest_of(evidence),
            Output::Clusters { clusters, .. } => digest_of(clusters),
            Output::Support { graph, regions } => {
                digest([digest_of(graph), digest(regions.labels().as_slice())])
            }
            Output::Hypotheses(hypotheses) => digest_of(&hypotheses),
            Output::Objects(found) => digest_of(found),
            _ => return,
        };
        self.0.insert(output.stage(), digest);
    }
}

fn digests(frame: &Frame, params: &Params) -> BTreeMap<Stage, u64> {
    let mut digests = Digests::default();
    discover_observed(frame, params, &mut digests).unwrap();
    digests.0
}

#[test]
fn a_parameter_names_the_first_stage_that_depends_on_it() {
    let frames = [(1, Family::Vessels), (2, Family::Clutter), (5, Family::Clutter)].into_iter();
    let frames = frames.map(|(seed, family)| render(&generate(family, seed), Sensor::Kinect).unwrap().frame);
    // Whether a tested value of a parameter changed the stage that it names.
    let mut changed: BTreeMap<String, bool> = BTreeMap::new();
    let table = Params::table();
    for frame in frames {
        for method in METHODS {
            let params = Params { method, ..Params::default() };
            let before = digests(&frame, &params);
            for setting in sensitivity(&params).unwrap() {
                let parameter = setting.name.split(" = ").next().unwrap();
                let Some(info) = table.iter().find(|info| info.name == parameter) else { continue };
                let first = info.first_stage(method).unwrap();
                let after = digests(&frame, &setting.params);
                for (stage, digest) in before.range(..first) {
                    assert_eq!(digest, &after[stage], "{method}, {}: {stage} differs", setting.name);
                }
                *changed.entry(format!("{method} {parameter}")).or_default() |=
                    before[&first] != after[&first];
            }
        }
    }
    let unchanged: Vec<&str> =
        changed.iter().filter(|(_, changed)| !**changed).map(|(name, _)| &name[..]).collect();
    assert_eq!(unchanged, UNCHANGED, "a stage is named too early, or these scenes do not show the parameter");
}
