//! Which choice a node is branched on.
//!
//! Method: the one whose both sides lose most of the bound, judged by trial at first, then by
//! experience (pseudo-costs).

use super::Choice;
use super::branch::{Search, WHOLE};
use super::number::f64_from_i128;
use super::simplex::Status;

/// Choices tried before one is branched on, and pivots for each.
const TRIALS: (usize, usize) = (8, 40);
/// Trials after which experience counts.
const EXPERIENCE: u32 = 2;

/// Experience of one choice: losses per share, and their number, down and up.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Experience {
    lost: [f64; 2],
    count: [u32; 2],
}

impl Search<'_> {
    /// The choice to branch on, and its share.
    pub(super) fn choose(&mut self, shares: &[f64]) -> (usize, f64) {
        let mut open: Vec<usize> = (0..shares.len())
            .filter(|&it| {
                self.program.choices[it] == Choice::Free
                    && (shares[it] - shares[it].round()).abs() >= WHOLE
            })
            .collect();
        if open.is_empty() {
            let free = (0..shares.len()).find(|&it| self.program.choices[it] == Choice::Free);
            let choice = free.unwrap_or(0);
            return (choice, shares[choice]);
        }
        let before = self.relaxation.objective();
        let halves = |it: usize| (shares[it] - 0.5).abs();
        open.sort_by(|&a, &b| halves(a).total_cmp(&halves(b)).then(a.cmp(&b)));
        let new: Vec<usize> = open
            .iter()
            .copied()
            .filter(|&it| self.experience[it].count.iter().any(|&count| count < EXPERIENCE))
            .take(TRIALS.0)
            .collect();
        let cutoff = f64_from_i128(self.value) / self.unit;
        for choice in new {
            for side in 0..2_u8 {
                let bound = f64::from(side);
                let (lower, upper) = (self.relaxation.lower[choice], self.relaxation.upper[choice]);
                self.relaxation.lower[choice] = bound;
                self.relaxation.upper[choice] = bound;
                let status = self.relaxation.solve(cutoff, TRIALS.1);
                let after = match status {
                    Status::Impossible(_) | Status::CutOff => cutoff,
                    Status::Solved | Status::Stuck => self.relaxation.objective(),
                };
                self.relaxation.lower[choice] = lower;
                self.relaxation.upper[choice] = upper;
                let moved = (bound - shares[choice]).abs();
                let side = usize::from(side);
                let experience = &mut self.experience[choice];
                experience.lost[side] += (before - after).max(0.0) / moved;
                experience.count[side] += 1;
            }
        }
        let mean = |side: usize| {
            let (mut lost, mut count) = (0.0, 0.0);
            for it in &self.experience {
                lost += it.lost[side];
                count += f64::from(it.count[side]);
            }
            if count > 0.0 { lost / count } else { 1.0 }
        };
        let means = [mean(0), mean(1)];
        let score = |it: usize| {
            let side = |side: usize| {
                let of = &self.experience[it];
                let count = of.count[side];
                if count > 0 { of.lost[side] / f64::from(count) } else { means[side] }
            };
            (side(0) * shares[it]).max(1e-9) * (side(1) * (1.0 - shares[it])).max(1e-9)
        };
        let best = open
            .iter()
            .copied()
            .max_by(|&a, &b| score(a).total_cmp(&score(b)).then_with(|| b.cmp(&a)));
        let choice = best.unwrap_or(open[0]);
        (choice, shares[choice])
    }
}
