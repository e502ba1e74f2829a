//! A forecast with what it was asked and what is told of it: of all passes, or of a plan's sessions.
//!
//! Method: where a plan's sessions miss a requirement, all passes are summed too, so that each miss has
//! its reason ([`Why`](super::Why)). [`one_of_each`] takes of every channel the detector that is nearest
//! the middle of the channel's, so that a plan of thousands of detectors is judged in seconds.
//!
//! Limits: those of a forecast; a detector at the edge of its field may have fewer passes than the one
//! that is judged for it.

use super::error::InformationError;
use super::errors::Errors;
use super::fisher::Fisher;
use super::forecast::{Forecast, Lesson, Question, Session, forecast};
use super::rows::{Row, Verdict, rows, verdicts, windows_of};
use super::sight::Look;
use super::window::Windows;
use crate::progress::Progress;
use crate::world::World;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::time::Duration;
use std::collections::{BTreeMap, BTreeSet};

/// A forecast with what it was asked and what is told of it.
#[derive(Debug, Clone)]
pub struct Teaching {
    /// Who looks.
    pub looks: Vec<Look>,
    /// Over which windows; those of the first kind are the plain rows'.
    pub windows: Windows,
    /// Only in these sessions.
    pub sessions: Option<Vec<Session>>,
    /// What passes teach.
    pub forecast: Forecast,
    /// What is told of it.
    pub rows: Vec<Row>,
    requirements: usize,
}

impl Teaching {
    /// What passes teach these looks: in windows of a length, or over the mission; in sessions, or all.
    ///
    /// # Errors
    /// As [`forecast`].
    pub fn of(
        world: &World,
        table: EphemerisTable<'_>,
        looks: Vec<Look>,
        (every, sessions): (Option<Duration>, Option<Vec<Session>>),
        progress: &dyn Progress,
    ) -> Result<Self, InformationError> {
        let requirements = &world.mission.calibration.requirements;
        let targets = world.targets.len();
        let windows = Windows::new((world.start, world.end), &windows_of(every, requirements));
        let question = Question { looks: &looks, windows: &windows, sessions: sessions.as_deref() };
        let found = forecast(world, table, &question, progress)?;
        let told = rows(&found, &looks, &windows, targets, requirements);
        let missed = told.iter().any(|it| it.met() == Some(false));
        let all = if missed && sessions.is_some() {
            let question = Question { sessions: None, ..question };
            let found = forecast(world, table, &question, progress)?;
            rows(&found, &looks, &windows, targets, requirements)
        } else {
            told.clone()
        };
        // Rows of requirements are the same ones in both.
        let mut all = all.iter().filter(|it| it.requirement.is_some()).map(|it| it.value);
        let rows = told
            .into_iter()
            .map(|row| match row.requirement {
                None => row,
                Some(_) => row.explained(all.next().flatten()),
            })
            .collect();
        let requirements = requirements.len();
        Ok(Self { looks, windows, sessions, forecast: found, rows, requirements })
    }

    /// What all targets teach a look over the mission.
    #[must_use]
    pub fn lesson(&self, look: usize) -> Lesson {
        let mut sum = Lesson::default();
        for window in self.windows.of_kind(0) {
            sum.add(&self.forecast.together(look, window));
        }
        sum
    }

    /// A look's errors by all targets over the mission.
    #[must_use]
    pub fn errors(&self, look: usize) -> Errors {
        let mut sum = Fisher::default();
        for window in self.windows.of_kind(0) {
            sum.add(&self.forecast.together(look, window).fisher);
        }
        Errors::of(&sum)
    }

    /// Whether each requirement is met; `None` where it speaks of nobody here.
    #[must_use]
    pub fn verdicts(&self) -> Vec<Option<Verdict>> {
        verdicts(&self.rows, self.requirements)
    }
}

/// Of every telescope and channel the look that is nearest the middle of its looks, in their order.
#[must_use]
pub fn one_of_each(looks: Vec<Look>) -> Vec<Look> {
    let mut groups: BTreeMap<(Option<usize>, Option<String>), Vec<usize>> = BTreeMap::new();
    for (index, it) in looks.iter().enumerate() {
        groups.entry((it.line.telescope, it.channel.clone())).or_default().push(index);
    }
    let direction = |&index: &usize| looks[index].line.field.centre().xyz();
    let kept: BTreeSet<usize> = groups
        .values()
        .filter_map(|group| {
            // Directions' sum points to their middle; the nearest has the largest product with it.
            let mut sum = [0.0; 3];
            for it in group.iter().map(direction) {
                sum = std::array::from_fn(|axis| sum[axis] + it[axis]);
            }
            let along = |it: &usize| {
                direction(it).iter().zip(&sum).map(|(one, other)| one * other).sum::<f64>()
            };
            // Of equals the first.
            group.iter().rev().copied().max_by(|a, b| along(a).total_cmp(&along(b)))
        })
        .collect();
    let numbered = looks.into_iter().enumerate();
    numbered.filter(|(index, _)| kept.contains(index)).map(|it| it.1).collect()
}
