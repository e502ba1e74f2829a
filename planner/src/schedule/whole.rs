//! The schedule under all rules: the day by day search where it is sharp, the integer programme for
//! everything.
//!
//! Method: over many sessions the day by day search (`split.rs`) gives a schedule under the first
//! rules and a bound; leaving rules out and charges away only raises a bound, so it holds under all
//! rules. The integer programme (`crate::program`) starts from that schedule, knows every rule, and
//! gives a second bound; the lower of the two counts. Without demands both see the same rules, and
//! what the programme found is improved day by day and by the programme once more: they exchange
//! different sets, so each gets the other out of its local optimum. Demands that cannot be met are
//! explained by `conflict.rs`.
//!
//! Limits: as both methods; the logarithmic objective has the programme alone.

use super::conflict::{find, is_demanding};
use super::draft::Draft;
use super::explain::{self, Because, ConstraintUse, Rule};
use super::families::DIRECTION;
use super::model::Model;
use super::relaxation::{self, Relaxed};
use super::rows::{Built, Facts, build, cone_members};
use super::{Problem, Schedule, ScheduleError, Stopped, asked, best, check, improved};
use crate::program::number::{f64_from_i128, f64_from_usize};
use crate::program::{
    Aids, Charged, Ended, Family, LARGEST_VALUE, Limits, Outcome, charged, grow, relax, solve_from,
};
use onboard_core::time::Duration;
use std::collections::{BTreeMap, BTreeSet};

/// Up to so many sessions the programme works alone.
const FEW: usize = 60;
/// Limits of the programme beside the day by day search.
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

/// Rounds of rows of families before the search.
const ROW_ROUNDS: usize = 8;

/// Asked whether to stop.
pub type Stop<'a> = Option<&'a (dyn Fn() -> bool + Sync)>;

