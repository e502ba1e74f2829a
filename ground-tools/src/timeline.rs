//! The calibration timeline: sessions, what was left out and why, how far the rules are used.
//!
//! Built from a schedule over opportunities; written as JSON, as CSV and as the records of the
//! uplink table. Ids name telescope, target and precession turn, so they survive replanning.

use crate::cli::Format;
use crate::degrees;
use crate::demands::Blackout;
use crate::failure::Failure;
use crate::output::WriteError;
use crate::passes::{Found, Offers, told};
use crate::provenance::Provenance;
use crate::resonance_check::Checked;
use crate::rows::{self, Layout};
use crate::signal::{Signal, hwp_coverage, impact_rad, strength};
use crate::world::{World, body};
use ephem::time::{format_tdb, format_utc};
use onboard_core::attitude::sweep;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::hwp::hwp_phase;
use onboard_core::sun::SunModel;
use onboard_core::time::{Duration, Instant};
use onboard_core::uplink::SessionRecord;
use planner::opportunity::Opportunity;
use planner::resonance::Recommendation;
use planner::schedule::{Because, ConstraintUse, Loosening, Problem, Rule, Schedule};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::Write;

/// Everything that a timeline is made from.
#[derive(Debug)]
pub struct Planned<'p> {
    /// The mission among the planets.
    pub world: &'p World,
    /// What it offers: lines of sight, passes, opportunities.
    pub offers: &'p Offers,
    /// The Sun model on the table that goes on board.
    pub sun: SunModel<'p>,
    /// The directions of its targets.
    pub table: EphemerisTable<'p>,
    /// The blackouts, as in the problem's demands.
    pub blackouts: &'p [Blackout],
    /// The scheduling problem.
    pub problem: &'p Problem,
    /// Its schedule.
    pub schedule: &'p Schedule,
    /// What its rules' giving way would bring.
    pub loosened: &'p [Loosening],
    /// Whether its periods beat, where that can be judged.
    pub resonance: Option<&'p Resonance>,
}

/// The check of the mission's periods, and where it fails what else to fly.
#[derive(Debug, Clone, Copy)]
pub struct Resonance {
    /// The check.
    pub checked: Checked,
    /// Periods nearby.
    pub recommended: Option<Recommendation>,
}

/// A timeline, as `timeline.json` holds it.
#[derive(Debug, Serialize, Deserialize)]
pub struct Timeline {
    /// Where it comes from.
    #[serde(flatten)]
    pub provenance: Provenance,
    /// Sum of weight times dwell in seconds.
    pub objective: f64,
    /// No schedule has a larger objective.
    pub upper_bound: f64,
    /// (upper bound - objective) / upper bound.
    pub gap: f64,
    /// Why the search ended.
    pub stopped: String,
    /// What changed against an earlier plan, where one was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub against: Option<Against>,
    /// The sessions by start.
    pub sessions: Vec<Session>,
    /// The opportunities not taken.
    pub rejected: Vec<Rejected>,
    /// How far the rules are used.
    pub constraints: Vec<Constraint>,
    /// What giving way in a rule would bring.
    #[serde(default)]
    pub loosening: Vec<Loosened>,
    /// Whether the periods beat on the sky, as `resonance --json` says it; null where not judged.
    pub resonance: Option<Value>,
}

/// What changed against an earlier plan, by ids.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Against {
    /// SHA-256 of its `timeline.json`.
    pub sha256: String,
    /// Sessions in both at the same times.
    pub kept: usize,
    /// Sessions that it did not have.
    pub added: Vec<String>,
    /// Sessions that only it had.
    pub dropped: Vec<String>,
    /// Sessions in both at other times.
    pub moved: Vec<String>,
}

