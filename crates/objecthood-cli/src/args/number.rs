//! Whole numbers on the command line.

use std::fmt::Display;
use std::str::FromStr;

/// Reads a whole number from `least` to `most`; anything else is refused in words that say what to give.
pub(crate) fn whole<T>(least: T, most: T) -> impl Fn(&str) -> Result<T, String> + Clone
where
    T: FromStr + PartialOrd + Display + Clone,
{
    move |text| match text.trim().parse::<T>() {
        Ok(number) if number >= least && number <= most => Ok(number),
        _ => Err(format!("give a whole number from {least} to {most}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// It said "invalid digit found in string".
    #[test]
    fn a_refusal_says_what_was_expected() {
        let read = whole(1_u32, 1024);
        assert_eq!((read("1"), read(" 1024 ")), (Ok(1), Ok(1024)));
        for wrong in ["0", "1025", "-3", "1.5", "many", "", "99999999999999999999"] {
            assert_eq!(read(wrong), Err("give a whole number from 1 to 1024".to_owned()), "{wrong}");
        }
    }
}
