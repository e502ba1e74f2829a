//! The schedule under all rules: labels first, the integer programme for what they leave.
//!
//! Method: labels and multipliers (`lagrangian.rs`) give a schedule and a bound; where these are close the
//! search ends. Else the integer programme (`joint/`, `crate::program`) starts from that schedule, knows
//! every rule, and gives a second bound; the lower of the two counts. Where labels do not serve, the search
//! by days (`daily/`) takes their place: leaving rules out and charges away only raises a bound, so its bound
//! holds under all rules. Demands that cannot be met are explained by `infeasible.rs`.
//!
//! Limits: as the methods.

use super::check::check;
use super::daily::{self, Days, Relaxed, improved};
use super::demands::Demands;
use super::draft::Draft;
use super::error::ScheduleError;
use super::explain;
use super::infeasible;
use super::joint::{Built, Facts, build};
use super::lagrangian::{self, Found as Labelled};
use super::model::Model;
use super::problem::Problem;
use super::reason::Because;
use super::solution::{Schedule, Stopped};
use super::usage;
use super::worth;
use crate::program::number::f64_from_i128;
use crate::program::{
    self, Aids, Dualised, Ended, Family, Limits, Outcome, Program, charged, grow, relax,
    solve_from, worth_of,
};
use crate::progress::{Progress, Quietly, StopOnly};
use std::collections::BTreeMap;

/// Up to so many sessions the programme works alone.
const FEW: usize = 60;
/// Limits of the programme beside the search by days.
const BESIDE: Limits =
    Limits { nodes: 20_000, work: 8_000_000_000, cut_rounds: 4, passes: 1, exchange_nodes: 60 };
/// The same above so many sessions, where it hardly does more than exchange.
const MANY: usize = 6_000;
const FEWER: Limits = Limits { cut_rounds: 0, exchange_nodes: 12, ..BESIDE };
/// Demands join the days, so that only the programme knows what they cost: up to so many sessions it
/// does more.
const STILL_TOGETHER: usize = 15_000;
const TOGETHER: Limits =
    Limits { nodes: 20_000, work: 15_000_000_000, cut_rounds: 10, passes: 3, exchange_nodes: 60 };
/// Most numbers touched where the programme works alone.
const ALONE_WORK: usize = 15_000_000_000;

/// Labels within one part in so many of their bound need no other search; the same under demands over
/// many sessions. Over few, the programme may prove more.
const NEAR: i128 = 1_000;
const NEAR_DEMANDS: i128 = 100;
/// Rounding of sums of f64, as a share of what is summed; a bound further below its own schedule is a defect.
const ROUNDING: f64 = 1e-9;
/// Rounds of rows of families before the search.
const ROW_ROUNDS: usize = 8;

/// Finds a good schedule and a bound on all schedules.
///
/// # Errors
/// [`ScheduleError`] when the problem is not well posed, or its rules contradict each other.
pub fn schedule(problem: &Problem) -> Result<Schedule, ScheduleError> {
    schedule_until(problem, &Quietly)
}

/// As [`schedule`], watched: told the steps of the search, which follow each other, and asked whether to
/// end it. Then the best schedule so far is returned, its bound still safe. Asked between steps of the
/// search, and not while a relaxation is solved.
///
/// # Errors
/// As [`schedule`]; [`ScheduleError::NotFound`] where nothing was found in time.
pub fn schedule_until(
    problem: &Problem,
    progress: &dyn Progress,
) -> Result<Schedule, ScheduleError> {
    problem.validate()?;
    let (model, screened) = Model::new(problem);
    let facts = Facts::new(problem, &model);
    let mut built = build(problem, &model, &facts);
    let relaxed = daily::relax(&model);
    let regime = Regime::of(&problem.demands, model.sessions.len());
    let labelled = lagrangian::search(&mut built, &relaxed.prices, progress);
    if let Some(found) = labelled.as_ref().and_then(|it| settled(&built, it, regime)) {
        let search = Search::new(&built, &Prepared::NOTHING, regime, progress);
        return search.report((&found, &relaxed), screened);
    }
    let prepared = Prepared::new(&mut built, (&relaxed, labelled), regime, progress);
    let search = Search::new(&built, &prepared, regime, progress);
    let found = search.run(&relaxed)?;
    search.report((&found, &relaxed), screened)
}

