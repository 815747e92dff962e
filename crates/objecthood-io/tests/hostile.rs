//! Files that are broken or lie: one clear line each, no panic.
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use common::{ENCODINGS, decode, small_binary_ply, small_file, small_ply};
use objecthood_io::{Given, GridCamera, Source, camera_file};
use pcd_rs::DataKind;
use proptest::prelude::*;

/// The small file in text form, header and data apart.
fn split(file: &[u8]) -> (String, Vec<u8>) {
    let data = file.windows(5).position(|w| w == b"\nDATA").unwrap() + 1;
    let data = data + file[data..].iter().position(|&b| b == b'\n').unwrap() + 1;
    (String::from_utf8(file[..data].to_vec()).unwrap(), file[data..].to_vec())
}

/// The small file with a change to its header.
fn with_header(encoding: DataKind, from: &str, to: &str) -> Vec<u8> {
    let (header, data) = split(&small_file(encoding));
    assert!(header.contains(from), "{from}");
    [header.replace(from, to).into_bytes(), data].concat()
}

/// The small file with other data.
fn with_data(encoding: DataKind, data: &[u8]) -> Vec<u8> {
    let (header, _) = split(&small_file(encoding));
    [header.as_bytes(), data].concat()
}

/// The data of a `binary_compressed` file.
fn compressed(unpacked_size: u32, packed: &[u8]) -> Vec<u8> {
    [&(packed.len() as u32).to_le_bytes()[..], &unpacked_size.to_le_bytes(), packed].concat()
}

fn assert_told(file: &[u8], said: &str) {
    let message = decode(file, None).unwrap_err().to_string();
    assert!(message.contains(said), "expected `{said}`: {message}");
    assert!(!message.contains('\n') && message.len() < 300, "{message}");
}

#[test]
fn no_point_cloud_at_all() {
    assert_told(b"", "the file is empty");
    assert_told(b"\0\x01\xfe\xff noise", "not a file that objecthood reads");
    assert_told(b"#!/bin/sh\necho hello\n", "line 2 of the PCD header is `echo hello`");
    assert_told(b"# \n\xff\xfe\xfd\n", r"line 2 of the PCD header is `\xff\xfe\xfd`");
    assert_told(&[b"VERSION ".to_vec(), vec![b'x'; 100_000]].concat(), "without a DATA line");
}

#[test]
fn a_file_cut_at_every_header_line_and_within_its_data() {
    for encoding in ENCODINGS {
        let file = small_file(encoding);
        let (header, data) = split(&file);
        for (end, _) in header.match_indices('\n') {
            let cut = &file[..end];
            assert!(decode(cut, None).is_err(), "cut at {end}");
            if end + 1 < header.len() {
                assert_told(&file[..end + 1], "without a DATA line");
            }
        }
        // A text may end within the digits of its last number and still be one.
        let ascii = encoding == DataKind::Ascii;
        let enough = if ascii { data.iter().rposition(|&b| b == b' ').unwrap() + 2 } else { data.len() };
        for end in 0..enough {
            assert!(decode(&file[..header.len() + end], None).is_err(), "{encoding:?} cut at {end}");
        }
        assert!(decode(&file[..header.len() + enough], None).is_ok());
    }
}

#[test]
fn sizes_beyond_the_file() {
    let points = |points: u64| format!("POINTS {points}");
    for encoding in ENCODINGS {
        let (header, data) = split(&small_file(encoding));
        let count = header.lines().find(|line| line.starts_with("POINTS")).unwrap().to_owned();
        let claim = |width: &str, height: &str, points: &str| {
            let header = header.replace("WIDTH 4", width).replace("HEIGHT 3", height).replace(&count, points);
            [header.as_bytes(), &data].concat()
        };
        let said = if encoding == DataKind::BinaryCompressed { "needs 240000" } else { "promises at least" };
        assert_told(&claim("WIDTH 100", "HEIGHT 120", &points(12_000)), said);
        let most = claim("WIDTH 4294967295", "HEIGHT 4294967295", &points(4_294_967_295 * 4_294_967_295));
        assert_told(&most, "at most 2^28 are read");
        assert_told(
            &claim("WIDTH 4294967295", "HEIGHT 4294967295", &points(1)),
            "WIDTH 4294967295 times HEIGHT",
        );
        assert_told(&claim("WIDTH 0", "HEIGHT 3", &points(0)), "at least one point");
        assert_told(&claim("WIDTH 4", "HEIGHT 0", &points(0)), "at least one point");
        assert_told(
            &claim("WIDTH 99999999999999999999", "HEIGHT 1", &points(1)),
            "WIDTH `99999999999999999999`",
        );
        let wide = with_header(encoding, "COUNT 1 1", "COUNT 18446744073709551615 1");
        let said =
            if encoding == DataKind::BinaryCompressed { "needs 18446744073709551615" } else { "promises" };
        assert_told(&wide, said);
    }
}

