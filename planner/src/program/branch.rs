//! Branch and bound over the choices that are left.
//!
//! Method: each node fixes some choices. Its relaxation is solved by the dual simplex method, from
//! the basis of the node before; rows enter it when shares break them, tangents of logarithms where
//! shares sit. From its prices follows a bound in integers (`bound.rs`), which decides whether the
//! node is pruned, and which further choices are the same in every better set. The choice to branch
//! on is the one whose both sides lose most, judged by trial at first, then by experience
//! (pseudo-costs). The search goes down until a node is pruned, then on at the node of largest bound.
//! A bound is rounded down to a multiple of what divides all values where it decides on pruning, not
//! where it orders the nodes: tied values would make them all alike.
//!
//! Limits: a count of nodes. Nodes cut short leave their bound in the result.

use super::bound::{Prices, impossible, priced};
use super::choose::Experience;
use super::gain::UNIT;
use super::number::{f64_from_i64, f64_from_i128};
use super::simplex::{Simplex, Status};
use super::state::{Index, State};
use super::waiting::{Node, Waiting};
use super::{Choice, Ended, Gain, Program, Row, cover, round};
use rayon::prelude::*;
use std::cmp::Reverse;

/// Shares this close to a whole number are whole.
pub(super) const WHOLE: f64 = 1e-6;
/// Rows must be broken by this share of their size.
const BROKEN: f64 = 1e-7;
/// Most rows added at once.
const AT_ONCE: usize = 40;
/// Most rounds of rows in one node.
const ROUNDS: usize = 60;
/// Most rounds of cover cuts at the first node.
const CUT_ROUNDS: usize = 6;
/// Most pivots of one relaxation.
const PIVOTS: usize = 20_000;
/// Nodes between two attempts at rounding.
const ROUNDING: usize = 3;
/// Nodes of one searcher alone, number of searchers after that, and nodes of each between two talks.
const ALONE: usize = 400;
const TEAM: usize = 4;
const TURN: usize = 250;
/// A set this close to the bound, as a power of two of its value, needs no further search: prices of
/// rows in nanoseconds resolve no more.
const CLOSE_BITS: u32 = 30;

/// What to look for.
pub(super) struct Task<'a> {
    /// Only sets worth more count.
    pub(super) cutoff: i128,
    /// Most nodes.
    pub(super) nodes: usize,
    /// Most numbers touched.
    pub(super) work: usize,
    /// Rows that a set breaks beside the programme's.
    pub(super) broken: &'a (dyn Fn(&[bool]) -> Vec<Row> + Sync),
    /// Whether to stop.
    pub(super) stop: &'a (dyn Fn() -> bool + Sync),
}

/// What was found.
#[derive(Debug)]
pub(super) struct Found {
    /// The best set worth more than the cutoff, and its value.
    pub(super) best: Option<(Vec<bool>, i128)>,
    /// No set is worth more; at least the cutoff.
    pub(super) bound: i128,
    pub(super) nodes: usize,
    pub(super) ended: Ended,
}

/// Deals the nodes out by bound in turn, and tells everyone the best value.
fn share_out(team: &mut [Search<'_>]) {
    let value = team.iter().map(|it| it.value).max().unwrap_or(i128::MIN);
    let mut nodes: Vec<Node> = Vec::new();
    for member in team.iter_mut() {
        member.value = value;
        nodes.extend(std::iter::from_fn(|| member.waiting.next()));
    }
    nodes.sort_by_key(|node| Reverse(node.bound));
    let count = team.len();
    for (place, node) in nodes.into_iter().enumerate() {
        team[place % count].waiting.add(node);
    }
}

/// A row of the relaxation.
#[derive(Debug, Clone, Copy)]
enum Line {
    /// A row of the programme, over its size.
    Row(usize, f64),
    /// A tangent of a cell's gain, with its slope.
    Tangent(usize, f64),
}

pub(super) struct Search<'t> {
    pub(super) program: Program,
    task: &'t Task<'t>,
    roots: Vec<Choice>,
    index: Index,
    pub(super) relaxation: Simplex,
    lines: Vec<Line>,
    present: Vec<bool>,
    pub(super) unit: f64,
    /// Worth of each cell's whole range.
    ranges: Vec<f64>,
    best: Option<(Vec<bool>, i128)>,
    pub(super) value: i128,
    /// Largest bound among nodes closed above the best value.
    left: i128,
    pub(super) experience: Vec<Experience>,
    nodes: usize,
    /// Every set's worth is a multiple.
    step: i128,
    /// Numbers touched beside the relaxation's.
    work: usize,
    /// Coefficients of the programme.
    terms: usize,
    waiting: Waiting,
}

