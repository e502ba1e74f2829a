//! Which values of a number are legal, and how to say so.
//!
//! Method: bounds are exact f64 values; numbers are compared with them as rationals.

use num_rational::BigRational;
use std::fmt;

/// The legal values of a number.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Range {
    /// With its article: `an angle`.
    pub(crate) what: &'static str,
    pub(crate) low: f64,
    pub(crate) low_is_legal: bool,
    pub(crate) high: f64,
    pub(crate) high_is_legal: bool,
    /// Empty for a pure number.
    pub(crate) unit: &'static str,
    /// Added for a negative value.
    pub(crate) if_negative: &'static str,
}

impl Range {
    /// Both ends legal.
    pub(crate) const fn closed(
        what: &'static str,
        low: f64,
        high: f64,
        unit: &'static str,
    ) -> Self {
        let (low_is_legal, high_is_legal) = (true, true);
        Self { what, low, low_is_legal, high, high_is_legal, unit, if_negative: "" }
    }

    /// Above zero, up to `high`.
    pub(crate) const fn positive(what: &'static str, high: f64, unit: &'static str) -> Self {
        let mut range = Self::closed(what, 0.0, high, unit);
        range.low_is_legal = false;
        range
    }

    pub(crate) const fn below_high(mut self) -> Self {
        self.high_is_legal = false;
        self
    }

    pub(crate) const fn if_negative(mut self, hint: &'static str) -> Self {
        self.if_negative = hint;
        self
    }

    /// Whether a value is legal.
    pub(crate) fn holds(&self, value: &BigRational) -> bool {
        let bound = |bound: f64| BigRational::from_float(bound);
        let above = bound(self.low)
            .is_none_or(|low| if self.low_is_legal { *value >= low } else { *value > low });
        let below = bound(self.high)
            .is_none_or(|high| if self.high_is_legal { *value <= high } else { *value < high });
        above && below
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |bound: f64| {
            if bound != 0.0 && !(1e-4..1e7).contains(&bound.abs()) {
                format!("{bound:e}")
            } else {
                format!("{bound}")
            }
        };
        let (low, high) = (shown(self.low), shown(self.high));
        write!(f, "{} ", self.what)?;
        match (self.low_is_legal, self.high_is_legal) {
            (true, true) => write!(f, "from {low} to {high}")?,
            (true, false) => write!(f, "from {low} to below {high}")?,
            (false, true) => write!(f, "above {low} and at most {high}")?,
            (false, false) => write!(f, "above {low} and below {high}")?,
        }
        if self.unit.is_empty() { Ok(()) } else { write!(f, " {}", self.unit) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Number;

    #[test]
    fn a_range_says_what_is_legal() {
        assert_eq!(
            Range::closed("an angle", 0.0, 180.0, "deg").to_string(),
            "an angle from 0 to 180 deg"
        );
        assert_eq!(
            Range::positive("a duration", 1e12, "min").to_string(),
            "a duration above 0 and at most 1e12 min"
        );
        assert_eq!(
            Range::positive("an angle", 180.0, "deg").below_high().to_string(),
            "an angle above 0 and below 180 deg"
        );
        assert_eq!(Range::closed("a ratio", 0.0, 1.0, "").to_string(), "a ratio from 0 to 1");
    }

    #[test]
    fn ranges_are_compared_exactly() {
        let range = Range::closed("an angle", 0.0, 180.0, "deg");
        let holds = |text: &str| range.holds(Number::parse(text).unwrap().exact());
        assert!(holds("180") && holds("0") && holds("-0"));
        assert!(!holds("180.00000000000000000000001") && !holds("-1e-300"));
    }
}
