//! How far is each rule used, and what would loosening it bring.
//!
//! Method: use and limit are read from the schedule that stands. Shadow prices are those of the
//! relaxations: by days for overlap, days and windows of starts, the programme's for further rules.
//!
//! Limits: a price holds for a small change of the relaxation; rows that families added are not listed,
//! but for scan angles, so a price of memory or thermal windows may be part of the whole.

use super::demands::Diversity;
use super::draft::Draft;
use super::joint::{Built, DIRECTION, cone_members};
use super::model::Model;
use super::price::Prices;
use super::rule::{ConstraintUse, Rule};
use crate::program::Outcome;
use crate::program::number::{f64_from_i64, f64_from_i128, f64_from_usize, i64_from_usize};
use onboard_core::time::{Duration, Instant};

const DAY_S: f64 = 86_400.0;

/// Overlap, days and windows of starts: each telescope, each day, and each window with a price.
pub(super) fn first(model: &Model, draft: &Draft<'_>, prices: &Prices) -> Vec<ConstraintUse> {
    let seconds = |ns: i64| Duration::from_ns(ns).seconds();
    let mut rows = Vec::new();
    let mut reserved = vec![0_i64; model.lanes];
    for id in draft.chosen() {
        let session = &model.sessions[id];
        if let Some(sum) = reserved.get_mut(session.lane) {
            *sum += session.length();
        }
    }
    let limit = seconds(model.span_ns);
    for ((&telescope, reserved), ladder) in model.lane_names.iter().zip(reserved).zip(&prices.lanes)
    {
        let price = model.price_from_units(f64_from_i64(ladder.total()));
        rows.push(ConstraintUse {
            rule: Rule::Exclusive { telescope },
            used: seconds(reserved),
            limit,
            shadow_price: if limit > 0.0 { price / limit } else { 0.0 },
        });
    }
    if let Some(limit) = model.day_limit {
        for day in 0..model.cell_count() {
            let price = model.price_from_units(f64_from_i64(prices.cell_worth(day, limit)));
            rows.push(ConstraintUse {
                rule: Rule::Day { day },
                used: seconds(draft.used(day)),
                limit: seconds(limit),
                shadow_price: if limit > 0 { price / seconds(limit) } else { 0.0 },
            });
        }
    }
    if let Some((count, window)) = model.count {
        for (from, price) in prices.windows.points() {
            let used = draft.starts(from, from.saturating_add(window)).count();
            rows.push(ConstraintUse {
                rule: Rule::SessionCount { from: Instant::from_tai_ns(from) },
                used: f64_from_i64(i64_from_usize(used)),
                limit: f64_from_i64(i64_from_usize(count)),
                shadow_price: model.price_from_units(f64_from_i64(price)),
            });
        }
    }
    rows
}

/// The further rules, by the sessions that stand.
pub(super) fn further(built: &Built<'_>, found: &Outcome, marks: &[bool]) -> Vec<ConstraintUse> {
    let mut all = rows(built, found, marks);
    all.extend(seasons(built, found, marks));
    all.extend(gaps(built, marks));
    for diversity in &built.problem.demands.diversity {
        all.extend(angles(built, found, marks, diversity));
    }
    all
}

/// Rules of which each place is one row: thermal windows and stretches of memory.
fn rows(built: &Built<'_>, found: &Outcome, marks: &[bool]) -> Vec<ConstraintUse> {
    let seconds = |ns: i128| f64_from_i128(ns) / 1e9;
    let rows = built.program.rows.iter().zip(&built.rules).zip(&found.prices);
    let used = rows.filter_map(|((row, rule), price)| {
        let standing = row.terms.iter().filter(|it| marks[it.0]);
        let used: i128 = standing.map(|it| i128::from(it.1)).sum();
        Some(ConstraintUse {
            rule: (*rule)?,
            used: seconds(used),
            limit: seconds(i128::from(row.limit)),
            // Per second of limit.
            shadow_price: built.value(price * 1e9),
        })
    });
    used.collect()
}

fn seasons(built: &Built<'_>, found: &Outcome, marks: &[bool]) -> Vec<ConstraintUse> {
    let used = built.seasons.iter().enumerate().map(|(place, season)| {
        // Seasons that are rows stand behind the programme's own.
        let row = found.prices.get(built.program.rows.len() + place);
        let price = found.slopes.get(season.cell).into_iter().chain(row).sum::<f64>();
        let held = season.sessions.iter().filter(|&&id| marks[id]).count();
        ConstraintUse {
            rule: season.rule(),
            used: f64_from_usize(held),
            limit: f64_from_usize(season.wanted),
            // Per session fewer asked for.
            shadow_price: built.value(price),
        }
    });
    used.collect()
}

/// Windows of the longest gap that no session starts in.
fn gaps(built: &Built<'_>, marks: &[bool]) -> Vec<ConstraintUse> {
    let Some(gap) = built.problem.demands.longest_gap else { return Vec::new() };
    let empty = built.gaps.iter().filter(|it| !it.sessions.iter().any(|&id| marks[id]));
    let used = empty.map(|it| ConstraintUse {
        rule: it.rule,
        used: gap.step().seconds() / DAY_S,
        limit: 0.0,
        shadow_price: gap.price_per_day,
    });
    used.collect()
}

/// One bound on scan angles, per target and telescope.
fn angles(
    built: &Built<'_>,
    found: &Outcome,
    marks: &[bool],
    diversity: &Diversity,
) -> Vec<ConstraintUse> {
    let mut all = Vec::new();
    for ((target, telescope), members) in cone_members(built.model, built.facts, diversity) {
        let (mut sums, mut weight) = ([0.0; 2], 0.0);
        for &(id, ..) in members.iter().filter(|it| marks[it.0]) {
            let [w, c, s] = diversity.sums[built.model.sessions[id].candidate];
            sums[0] += c;
            sums[1] += s;
            weight += w;
        }
        let rule = Rule::ScanAngle { n: diversity.n, target, telescope };
        all.push(ConstraintUse {
            rule,
            used: if weight > 0.0 { sums[0].hypot(sums[1]) / weight } else { 0.0 },
            limit: diversity.rho,
            // A tangent's limit is rho times the length of its direction times the time in ms.
            shadow_price: built.value(tangents(built, found, rule) * DIRECTION * weight * 1e3),
        });
    }
    all
}

/// The prices of a scan-angle rule's tangents together.
fn tangents(built: &Built<'_>, found: &Outcome, rule: Rule) -> f64 {
    let Some(it) = built.angles.iter().find(|it| it.rule == rule) else { return 0.0 };
    let listed: f64 = found.prices.get(it.rows.clone()).into_iter().flatten().sum();
    let grown = built.grown.iter().filter(|row| row.1 == it.family);
    let grown: f64 = grown.filter_map(|row| found.prices.get(row.0)).sum();
    listed + grown + found.family_prices.get(it.family).copied().unwrap_or(0.0)
}
