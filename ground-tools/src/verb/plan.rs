//! `gyrfalcon plan`: the calibration timeline, the main job.

use super::{print_json, tell, warn, world};
use crate::cli::{AttitudeSpan, PlanArgs, RevisionArgs, SharedArgs};
use crate::demands::{Sources, blackouts};
use crate::failure::Failure;
use crate::interrupt::SearchLimit;
use crate::mission::schedule::Exclusive as ExclusiveKey;
use crate::output::{fill_folder, whole};
use crate::passes::Offers;
use crate::product::stamp::stamp;
use crate::product::{ALWAYS, Also, Products};
use crate::provenance::PROGRAM;
use crate::quantity;
use crate::report::{self, Difference};
use crate::resonance_check::{ResonanceCheck, minutes};
use crate::revision::{Earlier, Revision};
use crate::rounding;
use crate::timeline::{Planned, Resonance, Timeline, date, session_id};
use crate::uplink::{Contents, slow_checks};
use crate::world::World;
use ephem::fit::FitOptions;
use ephem::time::{parse_time, utc_day, utc_midnight};
use onboard_core::time::{Duration, Instant};
use planner::opportunity::Opportunities;
use planner::schedule::{
    Candidate, Conflict, Demands, Exclusive, Loosening, Problem, RuleName, Rules, Schedule,
    ScheduleError, SessionCount, Stopped, check, loosen, schedule_until,
};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::Path;

const DEFAULT_FOLDER: &str = "gyrfalcon-plan";
/// The file by which a plan is known.
const TIMELINE: &str = ALWAYS[0];
/// How much of the timeline is printed.
const SHOWN: Duration = Duration::from_ns(14 * 86_400 * 1_000_000_000);

pub(super) fn run(shared: &SharedArgs, arguments: &PlanArgs) -> Result<(), Failure> {
    let folder = shared.out.clone().unwrap_or_else(|| DEFAULT_FOLDER.into());
    if folder.as_os_str() == "-" {
        return Err(Failure::Input(
            "plan writes a folder: --out FOLDER is needed, not -".to_owned(),
        ));
    }
    let ours = is_ours(&folder, arguments.force)?;
    let world = world(shared)?;
    let wishes = Wishes::read(&arguments.revision, &world)?;
    let asked = &arguments.products;
    let variable = std::env::var("SOURCE_DATE_EPOCH").ok();
    let stamp = stamp(asked.stamp.as_deref(), variable.as_deref(), world.start)?;
    warn(shared, &slow_checks(&world));
    let resonance = resonance(shared, &world)?;
    let tables = world.tables(&FitOptions::UPLINK)?;
    let table = tables.parse()?;
    let offers = Offers::find(&world, table)?;
    let opportunities = &offers.opportunities;
    let blackouts = blackouts(&world)?;
    let sun = world.sun(table)?;
    let sources = Sources { world: &world, offers: &offers, sun, table };
    let mut problem = problem(&world, opportunities, sources.demands(&blackouts)?);
    wishes.ask(&world, opportunities, &mut problem)?;
    let search_limit = SearchLimit::new(wishes.time_limit);
    let (schedule, loosened) = scheduled(&world, &problem, &search_limit)?;
    let planned = Planned {
        world: &world,
        offers: &offers,
        sun,
        table,
        blackouts: &blackouts,
        problem: &problem,
        schedule: &schedule,
        loosened: &loosened,
        resonance: resonance.as_ref(),
    };
    let mut timeline = planned.timeline()?;
    if schedule.stopped == Stopped::Interrupted {
        timeline.stopped = search_limit.told();
    }
    let difference = wishes.difference(&mut timeline);
    let records = planned.records()?;
    let contents = Contents {
        world: &world,
        ephemeris: &tables.fitted.bytes,
        sessions: Some(&records),
        sequence: arguments.sequence,
    };
    let violation = check(&problem, &schedule.chosen).err().map(|it| it.to_string());
    let page = report::page(&report::Source {
        world: &world,
        table,
        offers: &offers,
        timeline: &timeline,
        violation: violation.as_deref(),
        difference: difference.as_ref(),
    })?;
    let products = Products {
        world: &world,
        sun,
        timeline: &timeline,
        stamp,
        error_rad: (asked.aem_error_arcsec / 3600.0).to_radians(),
        whole: asked.aem_span == AttitudeSpan::All,
        spacecraft: asked.naif_id,
    };
    let (json, csv, uplink) = (timeline.to_json()?, timeline.to_csv()?, contents.to_bytes()?);
    let mut files = vec![
        (TIMELINE, whole(&json)),
        ("timeline.csv", whole(&csv)),
        ("uplink.tbl", whole(&uplink)),
        ("report.html", whole(&page)),
    ];
    files.extend(products.fills(&Also::chosen(&asked.also))?);
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    fill_folder(&folder, files)?;
    if ours {
        remove_stale(&folder, &names)?;
    }
    if shared.json {
        print_json(&summary(&world, &timeline, opportunities))?;
    } else {
        let resonance = resonance.as_ref();
        tell(shared, &told(&world, &timeline, opportunities, (&folder, &names), resonance))?;
    }
    verdict(&world, resonance.as_ref().filter(|_| arguments.strict))
}

