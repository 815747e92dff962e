//! Our reader against `pcd-rs`: what it writes we read, and what we read it reads too.
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use common::{ENCODINGS, data_folder, pcd_file, small_file};
use objecthood_io::formats::pcd;
use pcd_rs::{DataKind, DynReader, Field, ValueKind};
use proptest::prelude::*;

/// One point as it goes into the file.
#[derive(Clone, Copy, Debug)]
struct Point {
    xyz: [f32; 3],
    rgb: [u8; 3],
    alpha: u8,
    label: u8,
}

fn point() -> impl Strategy<Value = Point> {
    (any::<[f32; 3]>(), any::<[u8; 3]>(), any::<u8>(), 0..128_u8).prop_map(|(xyz, rgb, alpha, label)| Point {
        xyz,
        rgb,
        alpha,
        label,
    })
}

/// A field in the file: its declaration and how it takes its value from a point.
#[derive(Clone, Copy, Debug)]
enum Role {
    Axis(usize, ValueKind),
    Color(&'static str, ValueKind),
    Label(ValueKind),
    Other(&'static str, ValueKind, u64),
}

impl Role {
    fn declaration(self) -> (&'static str, ValueKind, u64) {
        match self {
            Self::Axis(axis, kind) => (["x", "y", "z"][axis], kind, 1),
            Self::Color(name, kind) => (name, kind, 1),
            Self::Label(kind) => ("label", kind, 1),
            Self::Other(name, kind, count) => (name, kind, count),
        }
    }

    fn value(self, point: &Point) -> Field {
        let [r, g, b] = point.rgb;
        match self {
            Self::Axis(axis, ValueKind::F64) => Field::F64(vec![point.xyz[axis].into()]),
            Self::Axis(axis, _) => Field::F32(vec![point.xyz[axis]]),
            // Without alpha, or the float might be a NaN, of which text keeps no bits.
            Self::Color(_, ValueKind::F32) => {
                Field::F32(vec![f32::from_bits(u32::from_be_bytes([0, r, g, b]))])
            }
            Self::Color(..) => Field::U32(vec![u32::from_be_bytes([point.alpha, r, g, b])]),
            Self::Label(kind) | Self::Other(_, kind, 1) => number(kind, &[point.label]),
            Self::Other(_, kind, count) => number(kind, &vec![7; count as usize]),
        }
    }
}

fn number(kind: ValueKind, values: &[u8]) -> Field {
    fn all<T: From<u8>>(values: &[u8]) -> Vec<T> {
        values.iter().map(|&value| value.into()).collect()
    }
    match kind {
        ValueKind::U8 => Field::U8(all(values)),
        ValueKind::U16 => Field::U16(all(values)),
        ValueKind::U32 => Field::U32(all(values)),
        ValueKind::U64 => Field::U64(all(values)),
        ValueKind::I8 => Field::I8(values.iter().map(|&value| value as i8).collect()),
        ValueKind::I16 => Field::I16(all(values)),
        ValueKind::I32 => Field::I32(all(values)),
        ValueKind::I64 => Field::I64(all(values)),
        ValueKind::F32 => Field::F32(all(values)),
        ValueKind::F64 => Field::F64(all(values)),
    }
}

fn roles() -> impl Strategy<Value = Vec<Role>> {
    use ValueKind::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
    let float = || prop_oneof![Just(F32), Just(F64)];
    let color = prop::option::of(prop_oneof![
        Just(Role::Color("rgb", F32)),
        Just(Role::Color("rgb", U32)),
        Just(Role::Color("rgba", U32)),
    ]);
    let label = prop::option::of(
        prop::sample::select(vec![U8, U16, U32, U64, I8, I16, I32, I64]).prop_map(Role::Label),
    );
    let others = prop::sample::subsequence(
        vec![
            Role::Other("normal", F32, 3),
            Role::Other("ring", U8, 1),
            Role::Other("_", U8, 5),
            Role::Other("t", F64, 1),
        ],
        0..=4,
    );
    let xyz = (float(), float(), float()).prop_map(|(x, y, z)| [x, y, z]);
    (xyz, color, label, others).prop_flat_map(|(xyz, color, label, others)| {
        let axes = xyz.into_iter().enumerate().map(|(axis, kind)| Role::Axis(axis, kind));
        let all: Vec<Role> = axes.chain(color).chain(label).chain(others).collect();
        Just(all).prop_shuffle()
    })
}

fn bits(points_m: &[[f32; 3]]) -> Vec<[u32; 3]> {
    // Text keeps no bits of a NaN.
    points_m.iter().map(|point| point.map(|x| if x.is_nan() { f32::NAN } else { x }.to_bits())).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_pcd_rs_writes_is_read(
        roles in roles(),
        rows in 1..5_usize,
        row in prop::collection::vec(point(), 1..20),
        encoding in prop::sample::select(ENCODINGS.to_vec()),
    ) {
        let points = row.repeat(rows);
        let schema: Vec<_> = roles.iter().map(|role| role.declaration()).collect();
        let records = points.iter().map(|point| roles.iter().map(|role| role.value(point)).collect());
        let file = pcd_file((row.len() as u64, rows as u64), encoding, &schema, records.collect());

        let cloud = pcd::parse(&file).unwrap();
        prop_assert_eq!((cloud.width, cloud.height), (row.len(), rows));
        prop_assert_eq!(bits(&cloud.points_m), bits(&points.iter().map(|point| point.xyz).collect::<Vec<_>>()));
        let has_color = roles.iter().any(|role| matches!(role, Role::Color(..)));
        prop_assert_eq!(cloud.color, has_color.then(|| points.iter().map(|point| point.rgb).collect::<Vec<_>>()));
        let has_label = roles.iter().any(|role| matches!(role, Role::Label(_)));
        prop_assert_eq!(cloud.label, has_label.then(|| points.iter().map(|point| point.label.into()).collect::<Vec<_>>()));
    }
}

#[test]
fn all_encodings_say_the_same() {
    let [ascii, binary, compressed] = ENCODINGS.map(|encoding| pcd::parse(&small_file(encoding)).unwrap());
    assert_eq!(bits(&ascii.points_m), bits(&binary.points_m));
    assert_eq!(bits(&compressed.points_m), bits(&binary.points_m));
    assert_eq!((&ascii.color, &ascii.label), (&binary.color, &binary.label));
    assert_eq!((&compressed.color, &compressed.label), (&binary.color, &binary.label));
    assert_eq!(binary.color.unwrap()[1], [0x10, 0x20, 0x31]);
}

#[test]
fn a_real_scene_is_read_alike() {
    let Some(data) = data_folder() else { return };
    let file = std::fs::read(data.join("mosd/learn/learn0.pcd")).unwrap();
    let ours = pcd::parse(&file).unwrap();
    let (color, label) = (ours.color.unwrap(), ours.label.unwrap());
    let mut count = 0;
    for (i, record) in DynReader::from_bytes(&file).unwrap().enumerate() {
        let record = record.unwrap().0;
        let [Field::U32(l), Field::F32(x), Field::F32(y), Field::F32(z), Field::U32(rgba)] =
            record.as_slice()
        else {
            panic!("{record:?}")
        };
        let theirs = [x[0], y[0], z[0]];
        assert_eq!(ours.points_m[i].map(f32::to_bits), theirs.map(f32::to_bits), "point {i}");
        assert_eq!(
            u32::from_be_bytes([0, color[i][0], color[i][1], color[i][2]]),
            rgba[0] & 0xff_ffff,
            "point {i}"
        );
        assert_eq!(label[i], l[0], "point {i}");
        count += 1;
    }
    assert_eq!(count, 640 * 480);
}

#[test]
fn a_colour_in_text_is_read_by_its_type_as_the_point_cloud_library_does() {
    let color = |kind: char, text: &str| {
        let file = format!(
            "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F {kind}\nCOUNT 1 1 1 1\n\
             WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n0.5 0.25 1 {text}\n"
        );
        pcd::parse(file.as_bytes()).map(|cloud| cloud.color.unwrap()[0])
    };
    assert_eq!(color('U', "4210752"), Ok([0x40, 0x40, 0x40]));
    assert_eq!(color('U', "4286611584"), Ok([0x80, 0x80, 0x80]));
    assert_eq!(color('I', "-1"), Ok([255, 255, 255]));
    // The bits of the float 4210800 are 4a80_80e0.
    assert_eq!(color('F', "4.2108e+06"), Ok([0x80, 0x80, 0xe0]));
    assert_eq!(color('F', "4210800"), Ok([0x80, 0x80, 0xe0]));
    // A colour without alpha is a denormal float.
    assert_eq!(color('F', &f32::from_bits(0x00_12_34_56).to_string()), Ok([0x12, 0x34, 0x56]));
    assert!(
        color('U', "4.2108e+06").unwrap_err().to_string().contains("rgb is `4.2108e+06`, which is no U4")
    );
}

#[test]
fn negative_labels_mean_none_and_too_large_ones_are_refused() {
    let read = |kind: ValueKind, label: Field| {
        let schema = [
            ("x", ValueKind::F32, 1),
            ("y", ValueKind::F32, 1),
            ("z", ValueKind::F32, 1),
            ("label", kind, 1),
        ];
        let xyz = || Field::F32(vec![1.0]);
        pcd::parse(&pcd_file((1, 1), DataKind::Binary, &schema, vec![vec![xyz(), xyz(), xyz(), label]]))
            .map(|cloud| cloud.label.unwrap()[0])
    };
    assert_eq!(read(ValueKind::I8, Field::I8(vec![-1])), Ok(0));
    assert_eq!(read(ValueKind::I16, Field::I16(vec![-300])), Ok(0));
    assert_eq!(read(ValueKind::I32, Field::I32(vec![i32::MAX])), Ok(i32::MAX as u32));
    assert_eq!(read(ValueKind::I64, Field::I64(vec![i64::MIN])), Ok(0));
    assert_eq!(read(ValueKind::U32, Field::U32(vec![u32::MAX])), Ok(u32::MAX));
    assert_eq!(read(ValueKind::U64, Field::U64(vec![1 << 32])), Err(pcd::PcdError::LabelTooLarge));
}
