//! The labels of mOSD learn, which must not change by accident. Its data is not ours to commit, so hashes stand for maps.
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::LazyLock;

use common::{data_folder, decode, open};
use objecthood::{Frame, Method, Params, Raster, discover};

fn labels(frame: &Frame, method: Method) -> Raster<u16> {
    discover(frame, &Params { method, ..Params::default() }).unwrap().labels
}

/// FNV-1a over the labels, low byte first, of objects numbered by their first pixels: what is an object and how sure it is change apart.
fn hash(labels: &Raster<u16>) -> u64 {
    let mut numbers = BTreeMap::from([(0, 0)]);
    let numbered = labels.as_slice().iter().map(|label| {
        let next = numbers.len() as u16;
        *numbers.entry(*label).or_insert(next)
    });
    numbered.flat_map(u16::to_le_bytes).fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// The scenes of learn, read once; none without the data.
static LEARN: LazyLock<Option<Vec<Frame>>> = LazyLock::new(|| {
    let data = data_folder()?;
    let scene = |k| open(&data.join(format!("mosd/learn/learn{k}.pcd")), None).unwrap().frame;
    Some((0..45).map(scene).collect())
});

/// The hash of every scene's labels, a line each.
fn hashes(method: Method) -> Option<String> {
    let mut hashes = String::new();
    for (k, frame) in LEARN.as_ref()?.iter().enumerate() {
        writeln!(hashes, "learn{k} {:016x}", hash(&labels(frame, method))).unwrap();
    }
    Some(hashes)
}

/// When a change is meant to alter labels: `INSTA_UPDATE=always cargo test -p objecthood-io --test mosd_labels`.
#[test]
fn labels_of_learn_are_as_they_were() {
    let Some(hashes) = hashes(Method::Paper) else { return };
    insta::assert_snapshot!(hashes);
}

/// On any number of threads. `objecthood-eval/tests/reference.rs` compares with the reference, without what is ours.
#[test]
fn labels_of_learn_by_context_are_as_they_were() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| hashes(Method::Context))
    };
    let Some(one) = on(1) else { return };
    assert!([2, 8].into_iter().all(|threads| on(threads).as_ref() == Some(&one)));
    insta::assert_snapshot!(one);
}

/// A cloud that lost its grid, and with it the colours of pixels without depth, has the labels it had before.
#[test]
fn a_flattened_scene_has_the_same_labels() {
    let Some(data) = data_folder() else { return };
    let kinect = "525,525,319.5,239.5".parse().unwrap();
    for k in [0, 9, 19, 28, 44] {
        let file = std::fs::read(data.join(format!("mosd/learn/learn{k}.pcd"))).unwrap();
        let size = b"WIDTH 640\nHEIGHT 480\n";
        let at = file.windows(size.len()).position(|window| window == size).unwrap();
        let list = [&file[..at], b"WIDTH 307200\nHEIGHT 1\n", &file[at + size.len()..]].concat();
        let (grid, again) = (decode(&file, None).unwrap(), decode(&list, Some(&kinect)).unwrap());
        assert_ne!(grid.frame.color(), again.frame.color(), "the file has colours without depth");
        for method in [Method::Paper, Method::Context] {
            let [grid, again] = [&grid, &again].map(|capture| labels(&capture.frame, method));
            assert!(grid == again, "learn{k} by {method}");
        }
    }
}
