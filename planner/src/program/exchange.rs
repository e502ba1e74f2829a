//! Fix and optimise: parts of the programme searched exactly with the rest held, then all that is open.
//!
//! Method: of the choices whose reduced cost is small, so that relaxation and incumbent may disagree
//! about them, some [`PART`] are freed at a time: neighbours in the programme's order, in overlapping
//! stretches, [`AT_ONCE`] stretches far apart at once; then the smallest reduced costs of all. What the
//! rest leaves of every row is the part's own programme, searched by branch and bound for a set that
//! is worth more. [`Exchange::core`] searches all that reduced costs leave open, for the bound.
//!
//! Limits: counts of passes and nodes, and of numbers touched in a part.

use super::bound::Priced;
use super::branch::{Found, Task, search};
use super::incumbent::Incumbent;
use super::number::u64_from_usize;
use super::options::{Aids, Limits};
use super::outcome::Ended;
use super::problem::{Cell, Choice, Program, Row};
use super::state::{Index, State};
use crate::progress::{Progress, StopOnly};
use rayon::prelude::*;

/// Choices freed at a time.
pub(super) const PART: usize = 160;
/// Parts searched at once.
const AT_ONCE: usize = 4;
/// Most numbers touched in one part.
const PART_WORK: usize = 400_000_000;

/// What the search needs to know.
pub(super) struct Exchange<'s, 'a> {
    pub(super) program: &'s Program,
    pub(super) index: &'s Index,
    pub(super) aids: &'s Aids<'a>,
    pub(super) limits: &'s Limits,
    pub(super) priced: &'s Priced,
    pub(super) shares: &'s [f64],
}

/// A part of a programme.
struct Part {
    program: Program,
    /// The choices of the whole that it holds.
    free: Vec<usize>,
}

impl Part {
    /// The programme of some choices while the others are as held, these not taken.
    fn new(program: &Program, index: &Index, held: &State<'_>, free: Vec<usize>) -> Self {
        let mut position = vec![usize::MAX; program.values.len()];
        for (place, &choice) in free.iter().enumerate() {
            position[choice] = place;
        }
        let within = |terms: &[(usize, i64)]| -> Vec<(usize, i64)> {
            let own = terms.iter().filter(|it| position[it.0] != usize::MAX);
            own.map(|&(choice, a)| (position[choice], a)).collect()
        };
        let touched = |of: &dyn Fn(usize) -> Vec<usize>| -> Vec<usize> {
            let mut all: Vec<usize> = free.iter().flat_map(|&choice| of(choice)).collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        let rows_of = |choice: usize| index.rows[choice].iter().map(|it| it.0).collect();
        let cells_of = |choice: usize| index.cells[choice].iter().map(|it| it.0).collect();
        let rows = touched(&rows_of).into_iter().filter_map(|row| {
            let terms = within(&program.rows[row].terms);
            let left = i128::from(program.rows[row].limit) - held.used(row);
            let most: i128 = terms.iter().map(|it| i128::from(it.1.max(0))).sum();
            (most > left).then(|| Row { terms, limit: limit(left) })
        });
        let cells = touched(&cells_of).into_iter().map(|cell| Cell {
            terms: within(&program.cells[cell].terms),
            gain: program.cells[cell].gain,
            base: held.sum(cell),
        });
        let part = Program {
            values: free.iter().map(|&choice| program.values[choice]).collect(),
            choices: free.iter().map(|&choice| program.choices[choice]).collect(),
            rows: rows.collect(),
            cells: cells.collect(),
        };
        Self { program: part, free }
    }
}

/// What is left of a row, as a limit.
fn limit(left: i128) -> i64 {
    i64::try_from(left).unwrap_or(if left < 0 { i64::MIN } else { i64::MAX })
}

impl Exchange<'_, '_> {
    /// Rows that a number of free choices will touch, roughly.
    pub(super) fn rows_touched(&self, free: usize) -> usize {
        self.program.rows.len().min(free * 2)
    }

    /// Improves the incumbent by parts.
    pub(super) fn improve(&self, best: &mut Incumbent) {
        let Some((set, value)) = best else { return };
        let passes = self.limits.passes;
        for pass in 0..passes {
            let before = *value;
            let open = self.open(set, *value);
            let stride = PART / 2;
            let first = if pass % 2 == 0 { 0 } else { stride / 2 };
            let mut parts: Vec<Vec<usize>> = (first..open.len())
                .step_by(stride)
                .map(|from| open[from..(from + PART).min(open.len())].to_vec())
                .collect();
            let mut order = open;
            order.sort_by_key(|&choice| (self.priced.reduced[choice].abs(), choice));
            // Parts far apart at once, so that they seldom meet.
            let apart = parts.len().div_ceil(AT_ONCE);
            let batches = (0..apart).map(|at| {
                parts.iter_mut().skip(at).step_by(apart.max(1)).map(std::mem::take).collect()
            });
            let batches: Vec<Vec<Vec<usize>>> = batches.collect();
            let least = order.chunks(PART).take(4).map(|part| {
                let mut part = part.to_vec();
                part.sort_unstable();
                vec![part]
            });
            let batches: Vec<Vec<Vec<usize>>> = batches.into_iter().chain(least).collect();
            self.aids.progress.begin("exchanges", u64_from_usize(batches.len()));
            for batch in batches {
                if self.aids.progress.stopped() {
                    return;
                }
                self.parts(set, value, batch);
                self.aids.progress.advance(1);
            }
            if *value - before <= (*value).abs() >> 17 {
                break;
            }
        }
    }

