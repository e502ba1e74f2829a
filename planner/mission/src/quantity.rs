//! What quantity did the user type on the command line.
//!
//! Durations need a unit (`20d`, `3.2h`, `192.348min`, `30s`, `2w`, `1.5y`, `14 days`), angles too (`45deg`,
//! `30arcmin`, `10arcsec`, `1mas`, `0.3rad`); rates are in Hz, with or without the unit.
//!
//! Method: the trailing letters are the unit, the rest is a [`Number`]; units are exact ratios of
//! seconds or degrees. A year is 365.25 d. Radians become degrees through 110 digits of pi.
//!
//! Limits: no sums of units (`1h30min`), no calendar months.
//!
//! # Example
//! ```
//! use mission::quantity::{degrees, seconds};
//!
//! assert_eq!(seconds("192.348min")?, seconds("11540.88s")?);
//! assert_eq!(degrees("30arcmin")?, degrees("0.5deg")?);
//! let told = seconds("20").map_err(|error| error.to_string());
//! assert_eq!(told, Err("20 has no unit: one of ns, us, ms, s, min, h, d, w, y is needed".to_owned()));
//! # Ok::<(), mission::quantity::QuantityError>(())
//! ```

use crate::number::{Number, NumberError};
use crate::rounding;
use num_rational::BigRational;
use thiserror::Error;

/// Why a text is not a quantity.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum QuantityError {
    /// The part before the unit is not a number.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// A number alone.
    #[error("{text} has no unit: one of {units} is needed")]
    MissingUnit {
        /// The text as typed.
        text: String,
        /// The legal units.
        units: String,
    },
    /// A unit of something else.
    #[error("{text} has the unit {unit}: one of {units} is needed")]
    UnknownUnit {
        /// The text as typed.
        text: String,
        /// Its unit.
        unit: String,
        /// The legal units.
        units: String,
    },
}

