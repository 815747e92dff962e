//! The file from which the program `counted` takes its frame.
//!
//! It is written and read by the same checkout, so it has no version. Formats that users have would link decoders, and to build
//! those in release takes longer than to build the method.

use anyhow::{Context, Result};
use objecthood::{Camera, Frame, Raster};
use serde::{Deserialize, Serialize};

/// What a file has of a frame.
#[derive(Serialize, Deserialize)]
struct Stored {
    size_px: (usize, usize),
    /// Row by row; NaN where nothing was measured.
    depth_m: Vec<f32>,
    color: Option<Vec<[u8; 3]>>,
    camera: Camera,
}

/// A frame as bytes.
///
/// # Errors
/// Never for a frame in memory; the encoder declares errors of outputs that can be full.
pub fn to_bytes(frame: &Frame) -> Result<Vec<u8>> {
    let stored = Stored {
        size_px: frame.size(),
        depth_m: frame.depth_m().as_slice().to_vec(),
        color: frame.color().map(|color| color.as_slice().to_vec()),
        camera: frame.camera(),
    };
    Ok(postcard::to_stdvec(&stored)?)
}

/// The frame of these bytes.
///
/// # Errors
/// When the bytes are none of [`to_bytes`].
pub fn from_bytes(bytes: &[u8]) -> Result<Frame> {
    let Stored { size_px: (width, height), depth_m, color, camera } =
        postcard::from_bytes(bytes).context("no frame of `measure demo`")?;
    let color = color.map(|color| Raster::from_vec(width, height, color)).transpose()?;
    Ok(Frame::new(Raster::from_vec(width, height, depth_m)?, color, camera)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_comes_back_as_it_was() {
        let bits = |frame: &Frame| frame.depth_m().map(|z| z.to_bits()).as_slice().to_vec();
        let depth_m = Raster::from_vec(2, 1, vec![0.0, 1.25]).unwrap();
        let color = Raster::from_vec(2, 1, vec![[1, 2, 3], [4, 5, 6]]).unwrap();
        let camera = Camera::new(500.0, 510.0, 0.5, 0.0).unwrap();
        for color in [Some(color), None] {
            let frame = Frame::new(depth_m.clone(), color, camera).unwrap();
            let back = from_bytes(&to_bytes(&frame).unwrap()).unwrap();
            assert_eq!(back.size(), frame.size());
            assert_eq!(back.camera(), camera);
            assert_eq!(bits(&back), bits(&frame));
            assert_eq!(back.color().map(Raster::as_slice), frame.color().map(Raster::as_slice));
        }
        assert!(from_bytes(b"\xff").is_err());
    }
}
