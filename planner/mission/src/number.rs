//! What number did the user write, exactly.
//!
//! A [`Number`] keeps decimal text and the rational it stands for: 192.348 is 192348/1000, never the
//! nearest f64.
//!
//! Method: big rationals. A number is `[sign] digits [. digits] [e [sign] digits]`, or the quotient
//! of two such, `20e6/1048576`.
//!
//! Limits: exponents from -300 to 300 and at most 1,000 characters, so that no text costs more than
//! microseconds.
//!
//! # Example
//! LiteBIRD's sampling rate as its clock gives it; no f64 comes between the text and the rational:
//! ```
//! use mission::number::Number;
//!
//! let rate_hz = Number::parse("20e6/1048576")?;
//! assert_eq!(rate_hz.text(), "20e6/1048576");
//! assert_eq!(rate_hz.times(1_048_576, 1), *Number::parse("20000000")?.exact());
//! assert_eq!(rate_hz.to_f64(), 19.073_486_328_125);
//! # Ok::<(), mission::number::NumberError>(())
//! ```

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Pow, Signed, ToPrimitive, Zero};
use std::fmt;
use thiserror::Error;

const MAX_TEXT: usize = 1000;
const MAX_EXPONENT: i32 = 300;
/// Decimals beyond which a computed number is written as a quotient.
const MAX_DECIMALS: u32 = 40;

/// A number with the text that it was written as.
#[derive(Clone, PartialEq, Eq)]
pub struct Number {
    text: String,
    exact: BigRational,
}

/// Why a text is not a number.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum NumberError {
    /// Neither a decimal nor a quotient of two.
    #[error(
        "{0:?} is not a number: a decimal such as 192.348 or 1e-3, or a quotient such as 20e6/1048576, is needed"
    )]
    NotANumber(String),
    /// A quotient with a zero below.
    #[error("{0} divides by zero")]
    DivisionByZero(String),
    /// An exponent outside the limits, or a text too long to be meant.
    #[error("{0} is beyond what is read: an exponent from -300 to 300 is needed")]
    TooLarge(String),
}

impl fmt::Debug for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Number {
    /// The number zero.
    #[must_use]
    pub fn zero() -> Self {
        Self { text: "0".to_owned(), exact: BigRational::zero() }
    }

    /// Reads a decimal or a quotient of two decimals.
    ///
    /// # Errors
    /// [`NumberError`] carries the text.
    pub fn parse(text: &str) -> Result<Self, NumberError> {
        let text = text.trim();
        if text.len() > MAX_TEXT {
            let start: String = text.chars().take(20).collect();
            return Err(NumberError::TooLarge(format!("{start}...")));
        }
        let bad = |part: &str| {
            if has_decimal_form(part) {
                NumberError::TooLarge(text.to_owned())
            } else {
                NumberError::NotANumber(text.to_owned())
            }
        };
        let part = |part: &str| decimal(part.trim()).ok_or_else(|| bad(part.trim()));
        let exact = match text.split_once('/') {
            None => part(text)?,
            Some((above, below)) => {
                let (above, below) = (part(above)?, part(below)?);
                if below.is_zero() {
                    return Err(NumberError::DivisionByZero(text.to_owned()));
                }
                above / below
            }
        };
        Ok(Self { text: text.strip_prefix('+').unwrap_or(text).to_owned(), exact })
    }

    /// The number of a rational: a decimal where one of at most 40 places is exact, else a quotient.
    #[must_use]
    pub fn from_exact(exact: BigRational) -> Self {
        let text =
            terminating(&exact).unwrap_or_else(|| format!("{}/{}", exact.numer(), exact.denom()));
        Self { text, exact }
    }

    /// The text as written, without a plus sign before it.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The rational.
    #[must_use]
    pub const fn exact(&self) -> &BigRational {
        &self.exact
    }

    /// The nearest f64; infinite beyond its range.
    #[must_use]
    pub fn to_f64(&self) -> f64 {
        nearest(&self.exact)
    }

    /// The number times `above` / `below`, which must not be zero.
    #[must_use]
    pub fn times(&self, above: i64, below: i64) -> BigRational {
        &self.exact * BigRational::new(above.into(), below.into())
    }

    /// The text as TOML: bare where TOML reads it as a number, else in quotes.
    #[must_use]
    pub fn toml(&self) -> String {
        if is_toml_number(&self.text) { self.text.clone() } else { format!("\"{}\"", self.text) }
    }
}

/// The f64 nearest to a rational, ties to even; infinite beyond the range of f64.
#[must_use]
pub fn nearest(exact: &BigRational) -> f64 {
    exact.to_f64().unwrap_or(f64::INFINITY)
}

/// The parts of a decimal: negative, integer digits, fraction digits, exponent.
fn decimal_parts(text: &str) -> Option<(bool, &str, &str, &str)> {
    let (negative, rest) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let (mantissa, exponent) = match rest.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (rest, None),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let all_digits = |digits: &str| digits.bytes().all(|byte| byte.is_ascii_digit());
    if whole.len() + fraction.len() == 0 || !all_digits(whole) || !all_digits(fraction) {
        return None;
    }
    if let Some(exponent) = exponent {
        let digits = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
        if digits.is_empty() || !all_digits(digits) {
            return None;
        }
    }
    Some((negative, whole, fraction, exponent.unwrap_or("0")))
}

fn has_decimal_form(text: &str) -> bool {
    decimal_parts(text).is_some()
}