/// A failure where the periods beat.
fn verdict(world: &World, resonance: Option<&Resonance>) -> Result<(), Failure> {
    match resonance {
        Some(Resonance { checked, .. }) if !checked.certificate.passes => {
            let name = &world.mission.name;
            Err(Failure::Check(format!("{name}: resonance: {}", checked.sentence())))
        }
        _ => Ok(()),
    }
}

/// The check of the periods; one that cannot be made is a warning. Where it fails, periods nearby
/// are recommended.
fn resonance(shared: &SharedArgs, world: &World) -> Result<Option<Resonance>, Failure> {
    let checked = ResonanceCheck::of_mission(world).and_then(|mut check| {
        let checked = check.certify().map_err(Failure::input)?;
        Ok((check, checked))
    });
    let (mut check, checked) = match checked {
        Ok(found) => found,
        Err(error) => {
            warn(shared, &[format!("resonance cannot be judged: {error}")]);
            return Ok(None);
        }
    };
    let candidates = if checked.certificate.passes { Vec::new() } else { check.nearby() };
    let recommended = check.recommend(&candidates).map_err(Failure::input)?;
    Ok(Some(Resonance { checked, recommended }))
}

/// Every file that `plan` may have written.
fn own_files() -> impl Iterator<Item = &'static str> {
    ALWAYS.into_iter().chain(Also::EACH.into_iter().flat_map(|it| it.files().iter().copied()))
}

/// Whether the folder is one that `plan` wrote, or empty. A place that cannot be a folder is told
/// before the work; one that others wrote must be forced.
fn is_ours(folder: &Path, force: bool) -> Result<bool, Failure> {
    let not_a_folder = folder.ancestors().find(|path| path.exists() && !path.is_dir());
    if let Some(file) = not_a_folder {
        return Err(Failure::Input(format!(
            "cannot write into {}: {} is a file",
            folder.display(),
            file.display()
        )));
    }
    if !folder.exists() {
        return Ok(true);
    }
    let entries = std::fs::read_dir(folder)
        .and_then(Iterator::collect::<Result<Vec<_>, _>>)
        .map_err(|error| Failure::file("use", folder, &error))?;
    let known =
        |entry: &std::fs::DirEntry| own_files().any(|name| entry.file_name().as_os_str() == name);
    let program = PROGRAM.split(' ').next().unwrap_or(PROGRAM);
    let marked = || {
        let text = std::fs::read(folder.join(TIMELINE)).unwrap_or_default();
        let value: Value = serde_json::from_slice(&text).unwrap_or_default();
        value["program"].as_str().is_some_and(|name| name.starts_with(program))
    };
    let ours = entries.is_empty() || (entries.iter().all(known) && marked());
    if ours || force {
        return Ok(ours);
    }
    Err(Failure::Input(format!(
        "{} is not empty and plan did not write it: an empty or new folder is needed (or --force, \
         which overwrites {} there)",
        folder.display(),
        ALWAYS.join(", ")
    )))
}

