//! What a forecast does not speak of, in sentences.

use planner::information::{SHORT, Teaching};
use planner::world::World;
use std::collections::BTreeMap;

/// What is left out for want of a key or of a known strength, and where noise is not white over a pass.
#[must_use]
pub fn left_out(world: &World, teaching: &Teaching) -> Vec<String> {
    let mut by_target: BTreeMap<Option<usize>, Vec<String>> = BTreeMap::new();
    for left in &teaching.forecast.left {
        by_target.entry(left.target).or_default().push(teaching.looks[left.look].key());
    }
    let few = |names: &[String]| match names {
        [first, .., last] if names.len() > 4 => {
            format!("{} lines of sight from {first} to {last}", names.len())
        }
        _ => names.join(", "),
    };
    let mut told: Vec<String> = by_target
        .iter()
        .map(|(target, names)| match target {
            None => format!("left out for want of net_uk_rts or frequency_ghz: {}", few(names)),
            Some(target) => format!(
                "{} has no known strength in the bands of {}",
                world.targets[*target].name(),
                few(names)
            ),
        })
        .collect();
    let long: Vec<String> = (0..teaching.looks.len())
        .filter(|&look| teaching.lesson(look).long > 0)
        .map(|look| teaching.looks[look].key())
        .collect();
    if !long.is_empty() {
        told.push(format!(
            "passes are not short beside the noise's knee, 1/f leaves less than {} % of the information: {}",
            100.0 * SHORT,
            few(&long)
        ));
    }
    told
}
