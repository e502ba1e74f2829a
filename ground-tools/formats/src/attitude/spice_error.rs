//! Why attitudes do not fit into SPICE kernels.

use ephem::time::format_utc;
use onboard_core::time::Instant;
use thiserror::Error;

/// Why a C-kernel cannot hold the attitudes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum SpiceError {
    /// There are none.
    #[error("a SPICE C-kernel holds attitudes, and this plan has no session")]
    Empty,
    /// An instant that the clock kernel does not reach.
    #[error(
        "{} lies outside the SPICE clock, which runs from 2000-01-01T12:00:00 TAI to 2285",
        format_utc(*_0)
    )]
    OutsideClock(Instant),
    /// More numbers than its addresses can name.
    #[error("the C-kernel would hold {0} numbers, more than its addresses can name")]
    TooLarge(usize),
}
