//! The best set of yes-or-no choices under integer rows, and a bound that no set exceeds.
//!
//! Maximise `sum v_i x_i + sum_c G_c(sum w_ci x_i)` over `x` in {0, 1} under rows `sum a_i x_i <= b`,
//! all numbers integers, every `G_c` concave ([`Gain`]: a priced shortfall, or a logarithm). Rows too
//! many to list come from a [`Family`] as they are broken.
//!
//! Method: Clarabel solves the linear relaxation on scaled data (`relaxation.rs`). From its prices
//! follows a bound in exact integer arithmetic on the data as given (`bound.rs`), whatever the
//! solver did. Rounding and repair give a first set (`round.rs`); what the bound says no better set
//! can hold, or lack, is fixed (reduced costs). What is left is searched by branch and bound
//! (`branch.rs`) over a dual simplex method (`simplex.rs`), with cover cuts (`cover.rs`), each prune
//! by the same exact bound; where too much is left, parts of it in turn (`exchange.rs`). The set
//! returned was evaluated row by row in integers (`state.rs`).
//!
//! Limits: effort is counted in nodes, cuts and passes, so equal input gives equal output; a
//! `stop` that the caller gives ends the search early, with the best set so far and a bound that
//! holds. Sums stay within i128 for values up to 2^45, coefficients and limits up to 2^53.

pub(crate) mod number;
mod gain;
mod state;
mod bound;
mod relaxation;
mod round;
mod complete;
mod cover;
mod simplex;
mod waiting;
mod branch;
mod choose;
mod exchange;
mod charge;

pub use gain::Gain;

use bound::Prices;
pub(crate) use charge::{Charged, charged, grow};
pub(crate) use relaxation::Relaxed;
use state::{Index, State};
use thiserror::Error;

/// Largest value of a choice or gain, in units.
pub const LARGEST_VALUE: i64 = 1 << 45;
/// Largest coefficient or limit.
pub const LARGEST_COEFFICIENT: i64 = 1 << 53;

/// `sum a_i x_i <= limit`.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Row {
    /// Choices and their coefficients, each choice at most once.
    pub terms: Vec<(usize, i64)>,
    /// The limit.
    pub limit: i64,
}

/// A concave part of the objective.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// Choices and what they add to the cell's sum, not negative.
    pub terms: Vec<(usize, i64)>,
    /// What the sum is worth.
    pub gain: Gain,
    /// The sum before any choice.
    pub base: i64,
}

/// What is open about a choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choice {
    /// It may be taken.
    Free,
    /// It must be taken.
    Always,
    /// It must not be taken.
    Never,
}

/// An integer programme over yes-or-no choices.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Program {
    /// Value of each choice in units.
    pub values: Vec<i64>,
    /// What is open about each.
    pub choices: Vec<Choice>,
    /// The rows.
    pub rows: Vec<Row>,
    /// The concave parts of the objective.
    pub cells: Vec<Cell>,
}

/// Rows that are found as they are broken.
pub trait Family: Sync {
    /// Rows of the family that a set breaks; none exactly where the set meets them all.
    fn broken(&self, taken: &[bool]) -> Vec<Row>;

    /// Rows of the family that shares break, for a sharper relaxation; may be none.
    fn separate(&self, shares: &[f64]) -> Vec<Row> {
        let _ = shares;
        Vec::new()
    }
}

/// How much work to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most nodes of the final branch and bound.
    pub nodes: usize,
    /// Most numbers that it touches, which bounds large nodes more than small ones.
    pub work: usize,
    /// Most rounds of cuts over the whole programme.
    pub cut_rounds: usize,
    /// Most passes of exchanges.
    pub passes: usize,
    /// Most nodes of one exchange.
    pub exchange_nodes: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { nodes: 400_000, work: 70_000_000_000, cut_rounds: 8, passes: 3, exchange_nodes: 200 }
    }
}