/// The schedule of a validated problem.
#[expect(clippy::too_many_lines, reason = "the steps, one after the other")]
pub(super) fn schedule(problem: &Problem, stop: Stop<'_>) -> Result<Schedule, ScheduleError> {
    let demands = &problem.demands;
    let (model, mut reasons) = Model::new(problem);
    let facts = Facts::new(problem, &model);
    let mut built = build(problem, &model, &facts);
    let relaxed = relaxation::solve(&model);
    let linear = demands.log.is_none();
    let day_by_day = linear && model.sessions.len() > FEW;
    let families: Vec<&dyn Family> = built.families.iter().map(AsRef::as_ref).collect();
    let together = !demands.is_empty() && model.sessions.len() <= STILL_TOGETHER;
    // Clarabel works alone meanwhile.
    let own_rows = built.program.rows.len();
    let ((days, charged), (ready, grown)) = {
        let (program, offset, further) = (&mut built.program, built.offset, built.further);
        let (plain, (charged, ready)) = rayon::join(
            || day_by_day.then(|| Days::new(problem, (&model, &relaxed), stop)),
            || {
                if day_by_day && together {
                    let (ready, grown) = grow(program, &families, (ROW_ROUNDS, offset));
                    let charged = ready.as_ref().map(|ready| charged(program, ready, further));
                    (charged.and_then(|it| Days::charged(&model, &it, stop)), (ready, grown))
                } else if model.sessions.len() > MANY {
                    (None, (relax(program, &relaxed.shares), Vec::new()))
                } else {
                    (None, (None, Vec::new()))
                }
            },
        );
        ((plain, charged), ready)
    };
    built.rules.resize(built.program.rows.len(), None);
    built.grown = (own_rows..).zip(grown).collect();
    let id_of: BTreeMap<usize, usize> =
        model.sessions.iter().enumerate().map(|(id, it)| (it.candidate, id)).collect();
    let mut start: Vec<usize> = Vec::new();
    if let Some(days) = &days {
        start = days.chosen.iter().filter_map(|it| id_of.get(it).copied()).collect();
    }
    if let Some((charged, _)) = &charged {
        start = charged.iter().filter_map(|it| id_of.get(it).copied()).collect();
    }
    if let Some(previous) = &demands.previous {
        start = previous.sessions.iter().filter_map(|it| id_of.get(it).copied()).collect();
    }
    // With further rules the day by day search tells less.
    let alone = !day_by_day || !demands.is_empty();
    let limits = match (model.sessions.len() > MANY, !alone) {
        (true, _) if together => TOGETHER,
        (true, _) => FEWER,
        (false, true) => BESIDE,
        (false, false) => Limits { work: 15_000_000_000, ..Limits::default() },
    };
    // The day by day search's bound, in the programme's units.
    let plain = days.as_ref().and_then(|it| it.units).map(|bound| bound + built.offset);
    let known = plain.into_iter().chain(charged.as_ref().map(|it| it.1)).min();
    let attempt = |start: &[usize], limits: &Limits| {
        let aids = Aids { families: &families, start, stop, bound: known };
        solve_from(&built.program, limits, &aids, ready.clone())
    };
    let lacking = demands.fixed.iter().any(|it| !id_of.contains_key(it));
    let mut found = if lacking { None } else { attempt(&start, &limits).ok() };
    if let Some(found) = found.as_mut().filter(|it| !alone && it.ended == Ended::Work) {
        let taken = found.taken.as_ref();
        let better = taken.and_then(|taken| improved(&model, &relaxed, taken, stop));
        if let Some(again) = better.and_then(|start| attempt(&start, &FEWER).ok())
            && again.value > found.value
        {
            (found.taken, found.value) = (again.taken, again.value);
        }
        if asked(stop) {
            found.ended = Ended::Stopped;
        }
    }
    let meets = |found: &Option<Outcome>| -> bool {
        let taken = found.as_ref().and_then(|it| it.taken.as_ref());
        taken.is_some_and(|taken| check(problem, &candidates(&model, taken)).is_ok())
    };
    if !meets(&found) && (is_demanding(demands) || found.is_none()) {
        match find(problem).map_err(ScheduleError::Infeasible)? {
            Some(met) => {
                // They can be met, so nothing else may outweigh them.
                let start: Vec<usize> =
                    met.iter().filter_map(|it| id_of.get(it).copied()).collect();
                let strict = built.with_seasons_met();
                let aids = Aids { families: &families, start: &start, stop, bound: known };
                found = solve_from(&strict, &limits, &aids, None).ok();
                if !meets(&found) {
                    return Err(ScheduleError::NotFound);
                }
            }
            None => return Err(ScheduleError::NotFound),
        }
    }
    let Some(found) = found else { return Err(ScheduleError::NotFound) };
    let taken = found.taken.clone().ok_or(ScheduleError::NotFound)?;
    let chosen = candidates(&model, &taken);
    check(problem, &chosen).map_err(ScheduleError::Unsound)?;

    let mut draft = Draft::new(&model);
    for &id in &taken {
        draft.add(id);
    }
    explain::left_out(&model, &draft, &mut reasons);
    let marks = marks(&model, &taken);
    left_out(problem, &model, &built, &marks, &mut reasons);

    let objective = objective(problem, &built, &facts, &model, &taken);
    let units = found.bound - built.offset;
    let mut upper_bound = value_above(units, &built);
    if let Some(days) = &days {
        upper_bound = upper_bound.min(days.bound);
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
    let mut constraints = explain::usage(&model, &draft, &relaxed.prices);
    constraints.extend(usage(problem, &model, &built, &facts, &found, &marks));
    Ok(Schedule {
        chosen,
        objective,
        upper_bound,
        gap: if upper_bound.abs() > 0.0 { gap } else { 0.0 },
        stopped,
        rejected: explain::rejections(reasons),
        constraints,
        changes: changes(problem, &taken, &model),
    })
}

/// The prices of a scan-angle rule's tangents together.
fn tangents(built: &Built<'_>, found: &Outcome, rule: Rule) -> f64 {
    let Some(it) = built.angles.iter().find(|it| it.rule == rule) else { return 0.0 };
    let listed: f64 = found.prices.get(it.rows.clone()).into_iter().flatten().sum();
    let grown = built.grown.iter().filter(|row| row.1 == it.family);
    let grown: f64 = grown.filter_map(|row| found.prices.get(row.0)).sum();
    listed + grown + found.family_prices.get(it.family).copied().unwrap_or(0.0)
}

/// What the day by day search gives.
struct Days {
    /// Candidates of its schedule.
    chosen: Vec<usize>,
    /// No schedule is worth more.
    bound: f64,
    /// The same in units, where the models share them.
    units: Option<i128>,
}

impl Days {
    /// A limit on reserved time in windows of a day or more binds each day as well.
    fn new(problem: &Problem, (model, relaxed): (&Model, &Relaxed), stop: Stop<'_>) -> Self {
        let boundaries = &problem.rules.day_boundaries;
        let longest = boundaries.windows(2).map(|day| day[1].since(day[0])).max();
        let covered = boundaries.first().is_some_and(|it| *it <= problem.span.0)
            && boundaries.last().is_some_and(|it| *it >= problem.span.1);
        let daily = problem
            .demands
            .thermal
            .filter(|it| covered && longest.is_some_and(|day| it.window >= day))
            .map(|it| it.most)
            .filter(|most| problem.rules.max_per_day.is_none_or(|limit| *most < limit));
        let Some(daily) = daily else { return Self::of((model, relaxed), true, stop) };
        let mut tighter = problem.clone();
        tighter.rules.max_per_day = Some(daily);
        let (tighter, _) = Model::new(&tighter);
        let shared = tighter.unit() == model.unit();
        Self::of((&tighter, &relaxation::solve(&tighter)), shared, stop)
    }

    /// Candidates of a schedule that pays for the further rules as it goes, and the bound that follows
    /// under all rules, in the programme's units.
    fn charged(model: &Model, charged: &Charged, stop: Stop<'_>) -> Option<(Vec<usize>, i128)> {
        if charged.values.iter().any(|it| *it > LARGEST_VALUE >> 1) {
            return None;
        }
        let model = model.with_values(&charged.values);
        let (draft, bound, _) = best(&model, &relaxation::solve(&model), stop);
        let taken: Vec<usize> = draft.chosen().collect();
        Some((candidates(&model, &taken), bound + charged.constant))
    }

    fn of((model, relaxed): (&Model, &Relaxed), shared: bool, stop: Stop<'_>) -> Self {
        let (draft, bound, _) = best(model, relaxed, stop);
        let taken: Vec<usize> = draft.chosen().collect();
        Self {
            chosen: candidates(model, &taken),
            bound: model.value_from_units(bound),
            units: shared.then_some(bound),
        }
    }
}

/// Candidates of sessions, by start.
fn candidates(model: &Model, taken: &[usize]) -> Vec<usize> {
    taken.iter().map(|&id| model.sessions[id].candidate).collect()
}

fn marks(model: &Model, taken: &[usize]) -> Vec<bool> {
    let mut marks = vec![false; model.sessions.len()];
    for &id in taken {
        marks[id] = true;
    }
    marks
}

/// Units as a value, rounded up.
fn value_above(units: i128, built: &Built<'_>) -> f64 {
    let value = built.value(f64_from_i128(units));
    value + 4.0 * f64::EPSILON * value.abs()
}

/// Candidates of the earlier plan that were dropped, and those that it did not have.
fn changes(problem: &Problem, taken: &[usize], model: &Model) -> usize {
    let Some(previous) = &problem.demands.previous else { return 0 };
    let before: BTreeSet<usize> = previous.sessions.iter().copied().collect();
    let now: BTreeSet<usize> = taken.iter().map(|&id| model.sessions[id].candidate).collect();
    before.symmetric_difference(&now).count()
}

/// What a schedule is worth, charges taken off.
fn objective(
    problem: &Problem,
    built: &Built<'_>,
    facts: &Facts,
    model: &Model,
    taken: &[usize],
) -> f64 {
    let demands = &problem.demands;
    let sum = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |sum, value| sum + value);
    let mut worth = match &demands.log {
        None => sum(&mut taken.iter().map(|&id| problem.value(model.sessions[id].candidate))),
        Some(log) => {
            let mut cells: BTreeMap<(usize, usize, i64, u32), f64> = BTreeMap::new();
            for &id in taken {
                let session = &model.sessions[id];
                let since = session.start.saturating_sub(problem.span.0.tai_ns());
                let epoch = since.div_euclid(log.epoch.ns().max(1));
                for &(bin, time) in &log.parts[session.candidate] {
                    let key = (facts.of[id].0, facts.of[id].1, epoch, bin);
                    *cells.entry(key).or_default() += time.seconds();
                }
            }
            let offset = log.offset.seconds();
            let weight = |target, bin| log.weight(&problem.weights, target, bin);
            let gains = cells.iter().map(|(key, t)| weight(key.0, key.3) * (t / offset).ln_1p());
            sum(&mut { gains })
        }
    };
    let marks = marks(model, taken);
    let empty = built.gaps.iter().filter(|gap| !gap.sessions.iter().any(|&id| marks[id])).count();
    if empty > 0 {
        worth -= built.gap_charge * f64_from_usize(empty);
    }
    if let Some(previous) = &demands.previous {
        worth -= previous.price * f64_from_usize(changes(problem, taken, model));
    }
    worth
}

