//! The search for the best set: relaxation and cuts at the root, then exchanges and branch and bound.
//!
//! Method: in rounds the relaxation is solved, its prices give a bound and fix choices, rounding and the
//! greedy fill offer sets, violated rows and cover cuts enter. Rounds end where the bound hardly falls.
//! If much is left open, the incumbent is improved by large neighbourhoods and exchanges, since a better
//! set fixes more; what is then open is searched by branch and bound where it is small enough.
//!
//! Limits: those of [`Limits`]; above [`CORE_CHOICES`] open choices the bound is the root's.

use super::bound::{self, Priced, Prices};
use super::branch;
use super::cover;
use super::error::ProgramError;
use super::exchange::{Exchange, PART};
use super::incumbent::{Incumbent, Judge};
use super::large_neighbourhood;
use super::number::u64_from_usize;
use super::options::{Aids, Limits};
use super::outcome::{Ended, Outcome};
use super::problem::Program;
use super::relaxation::{self, Relaxed};
use super::round;
use super::state::Index;

/// Free choices times rows that branch and bound takes on at once.
const CORE_SIZE: usize = 1_500_000;
/// Most free choices that it takes on at once.
const CORE_CHOICES: usize = 4_000;

/// Searches for the best set.
///
/// # Errors
/// [`ProgramError`] where the programme is not one, or what must be taken cannot be.
pub fn solve(program: &Program, limits: &Limits, aids: &Aids<'_>) -> Result<Outcome, ProgramError> {
    solve_from(program, limits, aids, None)
}

/// As [`solve`], the relaxation solved before where it is given.
pub(crate) fn solve_from(
    program: &Program,
    limits: &Limits,
    aids: &Aids<'_>,
    relaxed: Option<Relaxed>,
) -> Result<Outcome, ProgramError> {
    program.validate()?;
    let own_rows = program.rows.len();
    let mut root = Root::new(program.clone(), aids);
    forced(&root.program, &root.index)?;
    root.first_sets();
    let stopped = root.cut(limits.cut_rounds, relaxed);
    let mut end = End { ended: if stopped { Ended::Stopped } else { Ended::Work }, nodes: 0 };
    if !stopped && !root.is_reached() {
        end = root.search(limits);
    }
    if root.is_reached() {
        end.ended = Ended::Proven;
    }
    Ok(root.outcome(own_rows, &end))
}

/// Whether what must be taken leaves every row of coefficients at or above zero intact.
fn forced(program: &Program, index: &Index) -> Result<(), ProgramError> {
    let state = round::always(program, index);
    let broken = state.broken_rows().find(|&row| index.is_packing(row));
    broken.map_or(Ok(()), |row| {
        let (used, limit) = (state.used(row), program.rows[row].limit);
        Err(ProgramError::Always { row, used, limit })
    })
}

/// Why a search ended, and its nodes.
struct End {
    ended: Ended,
    nodes: usize,
}

/// The search at its root, before any branching.
struct Root<'a> {
    /// The programme, which cuts and rows of families extend.
    program: Program,
    index: Index,
    aids: &'a Aids<'a>,
    /// Whether sets are filled by what choices cost: families let rounded sets fall short.
    filling: bool,
    /// What each choice costs; empty where sets are not filled.
    costs: Vec<f64>,
    best: Incumbent,
    prices: Prices,
    bound: i128,
    /// The bound of the relaxation without cuts.
    relaxed_bound: i128,
    shares: Vec<f64>,
    /// The value that each choice has in every better set, where there is one.
    fixes: Vec<Option<bool>>,
    /// Rows that families added, and which family.
    family_rows: Vec<(usize, usize)>,
}

impl<'a> Root<'a> {
    fn new(program: Program, aids: &'a Aids<'a>) -> Self {
        let index = Index::new(&program);
        let count = program.values.len();
        let filling = !aids.families.is_empty() && count <= large_neighbourhood::MOST_CHOICES;
        let costs =
            if filling { large_neighbourhood::by_shares(&program, &index) } else { Vec::new() };
        let prices = Prices::none(&program);
        let bound = bound::priced(&program, &prices).bound;
        Self {
            program,
            index,
            aids,
            filling,
            costs,
            best: None,
            prices,
            bound,
            relaxed_bound: bound,
            shares: vec![0.0; count],
            fixes: vec![None; count],
            family_rows: Vec::new(),
        }
    }

    /// A bound known from elsewhere.
    fn known(&self) -> i128 {
        self.aids.bound.unwrap_or(i128::MAX)
    }

    /// Whether the incumbent is worth as much as a bound allows.
    fn is_reached(&self) -> bool {
        self.best.as_ref().is_some_and(|(_, value)| *value >= self.bound.min(self.known()))
    }

    fn offer(&mut self, set: &[bool]) {
        let (program, index, costs) = (&self.program, &self.index, &self.costs);
        Judge { program, index, aids: self.aids, costs }.offer(set, &mut self.best);
    }

    fn offer_filled(&mut self) {
        let (program, index, costs) = (&self.program, &self.index, &self.costs);
        Judge { program, index, aids: self.aids, costs }.offer_filled(&mut self.best);
    }

    /// Sets that need no relaxation.
    fn first_sets(&mut self) {
        let start = round::repaired(&self.program, &self.index, self.aids.start);
        self.offer(&start);
        let greedy = round::greedy(&self.program, &self.index);
        self.offer(&greedy);
        if self.filling {
            self.offer_filled();
        }
    }

