//! The demands of a mission file on its schedule, as the scheduler takes them.
//!
//! Method: crossing angles of passes are those at closest approach. An opportunity counts as too near
//! to a body to avoid where, at the entry, the closest approach or the exit of any of its passes, the
//! body stands nearer to that line of sight than its limit. Contacts and blackouts are read from CSV
//! files with a header (`start_utc, end_utc, bit_s`; `start_utc, end_utc, reason`), lines beginning
//! with `#` left out; blackouts also from an iCalendar file ([`crate::calendar`]).
//!
//! Limits: between these three instants of a pass a body to avoid may come nearer by what the line of
//! sight moves.

use crate::calendar::{self, Occasion};
use crate::failure::Failure;
use crate::mission::FilePath;
use crate::passes::{Found, Offers, told};
use crate::purposes::{Parts, Valued, Worth};
use crate::world::World;
use ephem::time::{format_utc, parse_time};
use onboard_core::attitude::sweep;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::sun::SunModel;
use onboard_core::time::{Duration, Instant};
use planner::opportunity::Opportunity;
use planner::schedule::{
    Contact, Data, Demands, Diversity, Log, LongestGap, SessionCount, Thermal,
};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Ranges of an angle in the logarithmic objective.
const BINS: u32 = 16;
/// Time in view that counts as one unit of information, in seconds.
const OFFSET_S: f64 = 600.0;
/// Length of an epoch of the logarithmic objective, in days: a quarter of a year.
const EPOCH_DAYS: f64 = 91.3125;
const DAY_S: f64 = 86_400.0;

/// A time when nothing is allowed, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Blackout {
    /// Its start.
    pub from: Instant,
    /// Its end.
    pub until: Instant,
    /// Why.
    pub reason: String,
}

/// What the scheduler's demands are made from.
#[derive(Debug, Clone, Copy)]
pub struct Sources<'s> {
    /// The mission among the planets.
    pub world: &'s World,
    /// What it offers: lines of sight, passes, opportunities.
    pub offers: &'s Offers,
    /// The Sun model that attitudes follow.
    pub sun: SunModel<'s>,
    /// The directions of its targets.
    pub table: EphemerisTable<'s>,
}

