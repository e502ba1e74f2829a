//! Epochs in their time system.

use super::error::CcsdsError;
use crate::time::{Scale, parse_in_scale};
use onboard_core::time::Instant;

/// The instant of an epoch: a calendar date or a day of the year, rounded to the ns.
///
/// Its text may end in `Z` on UTC.
///
/// # Errors
/// [`CcsdsError::Time`] with line, keyword and text.
pub fn epoch(line: usize, key: &str, text: &str, scale: Scale) -> Result<Instant, CcsdsError> {
    let zulu = if scale == Scale::Utc { text.strip_suffix(['Z', 'z']) } else { None };
    parse_in_scale(zulu.unwrap_or(text), scale).map_err(|fault| CcsdsError::Time {
        line,
        key: key.to_owned(),
        fault,
    })
}
