//! What of a frame is looked at: a range of depths, a region of the image, a mask. Outside, pixels get no depth.

use std::fmt;
use std::str::FromStr;

use objecthood::{Frame, Raster};

use crate::capture::Capture;
use crate::error::{Error, Result};

/// Depths from `nearest_m` to `farthest_m`, both included.
///
/// Written `nearest..farthest` in metres; either may be left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthRange {
    /// Least depth (m).
    pub nearest_m: f32,
    /// Greatest depth (m); may be infinite.
    pub farthest_m: f32,
}

/// A rectangle of pixels.
///
/// Written `x,y,width,height` in pixels; (x, y) is its upper left pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// First column.
    pub u: usize,
    /// First row.
    pub v: usize,
    /// Number of columns; not zero.
    pub width: usize,
    /// Number of rows; not zero.
    pub height: usize,
}

/// One of the limits of a [`Scope`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// [`Scope::range`].
    Range,
    /// [`Scope::region`].
    Region,
    /// [`Scope::mask`].
    Mask,
}

/// What is looked at: pixels that lie in everything that is given. By default all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scope {
    /// Depths.
    pub range: Option<DepthRange>,
    /// Part of the image.
    pub region: Option<Region>,
    /// Pixels, of the size of the frame.
    pub mask: Option<Raster<bool>>,
}

impl Scope {
    /// Takes depth, and so the truth, from the pixels that are not looked at. Colours stay.
    ///
    /// # Errors
    /// [`Error::RegionOutside`], [`Error::MaskSize`]; [`Error::NothingInScope`] when no depth is left.
    pub fn limit(&self, mut capture: Capture) -> Result<Capture> {
        if *self == Self::default() {
            return Ok(capture);
        }
        let size @ (width, height) = capture.frame.size();
        if let Some(region) = self.region.filter(|region| !region.lies_in(size)) {
            return Err(Error::RegionOutside { region, size });
        }
        if let Some(mask) = self.mask.as_ref().filter(|mask| mask.size() != size) {
            return Err(Error::MaskSize { mask: mask.size(), frame: size });
        }

        let mut depth_m = capture.frame.depth_m().clone();
        for v in 0..height {
            for u in 0..width {
                let i = v * width + u;
                if !self.contains(u, v, i, depth_m[i]) {
                    depth_m.as_mut_slice()[i] = f32::NAN;
                    if let Some(truth) = &mut capture.truth {
                        truth.as_mut_slice()[i] = 0;
                    }
                }
            }
        }
        if depth_m.as_slice().iter().all(|z| z.is_nan()) {
            return Err(self.nothing_left(&capture.frame));
        }
        capture.frame = capture.frame.with_depth_m(depth_m)?;
        Ok(capture)
    }

    /// Whether the pixel (u, v) with index `i` and depth `z_m` is looked at.
    fn contains(&self, u: usize, v: usize, i: usize, z_m: f32) -> bool {
        self.range.is_none_or(|range| (range.nearest_m..=range.farthest_m).contains(&z_m))
            && self.region.is_none_or(|region| region.contains(u, v))
            && self.mask.as_ref().is_none_or(|mask| mask[i])
    }

    /// Each limit that is given, alone.
    fn parts(&self) -> Vec<(Limit, Self)> {
        let all = [
            (Limit::Range, Self { range: self.range, ..Self::default() }),
            (Limit::Region, Self { region: self.region, ..Self::default() }),
            (Limit::Mask, Self { mask: self.mask.clone(), ..Self::default() }),
        ];
        all.into_iter().filter(|(_, part)| *part != Self::default()).collect()
    }

    /// Whether no pixel with depth is looked at.
    fn is_empty_in(&self, frame: &Frame) -> bool {
        let width = frame.size().0;
        let mut depth_m = frame.depth_m().as_slice().iter().enumerate();
        depth_m.all(|(i, z)| z.is_nan() || !self.contains(i % width, i / width, i, *z))
    }

    fn nothing_left(&self, frame: &Frame) -> Error {
        let (alone, others): (Vec<_>, Vec<_>) =
            self.parts().into_iter().partition(|(_, part)| part.is_empty_in(frame));
        let limits = if alone.is_empty() { others } else { alone };
        let valid = || frame.depth_m().as_slice().iter().copied().filter(|z| !z.is_nan());
        Error::NothingInScope {
            limits: limits.into_iter().map(|(limit, _)| limit).collect(),
            size: frame.size(),
            valid: valid().count(),
            nearest_m: valid().fold(f32::INFINITY, f32::min),
            farthest_m: valid().fold(0.0, f32::max),
        }
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Range => "the range of depths",
            Self::Region => "the region",
            Self::Mask => "the mask",
        })
    }
}

impl FromStr for DepthRange {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || Error::BadRange { given: text.to_owned() };
        let (nearest, farthest) = text.split_once("..").ok_or_else(wrong)?;
        let metres = |text: &str, if_left_out: f32| match text.trim() {
            "" => Ok(if_left_out),
            number => number.parse::<f32>().map_err(|_| wrong()),
        };
        let range = Self { nearest_m: metres(nearest, 0.0)?, farthest_m: metres(farthest, f32::INFINITY)? };
        let is_range = range.nearest_m >= 0.0 && range.nearest_m < range.farthest_m;
        if is_range && text.trim() != ".." { Ok(range) } else { Err(wrong()) }
    }
}

impl Region {
    fn contains(&self, u: usize, v: usize) -> bool {
        u >= self.u && u - self.u < self.width && v >= self.v && v - self.v < self.height
    }