/// One session.
#[derive(Debug, Serialize, Deserialize)]
pub struct Session {
    /// Telescope, target and precession turn.
    pub id: String,
    /// Target's name.
    pub target: String,
    /// Telescope's name.
    pub telescope: String,
    /// Start, setup included, TDB.
    pub start_tdb: String,
    /// End, cooldown included, TDB.
    pub end_tdb: String,
    /// Start, UTC.
    pub start_utc: String,
    /// End, UTC.
    pub end_utc: String,
    /// Start, ns of TAI.
    pub start_tai_ns: i64,
    /// End, ns of TAI.
    pub end_tai_ns: i64,
    /// The passes by entry.
    pub transits: Vec<SessionTransit>,
    /// Time with the target in view.
    pub dwell_s: f64,
    /// Number of passes.
    #[serde(default)]
    pub passes: usize,
    /// Least impact parameter of its passes.
    #[serde(default)]
    pub impact_min_deg: f64,
    /// Largest impact parameter.
    #[serde(default)]
    pub impact_max_deg: f64,
    /// How evenly its passes cover the phases of the half-wave plate, 0 to 1; null without a plate.
    #[serde(default)]
    pub hwp_coverage: Option<f64>,
    /// How strong the target is.
    #[serde(flatten)]
    pub signal: Signal,
    /// Why it is there.
    pub reason: String,
}

/// One pass of a session.
#[derive(Debug, Serialize, Deserialize)]
pub struct SessionTransit {
    /// Detector's name, or `-` for the field of view.
    pub detector: String,
    /// First instant inside, TDB.
    pub entry_tdb: String,
    /// Last instant inside, TDB.
    pub exit_tdb: String,
    /// First instant inside, ns of TAI.
    pub entry_tai_ns: i64,
    /// Last instant inside, ns of TAI.
    pub exit_tai_ns: i64,
    /// Closest approach, ns of TAI.
    pub closest_tai_ns: i64,
    /// Time inside.
    pub dwell_s: f64,
    /// Separation at closest approach.
    pub min_separation_deg: f64,
    /// Crossing angle at closest approach.
    pub psi_deg: f64,
    /// Scan-beam angle at closest approach.
    #[serde(default)]
    pub scan_beam_angle_deg: f64,
    /// Offset of the target across the scan at closest approach, positive along z x v.
    #[serde(default)]
    pub impact_deg: f64,
    /// Angle of the half-wave plate at closest approach; null without a plate.
    #[serde(default)]
    pub hwp_deg: Option<f64>,
}

/// An opportunity not taken.
#[derive(Debug, Serialize, Deserialize)]
pub struct Rejected {
    /// The id its session would have.
    pub opportunity: String,
    /// The rule that excludes it.
    pub because: String,
}

/// How far a rule is used.
#[derive(Debug, Serialize, Deserialize)]
pub struct Constraint {
    /// The rule and its place.
    pub name: String,
    /// What the schedule uses.
    pub used: f64,
    /// What the rule allows.
    pub limit: f64,
    /// Objective that a small loosening would bring.
    pub shadow_price: f64,
}

/// What giving way in a rule would bring while sessions may be taken in parts.
#[derive(Debug, Serialize, Deserialize)]
pub struct Loosened {
    /// The rule's key.
    pub rule: String,
    /// The step, as in `10 more minutes per day`.
    pub step: String,
    /// What the objective gains.
    pub objective_percent: f64,
    /// What the time in view of each target gains, where it has any.
    pub dwell_percent: BTreeMap<String, f64>,
}

/// The id of an opportunity's session: telescope, target and precession turn.
#[must_use]
pub fn session_id(world: &World, it: &Opportunity) -> String {
    let telescope = &world.mission.telescopes[it.telescope].name;
    format!("{telescope}-{}-{:06}", world.targets[it.target].name(), it.turn)
}

