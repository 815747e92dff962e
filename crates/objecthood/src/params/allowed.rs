//! The values that a parameter may take.

use std::fmt;

use crate::error::{Error, Result};
use crate::params::choices::{Channels, Choice, ColorFor, NoiseFrom, Profile, UpFrom};

/// The text between the two limits of a range.
pub(super) const TO: &str = " ..= ";
/// The text between the values of a choice.
pub(super) const OR: &str = " | ";

/// The values a parameter may take.
pub(super) trait Allowed<T> {
    fn allows(&self, value: &T) -> bool;
    fn in_words(&self) -> String;
}

impl<T: PartialOrd + fmt::Display> Allowed<T> for std::ops::RangeInclusive<T> {
    fn allows(&self, value: &T) -> bool {
        self.contains(value)
    }
    fn in_words(&self) -> String {
        format!("{}{TO}{}", self.start(), self.end())
    }
}

/// A choice between named values. The type admits no others, so there is nothing to check.
pub(super) struct OneOf(pub(super) &'static str);

impl<T> Allowed<T> for OneOf {
    fn allows(&self, _: &T) -> bool {
        true
    }
    fn in_words(&self) -> String {
        self.0.to_owned()
    }
}

/// A value that may be a number.
pub(super) trait Number: Sized {
    /// The number as printed: the 32-bit value 0.14 gives 0.14, not the nearest 32-bit number.
    fn number(&self) -> Option<f64>;
    /// The value of this type with this number, if there is one.
    fn from_number(number: f64) -> Option<Self>;
}

macro_rules! numbers {
    ($($Type:ty),+) => {
        $(impl Choice for $Type {
            fn choice(&self) -> Option<String> {
                None
            }
            fn from_choice(_: &str) -> Option<Self> {
                None
            }
        }

        impl Number for $Type {
            fn number(&self) -> Option<f64> {
                self.to_string().parse().ok()
            }
            fn from_number(number: f64) -> Option<Self> {
                number.to_string().parse().ok()
            }
        })+
    };
}

numbers!(f64, f32, usize, u32);

/// A choice is no number.
macro_rules! no_numbers {
    ($($Type:ty),+) => {
        $(impl Number for $Type {
            fn number(&self) -> Option<f64> {
                None
            }
            fn from_number(_: f64) -> Option<Self> {
                None
            }
        })+
    };
}

impl Choice for bool {
    fn choice(&self) -> Option<String> {
        Some(self.to_string())
    }
    fn from_choice(name: &str) -> Option<Self> {
        name.parse().ok()
    }
}

no_numbers!(bool, Channels, ColorFor, NoiseFrom, Profile, UpFrom);

/// Checks a value of a parameter.
///
/// # Errors
/// [`Error::BadParameter`] when the value is not allowed.
pub(super) fn check<T: fmt::Display>(name: &str, value: &T, allowed: &impl Allowed<T>) -> Result<()> {
    if allowed.allows(value) {
        return Ok(());
    }
    Err(Error::BadParameter {
        parameter: name.to_owned(),
        value: value.to_string(),
        range: allowed.in_words(),
    })
}
