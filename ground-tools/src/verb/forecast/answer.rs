//! A forecast with what it was asked.

use planner::information::{Errors, Fisher, Forecast, Look, Row, Session, Windows};
use planner::world::World;

/// A forecast with what it was asked.
pub(super) struct Answer<'w> {
    /// The mission among the planets.
    pub(super) world: &'w World,
    /// Who looks.
    pub(super) looks: &'w [Look],
    /// Over which windows.
    pub(super) windows: &'w Windows,
    /// Only in these sessions.
    pub(super) sessions: Option<&'w [Session]>,
    /// What passes teach.
    pub(super) forecast: Forecast,
    /// What is told of it.
    pub(super) rows: Vec<Row>,
}

impl Answer<'_> {
    /// A look's errors by all targets over the mission.
    pub(super) fn errors(&self, look: usize) -> Errors {
        let mut sum = Fisher::default();
        for window in self.windows.of_kind(0) {
            sum.add(&self.forecast.together(look, window).fisher);
        }
        Errors::of(&sum)
    }
}
