//! Sensitivity: what loosening one rule by a step would bring, target by target.
//!
//! Method: the relaxation of the problem as it is, and once more with each rule loosened by a step
//! that people think in ([`Give`]). The differences of objective and of each target's time in view
//! are what the step brings while sessions may be taken in parts. Unlike a shadow price this holds
//! for the whole step, and says which target gains. Of more than [`MOST`] opportunities only those in
//! stretches spread evenly over the mission are looked at, a third of its time, each stretch at
//! least twice as long as any window of the rules.
//!
//! Limits: an estimate, not a bound: sessions are not taken in parts. Rules that forbid (blackouts,
//! avoidance, fixed and forbidden sessions) have no step.

use super::error::ScheduleError;
use super::joint::{Facts, build};
use super::model::Model;
use super::problem::Problem;
use crate::program::number::{f64_from_i128, u64_from_usize};
use crate::program::{Family, relaxed_shares};
use crate::progress::Progress;
use onboard_core::time::Duration;
use rayon::prelude::*;
use std::fmt;

/// Rounds of rows that the relaxed schedule breaks.
const ROUNDS: usize = 3;
/// Up to so many opportunities all are looked at.
const MOST: usize = 15_000;
/// Of more, those in stretches of at least so many days that take this part of the mission.
const STRETCH_DAYS: i64 = 14;
const PART: i64 = 3;
/// A target's time in view below this, in s, has no shares.
const LEAST_S: f64 = 1.0;
const DAY_NS: i64 = 86_400_000_000_000;

/// The step by which a rule is loosened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Give {
    /// Ten more minutes of reserved time per day.
    DayMinutes,
    /// One more session in each window of `max_sessions`.
    Session,
    /// A minute less between sessions: of the setup, or else of the cooldown.
    Setup,
    /// Ten more minutes of reserved time in each window of `thermal`.
    ThermalMinutes,
    /// A tenth more memory.
    Memory,
    /// A longest gap longer by a day.
    GapDay,
    /// One session fewer asked for in each season.
    SeasonSession,
    /// Every bound on scan angles larger by 0.01.
    ScanAngle,
}

impl fmt::Display for Give {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::DayMinutes => "10 more minutes per day",
            Self::Session => "1 more session per window",
            Self::Setup => "1 minute less between sessions",
            Self::ThermalMinutes => "10 more minutes per thermal window",
            Self::Memory => "10 % more memory",
            Self::GapDay => "1 more day without a session",
            Self::SeasonSession => "1 session fewer per season",
            Self::ScanAngle => "0.01 more of each rho",
        })
    }
}

impl Give {
    const ALL: [Self; 8] = [
        Self::DayMinutes,
        Self::Session,
        Self::Setup,
        Self::ThermalMinutes,
        Self::Memory,
        Self::GapDay,
        Self::SeasonSession,
        Self::ScanAngle,
    ];

    /// The key of the rule in mission files.
    #[must_use]
    pub const fn rule(self) -> &'static str {
        match self {
            Self::DayMinutes => "max_minutes_per_day",
            Self::Session => "max_sessions",
            Self::Setup => "exclusive",
            Self::ThermalMinutes => "thermal",
            Self::Memory => "data",
            Self::GapDay => "longest_gain_gap",
            Self::SeasonSession => "min_sessions",
            Self::ScanAngle => "scan_angle",
        }
    }

    /// The problem with its rule loosened; `None` where it has no such rule.
    fn apply(self, problem: &Problem) -> Option<Problem> {
        let mut looser = problem.clone();
        let (rules, demands) = (&mut looser.rules, &mut looser.demands);
        let longer = |it: &mut Duration, seconds: i64| {
            *it = Duration::from_ns(it.ns().saturating_add(seconds * 1_000_000_000));
        };
        match self {
            Self::DayMinutes => longer(rules.max_per_day.as_mut()?, 600),
            Self::Session => rules.max_sessions.as_mut()?.count += 1,
            Self::Setup => {
                let minute = 60_000_000_000;
                let both = [&mut rules.setup, &mut rules.cooldown];
                longer(both.into_iter().find(|it| it.ns() >= minute)?, -60);
            }
            Self::ThermalMinutes => longer(&mut demands.thermal.as_mut()?.most, 600),
            Self::Memory => {
                let memory = &mut demands.data.as_mut()?.memory_bit;
                *memory = memory.saturating_add(*memory / 10);
            }
            Self::GapDay => longer(&mut demands.longest_gap.as_mut()?.longest, 86_400),
            Self::SeasonSession => {
                let rule = demands.min_sessions.as_mut()?;
                rule.count = rule.count.checked_sub(1)?;
            }
            Self::ScanAngle => {
                demands.diversity.first()?;
                for rule in &mut demands.diversity {
                    rule.rho = (rule.rho + 0.01).min(1.0);
                }
            }
        }
        Some(looser)
    }
}

