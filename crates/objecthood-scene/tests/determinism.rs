//! The same seed, the same bytes.
#![allow(clippy::unwrap_used, reason = "what fails is reported so")]

use objecthood_scene::{Family, Rendered, Sensor, export, generate, render};

/// Fowler, Noll and Vo's hash.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

fn bytes(family: Family, seed: u64, sensor: Sensor) -> Vec<u8> {
    let world = generate(family, seed);
    let rendered = &render(&world, sensor).unwrap();
    let Rendered { frame, truth, .. } = rendered;
    let mut bytes: Vec<u8> =
        frame.depth_m().as_slice().iter().flat_map(|z| z.to_bits().to_le_bytes()).collect();
    bytes.extend(frame.color().unwrap().as_slice().as_flattened());
    bytes.extend(
        truth.instance.as_slice().iter().chain(truth.surface.as_slice()).flat_map(|k| k.to_le_bytes()),
    );
    bytes.extend(export::scene_json(family, sensor, &world, rendered).unwrap().into_bytes());
    bytes
}

#[test]
fn threads_do_not_matter() {
    for (family, sensor) in
        [(Family::Clutter, Sensor::Kinect), (Family::Vessels, Sensor::Stereo), (Family::Single, Sensor::Tof)]
    {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| bytes(family, 5, sensor))
        };
        let one = with(1);
        assert!(one == with(2) && one == with(8), "{family} {sensor}");
    }
}

/// Pinned: these bytes were made on x86-64 Linux; every machine must make them. They change when a model is changed.
#[test]
fn machines_do_not_matter() {
    let hashes: Vec<u64> = [
        (Family::Tabletop, Sensor::Kinect),
        (Family::Stacked, Sensor::Stereo),
        (Family::Vessels, Sensor::Tof),
    ]
    .map(|(family, sensor)| hash(&bytes(family, 1, sensor)))
    .into();
    assert_eq!(hashes, [16_450_579_786_232_791_778, 7_315_356_473_804_660_420, 6_867_643_847_569_980_096]);
}

#[test]
fn seeds_matter() {
    assert_ne!(bytes(Family::Tabletop, 1, Sensor::Ideal), bytes(Family::Tabletop, 2, Sensor::Ideal));
}
