//! Every transit of every target through every line of sight, in order, and what they offer a plan.
//!
//! Method: one channel of the flight core's finder for each pair, run in parallel; then sorted by
//! entry, target and line of sight. The ground adds nothing to the mathematics.

use super::opportunity::{Opportunities, OpportunityError};
use super::pass::Pass;
use super::sight_line::{FieldKey, SightError, SightLine, of_plan};
use crate::visits::transits;
use crate::world::{TableFault, Tables, World, body};
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::time::Instant;
use onboard_core::transit::{Channel, Transit};
use rayon::prelude::*;
use std::collections::BTreeMap;
use thiserror::Error;

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

/// Why passes cannot be found; none of it is due to input that was checked.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OffersError {
    /// A line of sight cannot be made.
    #[error(transparent)]
    Sight(#[from] SightError),
    /// The tables.
    #[error(transparent)]
    Table(#[from] TableFault),
    /// The tables end before the search does.
    #[error("search for {target}: {fault}")]
    Search {
        /// The target searched for.
        target: String,
        /// What the table says.
        fault: TableFault,
    },
    /// Passes through a line of sight that is no telescope's.
    #[error("a plan's line of sight without a telescope")]
    NoTelescope,
    /// Passes that cannot be grouped.
    #[error(transparent)]
    Opportunity(#[from] OpportunityError),
}

/// What a mission offers to a plan.
#[derive(Debug)]
pub struct Offers {
    /// Its lines of sight.
    pub lines: Vec<SightLine>,
    /// All transits through them; in a window of the mission, those of the opportunities within it.
    pub found: Vec<Found>,
    /// Their opportunities.
    pub opportunities: Opportunities,
}

impl Offers {
    /// The transits of every target through every line of sight of a plan, grouped.
    ///
    /// # Errors
    /// [`OffersError`] where the fitted tables do not serve their own span.
    pub fn find(world: &World, tables: &Tables) -> Result<Self, OffersError> {
        let lines = of_plan(&world.mission)?;
        let found = search_in(world, tables.parse()?, &lines, world.reach())?;
        let passes = passes(&found, &lines)?;
        let mut opportunities =
            Opportunities::group(&passes, &world.scan, world.mission.sessions())?;
        let span = (world.start, world.end);
        let found = if world.reach() == span {
            found
        } else {
            let kept = opportunities.keep_within(span);
            kept.into_iter().map(|pass| found[pass]).collect()
        };
        Ok(Self { lines, found, opportunities })
    }
}

/// All transits over the mission, or its window, by entry, then target, then line of sight.
///
/// # Errors
/// [`OffersError`] where the fitted tables do not serve their own span.
pub fn search(
    world: &World,
    table: EphemerisTable<'_>,
    lines: &[SightLine],
) -> Result<Vec<Found>, OffersError> {
    search_in(world, table, lines, (world.start, world.end))
}

fn search_in(
    world: &World,
    table: EphemerisTable<'_>,
    lines: &[SightLine],
    span: (Instant, Instant),
) -> Result<Vec<Found>, OffersError> {
    let sun = world.sun(table)?;
    // Lines of sight that see the same are searched once.
    let mut alike: BTreeMap<FieldKey, Vec<usize>> = BTreeMap::new();
    for (index, line) in lines.iter().enumerate() {
        alike.entry(line.field_key()).or_default().push(index);
    }
    let pairs: Vec<(usize, &Vec<usize>)> = (0..world.targets.len())
        .flat_map(|target| alike.values().map(move |group| (target, group)))
        .collect();
    let found: Result<Vec<Vec<Found>>, OffersError> = pairs
        .par_iter()
        .map(|&(target, group)| {
            let source = &world.targets[target];
            let channel = Channel::new(
                &world.scan,
                sun,
                body(table, source.body())?,
                &lines[group[0]].field,
                span,
            );
            let transits = transits(channel).map_err(|error| OffersError::Search {
                target: source.name().to_owned(),
                fault: TableFault(error),
            })?;
            let all = |transit| group.iter().map(move |&line| Found { target, line, transit });
            Ok(transits.into_iter().flat_map(all).collect())
        })
        .collect();
    let mut found = found?.concat();
    found.sort_by_key(|it| (it.transit.entry, it.target, it.line));
    Ok(found)
}

fn passes(found: &[Found], lines: &[SightLine]) -> Result<Vec<Pass>, OffersError> {
    found
        .iter()
        .map(|it| {
            let telescope = lines[it.line].telescope.ok_or(OffersError::NoTelescope)?;
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