/// Removes products of an earlier plan that this one does not have: they would contradict it.
fn remove_stale(folder: &Path, written: &[&str]) -> Result<(), Failure> {
    for name in own_files().filter(|name| !written.contains(name)) {
        let path = folder.join(name);
        if path.exists() {
            std::fs::remove_file(&path).map_err(|error| Failure::file("remove", &path, &error))?;
        }
    }
    Ok(())
}

/// The schedule, and what its rules' giving way would bring; rules that contradict each other fail in
/// words.
fn scheduled(
    world: &World,
    problem: &Problem,
    limit: &SearchLimit,
) -> Result<(Schedule, Vec<Loosening>), Failure> {
    let (schedule, loosened) =
        rayon::join(|| schedule_until(problem, limit), || loosen(problem, limit));
    let failure = |error| match error {
        ScheduleError::Infeasible(conflict) => Failure::Check(contradiction(world, &conflict)),
        error @ ScheduleError::Unsound(_) => Failure::internal(error),
        error @ ScheduleError::NotFound => Failure::Check(error.to_string()),
        error => Failure::input(error),
    };
    Ok((schedule.map_err(failure)?, loosened.map_err(failure)?))
}

/// What the options ask of the schedule.
struct Wishes<'w> {
    arguments: &'w RevisionArgs,
    /// In seconds.
    time_limit: Option<f64>,
    frozen_until: Option<Instant>,
    earlier: Option<Earlier>,
}

impl<'w> Wishes<'w> {
    fn read(arguments: &'w RevisionArgs, world: &World) -> Result<Self, Failure> {
        if let Some(price) = arguments.change_price.filter(|it| !(0.0..=1e12).contains(it)) {
            return Err(Failure::Input(format!(
                "--change-price {price}: a number from 0 to 1e12 is needed"
            )));
        }
        let earlier = arguments.against.as_ref().map(|path| Earlier::read(path, world));
        Ok(Self {
            arguments,
            time_limit: arguments.time_limit.as_deref().map(time_limit).transpose()?,
            frozen_until: arguments.freeze_until.as_deref().map(frozen_until).transpose()?,
            earlier: earlier.transpose()?,
        })
    }

    fn ask(
        &self,
        world: &World,
        opportunities: &Opportunities,
        problem: &mut Problem,
    ) -> Result<(), Failure> {
        let ids = opportunities.list().iter().map(|it| session_id(world, it));
        let revision = Revision {
            earlier: self.earlier.as_ref(),
            change_price: self.arguments.change_price,
            frozen_until: self.frozen_until,
            fixed: &self.arguments.fix,
            forbidden: &self.arguments.forbid,
        };
        revision.ask(&ids.collect::<Vec<_>>(), problem)
    }

    /// What a timeline changes, which it is told.
    fn difference(&self, timeline: &mut Timeline) -> Option<Difference> {
        let earlier = self.earlier.as_ref()?;
        let difference = earlier.difference(timeline);
        timeline.against = Some(difference.by_ids(&earlier.sha256));
        Some(difference)
    }
}

/// The seconds of `--time-limit`.
fn time_limit(text: &str) -> Result<f64, Failure> {
    let option = |error: String| Failure::Input(format!("--time-limit: {error}"));
    let exact = quantity::seconds(text).map_err(|error| option(error.to_string()))?;
    let seconds = rounding::duration(&exact).map(Duration::seconds);
    seconds
        .filter(|it| (0.0..=1e9).contains(it))
        .ok_or_else(|| option(format!("{text} is not a duration from 0 s to 1e9 s")))
}

/// The instant of `--freeze-until`.
fn frozen_until(text: &str) -> Result<Instant, Failure> {
    parse_time(text).map_err(|error| Failure::Input(format!("--freeze-until: {error}")))
}