/// Searches a programme whose free choices are all of it.
pub(super) fn search(program: Program, task: &Task<'_>) -> Found {
    Search::new(program, task).run()
}

impl<'t> Search<'t> {
    fn new(program: Program, task: &'t Task<'t>) -> Self {
        let most = |cell: &super::Cell| cell.base + cell.terms.iter().map(|it| it.1).sum::<i64>();
        let ranges: Vec<f64> = program
            .cells
            .iter()
            .map(|cell| f64_from_i64(cell.gain.at(most(cell)) - cell.gain.at(cell.base)).max(1.0))
            .collect();
        let values = program.values.iter().map(|&value| f64_from_i64(value));
        let unit = values.clone().map(f64::abs).chain(ranges.iter().copied()).fold(1.0, f64::max);
        let costs: Vec<f64> = values.chain(ranges.iter().copied()).map(|it| it / unit).collect();
        let upper = vec![1.0; costs.len()];
        let mut search = Self {
            task,
            roots: program.choices.clone(),
            index: Index::new(&program),
            relaxation: Simplex::new(costs, upper),
            lines: Vec::new(),
            present: vec![false; program.rows.len()],
            unit,
            ranges,
            best: None,
            value: task.cutoff,
            left: task.cutoff,
            experience: vec![Experience::default(); program.values.len()],
            nodes: 0,
            step: step(&program),
            work: 0,
            waiting: Waiting::default(),
            terms: program.rows.iter().map(|row| row.terms.len()).sum(),
            program,
        };
        for cell in 0..search.program.cells.len() {
            let it = &search.program.cells[cell];
            let (base, most) = (f64_from_i64(it.base), f64_from_i64(most(it)));
            let places = match it.gain {
                Gain::Shortfall { .. } => 1,
                Gain::Log { .. } => 5,
            };
            for place in 0..places {
                search.tangent(cell, base + (most - base) * f64::from(place * place) / 25.0);
            }
        }
        search
    }

    /// Goes on for at most some nodes; `Proven` where no node is left.
    fn go_on(&mut self, nodes: usize) -> Ended {
        let most = self.nodes + nodes;
        let mut current: Option<Node> = None;
        loop {
            let Some(mut node) = current.take().or_else(|| self.waiting.next()) else {
                return Ended::Proven;
            };
            if self.closed(node.bound) {
                continue;
            }
            let stop = self.nodes.is_multiple_of(16) && (self.task.stop)();
            if self.nodes >= most || stop {
                self.waiting.add(node);
                return if stop { Ended::Stopped } else { Ended::Work };
            }
            self.nodes += 1;
            let Some((choice, share)) = self.visit(&mut node) else { continue };
            let mut sides = [false, true].map(|side| {
                let mut child = node.clone();
                child.fixes.push((choice, side));
                child
            });
            // The nearer side first.
            if share >= 0.5 {
                sides.reverse();
            }
            let [first, second] = sides;
            current = Some(first);
            self.waiting.add(second);
        }
    }