    /// The choices whose value a better set may change cheaply, in order.
    fn open(&self, set: &[bool], value: i128) -> Vec<usize> {
        let fixed = |choice: &usize| {
            let known = self.priced.fixed(*choice, value);
            self.program.choices[*choice] == Choice::Free && known != Some(set[*choice])
        };
        let mut open: Vec<usize> = (0..set.len()).filter(fixed).collect();
        // The doubtful ones, and as many again as are taken or shared.
        let taken = set.iter().filter(|it| **it).count();
        let most = (6 * taken).max(4 * PART);
        if open.len() > most {
            open.sort_by_key(|&choice| {
                let doubt = self.shares[choice] > 1e-4 || set[choice];
                (!doubt, self.priced.reduced[choice].abs(), choice)
            });
            open.truncate(most);
            open.sort_unstable();
        }
        open
    }

    /// Searches parts at once, each with the rest held, and takes over in turn what is better and
    /// still fits.
    fn parts(&self, set: &mut Vec<bool>, value: &mut i128, parts: Vec<Vec<usize>>) {
        let state = State::of(self.program, self.index, set);
        let found: Vec<(Vec<usize>, Option<Vec<bool>>)> = parts
            .into_par_iter()
            .map(|free| {
                let mut held = state.clone();
                for &choice in &free {
                    held.set(choice, false);
                }
                let cutoff = state.value() - held.value();
                let part = Part::new(self.program, self.index, &held, free);
                let work = (self.limits.exchange_nodes, PART_WORK);
                // Parts run side by side: only the batch is told.
                let quiet = StopOnly(self.aids.progress);
                let best = self.run(&part, set, (cutoff, &quiet), work).best;
                (part.free, best.map(|it| it.0))
            })
            .collect();
        let mut state = state;
        for (free, marks) in found {
            let Some(marks) = marks else { continue };
            let mut next = state.clone();
            for (&choice, &mark) in free.iter().zip(&marks) {
                next.set(choice, mark);
            }
            if next.value() <= *value || next.broken_rows().next().is_some() {
                continue;
            }
            let whole = next.clone().marks();
            if self.aids.families.iter().all(|family| family.broken(&whole).is_empty()) {
                *value = next.value();
                *set = whole;
                state = next;
            }
        }
    }

    /// Branch and bound over a part, with the families of the whole.
    fn run(
        &self,
        part: &Part,
        set: &[bool],
        (cutoff, progress): (i128, &dyn Progress),
        (nodes, work): (usize, usize),
    ) -> Found {
        let broken = |marks: &[bool]| -> Vec<Row> {
            if self.aids.families.is_empty() {
                return Vec::new();
            }
            let mut whole = set.to_vec();
            for (&choice, &mark) in part.free.iter().zip(marks) {
                whole[choice] = mark;
            }
            let mut position = vec![usize::MAX; set.len()];
            for (place, &choice) in part.free.iter().enumerate() {
                position[choice] = place;
            }
            let rows = self.aids.families.iter().flat_map(|family| family.broken(&whole));
            rows.map(|row| {
                let mut left = i128::from(row.limit);
                let mut terms = Vec::new();
                for (choice, a) in row.terms {
                    if position[choice] != usize::MAX {
                        terms.push((position[choice], a));
                    } else if set[choice] {
                        left -= i128::from(a);
                    }
                }
                Row { terms, limit: limit(left) }
            })
            .collect()
        };
        let task = Task { cutoff, nodes, work, broken: &broken, progress };
        search(part.program.clone(), &task)
    }

    /// Searches all that is not fixed: the bound on all sets, nodes, and why it ended.
    pub(super) fn core(
        &self,
        best: &mut Incumbent,
        fixes: &[Option<bool>],
    ) -> (i128, usize, Ended) {
        let mut set: Vec<bool> = fixes.iter().map(|fix| fix.unwrap_or(false)).collect();
        for (mark, choice) in set.iter_mut().zip(&self.program.choices) {
            match choice {
                Choice::Free => {}
                Choice::Always => *mark = true,
                Choice::Never => *mark = false,
            }
        }
        let free: Vec<usize> = (0..set.len())
            .filter(|&choice| {
                fixes[choice].is_none() && self.program.choices[choice] == Choice::Free
            })
            .collect();
        let state = State::of(self.program, self.index, &set);
        let held = state.value();
        // Rows without free choices that the fixed ones violate: no better set exists.
        let nothing = |row: usize| {
            self.program.rows[row]
                .terms
                .iter()
                .all(|it| fixes[it.0].is_some() || self.program.choices[it.0] != Choice::Free)
        };
        let known = best.as_ref().map_or(i128::MIN / 2, |(_, value)| *value);
        if state.broken_rows().any(nothing) {
            return (known, 0, Ended::Proven);
        }
        let part = Part::new(self.program, self.index, &state, free);
        let progress = self.aids.progress;
        progress.begin("branch and bound", u64_from_usize(self.limits.nodes));
        let work = (self.limits.nodes, self.limits.work);
        let found = self.run(&part, &set, (known - held, progress), work);
        if let Some((marks, value)) = found.best {
            for (&choice, mark) in part.free.iter().zip(marks) {
                set[choice] = mark;
            }
            *best = Some((set, held + value));
        }
        (found.bound + held, found.nodes, found.ended)
    }
}
