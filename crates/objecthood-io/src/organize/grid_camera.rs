//! The camera as the user gives it.

use std::str::FromStr;

use objecthood::{Camera, Raster};

use crate::error::{Error, Result};

/// A camera and, where it matters, the size of its image.
///
/// Written `fx,fy,cx,cy` or `fx,fy,cx,cy,width,height`, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridCamera {
    /// The intrinsics.
    pub camera: Camera,
    /// Columns and rows; `None`: the principal point is the middle of the image.
    pub size: Option<(usize, usize)>,
}

impl GridCamera {
    /// Columns and rows of the image: the given ones, or round(2·cx + 1) and round(2·cy + 1).
    ///
    /// # Errors
    /// [`Error::NoImageSize`] when no size is given and the principal point implies none.
    pub fn image_size(&self) -> Result<(usize, usize)> {
        if let Some(size) = self.size {
            return Ok(size);
        }
        let Camera { cx_px, cy_px, .. } = self.camera;
        let (width, height) = ((2.0 * cx_px + 1.0).round(), (2.0 * cy_px + 1.0).round());
        if width >= 1.0 && height >= 1.0 && width * height <= Raster::<f32>::MAX_PIXELS as f64 {
            Ok((width as usize, height as usize))
        } else {
            Err(Error::NoImageSize { cx_px, cy_px })
        }
    }
}

impl FromStr for GridCamera {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || Error::BadCameraText { given: text.to_owned() };
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        let (camera, size) = parts.split_at_checked(4).ok_or_else(wrong)?;
        let number = |k: usize| camera[k].parse::<f64>().map_err(|_| wrong());
        let side = |word: &str| word.parse().ok().filter(|&side: &usize| side > 0).ok_or_else(wrong);
        let camera = Camera::new(number(0)?, number(1)?, number(2)?, number(3)?)?;
        let size = match size {
            [] => None,
            [width, height] => Some((side(width)?, side(height)?)),
            _ => return Err(wrong()),
        };
        Ok(Self { camera, size })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_are_read() {
        let kinect = Camera::new(525.0, 525.0, 319.5, 239.5).unwrap();
        let short: GridCamera = "525,525,319.5,239.5".parse().unwrap();
        assert_eq!(short, GridCamera { camera: kinect, size: None });
        assert_eq!(short.image_size().unwrap(), (640, 480));
        let long: GridCamera = " 525, 525, 319.5, 239.5, 320, 240 ".parse().unwrap();
        assert_eq!(long.image_size().unwrap(), (320, 240));
    }

    #[test]
    fn anything_else_is_refused() {
        for text in [
            "",
            "525",
            "525,525,319.5",
            "1,1,0,0,5",
            "1,1,0,0,5,5,5",
            "1,1,0,0,0,5",
            "1,1,0,0,5,-5",
            "a,b,c,d",
        ] {
            let error = text.parse::<GridCamera>().unwrap_err();
            assert!(matches!(error, Error::BadCameraText { .. }), "{text}: {error}");
        }
        for text in ["0,1,0,0", "1,-1,0,0", "nan,1,0,0", "1,1,inf,0"] {
            let error = text.parse::<GridCamera>().unwrap_err();
            assert!(matches!(error, Error::Frame(objecthood::Error::BadCamera { .. })), "{text}: {error}");
        }
    }

    #[test]
    fn a_principal_point_far_off_implies_no_size() {
        for (cx_px, cy_px) in [(-1.0, 10.0), (10.0, -1.0), (1e7, 1e7), (1e6, 200.0)] {
            let camera = Camera::new(1.0, 1.0, cx_px, cy_px).unwrap();
            assert!(GridCamera { camera, size: None }.image_size().is_err());
        }
    }
}