    /// Relax, bound, round, cut, and again; true if the caller asked to stop.
    fn cut(&mut self, rounds: usize, mut relaxed: Option<Relaxed>) -> bool {
        let step = branch::step(&self.program);
        let progress = self.aids.progress;
        progress.begin("relaxation and cuts", u64_from_usize(rounds).saturating_add(1));
        for round in 0..=rounds {
            if self.is_reached() {
                break;
            }
            if progress.stopped() {
                return true;
            }
            let ready = relaxed.take();
            let solved = ready.or_else(|| relaxation::solve(&self.program, &self.shares));
            let Some(relaxed) = solved else { break };
            let gained = self.take_over(relaxed, (round, step));
            let value = self.best.as_ref().map(|best| best.1);
            let missing = value.map_or(i128::MAX, |value| (self.bound - value) >> 6);
            let small = round > 1 && gained < (self.bound.abs() >> 12).min(missing);
            if round == rounds || small || !self.grow() {
                break;
            }
            progress.advance(1);
        }
        false
    }

    /// Bound, sets and fixes from a relaxation; how much the bound fell.
    fn take_over(&mut self, relaxed: Relaxed, (round, step): (usize, i128)) -> i128 {
        if self.filling {
            self.costs = large_neighbourhood::by_prices(&self.program, &relaxed);
            self.offer_filled();
        }
        let found = bound::priced(&self.program, &relaxed.prices);
        let gained = self.bound - found.bound;
        if found.bound <= self.bound {
            self.bound = found.bound.div_euclid(step) * step;
            self.prices = relaxed.prices;
        }
        self.shares = relaxed.shares;
        if round == 0 {
            self.relaxed_bound = self.bound;
        }
        for way in 0..round::WAYS {
            let set = round::rounded(&self.program, &self.index, &self.shares, way);
            self.offer(&set);
        }
        if let Some((_, value)) = &self.best
            && !found.note(*value, &mut self.fixes)
        {
            self.bound = *value;
        }
        gained
    }

    /// Adds cover cuts and rows of families that the shares violate; false where there are none.
    fn grow(&mut self) -> bool {
        let program = &mut self.program;
        let before = program.rows.len();
        program.rows.extend(cover::separate(program, &self.shares));
        for (family, it) in self.aids.families.iter().enumerate() {
            let rows = it.separate(&self.shares);
            self.family_rows.extend((0..rows.len()).map(|at| (program.rows.len() + at, family)));
            program.rows.extend(rows);
        }
        if program.rows.len() == before {
            return false;
        }
        self.prices.rows.resize(program.rows.len(), 0);
        self.index = Index::new(program);
        true
    }

    /// Improves the incumbent, and searches what is open where it is small enough.
    fn search(&mut self, limits: &Limits) -> End {
        let priced = bound::priced(&self.program, &self.prices);
        let (program, index, aids, costs) = (&self.program, &self.index, self.aids, &self.costs);
        let exchange =
            Exchange { program, index, aids, limits, priced: &priced, shares: &self.shares };
        let judge = Judge { program, index, aids, costs };
        let mut open = noted(&priced, &self.best, &mut self.fixes);
        if open.is_some_and(|open| open > PART) {
            if self.filling {
                judge.renew(&mut self.best);
            }
            exchange.improve(&mut self.best);
            if self.filling {
                judge.renew(&mut self.best);
            }
            open = noted(&priced, &self.best, &mut self.fixes);
        }
        let Some(open) = open else {
            self.bound = self.best.as_ref().map_or(self.bound, |(_, value)| *value);
            return End { ended: Ended::Work, nodes: 0 };
        };
        if aids.progress.stopped() {
            return End { ended: Ended::Stopped, nodes: 0 };
        }
        if open > CORE_CHOICES || open * exchange.rows_touched(open) > CORE_SIZE {
            return End { ended: Ended::Work, nodes: 0 };
        }
        let (core, nodes, ended) = exchange.core(&mut self.best, &self.fixes);
        self.bound = self.bound.min(core);
        End { ended, nodes }
    }

    /// What was found, for a programme of `own_rows` rows.
    fn outcome(self, own_rows: usize, end: &End) -> Outcome {
        let known = self.known();
        let value = self.best.as_ref().map_or(0, |(_, value)| *value);
        let marks = self.best.map(|(marks, _)| marks);
        let mut bound = self.bound.min(known);
        if marks.is_some() {
            bound = bound.max(value);
        }
        let per_row = self.prices.per_unit();
        let mut family_prices = vec![0.0; self.aids.families.len()];
        for (row, family) in self.family_rows {
            family_prices[family] += per_row[row];
        }
        Outcome {
            taken: marks.map(|marks| (0..marks.len()).filter(|&choice| marks[choice]).collect()),
            value,
            bound,
            relaxed: self.relaxed_bound,
            prices: per_row.into_iter().take(own_rows).collect(),
            family_prices,
            slopes: self.prices.slopes_per_unit(),
            shares: self.shares,
            ended: end.ended,
            nodes: end.nodes,
            cuts: self.program.rows.len() - own_rows,
        }
    }
}

/// Notes what is the same in every better set; how many choices stay open, `None` where the notes
/// contradict each other.
fn noted(priced: &Priced, best: &Incumbent, fixes: &mut [Option<bool>]) -> Option<usize> {
    if let Some((_, value)) = best
        && !priced.note(*value, fixes)
    {
        return None;
    }
    Some(fixes.iter().filter(|fix| fix.is_none()).count())
}