/// The schedule by labels, where it comes close enough to its bound.
fn settled(built: &Built<'_>, found: &Labelled, regime: Regime) -> Option<Outcome> {
    let taken = found.taken.clone()?;
    let value = worth_of(&built.program, &taken);
    let missing = (found.bound - value).max(0);
    let near = if !regime.demands {
        NEAR
    } else if regime.many() {
        NEAR_DEMANDS
    } else {
        i128::MAX
    };
    if missing > (value - built.offset).abs() / near {
        return None;
    }
    // The labels' own rules have no multipliers: the relaxation has.
    let (prices, slopes) = if built.label_rows.is_empty() {
        (found.multipliers.rows.clone(), found.multipliers.slopes.clone())
    } else {
        relax(&built.program, &vec![0.0; built.program.values.len()])?.per_unit()
    };
    Some(Outcome {
        taken: Some(taken),
        value,
        bound: found.bound,
        relaxed: found.bound,
        prices,
        family_prices: Vec::new(),
        slopes,
        shares: Vec::new(),
        ended: if found.exact || missing == 0 { Ended::Proven } else { Ended::Work },
        nodes: 0,
        cuts: 0,
    })
}

/// Which searches a problem gets.
#[derive(Debug, Clone, Copy)]
struct Regime {
    sessions: usize,
    /// Rules beyond those of single days and windows.
    demands: bool,
    /// There is a search by days.
    by_days: bool,
}

impl Regime {
    fn of(demands: &Demands, sessions: usize) -> Self {
        let by_days = demands.log.is_none() && sessions > FEW;
        Self { sessions, demands: !demands.is_empty(), by_days }
    }

    /// More than [`MANY`] sessions.
    const fn many(self) -> bool {
        self.sessions > MANY
    }

    /// Demands join the days, and the programme can do more about them.
    const fn together(self) -> bool {
        self.demands && self.sessions <= STILL_TOGETHER
    }

    /// The search by days is missing, or does not know all rules.
    const fn alone(self) -> bool {
        !self.by_days || self.demands
    }

    /// Limits of the programme's search.
    fn limits(self) -> Limits {
        match (self.many(), self.alone()) {
            (true, _) if self.together() => TOGETHER,
            (true, _) => FEWER,
            (false, false) => BESIDE,
            (false, true) => Limits { work: ALONE_WORK, ..Limits::default() },
        }
    }
}

/// What is known before the programme is searched.
struct Prepared {
    labelled: Option<Labelled>,
    days: Option<Days>,
    /// Candidates and bound of a search by days, further rules dualised.
    charged: Option<(Vec<usize>, i128)>,
    /// The programme's relaxation, where it is solved already.
    ready: Option<program::Relaxed>,
}

impl Prepared {
    /// Nothing.
    const NOTHING: Self = Self { labelled: None, days: None, charged: None, ready: None };

    /// What labels found; the search by days where they did not serve or demands join the days, and beside
    /// it the programme's relaxation with rows of its families, which may
    /// give a second search by days; the programme keeps the rows.
    fn new(
        built: &mut Built<'_>,
        (relaxed, labelled): (&Relaxed, Option<Labelled>),
        regime: Regime,
        progress: &dyn Progress,
    ) -> Self {
        let by_days = regime.by_days && (labelled.is_none() || regime.together());
        let (problem, model) = (built.problem, built.model);
        let own_rows = built.program.rows.len();
        let families: Vec<&dyn Family> = built.families.iter().map(AsRef::as_ref).collect();
        let (program, offset, further) = (&mut built.program, built.offset, built.further);
        // Clarabel works alone meanwhile.
        let (days, (charged, (ready, grown))) = rayon::join(
            || by_days.then(|| Days::new(problem, (model, relaxed), progress)),
            || {
                if by_days && regime.together() {
                    let (ready, grown) = grow(program, &families, (ROW_ROUNDS, offset));
                    let charged = ready.as_ref().map(|ready| {
                        let (rows, slopes) = ready.per_unit();
                        let which = Dualised { rows_from: further, cells_until: usize::MAX };
                        charged(program, (&rows, &slopes), which)
                    });
                    let quiet = StopOnly(progress);
                    (charged.and_then(|it| Days::charged(model, &it, &quiet)), (ready, grown))
                } else if regime.many() {
                    (None, (relax(program, &relaxed.shares), Vec::new()))
                } else {
                    (None, (None, Vec::new()))
                }
            },
        );
        built.rules.resize(built.program.rows.len(), None);
        built.grown.extend((own_rows..).zip(grown));
        Self { labelled, days, charged, ready }
    }
}

