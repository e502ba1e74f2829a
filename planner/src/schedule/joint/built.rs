//! A problem as an integer programme, with the rule that each row and cell stands for.
//!
//! Values of the programme are units, larger than those of the schedule by an offset: what seasons, gaps
//! and kept sessions of an earlier plan bring at most.

use super::facts::Facts;
use crate::program::number::i64_from_usize;
use crate::program::{Family, Gain, Program, Row};
use crate::schedule::model::Model;
use crate::schedule::problem::Problem;
use crate::schedule::reason::Because;
use crate::schedule::rule::Rule;
use onboard_core::time::Instant;
use std::ops::Range;

/// A limit on time also limits how many of the larger sessions stand, up to this number.
const LAYERS: i64 = 3;

/// A season of one target on one telescope.
#[derive(Debug, Clone)]
pub(crate) struct Season {
    pub(crate) target: usize,
    pub(crate) telescope: usize,
    pub(crate) from: Instant,
    pub(crate) wanted: usize,
    /// Sessions that count.
    pub(crate) sessions: Vec<usize>,
    /// Its cell of the programme.
    pub(crate) cell: usize,
}

impl Season {
    /// The season as a rule at one place.
    pub(crate) const fn rule(&self) -> Rule {
        Rule::MinSessions { target: self.target, telescope: self.telescope, from: self.from }
    }
}

/// A bound on the scan angles of one target on one telescope.
#[derive(Debug, Clone)]
pub(crate) struct Angles {
    pub(crate) rule: Rule,
    /// Its tangents among the programme's rows.
    pub(crate) rows: Range<usize>,
    /// Its family, which adds further ones.
    pub(crate) family: usize,
}

/// A window that a session should start in.
#[derive(Debug, Clone)]
pub(crate) struct Gap {
    pub(crate) rule: Rule,
    pub(crate) sessions: Vec<usize>,
}

/// A problem as a programme.
pub(crate) struct Built<'m> {
    pub(crate) problem: &'m Problem,
    /// Its sessions: choice i is session i.
    pub(crate) model: &'m Model,
    pub(crate) facts: &'m Facts,
    pub(crate) program: Program,
    /// The rule of each row, where one row is one rule at one place.
    pub(crate) rules: Vec<Option<Rule>>,
    /// The rows before this one are those of overlap, days and starts.
    pub(crate) further: usize,
    /// Rows that labels know beyond those: of thermal windows and of the memory.
    pub(crate) label_rows: Range<usize>,
    /// The families before this one are theirs, too.
    pub(crate) further_families: usize,
    pub(crate) families: Vec<Box<dyn Family + 'm>>,
    /// Why a session is left out that a family refuses.
    pub(crate) refusals: Vec<Because>,
    /// What the programme's values are above those of the schedule, in units.
    pub(crate) offset: i128,
    /// Units per value, and the value they are of: their quotient may not be a number.
    pub(super) unit: (f64, f64),
    pub(crate) seasons: Vec<Season>,
    pub(crate) gaps: Vec<Gap>,
    pub(crate) angles: Vec<Angles>,
    /// Rows that families added to the programme, and which family.
    pub(crate) grown: Vec<(usize, usize)>,
    /// Objective lost per empty window.
    pub(crate) gap_charge: f64,
}

impl<'m> Built<'m> {
    /// A value in units.
    pub(super) fn units(&self, value: f64) -> f64 {
        value / self.unit.1.max(f64::MIN_POSITIVE) * self.unit.0
    }

    /// Units as a value.
    pub(crate) fn value(&self, units: f64) -> f64 {
        units / self.unit.0 * self.unit.1
    }

    /// The programme with every season as a rule beside its penalty.
    pub(crate) fn with_seasons_met(&self) -> Program {
        let mut strict = self.program.clone();
        strict.rows.extend(self.seasons.iter().map(|season| Row {
            terms: season.sessions.iter().map(|&id| (id, -1)).collect(),
            limit: -i64_from_usize(season.wanted),
        }));
        strict
    }

    /// The price in units of each window of the longest gap.
    pub(crate) fn gap_prices(&self) -> impl Iterator<Item = i64> + '_ {
        // Their cells are the last ones.
        let first = self.program.cells.len().saturating_sub(self.gaps.len());
        self.program.cells[first..].iter().map(|cell| match cell.gain {
            Gain::Shortfall { price, .. } => price,
            Gain::Log { .. } => 0,
        })
    }

    /// Whether a family is one of scan angles.
    pub(crate) fn is_of_angles(&self, family: usize) -> bool {
        self.angles.iter().any(|it| it.family == family)
    }

    /// Adds a family, and why it leaves sessions out.
    pub(super) fn family(&mut self, family: Box<dyn Family + 'm>, refusal: Because) {
        self.families.push(family);
        self.refusals.push(refusal);
    }

    /// Adds a row that some set violates.
    pub(super) fn row(&mut self, row: Row, rule: Option<Rule>) {
        let most: i128 = row.terms.iter().map(|it| i128::from(it.1.max(0))).sum();
        if most > i128::from(row.limit) {
            self.program.rows.push(row);
            self.rules.push(rule);
        }
    }

    /// A limit on time, and what follows from it: of sessions that each use more than 1/(k + 1) of
    /// the limit, at most k.
    pub(super) fn limit(&mut self, row: Row, rule: Option<Rule>) {
        for most in 1..=LAYERS {
            let large = |it: &&(usize, i64)| {
                i128::from(it.1) * i128::from(most + 1) > i128::from(row.limit)
            };
            let terms = row.terms.iter().filter(large).map(|it| (it.0, 1)).collect();
            self.row(Row { terms, limit: most }, None);
        }
        self.row(row, rule);
    }
}