impl Planned<'_> {
    /// The timeline.
    ///
    /// # Errors
    /// [`Failure::Internal`] where the table does not serve its own span.
    pub fn timeline(&self) -> Result<Timeline, Failure> {
        let schedule = self.schedule;
        let sessions = schedule
            .chosen
            .par_iter()
            .map(|&candidate| self.session(candidate))
            .collect::<Result<Vec<_>, Failure>>()?;
        let rejected = schedule
            .rejected
            .par_iter()
            .map(|it| Rejected {
                opportunity: self.id(it.candidate),
                because: self.because(&it.because),
            })
            .collect();
        Ok(Timeline {
            provenance: Provenance::of(self.world),
            objective: schedule.objective,
            upper_bound: schedule.upper_bound,
            gap: schedule.gap,
            stopped: schedule.stopped.to_string(),
            against: None,
            sessions,
            rejected,
            constraints: schedule.constraints.iter().map(|it| self.constraint(it)).collect(),
            loosening: self.loosened.iter().map(|it| self.loosening(it)).collect(),
            resonance: self.resonance.map(|it| it.checked.json(it.recommended.as_ref())),
        })
    }

    /// The sessions as the uplink table holds them.
    ///
    /// # Errors
    /// [`Failure::Input`] where a number exceeds the format.
    pub fn records(&self) -> Result<Vec<SessionRecord>, Failure> {
        self.schedule.chosen.iter().map(|&candidate| self.record(candidate)).collect()
    }

    fn opportunity(&self, candidate: usize) -> &Opportunity {
        &self.offers.opportunities.list()[candidate]
    }

    fn telescope(&self, candidate: usize) -> &str {
        &self.world.mission.telescopes[self.opportunity(candidate).telescope].name
    }

    fn target(&self, candidate: usize) -> &str {
        self.world.targets[self.opportunity(candidate).target].name()
    }

    fn id(&self, candidate: usize) -> String {
        session_id(self.world, self.opportunity(candidate))
    }

    fn session(&self, candidate: usize) -> Result<Session, Failure> {
        let opportunity = self.opportunity(candidate);
        let (start, end) = self.problem.reserved(candidate);
        let keys = &self.world.mission.calibration.schedule;
        let weight = if keys.purposes(self.target(candidate)).is_empty() {
            format!("weight {}", self.problem.weights[opportunity.target])
        } else {
            "weights by purpose".to_owned()
        };
        let dwell_s = opportunity.dwell.seconds();
        let passes = self.offers.opportunities.passes(opportunity);
        let transits = passes
            .iter()
            .map(|&pass| self.transit(&self.offers.found[pass]))
            .collect::<Result<Vec<_>, _>>()?;
        let (impact_min_deg, impact_max_deg) =
            range(transits.iter().map(|it: &SessionTransit| it.impact_deg));
        let found = || passes.iter().map(|&pass| &self.offers.found[pass]);
        let line = found().next().map(|it| &self.offers.lines[it.line]);
        Ok(Session {
            id: self.id(candidate),
            target: self.target(candidate).to_owned(),
            telescope: self.telescope(candidate).to_owned(),
            start_tdb: format_tdb(start),
            end_tdb: format_tdb(end),
            start_utc: format_utc(start),
            end_utc: format_utc(end),
            start_tai_ns: start.tai_ns(),
            end_tai_ns: end.tai_ns(),
            reason: format!(
                "adds {} to the objective: {} passes, {dwell_s} s in view, {weight}",
                self.problem.value(candidate),
                transits.len()
            ),
            passes: transits.len(),
            impact_min_deg,
            impact_max_deg,
            hwp_coverage: line.and_then(|line| hwp_coverage(self.world, line, found())),
            signal: strength(self.world, opportunity)?.into(),
            transits,
            dwell_s,
        })
    }

    fn transit(&self, found: &Found) -> Result<SessionTransit, Failure> {
        let (line, transit) = (&self.offers.lines[found.line], &found.transit);
        let at = transit.closest;
        let outside = |error| Failure::internal(told(error));
        let seen = sweep(&self.world.scan, &self.sun, line.rotation, at).map_err(outside)?;
        let target = body(self.table, self.world.targets[found.target].body())?;
        let target = target.state(at).map_err(outside)?.direction;
        let hwp = line.hwp.map(|plate| hwp_phase(&self.world.scan, plate, at).radians());
        Ok(SessionTransit {
            detector: line.detector_name.clone(),
            entry_tdb: format_tdb(transit.entry),
            exit_tdb: format_tdb(transit.exit),
            entry_tai_ns: transit.entry.tai_ns(),
            exit_tai_ns: transit.exit.tai_ns(),
            closest_tai_ns: at.tai_ns(),
            dwell_s: transit.dwell().seconds(),
            min_separation_deg: transit.min_separation_rad.to_degrees(),
            psi_deg: degrees::signed(seen.crossing_angle_rad),
            scan_beam_angle_deg: degrees::signed(seen.scan_beam_angle_rad),
            impact_deg: impact_rad(&seen, target).to_degrees(),
            hwp_deg: hwp.map(degrees::positive),
        })
    }

    fn record(&self, candidate: usize) -> Result<SessionRecord, Failure> {
        let opportunity = self.opportunity(candidate);
        let (start, end) = self.problem.reserved(candidate);
        let too_large = |what: &str| {
            Failure::Input(format!("the uplink table cannot hold the {what} of a session"))
        };
        let passes = self.offers.opportunities.passes(opportunity).len();
        Ok(SessionRecord {
            start,
            end,
            first_entry: opportunity.first_entry,
            last_exit: opportunity.last_exit,
            body: self.world.targets[opportunity.target].body(),
            turn: u32::try_from(opportunity.turn).map_err(|_| too_large("precession turn"))?,
            telescope: u16::try_from(opportunity.telescope).map_err(|_| too_large("telescope"))?,
            passes: u16::try_from(passes).unwrap_or(u16::MAX),
        })
    }

    /// The UTC date on which a day of the schedule begins.
    fn date(&self, day: usize) -> String {
        let midnight = self.problem.rules.day_boundaries.get(day);
        midnight.map_or_else(String::new, |at| date(*at))
    }

    fn because(&self, because: &Because) -> String {
        match *because {
            Because::Conflict { with } => format!("it overlaps the session {}", self.id(with)),
            Because::DayFull { day, needs, left } => format!(
                "it needs {} min of {} UTC, which has {} min left",
                minutes(needs),
                self.date(day),
                minutes(left)
            ),
            Because::TooLongForDay { day, needs } => format!(
                "its session alone needs {} min of {} UTC, more than max_minutes_per_day",
                minutes(needs),
                self.date(day)
            ),
            Because::SessionCount { from, count } => format!(
                "the window from {} already holds {count} sessions, as many as max_sessions allows",
                format_utc(from)
            ),
            Because::Blackout { index } => {
                let it = &self.blackouts[index];
                format!(
                    "it touches the blackout from {} to {}: {}",
                    format_utc(it.from),
                    format_utc(it.until),
                    it.reason
                )
            }
            Because::NoValue
            | Because::BeforeMission
            | Because::AfterMission
            | Because::Avoided
            | Because::Forbidden
            | Because::Thermal
            | Because::Memory
            | Because::ScanAngle { .. }
            | Because::NotWorth => because.to_string(),
        }
    }

    fn loosening(&self, it: &Loosening) -> Loosened {
        let names = self.world.targets.iter().map(|target| target.name().to_owned());
        let dwell = names.zip(&it.dwell);
        Loosened {
            rule: it.give.rule().to_owned(),
            step: it.give.to_string(),
            objective_percent: percent(it.objective),
            dwell_percent: dwell
                .filter_map(|(name, share)| Some((name, percent((*share)?))))
                .collect(),
        }
    }

    fn constraint(&self, it: &ConstraintUse) -> Constraint {
        let name = match it.rule {
            Rule::Exclusive { telescope: None } => "exclusive all".to_owned(),
            Rule::Exclusive { telescope: Some(index) } => {
                format!("exclusive {} (s)", self.world.mission.telescopes[index].name)
            }
            Rule::Day { day } => format!("max_minutes_per_day {} (s)", self.date(day)),
            Rule::SessionCount { from } => format!("max_sessions from {}", format_utc(from)),
            Rule::MinSessions { target, telescope, from } => {
                format!("min_sessions {} from {}", self.pair(target, telescope), format_utc(from))
            }
            Rule::Gap { telescope, from } => format!(
                "longest_gain_gap {} from {} (days)",
                self.world.mission.telescopes[telescope].name,
                format_utc(from)
            ),
            Rule::Thermal { from } => format!("thermal from {} (s)", format_utc(from)),
            Rule::Memory { from, until } => {
                format!("data from {} to {} (s)", format_utc(from), format_utc(until))
            }
            Rule::ScanAngle { n, target, telescope } => {
                format!("scan_angle n = {n} {}", self.pair(target, telescope))
            }
        };
        Constraint { name, used: it.used, limit: it.limit, shadow_price: it.shadow_price }
    }
}

