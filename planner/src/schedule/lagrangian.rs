//! The schedule by labels under all rules: what labels do not know is dualised.
//!
//! Method: the conic relaxation gives multipliers of the rules that link far times: seasons, gaps, scan
//! angles, logarithms. They change the sessions' values, and labels (`labels/`) then give a bound, the value
//! of the Lagrangian relaxation, and schedules. While a schedule breaks a rule that was dualised, its
//! multiplier rises and labels are asked again. Gaps are charged by labels or by multipliers, whichever
//! schedule is better; those sessions without which a season falls short are at last fixed, and labels fill
//! the rest by true values.
//!
//! Limits: rules that link far times are dualised for few or many sessions only ([`BETWEEN`]); [`ROUNDS`]
//! rounds; the bound is that of the relaxation's multipliers.

use super::check::check;
use super::joint::Built;
use super::labels::{self, EFFORT, Further, Items};
use super::price::Prices;
use super::worth;
use crate::program::number::{f64_from_i64, f64_from_i128, f64_from_usize, u64_from_usize};
use crate::program::{Charged, Choice, Dualised, Family, Gain, charged, grow};
use crate::progress::{Progress, StopOnly};
use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::ops::RangeInclusive;

/// Rounds of multipliers.
const ROUNDS: usize = 12;
/// Rounds of rows of families in the relaxation.
const ROW_ROUNDS: usize = 8;
/// Numbers of sessions at which the programme does better where rules link far times, and where thermal
/// windows or the memory leave labels too many.
const BETWEEN: RangeInclusive<usize> = 60..=15_000;
/// Comparisons of labels in a round, and in a last pass.
const SHORT: u64 = EFFORT / 40;
const LONG: u64 = EFFORT / 2;
/// The same before the programme, where it does better.
const BEFORE: u64 = EFFORT / 200;
/// By which part of itself, and of the sessions' mean value, the multiplier of a broken rule rises at first,
/// and how that grows from round to round.
const STEP: f64 = 0.05;
const GROWTH: f64 = 1.5;

/// A schedule and a bound.
#[derive(Debug)]
pub(super) struct Found {
    /// Sessions that meet all rules, ascending; `None` where none were found.
    pub(super) taken: Option<Vec<usize>>,
    /// No set is worth more, in the programme's units.
    pub(super) bound: i128,
    /// It is the best.
    pub(super) exact: bool,
    /// Multipliers of rows and cells in units, 0 for thermal windows and the memory; empty where all rules
    /// are the labels'.
    pub(super) multipliers: Multipliers,
}

/// Prices of the programme's rows and slopes of its cells, in units.
#[derive(Debug, Clone, Default)]
pub(super) struct Multipliers {
    pub(super) rows: Vec<f64>,
    pub(super) slopes: Vec<f64>,
}

/// A schedule by labels and a bound; `None` where labels do not serve, or the search was stopped. Rows that
/// the relaxation needs stay in the programme.
pub(super) fn search(
    built: &mut Built<'_>,
    plain: &Prices,
    progress: &dyn Progress,
) -> Option<Found> {
    let fixed: BTreeSet<usize> = built.problem.demands.fixed.iter().copied().collect();
    // One that can never stand is explained elsewhere.
    if built.program.choices.iter().filter(|it| **it == Choice::Always).count() < fixed.len() {
        return None;
    }
    let linked = !built.program.cells.is_empty() || !built.angles.is_empty();
    if !linked {
        let nothing = Multipliers { rows: vec![0.0; built.program.rows.len()], slopes: Vec::new() };
        let dual = Dual::new((built, plain), false);
        let (items, constant) = dual.items(&nothing)?;
        progress.begin("labels", u64_from_usize(items.len()).saturating_mul(2));
        let few = BETWEEN.contains(&built.model.sessions.len()) && !built.label_rows.is_empty();
        let effort = if few { BEFORE } else { EFFORT };
        let (found, bound) = labels::both(&items, effort, progress)?;
        let taken = dual.allowed(&found.taken).then_some(found.taken);
        let (bound, multipliers) = (bound + constant, Multipliers::default());
        return Some(Found { taken, bound, exact: found.exact, multipliers });
    }
    if BETWEEN.contains(&built.model.sessions.len()) {
        return None;
    }
    progress.begin("relaxation", 1);
    let multipliers = relaxed(built)?;
    progress.advance(1);
    let dual = Dual::new((built, plain), false);
    let (items, constant) = dual.items(&multipliers)?;
    progress.begin("labels", u64_from_usize(items.len()));
    let quiet = StopOnly(progress);
    let schedules = || {
        let charged = dual.schedule(multipliers.clone(), &quiet);
        let gaps = !built.gaps.is_empty() && Further::knows_gaps(built);
        let gaps = gaps.then(|| Dual::new((built, plain), true));
        let known = gaps.and_then(|it| it.schedule(multipliers.clone(), &quiet));
        let worth = |taken: &Vec<usize>| worth::objective(built, taken);
        // The first of equals.
        known.into_iter().chain(charged).max_by(|a, b| worth(a).total_cmp(&worth(b)))
    };
    let above = || labels::bound(&items, EFFORT, progress);
    let (taken, bound) = rayon::join(schedules, above);
    Some(Found { taken, bound: bound? + constant, exact: false, multipliers })
}