impl Sources<'_> {
    /// The demands of the mission's keys.
    ///
    /// # Errors
    /// [`Failure::Input`] names the file and line that cannot be used.
    pub fn demands(&self, blackouts: &[Blackout]) -> Result<Demands, Failure> {
        let keys = &self.world.mission.calibration.schedule;
        let angles = if keys.scan_angle.is_empty() && !keys.logarithmic {
            Vec::new()
        } else {
            self.angles()?
        };
        let worth = self.worth()?;
        let values = if worth.each.is_empty() { Vec::new() } else { self.values(&worth) };
        let diversity = keys.scan_angle.iter().map(|rule| Diversity {
            n: rule.n,
            rho: rule.rho.to_f64(),
            sums: self.resultants(&angles, rule.n),
        });
        let data = keys.data.as_ref().map(|data| -> Result<Data, Failure> {
            Ok(Data {
                // Rounded so that the memory is never taken for larger than it is.
                rate_bit_s: whole(data.rate_bit_s.to_f64().ceil()),
                memory_bit: whole(data.memory_bit.to_f64().floor()),
                contacts: contacts(self.world, &data.contacts)?,
            })
        });
        Ok(Demands {
            min_sessions: keys
                .min_sessions
                .as_ref()
                .map(|it| SessionCount { count: it.count, window: it.window() }),
            longest_gap: keys.longest_gain_gap.as_ref().map(|it| LongestGap {
                longest: Duration::from_seconds(it.days.to_f64() * DAY_S),
                price_per_day: it.price_per_day.to_f64(),
            }),
            diversity: diversity.collect(),
            data: data.transpose()?,
            thermal: keys.thermal.as_ref().map(|it| Thermal {
                most: Duration::from_seconds(it.minutes.to_f64() * 60.0),
                window: Duration::from_seconds(it.window_hours.to_f64() * 3600.0),
            }),
            blackouts: blackouts.iter().map(|it| (it.from, it.until)).collect(),
            avoided: self.avoided()?,
            log: keys.logarithmic.then(|| Log {
                offset: Duration::from_seconds(OFFSET_S),
                epoch: Duration::from_seconds(EPOCH_DAYS * DAY_S),
                parts: self.bins(&angles, &worth),
                weights: worth.weights,
            }),
            values,
            ..Demands::default()
        })
    }

    /// The crossing angle of each pass.
    fn angles(&self) -> Result<Vec<f64>, Failure> {
        let angle = |it: &Found| {
            let rotation = self.offers.lines[it.line].rotation;
            sweep(&self.world.scan, &self.sun, rotation, it.transit.closest)
                .map(|seen| seen.crossing_angle_rad)
                .map_err(|error| Failure::internal(told(error)))
        };
        self.offers.found.par_iter().map(angle).collect()
    }

    /// Per opportunity, the sums of w, w cos(n psi), w sin(n psi), w the time of a pass.
    fn resultants(&self, angles: &[f64], n: u32) -> Vec<[f64; 3]> {
        let of = |it| {
            let passes = self.offers.opportunities.passes(it).iter();
            passes.fold([0.0; 3], |[w, c, s], &pass| {
                let time = self.offers.found[pass].transit.dwell().seconds();
                let (sin, cos) = (f64::from(n) * angles[pass]).sin_cos();
                [w + time, c + time * cos, s + time * sin]
            })
        };
        self.offers.opportunities.list().iter().map(of).collect()
    }

    /// Per opportunity, what it is worth by purposes, or weight times dwell.
    fn values(&self, worth: &Worth) -> Vec<f64> {
        let keys = &self.world.mission.calibration.schedule;
        let of = |(it, valued): (&Opportunity, &Option<Valued>)| match valued {
            Some(valued) => valued.value,
            None => keys.weight(self.world.targets[it.target].name()) * it.dwell.seconds(),
        };
        self.offers.opportunities.list().iter().zip(&worth.each).map(of).collect()
    }

    /// Per opportunity, the time in each bin: of the crossing angle, or of its purposes.
    fn bins(&self, angles: &[f64], worth: &Worth) -> Vec<Parts> {
        let of = |(index, it): (usize, &Opportunity)| {
            if let Some(Some(valued)) = worth.each.get(index) {
                return valued.parts.clone();
            }
            let mut parts: Vec<(u32, Duration)> = Vec::new();
            for &pass in self.offers.opportunities.passes(it) {
                let (bin, time) =
                    (angle_bin(angles[pass]), self.offers.found[pass].transit.dwell());
                match parts.iter_mut().find(|part| part.0 == bin) {
                    Some(part) => part.1 = Duration::from_ns(part.1.ns() + time.ns()),
                    None => parts.push((bin, time)),
                }
            }
            parts
        };
        self.offers.opportunities.list().iter().enumerate().map(of).collect()
    }

    /// Opportunities with a pass too near to a body to avoid.
    fn avoided(&self) -> Result<Vec<usize>, Failure> {
        if self.world.avoided.is_empty() {
            return Ok(Vec::new());
        }
        let near = |pass: usize| -> Result<bool, Failure> {
            let found = &self.offers.found[pass];
            let transit = &found.transit;
            for at in [transit.entry, transit.closest, transit.exit] {
                let rotation = self.offers.lines[found.line].rotation;
                let sight = sweep(&self.world.scan, &self.sun, rotation, at)
                    .map_err(|error| Failure::internal(told(error)))?
                    .direction;
                for (source, limit) in &self.world.avoided {
                    let body = self.world.sky.direction(source, at).map_err(Failure::input)?;
                    if sight.separation_rad(body) < *limit {
                        return Ok(true);
                    }
                }
            }
            Ok(false)
        };
        let list = self.offers.opportunities.list();
        let all: Result<Vec<bool>, Failure> = list
            .par_iter()
            .map(|it| {
                for &pass in self.offers.opportunities.passes(it) {
                    if near(pass)? {
                        return Ok(true);
                    }
                }
                Ok(false)
            })
            .collect();
        Ok(all?.into_iter().enumerate().filter_map(|(index, near)| near.then_some(index)).collect())
    }
}

/// The range of an angle, of 16 from -180 deg on.
pub(crate) fn angle_bin(angle_rad: f64) -> u32 {
    let turn = (angle_rad + PI).rem_euclid(TAU) / TAU;
    (0..BINS).rfind(|&bin| f64::from(bin) <= turn * f64::from(BINS)).unwrap_or(0)
}

/// A number that a range has checked, as a whole one.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "not negative and at most 1e21, above which it saturates"
)]
const fn whole(number: f64) -> u64 {
    number as u64
}

fn text_of(path: &std::path::Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| Failure::file("read", path, &error))
}

