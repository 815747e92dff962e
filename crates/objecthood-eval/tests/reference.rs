//! The label images of the reference implementation score as its record says.

mod common;

use objecthood_eval::{
    Error, LabelFolder, Prediction, Report, Split, VerdictsTable, evaluate, evaluate_settings, ladder, scenes,
};
use serde_json::Value;

/// The recorded digits.
const TOLERANCE: f64 = 0.5e-4 + 1e-12;

fn assert_near(ours: f64, recorded: &Value, what: &str) {
    let recorded = recorded.as_f64().expect("a number");
    assert!((ours - recorded).abs() <= TOLERANCE, "{what}: {ours} but {recorded} is recorded");
}

/// Compares what the record holds of both a scene and the total.
fn assert_figures(ours: &Value, recorded: &Value, what: &str) {
    for (group, keys) in [("overlap", ["oP", "oR", "oF"]), ("boundary", ["bP", "bR", "bF"])] {
        for (key, letter) in keys.iter().zip(["P", "R", "F"]) {
            let value = ours[key].as_f64().expect("a figure");
            assert_near(value, &recorded[group][letter], &format!("{what} {key}"));
        }
    }
    assert_near(ours["p75"].as_f64().expect("a figure"), &recorded["p75"], &format!("{what} p75"));
    for key in ["hypotheses", "hypotheses_off_objects"] {
        assert_eq!(ours[key], recorded[key], "{what} {key}");
    }
}

fn assert_reproduced(report: &Report, recorded: &Value) {
    let json = serde_json::to_value(report).expect("a report has a JSON form");
    assert_figures(&json["total"], &recorded["total"], "total");
    assert_eq!(json["total"]["counts"], recorded["total"]["verdicts"]);
    assert_eq!(json["total"]["objects"], recorded["total"]["objects"]);
    assert_near(report.total.weighted_overlap, &recorded["total"]["WOv"], "total WOv");

    let scenes = recorded["scenes"].as_object().expect("a map of scenes");
    assert_eq!(report.scenes.len(), scenes.len());
    for scene in &report.scenes {
        let name = &scene.name;
        let (ours, recorded) = (&json["scenes"][name], &scenes[name]);
        assert_figures(ours, recorded, name);
        let objects = recorded["objects"].as_array().expect("a list of objects");
        assert_eq!(scene.score.objects.len(), objects.len(), "{name}");
        for (k, (object, recorded)) in scene.score.objects.iter().zip(objects).enumerate() {
            assert_near(object.iou, &recorded["iou"], &format!("{name} object {k}"));
            for key in ["truth_label", "pixels", "verdict"] {
                assert_eq!(ours["verdicts"][k][key], recorded[key], "{name} object {k} {key}");
            }
        }
    }
}

#[test]
fn the_reference_label_images_score_as_recorded() {
    let Some(data) = common::data() else {
        println!("skipped: no mOSD here (set OBJECTHOOD_DATA)");
        return;
    };
    let reference = data.join("../design/reference");
    let Ok(scores) = std::fs::read_to_string(reference.join("scores.json")) else {
        println!("skipped: no reference label images beside the data");
        return;
    };
    let scores: Value = serde_json::from_str(&scores).unwrap();
    let scenes = scenes(&data.join("mosd"), &Split::Folder("learn".to_owned())).unwrap();
    assert_eq!(scenes.len(), 45);

    for (method, line) in [
        (
            "paper",
            "correct 0.643 (72/112)  overlap P 85.0 R 80.9 F 82.7  boundary P 49.7 R 75.7 F 59.4  %75 76.6  WOv 0.810  | occl 12 over 13 under 7 bnd 0 missed 8",
        ),
        (
            "context",
            "correct 1.000 (112/112)  overlap P 98.9 R 98.5 F 98.7  boundary P 92.4 R 96.5 F 94.3  %75 100.0  WOv 0.979  | occl 0 over 0 under 0 bnd 0 missed 0",
        ),
    ] {
        let labels = LabelFolder { path: reference.join("learn"), suffix: format!(".{method}.png") };
        let report = evaluate(&scenes, None, |_, scene| labels.read(scene)).unwrap();
        assert_eq!(report.total.to_string(), line, "PARITY.md, The reference");
        assert_reproduced(&report, &scores["methods"][method]);
        if method == "paper" {
            let table = VerdictsTable(&report).to_string();
            let counts: Vec<String> = table.lines().skip(2).map(|row| row[..46].to_owned()).collect();
            let expected = [
                "| learn: boxes             |      29 |      38 |",
                "| learn: stacked boxes     |      12 |      20 |",
                "| learn: occluded objects  |       5 |      16 |",
                "| learn: cylindric objects |      26 |      38 |",
                "| learn                    |      72 |     112 |",
            ];
            assert_eq!(counts, expected.map(|row| row[..46].to_owned()), "PARITY.md, The reference");
        }
    }
}

