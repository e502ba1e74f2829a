//! Which sequence number goes with what is sent up: refused here where the spacecraft would refuse it.
//!
//! # Example
//! ```
//! use formats::sequence::number;
//!
//! assert_eq!(number(None, 7), Ok(8));
//! assert!(number(Some(u32::MAX), 7).is_err());
//! ```

use crate::products::ALWAYS;
use crate::uplink::legal;
use onboard_core::uplink::{Tables, check_sequence};
use std::path::Path;

/// The uplink table among a plan's files.
const UPLINK: &str = ALWAYS[4];

/// The number that is asked for, or the one after the newest on board, the option `--after`.
///
/// # Errors
/// A sentence where the number does not follow.
pub fn number(asked: Option<u32>, after: u32) -> Result<u32, String> {
    following(asked, after, "--after N names the newest number on board")
}

/// As [`number`]; the uplink table of an earlier plan's folder counts as on board.
///
/// # Errors
/// A sentence where the number does not follow.
pub fn number_after_plan(
    asked: Option<u32>,
    after: u32,
    earlier: Option<&Path>,
) -> Result<u32, String> {
    let before = earlier.and_then(|folder| {
        let bytes = std::fs::read(folder.join(UPLINK)).ok()?;
        Some(Tables::load(&bytes).ok()?.header().sequence)
    });
    match before {
        Some(before) if before > after => {
            following(asked, before, "the plan of --against has the number before; or --after N")
        }
        _ => number(asked, after),
    }
}

fn following(asked: Option<u32>, newest: u32, hint: &str) -> Result<u32, String> {
    let Some(first) = newest.checked_add(1) else {
        return Err(format!("--after {newest} is not legal: no number is above it"));
    };
    let sequence = asked.unwrap_or(first);
    check_sequence(sequence, Some(newest)).map_err(|_| {
        format!("--sequence {sequence} is not legal: {} are ({hint})", legal(newest))
    })?;
    Ok(sequence)
}
