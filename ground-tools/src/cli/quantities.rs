//! Quantities of the command line, with their units; a fault names the option.

use crate::failure::Failure;
use ephem::time::parse_time;
use mission::number::{Number, nearest};
use mission::{quantity, rounding};
use onboard_core::time::Instant;

/// An angle in radians, rounded once.
///
/// # Errors
/// [`Failure::Input`] names the option and what is wrong with its text.
pub(crate) fn angle_rad(option: &str, text: &str) -> Result<f64, Failure> {
    let degrees =
        quantity::degrees(text).map_err(|error| Failure::Input(format!("{option}: {error}")))?;
    Ok(rounding::radians(&degrees))
}

/// Angles with their units and commas between, in degrees.
///
/// # Errors
/// [`Failure::Input`] names the option and what is wrong with its text.
pub(crate) fn angles_deg<const N: usize>(
    option: &str,
    text: &str,
    names: [&str; N],
) -> Result<[f64; N], Failure> {
    let wrong = |what: String| Failure::Input(format!("{option} {text}: {what}"));
    let parts: Vec<&str> = text.split(',').collect();
    let parts: [&str; N] = parts.try_into().map_err(|_| {
        let (last, first) = names.split_last().unwrap_or((&"", &[]));
        wrong(format!("{} and {last} with commas between are needed", first.join(", ")))
    })?;
    let mut angles = [0.0; N];
    for (angle, part) in angles.iter_mut().zip(parts) {
        let exact = quantity::degrees(part).map_err(|error| wrong(error.to_string()))?;
        *angle = nearest(&exact);
    }
    Ok(angles)
}

/// A rate in Hz, exact.
///
/// # Errors
/// [`Failure::Input`] names the option and what is wrong with its text.
pub(crate) fn rate_hz(option: &str, text: &str) -> Result<Number, Failure> {
    quantity::hertz(text).map_err(|error| Failure::Input(format!("{option}: {error}")))
}

/// An instant with its time scale.
///
/// # Errors
/// [`Failure::Input`] names the option and what is wrong with its text.
pub(crate) fn instant(option: &str, text: &str) -> Result<Instant, Failure> {
    parse_time(text).map_err(|error| Failure::Input(format!("{option}: {error}")))
}

/// An error of interpolation in seconds of arc, for clap, which names the option.
pub(super) fn arcseconds(text: &str) -> Result<f64, String> {
    let value = Number::parse(text).map_err(|error| error.to_string())?.to_f64();
    if (1e-3..=60.0).contains(&value) {
        Ok(value)
    } else {
        Err(format!("{text} arcsec: an error from 0.001 to 60 arcsec is needed"))
    }
}
