//! The scene file against its published schema.
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

use std::path::Path;

use objecthood::discovery::{
    Continuation, Join, JoinEvidence, JoinedPart, NodeId, NodeKind, RimCircle, SupportEdge, SupportGraph,
    SupportKind, SupportNode, Up, UpSource,
};
use objecthood::planes::StructurePlane;
use objecthood::{
    Camera, Discovery, Estimates, Frame, Noise, Notice, Object, ObjectId, ObjectnessParts, OrientedBox,
    Params, PixelBox, Raster,
};
use objecthood_io::scene::{SceneFile, fingerprint, schema};
use objecthood_io::{CameraFit, Capture, Error};
use serde_json::{Value, json};

fn frame() -> Frame {
    let camera = Camera::new(525.0, 525.0, 1.5, 1.0).unwrap();
    Frame::new(Raster::filled(4, 3, 1.0).unwrap(), None, camera).unwrap()
}

fn discovery() -> Discovery {
    let node = |kind, p_o| SupportNode { kind, p_s: 0.5, p_o, height_m: -0.25, size_px: 6 };
    let box_m = OrientedBox {
        center_m: [0.1, -0.2, 1.05],
        rotation_xyzw: [0.0, 0.0, 0.0, 1.0],
        extents_m: [0.1, 0.2, 0.3],
    };
    let mut object = Object::new(ObjectId(1), PixelBox { u: 1, v: 0, width: 2, height: 2 }, box_m);
    object.objectness = 0.9;
    object.parts = ObjectnessParts {
        size: 1.0,
        support: 0.9,
        footing: 1.0,
        compactness: 0.8,
        separation: 1.0,
        visibility: 0.7,
    };
    object.top_m = Some(0.1);
    object.is_flat = true;
    object.centroid_m = [0.1, -0.2, 1.0];
    object.facets = 2;
    object.node = NodeId(1);
    object.parents = vec![NodeId(0)];
    let labels = Raster::from_vec(4, 3, vec![0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0]).unwrap();
    let mut discovery = Discovery::new(vec![object], labels);
    discovery.up = Up { direction: [0.0, -1.0, 0.0], source: UpSource::Plane };
    discovery.structure_planes =
        vec![StructurePlane { normal: [0.0, -1.0, 0.0], offset_m: 0.5, inlier_share: 0.7 }];
    discovery.support = SupportGraph {
        nodes: vec![node(NodeKind::Surface, 0.0), node(NodeKind::Object { object: ObjectId(1) }, 0.9)],
        edges: vec![SupportEdge {
            kind: SupportKind::In,
            confidence: 0.5,
            hidden: true,
            ..SupportEdge::seen(NodeId(0), NodeId(1), 12)
        }],
    };
    discovery.estimates = Some(Estimates::of_noise(Noise::KINECT, 1));
    discovery.notices = vec![Notice::NoColor];
    discovery
}

fn capture() -> Capture {
    Capture::new(frame())
}

fn scene() -> SceneFile {
    let fit = CameraFit { camera: frame().camera(), residual_px: 1e-5, points: 12 };
    let mut capture = capture();
    (capture.camera_fit, capture.turned) = (Some(fit), true);
    SceneFile::new("some/folder/a.pcd", &capture, &Params::default(), &discovery())
}

fn example() -> Value {
    serde_json::from_str(&scene().to_json().unwrap()).unwrap()
}

fn validator() -> jsonschema::Validator {
    let schema: Value = serde_json::from_str(&schema()).unwrap();
    jsonschema::meta::validate(&schema).unwrap();
    jsonschema::validator_for(&schema).unwrap()
}

/// Every place in a document, as a JSON pointer.
fn places(value: &Value, here: &str, found: &mut Vec<String>) {
    found.push(here.to_owned());
    match value {
        Value::Object(map) => {
            map.iter().for_each(|(key, value)| places(value, &format!("{here}/{key}"), found));
        }
        Value::Array(values) => {
            values.iter().enumerate().for_each(|(k, value)| places(value, &format!("{here}/{k}"), found));
        }
        _ => {}
    }
}

#[test]
fn the_published_schema_is_that_of_the_code() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/scene.schema.json");
    if std::env::var_os("OBJECTHOOD_BLESS").is_some() {
        std::fs::write(&path, schema()).unwrap();
    }
    let published = std::fs::read_to_string(&path).unwrap_or_default();
    // As values, because the order of keys depends on how serde_json was built.
    let same = serde_json::from_str::<Value>(&published).ok() == serde_json::from_str(&schema()).ok();
    assert!(
        same,
        "docs/scene.schema.json is out of date: run OBJECTHOOD_BLESS=1 cargo test -p objecthood-io and commit it"
    );
}

