//! The threads that a computation runs on.

use super::definition::SurveyError;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// A pool of that many threads; 0 takes one for each core.
pub(crate) fn pool(threads: usize) -> Result<ThreadPool, SurveyError> {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|_| SurveyError::Threads { threads })
}