/// Reasons beyond the first rules: of what fits by those, the family that refuses.
fn left_out(
    problem: &Problem,
    model: &Model,
    built: &Built<'_>,
    marks: &[bool],
    reasons: &mut [Option<Because>],
) {
    let mut with = marks.to_vec();
    for (id, session) in model.sessions.iter().enumerate() {
        if marks[id] || reasons[session.candidate].is_some() {
            continue;
        }
        with[id] = true;
        let refusing = built.families.iter().position(|family| !family.broken(&with).is_empty());
        let because = refusing.map(|place| built.named(problem, place));
        reasons[session.candidate] = Some(because.unwrap_or(Because::NotWorth));
        with[id] = false;
    }
}

impl Built<'_> {
    /// The reason that a family stands for, by its place: starts, heat, memory, then cones.
    fn named(&self, problem: &Problem, place: usize) -> Because {
        let demands = &problem.demands;
        let mut at = place;
        for (present, because) in [
            (problem.rules.max_sessions.is_some(), Because::NotWorth),
            (demands.thermal.is_some(), Because::Thermal),
            (demands.data.is_some(), Because::Memory),
        ] {
            if present {
                if at == 0 {
                    return because;
                }
                at -= 1;
            }
        }
        let cones = self.families.len() - (place - at);
        let each = (cones / demands.diversity.len().max(1)).max(1);
        demands
            .diversity
            .get(at / each)
            .map_or(Because::NotWorth, |rule| Because::ScanAngle { n: rule.n })
    }
}

