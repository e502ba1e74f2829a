//! Branch and bound over the choices that are left.
//!
//! Method: each node fixes some choices. Its relaxation is solved by the dual simplex method from the
//! basis of the node before (`node_relaxation.rs`). From its dual prices follows a bound in integers
//! (`bound.rs`), which decides whether the node is pruned, and which further choices have one value in
//! every better set. The choice to branch on comes from pseudo-costs (`pseudo_cost.rs`). The search dives
//! until a node is pruned, then goes on at the node of largest bound. A bound is rounded down to a
//! multiple of what divides all values where it decides on pruning, not where it orders the nodes: tied
//! values would make them all alike. After [`ALONE`] nodes, [`TEAM`] searchers share the nodes and the
//! best value every [`TURN`] nodes, whatever the number of threads.
//!
//! Limits: a count of nodes. Nodes cut short leave their bound in the result.

use super::bound::priced;
use super::cover;
use super::gain::Gain;
use super::node_relaxation::NodeRelaxation;
use super::number::{f64_from_i128, u64_from_usize};
use super::outcome::Ended;
use super::problem::{Choice, Program, Row};
use super::pseudo_cost::{PseudoCosts, WHOLE};
use super::round;
use super::simplex::Status;
use super::state::{Index, State};
use super::waiting::{Node, Waiting};
use crate::progress::Progress;
use rayon::prelude::*;
use std::cmp::Reverse;

/// Most rounds of rows in one node.
const ROUNDS: usize = 60;
/// Most rounds of cover cuts at the first node.
const CUT_ROUNDS: usize = 6;
/// Most pivots of one relaxation.
const PIVOTS: usize = 20_000;
/// Nodes between two attempts at rounding.
const ROUNDING: usize = 3;
/// Nodes between two questions whether to stop.
const ASKING: usize = 16;
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
    /// Rows that a set violates beside the programme's.
    pub(super) broken: &'a (dyn Fn(&[bool]) -> Vec<Row> + Sync),
    /// Told the nodes that are done, and asked whether to stop.
    pub(super) progress: &'a dyn Progress,
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

/// Searches a programme whose free choices are all of it.
pub(super) fn search(program: Program, task: &Task<'_>) -> Found {
    Search::new(program, task).run()
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

struct Search<'t> {
    program: Program,
    task: &'t Task<'t>,
    roots: Vec<Choice>,
    index: Index,
    relaxation: NodeRelaxation,
    best: Option<(Vec<bool>, i128)>,
    value: i128,
    /// Largest bound among nodes closed above the best value.
    left: i128,
    pseudo_costs: PseudoCosts,
    nodes: usize,
    /// Every set's worth is a multiple.
    step: i128,
    /// Numbers touched beside the relaxation's.
    work: usize,
    /// Coefficients of the programme.
    terms: usize,
    waiting: Waiting,
}

impl<'t> Search<'t> {
    fn new(program: Program, task: &'t Task<'t>) -> Self {
        Self {
            task,
            roots: program.choices.clone(),
            index: Index::new(&program),
            relaxation: NodeRelaxation::new(&program),
            best: None,
            value: task.cutoff,
            left: task.cutoff,
            pseudo_costs: PseudoCosts::new(program.values.len()),
            nodes: 0,
            step: step(&program),
            work: 0,
            waiting: Waiting::default(),
            terms: program.rows.iter().map(|row| row.terms.len()).sum(),
            program,
        }
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
            let stop = self.nodes.is_multiple_of(ASKING) && self.task.progress.stopped();
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
        let task = self.task;
        let mut team = vec![self];
        let mut told = 0;
        while ended == Ended::Work {
            let nodes: usize = team.iter().map(|it| it.nodes).sum();
            let work: usize = team.iter().map(Search::work).sum();
            task.progress.advance(u64_from_usize(nodes - told));
            told = nodes;
            if nodes >= task.nodes || work >= task.work {
                break;
            }
            if team.len() == 1 {
                team = (0..TEAM).map(|member| team[0].member(member)).collect();
            }
            share_out(&mut team);
            let share = TURN.min(task.nodes.saturating_sub(nodes) / TEAM + 1);
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
            best: self.best.clone(),
            pseudo_costs: self.pseudo_costs.clone(),
            waiting: Waiting::default(),
            ..*self
        };
        if number == 0 {
            member.waiting = self.waiting.clone();
        } else {
            member.nodes = 0;
            member.work = 0;
            member.relaxation.simplex.touched = 0;
        }
        member
    }

    /// Numbers touched so far.
    fn work(&self) -> usize {
        self.work + self.relaxation.simplex.touched
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

    fn set(&mut self, choice: usize, open: Choice) {
        self.program.choices[choice] = open;
        self.relaxation.bind(choice, open);
    }

    fn fix(&mut self, choice: usize, taken: bool) {
        self.set(choice, if taken { Choice::Always } else { Choice::Never });
    }

    fn apply(&mut self, node: &Node) {
        for choice in 0..self.roots.len() {
            self.set(choice, self.roots[choice]);
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
            let cutoff = (f64_from_i128(self.value)) / self.relaxation.unit;
            let cutoff = cutoff - 1e-9 * cutoff.abs() - 1e-12;
            let mut status = self.relaxation.simplex.solve(cutoff, PIVOTS);
            if status == Status::CutOff {
                if self.bound(node) {
                    return None;
                }
                status = self.relaxation.simplex.solve(f64::NEG_INFINITY, PIVOTS);
            }
            if let Status::Impossible(row) = status {
                if self.relaxation.is_impossible(&self.program, row) {
                    return None;
                }
                break;
            }
            if self.bound(node) {
                return None;
            }
            shares = self.relaxation.shares(self.roots.len());
            if self.relaxation.add_broken(&self.program, &shares) {
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
            // Whole shares may violate rows of families.
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
        let cutoff = f64_from_i128(self.value) / self.relaxation.unit;
        let (choices, simplex) = (&self.program.choices, &mut self.relaxation.simplex);
        Some(self.pseudo_costs.choose(choices, simplex, &shares, cutoff))
    }

    /// Lowers the node's bound by the prices at hand, fixes by reduced costs; true if it is closed.
    fn bound(&mut self, node: &mut Node) -> bool {
        let prices = self.relaxation.prices(&self.program);
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

    /// Adds rows to the programme and to the relaxation.
    fn grow(&mut self, rows: Vec<Row>) {
        let first = self.program.rows.len();
        self.program.rows.extend(rows);
        self.relaxation.enter_from(&self.program, first);
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