/// A unit as a name and the ratio to the base unit.
type Unit = (&'static str, i64, i64);

/// In seconds.
const DURATIONS: [Unit; 9] = [
    ("ns", 1, 1_000_000_000),
    ("us", 1, 1_000_000),
    ("ms", 1, 1000),
    ("s", 1, 1),
    ("min", 60, 1),
    ("h", 3600, 1),
    ("d", 86400, 1),
    ("w", 604_800, 1),
    ("y", 31_557_600, 1),
];
/// Other names of units, in letters of any case.
const ALIASES: [(&str, &str); 20] = [
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("mins", "min"),
    ("minute", "min"),
    ("minutes", "min"),
    ("hr", "h"),
    ("hrs", "h"),
    ("hour", "h"),
    ("hours", "h"),
    ("day", "d"),
    ("days", "d"),
    ("week", "w"),
    ("weeks", "w"),
    ("yr", "y"),
    ("year", "y"),
    ("years", "y"),
    ("degree", "deg"),
    ("degrees", "deg"),
];
/// In degrees; a radian is no ratio.
const ANGLES: [Unit; 5] =
    [("deg", 1, 1), ("arcmin", 1, 60), ("arcsec", 1, 3600), ("mas", 1, 3_600_000), ("rad", 0, 1)];

/// The exact seconds of a duration with its unit.
///
/// # Errors
/// [`QuantityError`] names the text and the legal units.
pub fn seconds(text: &str) -> Result<BigRational, QuantityError> {
    let (number, (_, above, below)) = with_unit(text, &DURATIONS)?;
    Ok(number.times(above, below))
}

/// The exact degrees of an angle with its unit.
///
/// # Errors
/// [`QuantityError`] names the text and the legal units.
pub fn degrees(text: &str) -> Result<BigRational, QuantityError> {
    let (number, (unit, above, below)) = with_unit(text, &ANGLES)?;
    Ok(if unit == "rad" { rounding::degrees(number.exact()) } else { number.times(above, below) })
}

/// The exact rate in Hz, with or without the unit.
///
/// # Errors
/// [`QuantityError`] names the text.
pub fn hertz(text: &str) -> Result<Number, QuantityError> {
    let (number, unit) = split(text);
    match unit {
        "" | "Hz" => Ok(Number::parse(number)?),
        _ => with_unit(text, &[("Hz", 1, 1)]).map(|(number, _)| number),
    }
}

/// The number and the trailing letters.
fn split(text: &str) -> (&str, &str) {
    let text = text.trim();
    let number = text.trim_end_matches(|c: char| c.is_alphabetic());
    (number, text.get(number.len()..).unwrap_or(""))
}

fn with_unit(text: &str, units: &[Unit]) -> Result<(Number, Unit), QuantityError> {
    let (number, unit) = split(text);
    let units_text = || units.iter().map(|unit| unit.0).collect::<Vec<_>>().join(", ");
    if number.is_empty() {
        return Err(NumberError::NotANumber(text.to_owned()).into());
    }
    let number = Number::parse(number)?;
    if unit.is_empty() {
        return Err(QuantityError::MissingUnit { text: text.to_owned(), units: units_text() });
    }
    let alias = ALIASES.iter().find(|it| it.0.eq_ignore_ascii_case(unit)).map(|it| it.1);
    let named = alias.unwrap_or(unit);
    units.iter().find(|known| known.0 == named).map(|known| (number, *known)).ok_or_else(|| {
        QuantityError::UnknownUnit {
            text: text.to_owned(),
            unit: unit.to_owned(),
            units: units_text(),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ratio(above: i64, below: i64) -> BigRational {
        BigRational::new(above.into(), below.into())
    }

    #[test]
    fn durations_are_exact_seconds() {
        assert_eq!(seconds("20d").unwrap(), ratio(1_728_000, 1));
        assert_eq!(seconds("3.2h").unwrap(), ratio(11520, 1));
        assert_eq!(seconds("192.348min").unwrap(), ratio(1_154_088, 100));
        assert_eq!(seconds("30 s").unwrap(), ratio(30, 1));
        assert_eq!(seconds("1.5y").unwrap(), ratio(47_336_400, 1));
        assert_eq!(seconds("2w").unwrap(), seconds("14 days").unwrap());
        assert_eq!(seconds("1.5 Years").unwrap(), seconds("1.5y").unwrap());
        assert_eq!(seconds("1e1ms").unwrap(), ratio(1, 100));
        assert_eq!(seconds("1/3h").unwrap(), ratio(1200, 1));
    }

    #[test]
    fn angles_are_exact_degrees() {
        assert_eq!(degrees("45deg").unwrap(), ratio(45, 1));
        assert_eq!(degrees("30arcmin").unwrap(), ratio(1, 2));
        assert_eq!(degrees("10arcsec").unwrap(), ratio(1, 360));
        assert_eq!(degrees("1mas").unwrap(), ratio(1, 3_600_000));
        let radian = crate::number::nearest(&degrees("0.3rad").unwrap());
        assert!((radian - 0.3_f64.to_degrees()).abs() < 1e-14);
    }

    #[test]
    fn rates_are_in_hertz() {
        assert_eq!(hertz("19").unwrap().text(), "19");
        assert_eq!(*hertz("20e6/1048576 Hz").unwrap().exact(), ratio(20_000_000, 1_048_576));
        assert_eq!(
            hertz("19rpm").unwrap_err().to_string(),
            "19rpm has the unit rpm: one of Hz is needed"
        );
    }

    #[test]
    fn a_wrong_or_missing_unit_is_named() {
        let sentence = |text: &str| seconds(text).unwrap_err().to_string();
        assert_eq!(
            sentence("20"),
            "20 has no unit: one of ns, us, ms, s, min, h, d, w, y is needed"
        );
        assert_eq!(
            sentence("20m"),
            "20m has the unit m: one of ns, us, ms, s, min, h, d, w, y is needed"
        );
        assert_eq!(
            sentence("nan"),
            "\"nan\" is not a number: a decimal such as 192.348 or 1e-3, or a quotient such as \
             20e6/1048576, is needed"
        );
        assert_eq!(
            degrees("45").unwrap_err().to_string(),
            "45 has no unit: one of deg, arcmin, arcsec, mas, rad is needed"
        );
    }
}