#[test]
fn a_scene_is_valid_with_and_without_what_is_optional() {
    let validator = validator();
    let full = example();
    if let Err(error) = validator.validate(&full) {
        panic!("{error} at {}", error.instance_path());
    }
    let mut empty = discovery();
    empty.objects.clear();
    empty.structure_planes.clear();
    empty.support = SupportGraph::default();
    empty.notices = vec![];
    empty.up.source = UpSource::Camera;
    let scene = SceneFile::new("", &capture(), &Params::default(), &empty);
    let value: Value = serde_json::from_str(&scene.to_json().unwrap()).unwrap();
    assert!(validator.is_valid(&value));
    assert!(value["camera"].get("fit_residual_px").is_none());
}

/// Every kind of join, with what the scene file says of it.
fn joins() -> Vec<(JoinEvidence, Value)> {
    let rim = RimCircle { center_m: [0.1, 0.2], radius_m: 0.06, residual_m: 0.002, covered: 0.75 };
    let continuation = Continuation {
        disagreement_quanta: 0.4,
        angle_deg: 2.5,
        distance_m: 0.15,
        hidden_share: 0.875,
        seen_through_share: 0.0625,
        color_overlap: Some(0.5),
    };
    let occlusion = json!({
        "kind": "occlusion", "disagreement_quanta": 0.4, "angle_deg": 2.5, "distance_m": 0.15,
        "hidden_share": 0.875, "seen_through_share": 0.0625, "color_overlap": 0.5
    });
    let wall = json!({
        "kind": "vessel_wall", "convexity": -0.3, "wall_in_front": 40, "rim_radius_m": 0.06, "rim_residual_m": 0.002
    });
    vec![
        (JoinEvidence::Occlusion(continuation), occlusion),
        (
            JoinEvidence::VesselInside { convexity: [-0.4, -0.2] },
            json!({"kind": "vessel_inside", "convexity": [-0.4, -0.2]}),
        ),
        (JoinEvidence::VesselWall { convexity: -0.3, wall_in_front: 40, rim: Some(rim) }, wall),
        (
            JoinEvidence::VesselWall { convexity: -0.3, wall_in_front: 12, rim: None },
            json!({"kind": "vessel_wall", "convexity": -0.3, "wall_in_front": 12}),
        ),
        (
            JoinEvidence::VesselRim { rim },
            json!({"kind": "vessel_rim", "rim_radius_m": 0.06, "rim_residual_m": 0.002}),
        ),
        (
            JoinEvidence::VesselTurned { radius_m: 0.07, covered: 0.75 },
            json!({"kind": "vessel_turned", "radius_m": 0.07, "covered": 0.75}),
        ),
        (JoinEvidence::OpenBox { enclosed_share: 0.75 }, json!({"kind": "open_box", "enclosed_share": 0.75})),
        (
            JoinEvidence::VesselBottom { contact_share: 0.9375 },
            json!({"kind": "vessel_bottom", "contact_share": 0.9375}),
        ),
        (
            JoinEvidence::VesselRemainder { contact_share: 0.8125 },
            json!({"kind": "vessel_remainder", "contact_share": 0.8125}),
        ),
    ]
}

#[test]
fn every_kind_of_join_is_written_and_read_back() {
    let parts = [3, 1]
        .map(|size_px| JoinedPart { size_px, box_px: PixelBox { u: 1, v: 0, width: size_px, height: 1 } });
    for (evidence, expected) in joins() {
        for behind in [None, Some(NodeId(1))] {
            let mut discovery = discovery();
            discovery.objects[0].joins = vec![Join { parts, evidence, behind }];
            let scene = SceneFile::new("", &capture(), &Params::default(), &discovery);
            let json = scene.to_json().unwrap();
            let value: Value = serde_json::from_str(&json).unwrap();
            assert!(validator().is_valid(&value), "{json}");
            let join = &value["objects"][0]["joins"][0];
            assert_eq!(join["evidence"], expected);
            assert_eq!(join.get("behind"), behind.map(|node| json!(node.0)).as_ref());
            assert_eq!(join["parts"][1]["size_px"], 1);
            assert_eq!(join["parts"][0]["box_px"], json!({"u": 1, "v": 0, "width": 3, "height": 1}));
            let again = serde_json::from_str::<SceneFile>(&json).unwrap();
            assert_eq!(again.to_json().unwrap(), json);
        }
    }
}

