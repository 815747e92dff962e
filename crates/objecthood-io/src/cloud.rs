//! Point clouds, whatever file they come from.

use crate::capture::Pose;
use crate::error::{Error, Result};

/// Points in the frame of the camera that saw them: x right, y down, z forward.
///
/// An *organized* cloud has a point for every pixel of an image, row by row; missing points are not finite. Any other
/// cloud is a list: `width` points in one row. A single point is an image of one pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct PointCloud {
    /// Columns of the image, or points of the list.
    pub width: usize,
    /// Rows of the image, 1 for a list.
    pub height: usize,
    /// The points (m), `width * height` of them.
    pub points_m: Vec<[f32; 3]>,
    /// sRGB colour of every point, if the file has colours.
    pub color: Option<Vec<[u8; 3]>>,
    /// Truth label of every point as the file has it, if it has labels.
    pub label: Option<Vec<u32>>,
    /// Where the file says that the sensor was; `None`: in the origin, with the axes above.
    pub viewpoint: Option<Pose>,
}

impl PointCloud {
    /// Whether the points lie on a pixel grid.
    pub(crate) fn is_organized(&self) -> bool {
        self.height > 1 || self.width == 1
    }

    /// Refuses a cloud whose lists differ in length from each other or from its size.
    ///
    /// # Errors
    /// [`Error::CloudLengths`].
    pub(crate) fn check(&self) -> Result<()> {
        let points = self.points_m.len();
        let fits = |length: usize| length == points;
        let (color, label) = (self.color.as_ref().map(Vec::len), self.label.as_ref().map(Vec::len));
        if self.width.checked_mul(self.height) == Some(points)
            && points > 0
            && color.is_none_or(fits)
            && label.is_none_or(fits)
        {
            return Ok(());
        }
        Err(Error::CloudLengths { size: (self.width, self.height), points, color, label })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_different_length_are_refused() {
        let cloud = PointCloud {
            width: 2,
            height: 2,
            points_m: vec![[0.0; 3]; 4],
            color: Some(vec![[0; 3]; 4]),
            label: Some(vec![0; 4]),
            viewpoint: None,
        };
        assert!(cloud.check().is_ok());
        for wrong in [
            PointCloud { width: 3, ..cloud.clone() },
            PointCloud { width: 0, height: 0, points_m: vec![], color: None, label: None, viewpoint: None },
            PointCloud { width: usize::MAX, height: usize::MAX, ..cloud.clone() },
            PointCloud { color: Some(vec![[0; 3]; 3]), ..cloud.clone() },
            PointCloud { label: Some(vec![0; 5]), ..cloud },
        ] {
            assert!(matches!(wrong.check(), Err(Error::CloudLengths { .. })), "{wrong:?}");
        }
    }
}
