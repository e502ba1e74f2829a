//! Made-up programmes: intervals on telescopes, and budgets that all of them share.

use crate::random::between;
use ephem::random::SplitMix64;
use planner::program::{Choice, Program, Row};

/// What the values of opportunities are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Values {
    /// Independent of all else.
    Uniform,
    /// About the length.
    Length,
    /// A few different ones.
    Tied,
    /// About what they use of the budgets.
    Correlated,
}

/// What an instance is like.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shape {
    pub(crate) opportunities: usize,
    pub(crate) budgets: usize,
    pub(crate) telescopes: usize,
    pub(crate) values: Values,
    /// Opportunities that overlap one instant of a telescope, about.
    pub(crate) depth: i64,
    /// Percentage of what all use together that each budget allows.
    pub(crate) tight: i64,
    /// Each budget counts a stretch of the mission only.
    pub(crate) local: bool,
}

/// The intervals of an instance, and its programme.
pub(crate) struct Instance {
    pub(crate) intervals: Vec<(usize, i64, i64)>,
    pub(crate) program: Program,
}

/// An instance from a seed.
pub(crate) fn instance(shape: &Shape, seed: u64) -> Instance {
    let mut random = SplitMix64(seed);
    let count = i64::try_from(shape.opportunities).unwrap();
    let lanes = i64::try_from(shape.telescopes).unwrap();
    let span = 100 * count / (lanes * shape.depth).max(1);
    let mut intervals: Vec<(usize, i64, i64)> = (0..count)
        .map(|_| {
            let start = between(&mut random, 0, span);
            let length = between(&mut random, 20, 180);
            (usize::try_from(between(&mut random, 0, lanes - 1)).unwrap(), start, start + length)
        })
        .collect();
    intervals.sort_by_key(|it| (it.1, it.2, it.0));
    let mut rows = Vec::new();
    for lane in 0..shape.telescopes {
        rows.extend(cliques(&intervals, lane));
    }
    let mut uses = vec![0; intervals.len()];
    for budget in 0..shape.budgets {
        let stretch = if shape.local {
            let width = span / i64::try_from(shape.budgets).unwrap() + 1;
            let from = i64::try_from(budget).unwrap() * width;
            from..from + width
        } else {
            0..span + 1
        };
        let terms: Vec<(usize, i64)> = (0..intervals.len())
            .filter(|&at| stretch.contains(&intervals[at].1))
            .map(|at| (at, between(&mut random, 10, 100)))
            .collect();
        for &(at, a) in &terms {
            uses[at] += a;
        }
        let all: i64 = terms.iter().map(|it| it.1).sum();
        rows.push(Row { terms, limit: all * shape.tight / 100 });
    }
    let values = intervals
        .iter()
        .zip(&uses)
        .map(|(&(_, start, end), &uses)| match shape.values {
            Values::Uniform => between(&mut random, 1, 1_000),
            Values::Length => (end - start) * 10 + between(&mut random, 0, 50),
            Values::Tied => 100 * between(&mut random, 1, 4),
            Values::Correlated => uses + between(&mut random, 0, 100),
        })
        .collect();
    let choices = vec![Choice::Free; intervals.len()];
    Instance { program: Program { values, choices, rows, cells: Vec::new() }, intervals }
}

/// Rows of the maximal sets of intervals that overlap on one telescope; intervals come by start.
fn cliques(intervals: &[(usize, i64, i64)], lane: usize) -> Vec<Row> {
    let on: Vec<usize> = (0..intervals.len()).filter(|&at| intervals[at].0 == lane).collect();
    let mut rows: Vec<Row> = Vec::new();
    for &at in &on {
        let start = intervals[at].1;
        let terms: Vec<(usize, i64)> = on
            .iter()
            .filter(|&&it| intervals[it].1 <= start && start < intervals[it].2)
            .map(|&it| (it, 1))
            .collect();
        if let Some(last) = rows.last_mut()
            && last.terms.iter().all(|it| terms.contains(it))
        {
            last.terms = terms;
        } else if terms.len() > 1 && !rows.iter().any(|row| row.terms == terms) {
            rows.push(Row { terms, limit: 1 });
        }
    }
    rows.retain(|row| row.terms.len() > 1);
    rows
}

/// The instances whose optima are stored, by name.
pub(crate) fn stored() -> Vec<(String, Shape, u64)> {
    let mut all = Vec::new();
    let kinds = [Values::Uniform, Values::Length, Values::Tied, Values::Correlated];
    for (number, values) in kinds.into_iter().enumerate() {
        for (place, (opportunities, budgets, tight, depth)) in
            [(60, 3, 20, 3), (120, 4, 12, 4), (200, 6, 10, 5), (200, 2, 25, 2), (200, 6, 5, 1)]
                .into_iter()
                .enumerate()
        {
            let seed = u64::try_from(1_000 + 10 * number + place).unwrap();
            let shape =
                Shape { opportunities, budgets, telescopes: 2, values, depth, tight, local: false };
            all.push((format!("{opportunities}-{budgets}-{tight}-{values:?}"), shape, seed));
        }
        let shape = Shape {
            opportunities: 1_000,
            budgets: 6,
            telescopes: 3,
            values,
            depth: 4,
            tight: 12,
            local: false,
        };
        all.push((format!("1000-6-12-{values:?}"), shape, 2_000 + u64::try_from(number).unwrap()));
    }
    all
}
