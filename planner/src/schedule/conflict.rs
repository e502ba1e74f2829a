//! Which rules contradict each other, and how little would have to give way.
//!
//! Method: of what must be met (sessions per season, fixed sessions) as much as possible is met, by
//! the same programme with nothing else to gain. If the exact bound says that not all can be, one
//! demand that cannot be met alone is singled out where there is one, and rules are left out one
//! after the other: a rule without which the rest still contradict each other is not to blame. What
//! remains contradicts itself and, rule for rule, no longer does without any one of them.
//!
//! Limits: the search for what can be met is cut by the same counts of work; where it ends without a
//! proof, no contradiction is claimed.

use super::demands::Demands;
use super::explain::Rule;
use super::model::Model;
use super::rows::{Facts, build};
use super::{Exclusive, Problem};
use crate::program::{Aids, Cell, Choice, Family, Gain, Limits, solve};
use onboard_core::time::Instant;
use std::fmt;

/// A rule by its key in mission files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum RuleName {
    /// Sessions must not overlap.
    Exclusive,
    /// Reserved time per day.
    MaxMinutesPerDay,
    /// Sessions per sliding window.
    MaxSessions,
    /// Sessions per season.
    MinSessions,
    /// Scan angles.
    ScanAngle,
    /// Memory and contacts.
    Data,
    /// Reserved time per sliding window.
    Thermal,
    /// Times when nothing is allowed.
    Blackouts,
    /// Sessions that a person asks for.
    Fixed,
    /// Sessions that a person forbids.
    Forbidden,
}

impl RuleName {
    const ALL: [Self; 10] = [
        Self::Forbidden,
        Self::Blackouts,
        Self::Thermal,
        Self::Data,
        Self::ScanAngle,
        Self::MaxSessions,
        Self::MaxMinutesPerDay,
        Self::Exclusive,
        Self::Fixed,
        Self::MinSessions,
    ];

    /// Whether a problem has the rule.
    fn binds(self, problem: &Problem) -> bool {
        let demands = &problem.demands;
        match self {
            Self::Exclusive => problem.rules.exclusive != Exclusive::None,
            Self::MaxMinutesPerDay => problem.rules.max_per_day.is_some(),
            Self::MaxSessions => problem.rules.max_sessions.is_some(),
            Self::MinSessions => demands.min_sessions.is_some(),
            Self::ScanAngle => !demands.diversity.is_empty(),
            Self::Data => demands.data.is_some(),
            Self::Thermal => demands.thermal.is_some(),
            Self::Blackouts => !demands.blackouts.is_empty(),
            Self::Fixed => !demands.fixed.is_empty(),
            Self::Forbidden => !demands.forbidden.is_empty(),
        }
    }

    /// Switches the rule off.
    fn leave_out(self, problem: &mut Problem) {
        let demands = &mut problem.demands;
        match self {
            Self::Exclusive => problem.rules.exclusive = Exclusive::None,
            Self::MaxMinutesPerDay => problem.rules.max_per_day = None,
            Self::MaxSessions => problem.rules.max_sessions = None,
            Self::MinSessions => demands.min_sessions = None,
            Self::ScanAngle => demands.diversity.clear(),
            Self::Data => demands.data = None,
            Self::Thermal => demands.thermal = None,
            Self::Blackouts => demands.blackouts.clear(),
            Self::Fixed => demands.fixed.clear(),
            Self::Forbidden => demands.forbidden.clear(),
        }
    }
}

impl fmt::Display for RuleName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exclusive => "exclusive",
            Self::MaxMinutesPerDay => "max_minutes_per_day",
            Self::MaxSessions => "max_sessions",
            Self::MinSessions => "min_sessions",
            Self::ScanAngle => "scan_angle",
            Self::Data => "data",
            Self::Thermal => "thermal",
            Self::Blackouts => "blackouts",
            Self::Fixed => "fixed sessions",
            Self::Forbidden => "forbidden sessions",
        })
    }
}

/// What cannot be met together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Conflict {
    /// Rules that contradict each other; without any one of them the rest do not.
    pub rules: Vec<RuleName>,
    /// Sessions that the demands ask for.
    pub wanted: usize,
    /// The most that can be met: asking for no more is the least change.
    pub possible: usize,
    /// The season that cannot be met, where one alone cannot: target, telescope and start.
    pub season: Option<(usize, usize, Instant)>,
}