/// What the search may use beside the programme.
#[derive(Clone, Copy, Default)]
pub struct Aids<'a> {
    /// Rows found as they are broken.
    pub families: &'a [&'a dyn Family],
    /// A set to start from; left aside where it breaks a row.
    pub start: &'a [usize],
    /// A bound known from elsewhere: no set is worth more, in units.
    pub bound: Option<i128>,
    /// Asked now and then whether to stop.
    pub stop: Option<&'a (dyn Fn() -> bool + Sync)>,
}

impl std::fmt::Debug for Aids<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Aids").field("families", &self.families.len()).finish_non_exhaustive()
    }
}

impl Aids<'_> {
    fn stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop())
    }
}

/// Why the search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// No better set exists, or none at all.
    Proven,
    /// The limit on the work was reached.
    Work,
    /// The caller asked to stop.
    Stopped,
}

/// The best set found, and how good it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The choices taken, ascending; `None` where no set was found that meets all rows.
    pub taken: Option<Vec<usize>>,
    /// Value of the set in units; 0 without one.
    pub value: i128,
    /// No set is worth more, in units.
    pub bound: i128,
    /// The bound of the linear relaxation alone.
    pub relaxed: i128,
    /// Price of each row of the programme in units of value per unit of its limit.
    pub prices: Vec<f64>,
    /// The same summed over the rows that each family added to the relaxation.
    pub family_prices: Vec<f64>,
    /// Slope of each cell's gain in units of value per unit of its sum.
    pub slopes: Vec<f64>,
    /// Share of each choice in the relaxation.
    pub shares: Vec<f64>,
    /// Why the search ended.
    pub ended: Ended,
    /// Nodes of the final branch and bound.
    pub nodes: usize,
    /// Rows added as cuts or by families to the whole programme.
    pub cuts: usize,
}

/// Why a programme cannot be worked on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum ProgramError {
    /// Lists of different lengths.
    #[error("there are {values} values but {choices} choices")]
    Lengths {
        /// Number of values.
        values: usize,
        /// Number of choices.
        choices: usize,
    },
    /// A row or cell names a choice that does not exist, or twice.
    #[error("row or cell {index} names choice {choice}, which does not exist or came before")]
    Term {
        /// Index among the rows, then the cells.
        index: usize,
        /// The choice.
        choice: usize,
    },
    /// A number is out of range.
    #[error("{what} {index} holds {number}, beyond what sums allow")]
    Number {
        /// Which list.
        what: &'static str,
        /// Index in it.
        index: usize,
        /// The number.
        number: i64,
    },
    /// The choices that must be taken break a row of coefficients at or above zero.
    #[error("the choices that must be taken use {used} of row {row}, more than {limit}")]
    Always {
        /// The row.
        row: usize,
        /// What they use.
        used: i128,
        /// The row's limit.
        limit: i64,
    },
}

/// A set as marks and its value, where there is one.
type Best = Option<(Vec<bool>, i128)>;

/// Free choices times rows that branch and bound takes on at once.
const CORE_SIZE: usize = 1_500_000;
/// Most free choices that it takes on at once.
const CORE_CHOICES: usize = 4_000;

