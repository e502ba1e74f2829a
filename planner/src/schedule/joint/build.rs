//! The integer programme of a problem: choice i is session i of the model.

use super::built::Built;
use super::cells::LARGEST_CELL;
use super::facts::Facts;
use crate::program::{Choice, Program};
use crate::schedule::model::Model;
use crate::schedule::problem::Problem;

/// Largest charge at one place over the largest weight of a logarithm.
const CHARGE_PER_WEIGHT: f64 = 256.0;

/// The programme of a problem.
pub(crate) fn build<'m>(problem: &'m Problem, model: &'m Model, facts: &'m Facts) -> Built<'m> {
    let demands = &problem.demands;
    let unit = match &demands.log {
        None => model.unit(),
        Some(log) => {
            let weights = problem.weights.iter().chain(log.weights.values());
            let charge = demands.largest_charge() / CHARGE_PER_WEIGHT;
            (LARGEST_CELL, weights.copied().fold(charge.max(f64::MIN_POSITIVE), f64::max))
        }
    };
    let count = model.sessions.len();
    let mut fixed = vec![false; problem.candidates.len()];
    for &candidate in &demands.fixed {
        fixed[candidate] = true;
    }
    let choice = |id: usize| {
        if fixed[model.sessions[id].candidate] { Choice::Always } else { Choice::Free }
    };
    let linear = demands.log.is_none();
    let mut built = Built {
        problem,
        model,
        facts,
        program: Program {
            values: model.sessions.iter().map(|it| if linear { it.value } else { 0 }).collect(),
            choices: (0..count).map(choice).collect(),
            rows: Vec::new(),
            cells: Vec::new(),
        },
        rules: Vec::new(),
        further: 0,
        label_rows: 0..0,
        further_families: 0,
        families: Vec::new(),
        refusals: Vec::new(),
        offset: 0,
        unit,
        seasons: Vec::new(),
        gaps: Vec::new(),
        angles: Vec::new(),
        grown: Vec::new(),
        gap_charge: 0.0,
    };
    built.overlaps();
    built.days();
    built.starts();
    built.further = built.program.rows.len();
    built.further_families = built.families.len();
    built.heat();
    built.memory();
    built.label_rows = built.further..built.program.rows.len();
    for diversity in &demands.diversity {
        built.cones(diversity);
    }
    built.logarithms();
    built.previous();
    built.season_cells();
    built.gap_cells();
    built
}