fn decimal(text: &str) -> Option<BigRational> {
    let (negative, whole, fraction, exponent) = decimal_parts(text)?;
    let exponent: i32 = exponent.parse().ok()?;
    if exponent.abs() > MAX_EXPONENT {
        return None;
    }
    let digits = BigInt::parse_bytes(format!("{whole}{fraction}").as_bytes(), 10)?;
    let places = i32::try_from(fraction.len()).ok()?;
    let magnitude = BigRational::from_integer(digits) * ten_to(exponent - places);
    Some(if negative { -magnitude } else { magnitude })
}

fn ten_to(exponent: i32) -> BigRational {
    let power = BigRational::from_integer(Pow::pow(BigInt::from(10), exponent.unsigned_abs()));
    if exponent < 0 { power.recip() } else { power }
}

/// The decimal of a rational that has one of at most [`MAX_DECIMALS`] places.
fn terminating(exact: &BigRational) -> Option<String> {
    let places = (0..=MAX_DECIMALS)
        .find(|&places| (BigInt::from(10).pow(places) % exact.denom()).is_zero())?;
    let scaled =
        (exact.abs() * BigRational::from_integer(BigInt::from(10).pow(places))).to_integer();
    let sign = if exact.is_negative() { "-" } else { "" };
    let width = usize::try_from(places).ok()?;
    let digits = format!("{scaled:0>width$}", width = width + 1);
    let (whole, fraction) = digits.split_at(digits.len() - width);
    Some(if fraction.is_empty() {
        format!("{sign}{whole}")
    } else {
        format!("{sign}{whole}.{fraction}")
    })
}

/// Whether TOML reads the text as a number, an integer within i64.
fn is_toml_number(text: &str) -> bool {
    let unsigned = text.strip_prefix('-').unwrap_or(text);
    let (mantissa, exponent) =
        unsigned.split_once(['e', 'E']).map_or((unsigned, false), |(mantissa, _)| (mantissa, true));
    let (whole, fraction) =
        mantissa.split_once('.').map_or((mantissa, None), |(whole, rest)| (whole, Some(rest)));
    has_decimal_form(text)
        && !whole.is_empty()
        && (whole == "0" || !whole.starts_with('0'))
        && fraction != Some("")
        && (exponent || fraction.is_some() || whole.len() <= 18)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn number(text: &str) -> Number {
        Number::parse(text).unwrap()
    }

    #[test]
    fn text_is_read_exactly() {
        let ratio = |above: i64, below: i64| BigRational::new(above.into(), below.into());
        assert_eq!(*number("192.348").exact(), ratio(192_348, 1000));
        assert_eq!(*number("1e-3").exact(), ratio(1, 1000));
        assert_eq!(*number("-.5E+1").exact(), ratio(-5, 1));
        assert_eq!(*number("20e6/1048576").exact(), ratio(20_000_000, 1_048_576));
        assert_eq!(*number(" 1 / 3 ").exact(), ratio(1, 3));
        assert_eq!(number("+47.50").text(), "47.50");
    }

    #[test]
    fn other_text_is_refused() {
        for bad in ["", ".", "-", "1e", "1e+", "nan", "inf", "1_000", "0x10", "1/2/3", "1 2", "١"]
        {
            assert_eq!(Number::parse(bad), Err(NumberError::NotANumber(bad.to_owned())), "{bad}");
        }
        assert_eq!(Number::parse("1/0.0"), Err(NumberError::DivisionByZero("1/0.0".to_owned())));
        for huge in ["1e301", "1e-301", "1e99999999999999999999"] {
            assert_eq!(Number::parse(huge), Err(NumberError::TooLarge(huge.to_owned())));
        }
        assert!(matches!(Number::parse(&"9".repeat(1001)), Err(NumberError::TooLarge(_))));
    }

    #[test]
    fn a_computed_number_has_the_shortest_exact_text() {
        let text = |a: i64, b: i64| Number::from_exact(BigRational::new(a.into(), b.into())).text;
        assert_eq!(text(547_875, 1000), "547.875");
        assert_eq!(text(-1, 8), "-0.125");
        assert_eq!(text(20, 1), "20");
        assert_eq!(text(2, 15), "2/15");
        assert_eq!(text(0, 7), "0");
    }

    #[test]
    fn toml_text_is_bare_where_toml_allows() {
        for bare in ["0", "-1", "45.0", "1e-3", "2E+5", "-0.5"] {
            assert_eq!(number(bare).toml(), bare);
        }
        for quoted in [".5", "5.", "007", "1/3", "1234567890123456789012"] {
            assert_eq!(number(quoted).toml(), format!("\"{quoted}\""));
        }
    }

    proptest! {
        #[test]
        fn nearest_agrees_with_the_standard_reader(digits: i64, exponent in -250..250_i32) {
            let text = format!("{digits}e{exponent}");
            let standard: f64 = text.parse().unwrap();
            prop_assert_eq!(number(&text).to_f64().to_bits(), standard.to_bits());
        }

        #[test]
        fn computed_text_reads_back(above: i64, below in 1..i64::MAX) {
            let made = Number::from_exact(BigRational::new(above.into(), below.into()));
            prop_assert_eq!(number(made.text()), made);
        }

        #[test]
        fn no_text_panics(text in "[-+0-9./eE nN]{0,12}") {
            if let Ok(read) = Number::parse(&text) {
                prop_assert!(!read.to_f64().is_nan());
            }
        }
    }
}
