//! What `plan` says: sessions, hours, objective, the first two weeks.

use ephem::time::format_tdb;
use formats::forecast::{Required, Taught};
use formats::resonance::{minutes, sentence};
use formats::timeline::{Idle, Timeline};
use onboard_core::time::Duration;
use planner::opportunities::Opportunities;
use planner::resonance::check::Resonances;
use planner::world::World;
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::Path;

/// How much of the timeline is printed.
const SHOWN: Duration = Duration::from_ns(14 * 86_400 * 1_000_000_000);

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

/// What is told of.
#[derive(Clone, Copy)]
pub(super) struct Summed<'p> {
    pub(super) world: &'p World,
    pub(super) timeline: &'p Timeline,
    pub(super) opportunities: &'p Opportunities,
    pub(super) taught: &'p Taught<'p>,
}

/// For a program.
pub(super) fn summary(summed: &Summed<'_>) -> Value {
    let Summed { world, timeline, opportunities, taught } = *summed;
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
        "alerts": taught.alerts(),
        "requirements": taught.required.iter().map(Required::json).collect::<Vec<_>>(),
        "longest_gaps": taught.idle.iter().map(Idle::json).collect::<Vec<_>>(),
    })
}

/// For a person.
pub(super) fn told(
    summed: &Summed<'_>,
    (folder, files): (&Path, &[&str]),
    resonance: Option<&Resonances>,
) -> String {
    let Summed { world, timeline, opportunities, taught } = *summed;
    let mission = &world.mission;
    let mut text = String::new();
    let alerts = taught.alerts();
    for it in &alerts {
        let _ = writeln!(text, "ALERT: {it}");
    }
    if !alerts.is_empty() {
        text.push('\n');
    }
    if let Some(Resonances { checked, recommended }) = resonance
        && !checked.certificate.passes
    {
        let _ = writeln!(text, "RESONANCE: {}", sentence(checked));
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
        "{}: calibration timeline, {}\nkernel {}, trajectory {}\n\n",
        mission.name,
        span(world),
        timeline.provenance.kernel,
        timeline.provenance.trajectory
    );
    if !taught.required.is_empty() {
        text.push_str("requirements:\n");
        for it in &taught.required {
            let _ = writeln!(text, "  {}: {}", it.name(), it.sentence());
        }
        text.push('\n');
    }
    for it in &taught.idle {
        let _ =
            writeln!(text, "{:<12} {:>9} sessions; {}", it.telescope, it.sessions, it.sentence());
    }
    if !taught.idle.is_empty() {
        text.push('\n');
    }
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
    if let Some(Resonances { checked, .. }) = resonance.filter(|it| it.checked.certificate.passes) {
        let _ = writeln!(text, "resonance: {}\n", sentence(checked));
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

/// The mission's span, or its window.
fn span(world: &World) -> String {
    let mission = &world.mission.span;
    let whole = format!("{} for {} days", mission.start.text(), mission.duration_days);
    if world.mission_span() == (world.start, world.end) {
        return whole;
    }
    format!("{} to {} TDB of {whole}", format_tdb(world.start), format_tdb(world.end))
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
