//! A systematic signal as fields on the sky with spins: what an effect is, apart from any sky.
//!
//! `d = sum over terms of 2 Re[f X(p) exp(i (n psi + m phi))]`, psi the crossing angle, phi the plate's
//! angle, X a field of the sky at the pixel's centre, f a number. In the notation of \[Takase2024\],
//! `S_nm = f X` and `S_(-n,-m)` its conjugate: a [`Term`] stands for both.
//!
//! X is the temperature or the polarisation, `P = Q + iU` of the COSMO sense, differentiated by eth
//! (`d_N - i d_E`) or its conjugate as often as the effect is of that order.

use crate::harmonics::Complex64;

/// A field of the sky.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SkyField {
    /// eth applied so many times to I: spin that number.
    Temperature(u8),
    /// eth, or for a negative number its conjugate, applied so many times to P: spin 2 and more or
    /// less.
    Polarisation(i8),
}

impl SkyField {
    /// I.
    pub const I: Self = Self::Temperature(0);
    /// Q + iU.
    pub const P: Self = Self::Polarisation(0);

    /// Its spin.
    #[must_use]
    pub fn spin(self) -> i32 {
        match self {
            Self::Temperature(raised) => i32::from(raised),
            Self::Polarisation(raised) => 2 + i32::from(raised),
        }
    }
}

/// `2 Re[factor X exp(i (n psi + m phi))]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// Of the crossing angle.
    pub n: i32,
    /// Of the plate's angle.
    pub m: i32,
    /// X.
    pub field: SkyField,
    /// f.
    pub factor: Complex64,
}

/// A systematic effect.
pub trait Effect: Sync {
    /// Its signal.
    fn terms(&self) -> Vec<Term>;
}
