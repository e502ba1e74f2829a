//! A plan as a timeline.

use super::types::{Rejected, Session, SessionTransit, Timeline};
use super::words::Words;
use crate::degrees;
use crate::resonance;
use ephem::time::{format_tdb, format_utc};
use planner::plan::{self, Plan, SessionPass};
use planner::provenance::Provenance;
use planner::resonance::check::Resonances;
use planner::world::World;
use planner::worth::WorthError;
use rayon::prelude::*;

/// The timeline of a plan; `resonances` is the check of its periods, where one could be made.
///
/// # Errors
/// [`WorthError`] where tables or ephemeris do not serve the mission's own span.
pub fn timeline(
    world: &World,
    plan: &Plan,
    resonances: Option<&Resonances>,
) -> Result<Timeline, WorthError> {
    let schedule = &plan.schedule;
    let words = Words { world, offered: &plan.offered };
    let rejected = schedule
        .rejected
        .par_iter()
        .map(|it| Rejected {
            opportunity: plan.offered.id(world, it.candidate),
            because: words.because(&it.because),
        })
        .collect();
    Ok(Timeline {
        provenance: Provenance::of(world),
        objective: schedule.objective,
        upper_bound: schedule.upper_bound,
        gap: schedule.gap,
        stopped: schedule.stopped.to_string(),
        against: None,
        sessions: plan.sessions(world)?.iter().map(|it| session(world, it)).collect(),
        rejected,
        constraints: schedule.constraints.iter().map(|it| words.constraint(it)).collect(),
        loosening: plan.loosened.iter().map(|it| words.loosening(it)).collect(),
        resonance: resonances.map(|it| resonance::json(&it.checked, it.recommended.as_ref())),
    })
}

fn session(world: &World, it: &plan::Session) -> Session {
    let keys = &world.mission.calibration.schedule;
    let weight = if keys.purposes(&it.target).is_empty() {
        format!("weight {}", keys.weight(&it.target))
    } else {
        "weights by purpose".to_owned()
    };
    let dwell_s = it.dwell.seconds();
    let transits: Vec<SessionTransit> = it.passes.iter().map(transit).collect();
    let (impact_min_deg, impact_max_deg) = range(transits.iter().map(|it| it.impact_deg));
    Session {
        id: it.id.clone(),
        target: it.target.clone(),
        telescope: it.telescope.clone(),
        start_tdb: format_tdb(it.start),
        end_tdb: format_tdb(it.end),
        start_utc: format_utc(it.start),
        end_utc: format_utc(it.end),
        start_tai_ns: it.start.tai_ns(),
        end_tai_ns: it.end.tai_ns(),
        reason: format!(
            "adds {} to the objective: {} passes, {dwell_s} s in view, {weight}",
            it.value,
            transits.len()
        ),
        passes: transits.len(),
        impact_min_deg,
        impact_max_deg,
        hwp_coverage: it.hwp_coverage,
        signal: it.strength.into(),
        transits,
        dwell_s,
    }
}

fn transit(it: &SessionPass) -> SessionTransit {
    let transit = &it.transit;
    SessionTransit {
        detector: it.detector.clone(),
        entry_tdb: format_tdb(transit.entry),
        exit_tdb: format_tdb(transit.exit),
        entry_tai_ns: transit.entry.tai_ns(),
        exit_tai_ns: transit.exit.tai_ns(),
        closest_tai_ns: transit.closest.tai_ns(),
        dwell_s: transit.dwell().seconds(),
        min_separation_deg: transit.min_separation_rad.to_degrees(),
        psi_deg: degrees::signed(it.crossing_angle_rad),
        scan_beam_angle_deg: degrees::signed(it.scan_beam_angle_rad),
        impact_deg: it.impact_rad.to_degrees(),
        hwp_deg: it.hwp_rad.map(degrees::positive),
    }
}

/// Least and largest of some numbers.
fn range(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| (low.min(it), high.max(it)))
}