/// A contradiction among the rules, and the least change that would end it.
fn contradiction(world: &World, conflict: &Conflict) -> String {
    let named = |rule: &RuleName| match rule {
        RuleName::Fixed | RuleName::Forbidden => format!("the {rule}"),
        _ => format!("calibration.schedule.{rule}"),
    };
    let rules: Vec<String> = conflict.rules.iter().map(named).collect();
    let place = conflict.season.map_or_else(String::new, |(target, telescope, from)| {
        format!(
            " of {} on {} in the season from {} UTC",
            world.targets[target].name(),
            world.mission.telescopes[telescope].name,
            date(from)
        )
    });
    format!(
        "no schedule meets {} together: of the {} sessions asked for{place}, at most {} can be had; \
         asking for {} fewer, or leaving out any one of these rules, ends the contradiction",
        rules.join(", "),
        conflict.wanted,
        conflict.possible,
        conflict.wanted.saturating_sub(conflict.possible)
    )
}

pub(super) fn problem(world: &World, opportunities: &Opportunities, demands: Demands) -> Problem {
    let keys = &world.mission.calibration.schedule;
    let candidates = opportunities
        .list()
        .iter()
        .map(|it| Candidate {
            target: it.target,
            telescope: it.telescope,
            first_entry: it.first_entry,
            last_exit: it.last_exit,
            dwell: it.dwell,
        })
        .collect();
    Problem {
        span: (world.start, world.end),
        candidates,
        weights: world.targets.iter().map(|source| keys.weight(source.name())).collect(),
        rules: Rules {
            setup: keys.setup(),
            cooldown: keys.cooldown(),
            exclusive: match keys.exclusive {
                ExclusiveKey::Telescope => Exclusive::Telescope,
                ExclusiveKey::All => Exclusive::All,
            },
            max_per_day: keys.max_per_day(),
            max_sessions: keys
                .max_sessions
                .as_ref()
                .map(|it| SessionCount { count: it.count, window: it.window() }),
            day_boundaries: midnights(world.start, world.end),
        },
        demands,
    }
}

/// UTC midnights around and within the mission.
fn midnights(start: Instant, end: Instant) -> Vec<Instant> {
    (utc_day(start)..=utc_day(end) + 1).map(utc_midnight).collect()
}

/// Sessions, their hours, and what was on offer, per target.
struct Share<'w> {
    target: &'w str,
    sessions: usize,
    hours: f64,
    opportunities: usize,
    hours_offered: f64,
}

fn shares<'w>(
    world: &'w World,
    timeline: &Timeline,
    opportunities: &Opportunities,
) -> Vec<Share<'w>> {
    let share = |(index, target): (usize, &'w ephem::source::Source)| {
        let sessions = || timeline.sessions.iter().filter(|it| it.target == target.name());
        let offered = || opportunities.list().iter().filter(|it| it.target == index);
        Share {
            target: target.name(),
            sessions: sessions().count(),
            hours: total(sessions().map(|it| it.dwell_s)) / 3600.0,
            opportunities: offered().count(),
            hours_offered: total(offered().map(|it| it.dwell.seconds())) / 3600.0,
        }
    };
    world.targets.iter().enumerate().map(share).collect()
}

/// A sum that is +0 where there is nothing to add.
fn total(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |sum, number| sum + number)
}

fn summary(world: &World, timeline: &Timeline, opportunities: &Opportunities) -> Value {
    let shares = shares(world, timeline, opportunities);
    let by_target = |pick: &dyn Fn(&Share<'_>) -> Value| {
        shares.iter().map(|it| (it.target.to_owned(), pick(it))).collect::<Map<_, _>>()
    };
    json!({
        "provenance": timeline.provenance,
        "sessions": timeline.sessions.len(),
        "sessions_by_target": by_target(&|it| json!(it.sessions)),
        "hours_by_target": by_target(&|it| json!(it.hours)),
        "opportunities": opportunities.list().len(),
        "objective": timeline.objective,
        "upper_bound": timeline.upper_bound,
        "gap": timeline.gap,
        "stopped": timeline.stopped,
        "against": timeline.against,
        "resonance": timeline.resonance,
    })
}

