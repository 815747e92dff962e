//! `objecthood segment` on unorganized clouds: a virtual camera, and a label for every point.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use std::collections::BTreeMap;
use std::path::Path;

use common::Folder;
use objecthood_io::formats::pcd;
use objecthood_io::label_image;

/// A list of points with their colours, and the label that the same points have as an image.
struct List {
    points_m: Vec<[f32; 3]>,
    colors: Vec<[u8; 3]>,
    labels: Vec<u16>,
    /// VIEWPOINT of the file.
    viewpoint: &'static str,
}

impl List {
    /// The points of an organized cloud in no order, without the missing ones.
    fn of(cloud: &Path, labels: &[u8]) -> Self {
        let cloud = pcd::parse(&std::fs::read(cloud).unwrap()).unwrap();
        let (points_m, colors) = (cloud.points_m, cloud.color.unwrap());
        let labels = label_image::decode(labels).unwrap();
        let count = points_m.len();
        // A step that is no divisor of the count meets every point once.
        let step = (1..).map(|k| 123_457 + k).find(|&step| gcd(step, count) == 1).unwrap();
        let order = (0..count).map(|k| k * step % count).filter(|&k| points_m[k][2] > 0.0);
        let order: Vec<usize> = order.collect();
        Self {
            points_m: order.iter().map(|&k| points_m[k]).collect(),
            colors: order.iter().map(|&k| colors[k]).collect(),
            labels: order.iter().map(|&k| labels[k]).collect(),
            viewpoint: "0 0 0 1 0 0 0",
        }
    }

    /// Points that are all black, with no known label.
    fn of_black(points_m: Vec<[f32; 3]>, viewpoint: &'static str) -> Self {
        Self { colors: vec![[0; 3]; points_m.len()], points_m, labels: Vec::new(), viewpoint }
    }

    fn map(&self, viewpoint: &'static str, change: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let change = |point: &[f32; 3]| change(point.map(f64::from)).map(|part| part as f32);
        Self {
            points_m: self.points_m.iter().map(change).collect(),
            colors: self.colors.clone(),
            labels: self.labels.clone(),
            viewpoint,
        }
    }

    /// Every third of the points, which are in no order.
    fn thinned(&self) -> Self {
        Self {
            points_m: self.points_m.iter().step_by(3).copied().collect(),
            colors: self.colors.iter().step_by(3).copied().collect(),
            labels: self.labels.iter().step_by(3).copied().collect(),
            viewpoint: self.viewpoint,
        }
    }

    /// As PCD, `DATA binary`, with a missing point behind the last.
    fn to_pcd(&self) -> Vec<u8> {
        let count = self.points_m.len() + 1;
        let mut bytes = format!(
            "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nWIDTH {count}\nHEIGHT 1\nVIEWPOINT {}\nPOINTS {count}\nDATA binary\n",
            self.viewpoint
        )
        .into_bytes();
        let points = self.points_m.iter().zip(&self.colors).chain([(&[f32::NAN; 3], &[0; 3])]);
        for (point_m, [r, g, b]) in points {
            point_m.iter().for_each(|part| bytes.extend(part.to_le_bytes()));
            bytes.extend([*b, *g, *r, 0]);
        }
        bytes
    }

