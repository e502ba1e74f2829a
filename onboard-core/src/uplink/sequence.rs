//! Which number may follow which.
//!
//! Containers and clock correlations each carry a number that grows with every one that is sent. A
//! number follows another when it is greater by 1 to [`MAX_SEQUENCE_STEP`]; the first one ever follows
//! 0. So one wrong number cannot use up all that could still come.
//!
//! Rollback orders carry no number of their own: they name two that are in the slots.

/// The largest step from one sequence number to the next.
pub const MAX_SEQUENCE_STEP: u32 = 1000;

/// Why a sequence number may not follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SequenceError {
    /// It is not above the newest one.
    Older {
        /// The number that is refused.
        candidate: u32,
        /// The newest one seen.
        newest: u32,
    },
    /// It is further above the newest one than [`MAX_SEQUENCE_STEP`].
    StepTooLarge {
        /// The number that is refused.
        candidate: u32,
        /// The newest one seen, 0 where there was none.
        newest: u32,
    },
}

/// Checks a number against the newest one seen.
///
/// # Errors
/// [`SequenceError`] with both.
// REQ-NUMBER-1.
pub const fn check_sequence(candidate: u32, newest: Option<u32>) -> Result<(), SequenceError> {
    let newest = match newest {
        Some(newest) => newest,
        None => 0,
    };
    if candidate <= newest {
        Err(SequenceError::Older { candidate, newest })
    } else if candidate.wrapping_sub(newest) > MAX_SEQUENCE_STEP {
        Err(SequenceError::StepTooLarge { candidate, newest })
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    // REQ-NUMBER-1.
    fn a_number_follows_within_the_step() {
        let older = |candidate, newest| Err(SequenceError::Older { candidate, newest });
        let far = |candidate, newest| Err(SequenceError::StepTooLarge { candidate, newest });
        assert_eq!(check_sequence(1, None), Ok(()));
        assert_eq!(check_sequence(0, None), older(0, 0));
        assert_eq!(check_sequence(1000, None), Ok(()));
        assert_eq!(check_sequence(1001, None), far(1001, 0));
        assert_eq!(check_sequence(u32::MAX, None), far(u32::MAX, 0));
        assert_eq!(check_sequence(8, Some(8)), older(8, 8));
        assert_eq!(check_sequence(7, Some(8)), older(7, 8));
        assert_eq!(check_sequence(9, Some(8)), Ok(()));
        assert_eq!(check_sequence(1008, Some(8)), Ok(()));
        assert_eq!(check_sequence(1009, Some(8)), far(1009, 8));
        assert_eq!(check_sequence(u32::MAX, Some(u32::MAX - 1)), Ok(()));
        assert_eq!(check_sequence(u32::MAX, Some(u32::MAX)), older(u32::MAX, u32::MAX));
    }
}