#[test]
fn fields_that_contradict_themselves_or_are_missing() {
    for (from, to, said) in [
        ("SIZE 4 4", "SIZE 4 2", "field x has TYPE F with SIZE 2"),
        ("SIZE 4 4", "SIZE 4 3", "field x has TYPE F with SIZE 3"),
        ("SIZE 4 4", "SIZE 0 4", "field label has TYPE U with SIZE 0"),
        ("SIZE 4 4", "SIZE 4", "4 entries in SIZE"),
        ("FIELDS label x", "FIELDS label r", "no field x"),
        ("FIELDS label x", "FIELDS x x", "names field x twice"),
        ("FIELDS label", "FIELDS rgb", "both a field rgb and a field rgba"),
        ("VERSION .7", "VERSION 1", "VERSION `1`: expected 0.7"),
    ] {
        for encoding in ENCODINGS {
            assert_told(&with_header(encoding, from, to), said);
        }
    }
    // The size of a point stays as it was or becomes less, so that the data do suffice.
    for (from, to, said) in [
        ("TYPE U F", "TYPE U U", "field x is U4 with COUNT 1: it must be F4 or F8"),
        ("TYPE U F", "TYPE F F", "field label is F4 with COUNT 1: it must be U or I"),
        ("SIZE 4 4 4 4 4", "SIZE 4 4 4 4 2", "field rgba is U2 with COUNT 1: it must be U4 or F4"),
    ] {
        assert_told(&with_header(DataKind::Binary, from, to), said);
    }
    let triple = with_header(DataKind::Binary, "COUNT 1 1", "COUNT 1 3");
    assert_told(&[triple, vec![0; 8 * 12]].concat(), "field x is F4 with COUNT 3");
    assert_told(&with_header(DataKind::Ascii, "TYPE U F", "TYPE U U"), "x is `NaN`, which is no U4");
}

#[test]
fn wrong_lzf_data() {
    let kind = DataKind::BinaryCompressed;
    let size = 12 * 20;
    assert_told(&with_data(kind, b"1234567"), "promises at least 8 bytes");
    assert_told(
        &with_data(kind, &compressed(size + 1, &[0; 100])),
        "unpack to 241 bytes but the PCD header needs 240",
    );
    assert_told(&with_data(kind, &compressed(u32::MAX, &[0; 100])), "unpack to 4294967295 bytes");
    assert_told(&with_data(kind, &compressed(size, &[])), "too few for what they should unpack to");
    assert_told(&with_data(kind, &compressed(size, &[0; 100])), "unpack to less");
    assert_told(&with_data(kind, &compressed(size, &[0xff; 100])), "a copy from before the beginning");
    assert_told(&with_data(kind, &compressed(size, &[0, 0, 0xe0, 255, 0])), "unpack to more");
    assert_told(&with_data(kind, &compressed(size, &[31; 20])), "end within a piece");
    let mut longer = compressed(size, &[0; 100]);
    longer[..4].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_told(&with_data(kind, &longer), "promises at least 4294967303 bytes");
}