impl Program {
    fn validate(&self) -> Result<(), ProgramError> {
        let count = self.values.len();
        if self.choices.len() != count {
            return Err(ProgramError::Lengths { values: count, choices: self.choices.len() });
        }
        let within = |what, index, number: i64, most: i64| {
            if (-most..=most).contains(&number) {
                Ok(())
            } else {
                Err(ProgramError::Number { what, index, number })
            }
        };
        for (index, &value) in self.values.iter().enumerate() {
            within("value", index, value, LARGEST_VALUE)?;
        }
        let mut seen = vec![usize::MAX; count];
        let rows = self.rows.iter().map(|row| &row.terms);
        let cells = self.cells.iter().map(|cell| &cell.terms);
        for (index, terms) in rows.chain(cells).enumerate() {
            for &(choice, coefficient) in terms {
                if seen.get(choice).is_none_or(|&last| last == index) {
                    return Err(ProgramError::Term { index, choice });
                }
                seen[choice] = index;
                within("row or cell", index, coefficient, LARGEST_COEFFICIENT)?;
            }
        }
        for (index, row) in self.rows.iter().enumerate() {
            within("limit", index, row.limit, LARGEST_COEFFICIENT)?;
        }
        for (index, cell) in self.cells.iter().enumerate() {
            let (first, second, least) = match cell.gain {
                Gain::Shortfall { wanted, price } => (price, wanted, 0),
                Gain::Log { scale, offset } => (scale, offset, 1),
            };
            let sum: i64 = cell.terms.iter().fold(0, |sum, term| sum.saturating_add(term.1));
            let legal = (0..=LARGEST_VALUE).contains(&first)
                && (least..=LARGEST_COEFFICIENT).contains(&second)
                && cell.terms.iter().all(|term| term.1 >= 0)
                && (0..=LARGEST_COEFFICIENT).contains(&cell.base)
                && cell.base.saturating_add(sum) <= LARGEST_COEFFICIENT
                && cell.gain.at(cell.base.saturating_add(sum)) < LARGEST_VALUE << 8;
            if !legal {
                return Err(ProgramError::Number { what: "cell", index, number: first });
            }
        }
        Ok(())
    }

    /// Value of a set in units where it meets every row and family, in exact arithmetic.
    ///
    /// # Errors
    /// [`ProgramError`] where the programme is not one.
    pub fn evaluate(
        &self,
        taken: &[usize],
        families: &[&dyn Family],
    ) -> Result<Option<i128>, ProgramError> {
        self.validate()?;
        let index = Index::new(self);
        let mut state = State::new(self, &index);
        let mut marks = vec![false; self.values.len()];
        for &choice in taken {
            if marks.get(choice).is_none_or(|&mark| mark) {
                return Ok(None);
            }
            marks[choice] = true;
            state.set(choice, true);
        }
        let met = state.meets_choices()
            && state.broken_rows().next().is_none()
            && families.iter().all(|family| family.broken(&marks).is_empty());
        Ok(met.then(|| state.value()))
    }
}

/// The relaxation of a programme, to be handed on to [`solve_from`]; `None` where there is none.
/// Shares known from elsewhere say which choices matter.
pub(crate) fn relax(program: &Program, known: &[f64]) -> Option<Relaxed> {
    program.validate().ok()?;
    relaxation::solve(program, known)
}

/// The relaxation's worth in units and the share of each choice, after some rounds of the families'
/// rows; `None` where the solver fails.
pub(crate) fn relaxed_shares(
    program: &Program,
    families: &[&dyn Family],
    rounds: usize,
) -> Option<(i128, Vec<f64>)> {
    program.validate().ok()?;
    let mut grown = program.clone();
    let mut shares = vec![0.0; program.values.len()];
    for round in 0..=rounds {
        let found = relaxation::solve(&grown, &shares)?;
        shares = found.shares;
        let cuts: Vec<Row> = families.iter().flat_map(|family| family.separate(&shares)).collect();
        if cuts.is_empty() || round == rounds {
            return Some((bound::priced(&grown, &found.prices).bound, shares));
        }
        grown.rows.extend(cuts);
    }
    None
}

/// Searches for the best set.
///
/// # Errors
/// [`ProgramError`] where the programme is not one, or what must be taken cannot be.
pub fn solve(program: &Program, limits: &Limits, aids: &Aids<'_>) -> Result<Outcome, ProgramError> {
    solve_from(program, limits, aids, None)
}

