//! The demands of a mission file on its schedule, as the scheduler takes them.
//!
//! Method: crossing angles of passes are those at closest approach. Which opportunities come too near to
//! a body to avoid is decided by the flight core ([`Judge`]), as the spacecraft decides it: the nearest
//! point of every field that calibrates the telescope counts, over the whole session, setup and cooldown
//! included. Nor is one offered that starts so soon after the tables' validity that it could not be
//! checked. Contacts and blackouts are read from CSV files with a header (`start_utc, end_utc, bit_s`;
//! `start_utc, end_utc, reason`), lines beginning with `#` left out; blackouts also from an iCalendar
//! file ([`mission::occasions`]).
//!
//! Limits: those of the core's search, 2e-11 rad at a limit's edge.

use super::error::DemandError;
use crate::onboard::{AHEAD, Judge, JudgeError, TICK, mission_section, record};
use crate::opportunities::{Found, Opportunity};
use crate::schedule::{Contact, Data, Demands, Diversity, Log, LongestGap, SessionCount, Thermal};
use crate::world::{TableFault, World};
use crate::worth::{Parts, Scene, Valued, Worth, angle_bin};
use mission::FilePath;
use mission::occasions::{self, Blackout, OccasionError};
use onboard_core::attitude::sweep;
use onboard_core::sequencer::SkipReason;
use onboard_core::time::Duration;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Time in view that counts as one unit of information, in seconds.
const OFFSET_S: f64 = 600.0;
/// Length of an epoch of the logarithmic objective, in days: a quarter of a year.
const EPOCH_DAYS: f64 = 91.3125;
const DAY_S: f64 = 86_400.0;

impl Scene<'_> {
    /// The demands of the mission's keys.
    ///
    /// # Errors
    /// [`DemandError`] names the file and line that cannot be used.
    pub(crate) fn demands(&self, blackouts: &[Blackout]) -> Result<Demands, DemandError> {
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
        let (avoided, skipped) = self.disallowed()?;
        let data = keys.data.as_ref().map(|data| -> Result<Data, DemandError> {
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
            avoided,
            skipped,
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
    fn angles(&self) -> Result<Vec<f64>, DemandError> {
        let angle = |it: &Found| {
            let rotation = self.offers.lines[it.line].rotation;
            sweep(&self.world.scan, &self.sun, rotation, it.transit.closest)
                .map(|seen| seen.crossing_angle_rad)
                .map_err(|error| TableFault(error).into())
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

    /// Opportunities that the spacecraft would not begin; why, where that is no body to avoid.
    fn disallowed(&self) -> Result<(Vec<usize>, BTreeMap<usize, SkipReason>), DemandError> {
        let (from, until) = (self.world.start, self.world.end);
        let section = mission_section(self.world).map_err(JudgeError::TooMany)?;
        let judge = Judge::new(&section, self.table, (from, until))?;
        let judged = |it: &Opportunity| -> Result<Option<SkipReason>, DemandError> {
            let session = record(self.world, self.offers, it)?;
            if session.start < from || session.end > until {
                // No session at all: the rules refuse it.
                return Ok(None);
            }
            if let Err(reason) = judge.avoidance(&session) {
                return Ok(Some(reason));
            }
            let since = session.start.since(from);
            let late = since < AHEAD
                && since.ns() <= TICK.ns().saturating_mul(i64::from(judge.ticks(&session)));
            Ok(late.then_some(SkipReason::NotChecked))
        };
        let list = self.offers.opportunities.list();
        let reasons: Result<Vec<_>, DemandError> = list.par_iter().map(judged).collect();
        let mut avoided = Vec::new();
        let mut skipped = BTreeMap::new();
        for (index, reason) in reasons?.into_iter().enumerate() {
            let Some(reason) = reason else { continue };
            avoided.push(index);
            if !matches!(reason, SkipReason::Avoidance(_)) {
                skipped.insert(index, reason);
            }
        }
        Ok((avoided, skipped))
    }
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

/// The ground contacts of a file.
fn contacts(world: &World, file: &FilePath) -> Result<Vec<Contact>, OccasionError> {
    let contacts = occasions::contacts(&world.mission, file)?;
    let contact =
        |it: &occasions::Contact| Contact { from: it.from, until: it.until, bit_s: it.bit_s };
    Ok(contacts.iter().map(contact).collect())
}