#[test]
fn wrong_text() {
    let (_, data) = split(&small_file(DataKind::Ascii));
    let text = String::from_utf8(data).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let changed = |k: usize, line: &str| {
        let mut lines = lines.clone();
        lines[k] = line;
        with_data(DataKind::Ascii, lines.join("\n").as_bytes())
    };
    // The data begin at line 12.
    assert_told(&changed(3, "1 2 3 4"), "line 15 of the PCD file is no point: it has fewer values");
    assert_told(&changed(3, "1 2 3 4 5 6"), "line 15 of the PCD file is no point: it has more values");
    assert_told(&changed(3, "1 2 tree 4 5"), "line 15 of the PCD file is no point: y is `tree`");
    assert_told(&changed(3, "-1 2 3 4 5"), "label is `-1`");
    assert_told(&changed(3, "1 2 3 4 4294967296"), "rgba is `4294967296`");
    assert_told(&changed(11, &" ".repeat(100)), "12 points but 11 lines");
}

#[test]
fn nothing_to_see() {
    let (_, data) = split(&small_file(DataKind::Ascii));
    let blind: Vec<String> = String::from_utf8(data)
        .unwrap()
        .lines()
        .map(|line| format!("{} nan nan nan 7", &line[..1]))
        .collect();
    let file = with_data(DataKind::Ascii, blind.join("\n").as_bytes());
    assert_told(&file, "no pixel has a valid depth");
    let camera: GridCamera = "4,4,1.5,1".parse().unwrap();
    assert!(decode(&file, Some(&camera)).unwrap_err().to_string().contains("no pixel has a valid depth"));
}

#[test]
fn a_single_point_is_an_image() {
    let file = b"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n0.1 0.2 2\n";
    let capture = decode(file, None).unwrap();
    assert_eq!(capture.frame.size(), (1, 1));
    let point = capture.frame.points_m()[0];
    assert!((point[0] - 0.1).abs() < 1e-6 && (point[1] - 0.2).abs() < 1e-6 && point[2] == 2.0, "{point:?}");
}

#[test]
fn what_follows_the_last_point_is_ignored() {
    for encoding in ENCODINGS {
        let file = small_file(encoding);
        let longer = [&file[..], b"\nwhatever"].concat();
        let (a, b) = (decode(&file, None).unwrap(), decode(&longer, None).unwrap());
        assert_eq!(a.truth, b.truth);
        assert_eq!(a.camera_fit, b.camera_fit);
    }
}

/// Good files of every format, seen by a camera `4,4,1.5,1` of 4 x 3 pixels. What is added here is cut and damaged as the
/// others are.
fn good_files() -> Vec<Vec<u8>> {
    let mut files = ENCODINGS.map(small_file).to_vec();
    files.extend([small_ply(), small_binary_ply()]);
    files
}

#[test]
fn every_good_file_is_read_and_cut_anywhere_it_is_sound() {
    for file in good_files() {
        let camera: GridCamera = "4,4,1.5,1".parse().unwrap();
        assert_eq!(decode(&file, Some(&camera)).unwrap().frame.size(), (4, 3));
        (0..file.len()).for_each(|end| assert_sound(&file[..end]));
    }
}

/// A change to a file.
#[derive(Clone, Debug)]
enum Damage {
    Set(prop::sample::Index, u8),
    Cut(prop::sample::Index),
    Insert(prop::sample::Index, Vec<u8>),
    Remove(prop::sample::Index, usize),
}

impl Damage {
    fn apply(&self, file: &mut Vec<u8>) {
        if file.is_empty() {
            return;
        }
        match self {
            Self::Set(at, value) => *at.get_mut(file.as_mut_slice()) = *value,
            Self::Cut(at) => file.truncate(at.index(file.len())),
            Self::Insert(at, bytes) => {
                let at = at.index(file.len());
                file.splice(at..at, bytes.iter().copied());
            }
            Self::Remove(at, count) => {
                let at = at.index(file.len());
                file.drain(at..file.len().min(at + count));
            }
        }
    }
}