/// As [`solve`], the relaxation solved before where it is given.
#[expect(clippy::too_many_lines, reason = "the steps of the search, one after the other")]
pub(crate) fn solve_from(
    program: &Program,
    limits: &Limits,
    aids: &Aids<'_>,
    mut relaxed: Option<Relaxed>,
) -> Result<Outcome, ProgramError> {
    program.validate()?;
    let own_rows = program.rows.len();
    let mut grown = program.clone();
    let program = &mut grown;
    let mut index = Index::new(program);
    forced(program, &index)?;
    let mut best: Best = None;
    // What each choice pays, where families let rounded sets fall short.
    let filling = !aids.families.is_empty() && program.values.len() <= complete::MOST_CHOICES;
    let mut pays = if filling { complete::by_shares(program, &index) } else { Vec::new() };
    let start = round::repaired(program, &index, aids.start);
    offer(program, &index, (aids, &pays), &start, &mut best);
    offer(program, &index, (aids, &pays), &round::greedy(program, &index), &mut best);
    if filling {
        let set = filled_up(program, &index, (aids, &pays), round::always(program, &index).marks());
        offer(program, &index, (aids, &pays), &set, &mut best);
    }

    // The root: relax, bound, round, cut, and again.
    let mut prices = Prices::none(program);
    let whole_step = branch::step(program);
    let mut bound = bound::priced(program, &prices).bound;
    let known = aids.bound.unwrap_or(i128::MAX);
    let (mut relaxed_bound, mut shares) = (bound, vec![0.0; program.values.len()]);
    let mut fixes = vec![None; program.values.len()];
    let reached = |best: &Best, bound: i128| {
        best.as_ref().is_some_and(|(_, value)| *value >= bound.min(known))
    };
    let mut halted = false;
    // Rows that families add here, and which family.
    let mut family_rows: Vec<(usize, usize)> = Vec::new();
    for round in 0..=limits.cut_rounds {
        if reached(&best, bound) {
            break;
        }
        if aids.stopped() {
            halted = true;
            break;
        }
        let ready = relaxed.take();
        let Some(relaxed) = ready.or_else(|| relaxation::solve(program, &shares)) else { break };
        if filling {
            pays = complete::by_prices(program, &relaxed);
            let set = round::always(program, &index).marks();
            let set = filled_up(program, &index, (aids, &pays), set);
            offer(program, &index, (aids, &pays), &set, &mut best);
        }
        let found = bound::priced(program, &relaxed.prices);
        let gained = bound - found.bound;
        if found.bound <= bound {
            bound = found.bound.div_euclid(whole_step) * whole_step;
            prices = relaxed.prices;
        }
        shares = relaxed.shares;
        if round == 0 {
            relaxed_bound = bound;
        }
        for way in 0..round::WAYS {
            let set = round::rounded(program, &index, &shares, way);
            offer(program, &index, (aids, &pays), &set, &mut best);
        }
        if let Some((_, value)) = &best
            && !found.note(*value, &mut fixes)
        {
            bound = *value;
        }
        let missing = best.as_ref().map_or(i128::MAX, |(_, value)| (bound - value) >> 6);
        let small = round > 1 && gained < (bound.abs() >> 12).min(missing);
        if round == limits.cut_rounds || small {
            break;
        }
        let before = program.rows.len();
        program.rows.extend(cover::separate(program, &shares));
        for (family, it) in aids.families.iter().enumerate() {
            let rows = it.separate(&shares);
            family_rows.extend((0..rows.len()).map(|at| (program.rows.len() + at, family)));
            program.rows.extend(rows);
        }
        if program.rows.len() == before {
            break;
        }
        prices.rows.resize(program.rows.len(), 0);
        index = Index::new(program);
    }
    let mut ended = if halted { Ended::Stopped } else { Ended::Work };
    let mut nodes = 0;
    if !halted && !reached(&best, bound) {
        let reserve = bound::priced(program, &prices);
        let mut search = exchange::Search {
            program,
            index: &mut index,
            aids,
            limits,
            priced: &reserve,
            shares: &shares,
        };
        let mut open = noted(&reserve, best.as_ref(), &mut fixes);
        let large = open.is_some_and(|open| open > exchange::PART);
        if filling && large {
            renewed(search.program, search.index, (aids, &pays), &mut best);
        }
        // Exchanges first where the rest is large: a better set fixes more.
        if large {
            search.exchange(&mut best);
            if filling {
                renewed(search.program, search.index, (aids, &pays), &mut best);
            }
            open = noted(&reserve, best.as_ref(), &mut fixes);
        }
        let whole =
            |open: usize| open <= CORE_CHOICES && open * search.rows_touched(open) <= CORE_SIZE;
        if open.is_none() {
            bound = best.as_ref().map_or(bound, |(_, value)| *value);
        } else if aids.stopped() {
            ended = Ended::Stopped;
        } else if open.is_some_and(whole) {
            let (core, count, end) = search.core(&mut best, &fixes);
            bound = bound.min(core);
            nodes = count;
            ended = end;
        }
    }
    if reached(&best, bound) {
        ended = Ended::Proven;
    }
    let value = best.as_ref().map_or(0, |(_, value)| *value);
    let marks = best.map(|(marks, _)| marks);
    bound = bound.min(known);
    if marks.is_some() {
        bound = bound.max(value);
    }
    let per_row = prices.per_unit();
    let mut family_prices = vec![0.0; aids.families.len()];
    for (row, family) in family_rows {
        family_prices[family] += per_row[row];
    }
    Ok(Outcome {
        taken: marks.map(|marks| (0..marks.len()).filter(|&choice| marks[choice]).collect()),
        value,
        bound,
        relaxed: relaxed_bound,
        prices: per_row.into_iter().take(own_rows).collect(),
        family_prices,
        slopes: prices.slopes_per_unit(),
        shares,
        ended,
        nodes,
        cuts: program.rows.len() - own_rows,
    })
}

