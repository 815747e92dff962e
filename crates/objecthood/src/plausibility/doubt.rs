//! What may be wrong with a frame, in words.

use std::fmt;

use crate::camera::Camera;

/// Something about a frame that is implausible, with what is more likely. Nothing was changed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// The intrinsics are shares of the image, not pixels.
    CameraNormalized {
        /// The same in pixels of this image.
        likely: Camera,
    },
    /// The intrinsics are lengths, such as millimetres, not pixels.
    CameraNotInPixels {
        /// The focal lengths as they were given.
        focal: [f64; 2],
        /// The same in pixels, if the principal point is the middle of the image.
        likely: Camera,
    },
    /// The camera is that of an image of another size.
    CameraOfOtherSize {
        /// By how much that image is larger.
        times: f64,
        /// The camera of this size.
        likely: Camera,
    },
    /// The column and the row of the principal point are exchanged, or the image is turned on its side.
    CenterSwapped {
        /// The principal point as it was given (px).
        center_px: [f64; 2],
    },
    /// The principal point is far from the middle of the image.
    CenterOff {
        /// The principal point as it was given (px).
        center_px: [f64; 2],
        /// The middle of the image (px).
        middle_px: [f64; 2],
    },
    /// No depth camera sees so little or so much.
    FieldOfView {
        /// Angle across the columns and across the rows (degrees).
        degrees: [f64; 2],
    },
    /// The pixels would be far from square.
    FocalLengths {
        /// Focal lengths as they were given (px).
        focal_px: [f64; 2],
    },
    /// The two bytes of each depth are exchanged.
    BytesSwapped {
        /// How many times less neighbouring pixels differ with the bytes the other way round.
        ratio: f64,
    },
    /// Neighbouring pixels have depths that have nothing to do with each other.
    DepthScrambled {
        /// Share of the neighbours in a row whose depth jumps.
        share: f64,
    },
    /// The rows of the depth image do not continue each other.
    RowsScrambled {
        /// Share of the neighbours in a column whose depth jumps.
        share: f64,
    },
    /// The greatest depth stands for "none".
    DepthSaturated {
        /// That depth (m).
        depth_m: f64,
        /// Share of the measured pixels that have it.
        share: f64,
    },
    /// Surfaces are even in depth where they have to be even in inverse depth.
    DisparityAsDepth {
        /// Share of the places at which it is so.
        share: f64,
    },
    /// Depths are in a smaller unit than they are taken for.
    TooFar {
        /// The depths (m) between which nine tenths of the pixels lie.
        range_m: [f64; 2],
        /// How many times too large they are, most likely.
        times: f64,
    },
    /// Depths are in a larger unit than they are taken for.
    TooNear {
        /// The median depth (m).
        median_m: f64,
        /// Differences of neighbouring pixels from a plane (m), where the median is.
        noise_m: f64,
        /// How many times too small they are, most likely.
        times: f64,
    },
    /// The edges of the colour image fit to the depth when one of them is mirrored.
    ColorMirrored(Mirrored),
}

/// How one of two images is mirrored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mirrored {
    /// Left and right are exchanged.
    Sideways,
    /// Top and bottom are exchanged.
    UpsideDown,
    /// Turned by half.
    Turned,
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::CameraNormalized { likely } => {
                write!(f, "the camera is given in shares of the image, not in pixels: in pixels it is ")?;
                numbers(f, likely)
            }
            Self::CameraNotInPixels { focal: [fx, fy], likely } => {
                write!(
                    f,
                    "focal lengths of {fx:.3} and {fy:.3} px are too short, they may be in millimetres: in pixels the camera is about "
                )?;
                numbers(f, likely)
            }
            Self::CameraOfOtherSize { times, likely } => {
                write!(
                    f,
                    "the camera seems to be that of an image of {times:.1} times this size: for this one it is about "
                )?;
                numbers(f, likely)?;
                f.write_str(", unless the image is cut out of a larger one")
            }
            Self::CenterSwapped { center_px: [cx, cy] } => write!(
                f,
                "the principal point ({cx:.1}, {cy:.1}) would be in the middle of an image turned on its side: are cx and cy exchanged, or the columns and rows of the images?"
            ),
            Self::CenterOff { center_px: [cx, cy], middle_px: [u, v] } => write!(
                f,
                "the principal point ({cx:.1}, {cy:.1}) is far from the middle of the image, near which cameras have it: is ({u:.1}, {v:.1}) meant, or is the image cut out of a larger one?"
            ),
            Self::FieldOfView { degrees: [across, down] } => write!(
                f,
                "the camera would see {across:.0} x {down:.0} degrees, as no depth camera does: check the focal lengths, which are in pixels of this image"
            ),
            Self::FocalLengths { focal_px: [fx, fy] } => write!(
                f,
                "the focal lengths {fx} and {fy} px differ, but pixels are square: is one of them another number of the camera?"
            ),
            _ => self.fmt_images(f),
        }
    }
}

impl Doubt {
    /// What is said of depth and colour.
    fn fmt_images(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::BytesSwapped { ratio } => write!(
                f,
                "with the two bytes of each depth exchanged, neighbouring pixels would differ {ratio:.0} times less: the depth image may have the other byte order"
            ),
            Self::DepthScrambled { share } => write!(
                f,
                "depth jumps between {:.0} % of neighbouring pixels, as no sensor measures: this may be no depth image",
                100.0 * share
            ),
            Self::RowsScrambled { share } => write!(
                f,
                "depth jumps between {:.0} % of the pixels of neighbouring rows but not along them: width and height of the depth image may be exchanged",
                100.0 * share
            ),
            Self::DepthSaturated { depth_m, share } => write!(
                f,
                "{:.0} % of the depths are exactly {depth_m:.3} m, far behind all others: that number may stand for no depth, which is 0",
                100.0 * share
            ),
            Self::DisparityAsDepth { share } => write!(
                f,
                "at {:.0} % of the places that tell, surfaces are even in depth instead of inverse depth: this may be disparity; depth is focal length times baseline, divided by it",
                100.0 * share
            ),
            Self::TooFar { range_m: [near, far], times } => write!(
                f,
                "depths run from {near:.2} to {far:.2} m, farther than depth cameras see things to grasp: they may be {times} times too large, so the depth scale, units in a metre, would be {times} times as large"
            ),
            Self::TooNear { median_m, noise_m, times } => write!(
                f,
                "half of the depths are below {median_m:.3} m, with noise and steps of {:.2} mm, nearer than depth cameras see or coarser than they measure there: they may be {times} times too small, so the depth scale, units in a metre, would be 1/{times} of what it is",
                1000.0 * noise_m
            ),
            Self::ColorMirrored(mirrored) => {
                let (how, what) = match mirrored {
                    Mirrored::Sideways => ("with left and right exchanged", "mirrored"),
                    Mirrored::UpsideDown => ("with top and bottom exchanged", "mirrored"),
                    Mirrored::Turned => ("turned by half", "turned"),
                };
                write!(
                    f,
                    "the edges of the colour image fit those of the depth better {how}: one of the two may be {what}"
                )
            }
            _ => Ok(()),
        }
    }
}

/// A camera as options take it.
fn numbers(f: &mut fmt::Formatter<'_>, camera: Camera) -> fmt::Result {
    let Camera { fx_px, fy_px, cx_px, cy_px } = camera;
    write!(f, "{fx_px:.1},{fy_px:.1},{cx_px:.1},{cy_px:.1}")
}