fn told(
    world: &World,
    timeline: &Timeline,
    opportunities: &Opportunities,
    (folder, files): (&Path, &[&str]),
    resonance: Option<&Resonance>,
) -> String {
    let mission = &world.mission;
    let mut text = String::new();
    if let Some(Resonance { checked, recommended }) = resonance
        && !checked.certificate.passes
    {
        let _ = writeln!(text, "RESONANCE: {}", checked.sentence());
        if let Some(nearby) = recommended.map(|it| it.quietest) {
            let _ = writeln!(
                text,
                "nearby, {:.4} min has the smallest bound: {:.2} % above the floor",
                minutes(nearby.precession_period_s),
                100.0 * nearby.certificate.excess
            );
        }
        text.push('\n');
    }
    let _ = write!(
        text,
        "{}: calibration timeline, {} for {} days\nkernel {}, trajectory {}\n\n",
        mission.name,
        mission.span.start.text(),
        mission.span.duration_days,
        timeline.provenance.kernel,
        timeline.provenance.trajectory
    );
    let _ = writeln!(
        text,
        "{:<12} {:>9} {:>10} {:>14} {:>14}",
        "target", "sessions", "hours", "opportunities", "hours offered"
    );
    let mut total =
        Share { target: "total", sessions: 0, hours: 0.0, opportunities: 0, hours_offered: 0.0 };
    let row = |text: &mut String, it: &Share<'_>| {
        let _ = writeln!(
            text,
            "{:<12} {:>9} {:>10.2} {:>14} {:>14.2}",
            it.target, it.sessions, it.hours, it.opportunities, it.hours_offered
        );
    };
    for share in shares(world, timeline, opportunities) {
        row(&mut text, &share);
        total.sessions += share.sessions;
        total.hours += share.hours;
        total.opportunities += share.opportunities;
        total.hours_offered += share.hours_offered;
    }
    row(&mut text, &total);
    let _ = writeln!(
        text,
        "\nobjective {:.1}, no schedule exceeds {:.1}: gap {:.3} %\n({})\n",
        timeline.objective,
        timeline.upper_bound,
        100.0 * timeline.gap,
        timeline.stopped
    );
    if let Some(Resonance { checked, .. }) = resonance.filter(|it| it.checked.certificate.passes) {
        let _ = writeln!(text, "resonance: {}\n", checked.sentence());
    }
    if let Some(it) = &timeline.against {
        let (added, dropped, moved) = (it.added.len(), it.dropped.len(), it.moved.len());
        let _ = writeln!(
            text,
            "against the earlier plan: {added} added, {dropped} dropped, {moved} moved, {} kept\n",
            it.kept
        );
    }
    first_weeks(&mut text, world, timeline);
    let _ = writeln!(text, "\nwritten to {}: {}", folder.display(), files.join(", "));
    text
}

/// The sessions that start in the first two weeks.
fn first_weeks(text: &mut String, world: &World, timeline: &Timeline) {
    let until = world.start.plus(SHOWN).tai_ns();
    let shown: Vec<_> = timeline.sessions.iter().filter(|it| it.start_tai_ns < until).collect();
    let _ = writeln!(
        text,
        "first two weeks (UTC): {} sessions\n{:<17} {:<17} {:<10} {:<12} {:>6} {:>9}",
        shown.len(),
        "start",
        "end",
        "telescope",
        "target",
        "passes",
        "dwell (s)"
    );
    let minute = |time: &str| time.get(..16).unwrap_or(time).replace('T', " ");
    for it in shown {
        let _ = writeln!(
            text,
            "{:<17} {:<17} {:<10} {:<12} {:>6} {:>9.1}",
            minute(&it.start_utc),
            minute(&it.end_utc),
            it.telescope,
            it.target,
            it.transits.len(),
            it.dwell_s
        );
    }
}