impl Planned<'_> {
    /// `target on TELESCOPE`.
    fn pair(&self, target: usize, telescope: usize) -> String {
        let telescope = &self.world.mission.telescopes[telescope].name;
        format!("{} on {telescope}", self.world.targets[target].name())
    }
}

/// Least and largest of some numbers.
pub(crate) fn range(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| (low.min(it), high.max(it)))
}

/// The date of an instant, UTC.
pub(crate) fn date(at: Instant) -> String {
    format_utc(at).chars().take_while(|letter| *letter != 'T').collect()
}

/// A share in percent, to the hundredths that the relaxation is good for.
fn percent(share: f64) -> f64 {
    let hundredths = (share * 1e4).round();
    // No negative zero.
    if hundredths == 0.0 { 0.0 } else { hundredths / 100.0 }
}

/// Minutes to a tenth, for sentences.
fn minutes(span: Duration) -> String {
    format!("{:.1}", span.seconds() / 60.0)
}

#[derive(Serialize)]
struct Row<'t> {
    id: &'t str,
    target: &'t str,
    telescope: &'t str,
    start_utc: &'t str,
    end_utc: &'t str,
    start_tdb: &'t str,
    end_tdb: &'t str,
    start_tai_ns: i64,
    end_tai_ns: i64,
    passes: usize,
    dwell_s: f64,
    impact_min_deg: f64,
    impact_max_deg: f64,
    hwp_coverage: Option<f64>,
    angular_diameter_arcsec: Option<f64>,
    brightness_temperature_k: Option<f64>,
    beam_dilution: Option<f64>,
    antenna_temperature_mk: Option<f64>,
    polarised_temperature_mk: Option<f64>,
    reason: &'t str,
}

