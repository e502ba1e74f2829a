//! Moves the multipliers of a split so that its bound falls: subgradient methods.
//!
//! The bound is convex in amounts and prices, and where cells disagree about a session, or starts
//! about a window, is a subgradient.
//!
//! Method: first resilient steps, one per multiplier, each of which grows while the sign stays and halves
//! when it turns (Riedmiller and Braun 1993, Rprop), for the windows that the relaxation prices, which
//! falls fast and then stalls; then the volume algorithm (Barahona and Anbil 2000) with all windows: from
//! the best point along a running mean of the subgradients, as far as a share of the bound over the
//! mean's square.
//!
//! Limits: neither reaches the least bound; LiteBIRD's three years end some 0.003 % above what four
//! times the rounds give.

use super::split::{Best, Split};
use crate::program::number::{f64_from_i64, f64_from_i128, i64_from_f64, i64_from_usize};
use crate::schedule::instants::window_starts;
use crate::schedule::price::Ladder;
use std::collections::BTreeMap;

/// Rounds with a step per multiplier.
const QUICK: usize = 20;
/// First step of an amount, and of a window's price, over the mean value of a relaxed session.
const FIRST_STEP: (f64, f64) = (0.12, 0.012);
/// A step grows by this factor while its sign stays, and shrinks by the other when it turns.
const STEP_FACTORS: (f64, f64) = (1.3, 0.5);
/// Weight of the newest subgradient in the mean.
const NEWEST: f64 = 0.05;
/// The bound hopes to fall by this share of itself, times a factor: at first, how it grows where the
/// newest subgradient agrees with the mean, and shrinks after so many rounds without progress.
const HOPE: f64 = 0.003;
const FACTOR: (f64, f64, f64) = (0.5, 1.1, 0.66);
const PATIENCE: usize = 5;

/// The state of the descent.
#[derive(Debug)]
pub(super) struct Descent {
    round: usize,
    quick: Quick,
    volume: Option<Volume>,
}

impl Descent {
    /// A descent from a split; `scale` is the typical value of a session in units.
    pub(super) fn new(split: &Split<'_>, scale: f64) -> Self {
        Self { round: 0, quick: Quick::new(split, scale), volume: None }
    }

    /// Moves on from a point whose bound and best sets are known, and marks the cells that change.
    pub(super) fn step(
        &mut self,
        split: &mut Split<'_>,
        bests: &[Best],
        bound: i128,
        changed: &mut [bool],
    ) {
        self.round += 1;
        let slopes = Slopes::new(split, bests);
        if self.round <= QUICK {
            self.quick.step(split, &slopes, changed);
        } else {
            let volume = self.volume.get_or_insert_with(|| Volume::new(split));
            volume.step(split, &slopes, f64_from_i128(bound), changed);
        }
        split.settle(changed);
    }
}

/// Where the cells disagree.
#[derive(Debug)]
struct Slopes {
    /// Per part: 1 where its cell alone takes the session, -1 where only the cell of the start does.
    parts: Vec<i8>,
    /// Starts of the sessions taken where they start, ascending.
    starts: Vec<i64>,
}

impl Slopes {
    fn new(split: &Split<'_>, bests: &[Best]) -> Self {
        let mut taken = vec![false; split.parts.len()];
        for (cell, best) in bests.iter().enumerate() {
            for &id in &best.ids {
                let parts = split.first[id]..split.first[id + 1];
                for part in parts.filter(|&part| split.parts[part].cell == cell) {
                    taken[part] = true;
                }
            }
        }
        let mut slopes = Self { parts: vec![0; split.parts.len()], starts: Vec::new() };
        for (id, session) in split.model.sessions.iter().enumerate() {
            let start = split.first[id];
            if taken[start] {
                slopes.starts.push(session.start);
            }
            for part in start + 1..split.first[id + 1] {
                slopes.parts[part] = i8::from(taken[part]) - i8::from(taken[start]);
            }
        }
        slopes
    }

    /// Starts beyond the limit in the window from an instant.
    fn over(&self, at: i64, (count, window): (usize, i64)) -> i64 {
        let until = at.saturating_add(window);
        let inside = self.starts.partition_point(|start| *start < until)
            - self.starts.partition_point(|start| *start < at);
        i64_from_usize(inside) - i64_from_usize(count)
    }
}

/// How one multiplier is moved.
#[derive(Debug, Clone, Copy)]
struct Step {
    size: f64,
    /// Sign of the move before, 0 at first.
    sign: f64,
}

impl Step {
    /// The move along a slope that is not zero.
    fn along(&mut self, slope: f64) -> f64 {
        let sign = slope.signum();
        if self.sign * sign > 0.0 {
            self.size *= STEP_FACTORS.0;
        } else if self.sign * sign < 0.0 {
            self.size *= STEP_FACTORS.1;
        }
        self.sign = sign;
        self.size * slope
    }
}

/// Resilient steps, one per multiplier.
#[derive(Debug)]
struct Quick {
    /// Per part; that of a session's first part is not used.
    parts: Vec<Step>,
    /// First instant, price and step of each priced window.
    windows: Vec<(i64, f64, Step)>,
    /// Largest step of a window whose price is zero.
    idle: f64,
}

