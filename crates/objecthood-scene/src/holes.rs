//! Pixels that lose their depth on the way from the sensor to the file.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, choices};

/// What takes depth from pixels, whatever the sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Holes {
    /// Nothing.
    #[default]
    None,
    /// A regular grid of single pixels, as registration into a larger colour image leaves: of 512 columns and 424 rows
    /// stretched by 5/4 every fifth is hit by no measurement; a driver that fills gaps along rows and along columns
    /// leaves where they cross.
    Grid,
}

/// Every so many pixels of a row and of a column there is a hole: 1 / (1 - 4/5).
const PERIOD_PX: usize = 5;

impl Holes {
    /// Everything there is.
    pub const ALL: [Self; 2] = [Self::None, Self::Grid];

    /// Its name, as [`FromStr`] reads it.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Grid => "grid",
        }
    }

    /// Whether there are none.
    pub(crate) fn is_none(&self) -> bool {
        *self == Self::None
    }

    /// Whether the pixel in this column and row loses its depth.
    pub(crate) fn takes(self, u: usize, v: usize) -> bool {
        match self {
            Self::None => false,
            Self::Grid => u % PERIOD_PX == PERIOD_PX / 2 && v % PERIOD_PX == PERIOD_PX / 2,
        }
    }
}

impl fmt::Display for Holes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Holes {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Self::ALL
            .into_iter()
            .find(|holes| holes.name() == name)
            .ok_or_else(|| Error::UnknownHoles { name: name.to_owned(), known: choices(Self::ALL) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_has_single_pixels() {
        let count = |holes: Holes| {
            (0..50).flat_map(|v| (0..50).map(move |u| (u, v))).filter(|&(u, v)| holes.takes(u, v)).count()
        };
        assert_eq!((count(Holes::None), count(Holes::Grid)), (0, 100));
        assert!(Holes::Grid.takes(7, 12) && !Holes::Grid.takes(8, 12) && !Holes::Grid.takes(7, 11));
    }

    #[test]
    fn names_are_read_back() {
        assert!(Holes::ALL.into_iter().all(|holes| holes.name().parse::<Holes>().unwrap() == holes));
        let message = "moth".parse::<Holes>().unwrap_err().to_string();
        assert_eq!(message, "`moth` is no kind of holes: choose none or grid");
    }
}
