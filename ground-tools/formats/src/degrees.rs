//! Radians of the core as the degrees of text.
//!
//! # Example
//! ```
//! use formats::degrees::{positive, signed};
//!
//! let quarter_rad = std::f64::consts::FRAC_PI_2;
//! assert_eq!((signed(3.0 * quarter_rad), positive(-quarter_rad)), (-90.0, 270.0));
//! ```

/// Degrees in (-180, 180].
#[must_use]
pub fn signed(radians: f64) -> f64 {
    let degrees = radians.to_degrees();
    let wrapped = degrees - 360.0 * (degrees / 360.0).round();
    if wrapped <= -180.0 { wrapped + 360.0 } else { wrapped }
}

/// Degrees in [0, 360).
#[must_use]
pub fn positive(radians: f64) -> f64 {
    let wrapped = radians.to_degrees().rem_euclid(360.0);
    // A tiny negative angle rounds up to a whole turn.
    if wrapped >= 360.0 { 0.0 } else { wrapped }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn ranges_are_half_open_on_their_own_side() {
        for (radians, s, p) in [
            (0.0, 0.0, 0.0),
            (PI, 180.0, 180.0),
            (-PI, 180.0, 180.0),
            (-0.5 * PI, -90.0, 270.0),
            (3.5 * PI, -90.0, 270.0),
            (-1e-20, -1e-20_f64.to_degrees(), 0.0),
        ] {
            assert!((signed(radians) - s).abs() < 1e-12, "{radians}");
            assert!((positive(radians) - p).abs() < 1e-12, "{radians}");
        }
    }
}
