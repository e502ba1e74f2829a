//! Who watches a survey: a bar on standard error, and Ctrl-C, which ends it early; and why it fails.
//! A second Ctrl-C ends the program.

use crate::cli::SharedArgs;
use crate::failure::Failure;
use crate::output::interrupt;
use indicatif::{ProgressBar, ProgressStyle};
use planner::progress::Progress;
use planner::survey::SurveyError;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Samples done.
#[derive(Debug, Default)]
pub(super) struct Watch {
    samples: AtomicU64,
}

impl Progress for Watch {
    fn advance(&self, units: u64) {
        self.samples.fetch_add(units, Ordering::Relaxed);
    }

    fn stopped(&self) -> bool {
        interrupt::interrupted()
    }
}

impl Watch {
    /// A watch that Ctrl-C stops.
    pub(super) fn on_interrupt() -> Self {
        interrupt::listen();
        Self::default()
    }

    /// Samples of all detectors done.
    pub(super) fn samples(&self) -> u64 {
        self.samples.load(Ordering::Relaxed)
    }

    /// Does the work, of `total` samples, while a bar follows.
    pub(super) fn shown<T>(
        &self,
        shared: &SharedArgs,
        total: u64,
        work: impl FnOnce() -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let bar = &bar(shared, total);
        let (done, ended) = std::sync::mpsc::channel::<()>();
        let result = std::thread::scope(|scope| {
            scope.spawn(move || {
                while ended.recv_timeout(Duration::from_millis(100))
                    == Err(std::sync::mpsc::RecvTimeoutError::Timeout)
                {
                    bar.set_position(self.samples());
                    bar.set_message(format!("{:.1} M samples/s", bar.per_sec() / 1e6));
                }
            });
            let result = work();
            drop(done);
            result
        });
        bar.finish_and_clear();
        result
    }
}

/// A bar on standard error where that is a terminal.
fn bar(shared: &SharedArgs, total: u64) -> ProgressBar {
    if shared.quiet {
        return ProgressBar::hidden();
    }
    let style = "{wide_bar} {percent:>3}%  {msg}  {eta} left";
    let bar = ProgressBar::new(total);
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style);
    }
    bar
}

/// What a survey cannot have on checked input.
pub(super) fn failed(error: SurveyError) -> Failure {
    match error {
        SurveyError::Ephemeris(error) => Failure::internal(format!("{error:?}")),
        other => Failure::internal(other),
    }
}