fn damage() -> impl Strategy<Value = Damage> {
    prop_oneof![
        6 => (any::<prop::sample::Index>(), any::<u8>()).prop_map(|(at, value)| Damage::Set(at, value)),
        3 => (any::<prop::sample::Index>(), b'0'..=b'9').prop_map(|(at, value)| Damage::Set(at, value)),
        1 => any::<prop::sample::Index>().prop_map(Damage::Cut),
        1 => (any::<prop::sample::Index>(), prop::collection::vec(any::<u8>(), 1..20))
            .prop_map(|(at, bytes)| Damage::Insert(at, bytes)),
        1 => (any::<prop::sample::Index>(), 1..20_usize).prop_map(|(at, count)| Damage::Remove(at, count)),
    ]
}

/// Whatever the bytes: a frame with as many labels as pixels, or one line.
fn assert_sound(file: &[u8]) {
    let camera: GridCamera = "4,4,1.5,1".parse().unwrap();
    for camera in [None, Some(&camera)] {
        match decode(file, camera) {
            Ok(capture) => {
                assert!(capture.truth.is_none_or(|truth| truth.size() == capture.frame.size()));
                assert!(capture.camera_fit.is_none_or(|fit| fit.residual_px <= 0.5));
            }
            Err(error) => {
                let message = error.to_string();
                assert!(!message.contains('\n') && message.len() < 400, "{message}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes(
        head in prop::sample::select(vec!["", "VERSION .7\n", "ply\nformat ascii 1.0\n", "ply\nformat binary_big_endian 1.0\n", "PK\x03\x04"]),
        bytes in prop::collection::vec(any::<u8>(), 0..600),
    ) {
        assert_sound(&[head.as_bytes(), &bytes].concat());
    }

    #[test]
    fn damaged_files(
        mut file in prop::sample::select(good_files()),
        damages in prop::collection::vec(damage(), 1..6),
    ) {
        damages.iter().for_each(|damage| damage.apply(&mut file));
        assert_sound(&file);
    }

    #[test]
    fn damaged_data_under_a_good_header(
        encoding in prop::sample::select(ENCODINGS.to_vec()),
        damages in prop::collection::vec(damage(), 1..6),
    ) {
        let (header, mut data) = split(&small_file(encoding));
        damages.iter().for_each(|damage| damage.apply(&mut data));
        assert_sound(&[header.as_bytes(), &data].concat());
    }

    #[test]
    fn invented_headers(
        lines in prop::collection::vec(
            prop_oneof![
                "FIELDS( (x|y|z|rgb|rgba|label|_|n)){0,6}", "SIZE( [0-9]){0,6}", "TYPE( [FUI]){0,6}", "COUNT( [0-9]){0,6}",
                "WIDTH [0-9]{1,10}", "HEIGHT [0-9]{1,10}", "POINTS [0-9]{1,20}", "VIEWPOINT.*", "VERSION 0?\\.[67]",
            ],
            0..12,
        ),
        encoding in prop::sample::select(vec!["ascii", "binary", "binary_compressed"]),
        data in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        let header = format!("VERSION 0.7\n{}\nDATA {encoding}\n", lines.join("\n"));
        assert_sound(&[header.as_bytes(), &data].concat());
    }

    #[test]
    fn invented_ply_headers(
        lines in prop::collection::vec(
            prop_oneof![
                6 => "property (char|uchar|short|uint|float|double|float32) (x|y|z|red|green|blue|n)",
                1 => "property list (uchar|int|float) (int|half) (x|vertex_indices)",
                1 => "element (vertex|face) [0-9]{1,20}",
                1 => "(comment|obj_info).*",
            ],
            0..12,
        ),
        vertices in 0..5_u8,
        data in "([0-9.-]{1,4}[ \n]){0,80}",
    ) {
        let header = format!("ply\nformat ascii 1.0\nelement vertex {vertices}\n{}\nend_header\n", lines.join("\n"));
        assert_sound((header + &data).as_bytes());
    }
}

#[test]
fn wrong_ply() {
    let text = String::from_utf8(small_ply()).unwrap();
    let changed = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to).into_bytes()
    };
    assert_told(b"ply\n\xff\xfe\n", r"line 2 of the PLY header is `\xff\xfe`: expected one of");
    assert_told(&changed("ascii", "binary"), "expected `format`, one of ascii, binary_little_endian");
    let file = small_binary_ply();
    assert_told(&file[..file.len() - 20], "promises at least 209 bytes behind it");
    assert_told(&changed("end_header\n", ""), "line 13 of the PLY header is `");
    assert_told(&changed("vertex 11", "vertex 4294967295"), "at most 2^28 are read");
    assert_told(&changed("vertex 11", "vertex 268435456"), "promises at least 3221225471 bytes behind it");
    assert_told(
        &changed("vertex 11", "vertex 99999999999999999999"),
        "expected `element`, a name and how many",
    );
    // The face stands where the twelfth vertex is promised.
    assert_told(
        &changed("vertex 11", "vertex 12"),
        "line 25 of the PLY file is no vertex: it has fewer values",
    );
    assert_told(&changed("16 32 50", "16 32 tree"), "line 15 of the PLY file is no vertex: blue is `tree`");
    assert_told(&[&b"ply "[..], &[b'x'; 100_000]].concat(), "line 1 of the PLY header is `ply xxxxxxxx");
    let list = decode(text.as_bytes(), None).unwrap().list.unwrap();
    assert!(list.is_virtual && list.points_m.len() == 11);
}

const CAMERA: &str =
    r#"{"fx": 4, "fy": 4, "cx": 1.5, "cy": 1, "width": 4, "height": 3, "depth_scale": 1000}"#;

/// Camera files of other kinds.
const CAMERAS: [&str; 6] = [
    CAMERA,
    "header:\n  frame_id: \"c\"\nheight: 3\nwidth: 4\nk:\n- 4.0\n- 0.0\n- 1.5\n- 0.0\n- 4.0\n- 1.0\n- 0.0\n- 0.0\n- 1.0\n---\n",
    "%YAML:1.0\n---\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   data: [ 4., 0., 1.5, 0., 4., 1., 0.,\n       0., 1. ]\n",
    r#"{"0": {"cam_K": [4, 0, 1.5, 0, 4, 1, 0, 0, 1], "depth_scale": 0.1}}"#,
    "# K\n4 0 1.5\n0 4 1\n0 0 1\n",
    "4 4 1.5 1\n",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_camera_files(
        kind in prop::sample::select(CAMERAS.to_vec()),
        damages in prop::collection::vec(damage(), 1..6),
    ) {
        prop_assert!(camera_file::parse(kind.as_bytes()).is_ok());
        let mut file = kind.as_bytes().to_vec();
        damages.iter().for_each(|damage| damage.apply(&mut file));
        if let Err(error) = camera_file::parse(&file) {
            let message = error.to_string();
            prop_assert!(!message.contains('\n') && message.len() < 400, "{}", message);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever the lists of a folder say: a source whose frames, of which no image is there, are one line each, or one
    /// line for the folder.
    #[test]
    fn damaged_lists_of_a_folder(
        which in prop::sample::select(vec!["rgb.txt", "depth.txt", "groundtruth.txt"]),
        damages in prop::collection::vec(damage(), 1..6),
    ) {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in [
            ("rgb.txt", "# c\n1.0 rgb/1.png\n2.0 rgb/2.png\n"),
            ("depth.txt", "# d\n1.01 depth/1.png\n2.01 depth/2.png\n"),
            ("groundtruth.txt", "# p\n1.0 1 2 3 0 0 0 1\n2.0 1 2 3 0 0.6 0 0.8\n"),
            ("camera.json", CAMERA),
        ] {
            let mut content = content.as_bytes().to_vec();
            if name == which {
                damages.iter().for_each(|damage| damage.apply(&mut content));
            }
            std::fs::write(folder.path().join(name), content).unwrap();
        }
        let messages: Vec<String> = match Source::open(folder.path(), &Given::default()) {
            Ok(source) => {
                let notices: Vec<String> = source.notices().iter().map(ToString::to_string).collect();
                let errors = source.captures().map(|capture| capture.unwrap_err().to_string());
                notices.into_iter().chain(errors).collect()
            }
            Err(error) => vec![error.to_string()],
        };
        for message in messages {
            prop_assert!(!message.contains('\n') && message.len() < 600, "{}", message);
        }
    }
}
