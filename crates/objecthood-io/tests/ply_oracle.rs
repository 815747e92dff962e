//! Our reader against other programs: what `ply-rs-bw` writes, what `plyfile` wrote, and the cubes of the format's author.
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use common::{decode, small_file, small_ply};
use objecthood_io::formats::ply;
use pcd_rs::DataKind;
use ply_rs_bw::ply::{
    Addable, DefaultElement, ElementDef, Encoding, Ply, Property, PropertyDef, PropertyType, ScalarType,
};
use ply_rs_bw::writer::Writer;
use proptest::prelude::*;

/// One point as it goes into the file. Its coordinates are whole numbers where the type is.
#[derive(Clone, Copy, Debug)]
struct Point {
    xyz: [f32; 3],
    whole: [i8; 3],
    rgb: [u8; 3],
}

/// A property in the file, and how it takes its value from a point.
#[derive(Clone, Debug)]
enum Role {
    Axis(usize, ScalarType),
    Channel(usize, ScalarType),
    Other(&'static str, ScalarType),
    List(&'static str),
}

impl Role {
    fn name(&self) -> &'static str {
        match self {
            Self::Axis(axis, _) => ["x", "y", "z"][*axis],
            Self::Channel(channel, _) => ["red", "green", "blue"][*channel],
            Self::Other(name, _) | Self::List(name) => name,
        }
    }

    fn declaration(&self) -> PropertyDef {
        let kind = match self {
            Self::Axis(_, kind) | Self::Channel(_, kind) | Self::Other(_, kind) => {
                PropertyType::Scalar(kind.clone())
            }
            Self::List(_) => PropertyType::List(ScalarType::UChar, ScalarType::Int),
        };
        PropertyDef::new(self.name().to_owned(), kind)
    }

    fn value(&self, point: &Point) -> Property {
        match self {
            Self::Axis(axis, ScalarType::Float) => Property::Float(point.xyz[*axis]),
            Self::Axis(axis, ScalarType::Double) => Property::Double(point.xyz[*axis].into()),
            Self::Axis(axis, kind) => whole(kind, point.whole[*axis].into()),
            Self::Channel(channel, ScalarType::Float) => {
                Property::Float(f32::from(point.rgb[*channel]) / 255.0)
            }
            Self::Channel(channel, kind) => whole(kind, point.rgb[*channel].into()),
            Self::Other(_, kind) => whole(kind, 7),
            Self::List(_) => Property::ListInt(vec![-5; usize::from(point.rgb[0] % 4)]),
        }
    }

    /// What is to be read of a coordinate.
    fn coordinate(&self, point: &Point) -> f32 {
        match self.value(point) {
            Property::Char(value) => value.into(),
            Property::Short(value) => value.into(),
            Property::Int(value) => value as f32,
            Property::Float(value) => value,
            Property::Double(value) => value as f32,
            other => panic!("{other:?}"),
        }
    }
}

fn whole(kind: &ScalarType, value: i16) -> Property {
    match kind {
        ScalarType::Char => Property::Char(value as i8),
        ScalarType::UChar => Property::UChar(value as u8),
        ScalarType::Short => Property::Short(value),
        ScalarType::UShort => Property::UShort(value as u16),
        ScalarType::Int => Property::Int(value.into()),
        ScalarType::UInt => Property::UInt(value as u32),
        ScalarType::Float => Property::Float(value.into()),
        ScalarType::Double => Property::Double(value.into()),
    }
}

fn point() -> impl Strategy<Value = Point> {
    (any::<[f32; 3]>(), any::<[i8; 3]>(), any::<[u8; 3]>()).prop_map(|(xyz, whole, rgb)| Point {
        xyz,
        whole,
        rgb,
    })
}

fn roles() -> impl Strategy<Value = Vec<Role>> {
    use ScalarType::{Char, Double, Float, Int, Short, UChar, UInt, UShort};
    let axis = || prop::sample::select(vec![Float, Double, Char, Short, Int]);
    let channel = prop::option::of(prop::sample::select(vec![UChar, UShort, Short, Int, UInt, Float]));
    let others = prop::sample::subsequence(
        vec![
            Role::Other("nx", Float),
            Role::Other("alpha", UChar),
            Role::Other("t", Double),
            Role::List("near"),
        ],
        0..=4,
    );
    ([axis(), axis(), axis()], channel, others).prop_flat_map(|(xyz, channel, others)| {
        let axes = xyz.into_iter().enumerate().map(|(axis, kind)| Role::Axis(axis, kind));
        let color =
            channel.into_iter().flat_map(|kind| [0, 1, 2].map(|part| Role::Channel(part, kind.clone())));
        let all: Vec<Role> = axes.chain(color).chain(others).collect();
        Just(all).prop_shuffle()
    })
}

/// A file of these points, with a sensor before them and faces behind.
fn ply_file(encoding: Encoding, roles: &[Role], points: &[Point]) -> Vec<u8> {
    let sensor = [Role::Other("width", ScalarType::Int), Role::List("lens")];
    let face = [Role::List("vertex_indices")];
    let mut ply = Ply::<DefaultElement>::new();
    ply.header.encoding = encoding;
    ply.header.comments.push("of a test".to_owned());
    for (name, roles, points) in
        [("sensor", &sensor[..], &points[..1]), ("vertex", roles, points), ("face", &face, points)]
    {
        let mut element = ElementDef::new(name.to_owned());
        roles.iter().for_each(|role| element.properties.add(role.declaration()));
        ply.header.elements.add(element);
        let record = |point| roles.iter().map(|role| (role.name().to_owned(), role.value(point))).collect();
        ply.payload.insert(name.to_owned(), points.iter().map(record).collect());
    }
    let mut file = Vec::new();
    Writer::new().write_ply(&mut file, &mut ply).unwrap();
    file
}

fn bits(points_m: &[[f32; 3]]) -> Vec<[u32; 3]> {
    // Text keeps no bits of a NaN.
    points_m.iter().map(|point| point.map(|x| if x.is_nan() { f32::NAN } else { x }.to_bits())).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_ply_rs_writes_is_read(
        encoding in prop::sample::select(vec![Encoding::Ascii, Encoding::BinaryLittleEndian, Encoding::BinaryBigEndian]),
        roles in roles(),
        points in prop::collection::vec(point(), 1..20),
    ) {
        let cloud = ply::parse(&ply_file(encoding, &roles, &points)).unwrap();
        prop_assert_eq!((cloud.width, cloud.height), (points.len(), 1));
        let of_axis = |axis| roles.iter().find(|role| matches!(role, Role::Axis(found, _) if *found == axis)).unwrap();
        let xyz: Vec<_> = points.iter().map(|point| [0, 1, 2].map(|axis| of_axis(axis).coordinate(point))).collect();
        prop_assert_eq!(bits(&cloud.points_m), bits(&xyz));
        let has_color = roles.iter().any(|role| matches!(role, Role::Channel(..)));
        prop_assert_eq!(cloud.color, has_color.then(|| points.iter().map(|point| point.rgb).collect::<Vec<_>>()));
        prop_assert_eq!(cloud.label, None);
    }
}

/// The file that `plyfile` 1.1.5 for Python wrote of three points and a face.
#[test]
fn what_plyfile_wrote_is_read() {
    let file = "ply\nformat ascii 1.0\ncomment three points and a face\nobj_info note\nelement vertex 3\n\
        property float x\nproperty float y\nproperty double z\nproperty uchar red\nproperty uchar green\n\
        property uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0.5 -0.25 1.5 10 20 30\nnan 0 2 255 0 128\n\
        -0.00100000004749745131 0.333333343267440796 1.25 1 2 3\n3 0 1 2\n";
    let cloud = ply::parse(file.as_bytes()).unwrap();
    let points = [[0.5, -0.25, 1.5], [f32::NAN, 0.0, 2.0], [-1e-3, 1.0 / 3.0, 1.25]];
    assert_eq!(bits(&cloud.points_m), bits(&points));
    assert_eq!(cloud.color, Some(vec![[10, 20, 30], [255, 0, 128], [1, 2, 3]]));
}

/// The two cubes of Greg Turk's description of the format.
#[test]
fn the_cubes_of_the_description_are_read() {
    let corners = ["0 0 0", "0 0 1", "0 1 1", "0 1 0", "1 0 0", "1 0 1", "1 1 1", "1 1 0"];
    let faces = "4 0 1 2 3\n4 7 6 5 4\n4 0 4 5 1\n4 1 5 6 2\n4 2 6 7 3\n4 3 7 4 0\n";
    let plain = format!(
        "ply\nformat ascii 1.0\ncomment made by Greg Turk\ncomment this file is a cube\nelement vertex 8\n\
         property float x\nproperty float y\nproperty float z\nelement face 6\n\
         property list uchar int vertex_index\nend_header\n{}\n{faces}",
        corners.join("\n")
    );
    let cloud = ply::parse(plain.as_bytes()).unwrap();
    assert_eq!((cloud.points_m.len(), cloud.points_m[1], cloud.color), (8, [0.0, 0.0, 1.0], None));

    let red_and_blue = |i: usize| if i < 4 { "255 0 0" } else { "0 0 255" };
    let corners: Vec<_> = (0..8).map(|i| format!("{} {}", corners[i], red_and_blue(i))).collect();
    let colored = format!(
        "ply\nformat ascii 1.0\ncomment author: Greg Turk\ncomment object: another cube\nelement vertex 8\n\
         property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n\
         property uchar blue\nelement face 6\nproperty list uchar int vertex_index\nelement edge 5\n\
         property int vertex1\nproperty int vertex2\nproperty uchar red\nproperty uchar green\n\
         property uchar blue\nend_header\n{}\n{faces}0 1 255 255 255\n1 2 255 255 255\n2 3 255 255 255\n\
         3 0 255 255 255\n2 0 0 0 0\n",
        corners.join("\n")
    );
    let again = ply::parse(colored.as_bytes()).unwrap();
    assert_eq!(again.points_m, cloud.points_m);
    assert_eq!(again.color.unwrap()[3..5], [[255, 0, 0], [0, 0, 255]]);
}

/// A list of points goes to the pixels that see them, whatever the format.
#[test]
fn a_cloud_is_the_same_frame_as_pcd_and_as_ply() {
    let camera = "4,4,1.5,1".parse().unwrap();
    let [pcd, ply] =
        [small_file(DataKind::Binary), small_ply()].map(|file| decode(&file, Some(&camera)).unwrap());
    let bits = |capture: &objecthood_io::Capture| -> Vec<u32> {
        capture.frame.depth_m().as_slice().iter().map(|z| if z.is_nan() { 0 } else { z.to_bits() }).collect()
    };
    assert_eq!(bits(&ply), bits(&pcd));
    assert_eq!(ply.frame.color().unwrap().as_slice()[1..], pcd.frame.color().unwrap().as_slice()[1..]);
    assert!(ply.truth.is_none());
}