    /// Alone at first, then by several that share nodes and the best value from time to time.
    fn run(mut self) -> Found {
        self.waiting.add(Node { bound: i128::MAX, fixes: Vec::new() });
        let mut ended = self.go_on(ALONE.min(self.task.nodes));
        let mut team = vec![self];
        while ended == Ended::Work {
            let nodes: usize = team.iter().map(|it| it.nodes).sum();
            let work: usize = team.iter().map(Search::work).sum();
            if nodes >= team[0].task.nodes || work >= team[0].task.work {
                break;
            }
            if team.len() == 1 {
                team = (0..TEAM).map(|member| team[0].member(member)).collect();
            }
            share_out(&mut team);
            let share = TURN.min(team[0].task.nodes.saturating_sub(nodes) / TEAM + 1);
            let ends: Vec<Ended> = team.par_iter_mut().map(|it| it.go_on(share)).collect();
            ended = if ends.contains(&Ended::Stopped) {
                Ended::Stopped
            } else if ends.iter().all(|it| *it == Ended::Proven) {
                Ended::Proven
            } else {
                Ended::Work
            };
        }
        share_out(&mut team);
        let nodes = team.iter().map(|it| it.nodes).sum();
        let open = team.iter().filter_map(|it| it.waiting.largest()).max();
        let left = team.iter().map(|it| it.left).max().unwrap_or(i128::MIN);
        let value = team[0].value;
        let open = open.map_or(i128::MIN, |it| it.div_euclid(team[0].step) * team[0].step);
        let bound = value.max(left).max(open);
        let ended = if bound <= value { Ended::Proven } else { ended };
        let best = team.into_iter().find_map(|it| it.best.filter(|best| best.1 == value));
        Found { best, bound, nodes, ended }
    }

    /// One of several that go on from here; the first keeps the counts.
    fn member(&self, number: usize) -> Self {
        let mut member = Self {
            program: self.program.clone(),
            task: self.task,
            roots: self.roots.clone(),
            index: Index::new(&self.program),
            relaxation: self.relaxation.clone(),
            lines: self.lines.clone(),
            present: self.present.clone(),
            ranges: self.ranges.clone(),
            best: self.best.clone(),
            experience: self.experience.clone(),
            waiting: Waiting::default(),
            ..*self
        };
        if number == 0 {
            member.waiting = self.waiting.clone();
        } else {
            member.nodes = 0;
            member.work = 0;
            member.relaxation.touched = 0;
        }
        member
    }

    /// Numbers touched so far.
    fn work(&self) -> usize {
        self.work + self.relaxation.touched
    }

    /// Whether a bound leaves nothing to look for; what it leaves by rounding is noted.
    fn closed(&mut self, bound: i128) -> bool {
        let bound = bound.div_euclid(self.step) * self.step;
        let closed = bound <= self.value + (self.value.abs() >> CLOSE_BITS);
        if closed {
            self.left = self.left.max(bound);
        }
        closed
    }

    fn fix(&mut self, choice: usize, taken: bool) {
        self.program.choices[choice] = if taken { Choice::Always } else { Choice::Never };
        let bound = f64::from(u8::from(taken));
        self.relaxation.lower[choice] = bound;
        self.relaxation.upper[choice] = bound;
    }

    fn apply(&mut self, node: &Node) {
        for choice in 0..self.roots.len() {
            match self.roots[choice] {
                Choice::Free => {
                    self.program.choices[choice] = Choice::Free;
                    self.relaxation.lower[choice] = 0.0;
                    self.relaxation.upper[choice] = 1.0;
                }
                Choice::Always => self.fix(choice, true),
                Choice::Never => self.fix(choice, false),
            }
        }
        for &(choice, taken) in &node.fixes {
            self.fix(choice, taken);
        }
    }