/// The rows of a CSV as start, end and a third column, by start; the place of each.
fn rows(
    path: &std::path::Path,
    third: &str,
) -> Result<Vec<(Instant, Instant, String, u64)>, Failure> {
    let text = text_of(path)?;
    let refuse = |line: u64, what: String| {
        Failure::Input(format!("{}, line {line}: {what}", path.display()))
    };
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| refuse(1, error.to_string()))?.clone();
    let names = ["start_utc", "end_utc", third];
    let place = |name: &str| header.iter().position(|it| it == name);
    let [Some(start), Some(end), Some(last)] = names.map(place) else {
        let found = header.iter().collect::<Vec<_>>().join(", ");
        return Err(refuse(1, format!("the header is {found}: {} is needed", names.join(", "))));
    };
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| {
            refuse(error.position().map_or(0, csv::Position::line), error.to_string())
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        let cell = |at: usize| record.get(at).unwrap_or_default();
        let time = |at: usize| {
            parse_time(cell(at))
                .map_err(|error| refuse(line, format!("{}: {error}", header.get(at).unwrap_or(""))))
        };
        let (from, until) = (time(start)?, time(end)?);
        if until <= from {
            let what =
                format!("the end {} does not come after the start {}", cell(end), cell(start));
            return Err(refuse(line, what));
        }
        rows.push((from, until, cell(last).to_owned(), line));
    }
    rows.sort_by_key(|it| (it.0, it.1));
    Ok(rows)
}

/// The ground contacts of a file.
fn contacts(world: &World, file: &FilePath) -> Result<Vec<Contact>, Failure> {
    let path = world.mission.path(file);
    let refuse = |line: u64, what: String| {
        Failure::Input(format!("{}, line {line}: {what}", path.display()))
    };
    let mut contacts: Vec<Contact> = Vec::new();
    for (from, until, rate, line) in rows(&path, "bit_s")? {
        let legal = rate.parse::<f64>().ok().filter(|it| (0.0..=1e18).contains(it));
        let Some(rate) = legal else {
            return Err(refuse(line, format!("bit_s is {rate}: a rate from 0 to 1e18 is needed")));
        };
        if let Some(last) = contacts.last()
            && from < last.until
        {
            return Err(refuse(
                line,
                format!("the contact from {} overlaps the one before it", format_utc(from)),
            ));
        }
        contacts.push(Contact { from, until, bit_s: whole(rate) });
    }
    Ok(contacts)
}

/// The blackouts of a mission, by start; each must touch the mission.
///
/// # Errors
/// [`Failure::Input`] names the file, the line and what is wrong.
pub fn blackouts(world: &World) -> Result<Vec<Blackout>, Failure> {
    let Some(file) = &world.mission.calibration.schedule.blackouts else { return Ok(Vec::new()) };
    let path = world.mission.path(file);
    let is_calendar = path.extension().is_some_and(|it| it.eq_ignore_ascii_case("ics"));
    // A calendar's events have no line of their own.
    let placed: Vec<(Blackout, String)> = if is_calendar {
        events(&path)?.into_iter().map(|it| (it, String::new())).collect()
    } else {
        rows(&path, "reason")?
            .into_iter()
            .map(|(from, until, reason, line)| {
                (Blackout { from, until, reason }, format!(", line {line}"))
            })
            .collect()
    };
    let is_outside = |it: &Blackout| it.until <= world.start || it.from >= world.end;
    if let Some((outside, line)) = placed.iter().find(|it| is_outside(&it.0)) {
        return Err(Failure::Input(format!(
            "{}{line}: the blackout from {} to {} lies outside the mission, {} to {}",
            path.display(),
            format_utc(outside.from),
            format_utc(outside.until),
            format_utc(world.start),
            format_utc(world.end)
        )));
    }
    let mut all: Vec<Blackout> = placed.into_iter().map(|it| it.0).collect();
    all.sort_by(|a, b| (a.from, a.until, &a.reason).cmp(&(b.from, b.until, &b.reason)));
    Ok(all)
}

/// The events of an iCalendar file.
fn events(path: &std::path::Path) -> Result<Vec<Blackout>, Failure> {
    let events = calendar::read(&text_of(path)?)
        .map_err(|what| Failure::Input(format!("{}: {what}", path.display())))?;
    let blackout = |it: Occasion| Blackout { from: it.from, until: it.until, reason: it.summary };
    Ok(events.into_iter().map(blackout).collect())
}
