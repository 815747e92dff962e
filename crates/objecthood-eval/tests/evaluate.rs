//! Many scenes at once: order, settings, errors.

use std::fs;
use std::path::Path;

use objecthood::{Camera, Observer, Output, Raster, Segments};
use objecthood_eval::{
    Error, LabelFolder, Prediction, Scene, SceneRef, Split, StageObserver, evaluate, evaluate_settings,
    scenes,
};
use objecthood_io::label_image;

const SIDE: usize = 12;

/// A scene in which the first `object` columns are one object and the rest is table.
fn write_scene(path: &Path, object: usize) {
    let camera = Camera { fx_px: 20.0, fy_px: 20.0, cx_px: 5.5, cy_px: 5.5 };
    let points = (0..SIDE * SIDE).map(|i| {
        let [x, y, z] = camera.back_project(i % SIDE, i / SIDE, 1.0 + i as f32 / 1000.0);
        format!("{x} {y} {z} {}\n", if i % SIDE < object { 20 } else { 1 })
    });
    let header = format!(
        "VERSION 0.7\nFIELDS x y z label\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH {SIDE}\nHEIGHT {SIDE}\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA ascii\n",
        SIDE * SIDE
    );
    fs::write(path, header + &points.collect::<String>()).expect("a scene is written");
}

/// Twenty scenes, so that there are more than threads; the object grows from scene to scene.
fn data_set() -> (tempfile::TempDir, Vec<SceneRef>) {
    let root = tempfile::tempdir().expect("a folder");
    fs::create_dir(root.path().join("few")).expect("a folder");
    for k in 0..20 {
        write_scene(&root.path().join(format!("few/s{k}.pcd")), 1 + k % 11);
    }
    let scenes = scenes(root.path(), &Split::All).expect("scenes");
    (root, scenes)
}

/// The truth itself.
fn perfect(scene: &Scene) -> Prediction {
    let labels = scene.truth.labels().map(|&l| if l > 1 { l as u16 } else { 0 });
    Prediction { labels, objects: None, stages: None }
}

#[test]
fn scenes_are_reported_in_their_order() {
    let (_root, scenes) = data_set();
    let report = evaluate(&scenes, None, |scene, _| Ok::<_, Error>(perfect(scene))).unwrap();
    assert_eq!(report.total.counts.correct, 20);
    for (k, scene) in report.scenes.iter().enumerate() {
        assert_eq!((scene.name.as_str(), scene.folder.as_str()), (format!("s{k}").as_str(), "few"));
        assert_eq!(scene.score.objects[0].pixels, (1 + k % 11) * SIDE);
    }
}

#[test]
fn every_setting_has_a_report_with_its_stages() {
    let (_root, scenes) = data_set();
    let predict = |&found: &bool, scene: &Scene, _: &SceneRef| {
        let mut prediction = perfect(scene);
        if !found {
            prediction.labels.as_mut_slice().fill(0);
        }
        let mut observer = StageObserver::new(&scene.truth);
        let segments = Segments::from_labels(&prediction.labels.map(|&l| i32::from(l)));
        observer.observe(Output::Shapes((&segments).into()));
        Ok::<_, Error>(Prediction { stages: Some(observer.into_stages()?), ..prediction })
    };
    let reports = evaluate_settings(&scenes, None, &[true, false], predict).unwrap();
    let correct: Vec<_> = reports.iter().map(|r| r.total.counts.correct).collect();
    assert_eq!(correct, [20, 0]);
    let asa: Vec<_> = reports.iter().map(|r| r.total.stages.unwrap().shapes.unwrap().asa).collect();
    assert!(asa[0] == 1.0 && asa[1] < 1.0, "{asa:?}");
    assert!(reports.iter().all(|r| r.total.stages.unwrap().facets.is_none()));
}

#[test]
fn the_first_scene_that_fails_is_named() {
    let (root, scenes) = data_set();
    let labels = LabelFolder { path: root.path().to_owned(), suffix: ".labels.png".to_owned() };
    let write = |scene: &SceneRef| {
        let image = perfect(&scene.load(None).unwrap()).labels;
        fs::write(
            root.path().join(format!("{}.labels.png", scene.name)),
            label_image::encode(&image).unwrap(),
        )
        .unwrap();
    };
    scenes.iter().for_each(write);
    let run = || evaluate(&scenes, None, |_, scene| labels.read(scene));
    assert_eq!(run().unwrap().total.counts.correct, 20);

    fs::remove_file(root.path().join("s13.labels.png")).unwrap();
    fs::remove_file(root.path().join("s6.labels.png")).unwrap();
    let error = run().unwrap_err().to_string();
    assert!(error.contains("s6.labels.png: no label image for scene s6"), "{error}");

    fs::write(root.path().join("s5.labels.png"), "no image").unwrap();
    let error = run().unwrap_err().to_string();
    assert_eq!(error.matches("s5.labels.png").count(), 1, "{error}");

    let small = Raster::filled(3, 2, 1).unwrap();
    fs::write(root.path().join("s4.labels.png"), label_image::encode(&small).unwrap()).unwrap();
    let error = run().unwrap_err().to_string();
    assert!(error.contains("s4.pcd: the label image has 3x2 pixels, the truth 12x12"), "{error}");

    fs::write(root.path().join("few/s3.pcd"), "no cloud").unwrap();
    let error = run().unwrap_err().to_string();
    assert_eq!(error.matches("s3.pcd").count(), 1, "{error}");
}