/// What loosening a rule would bring in the relaxation.
#[derive(Debug, Clone, PartialEq)]
pub struct Loosening {
    /// The step.
    pub give: Give,
    /// What the objective gains, as a share of what it is.
    pub objective: f64,
    /// What each target's time in view gains, as a share of what it is; `None` without any.
    pub dwell: Vec<Option<f64>>,
}

/// The relaxed schedule: objective, and each target's time in view in s.
fn relaxed(problem: &Problem) -> Option<(f64, Vec<f64>)> {
    let (model, _) = Model::new(problem);
    let facts = Facts::new(problem, &model);
    let built = build(problem, &model, &facts);
    let families: Vec<&dyn Family> = built.families.iter().map(AsRef::as_ref).collect();
    let (worth, shares) = relaxed_shares(&built.program, &families, ROUNDS)?;
    let mut dwell = vec![0.0; problem.weights.len()];
    for (session, share) in model.sessions.iter().zip(shares) {
        let it = &problem.candidates[session.candidate];
        dwell[it.target] += share * it.dwell.seconds();
    }
    Some((built.value(f64_from_i128(worth - built.offset)), dwell))
}

/// The problem with only the opportunities in stretches of the mission.
fn thinned(problem: &Problem) -> Problem {
    let mut thin = problem.clone();
    let demands = &problem.demands;
    let windows = [
        problem.rules.max_sessions.map(|it| it.window),
        demands.min_sessions.map(|it| it.window),
        demands.longest_gap.map(|it| it.longest),
        demands.thermal.map(|it| it.window),
        demands.log.as_ref().map(|it| it.epoch),
    ];
    let longest = windows.into_iter().flatten().map(Duration::ns).max().unwrap_or(0);
    let (from, until) = problem.span;
    let mission = until.since(from).ns().max(1);
    let stretch = longest.saturating_mul(2).max(STRETCH_DAYS * DAY_NS);
    let count = (mission / PART / stretch).max(1);
    // Whole days, so that stretches do not cut them.
    let period = mission / count / DAY_NS * DAY_NS;
    let outside = (0..problem.candidates.len()).filter(|&candidate| {
        let since = problem.candidates[candidate].first_entry.since(from).ns();
        since.rem_euclid(period.max(1)) >= stretch
    });
    // As if avoided: seasons do not ask for them.
    thin.demands.avoided.extend(outside);
    thin.demands.avoided.sort_unstable();
    thin.demands.avoided.dedup();
    thin.demands.fixed.retain(|it| thin.demands.avoided.binary_search(it).is_err());
    thin
}

/// What loosening each rule would bring, the most rewarding first. Rules whose relaxation cannot be
/// solved are left out; all are once `progress` asks to stop.
///
/// # Errors
/// [`ScheduleError`] when the problem is not well posed.
pub fn loosen(problem: &Problem, progress: &dyn Progress) -> Result<Vec<Loosening>, ScheduleError> {
    problem.validate()?;
    let thin = (problem.candidates.len() > MOST).then(|| thinned(problem));
    let problem = thin.as_ref().unwrap_or(problem);
    let steps: Vec<(Give, Problem)> = Give::ALL
        .into_iter()
        .filter_map(|give| give.apply(problem).map(|looser| (give, looser)))
        .collect();
    progress.begin("loosened rules", u64_from_usize(steps.len()).saturating_add(1));
    let relaxed = |problem: &Problem| {
        let found = if progress.stopped() { None } else { relaxed(problem) };
        progress.advance(1);
        found
    };
    let (before, after) = rayon::join(
        || relaxed(problem),
        || steps.par_iter().map(|(_, looser)| relaxed(looser)).collect::<Vec<_>>(),
    );
    let Some((objective, dwell)) = before else { return Ok(Vec::new()) };
    let share = |gain: f64, of: f64| if of.abs() > 0.0 { gain / of.abs() } else { 0.0 };
    let mut all: Vec<Loosening> = steps
        .iter()
        .zip(after)
        .filter_map(|((give, _), after)| {
            let (loosened, longer) = after?;
            let dwell = dwell.iter().zip(longer);
            Some(Loosening {
                give: *give,
                // Less can only come from the solver's tolerance.
                objective: share((loosened - objective).max(0.0), objective),
                dwell: dwell
                    .map(|(&was, is)| (was >= LEAST_S).then(|| share(is - was, was)))
                    .collect(),
            })
        })
        .collect();
    all.sort_by(|a, b| b.objective.total_cmp(&a.objective).then(a.give.cmp(&b.give)));
    Ok(all)
}
