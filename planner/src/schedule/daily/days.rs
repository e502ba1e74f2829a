//! A schedule and a bound by days: the parts of the search in order.
//!
//! Method: rounding the relaxation gives a first schedule, the Lagrangian dual a bound and a few splits
//! by good multipliers. Each split is assembled into a schedule and improved; all are recombined and the
//! result is improved again. The best one counts.
//!
//! Limits: [`PASSES`] of improvement; the search ends where the schedule is within one part in
//! [`CLOSE`] of the bound.

use super::assemble;
use super::bound::priced;
use super::improve::{self, Priced};
use super::lagrangian::sharpen;
use super::relaxation::{self, Relaxed};
use crate::program::number::u64_from_usize;
use crate::program::{Charged, LARGEST_VALUE};
use crate::progress::Progress;
use crate::schedule::draft::Draft;
use crate::schedule::model::Model;
use crate::schedule::problem::Problem;
use crate::schedule::solution::Stopped;
use rayon::prelude::*;

/// A schedule within one part in this many of the bound is good enough.
const CLOSE: i128 = 100_000;
/// Most passes of exchanges over a schedule that was assembled, and over the mixture of all.
const PASSES: (usize, usize) = (1, 6);

/// What the search by days gives.
pub(crate) struct Days {
    /// Candidates of its schedule.
    pub(crate) chosen: Vec<usize>,
    /// No schedule is worth more.
    pub(crate) bound: f64,
    /// The same in units, where the models share them.
    pub(crate) units: Option<i128>,
}

impl Days {
    /// Under overlap, days and windows of starts. A limit on reserved time in windows of a day or more
    /// binds each day as well.
    pub(crate) fn new(
        problem: &Problem,
        (model, relaxed): (&Model, &Relaxed),
        progress: &dyn Progress,
    ) -> Self {
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
        let Some(daily) = daily else { return Self::of((model, relaxed), true, progress) };
        let mut tighter = problem.clone();
        tighter.rules.max_per_day = Some(daily);
        let (tighter, _) = Model::new(&tighter);
        let shared = tighter.unit() == model.unit();
        Self::of((&tighter, &relaxation::solve(&tighter)), shared, progress)
    }

    /// Candidates of a schedule by the reduced values that dualised further rules leave, and the bound
    /// that follows under all rules, in the programme's units.
    pub(crate) fn charged(
        model: &Model,
        charged: &Charged,
        progress: &dyn Progress,
    ) -> Option<(Vec<usize>, i128)> {
        if charged.values.iter().any(|it| *it > LARGEST_VALUE >> 1) {
            return None;
        }
        let model = model.with_values(&charged.values);
        let (draft, bound, _) = best(&model, &relaxation::solve(&model), progress);
        let taken: Vec<usize> = draft.chosen().collect();
        Some((model.candidates(&taken), bound + charged.constant))
    }

    fn of((model, relaxed): (&Model, &Relaxed), shared: bool, progress: &dyn Progress) -> Self {
        let (draft, bound, _) = best(model, relaxed, progress);
        let taken: Vec<usize> = draft.chosen().collect();
        Self {
            chosen: model.candidates(&taken),
            bound: model.value_from_units(bound),
            units: shared.then_some(bound),
        }
    }
}

