//! Clouds as the images that a camera would have written.

use std::io::Cursor;

use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb};

use super::Folder;
use super::scene::{Cloud, FOCAL_PX};

/// `--camera` of the clouds in [`super::scene`].
pub(crate) fn camera() -> String {
    format!("{FOCAL_PX},{FOCAL_PX},159.5,119.5")
}

impl Cloud {
    pub(crate) fn color(&self) -> DynamicImage {
        let at = |u, v| Rgb(self.points[(v as usize) * self.width + u as usize].color);
        ImageBuffer::from_fn(self.width as u32, self.height as u32, at).into()
    }

    /// 16-bit depth with `scale` units a metre; none is 0.
    pub(crate) fn depth(&self, scale: f32) -> DynamicImage {
        let unit = |z: f32| if z.is_nan() { 0 } else { (z * scale).round() as u16 };
        let at = |u, v| Luma([unit(self.points[(v as usize) * self.width + u as usize].xyz_m[2])]);
        ImageBuffer::<Luma<u16>, _>::from_fn(self.width as u32, self.height as u32, at).into()
    }
}

pub(crate) fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

pub(crate) fn png(image: &DynamicImage) -> Vec<u8> {
    encoded(image, ImageFormat::Png)
}

impl Folder {
    /// Writes `<folder>/<key>-color.png` and `-depth.png`, in tenths of a millimetre.
    pub(crate) fn write_pair(&self, folder: &str, key: &str, cloud: &Cloud) {
        self.write(&format!("{folder}/{key}-color.png"), &png(&cloud.color()));
        self.write(&format!("{folder}/{key}-depth.png"), &png(&cloud.depth(10_000.0)));
    }
}
