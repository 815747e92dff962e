//! Limits that several kinds of evidence share (docs/CONTEXT.md 4.7).

/// The foot of a part is this quantile of its heights.
pub(super) const FOOT_SHARE: f64 = 0.05;
/// A part whose foot is no higher above its support (m) stands on it: twice the noise of a foot at 1.5 m.
pub(super) const FOOT_M: f64 = 0.015;
/// A part that hangs, or lies on a slope, has at most this share of the pixels of the other: caps and heads
/// measure 0.1 to 0.35. Of two things that lean on each other, the front one hides the foot of the other, and
/// both have similar sizes. A third part that is smaller than this beside a ball, such as an ear, does not
/// hold the ball.
pub(super) const SMALLER_SHARE: f64 = 0.4;
/// A part is held by another at most this far (m) away: a shoulder hides as much of the neck behind it.
pub(super) const HIDDEN_M: f64 = 0.03;
/// The lower part is examined within this distance (m) of the contact, or of a ball: where a foot would
/// stand.
pub(super) const AROUND_M: f64 = 0.03;
/// Widths reach from the first to the second of these quantiles of places: outlines are noisy.
pub(super) const SIDES: [f64; 2] = [0.05, 0.95];
/// A width of fewer quanta than this is noise: of an upright thing only the front is seen.
pub(super) const WIDTH_QUANTA: f64 = 2.0;
