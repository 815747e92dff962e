//! What is written is read back by the readers of the project.
#![allow(clippy::unwrap_used, reason = "what fails is reported so")]

use objecthood_eval::{Split, scenes};
use objecthood_io::{formats::pcd, label_image};
use objecthood_scene::{Family, Rendered, Role, Sensor, World, export, generate, render};

fn scene() -> (World, Rendered) {
    let world = generate(Family::Occluded, 1);
    let rendered = render(&world, Sensor::Kinect).unwrap();
    (world, rendered)
}

#[test]
fn a_point_cloud_comes_back() {
    let (world, rendered) = scene();
    let cloud = pcd::parse(&export::pcd(&world, &rendered, false)).unwrap();
    assert_eq!((cloud.width, cloud.height), (640, 480));
    assert_eq!(cloud.color.unwrap(), rendered.frame.color().unwrap().as_slice());
    let label = cloud.label.unwrap();
    let objects: Vec<u16> = world.objects().collect();
    for (i, point) in rendered.frame.points_m().as_slice().iter().enumerate() {
        assert_eq!(cloud.points_m[i].map(f32::to_bits), point.map(f32::to_bits));
        let instance = rendered.truth.instance[i];
        let expected =
            objects.iter().position(|&k| k == instance).map_or(u32::from(instance > 0), |k| k as u32 + 2);
        let found = if label[i] < 10 { label[i] } else { label[i] / 10 };
        assert_eq!(found, expected);
        assert_eq!(label[i] == 0, point[2].is_nan());
    }
}

#[test]
fn a_cropped_point_cloud_has_no_room() {
    let (world, rendered) = scene();
    let cloud = pcd::parse(&export::pcd(&world, &rendered, true)).unwrap();
    let label = cloud.label.unwrap();
    for (i, &k) in rendered.truth.instance.as_slice().iter().enumerate() {
        let in_room = world.solid(k).is_none_or(|solid| solid.role() == Role::Room);
        assert_eq!(label[i] == 0, in_room);
        assert_eq!(cloud.points_m[i][2].is_nan(), in_room);
    }
}

#[test]
fn eval_reads_the_point_cloud() {
    let (world, rendered) = scene();
    let root = tempfile::tempdir().unwrap();
    std::fs::create_dir(root.path().join("synthetic")).unwrap();
    std::fs::write(root.path().join("synthetic/scene0.pcd"), export::pcd(&world, &rendered, true)).unwrap();
    let scenes = scenes(root.path(), &Split::All).unwrap();
    let scene = scenes[0].load(None).unwrap();
    let (fit, given) = (scene.frame.camera(), rendered.frame.camera());
    assert!((fit.fx_px - given.fx_px).abs() < 0.01 && (fit.cy_px - given.cy_px).abs() < 0.01, "{fit:?}");
    let greatest = scene.truth.labels().as_slice().iter().max();
    assert_eq!(greatest, Some(&(world.objects().count() as u32 + 1)));
}

#[test]
fn images_come_back() {
    let (world, rendered) = scene();
    let truth = label_image::decode(&export::truth_png(&rendered).unwrap()).unwrap();
    assert_eq!(truth, rendered.truth.instance);
    let surfaces = label_image::decode(&export::surfaces_png(&rendered).unwrap()).unwrap();
    assert_eq!(surfaces, rendered.truth.surface);
    let color = image::load_from_memory(&export::color_png(&rendered.frame).unwrap()).unwrap();
    assert_eq!(color.into_rgb8().into_raw(), rendered.frame.color().unwrap().as_slice().as_flattened());
    let depth = label_image::decode(&export::depth_png(&rendered.frame).unwrap()).unwrap();
    for (&units, &z) in depth.as_slice().iter().zip(rendered.frame.depth_m().as_slice()) {
        let expected = if z.is_nan() { 0.0 } else { f64::from(z) };
        assert!((f64::from(units) / export::DEPTH_SCALE - expected).abs() <= 0.00005001, "{units} {z}");
    }
    let camera: serde_json::Value = serde_json::from_str(&export::camera_json(&world).unwrap()).unwrap();
    assert_eq!(
        (&camera["fx"], &camera["depth_scale"], &camera["height"]),
        (&525.0.into(), &10000.0.into(), &480.into())
    );
}

#[test]
fn the_scene_file_tells_the_truth() {
    let (world, rendered) = scene();
    let json = export::scene_json(Family::Occluded, Sensor::Kinect, &world, &rendered).unwrap();
    let scene: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(
        (&scene["family"], &scene["sensor"], &scene["seed"]),
        (&"occluded".into(), &"kinect".into(), &1.into())
    );
    let solids = scene["solids"].as_array().unwrap();
    assert_eq!(solids.len(), world.solids().len());
    assert_eq!(scene["contacts"].as_array().unwrap().len(), world.contacts().len());
    let mut next_surface = 1;
    for (k, solid) in solids.iter().enumerate() {
        assert_eq!(solid["instance"], k + 1);
        assert_eq!(solid["surfaces"][0], next_surface);
        next_surface = solid["surfaces"][1].as_u64().unwrap() + 1;
        let count = rendered.truth.instance.as_slice().iter().filter(|&&l| usize::from(l) == k + 1).count();
        assert_eq!(solid["size_px"], count);
        let visible = solid["visible_fraction"].as_f64().unwrap();
        assert!((visible - rendered.visible_fraction[k]).abs() < 1e-12);
    }
}