    fn lies_in(&self, (width, height): (usize, usize)) -> bool {
        let fits =
            |first: usize, count: usize, all: usize| first.checked_add(count).is_some_and(|end| end <= all);
        fits(self.u, self.width, width) && fits(self.v, self.height, height)
    }
}

impl FromStr for Region {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || Error::BadRegion { given: text.to_owned() };
        let numbers: Result<Vec<usize>, _> = text.split(',').map(|part| part.trim().parse()).collect();
        match numbers.map_err(|_| wrong())?[..] {
            [u, v, width, height] if width > 0 && height > 0 => Ok(Self { u, v, width, height }),
            _ => Err(wrong()),
        }
    }
}

impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{},{}", self.u, self.v, self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use objecthood::Camera;

    use super::*;

    /// 4 x 3 pixels at 1, 2, .. 12 m; the last one has no depth.
    fn capture() -> Capture {
        let mut depth_m: Vec<f32> = (1..=12).map(|k| k as f32).collect();
        depth_m[11] = f32::NAN;
        let depth_m = Raster::from_vec(4, 3, depth_m).unwrap();
        let color = Raster::filled(4, 3, [7; 3]).unwrap();
        let frame = Frame::new(depth_m, Some(color), Camera::new(4.0, 4.0, 2.0, 1.0).unwrap()).unwrap();
        Capture { truth: Some(Raster::filled(4, 3, 5).unwrap()), ..Capture::new(frame) }
    }

    /// The depths that are left, whole metres.
    fn left(scope: &Scope) -> Vec<u32> {
        let capture = scope.limit(capture()).unwrap();
        assert_eq!(capture.frame.color().unwrap().as_slice(), [[7; 3]; 12]);
        let depth_m = capture.frame.depth_m().as_slice();
        if *scope != Scope::default() {
            let truth = capture.truth.unwrap();
            assert!(depth_m.iter().zip(truth.as_slice()).take(11).all(|(z, t)| z.is_nan() == (*t == 0)));
        }
        depth_m.iter().filter(|z| !z.is_nan()).map(|&z| z as u32).collect()
    }

    #[test]
    fn limits_add_up() {
        let range = Some("2..9".parse().unwrap());
        let region = Some("1,0,2,3".parse().unwrap());
        let mask = Some(Raster::from_vec(4, 3, (0..12).map(|i| i % 2 == 0).collect()).unwrap());
        assert_eq!(left(&Scope::default()).len(), 11);
        assert_eq!(left(&Scope { range, ..Scope::default() }), [2, 3, 4, 5, 6, 7, 8, 9]);
        assert_eq!(left(&Scope { region, ..Scope::default() }), [2, 3, 6, 7, 10, 11]);
        assert_eq!(left(&Scope { mask: mask.clone(), ..Scope::default() }), [1, 3, 5, 7, 9, 11]);
        assert_eq!(left(&Scope { range, region, mask }), [3, 7]);
    }

    #[test]
    fn limits_that_fit_no_frame_are_refused() {
        let error = |scope: Scope| scope.limit(capture()).unwrap_err().to_string();
        for region in ["3,0,2,1", "0,2,1,2", "4,0,1,1", "18446744073709551615,0,1,1"] {
            let region = Some(region.parse().unwrap());
            assert!(error(Scope { region, ..Scope::default() }).contains("4x3"));
        }
        let mask = Some(Raster::filled(3, 4, true).unwrap());
        let said = error(Scope { mask, ..Scope::default() });
        assert!(said.contains("3x4") && said.contains("4x3"), "{said}");
        let range = Some("20..".parse().unwrap());
        let said = error(Scope { range, ..Scope::default() });
        assert!(said.contains("11 pixels") && said.contains("1.00 to 11.00 m"), "{said}");
    }

    /// All limits that there are were named, also those that were not given.
    #[test]
    fn the_limit_that_leaves_nothing_is_named() {
        let mask =
            |first: usize| Some(Raster::from_vec(4, 3, (0..12).map(|i| i >= first).collect()).unwrap());
        let (near, far) = (Some("..3".parse().unwrap()), Some("20..".parse().unwrap()));
        let region = Some("0,0,4,2".parse().unwrap());
        for (scope, limits) in [
            (Scope { range: far, region, mask: mask(0) }, &[Limit::Range][..]),
            (Scope { range: near, region: None, mask: mask(11) }, &[Limit::Mask]),
            (Scope { range: None, region, mask: mask(8) }, &[Limit::Region, Limit::Mask]),
        ] {
            match scope.limit(capture()).unwrap_err() {
                Error::NothingInScope { limits: named, size: (4, 3), .. } => assert_eq!(named, limits),
                other => panic!("{other}"),
            }
        }
    }

    #[test]
    fn ranges_and_regions_are_read() {
        let range = |text: &str| text.parse::<DepthRange>();
        assert_eq!(range("0.3..1.5").unwrap(), DepthRange { nearest_m: 0.3, farthest_m: 1.5 });
        assert_eq!(range("..1.5").unwrap(), DepthRange { nearest_m: 0.0, farthest_m: 1.5 });
        assert_eq!(range("1..").unwrap().farthest_m, f32::INFINITY);
        for text in ["", "..", "1", "2..1", "1..1", "-1..2", "a..b", "nan..2", "1..nan", "1..2..3", "0.3-1.5"]
        {
            assert!(range(text).is_err(), "{text}");
        }
        assert_eq!("1, 2,3,4".parse::<Region>().unwrap(), Region { u: 1, v: 2, width: 3, height: 4 });
        for text in ["", "1,2,3", "1,2,3,0", "1,2,0,4", "1,2,3,4,5", "-1,2,3,4", "1.5,2,3,4"] {
            assert!(text.parse::<Region>().is_err(), "{text}");
        }
    }
}