    /// Bounds a node; the choice to branch on and its share, or `None` where it is closed.
    fn visit(&mut self, node: &mut Node) -> Option<(usize, f64)> {
        self.apply(node);
        let first = self.nodes == 1;
        let mut cuts = if first { CUT_ROUNDS } else { 0 };
        let mut shares = Vec::new();
        for _ in 0..ROUNDS {
            let cutoff = (f64_from_i128(self.value)) / self.unit;
            let cutoff = cutoff - 1e-9 * cutoff.abs() - 1e-12;
            let mut status = self.relaxation.solve(cutoff, PIVOTS);
            if status == Status::CutOff {
                if self.bound(node) {
                    return None;
                }
                status = self.relaxation.solve(f64::NEG_INFINITY, PIVOTS);
            }
            if let Status::Impossible(row) = status {
                let ray = self.relaxation.ray(row);
                if self.is_impossible(&ray) {
                    return None;
                }
                break;
            }
            if self.bound(node) {
                return None;
            }
            shares = self.shares();
            if self.add_broken(&shares) {
                continue;
            }
            if cuts > 0 {
                cuts -= 1;
                let found = cover::separate(&self.program, &shares);
                if !found.is_empty() {
                    self.grow(found);
                    continue;
                }
            }
            // Whole shares may break rows of families.
            if shares.iter().all(|share| (share - share.round()).abs() < WHOLE) {
                let marks: Vec<bool> = shares.iter().map(|share| *share > 0.5).collect();
                let broken = (self.task.broken)(&marks);
                if !broken.is_empty() {
                    self.grow(broken);
                    continue;
                }
                self.offer(marks);
                if self.closed(node.bound) {
                    return None;
                }
            } else if self.nodes % ROUNDING == 1 {
                for way in 0..2 {
                    let set = round::rounded(&self.program, &self.index, &shares, way);
                    self.offer_if_whole(set);
                }
                if self.closed(node.bound) {
                    return None;
                }
            }
            break;
        }
        let free = |it: &usize| self.program.choices[*it] == Choice::Free;
        if !(0..self.roots.len()).any(|it| free(&it)) {
            // All is fixed: the set is what it is.
            let marks: Vec<bool> =
                self.program.choices.iter().map(|it| *it == Choice::Always).collect();
            self.offer_if_whole(marks);
            return None;
        }
        if shares.is_empty() {
            return (0..self.roots.len()).find(free).map(|choice| (choice, 0.0));
        }
        Some(self.choose(&shares))
    }

    /// Lowers the node's bound by the prices at hand, fixes by reduced costs; true if it is closed.
    fn bound(&mut self, node: &mut Node) -> bool {
        let prices = self.prices();
        let found = priced(&self.program, &prices);
        self.work += 4 * self.terms;
        node.bound = node.bound.min(found.bound);
        if self.closed(node.bound) {
            return true;
        }
        for choice in 0..self.roots.len() {
            if self.program.choices[choice] == Choice::Free
                && let Some(taken) = found.fixed(choice, self.value)
            {
                self.fix(choice, taken);
                node.fixes.push((choice, taken));
            }
        }
        false
    }

    fn prices(&self) -> Prices {
        let mut rows = vec![0.0; self.program.rows.len()];
        let mut slopes = vec![0.0; self.program.cells.len()];
        for (line, kind) in self.lines.iter().enumerate() {
            let price = self.relaxation.price(line);
            match *kind {
                Line::Row(row, size) => rows[row] += price * self.unit / size,
                Line::Tangent(cell, slope) => {
                    slopes[cell] += price * self.unit / self.ranges[cell] * slope;
                }
            }
        }
        Prices::new(&self.program, rows.into_iter(), slopes.into_iter())
    }

    fn is_impossible(&self, ray: &[f64]) -> bool {
        let mut rows = vec![0.0; self.program.rows.len()];
        for (kind, multiplier) in self.lines.iter().zip(ray) {
            if let Line::Row(row, size) = *kind {
                rows[row] += multiplier / size;
            }
        }
        // Scaled so that the integers resolve it.
        let largest = rows.iter().copied().fold(0.0, f64::max);
        let scaled = rows.into_iter().map(|it| it / largest.max(1e-300) * UNIT);
        let prices = Prices::new(&self.program, scaled, std::iter::empty());
        impossible(&self.program, &prices.rows)
    }

    fn shares(&self) -> Vec<f64> {
        (0..self.roots.len()).map(|it| self.relaxation.share(it).clamp(0.0, 1.0)).collect()
    }

