//! `gyrfalcon plan`: the calibration timeline, the main job.

mod wishes;
mod contradiction;
mod folder;
mod never;
mod summary;

use super::asked::world;
use super::earlier::TIMELINE;
use super::pointing::SHORTEST_MESSAGE_NS;
use super::told::{print_json, tell, warn};
use crate::cli::{AttitudeSpan, PlanArgs, SharedArgs};
use crate::failure::Failure;
use crate::output::interrupt::{self, SearchLimit};
use crate::output::stamp::stamp;
use crate::output::unfinished::Locked;
use crate::output::{fill_folder_with_digests, whole};
use crate::report;
use contradiction::plan_failure;
use folder::{is_ours, remove_stale};
use formats::flown::{FlightError, flown};
use formats::forecast::Taught;
use formats::products::Products;
use formats::resonance::sentence;
use formats::sequence::number_after_plan;
use formats::timeline::timeline;
use formats::uplink::{long_checks, slow_checks};
use mission::occasions::Blackouts;
use never::never;
use planner::plan::plan;
use planner::resonance::check::Resonances;
use planner::schedule::{Stopped, check};
use planner::world::World;
use std::path::Path;
use summary::{Summed, summary, told};
use wishes::Wishes;

const DEFAULT_FOLDER: &str = "gyrfalcon-plan";

pub(super) fn run(shared: &SharedArgs, arguments: &PlanArgs) -> Result<(), Failure> {
    let folder = shared.out.clone().unwrap_or_else(|| DEFAULT_FOLDER.into());
    if folder.as_os_str() == "-" {
        return Err(Failure::Input(
            "plan writes a folder: --out FOLDER is needed, not -".to_owned(),
        ));
    }
    let ours = is_ours(&folder, arguments.force)?;
    let lock = lock(&folder)?;
    let replaces = folder.join(TIMELINE).exists() && !arguments.force;
    let world = world(shared)?;
    let wishes = Wishes::read(&arguments.revision, &world)?;
    let (asked, after) = (arguments.sequence.sequence, arguments.sequence.after);
    let sequence = number_after_plan(asked, after, arguments.revision.against.as_deref())
        .map_err(Failure::Input)?;
    let asked = &arguments.products;
    let stamp = stamp(asked.stamp.as_deref(), world.start)?;
    warn(shared, &slow_checks(&world));
    warn(shared, &Blackouts::read(&world.mission, (world.start, world.end))?.left_out());
    let resonance = resonance(shared, &world);
    if asked.aem_span == AttitudeSpan::All
        && world.end.since(world.start).ns() < SHORTEST_MESSAGE_NS
    {
        return Err(Failure::Input(
            "--aem-span all: a mission of 1 ms or more is needed for its attitude".to_owned(),
        ));
    }
    let search_limit = SearchLimit::new(wishes.time_limit);
    let plan = plan(&world, &wishes.revision(), &search_limit)
        .map_err(|error| plan_failure(&world, error))?;
    let flight = flown(&world, plan, sequence, &search_limit);
    let (plan, uplink) = flight.map_err(|error| match error {
        FlightError::Plan(error) => plan_failure(&world, *error),
        FlightError::TooLarge(error) => error.into(),
        FlightError::Fault(fault) => Failure::internal(fault),
    })?;
    interrupt::listen_no_more();
    if interrupt::interrupted() && replaces {
        return Err(Failure::Check(format!(
            "interrupted: the plan in {} stays as it was (--force, or --out with a new folder, takes \
             the best schedule so far)",
            folder.display()
        )));
    }
    let (tables, offers) = (&plan.offered.tables, &plan.offered.offers);
    let opportunities = &offers.opportunities;
    warn(shared, &long_checks(&world, &uplink));
    warn(shared, never(&plan.schedule.rejected, opportunities.list().len()).as_slice());
    let mut timeline = timeline(&world, &plan, resonance.as_ref())?;
    if plan.schedule.stopped == Stopped::Interrupted {
        timeline.stopped = search_limit.told();
    }
    let difference = wishes.difference(&mut timeline);
    let violation =
        check(&plan.offered.problem, &plan.schedule.chosen).err().map(|it| it.to_string());
    let taught = Taught::of(&world, tables.parse()?, &timeline, opportunities);
    let page = report::page(&report::Source {
        world: &world,
        taught: &taught,
        table: tables.parse()?,
        offers,
        timeline: &timeline,
        violation: violation.as_deref(),
        difference: difference.as_ref(),
    })?;
    let products = Products {
        world: &world,
        sun: world.sun(tables.parse()?)?,
        timeline: &timeline,
        stamp,
        error_rad: (asked.aem_error_arcsec / 3600.0).to_radians(),
        whole: asked.aem_span == AttitudeSpan::All,
        spacecraft: asked.naif_id,
    };
    let (json, csv) = (timeline.to_json()?, timeline.to_csv()?);
    let mut files = vec![
        (TIMELINE, whole(&json)),
        ("timeline.csv", whole(&csv)),
        ("uplink.tbl", whole(&uplink)),
        ("report.html", whole(&page)),
    ];
    files.extend(products.fills(&asked.also())?);
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    lock.clear();
    fill_folder_with_digests(&folder, files)?;
    if ours {
        remove_stale(&folder, &names)?;
    }
    let summed = Summed { world: &world, timeline: &timeline, opportunities, taught: &taught };
    if shared.json {
        print_json(&summary(&summed))?;
    } else {
        let resonance = resonance.as_ref();
        tell(&told(&summed, (&folder, &names), resonance))?;
    }
    finished(&folder)?;
    if arguments.strict {
        enough(&world, &taught)?;
        verdict(&world, resonance.as_ref())?;
    }
    Ok(())
}

/// A failure where the search was interrupted.
fn finished(folder: &Path) -> Result<(), Failure> {
    if interrupt::interrupted() {
        let folder = folder.display();
        return Err(Failure::Check(format!("interrupted: {folder} has the best schedule so far")));
    }
    Ok(())
}

/// A failure where a requirement is missed.
fn enough(world: &World, taught: &Taught) -> Result<(), Failure> {
    match taught.required.iter().find(|it| it.is_missed()) {
        Some(it) => {
            let (mission, name) = (&world.mission.name, it.name());
            Err(Failure::Check(format!("{mission}: requirement {name}: {}", it.sentence())))
        }
        None => Ok(()),
    }
}

/// The folder, in which no other plan is written meanwhile.
fn lock(folder: &Path) -> Result<Locked, Failure> {
    let locked = Locked::folder(folder).map_err(|error| Failure::file("use", folder, &error))?;
    locked.ok_or_else(|| {
        Failure::Input(format!(
            "another plan is being written into {}: wait for it, or name another folder with --out",
            folder.display()
        ))
    })
}

/// A failure where the periods beat.
fn verdict(world: &World, resonance: Option<&Resonances>) -> Result<(), Failure> {
    match resonance {
        Some(Resonances { checked, .. }) if !checked.certificate.passes => {
            let name = &world.mission.name;
            Err(Failure::Check(format!("{name}: resonance: {}", sentence(checked))))
        }
        _ => Ok(()),
    }
}

/// The check of the periods; one that cannot be made is a warning.
fn resonance(shared: &SharedArgs, world: &World) -> Option<Resonances> {
    Resonances::of_mission(world)
        .map_err(|error| warn(shared, &[format!("resonance cannot be judged: {error}")]))
        .ok()
}
