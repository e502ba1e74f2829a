//! A minimal infeasible subset of the rules, and how little would have to give way.
//!
//! Method: of what must be met (sessions per season, fixed sessions) as much as possible is met, by
//! the same programme with nothing else to gain. If the exact bound says that not all can be, one
//! season that cannot be met alone is singled out where there is one, and a deletion filter (Chinneck
//! and Dravnieks 1991) leaves out one rule after the other: a rule without which the rest are still
//! infeasible does not belong to the subset. What remains is infeasible, and feasible without any one
//! of its rules.
//!
//! Limits: the search for what can be met is cut by counts of work; where it ends without a proof, no
//! contradiction is claimed, and a rule whose trial ends so stays in the subset.

use super::conflict::Conflict;
use super::demands::Demands;
use super::joint::{Facts, Season, build};
use super::model::Model;
use super::problem::Problem;
use super::rule::{Exclusive, RuleName};
use crate::program::{Aids, Cell, Choice, Family, Gain, Limits, solve};
use onboard_core::time::Instant;

/// Most numbers touched in one attempt.
const WORK: usize = 4_000_000_000;
/// Seasons tried alone.
const ALONE: usize = 8;
/// The order in which rules are tried without.
const ORDER: [RuleName; 10] = [
    RuleName::Forbidden,
    RuleName::Blackouts,
    RuleName::Thermal,
    RuleName::Data,
    RuleName::ScanAngle,
    RuleName::MaxSessions,
    RuleName::MaxMinutesPerDay,
    RuleName::Exclusive,
    RuleName::Fixed,
    RuleName::MinSessions,
];

/// A season: target, telescope and start.
type Place = (usize, usize, Instant);

const fn place(season: &Season) -> Place {
    (season.target, season.telescope, season.from)
}

/// Whether a problem has the rule.
fn binds(rule: RuleName, problem: &Problem) -> bool {
    let demands = &problem.demands;
    match rule {
        RuleName::Exclusive => problem.rules.exclusive != Exclusive::None,
        RuleName::MaxMinutesPerDay => problem.rules.max_per_day.is_some(),
        RuleName::MaxSessions => problem.rules.max_sessions.is_some(),
        RuleName::MinSessions => demands.min_sessions.is_some(),
        RuleName::ScanAngle => !demands.diversity.is_empty(),
        RuleName::Data => demands.data.is_some(),
        RuleName::Thermal => demands.thermal.is_some(),
        RuleName::Blackouts => !demands.blackouts.is_empty(),
        RuleName::Fixed => !demands.fixed.is_empty(),
        RuleName::Forbidden => !demands.forbidden.is_empty(),
    }
}

/// Switches the rule off.
fn leave_out(rule: RuleName, problem: &mut Problem) {
    let demands = &mut problem.demands;
    match rule {
        RuleName::Exclusive => problem.rules.exclusive = Exclusive::None,
        RuleName::MaxMinutesPerDay => problem.rules.max_per_day = None,
        RuleName::MaxSessions => problem.rules.max_sessions = None,
        RuleName::MinSessions => demands.min_sessions = None,
        RuleName::ScanAngle => demands.diversity.clear(),
        RuleName::Data => demands.data = None,
        RuleName::Thermal => demands.thermal = None,
        RuleName::Blackouts => demands.blackouts.clear(),
        RuleName::Fixed => demands.fixed.clear(),
        RuleName::Forbidden => demands.forbidden.clear(),
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
    short: Vec<Place>,
}

/// Meets as much as possible, only one season where given.
fn attempt(problem: &Problem, only: Option<Place>) -> Attempt {
    let (model, _) = Model::new(problem);
    let facts = Facts::new(problem, &model);
    let mut built = build(problem, &model, &facts);
    let program = &mut built.program;
    program.values.fill(0);
    program.cells.clear();
    let mut wanted = 0;
    let mut session_of = vec![None; problem.candidates.len()];
    for (id, session) in model.sessions.iter().enumerate() {
        session_of[session.candidate] = Some(id);
        program.choices[id] = Choice::Free;
    }
    for &candidate in &problem.demands.fixed {
        wanted += 1;
        // A fixed session that cannot stand at all is simply missing.
        if let Some(id) = session_of[candidate] {
            program.values[id] = 1;
        }
    }
    for season in &built.seasons {
        if only.is_none_or(|only| only == place(season)) {
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
    let limits = Limits { work: WORK, ..Limits::default() };
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
        (held < season.wanted).then(|| place(season))
    });
    Attempt {
        wanted,
        possible: whole(found.value),
        proved: whole(found.bound) < wanted,
        short: short.collect(),
        chosen: model.candidates(&taken),
    }
}

/// An infeasible subset of the rules; else a schedule that meets them, if one was found.
pub(super) fn find(problem: &Problem) -> Result<Option<Vec<usize>>, Conflict> {
    let whole = attempt(problem, None);
    if !whole.proved {
        return Ok((whole.possible >= whole.wanted).then_some(whole.chosen));
    }
    // A season that cannot be met alone makes for a smaller set.
    let alone = whole.short.iter().take(ALONE).find_map(|&season| {
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
        ORDER.into_iter().filter(|rule| binds(*rule, &problem)).collect();
    for rule in ORDER {
        let mut less = problem.clone();
        leave_out(rule, &mut less);
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