/// The multipliers of the relaxation without thermal windows and the memory, which labels know.
fn relaxed(built: &mut Built<'_>) -> Option<Multipliers> {
    let mut program = built.program.clone();
    let kept: Vec<usize> =
        (0..program.rows.len()).filter(|it| !built.label_rows.contains(it)).collect();
    program.rows = kept.iter().map(|&it| built.program.rows[it].clone()).collect();
    let asked: Vec<usize> = (0..built.families.len())
        .filter(|&it| it < built.further_families || built.is_of_angles(it))
        .collect();
    let families: Vec<&dyn Family> = asked.iter().map(|&it| built.families[it].as_ref()).collect();
    let own = program.rows.len();
    let (found, of) = grow(&mut program, &families, (ROW_ROUNDS, built.offset));
    let (prices, slopes) = found?.per_unit();
    let mut rows = vec![0.0; built.program.rows.len()];
    for (&row, &price) in kept.iter().zip(&prices) {
        rows[row] = price;
    }
    for ((row, price), family) in program.rows.drain(own..).zip(&prices[own..]).zip(of) {
        let family = asked[family];
        if family >= built.further_families {
            built.grown.push((built.program.rows.len(), family));
            built.program.rows.push(row);
            built.rules.push(None);
            rows.push(*price);
        }
    }
    Some(Multipliers { rows, slopes })
}

/// The Lagrangian relaxation that labels solve.
struct Dual<'b> {
    built: &'b Built<'b>,
    /// The prices of overlap, days and windows of starts.
    plain: &'b Prices,
    further: Further<'b>,
    which: Dualised,
    /// What windows of the longest gap that labels charge are worth when none is empty.
    gaps: i128,
}

