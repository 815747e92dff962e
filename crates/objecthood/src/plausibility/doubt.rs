//! What may be wrong with a frame, as data and in words.

use std::fmt;

use crate::camera::Camera;

/// Noise below this (m) is not reported: no depth camera measures so well.
const LEAST_TOLD_M: f64 = 1e-5;

/// Something about a frame that is implausible, with what is more likely. The frame is not changed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// The intrinsics are fractions of the image, not pixels.
    CameraNormalized {
        /// The same in pixels of this image.
        likely: Camera,
    },
    /// The intrinsics are lengths, such as millimetres, not pixels.
    CameraNotInPixels {
        /// The focal lengths as they were given.
        focal: [f64; 2],
        /// The same in pixels, if the principal point is a length too and lies in the middle of the image;
        /// otherwise `None`.
        likely: Option<Camera>,
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
    /// Surfaces are flat in depth, but should be flat in inverse depth.
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
    /// The edges of the colour image match the depth if one of the two is mirrored.
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
                    "focal lengths of {} and {} px are too short, they may be in millimetres: ",
                    Rounded(fx),
                    Rounded(fy)
                )?;
                match likely {
                    Some(likely) => {
                        f.write_str("in pixels the camera is about ")?;
                        numbers(f, likely)
                    }
                    None => f.write_str("divide them by the width of a pixel on the sensor"),
                }
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
                "the focal lengths {fx:.1} and {fy:.1} px differ, but pixels are square: is one of them another number of the camera?"
            ),
            _ => self.fmt_images(f),
        }
    }
}

impl Doubt {
    /// The words for depth and colour.
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
                "depths run from {} to {} m, farther than depth cameras see things to grasp: they may be {times} times too large",
                Rounded(near),
                Rounded(far)
            ),
            Self::TooNear { median_m, noise_m, times } => {
                write!(f, "half of the depths are below {} m, ", Rounded(median_m))?;
                // A usual noise of depths in kilometres is a micrometre in metres, which means nothing to a
                // reader.
                if noise_m >= LEAST_TOLD_M {
                    write!(f, "with noise and steps of {} mm, ", Rounded(1000.0 * noise_m))?;
                }
                write!(
                    f,
                    "nearer than depth cameras see or coarser than they measure there: they may be {times} times too small"
                )
            }
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

/// A number as people read it: three digits from the first that is not 0 on, however large or small it is.
struct Rounded(f64);

impl fmt::Display for Rounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A number below 10 has two digits behind the point, and one more for each 0 before the first other digit.
        let decimals = if self.0 == 0.0 { 0.0 } else { 2.0 - libm::floor(libm::log10(self.0.abs())) };
        write!(f, "{:.*}", decimals.clamp(0.0, MOST_DECIMALS) as usize, self.0)
    }
}

/// Smaller numbers are printed as 0.
const MOST_DECIMALS: f64 = 9.0;

/// A camera as options take it.
fn numbers(f: &mut fmt::Formatter<'_>, camera: Camera) -> fmt::Result {
    let Camera { fx_px, fy_px, cx_px, cy_px } = camera;
    write!(f, "{fx_px:.1},{fy_px:.1},{cx_px:.1},{cy_px:.1}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silly_numbers_are_written_as_people_do() {
        let told =
            [0.0, 0.000_723_4, 0.85, 1.0, 22.804, 722.7, 2_795_200.0, 1e-30].map(|x| Rounded(x).to_string());
        assert_eq!(told, ["0", "0.000723", "0.850", "1.00", "22.8", "723", "2795200", "0.000000000"]);
    }
}
