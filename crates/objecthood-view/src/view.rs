//! A frame and what was found in it, at the size of a tile: what the tiles are painted from.

use image::imageops::{self, FilterType};
use image::{ImageBuffer, Rgb, RgbImage};
use objecthood::{Discovery, Frame, Raster, Segments};

use crate::grid::{sample, tile_size};
use crate::objects::Objects;
use crate::recording::Recording;
use crate::support::forest::Forest;

/// Where there is no depth, no label, or nothing was recorded.
pub(crate) const NOTHING: Rgb<u8> = Rgb([0; 3]);

/// All that is to be drawn of a frame, at the size of a tile.
pub(crate) struct View<'a> {
    size: (usize, usize),
    color: Option<RgbImage>,
    depth_m: Raster<f32>,
    normals: Option<Raster<[f32; 3]>>,
    /// The objects that were found.
    pub(crate) objects: Objects,
    /// What stands on what.
    pub(crate) forest: Forest,
    frame: &'a Frame,
    pub(crate) recording: &'a Recording,
    pub(crate) discovery: &'a Discovery,
}

impl<'a> View<'a> {
    pub(crate) fn new(frame: &'a Frame, recording: &'a Recording, discovery: &'a Discovery) -> Self {
        Self {
            size: tile_size(frame.size()),
            color: frame.color().and_then(resize),
            depth_m: sample(frame.depth_m()),
            objects: Objects::new(sample(&discovery.labels)),
            forest: Forest::new(discovery),
            normals: recording.normals.as_ref().map(sample),
            frame,
            recording,
            discovery,
        }
    }

    /// Columns and rows of a tile.
    pub(crate) fn tile_size(&self) -> (u32, u32) {
        (self.size.0 as u32, self.size.1 as u32)
    }

    /// A tile of which `color` paints every pixel that shows something.
    pub(crate) fn paint(&self, mut color: impl FnMut(usize, usize) -> Option<Rgb<u8>>) -> RgbImage {
        let (width, height) = self.tile_size();
        RgbImage::from_fn(width, height, |x, y| color(x as usize, y as usize).unwrap_or(NOTHING))
    }

    /// Width of a line that is seen at the size of a tile [px].
    pub(crate) fn line_px(&self) -> u32 {
        (self.size.0.max(self.size.1) / 320) as u32
    }

    pub(crate) fn has_color(&self) -> bool {
        self.color.is_some()
    }

    /// What the camera saw, or where it has no colour the surfaces lit from the camera.
    pub(crate) fn scenery(&self, u: usize, v: usize) -> Option<Rgb<u8>> {
        if let Some(color) = &self.color {
            return color.get_pixel_checked(u as u32, v as u32).copied();
        }
        self.depth_m(u, v)?;
        let light = self.normal(u, v).map_or(0.0, |n| n[2].abs().min(1.0));
        Some(Rgb([(60.0 + 180.0 * light) as u8; 3]))
    }

    /// Depth at a pixel, in metres.
    pub(crate) fn depth_m(&self, u: usize, v: usize) -> Option<f32> {
        self.depth_m.get(u, v).copied().filter(|z| !z.is_nan())
    }

    /// Every depth there is, in metres.
    pub(crate) fn valid_depths_m(&self) -> Vec<f32> {
        self.depth_m.as_slice().iter().copied().filter(|z| !z.is_nan()).collect()
    }

    /// The normal at a pixel; none is stored as zero.
    pub(crate) fn normal(&self, u: usize, v: usize) -> Option<[f32; 3]> {
        let is_normal = |n: &[f32; 3]| n.iter().all(|x| x.is_finite()) && *n != [0.0; 3];
        self.normals.as_ref()?.get(u, v).copied().filter(is_normal)
    }

    /// Label map at the size of a tile, without the pixels that have no depth.
    pub(crate) fn labels(&self, segments: &Segments) -> Raster<i32> {
        let mut labels = sample(segments.labels());
        for (label, z) in labels.as_mut_slice().iter_mut().zip(self.depth_m.as_slice()) {
            if z.is_nan() {
                *label = Segments::NONE;
            }
        }
        labels
    }

    /// Number of segments from `first` on that own a pixel with depth.
    pub(crate) fn count(&self, segments: &Segments, first: usize) -> usize {
        let mut owns_depth = vec![false; segments.count()];
        for (&label, z) in segments.labels().as_slice().iter().zip(self.frame.depth_m().as_slice()) {
            if let (Ok(s), false) = (usize::try_from(label), z.is_nan()) {
                owns_depth[s] = true;
            }
        }
        owns_depth.iter().skip(first).filter(|&&owns| owns).count()
    }

    /// As [`Objects::at`].
    pub(crate) fn object(&self, u: usize, v: usize) -> Option<(u16, u32)> {
        self.objects.at(u, v)
    }
}

/// Colour at the size of a tile; `None` never happens but for an image that claims a wrong size.
pub(crate) fn resize(color: &Raster<[u8; 3]>) -> Option<RgbImage> {
    let (width, height) = color.size();
    let (columns, rows) = tile_size(color.size());
    let bytes = color.as_slice().as_flattened();
    let image = ImageBuffer::<Rgb<u8>, _>::from_raw(width as u32, height as u32, bytes)?;
    let filter = if columns < width { FilterType::Triangle } else { FilterType::Nearest };
    Some(imageops::resize(&image, columns as u32, rows as u32, filter))
}