impl<'b> Dual<'b> {
    /// Labels know thermal windows and the memory; gaps are charged by them or by multipliers.
    fn new((built, plain): (&'b Built<'_>, &'b Prices), gaps: bool) -> Dual<'b> {
        let cells = built.program.cells.len();
        let cells_until = if gaps { cells - built.gaps.len() } else { cells };
        let worth = if gaps { built.gap_prices().map(i128::from).sum() } else { 0 };
        let which = Dualised { rows_from: built.further, cells_until };
        Dual { built, plain, further: Further::of(built, gaps), which, gaps: worth }
    }

    /// What labels visit at some multipliers, and what to add to their values.
    fn items(&self, at: &Multipliers) -> Option<(Items<'_>, i128)> {
        let program = &self.built.program;
        let Charged { constant, values } = charged(program, (&at.rows, &at.slopes), self.which);
        let items =
            Items::new((self.built.model, self.plain), (&values, &program.choices), &self.further)?;
        Some((items, constant + self.gaps))
    }

    /// Whether a set meets all rules.
    fn allowed(&self, taken: &[usize]) -> bool {
        check(self.built.problem, &self.built.model.candidates(taken)).is_ok()
    }

    /// The best of the schedules that labels give while multipliers rise.
    fn schedule(&self, mut at: Multipliers, progress: &dyn Progress) -> Option<Vec<usize>> {
        let log = self.built.problem.demands.log.is_some();
        let linked = log || !self.built.seasons.is_empty() || !self.built.angles.is_empty();
        let mut best: Option<(f64, Vec<usize>)> = None;
        let mut keep = |taken: Vec<usize>| -> bool {
            let (worth, allowed) = (worth::objective(self.built, &taken), self.allowed(&taken));
            if allowed && best.as_ref().is_none_or(|it| worth > it.0) {
                best = Some((worth, taken));
            }
            allowed
        };
        let mut step = STEP;
        for _ in 0..if linked { ROUNDS } else { 0 } {
            let (items, _) = self.items(&at)?;
            let found = labels::best(&items, SHORT, progress)?;
            self.raise(&found, &mut at, step);
            step *= GROWTH;
            if keep(found.taken) && !log {
                break;
            }
        }
        let (items, _) = self.items(&at)?;
        keep(labels::best(&items, LONG, progress)?.taken);
        let (worth, taken) = best?;
        let better = self.with_tight_seasons(&taken, progress).filter(|it| self.allowed(it));
        Some(better.filter(|it| worth::objective(self.built, it) > worth).unwrap_or(taken))
    }

    /// The best schedule by true values that holds those sessions of another without which a season would
    /// fall short; `None` where other rules are dualised as well.
    fn with_tight_seasons(&self, taken: &[usize], progress: &dyn Progress) -> Option<Vec<usize>> {
        let (built, program) = (self.built, &self.built.program);
        let others = built.problem.demands.log.is_some() || !built.angles.is_empty();
        if others || built.seasons.is_empty() {
            return None;
        }
        let stands: BTreeSet<usize> = taken.iter().copied().collect();
        let mut choices = program.choices.clone();
        for season in &built.seasons {
            let held = season.sessions.iter().filter(|it| stands.contains(it));
            let mut held: Vec<usize> = held.copied().collect();
            held.sort_by_key(|&id| Reverse(program.values[id]));
            held.iter().take(season.wanted).for_each(|&id| choices[id] = Choice::Always);
        }
        let items =
            Items::new((built.model, self.plain), (&program.values, &choices), &self.further)?;
        Some(labels::best(&items, LONG, progress)?.taken)
    }

    /// Raises the multipliers of the rules that a set breaks; slopes of logarithms move halfway to those at
    /// the set's sums.
    fn raise(&self, found: &labels::Found, at: &mut Multipliers, step: f64) {
        let program = &self.built.program;
        let mut stands = vec![false; program.values.len()];
        found.taken.iter().for_each(|&id| stands[id] = true);
        let held = |terms: &[(usize, i64)]| -> i64 {
            terms.iter().filter(|it| stands[it.0]).map(|it| it.1).sum()
        };
        let values: i128 = found.taken.iter().map(|&id| i128::from(program.values[id])).sum();
        let values = if values > 0 { values } else { found.value };
        let mean = f64_from_i128(values) / f64_from_usize(found.taken.len().max(1));
        let cells = program.cells.iter().zip(&mut at.slopes).take(self.which.cells_until);
        for (cell, slope) in cells {
            let held = cell.base + held(&cell.terms);
            match cell.gain {
                Gain::Shortfall { wanted, price } if held < wanted => {
                    *slope = (*slope + step * (*slope + mean)).min(f64_from_i64(price));
                }
                Gain::Shortfall { .. } => {}
                Gain::Log { .. } => *slope = 0.5 * (*slope + cell.gain.slope(f64_from_i64(held))),
            }
        }
        for angles in &self.built.angles {
            let grown = self.built.grown.iter().filter(|it| it.1 == angles.family).map(|it| it.0);
            for index in angles.rows.clone().chain(grown) {
                let row = &program.rows[index];
                if held(&row.terms) > row.limit {
                    let size: f64 = row.terms.iter().map(|it| f64_from_i64(it.1).abs()).sum();
                    let size = (size / f64_from_usize(row.terms.len().max(1))).max(1.0);
                    at.rows[index] += step * (at.rows[index] + mean / size);
                }
            }
        }
    }
}