#[test]
fn the_values_are_those_of_the_discovery() {
    let value = example();
    assert_eq!(value["schema_version"], 1);
    assert_eq!(value["input"], "some/folder/a.pcd");
    assert_eq!(value["method"], "context");
    assert_eq!(value["parameters_fingerprint"], fingerprint(&Params::default()));
    assert_eq!(value["image"], json!({"width_px": 4, "height_px": 3}));
    assert_eq!(value["camera"]["fit_residual_px"], 1e-5);
    assert_eq!(value["up"], json!({"direction": [0.0, -1.0, 0.0], "source": "plane"}));
    assert_eq!(value["objects"][0]["box_px"], json!({"u": 1, "v": 0, "width": 2, "height": 2}));
    assert_eq!(value["objects"][0]["parts"]["size"], 1.0);
    assert_eq!(value["objects"][0]["parents"], json!([0]));
    assert!(value["support"]["nodes"][0].get("object").is_none());
    assert_eq!(value["support"]["nodes"][1]["object"], 1);
    assert_eq!(
        value["support"]["edges"],
        json!([{
            "lower": 0, "upper": 1, "kind": "in", "confidence": 0.5, "hidden": true, "contacts": 12
        }])
    );
    assert_eq!(value["notices"][1], Notice::NoColor.to_string());
    assert!(value["notices"][0].as_str().unwrap().contains("behind the camera"));
}

#[test]
fn numbers_are_written_as_short_as_they_are() {
    let text = scene().to_json().unwrap();
    assert!(text.contains("\"objectness\": 0.9,"), "{text}");
    assert!(text.ends_with("}\n"));
}

#[test]
fn a_scene_can_be_read_back() {
    assert_eq!(serde_json::from_str::<SceneFile>(&scene().to_json().unwrap()).unwrap(), scene());
}

#[test]
fn every_unknown_missing_or_wrong_entry_is_refused() {
    let validator = validator();
    let example = example();
    let mut all = Vec::new();
    places(&example, "", &mut all);
    assert!(all.len() > 80, "{}", all.len());
    let optional = |place: &str| {
        ["fit_residual_px", "nodes/1/object", "objects/0/top_m", "objects/0/flat", "/noise"]
            .iter()
            .any(|end| place.ends_with(end))
    };

    for place in &all {
        let refuses = |change: &dyn Fn(&mut Value)| {
            let mut broken = example.clone();
            change(broken.pointer_mut(place).unwrap());
            !validator.is_valid(&broken)
        };
        assert!(refuses(&|value| *value = Value::Null), "{place} = null");
        assert!(refuses(&|value| *value = json!({"other": 1})), "{place} = an object");
        if !example.pointer(place).unwrap().is_string() {
            assert!(refuses(&|value| *value = json!("text")), "{place} = text");
        }
        if let Some(map) = example.pointer(place).unwrap().as_object() {
            assert!(refuses(&|value| value["unknown"] = json!(1)), "{place} with an unknown entry");
            for key in map.keys().filter(|key| !optional(&format!("{place}/{key}"))) {
                let remove = |value: &mut Value| drop(value.as_object_mut().unwrap().remove(key));
                assert!(refuses(&remove), "{place} without {key}");
            }
        }
    }
}

#[test]
fn values_out_of_range_are_refused() {
    let validator = validator();
    for (place, value) in [
        ("/schema_version", json!(2)),
        ("/parameters_fingerprint", json!("abc")),
        ("/image/width_px", json!(0)),
        ("/image/width_px", json!(1.5)),
        ("/camera/fx_px", json!(0.0)),
        ("/camera/fit_residual_px", json!(-0.1)),
        ("/up/source", json!("guess")),
        ("/up/direction", json!([0.0, 1.0])),
        ("/structure_planes/0/inlier_share", json!(1.5)),
        ("/objects/0/id", json!(0)),
        ("/objects/0/id", json!(65536)),
        ("/objects/0/objectness", json!(1.01)),
        ("/objects/0/parts/support", json!(-0.01)),
        ("/objects/0/size_px", json!(0)),
        ("/objects/0/box_px/width", json!(0)),
        ("/objects/0/box_m/extents_m", json!([0.1, -0.1, 0.1])),
        ("/objects/0/box_m/rotation_xyzw", json!([0.0, 0.0, 1.0])),
        ("/objects/0/parents/0", json!(-1)),
        ("/support/nodes/1/object", json!(0)),
        ("/support/edges/0/lower", json!(-1)),
    ] {
        let mut broken = example();
        *broken.pointer_mut(place).unwrap() = value.clone();
        assert!(!validator.is_valid(&broken), "{place} = {value}");
    }
}

#[test]
fn what_is_not_finite_is_never_written() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut discovery = discovery();
        discovery.objects[0].box_m.extents_m[2] = bad;
        let scene = SceneFile::new("a.pcd", &capture(), &Params::default(), &discovery);
        let error = scene.to_json().unwrap_err();
        assert!(
            matches!(&error, Error::NotFinite { place } if place == ".objects[0].box_m.extents_m[2]"),
            "{error}"
        );
    }
}

#[test]
fn every_entry_is_described() {
    let schema: Value = serde_json::from_str(&schema()).unwrap();
    let objects = schema["$defs"].as_object().unwrap().values().chain([&schema]);
    for properties in objects.filter_map(|object| object["properties"].as_object()) {
        for (name, property) in properties {
            assert!(property["description"].is_string(), "{name} has no description");
        }
    }
}
