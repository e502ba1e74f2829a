//! Which choice a node is branched on: pseudo-costs, initialised by strong branching.
//!
//! Method: both sides of a fractional choice lose some of the bound. The loss per share is learnt by
//! trial solves with few pivots at first (strong branching), then taken from experience
//! (pseudo-costs); the choice whose two losses have the largest product is branched on.
//!
//! Limits: [`TRIALS`] choices and pivots at a node, [`EXPERIENCE`] trials of each choice and side.

use super::problem::Choice;
use super::simplex::{Simplex, Status};

/// Shares this close to a whole number are whole.
pub(super) const WHOLE: f64 = 1e-6;
/// Choices tried before one is branched on, and pivots for each.
const TRIALS: (usize, usize) = (8, 40);
/// Trials after which experience counts.
const EXPERIENCE: u32 = 2;

/// Experience of one choice: losses per share, and their number, down and up.
#[derive(Debug, Clone, Copy, Default)]
struct Experience {
    lost: [f64; 2],
    count: [u32; 2],
}

/// What branching on each choice cost so far.
#[derive(Debug, Clone)]
pub(super) struct PseudoCosts {
    of: Vec<Experience>,
}

impl PseudoCosts {
    /// Of so many choices, none tried.
    pub(super) fn new(count: usize) -> Self {
        Self { of: vec![Experience::default(); count] }
    }

    /// The choice to branch on, and its share; sides that fall to `cutoff` lose all above it.
    pub(super) fn choose(
        &mut self,
        choices: &[Choice],
        simplex: &mut Simplex,
        shares: &[f64],
        cutoff: f64,
    ) -> (usize, f64) {
        let mut open: Vec<usize> = (0..shares.len())
            .filter(|&it| {
                choices[it] == Choice::Free && (shares[it] - shares[it].round()).abs() >= WHOLE
            })
            .collect();
        if open.is_empty() {
            let free = (0..shares.len()).find(|&it| choices[it] == Choice::Free);
            let choice = free.unwrap_or(0);
            return (choice, shares[choice]);
        }
        let before = simplex.objective();
        let halves = |it: usize| (shares[it] - 0.5).abs();
        open.sort_by(|&a, &b| halves(a).total_cmp(&halves(b)).then(a.cmp(&b)));
        let new: Vec<usize> = open
            .iter()
            .copied()
            .filter(|&it| self.of[it].count.iter().any(|&count| count < EXPERIENCE))
            .take(TRIALS.0)
            .collect();
        for choice in new {
            for side in 0..2_u8 {
                let after = tried(simplex, choice, f64::from(side), cutoff);
                let moved = (f64::from(side) - shares[choice]).abs();
                let experience = &mut self.of[choice];
                experience.lost[usize::from(side)] += (before - after).max(0.0) / moved;
                experience.count[usize::from(side)] += 1;
            }
        }
        let choice = self.best(&open, shares).unwrap_or(open[0]);
        (choice, shares[choice])
    }

    /// The choice with the largest product of losses; the first of equals.
    fn best(&self, open: &[usize], shares: &[f64]) -> Option<usize> {
        let mean = |side: usize| {
            let (mut lost, mut count) = (0.0, 0.0);
            for it in &self.of {
                lost += it.lost[side];
                count += f64::from(it.count[side]);
            }
            if count > 0.0 { lost / count } else { 1.0 }
        };
        let means = [mean(0), mean(1)];
        let score = |it: usize| {
            let side = |side: usize| {
                let of = &self.of[it];
                let count = of.count[side];
                if count > 0 { of.lost[side] / f64::from(count) } else { means[side] }
            };
            (side(0) * shares[it]).max(1e-9) * (side(1) * (1.0 - shares[it])).max(1e-9)
        };
        open.iter().copied().max_by(|&a, &b| score(a).total_cmp(&score(b)).then_with(|| b.cmp(&a)))
    }
}

/// The objective with a choice fixed, after a few pivots.
fn tried(simplex: &mut Simplex, choice: usize, value: f64, cutoff: f64) -> f64 {
    let (lower, upper) = (simplex.lower[choice], simplex.upper[choice]);
    simplex.lower[choice] = value;
    simplex.upper[choice] = value;
    let after = match simplex.solve(cutoff, TRIALS.1) {
        Status::Impossible(_) | Status::CutOff => cutoff,
        Status::Solved | Status::Stuck => simplex.objective(),
    };
    simplex.lower[choice] = lower;
    simplex.upper[choice] = upper;
    after
}