/// The search of the programme, and what it starts from.
struct Search<'s> {
    built: &'s Built<'s>,
    prepared: &'s Prepared,
    regime: Regime,
    families: Vec<&'s dyn Family>,
    /// The session of each candidate that could stand.
    sessions: BTreeMap<usize, usize>,
    progress: &'s dyn Progress,
}

impl<'s> Search<'s> {
    fn new(
        built: &'s Built<'s>,
        prepared: &'s Prepared,
        regime: Regime,
        progress: &'s dyn Progress,
    ) -> Self {
        let sessions = built.model.sessions.iter().enumerate();
        Self {
            built,
            prepared,
            regime,
            families: built.families.iter().map(AsRef::as_ref).collect(),
            sessions: sessions.map(|(id, it)| (it.candidate, id)).collect(),
            progress,
        }
    }

    /// The best set of the programme that meets every rule.
    fn run(&self, relaxed: &Relaxed) -> Result<Outcome, ScheduleError> {
        let demands = &self.built.problem.demands;
        let lacking = demands.fixed.iter().any(|it| !self.sessions.contains_key(it));
        let mut found = if lacking { None } else { self.first(relaxed) };
        let demanding = infeasible::is_demanding(demands);
        if !self.meets(found.as_ref()) && (demanding || found.is_none()) {
            found = Some(self.with_demands_met()?);
        }
        found.ok_or(ScheduleError::NotFound)
    }

    /// The programme from the best start that is known, and improved by days where both see the same
    /// rules.
    fn first(&self, relaxed: &Relaxed) -> Option<Outcome> {
        let ready = self.prepared.ready.clone();
        let program = &self.built.program;
        let mut found = self.attempt((program, &self.regime.limits()), &self.start(), ready)?;
        if self.regime.alone() || found.ended != Ended::Work {
            return Some(found);
        }
        let model = self.built.model;
        let taken = found.taken.as_ref();
        let better = taken.and_then(|taken| improved(model, relaxed, taken, self.progress));
        let again = better
            .and_then(|start| self.attempt((program, &FEWER), &start, self.prepared.ready.clone()));
        if let Some(again) = again.filter(|it| it.value > found.value) {
            (found.taken, found.value) = (again.taken, again.value);
        }
        if self.progress.stopped() {
            found.ended = Ended::Stopped;
        }
        Some(found)
    }

    /// The programme with all demands as rows, or the proof that they contradict each other.
    fn with_demands_met(&self) -> Result<Outcome, ScheduleError> {
        let met = infeasible::find(self.built.problem).map_err(ScheduleError::Infeasible)?;
        let start = self.sessions_of(&met.ok_or(ScheduleError::NotFound)?);
        // They can be met, so nothing else may outweigh them.
        let strict = self.built.with_seasons_met();
        let found = self.attempt((&strict, &self.regime.limits()), &start, None);
        found.filter(|found| self.meets(Some(found))).ok_or(ScheduleError::NotFound)
    }

    fn attempt(
        &self,
        (program, limits): (&Program, &Limits),
        start: &[usize],
        ready: Option<program::Relaxed>,
    ) -> Option<Outcome> {
        let (families, progress) = (&self.families, self.progress);
        let aids = Aids { families, start, bound: self.known(), progress };
        solve_from(program, limits, &aids, ready).ok()
    }

