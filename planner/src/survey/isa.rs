//! Which instruction set the kernel runs on, chosen at run time.
//!
//! One generic function is compiled for each set. An [`Isa`] is proof that the processor has the
//! set: it can be had by [`Isa::best`] and [`Isa::named`] only, save for those that every processor
//! has.
//!
//! Limits: hits are the same on every set, moments to 1e-10.

#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};
use thiserror::Error;

/// An instruction set that this processor has.
#[derive(Debug, Clone, Copy)]
pub struct Isa(Set);

/// The sets, each with the proof that it is there.
#[derive(Debug, Clone, Copy)]
pub(super) enum Set {
    /// AVX-512 (F, BW, CD, DQ, VL): eight numbers at a time.
    #[cfg(target_arch = "x86_64")]
    Avx512(V4),
    /// AVX2 and FMA: four numbers at a time.
    #[cfg(target_arch = "x86_64")]
    Avx2(V3),
    /// What every processor of the architecture has.
    Portable,
    /// Sample by sample.
    Plain,
}

/// An instruction set that is not known or not there.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum IsaError {
    /// No such name.
    #[error("{0} is no instruction set: auto, avx512, avx2, portable or plain is needed")]
    Unknown(String),
    /// Not on this processor.
    #[error("this processor has no {0}: auto takes the best that it has")]
    Missing(&'static str),
}

impl Isa {
    /// What every processor of the architecture has.
    pub const PORTABLE: Self = Self(Set::Portable);
    /// Sample by sample, by the flight core and library functions.
    pub const PLAIN: Self = Self(Set::Plain);

    /// The best that this processor has.
    #[must_use]
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(it) = V4::try_new() {
                return Self(Set::Avx512(it));
            }
            if let Some(it) = V3::try_new() {
                return Self(Set::Avx2(it));
            }
        }
        Self::PORTABLE
    }

    /// The set of that name: `auto`, `avx512`, `avx2`, `portable` or `plain`.
    ///
    /// # Errors
    /// [`IsaError`] for a name that is not known, or a set that the processor does not have.
    pub fn named(name: &str) -> Result<Self, IsaError> {
        match name {
            "auto" => Ok(Self::best()),
            "portable" => Ok(Self::PORTABLE),
            "plain" => Ok(Self::PLAIN),
            #[cfg(target_arch = "x86_64")]
            "avx512" => {
                V4::try_new().map(|it| Self(Set::Avx512(it))).ok_or(IsaError::Missing("avx512"))
            }
            #[cfg(target_arch = "x86_64")]
            "avx2" => V3::try_new().map(|it| Self(Set::Avx2(it))).ok_or(IsaError::Missing("avx2")),
            #[cfg(not(target_arch = "x86_64"))]
            "avx512" => Err(IsaError::Missing("avx512")),
            #[cfg(not(target_arch = "x86_64"))]
            "avx2" => Err(IsaError::Missing("avx2")),
            other => Err(IsaError::Unknown(other.to_owned())),
        }
    }

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Set::Avx512(_) => "avx512",
            #[cfg(target_arch = "x86_64")]
            Set::Avx2(_) => "avx2",
            Set::Portable => "portable",
            Set::Plain => "plain",
        }
    }

    pub(super) const fn set(self) -> Set {
        self.0
    }
}
