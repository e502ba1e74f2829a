//! When must the search for a schedule end.
//!
//! The first interruption (Ctrl-C) ends the search with the best schedule so far; the second ends the
//! program with exit code 130.

use planner::progress::Progress;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that an interruption ends.
const BY_INTERRUPTION: i32 = 130;

/// A limit on the time of a search, and interruptions.
#[derive(Debug, Clone, Copy)]
pub struct SearchLimit {
    begun: Instant,
    seconds: Option<f64>,
}

impl SearchLimit {
    /// Begins now; listens to interruptions from here on.
    #[must_use]
    pub fn new(seconds: Option<f64>) -> Self {
        // A second plan in one process keeps the first one's handler.
        let _ = ctrlc::set_handler(|| {
            if INTERRUPTED.swap(true, Ordering::Relaxed) {
                std::process::exit(BY_INTERRUPTION);
            }
        });
        Self { begun: Instant::now(), seconds }
    }

    /// Why it ended, for the timeline.
    #[must_use]
    pub fn told(&self) -> String {
        match self.seconds {
            Some(limit) if !INTERRUPTED.load(Ordering::Relaxed) => {
                format!("the time limit of {limit} s was reached: the best schedule so far")
            }
            _ => "interrupted: the best schedule so far".to_owned(),
        }
    }
}

impl Progress for SearchLimit {
    fn stopped(&self) -> bool {
        let late = |limit| self.begun.elapsed() >= Duration::from_secs_f64(limit);
        INTERRUPTED.load(Ordering::Relaxed) || self.seconds.is_some_and(late)
    }
}
