//! Every transit of every target through every line of sight, in order, and what they offer a plan.
//!
//! Method: one channel of the flight core's finder for each pair, run in parallel; then sorted by
//! entry, target and line of sight. The ground adds nothing to the mathematics.

use crate::failure::Failure;
use crate::sightline::{SightLine, View, of_plan};
use crate::world::{World, body};
use ephem::time::format_tdb;
use onboard_core::ephemeris::{EphemerisError, EphemerisTable};
use onboard_core::transit::{Channel, Transit};
use planner::opportunity::{Opportunities, Pass};
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

/// What a mission offers to a plan.
#[derive(Debug)]
pub struct Offers {
    /// Its lines of sight.
    pub lines: Vec<SightLine>,
    /// All transits through them.
    pub found: Vec<Found>,
    /// Their opportunities.
    pub opportunities: Opportunities,
}

impl Offers {
    /// The transits of every target through every line of sight of a plan, grouped.
    ///
    /// # Errors
    /// [`Failure::Internal`] where the fitted table does not serve its own span,
    /// [`Failure::Input`] where a line of sight cannot be made.
    pub fn find(world: &World, table: EphemerisTable<'_>) -> Result<Self, Failure> {
        let lines = of_plan(&world.mission)?;
        let found = search(world, table, &lines)?;
        let passes = passes(&found, &lines)?;
        let opportunities =
            Opportunities::group(&passes, &world.scan).map_err(Failure::internal)?;
        Ok(Self { lines, found, opportunities })
    }
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

fn passes(found: &[Found], lines: &[SightLine]) -> Result<Vec<Pass>, Failure> {
    found
        .iter()
        .map(|it| {
            let telescope = lines[it.line]
                .telescope
                .ok_or_else(|| Failure::internal("a plan's line of sight without a telescope"))?;
            Ok(Pass {
                target: it.target,
                telescope,
                detector: it.line,
                entry: it.transit.entry,
                exit: it.transit.exit,
                closest: it.transit.closest,
                entry_clipped: it.transit.entry_clipped,
                exit_clipped: it.transit.exit_clipped,
            })
        })
        .collect()
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
