//! Every transit of every target through every line of sight, in order.
//!
//! Method: one channel of the flight core's finder for each pair, run in parallel; then sorted by
//! entry, target and line of sight. The ground adds nothing to the mathematics.

use crate::failure::Failure;
use crate::sightline::{SightLine, View};
use crate::world::{World, body};
use ephem::time::format_tdb;
use onboard_core::ephemeris::{EphemerisError, EphemerisTable};
use onboard_core::transit::{Channel, Transit};
use planner::visits::transits;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A transit with the indices of its target and its line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// Index of the target.
    pub target: usize,
    /// Index of the line of sight.
    pub line: usize,
    /// The transit.
    pub transit: Transit,
}

/// All transits over the mission, by entry, then target, then line of sight.
///
/// # Errors
/// [`Failure::Internal`] where the fitted table does not serve its own span.
pub fn search(
    world: &World,
    table: EphemerisTable<'_>,
    lines: &[SightLine],
) -> Result<Vec<Found>, Failure> {
    let sun = world.sun(table)?;
    // Lines of sight that see the same are searched once.
    let mut alike: BTreeMap<View, Vec<usize>> = BTreeMap::new();
    for (index, line) in lines.iter().enumerate() {
        alike.entry(line.view()).or_default().push(index);
    }
    let pairs: Vec<(usize, &Vec<usize>)> = (0..world.targets.len())
        .flat_map(|target| alike.values().map(move |group| (target, group)))
        .collect();
    let found: Result<Vec<Vec<Found>>, Failure> = pairs
        .par_iter()
        .map(|&(target, group)| {
            let source = &world.targets[target];
            let channel = Channel::new(
                &world.scan,
                sun,
                body(table, source.body())?,
                &lines[group[0]].field,
                (world.start, world.end),
            );
            let transits = transits(channel).map_err(|error| {
                Failure::internal(format!("search for {}: {}", source.name(), told(error)))
            })?;
            let all = |transit| group.iter().map(move |&line| Found { target, line, transit });
            Ok(transits.into_iter().flat_map(all).collect())
        })
        .collect();
    let mut found = found?.concat();
    found.sort_by_key(|it| (it.transit.entry, it.target, it.line));
    Ok(found)
}

/// An error of the core's table, in words.
#[must_use]
pub fn told(error: EphemerisError) -> String {
    match error {
        EphemerisError::WrongLength => "the table's length contradicts its counts".to_owned(),
        EphemerisError::BadSpan(index) => format!("span {index} of the table is illegal"),
        EphemerisError::BadCoefficient(index) => {
            format!("coefficient {index} of the table is not finite")
        }
        EphemerisError::NoSuchBody(number) => format!("body {number} is not in the table"),
        EphemerisError::OutOfSpan(at) => {
            format!("{} TDB lies outside the table", format_tdb(at))
        }
    }
}
