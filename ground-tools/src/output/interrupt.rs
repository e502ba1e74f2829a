//! What happens when the program is interrupted (Ctrl-C, SIGTERM, SIGHUP).
//!
//! While a search or a survey listens ([`listen`]), the first interruption asks it to end; any other
//! removes unfinished files and ends the program with exit code 130.
//!
//! A limit on the size of files (`ulimit -f`) is an error of writing, not the end of the program.
//!
//! Limits: nothing can be done about SIGKILL; what it leaves is removed by the next plan there.

use super::unfinished;
use planner::progress::Progress;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

static LISTENING: AtomicBool = AtomicBool::new(false);
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that an interruption ends.
const BY_INTERRUPTION: i32 = 130;

/// Takes interruptions from here on; once in a process.
pub fn install() {
    // Where no handler can be set the system's own stays: the program ends, as asked.
    let _ = ctrlc::set_handler(|| {
        if LISTENING.load(Ordering::SeqCst) && !INTERRUPTED.swap(true, Ordering::SeqCst) {
            return;
        }
        unfinished::remove_all();
        std::process::exit(BY_INTERRUPTION);
    });
    #[cfg(unix)]
    {
        // With a handler of its own the signal no longer ends the program: the write fails instead.
        let noted = std::sync::Arc::new(AtomicBool::new(false));
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, noted);
    }
}

/// From here on the first interruption asks whoever looks at [`interrupted`] to end.
pub fn listen() {
    LISTENING.store(true, Ordering::SeqCst);
}

/// From here on an interruption ends the program at once.
pub fn listen_no_more() {
    LISTENING.store(false, Ordering::SeqCst);
}

/// Whether an interruption has come.
#[must_use]
pub fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}

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
        listen();
        Self { begun: Instant::now(), seconds }
    }

    /// Why it ended, for the timeline.
    #[must_use]
    pub fn told(&self) -> String {
        match self.seconds {
            Some(limit) if !interrupted() => {
                format!("the time limit of {limit} s was reached: the best schedule so far")
            }
            _ => "interrupted: the best schedule so far".to_owned(),
        }
    }
}

impl Progress for SearchLimit {
    fn stopped(&self) -> bool {
        let late = |limit| self.begun.elapsed() >= Duration::from_secs_f64(limit);
        interrupted() || self.seconds.is_some_and(late)
    }
}
