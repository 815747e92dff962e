//! The support forest on synthetic scenes, of which the contacts are known.
#![allow(clippy::unwrap_used, reason = "what fails is reported so")]

use objecthood::Params;
use objecthood_eval::support::{FAMILIES, SceneSupport};
use objecthood_scene::Sensor;

/// Few scenes, so the floors lie below the figures of EVALUATION.md.
#[test]
fn most_edges_are_right_on_our_own_and_on_true_segments() {
    let mut sum = SceneSupport::default();
    for (family, seed) in FAMILIES.into_iter().zip(2000..) {
        sum += SceneSupport::of(family, seed, Sensor::Kinect, &Params::default()).unwrap();
    }
    let (own, truth) = (sum.own.edges, sum.truth.edges);
    assert!(truth.right > 20 && own.right > 15, "{own:?} {truth:?}");
    assert!(truth.precision() > 0.9 && truth.recall() > 0.9, "{truth:?}");
    assert!(own.precision() > 0.85 && own.recall() > 0.85, "{own:?}");
    let claim = sum.own.recursion;
    assert!(claim.with == claim.things && claim.without < claim.things, "{claim:?}");
}
