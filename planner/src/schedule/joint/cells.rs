//! The concave parts of the objective: logarithms of time, seasons, gaps, and the earlier plan.
//!
//! Method: seasons and gaps are cells that earn a price per session up to what is wanted, so a shortfall
//! costs its penalty: one above all other values for seasons, the given price for gaps. A logarithmic
//! objective has a cell per target, telescope, epoch and range of scan angles. An earlier plan changes
//! the values of sessions.
//!
//! Limits: a season is a fixed window, consecutive from the mission's start; gaps are charged in steps.

use super::built::{Built, Gap, Season};
use super::facts::Facts;
use crate::program::number::{f64_from_i64, i64_from_f64, i64_from_usize};
use crate::program::{Cell, Gain};
use crate::schedule::model::Model;
use crate::schedule::problem::Problem;
use crate::schedule::rule::Rule;
use onboard_core::time::Duration;
use std::collections::{BTreeMap, BTreeSet};

/// A session missing in a season costs as much as so many of the most valuable.
const SEASON_PRICE: f64 = 12.0;
/// Units of the logarithmic objective's largest cell.
pub(super) const LARGEST_CELL: f64 = 68_719_476_736.0;
const MS: i64 = 1_000_000;

/// Target, telescope, epoch and range of scan angles.
type CellKey = (usize, usize, i64, u32);

impl Built<'_> {
    /// A cell of the logarithm per target, telescope, epoch and range of scan angles.
    pub(super) fn logarithms(&mut self) {
        let (problem, model, facts) = (self.problem, self.model, self.facts);
        let Some(log) = &problem.demands.log else { return };
        let mut cells: BTreeMap<CellKey, Vec<(usize, i64)>> = BTreeMap::new();
        for (id, session) in model.sessions.iter().enumerate() {
            let epoch = epoch(problem, session.start, log.epoch);
            let (target, telescope) = facts.of[id];
            for &(bin, time) in &log.parts[session.candidate] {
                // Rounded up, so that no schedule is worth more than the programme says.
                let ms = time.ns().saturating_add(MS - 1) / MS;
                let terms = cells.entry((target, telescope, epoch, bin)).or_default();
                match terms.last_mut() {
                    Some(last) if last.0 == id => last.1 += ms,
                    _ => terms.push((id, ms)),
                }
            }
        }
        let offset = (log.offset.ns() / MS).max(1);
        for ((target, _, _, bin), terms) in cells {
            let weight = log.weight(&problem.weights, target, bin);
            let scale = i64_from_f64(self.units(weight).ceil());
            let gain = Gain::Log { scale, offset };
            self.program.cells.push(Cell { terms, gain, base: 0 });
        }
    }

    /// What staying close to the earlier plan brings, per session.
    pub(super) fn previous(&mut self) {
        let Some(previous) = &self.problem.demands.previous else { return };
        let price = i64_from_f64(self.units(previous.price).floor()).clamp(0, 1 << 44);
        // Each session of that plan pays its price unless it stands, whether or not it can.
        let before: BTreeSet<usize> = previous.sessions.iter().copied().collect();
        for (id, session) in self.model.sessions.iter().enumerate() {
            let kept = before.contains(&session.candidate);
            self.program.values[id] += if kept { price } else { -price };
        }
        self.offset += i128::from(price) * i128::from(i64_from_usize(before.len()));
    }

    /// A cell per season: each session up to what is wanted earns the penalty.
    pub(super) fn season_cells(&mut self) {
        self.seasons = seasons(self.problem, self.model, self.facts);
        let largest = self.program.values.iter().map(|it| it.abs()).max().unwrap_or(1);
        let largest = f64_from_i64(largest).max(if self.problem.demands.log.is_some() {
            4.0 * LARGEST_CELL
        } else {
            1.0
        });
        let price = i64_from_f64((SEASON_PRICE * largest).ceil());
        for season in &mut self.seasons {
            season.cell = self.program.cells.len();
            let wanted = i64_from_usize(season.wanted);
            let terms = season.sessions.iter().map(|&id| (id, 1)).collect();
            let gain = Gain::Shortfall { wanted, price };
            self.program.cells.push(Cell { terms, gain, base: 0 });
            self.offset += i128::from(price) * i128::from(wanted);
        }
    }

    /// A cell per window of the longest gap: the first session in it earns a step's price.
    pub(super) fn gap_cells(&mut self) {
        let (problem, model, facts) = (self.problem, self.model, self.facts);
        let Some(gap) = problem.demands.longest_gap else { return };
        let step = gap.step();
        self.gap_charge = gap.charge();
        let price = i64_from_f64(self.units(self.gap_charge).floor()).clamp(0, 1 << 44);
        let mut telescopes: Vec<usize> = facts.of.iter().map(|it| it.1).collect();
        telescopes.sort_unstable();
        telescopes.dedup();
        for telescope in telescopes {
            let on: Vec<usize> =
                (0..facts.of.len()).filter(|&id| facts.of[id].1 == telescope).collect();
            let mut from = problem.span.0;
            while from.plus(gap.longest) <= problem.span.1 {
                let until = from.plus(gap.longest).tai_ns();
                let start = |id: &usize| model.sessions[*id].start;
                let first = on.partition_point(|id| start(id) < from.tai_ns());
                let last = on.partition_point(|id| start(id) < until);
                if last > first {
                    let sessions = on[first..last].to_vec();
                    let terms = sessions.iter().map(|&id| (id, 1)).collect();
                    let gain = Gain::Shortfall { wanted: 1, price };
                    self.program.cells.push(Cell { terms, gain, base: 0 });
                    self.offset += i128::from(price);
                    self.gaps.push(Gap { rule: Rule::Gap { telescope, from }, sessions });
                }
                from = from.plus(step);
            }
        }
    }
}