/// How far the further rules are used.
fn usage(
    problem: &Problem,
    model: &Model,
    built: &Built<'_>,
    facts: &Facts,
    found: &Outcome,
    marks: &[bool],
) -> Vec<ConstraintUse> {
    let seconds = |ns: i128| f64_from_i128(ns) / 1e9;
    let standing = |ids: &[usize]| f64_from_usize(ids.iter().filter(|&&id| marks[id]).count());
    let mut all = Vec::new();
    let rows = built.program.rows.iter().zip(&built.rules).zip(&found.prices);
    for ((row, rule), price) in rows {
        let Some(rule) = rule else { continue };
        let used: i128 = row.terms.iter().filter(|it| marks[it.0]).map(|it| i128::from(it.1)).sum();
        all.push(ConstraintUse {
            rule: *rule,
            used: seconds(used),
            limit: seconds(i128::from(row.limit)),
            // Per second of limit.
            shadow_price: built.value(price * 1e9),
        });
    }
    for (place, season) in built.seasons.iter().enumerate() {
        // Seasons that are rows stand behind the programme's own.
        let row = found.prices.get(built.program.rows.len() + place);
        let price = found.slopes.get(season.cell).into_iter().chain(row).sum::<f64>();
        let held = season.sessions.iter().filter(|&&id| marks[id]).count();
        all.push(ConstraintUse {
            rule: season.rule,
            used: f64_from_usize(held),
            limit: f64_from_usize(season.wanted),
            // Per session fewer asked for.
            shadow_price: built.value(price),
        });
    }
    for gap in &built.gaps {
        let empty = f64::from(u8::from(standing(&gap.sessions) < 0.5));
        let step = problem.demands.longest_gap.map_or(Duration::ZERO, |it| it.step());
        let price = problem.demands.longest_gap.map_or(0.0, |it| it.price_per_day);
        if empty > 0.0 {
            all.push(ConstraintUse {
                rule: gap.rule,
                used: step.seconds() / 86_400.0,
                limit: 0.0,
                shadow_price: price,
            });
        }
    }
    for diversity in &problem.demands.diversity {
        for ((target, telescope), members) in cone_members(model, facts, diversity) {
            let held = members.iter().filter(|it| marks[it.0]);
            let (mut sums, mut weight) = ([0.0; 2], 0.0);
            for &(id, ..) in held {
                let [w, c, s] = diversity.sums[model.sessions[id].candidate];
                sums[0] += c;
                sums[1] += s;
                weight += w;
            }
            let rule = Rule::ScanAngle { n: diversity.n, target, telescope };
            all.push(ConstraintUse {
                rule,
                used: if weight > 0.0 { sums[0].hypot(sums[1]) / weight } else { 0.0 },
                limit: diversity.rho,
                // A tangent's limit is rho times the length of its direction times the time in ms.
                shadow_price: built.value(tangents(built, found, rule) * DIRECTION * weight * 1e3),
            });
        }
    }
    all
}
