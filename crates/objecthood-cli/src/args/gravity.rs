//! What is said of gravity.

use anyhow::{Result, anyhow};
use objecthood_io::Capture;

/// Gravity, or where to read it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum GravityArg {
    /// The direction in which things fall, in the frame of the points: of images the camera frame.
    Given([f32; 3]),
    /// The poses of the frames, in a world whose z axis points up.
    Poses,
}

impl GravityArg {
    /// Three numbers, or `poses`.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        if text == "poses" {
            return Ok(Self::Poses);
        }
        let numbers: Option<Vec<f32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
        let vector: Option<[f32; 3]> = numbers.and_then(|numbers| numbers.try_into().ok());
        let is_direction = |vector: &[f32; 3]| vector.iter().all(|x| x.is_finite()) && *vector != [0.0; 3];
        vector.filter(is_direction).map(Self::Given).ok_or_else(|| {
            "give the direction in which things fall, as 0,9.81,0 for a level camera (x right, y down, z forward), or `poses`"
                .to_owned()
        })
    }

    /// The frame with the direction against gravity.
    ///
    /// # Errors
    /// When it is to be read from a pose that the frame does not have.
    pub(crate) fn set(self, mut capture: Capture) -> Result<Capture> {
        let up = match (self, capture.pose) {
            (Self::Given(gravity), _) => capture.to_camera_direction(gravity).map(|part| -part),
            (Self::Poses, Some(pose)) => pose.up(),
            (Self::Poses, None) => {
                return Err(anyhow!(
                    "the frame has no pose: give --gravity X,Y,Z instead of --gravity poses"
                ));
            }
        };
        capture.frame = capture.frame.with_up(up)?;
        Ok(capture)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_is_three_numbers_or_poses() {
        assert_eq!(GravityArg::parse("0, 9.81,-1"), Ok(GravityArg::Given([0.0, 9.81, -1.0])));
        assert_eq!(GravityArg::parse("poses"), Ok(GravityArg::Poses));
        for wrong in ["0,0,0", "1,2", "1,2,3,4", "x,1,2", "nan,1,2", ""] {
            assert!(GravityArg::parse(wrong).is_err(), "{wrong}");
        }
    }
}