/// Number of the epoch that holds an instant.
fn epoch(problem: &Problem, at: i64, length: Duration) -> i64 {
    at.saturating_sub(problem.span.0.tai_ns()).div_euclid(length.ns().max(1))
}

/// The seasons, with what each wants.
fn seasons(problem: &Problem, model: &Model, facts: &Facts) -> Vec<Season> {
    let Some(rule) = problem.demands.min_sessions else { return Vec::new() };
    let mission = problem.span.1.since(problem.span.0).ns();
    let length = rule.window.ns();
    let mut avoided = vec![false; problem.candidates.len()];
    for &candidate in &problem.demands.avoided {
        avoided[candidate] = true;
    }
    // Opportunities count whether or not the other rules let them stand.
    let mut offered: BTreeMap<(usize, usize, i64), usize> = BTreeMap::new();
    for (candidate, it) in problem.candidates.iter().enumerate() {
        let (start, end) = problem.reserved(candidate);
        let inside = start >= problem.span.0 && end <= problem.span.1;
        if inside && !avoided[candidate] && problem.value(candidate) > 0.0 {
            let season = epoch(problem, start.tai_ns(), rule.window);
            *offered.entry((it.target, it.telescope, season)).or_default() += 1;
        }
    }
    let mut sessions: BTreeMap<(usize, usize, i64), Vec<usize>> = BTreeMap::new();
    for (id, session) in model.sessions.iter().enumerate() {
        let season = epoch(problem, session.start, rule.window);
        let (target, telescope) = facts.of[id];
        sessions.entry((target, telescope, season)).or_default().push(id);
    }
    let seasons = offered.into_iter().filter_map(|(key, offered)| {
        let (target, telescope, season) = key;
        let rest = mission.saturating_sub(season.saturating_mul(length)).clamp(0, length);
        let share = i128::from(rule.count) * i128::from(rest) / i128::from(length.max(1));
        let wanted = usize::try_from(share).unwrap_or(usize::MAX).min(offered);
        let from = problem.span.0.plus(Duration::from_ns(season.saturating_mul(length)));
        (wanted > 0).then(|| Season {
            target,
            telescope,
            from,
            wanted,
            sessions: sessions.remove(&key).unwrap_or_default(),
            cell: usize::MAX,
        })
    });
    seasons.collect()
}