const COLUMNS: [&str; 20] = [
    "id",
    "target",
    "telescope",
    "start_utc",
    "end_utc",
    "start_tdb",
    "end_tdb",
    "start_tai_ns",
    "end_tai_ns",
    "passes",
    "dwell_s",
    "impact_min_deg",
    "impact_max_deg",
    "hwp_coverage",
    "angular_diameter_arcsec",
    "brightness_temperature_k",
    "beam_dilution",
    "antenna_temperature_mk",
    "polarised_temperature_mk",
    "reason",
];

impl Timeline {
    /// `timeline.json`.
    ///
    /// # Errors
    /// [`Failure::Internal`] where it cannot be written.
    pub fn to_json(&self) -> Result<Vec<u8>, Failure> {
        let mut bytes = Vec::new();
        let indent = serde_json::ser::PrettyFormatter::with_indent(b" ");
        let mut writer = serde_json::Serializer::with_formatter(&mut bytes, indent);
        self.serialize(&mut writer).map_err(Failure::internal)?;
        bytes.push(b'\n');
        Ok(bytes)
    }

    /// `timeline.csv`.
    ///
    /// # Errors
    /// [`Failure::Internal`] where it cannot be written.
    pub fn to_csv(&self) -> Result<Vec<u8>, Failure> {
        let mut bytes = Vec::new();
        self.write_table(&mut bytes, Format::Csv).map_err(|error| match error {
            WriteError::Io(error) => Failure::internal(error),
            WriteError::Failed(failure) => failure,
        })?;
        Ok(bytes)
    }

    /// A row per session.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write_table(&self, out: &mut dyn Write, format: Format) -> Result<(), WriteError> {
        let rows = self.sessions.iter().map(|it| Row {
            id: &it.id,
            target: &it.target,
            telescope: &it.telescope,
            start_utc: &it.start_utc,
            end_utc: &it.end_utc,
            start_tdb: &it.start_tdb,
            end_tdb: &it.end_tdb,
            start_tai_ns: it.start_tai_ns,
            end_tai_ns: it.end_tai_ns,
            passes: it.transits.len(),
            dwell_s: it.dwell_s,
            impact_min_deg: it.impact_min_deg,
            impact_max_deg: it.impact_max_deg,
            hwp_coverage: it.hwp_coverage,
            angular_diameter_arcsec: it.signal.angular_diameter_arcsec,
            brightness_temperature_k: it.signal.brightness_temperature_k,
            beam_dilution: it.signal.beam_dilution,
            antenna_temperature_mk: it.signal.antenna_temperature_mk,
            polarised_temperature_mk: it.signal.polarised_temperature_mk,
            reason: &it.reason,
        });
        let layout = Layout { format, provenance: &self.provenance, header: &COLUMNS };
        rows::write(out, rows.map(Ok), &layout).map(|_| ())
    }
}