/// The best schedule found, a bound on all schedules in units, and why the search ended.
fn best<'a>(
    model: &'a Model,
    relaxed: &Relaxed,
    progress: &dyn Progress,
) -> (Draft<'a>, i128, Stopped) {
    let prices = &relaxed.prices;
    let mut bound = priced(model, prices);
    let rounded = improve::round(model, relaxed);
    if let Some(stopped) = close(&rounded, bound) {
        return (rounded, bound, stopped);
    }
    let reduced = Priced::new(model, prices);
    let scale = relaxed.typical_value(model);
    let enough = i128::from(rounded.value());
    let sharpened = sharpen(model, prices, (scale, enough), progress);
    bound = bound.min(sharpened.bound);
    if let Some(stopped) = close(&rounded, bound) {
        return (rounded, bound, stopped);
    }
    if progress.stopped() {
        return (rounded, bound, Stopped::Interrupted);
    }
    progress.begin("schedules by days", u64_from_usize(sharpened.splits.len()).saturating_add(1));
    let mut drafts: Vec<Draft<'a>> = sharpened
        .splits
        .par_iter()
        .map(|split| {
            let mut draft = assemble::assemble(split, &sharpened.patterns, scale);
            improve::improve(&mut draft, model, &reduced, (PASSES.0, progress));
            progress.advance(1);
            draft
        })
        .collect();
    drafts.push(rounded);
    let settled = sharpened.splits.last().is_some_and(|split| {
        let mut mixed = assemble::splice(split, &drafts);
        let settled = improve::improve(&mut mixed, model, &reduced, (PASSES.1, progress));
        drafts.insert(0, mixed);
        settled
    });
    // The first of equals.
    let draft =
        drafts.into_iter().rev().max_by_key(Draft::value).unwrap_or_else(|| Draft::new(model));
    let stopped = match (relaxed.solved, settled) {
        (false, _) => Stopped::NoRelaxation,
        (true, true) => Stopped::LocalOptimum,
        (true, false) => Stopped::WorkLimit,
    };
    let stopped = close(&draft, bound).unwrap_or(stopped);
    (draft, bound, stopped)
}

/// A better schedule by exchanges within a few days; `None` where there is none.
pub(crate) fn improved(
    model: &Model,
    relaxed: &Relaxed,
    taken: &[usize],
    progress: &dyn Progress,
) -> Option<Vec<usize>> {
    let mut draft = Draft::new(model);
    for &id in taken {
        draft.add(id);
    }
    let before = draft.value();
    improve::improve(&mut draft, model, &Priced::new(model, &relaxed.prices), (PASSES.1, progress));
    (draft.value() > before).then(|| draft.chosen().collect())
}

/// Whether a schedule is so close to the bound that the search may end.
fn close(draft: &Draft<'_>, bound: i128) -> Option<Stopped> {
    let missing = bound - i128::from(draft.value());
    if missing <= 0 {
        Some(Stopped::Optimal)
    } else {
        (missing <= bound / CLOSE).then_some(Stopped::Close)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Quietly;
    use crate::schedule::check::check;
    use crate::schedule::demands::Demands;
    use crate::schedule::price::Prices;
    use crate::schedule::problem::Candidate;
    use crate::schedule::rule::{Exclusive, Rules};
    use onboard_core::time::{Duration, Instant};

    #[test]
    fn without_a_relaxation_schedule_and_bound_still_hold() {
        let at = Instant::from_tai_ns;
        let times = [(0, 30), (20, 60), (55, 90), (95, 130), (100, 190)];
        let candidates = times.map(|(entry, exit)| Candidate {
            target: 0,
            telescope: 0,
            first_entry: at(entry),
            last_exit: at(exit),
            dwell: Duration::from_ns(exit - entry),
        });
        let problem = Problem {
            span: (at(0), at(200)),
            candidates: candidates.to_vec(),
            weights: vec![1.0],
            rules: Rules {
                setup: Duration::ZERO,
                cooldown: Duration::ZERO,
                exclusive: Exclusive::All,
                max_per_day: Some(Duration::from_ns(95)),
                max_sessions: None,
                day_boundaries: vec![at(0), at(100), at(200)],
            },
            demands: Demands::default(),
        };
        let (model, _) = Model::new(&problem);
        let relaxed = Relaxed { prices: Prices::none(&model), shares: vec![0.0; 5], solved: false };
        let (draft, bound, stopped) = best(&model, &relaxed, &Quietly);
        let chosen: Vec<usize> = draft.chosen().map(|id| model.sessions[id].candidate).collect();
        assert_eq!(check(&problem, &chosen), Ok(()));
        // 0 to 30, 55 to 90 and 100 to 190 is the best: 155 ns.
        assert_eq!(chosen, [0, 2, 4]);
        let objective: f64 = chosen.iter().map(|&index| problem.value(index)).sum();
        assert!(model.value_from_units(bound) >= objective);
        assert!(matches!(stopped, Stopped::NoRelaxation | Stopped::Optimal | Stopped::Close));
    }
}