    /// A schedule by labels, else the earlier plan, else a schedule by days.
    fn start(&self) -> Vec<usize> {
        let previous = self.built.problem.demands.previous.as_ref().map(|it| &it.sessions);
        let charged = self.prepared.charged.as_ref().map(|it| &it.0);
        let days = self.prepared.days.as_ref().map(|it| &it.chosen);
        if let Some(taken) = self.prepared.labelled.as_ref().and_then(|it| it.taken.clone()) {
            return taken;
        }
        let start = previous.or(charged).or(days);
        start.map(|candidates| self.sessions_of(candidates)).unwrap_or_default()
    }

    /// The least bound by labels and by days, in the programme's units.
    fn known(&self) -> Option<i128> {
        let units = self.prepared.days.as_ref().and_then(|it| it.units);
        let plain = units.map(|bound| bound + self.built.offset);
        let charged = self.prepared.charged.as_ref().map(|it| it.1);
        let labelled = self.prepared.labelled.as_ref().map(|it| it.bound);
        plain.into_iter().chain(charged).chain(labelled).min()
    }

    /// Sessions of candidates, where they could stand.
    fn sessions_of(&self, candidates: &[usize]) -> Vec<usize> {
        candidates.iter().filter_map(|it| self.sessions.get(it).copied()).collect()
    }

    /// Whether there is a set, and it meets every rule.
    fn meets(&self, found: Option<&Outcome>) -> bool {
        let taken = found.and_then(|it| it.taken.as_ref());
        let (problem, model) = (self.built.problem, self.built.model);
        taken.is_some_and(|taken| check(problem, &model.candidates(taken)).is_ok())
    }

    /// The schedule with its numbers, reasons and prices, checked.
    fn report(
        &self,
        (found, relaxed): (&Outcome, &Relaxed),
        screened: Vec<Option<Because>>,
    ) -> Result<Schedule, ScheduleError> {
        let (built, model) = (self.built, self.built.model);
        let taken = found.taken.clone().ok_or(ScheduleError::NotFound)?;
        let chosen = model.candidates(&taken);
        check(built.problem, &chosen).map_err(ScheduleError::Unsound)?;
        let mut draft = Draft::new(model);
        for &id in &taken {
            draft.add(id);
        }
        let objective = worth::objective(built, &taken);
        let units = found.bound - built.offset;
        let mut upper_bound = value_above(units, built);
        if let Some(days) = &self.prepared.days {
            upper_bound = upper_bound.min(days.bound);
        }
        // Charges may cancel what the sessions bring.
        let size = objective.abs() + built.value(f64_from_i128(built.offset)).abs();
        if objective - upper_bound > ROUNDING * size {
            return Err(ScheduleError::BoundBelow { objective, upper_bound });
        }
        let upper_bound = upper_bound.max(objective);
        let gap = (upper_bound - objective) / upper_bound.abs();
        let stopped = match found.ended {
            Ended::Stopped => Stopped::Interrupted,
            Ended::Proven => Stopped::Optimal,
            Ended::Work if units - (found.value - built.offset) <= 0 => Stopped::Optimal,
            Ended::Work if gap <= 1e-5 => Stopped::Close,
            Ended::Work => Stopped::WorkLimit,
        };
        let mut constraints = usage::first(model, &draft, &relaxed.prices);
        constraints.extend(usage::further(built, found, draft.marks()));
        Ok(Schedule {
            chosen,
            objective,
            upper_bound,
            gap: if upper_bound.abs() > 0.0 { gap } else { 0.0 },
            stopped,
            rejected: explain::rejected(built, &draft, screened),
            constraints,
            changes: worth::changes(built, &taken),
        })
    }
}

/// Units as a value, rounded up.
fn value_above(units: i128, built: &Built<'_>) -> f64 {
    let value = built.value(f64_from_i128(units));
    value + 4.0 * f64::EPSILON * value.abs()
}
