//! Depth images.

use objecthood::Raster;

use super::error::ImageError;
use super::picture::{self, Format, Picture, Samples};
use crate::error::Result;
use crate::given::Given;

/// Scales that are in use: millimetres, TUM, YCB-Video, metres.
const USUAL_SCALES: [f64; 4] = [1000.0, 5000.0, 10_000.0, 1.0];

/// Where depth cameras measure: a median outside is one of wrong units.
const LIKELY_M: std::ops::RangeInclusive<f64> = 0.05..=50.0;

/// The depth of every pixel (m) of an image file, from its first channel. What is not positive and finite means none.
pub(crate) fn decode(bytes: &[u8], given: &Given) -> Result<Raster<f32>> {
    if picture::probe(bytes)? == Format::Jpeg {
        return Err(ImageError::DepthIsJpeg.into());
    }
    of_picture(picture::decode(bytes, given.max_pixels)?, given)
}

/// The depth of every pixel (m) of an image, from its first channel.
pub(crate) fn of_picture(picture: Picture, given: &Given) -> Result<Raster<f32>> {
    let Picture { size, channels, samples } = picture;
    if channels > 2 {
        return Err(ImageError::DepthIsColor { channels }.into());
    }
    let (depth_m, scale) = match samples {
        Samples::U8(_) => return Err(ImageError::DepthEightBit.into()),
        Samples::U16(samples) => {
            let scale = given.depth_scale.ok_or(ImageError::NoDepthScale)?;
            (metres_of_units(samples.into_iter().step_by(channels), scale), scale)
        }
        Samples::F32(samples) => {
            let scale = given.depth_scale.unwrap_or(1.0);
            (metres_of_floats(samples.into_iter().step_by(channels), scale), scale)
        }
    };
    check_unit(&depth_m, scale)?;
    Ok(Raster::from_vec(size.0, size.1, depth_m)?)
}

/// The depth of a 16-bit image, of which a message tells size and unit by `metres`.
///
/// # Errors
/// As [`decode`].
pub(crate) fn depth_of_image(
    bytes: &[u8],
    metres: impl FnOnce(Vec<u16>) -> Vec<f32>,
    max_pixels: usize,
) -> Result<Raster<f32>> {
    let Picture { size, channels, samples } = picture::decode(bytes, max_pixels)?;
    match samples {
        Samples::U16(samples) if channels == 1 => Ok(Raster::from_vec(size.0, size.1, metres(samples))?),
        Samples::U8(_) if channels <= 2 => Err(ImageError::DepthEightBit.into()),
        _ => Err(ImageError::DepthIsColor { channels }.into()),
    }
}

/// Depth (m) of units of which `scale` make a metre. Their greatest value stands for what is farther, or for nothing at all.
pub fn metres_of_units(samples: impl IntoIterator<Item = u16>, scale: f64) -> Vec<f32> {
    let metres = |raw: u16| if raw == u16::MAX { f32::NAN } else { (f64::from(raw) / scale) as f32 };
    samples.into_iter().map(metres).collect()
}

/// Depth (m) of floating-point numbers of which `scale` make a metre.
pub fn metres_of_floats(samples: impl IntoIterator<Item = f32>, scale: f64) -> Vec<f32> {
    samples.into_iter().map(|raw| (f64::from(raw) / scale) as f32).collect()
}

/// Refuses depths of which more than half lie where no depth camera measures.
pub(crate) fn check_unit(depth_m: &[f32], depth_scale: f64) -> Result<(), ImageError> {
    let valid = || depth_m.iter().map(|&z| f64::from(z)).filter(|z| *z > 0.0 && z.is_finite());
    let (mut all, mut near, mut far) = (0_usize, 0_usize, 0_usize);
    for z in valid() {
        all += 1;
        near += usize::from(z < *LIKELY_M.start());
        far += usize::from(z > *LIKELY_M.end());
    }
    if 2 * near.max(far) <= all {
        return Ok(());
    }
    let mut valid: Vec<f64> = valid().collect();
    let (_, &mut median_m, _) = valid.select_nth_unstable_by(all / 2, f64::total_cmp);
    // Of the scales that make sense of it the one that brings the median nearest to a metre, as a ratio.
    let with = |scale: f64| median_m * depth_scale / scale;
    let likely = USUAL_SCALES.into_iter().filter(|&scale| LIKELY_M.contains(&with(scale)));
    let likely = likely.min_by(|&a, &b| with(a).ln().abs().total_cmp(&with(b).ln().abs()));
    Err(ImageError::UnlikelyUnit { depth_scale, median_m, likely })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn proposed(raw: f64, scale: f64) -> Option<Option<f64>> {
        let depth_m: Vec<f32> =
            (0..99).map(|k| (raw * (0.9 + 0.002 * f64::from(k)) / scale) as f32).collect();
        match check_unit(&depth_m, scale) {
            Ok(()) => None,
            Err(ImageError::UnlikelyUnit { likely, .. }) => Some(likely),
            Err(other) => panic!("{other}"),
        }
    }

    #[test]
    fn the_likely_scale_is_proposed() {
        assert_eq!(proposed(900.0, 1000.0), None);
        assert_eq!(proposed(900.0, 1.0), Some(Some(1000.0)));
        assert_eq!(proposed(5200.0, 1.0), Some(Some(5000.0)));
        assert_eq!(proposed(11_000.0, 1.0), Some(Some(10_000.0)));
        assert_eq!(proposed(0.9, 1000.0), Some(Some(1.0)));
        assert_eq!(proposed(1e-4, 1.0), Some(None));
        assert_eq!(proposed(1e9, 1000.0), Some(None));
    }

    #[test]
    fn it_is_the_median_of_what_is_valid_that_counts() {
        assert!(check_unit(&[0.0; 9], 1.0).is_ok());
        assert!(check_unit(&[f32::NAN, f32::INFINITY, -3.0, 60.0], 1.0).is_err());
        assert!(check_unit(&[60.0, 1.0], 1.0).is_ok());
        assert!(check_unit(&[60.0, 70.0, 1.0], 1.0).is_err());
        assert!(check_unit(&[0.01, 0.02, 1.0], 1.0).is_err());
    }
}
