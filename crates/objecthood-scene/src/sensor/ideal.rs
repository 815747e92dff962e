//! A camera without error.

use super::Measured;
use crate::view::View;

pub(super) fn measure(view: &View) -> Vec<Measured> {
    let pixels = view.sights.iter().enumerate();
    pixels
        .map(|(i, sight)| {
            sight.map_or(Measured::NONE, |sight| Measured { depth_m: sight.t as f32, source: i })
        })
        .collect()
}