impl Quick {
    fn new(split: &Split<'_>, scale: f64) -> Self {
        let idle = FIRST_STEP.1 * scale;
        let part = Step { size: FIRST_STEP.0 * scale, sign: 0.0 };
        let windows = split.prices.windows.points();
        Self {
            parts: vec![part; split.parts.len()],
            windows: windows
                .map(|(at, price)| (at, f64_from_i64(price), Step { size: idle, sign: 0.0 }))
                .collect(),
            idle,
        }
    }

    fn step(&mut self, split: &mut Split<'_>, slopes: &Slopes, changed: &mut [bool]) {
        for (part, slope) in slopes.parts.iter().enumerate().filter(|it| *it.1 != 0) {
            let moved = i64_from_f64(self.parts[part].along(-f64::from(*slope)));
            split.parts[part].earns += moved;
            changed[split.parts[part].cell] = true;
        }
        let Some(limit) = split.model.count else { return };
        for (at, price, step) in &mut self.windows {
            let over = slopes.over(*at, limit);
            if over > 0 || (over < 0 && *price > 0.0) {
                *price = (*price + step.along(f64_from_i64(over))).max(0.0);
            }
            if *price <= 0.0 {
                step.size = step.size.min(self.idle);
            }
        }
        split.prices.windows = Ladder::new(self.windows.iter().map(|it| (it.0, it.1)));
    }
}

/// One multiplier of the volume algorithm.
#[derive(Debug, Clone, Copy, Default)]
struct Moved {
    /// Now.
    now: f64,
    /// Where the bound was least.
    best: f64,
    /// Mean slope.
    mean: f64,
}

impl Moved {
    const fn at(number: f64) -> Self {
        Self { now: number, best: number, mean: 0.0 }
    }
}

/// The volume algorithm.
#[derive(Debug)]
struct Volume {
    parts: Vec<Moved>,
    windows: Vec<(i64, Moved)>,
    /// The least bound.
    bound: f64,
    factor: f64,
    /// Rounds since the bound fell.
    idle: usize,
    /// Weight of the next subgradient.
    weight: f64,
}

impl Volume {
    fn new(split: &Split<'_>) -> Self {
        let model = split.model;
        let ids: Vec<usize> = (0..model.sessions.len()).collect();
        let mut prices: BTreeMap<i64, i64> =
            window_starts(model, &ids).into_iter().map(|at| (at, 0)).collect();
        prices.extend(split.prices.windows.points());
        let windows = prices.into_iter().map(|(at, price)| (at, Moved::at(f64_from_i64(price))));
        Self {
            parts: split.parts.iter().map(|part| Moved::at(f64_from_i64(part.earns))).collect(),
            windows: windows.collect(),
            bound: f64::INFINITY,
            factor: FACTOR.0,
            idle: 0,
            weight: 1.0,
        }
    }

    fn step(&mut self, split: &mut Split<'_>, slopes: &Slopes, bound: f64, changed: &mut [bool]) {
        let agrees = self.observe(split, slopes);
        self.weight = NEWEST;
        if bound < self.bound {
            self.bound = bound;
            self.idle = 0;
            for it in self.parts.iter_mut().chain(self.windows.iter_mut().map(|it| &mut it.1)) {
                it.best = it.now;
            }
            if agrees > 0.0 {
                self.factor = (self.factor * FACTOR.1).min(2.0);
            }
        } else {
            self.idle += 1;
            if self.idle.is_multiple_of(PATIENCE) {
                self.factor *= FACTOR.2;
            }
        }
        // A price at zero that would fall further does not move.
        let moves = |it: &&Moved| it.mean < 0.0 || it.best > 0.0;
        let square = self.parts.iter().map(|it| it.mean * it.mean).sum::<f64>()
            + self
                .windows
                .iter()
                .map(|it| &it.1)
                .filter(moves)
                .map(|it| it.mean * it.mean)
                .sum::<f64>();
        let step = self.factor * HOPE * self.bound / square.max(1e-9);
        for (it, part) in self.parts.iter_mut().zip(&mut split.parts) {
            it.now = it.best - step * it.mean;
            let earns = i64_from_f64(it.now);
            // Slopes of first parts stay zero: what they earn is settled afterwards.
            if it.mean != 0.0 && earns != part.earns {
                part.earns = earns;
                changed[part.cell] = true;
            }
        }
        for (_, it) in &mut self.windows {
            it.now = (it.best - step * it.mean).max(0.0);
        }
        split.prices.windows = Ladder::new(self.windows.iter().map(|it| (it.0, it.1.now)));
    }

    /// Takes slopes into the mean; the product of both, from before.
    fn observe(&mut self, split: &Split<'_>, slopes: &Slopes) -> f64 {
        let weight = self.weight;
        let mut agrees = 0.0;
        let mut observe = |it: &mut Moved, slope: f64| {
            agrees += it.mean * slope;
            it.mean += weight * (slope - it.mean);
        };
        for (it, &slope) in self.parts.iter_mut().zip(&slopes.parts) {
            observe(it, f64::from(slope));
        }
        if let Some(limit) = split.model.count {
            for (at, it) in &mut self.windows {
                observe(it, -f64_from_i64(slopes.over(*at, limit)));
            }
        }
        agrees
    }
}
