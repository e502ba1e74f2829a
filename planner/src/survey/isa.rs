//! Which instruction set the kernel runs on, chosen at run time.
//!
//! One generic function is compiled for each set; `pulp` holds the proof that the processor has it.

#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};
use thiserror::Error;

/// An instruction set that this processor has.
#[derive(Debug, Clone, Copy)]
pub enum Isa {
    /// AVX-512 (F, BW, CD, DQ, VL): eight numbers at a time.
    #[cfg(target_arch = "x86_64")]
    Avx512(V4),
    /// AVX2 and FMA: four numbers at a time.
    #[cfg(target_arch = "x86_64")]
    Avx2(V3),
    /// What every processor of the architecture has.
    Portable,
    /// Sample by sample, by the flight core and library functions.
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
    /// The best that this processor has.
    #[must_use]
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(it) = V4::try_new() {
                return Self::Avx512(it);
            }
            if let Some(it) = V3::try_new() {
                return Self::Avx2(it);
            }
        }
        Self::Portable
    }

    /// The set of that name.
    ///
    /// # Errors
    /// [`IsaError`] for a name that is not known, or a set that the processor does not have.
    pub fn named(name: &str) -> Result<Self, IsaError> {
        match name {
            "auto" => Ok(Self::best()),
            "portable" => Ok(Self::Portable),
            "plain" => Ok(Self::Plain),
            #[cfg(target_arch = "x86_64")]
            "avx512" => V4::try_new().map(Self::Avx512).ok_or(IsaError::Missing("avx512")),
            #[cfg(target_arch = "x86_64")]
            "avx2" => V3::try_new().map(Self::Avx2).ok_or(IsaError::Missing("avx2")),
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
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(_) => "avx512",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_) => "avx2",
            Self::Portable => "portable",
            Self::Plain => "plain",
        }
    }
}
