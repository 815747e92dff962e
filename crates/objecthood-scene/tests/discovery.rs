//! The method on synthetic scenes.

use objecthood::{Params, discover};
use objecthood_scene::{Family, Sensor, generate, render};

/// Counts objects of the truth that one found object covers with an intersection over union of at least a half.
#[test]
fn the_method_finds_objects() {
    let (mut there, mut found) = (0, 0);
    for (family, seeds) in [(Family::Single, 0..4), (Family::Tabletop, 0..4), (Family::Stacked, 0..2)] {
        for seed in seeds {
            let world = generate(family, seed);
            let seen = render(&world, Sensor::Kinect).unwrap();
            let discovery = discover(&seen.frame, &Params::default()).unwrap();
            for object in world.objects() {
                let truth = seen.truth.instance.as_slice();
                let own = truth.iter().filter(|&&k| k == object).count();
                let best = discovery.objects.iter().map(|candidate| {
                    let pairs = truth.iter().zip(discovery.labels.as_slice());
                    let both = pairs.filter(|&(&k, &label)| k == object && label == candidate.id.0).count();
                    both as f64 / (own + candidate.size_px - both) as f64
                });
                there += 1;
                found += usize::from(best.fold(0.0, f64::max) >= 0.5);
            }
        }
    }
    println!("{found} of {there} objects found");
    assert!(found * 2 > there, "{found} of {there} objects found");
}
