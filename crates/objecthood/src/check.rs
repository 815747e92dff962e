//! Checks: the measured values of a rule, with their limits.
//!
//! A rule holds when all of its checks hold. An explanation shows the same checks.

use serde::Serialize;
use serde::ser::{SerializeStruct, Serializer};

/// The side of its limit on which a measured value must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// Less than the limit.
    Below,
    /// The limit or less.
    AtMost,
    /// More than the limit.
    Above,
    /// The limit or more.
    AtLeast,
}

/// One condition, with the measured value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Check {
    /// The measured quantity, in words.
    pub what: &'static str,
    /// Its unit; empty for counts and shares.
    pub unit: &'static str,
    /// The measured value.
    pub measured: f64,
    /// The side of the limit on which it must be.
    pub bound: Bound,
    /// The limit.
    pub limit: f64,
    /// The parameter to which the limit is proportional; `None` = the limit is fixed.
    pub parameter: Option<&'static str>,
}

/// Serialized as an object with all fields, plus `holds`.
impl Serialize for Check {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let &Self { what, unit, measured, bound, limit, parameter } = self;
        let mut check = serializer.serialize_struct("Check", 7)?;
        check.serialize_field("what", what)?;
        check.serialize_field("unit", unit)?;
        check.serialize_field("measured", &measured)?;
        check.serialize_field("bound", &bound)?;
        check.serialize_field("limit", &limit)?;
        check.serialize_field("holds", &self.holds())?;
        match parameter {
            Some(parameter) => check.serialize_field("parameter", parameter)?,
            None => check.skip_field("parameter")?,
        }
        check.end()
    }
}

impl Check {
    /// The check that a measured value is on the right side of a fixed limit.
    pub(crate) fn new(
        what: &'static str,
        unit: &'static str,
        measured: f64,
        bound: Bound,
        limit: f64,
    ) -> Self {
        Self { what, unit, measured, bound, limit, parameter: None }
    }

    /// The same check with a limit that a parameter sets.
    pub(crate) fn set_by(self, parameter: &'static str) -> Self {
        Self { parameter: Some(parameter), ..self }
    }

    /// Whether it holds.
    pub fn holds(&self) -> bool {
        match self.bound {
            Bound::Below => self.measured < self.limit,
            Bound::AtMost => self.measured <= self.limit,
            Bound::Above => self.measured > self.limit,
            Bound::AtLeast => self.measured >= self.limit,
        }
    }

    /// Distance of the measured value from the limit, as a share of the larger of both; in [0, 2].
    pub fn distance(&self) -> f64 {
        let scale = self.limit.abs().max(self.measured.abs());
        if scale > 0.0 { (self.measured - self.limit).abs() / scale } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_say_whether_the_limit_is_included() {
        let holds = |bound| [0.9, 1.0, 1.1].map(|measured| Check::new("", "", measured, bound, 1.0).holds());
        assert_eq!(holds(Bound::Below), [true, false, false]);
        assert_eq!(holds(Bound::AtMost), [true, true, false]);
        assert_eq!(holds(Bound::Above), [false, false, true]);
        assert_eq!(holds(Bound::AtLeast), [false, true, true]);
        let nan = [Bound::Below, Bound::AtMost, Bound::Above, Bound::AtLeast]
            .map(|bound| Check::new("", "", f64::NAN, bound, 1.0).holds());
        assert_eq!(nan, [false; 4]);
    }

    #[test]
    fn a_distance_is_a_share() {
        let distance = |measured, limit| Check::new("", "", measured, Bound::Below, limit).distance();
        assert_eq!(distance(5.0, 10.0), 0.5);
        assert_eq!(distance(20.0, 10.0), 0.5);
        assert_eq!(distance(-1.0, 1.0), 2.0);
        assert_eq!(distance(0.0, 0.0), 0.0);
    }
}
