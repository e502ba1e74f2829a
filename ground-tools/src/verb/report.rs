//! `gyrfalcon report`: the page of a plan again, from its `timeline.json`.
//!
//! Passes are computed afresh; the mission and the kernel must be those of the plan, told by digest. The
//! sessions are held against every rule once more: a plan that breaks one gets its page, and exit code 1.

use super::asked::world;
use super::delivered::sink;
use super::earlier::{Earlier, TIMELINE, of_one_plan};
use super::told::warn;
use crate::cli::{ReportArgs, SharedArgs};
use crate::failure::Failure;
use crate::report::{Source, chosen, page};
use formats::forecast::Taught;
use formats::timeline::Timeline;
use planner::plan::{Offered, Session};
use planner::provenance::Provenance;
use planner::schedule::check;
use planner::world::World;
use std::path::Path;

pub(super) fn run(shared: &SharedArgs, arguments: &ReportArgs) -> Result<(), Failure> {
    let file = arguments.folder.join(TIMELINE);
    of_one_plan(&file)?;
    let (timeline, _) = Timeline::read(&file)?;
    let world = world(shared)?;
    same_inputs(&file, &timeline.provenance, &world)?;
    let program = &Provenance::of(&world).program;
    if *program != timeline.provenance.program {
        let other = &timeline.provenance.program;
        warn(shared, &[format!("{} is by {other}, the page by {program}", file.display())]);
    }
    let offered = Offered::find(&world)?;
    let earlier = arguments.against.as_ref().map(|path| Earlier::read(path, &world)).transpose()?;
    let difference = earlier.map(|it| it.difference(&timeline));
    let table = offered.tables.parse()?;
    let taught = Taught::of(&world, table, &timeline, &offered.offers.opportunities);
    let source = Source {
        world: &world,
        table,
        offers: &offered.offers,
        timeline: &timeline,
        violation: None,
        taught: &taught,
        difference: difference.as_ref(),
    };
    let taken = chosen(&source)?;
    same_sessions(&file, &timeline, &offered.sessions(&world, &taken)?)?;
    let violation = check(&offered.problem, &taken).err().map(|it| it.to_string());
    sink(shared).write(&page(&Source { violation: violation.as_deref(), ..source })?)?;
    match violation {
        None => Ok(()),
        Some(violation) => {
            Err(Failure::Check(format!("{} breaks a rule: {violation}", file.display())))
        }
    }
}

/// Refuses sessions that are not what the mission gives for their ids.
fn same_sessions(file: &Path, timeline: &Timeline, expected: &[Session]) -> Result<(), Failure> {
    let near = |found: f64, expected: f64| (found - expected).abs() < 1e-6;
    for (found, expected) in timeline.sessions.iter().zip(expected) {
        let passes = found.transits.iter().zip(&expected.passes);
        let same_passes = found.transits.len() == expected.passes.len()
            && passes.clone().all(|(found, expected)| {
                let transit = &expected.transit;
                found.detector == expected.detector
                    && found.entry_tai_ns == transit.entry.tai_ns()
                    && found.exit_tai_ns == transit.exit.tai_ns()
                    && found.closest_tai_ns == transit.closest.tai_ns()
                    && near(found.dwell_s, transit.dwell().seconds())
            });
        let what = match () {
            () if found.target != expected.target => "target",
            () if found.telescope != expected.telescope => "telescope",
            () if found.start() != expected.start => "start_tai_ns",
            () if found.end() != expected.end => "end_tai_ns",
            () if !near(found.dwell_s, expected.dwell.seconds()) => "dwell_s",
            () if !same_passes => "transits",
            () => continue,
        };
        return Err(Failure::Input(format!(
            "{}: the {what} of session {} is not what the mission gives: the timeline was changed",
            file.display(),
            found.id
        )));
    }
    Ok(())
}

fn same_inputs(file: &Path, plan: &Provenance, world: &World) -> Result<(), Failure> {
    let here = Provenance::of(world);
    let refuse = |what: &str, option: &str, theirs: &str, ours: &str| {
        Err(Failure::Input(format!(
            "{} was planned with the {what} of SHA-256 {theirs}, but here it is {ours}: that {what} is \
             needed, by {option}",
            file.display()
        )))
    };
    if plan.mission_sha256 != here.mission_sha256 {
        let options = "--mission, --set and the options that the plan had";
        return refuse("mission", options, &plan.mission_sha256, &here.mission_sha256);
    }
    if let Some(other) = plan.files.iter().find(|it| !here.files.contains(it)) {
        let ours = here.files.iter().find(|it| it.path == other.path);
        let ours = ours.map_or("not to be read", |it| it.sha256.as_str());
        let what = format!("file {}", other.path);
        return refuse(&what, "the mission's key", &other.sha256, ours);
    }
    if plan.kernel_sha256 != here.kernel_sha256 {
        return refuse("kernel", "--ephemeris", &plan.kernel_sha256, &here.kernel_sha256);
    }
    Ok(())
}