/// Each of our labels stands for one label of the reference, and the other way round.
fn assert_same_regions(ours: &[u16], reference: &[u16], name: &str) {
    let mut partner = std::collections::BTreeMap::new();
    let mut taken = std::collections::BTreeMap::from([(0, 0)]);
    for (i, (&a, &b)) in ours.iter().zip(reference).enumerate() {
        let (expected, back) = (*partner.entry(a).or_insert(b), *taken.entry(b).or_insert(a));
        assert_eq!((expected, back), (b, a), "{name}, pixel {i}");
    }
}

#[test]
fn context_gives_the_reference_label_maps_pixel_for_pixel() {
    let Some(data) = common::data() else {
        println!("skipped: no mOSD here (set OBJECTHOOD_DATA)");
        return;
    };
    let reference = data.join("../design/reference/learn");
    if !reference.is_dir() {
        println!("skipped: no reference label images beside the data");
        return;
    }
    let labels = LabelFolder { path: reference, suffix: ".context.png".to_owned() };
    // What we added to the reference is off: its run had nothing of it.
    let mut params = objecthood::Params { method: objecthood::Method::Context, ..Default::default() };
    params.structure.slope_quanta_per_px = 0.0;
    params.structure.skirt_reach_px = 0;
    params.vessels.bottom_contact_share = 2.0;
    params.objectness.every_hypothesis = true;
    params.flat.enabled = false;
    params.color_cuts.enabled = false;
    params.contraction.color_change_weight = 0.0;
    params.seams.enabled = false;
    params.necks.enabled = false;
    let scenes = scenes(&data.join("mosd"), &Split::Folder("learn".to_owned())).unwrap();
    for reference in &scenes {
        let scene = reference.load(None).unwrap();
        let found = objecthood::discover(&scene.frame, &params).unwrap();
        let expected = labels.read(reference).unwrap().labels;
        assert_same_regions(found.labels.as_slice(), expected.as_slice(), &reference.name);
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let again = pool.install(|| objecthood::discover(&scene.frame, &params)).unwrap();
            assert!(again.labels == found.labels, "{}: other labels on {threads} threads", reference.name);
        }
    }
}

/// Some rungs of the ladder of the reference (PARITY.md); the last is the method itself, which is compared pixel for pixel above.
#[test]
fn the_ladder_climbs_as_that_of_the_reference() {
    let Some(data) = common::data() else {
        println!("skipped: no mOSD here (set OBJECTHOOD_DATA)");
        return;
    };
    let scenes = scenes(&data.join("mosd"), &Split::Folder("learn".to_owned())).unwrap();
    let params = objecthood::Params { method: objecthood::Method::Context, ..Default::default() };
    let rungs = [(0, 91), (7, 94), (8, 104), (9, 105)];
    let settings = rungs.map(|(rung, _)| ladder(&params)[rung].clone());
    let reports = evaluate_settings(&scenes, None, &settings, |setting, scene, _| {
        let labels = objecthood::discover(&scene.frame, &setting.params)?.labels;
        Ok::<_, Error>(Prediction { labels, objects: None, stages: None })
    });
    for ((rung, correct), report) in rungs.into_iter().zip(reports.unwrap()) {
        assert_eq!(report.total.counts.correct, correct, "rung {rung}");
    }
}