impl fmt::Display for Conflict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<String> = self.rules.iter().map(ToString::to_string).collect();
        write!(
            f,
            "no schedule meets {} together: of {} sessions asked for",
            names.join(", "),
            self.wanted
        )?;
        if let Some((target, telescope, from)) = self.season {
            write!(
                f,
                " of target {target} on telescope {telescope} in the season from {} ns TAI",
                from.tai_ns()
            )?;
        }
        write!(f, ", at most {} can be had", self.possible)
    }
}

/// How much of what must be met can be: wanted, possible, and whether less is proved; the sessions of
/// the best attempt.
struct Attempt {
    wanted: usize,
    possible: usize,
    proved: bool,
    chosen: Vec<usize>,
    /// Seasons that fall short.
    short: Vec<(usize, usize, Instant)>,
}

/// Meets as much as possible, only one season where given.
fn attempt(problem: &Problem, only: Option<(usize, usize, Instant)>) -> Attempt {
    let (model, _) = Model::new(problem);
    let facts = Facts::new(problem, &model);
    let mut built = build(problem, &model, &facts);
    let program = &mut built.program;
    program.values.fill(0);
    program.cells.clear();
    let mut wanted = 0;
    let mut place = vec![None; problem.candidates.len()];
    for (id, session) in model.sessions.iter().enumerate() {
        place[session.candidate] = Some(id);
        program.choices[id] = Choice::Free;
    }
    for &candidate in &problem.demands.fixed {
        wanted += 1;
        // A fixed session that cannot stand at all is simply missing.
        if let Some(id) = place[candidate] {
            program.values[id] = 1;
        }
    }
    for season in &built.seasons {
        let Rule::MinSessions { target, telescope, from } = season.rule else { continue };
        if only.is_none_or(|only| only == (target, telescope, from)) {
            wanted += season.wanted;
            program.cells.push(Cell {
                terms: season.sessions.iter().map(|&id| (id, 1)).collect(),
                gain: Gain::Shortfall {
                    wanted: i64::try_from(season.wanted).unwrap_or(i64::MAX),
                    price: 1,
                },
                base: 0,
            });
        }
    }
    let families: Vec<&dyn Family> = built.families.iter().map(AsRef::as_ref).collect();
    let aids = Aids { families: &families, ..Aids::default() };
    let limits = Limits { work: 4_000_000_000, ..Limits::default() };
    let Ok(found) = solve(&built.program, &limits, &aids) else {
        return Attempt {
            wanted,
            possible: 0,
            proved: false,
            chosen: Vec::new(),
            short: Vec::new(),
        };
    };
    let taken = found.taken.unwrap_or_default();
    let whole = |number: i128| usize::try_from(number.max(0)).unwrap_or(0);
    let short = built.seasons.iter().filter_map(|season| {
        let held = season.sessions.iter().filter(|id| taken.binary_search(id).is_ok()).count();
        let Rule::MinSessions { target, telescope, from } = season.rule else { return None };
        (held < season.wanted).then_some((target, telescope, from))
    });
    Attempt {
        wanted,
        possible: whole(found.value),
        proved: whole(found.bound) < wanted,
        short: short.collect(),
        chosen: taken.iter().map(|&id| model.sessions[id].candidate).collect(),
    }
}

/// The contradiction among the rules; else a schedule that meets them, if one was found.
pub(super) fn find(problem: &Problem) -> Result<Option<Vec<usize>>, Conflict> {
    let whole = attempt(problem, None);
    if !whole.proved {
        return Ok((whole.possible >= whole.wanted).then_some(whole.chosen));
    }
    // A season that cannot be met alone makes for a smaller set.
    let alone = whole.short.iter().take(8).find_map(|&season| {
        let mut without = problem.clone();
        without.demands.fixed.clear();
        [&without, problem].into_iter().find_map(|problem| {
            let found = attempt(problem, Some(season));
            found.proved.then(|| (season, problem.clone(), found))
        })
    });
    let (season, mut problem, mut found) = match alone {
        Some((season, problem, found)) => (Some(season), problem, found),
        None => (None, problem.clone(), whole),
    };
    let mut rules: Vec<RuleName> =
        RuleName::ALL.into_iter().filter(|rule| rule.binds(&problem)).collect();
    for rule in RuleName::ALL {
        let mut less = problem.clone();
        rule.leave_out(&mut less);
        if rules.contains(&rule) && rules.len() > 1 {
            let again = attempt(&less, season);
            if again.proved {
                rules.retain(|it| *it != rule);
                (problem, found) = (less, again);
            }
        }
    }
    rules.sort_unstable();
    Err(Conflict { rules, wanted: found.wanted, possible: found.possible, season })
}

/// Whether anything must be met.
pub(super) const fn is_demanding(demands: &Demands) -> bool {
    demands.min_sessions.is_some() || !demands.fixed.is_empty()
}
