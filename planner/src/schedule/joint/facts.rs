//! What rows and cells need to know of each session of the model beyond its reserved time.

use crate::schedule::model::Model;
use crate::schedule::problem::Problem;

/// Target, telescope and time of producing data of each session.
#[derive(Debug)]
pub(crate) struct Facts {
    /// Per session, from when until when it produces data.
    pub(crate) produces: Vec<(i64, i64)>,
    /// Target and telescope.
    pub(crate) of: Vec<(usize, usize)>,
}

impl Facts {
    pub(crate) fn new(problem: &Problem, model: &Model) -> Self {
        let candidates = model.sessions.iter().map(|it| &problem.candidates[it.candidate]);
        Self {
            produces: candidates
                .clone()
                .map(|it| (it.first_entry.tai_ns(), it.last_exit.tai_ns()))
                .collect(),
            of: candidates.map(|it| (it.target, it.telescope)).collect(),
        }
    }
}