/// Notes what is the same in every better set; how many choices stay open, `None` where the notes
/// contradict each other.
fn noted(
    priced: &bound::Priced,
    best: Option<&(Vec<bool>, i128)>,
    fixes: &mut [Option<bool>],
) -> Option<usize> {
    if let Some((_, value)) = best
        && !priced.note(*value, fixes)
    {
        return None;
    }
    Some(fixes.iter().filter(|fix| fix.is_none()).count())
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

/// Gives back and fills anew the stretches of the best set.
fn renewed(program: &Program, index: &Index, (aids, pays): (&Aids<'_>, &[f64]), best: &mut Best) {
    if let Some((set, value)) = best {
        let mut filling = complete::Filling::new(program, index, aids, set.clone());
        filling.improve(pays);
        let better = filling.marks();
        *value = State::of(program, index, &better).value();
        *set = better;
    }
}

/// A set that breaks nothing, filled up by what choices pay.
fn filled_up(
    program: &Program,
    index: &Index,
    (aids, pays): (&Aids<'_>, &[f64]),
    set: Vec<bool>,
) -> Vec<bool> {
    let all = 0..set.len();
    let mut filling = complete::Filling::new(program, index, aids, set);
    filling.fill(all, &|choice| pays[choice]);
    filling.marks()
}

/// Keeps a set that meets all rows and is better; rows of families that it breaks are left to the
/// search.
fn offer(
    program: &Program,
    index: &Index,
    (aids, pays): (&Aids<'_>, &[f64]),
    set: &[bool],
    best: &mut Best,
) {
    let state = State::of(program, index, set);
    let better = best.as_ref().is_none_or(|(_, value)| state.value() > *value);
    if better && state.meets_choices() && state.broken_rows().next().is_none() {
        let own = round::within_families(program, index, aids, set.to_vec());
        // What was given back leaves room.
        let gave = own != set;
        let room = gave && !pays.is_empty();
        let set = if room { filled_up(program, index, (aids, pays), own) } else { own };
        let state = State::of(program, index, &set);
        let met = state.meets_choices()
            && state.broken_rows().next().is_none()
            && aids.families.iter().all(|family| family.broken(&set).is_empty());
        if met && best.as_ref().is_none_or(|(_, value)| state.value() > *value) {
            let value = state.value();
            *best = Some((set, value));
        }
    }
}