    /// Adds rows and tangents that the shares break; false where there are none.
    fn add_broken(&mut self, shares: &[f64]) -> bool {
        let mut broken: Vec<(f64, usize)> = Vec::new();
        for (index, row) in self.program.rows.iter().enumerate() {
            if self.present[index] {
                continue;
            }
            let used: f64 = row.terms.iter().map(|it| shares[it.0] * f64_from_i64(it.1)).sum();
            let by = (used - f64_from_i64(row.limit)) / size(row);
            if by > BROKEN {
                broken.push((by, index));
            }
        }
        broken.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        broken.truncate(AT_ONCE);
        for &(_, index) in &broken {
            self.enter(index);
        }
        let mut found = !broken.is_empty();
        for cell in 0..self.program.cells.len() {
            let it = &self.program.cells[cell];
            let sum = f64_from_i64(it.base)
                + it.terms.iter().map(|it| shares[it.0] * f64_from_i64(it.1)).sum::<f64>();
            if let Gain::Log { scale, offset } = it.gain {
                let ln = |sum: f64| (sum / f64_from_i64(offset)).ln_1p();
                let worth = f64_from_i64(scale) * (ln(sum) - ln(f64_from_i64(it.base)));
                let range = self.ranges[cell];
                let claimed = self.relaxation.share(self.roots.len() + cell) * range;
                if claimed > worth + 1e-7 * range && self.lines.len() < 4_000 {
                    self.tangent(cell, sum);
                    found = true;
                }
            }
        }
        found
    }

    /// Puts a row into the relaxation.
    fn enter(&mut self, index: usize) {
        let row = &self.program.rows[index];
        let size = size(row);
        let terms = row.terms.iter().map(|it| (it.0, f64_from_i64(it.1) / size)).collect();
        self.relaxation.add(terms, f64_from_i64(row.limit) / size);
        self.lines.push(Line::Row(index, size));
        self.present[index] = true;
    }

    /// Puts the tangent of a cell's gain at a sum into the relaxation.
    fn tangent(&mut self, cell: usize, sum: f64) {
        let (it, range) = (&self.program.cells[cell], self.ranges[cell]);
        let slope = it.gain.slope(sum);
        let base = f64_from_i64(it.base);
        let worth = match it.gain {
            Gain::Shortfall { price, wanted } => {
                f64_from_i64(price)
                    * (sum.min(f64_from_i64(wanted)) - base.min(f64_from_i64(wanted)))
            }
            Gain::Log { scale, offset } => {
                let ln = |sum: f64| (sum / f64_from_i64(offset)).ln_1p();
                f64_from_i64(scale) * (ln(sum) - ln(base))
            }
        };
        let column = self.program.values.len() + cell;
        let mut terms: Vec<(usize, f64)> =
            it.terms.iter().map(|it| (it.0, -slope * f64_from_i64(it.1) / range)).collect();
        terms.push((column, 1.0));
        self.relaxation.add(terms, (worth + slope * (base - sum)) / range);
        self.lines.push(Line::Tangent(cell, slope));
    }

    /// Adds rows to the programme and to the relaxation.
    fn grow(&mut self, rows: Vec<Row>) {
        let first = self.program.rows.len();
        self.program.rows.extend(rows);
        self.present.resize(self.program.rows.len(), false);
        for index in first..self.program.rows.len() {
            self.enter(index);
        }
        self.index = Index::new(&self.program);
    }

    fn offer_if_whole(&mut self, marks: Vec<bool>) {
        if (self.task.broken)(&marks).is_empty() {
            self.offer(marks);
        }
    }

    /// Keeps a set that meets all rows and is better.
    fn offer(&mut self, marks: Vec<bool>) {
        let state = State::of(&self.program, &self.index, &marks);
        let chosen = marks.iter().zip(&self.roots).all(|(&mark, root)| match root {
            Choice::Free => true,
            Choice::Always => mark,
            Choice::Never => !mark,
        });
        if chosen && state.value() > self.value && state.broken_rows().next().is_none() {
            self.value = state.value();
            self.best = Some((marks, self.value));
        }
    }
}

/// What a row is divided by.
fn size(row: &Row) -> f64 {
    row.terms.iter().map(|it| f64_from_i64(it.1.abs())).fold(1.0, f64::max)
}

/// A number that divides the worth of every set.
pub(super) fn step(program: &Program) -> i128 {
    let gains = program.cells.iter().map(|cell| match cell.gain {
        Gain::Shortfall { price, .. } => price,
        Gain::Log { .. } => 1,
    });
    let all = program.values.iter().copied().chain(gains);
    let step = all.fold(0_i64, |mut a, b| {
        let mut b = b.abs();
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a
    });
    i128::from(step.max(1))
}
