//! What of a frame cannot be: a camera that is not that of the image, depth in another unit, images that do not belong together.
//!
//! The numbers of a frame say much of where they came from: cameras look into the middle of their image; depth cameras reach some
//! metres; their noise grows as the square of depth; planes are affine in inverse depth; where depth jumps, colour
//! often changes. A frame against which one of these speaks is processed as it is, with a [`Doubt`].
//!
//! Only a grid of pixels is looked at, so the cost is below 2 % of that of a method. Ours: the limits leave room around all frames at
//! hand (docs/INPUTS.md says how that was measured).

mod alignment;
mod doubt;
mod sample;
mod steps;
mod unit;
mod values;
mod view;

pub use doubt::{Doubt, Mirrored};

use self::sample::Sample;
use crate::frame::Frame;

/// What of a frame is implausible, the camera first. Of several doubts about depth only the first is told: the others may follow from it.
///
/// O(n) for n pixels, of which a few thousand are looked at.
///
/// ```
/// use objecthood::plausibility::{Doubt, find_doubts};
/// use objecthood::{Camera, Frame, Raster};
///
/// let far = Raster::filled(64, 48, 900.0)?; // millimetres that were taken for metres
/// let frame = Frame::new(far, None, Camera::new(52.5, 52.5, 31.5, 23.5)?)?;
/// assert!(matches!(find_doubts(&frame)[..], [Doubt::TooFar { times, .. }] if times == 1000.0));
/// # Ok::<(), objecthood::Error>(())
/// ```
pub fn find_doubts(frame: &Frame) -> Vec<Doubt> {
    let sample = &Sample::of(frame.depth_m());
    let depth = values::doubt(frame.depth_m(), sample)
        .or_else(|| values::disparity_doubt(frame.depth_m(), sample))
        .or_else(|| unit::doubt(frame.depth_m(), sample));
    let color = frame.color().and_then(|color| alignment::doubt(frame.depth_m(), color));
    view::doubt(frame.camera(), frame.size()).into_iter().chain(depth).chain(color).collect()
}
