//! The quantities that a pass teaches.
//!
//! | parameter | unit | the signal's change |
//! |---|---|---|
//! | `gain` | fraction | of its amplitude |
//! | `offset_x`, `offset_y` | rad | of the beam's centre along the detector's x and y |
//! | `width` | fraction | of the beam's width, all directions alike |
//! | `e_plus`, `e_cross` | | `(C_xx - C_yy) / (C_xx + C_yy)` and `2 C_xy / (C_xx + C_yy)` of the beam's C |
//! | `time_constant` | s | of a response 1 / (1 + i w tau) |
//! | `polarisation_angle` | rad | of the detector's angle of polarisation |
//!
//! The beam is exp(-u C^-1 u / 2) about its centre; the ratio of its axes is 1 + e to first order.

use mission::requirement::Quantity;

/// How many there are.
pub const COUNT: usize = 8;

/// A quantity that a pass teaches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Parameter {
    /// The gain, as a fraction of itself.
    Gain,
    /// The beam's centre along the detector's x axis in radians.
    OffsetX,
    /// The beam's centre along the detector's y axis in radians.
    OffsetY,
    /// The beam's width, as a fraction of itself.
    Width,
    /// Ellipticity along the axes.
    EPlus,
    /// Ellipticity between the axes.
    ECross,
    /// The detector's time constant in seconds.
    TimeConstant,
    /// The detector's angle of polarisation in radians.
    PolarisationAngle,
}

impl Parameter {
    /// All, in the order of a matrix's rows.
    pub const EACH: [Self; COUNT] = [
        Self::Gain,
        Self::OffsetX,
        Self::OffsetY,
        Self::Width,
        Self::EPlus,
        Self::ECross,
        Self::TimeConstant,
        Self::PolarisationAngle,
    ];

    /// Its row in a matrix.
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::Gain => 0,
            Self::OffsetX => 1,
            Self::OffsetY => 2,
            Self::Width => 3,
            Self::EPlus => 4,
            Self::ECross => 5,
            Self::TimeConstant => 6,
            Self::PolarisationAngle => 7,
        }
    }

    /// Its name in outputs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gain => "gain",
            Self::OffsetX => "offset_x",
            Self::OffsetY => "offset_y",
            Self::Width => "width",
            Self::EPlus => "e_plus",
            Self::ECross => "e_cross",
            Self::TimeConstant => "time_constant",
            Self::PolarisationAngle => "polarisation_angle",
        }
    }

    /// The quantity of requirements that it belongs to.
    #[must_use]
    pub const fn quantity(self) -> Quantity {
        match self {
            Self::Gain => Quantity::Gain,
            Self::OffsetX | Self::OffsetY => Quantity::Offset,
            Self::Width => Quantity::Width,
            Self::EPlus | Self::ECross => Quantity::Ellipticity,
            Self::TimeConstant => Quantity::TimeConstant,
            Self::PolarisationAngle => Quantity::PolarisationAngle,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_in_order() {
        for (row, it) in Parameter::EACH.into_iter().enumerate() {
            assert_eq!(it.index(), row);
        }
    }
}