    /// What `segment` says of the list: the share of points with the label that they have in the image, when each object
    /// has the number of the object that it overlaps most, and the least IoU of an object; and the notice.
    fn judge(&self, folder: &Folder, name: &str) -> (f64, f64, String) {
        folder.write(&format!("{name}.pcd"), &self.to_pcd());
        let run = folder.run(&format!("segment {name}.pcd --out out"), 0);
        let answer = pcd::parse(&folder.files("out")[&format!("{name}.labels.pcd")]).unwrap();
        assert_eq!(answer.points_m.len(), self.points_m.len() + 1);
        assert_eq!(answer.points_m[..self.points_m.len()], self.points_m, "the points, in their order");
        let found = answer.label.unwrap();
        assert_eq!(found.last(), Some(&0), "a missing point is no object");
        let (agreement, iou) = compare(&self.labels, &found);
        (agreement, iou, run.stderr)
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

fn compare(known: &[u16], found: &[u32]) -> (f64, f64) {
    let mut both = BTreeMap::new();
    let (mut of_known, mut of_found) = (BTreeMap::new(), BTreeMap::new());
    for (&a, &b) in known.iter().zip(found) {
        *both.entry((a, b)).or_insert(0.0) += 1.0;
        *of_known.entry(a).or_insert(0.0) += 1.0;
        *of_found.entry(b).or_insert(0.0) += 1.0;
    }
    let (mut agreement, mut least) = (0.0, 1.0_f64);
    for (&a, &count) in &of_known {
        let pairs = both.iter().filter(|((k, f), _)| *k == a && (a == 0) == (*f == 0));
        let iou = |f: u32, n: f64| n / (count + of_found[&f] - n);
        let best =
            pairs.map(|(&(_, f), &n)| (iou(f, n), n)).fold((0.0, 0.0), |x, y| if y.0 > x.0 { y } else { x });
        agreement += best.1;
        least = if a > 0 { least.min(best.0) } else { least };
    }
    (agreement / known.len() as f64, least)
}

/// Turns a point by an angle whose cosine and sine are 0.8 and 0.6.
fn roll([x, y, z]: [f64; 3]) -> [f64; 3] {
    [0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y, z]
}

#[test]
fn a_list_of_the_points_of_an_image_gives_the_objects_of_the_image() {
    let folder = Folder::new();
    folder.run("synth --family tabletop --scenes 3 --seed 6 --out s", 0);
    folder.run("segment s/tabletop --out whole", 0);
    // Of scene 9 the image shows a seam between a can and a box, and a third of the points does not.
    for seed in 6..9 {
        let name = format!("tabletop{seed}");
        let cloud = folder.path().join(format!("s/tabletop/{name}.pcd"));
        let list = List::of(&cloud, &folder.files("whole")[&format!("{name}.labels.png")]);
        let quarter = "1 2 3 0.5 0.5 0.5 0.5";
        // The rotation of that quaternion takes x to y, y to z and z to x.
        let in_world = |[x, y, z]: [f64; 3]| [z + 1.0, x + 2.0, y + 3.0];
        let none = "0 0 0 1 0 0 0";
        // Other pixels cut things otherwise, so an object may lose a part.
        for (kind, list, least_iou) in [
            ("shuffled", list.map(none, |p| p), 0.99),
            ("in the world, with a viewpoint", list.map(quarter, in_world), 0.99),
            ("with a viewpoint, in the frame of the camera", list.map(quarter, |p| p), 0.99),
            ("of computer graphics", list.map(none, |[x, y, z]| [x, -y, -z]), 0.99),
            ("rolled, so without pixels", list.map(none, roll), 0.6),
            ("x forward, z up", list.map(none, |[x, y, z]| [z, -x, -y]), 0.6),
            ("thinned", list.thinned(), 0.6),
        ] {
            let (agreement, iou, said) = list.judge(&folder, &name);
            println!("{name} {kind}: {agreement:.3} {iou:.3} {}", said.trim());
            assert!(said.contains("no camera is given"), "{kind}: {said}");
            assert!(agreement >= 0.95 && iou >= least_iou, "{name} {kind}: {agreement} {iou}");
        }
    }
}

#[test]
fn a_real_frame_as_a_list_gives_the_objects_of_the_image() {
    let Some(mosd) = common::mosd() else { return };
    let folder = Folder::new();
    for name in ["learn0", "learn33"] {
        let cloud = mosd.join(format!("learn/{name}.pcd"));
        folder.run(&format!("segment {} --out whole", cloud.display()), 0);
        let list = List::of(&cloud, &folder.files("whole")[&format!("{name}.labels.png")]);
        for (kind, list) in
            [("shuffled", list.map("0 0 0 1 0 0 0", |p| p)), ("rolled", list.map("0 0 0 1 0 0 0", roll))]
        {
            let (agreement, iou, said) = list.judge(&folder, name);
            println!("{name} {kind}: {agreement:.3} {iou:.3} {}", said.trim());
            assert!(agreement >= 0.95 && iou >= 0.8, "{name} {kind}: {agreement} {iou}");
        }
    }
}

#[test]
fn points_all_around_are_refused_with_advice() {
    let folder = Folder::new();
    let around = |k: usize| {
        let (sin, cos) = (k as f32 / 100.0).sin_cos();
        [cos, (k % 37) as f32 / 37.0, sin]
    };
    let points_m = (0..628).map(around).collect();
    let list = List::of_black(points_m, "0 0 0 1 0 0 0");
    folder.write("around.pcd", &list.to_pcd());
    let run = folder.run("segment around.pcd --out out", 1);
    assert!(run.stderr.contains("span more than 120 degrees"), "{}", run.stderr);
    assert!(run.stderr.contains("--camera"), "{}", run.stderr);
    assert!(folder.names("out").is_empty());
}

#[test]
fn few_points_are_no_error() {
    let folder = Folder::new();
    for count in [2, 3, 10, 30] {
        let points_m = (0..count).map(|k| [k as f32 / 50.0, (k * k % 7) as f32 / 50.0, 1.0]).collect();
        let list = List::of_black(points_m, "0 0 0 0 0 0 0");
        folder.write("few.pcd", &list.to_pcd());
        folder.run("segment few.pcd --out out", 0);
        let answer = pcd::parse(&folder.files("out")["few.labels.pcd"]).unwrap();
        assert_eq!(answer.label.unwrap(), vec![0; count + 1]);
    }
}

#[test]
fn answers_of_an_earlier_run_are_no_inputs() {
    let folder = Folder::new();
    let points_m = (0..100).map(|k| [(k % 10) as f32 / 50.0, (k / 10) as f32 / 50.0, 1.0]).collect();
    let list = List::of_black(points_m, "0 0 0 1 0 0 0");
    folder.write("in/few.pcd", &list.to_pcd());
    for _ in 0..2 {
        folder.run("segment in --out in", 0);
        assert_eq!(folder.names("in"), ["few.json", "few.labels.pcd", "few.labels.png", "few.pcd"]);
    }
}
