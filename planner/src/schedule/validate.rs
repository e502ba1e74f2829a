//! Is a problem well posed: numbers within range, lists of one length, candidates that exist.

use super::demands::Demands;
use super::error::ScheduleError;
use super::problem::{MAX_CANDIDATES, Problem};
use onboard_core::time::Duration;

impl Problem {
    /// Whether the problem is well posed; the first fault.
    pub(super) fn validate(&self) -> Result<(), ScheduleError> {
        let rules = &self.rules;
        let at_least = |name, ns, least: i64, must| {
            if ns < least { Err(ScheduleError::Duration { name, ns, must }) } else { Ok(()) }
        };
        at_least("the setup", rules.setup.ns(), 0, "not be negative")?;
        at_least("the cooldown", rules.cooldown.ns(), 0, "not be negative")?;
        if let Some(limit) = rules.max_per_day {
            at_least("the reserved time per day", limit.ns(), 0, "not be negative")?;
        }
        if let Some(sessions) = rules.max_sessions {
            at_least("the window of max_sessions", sessions.window.ns(), 1, "be positive")?;
        }
        let (start, end) = self.span;
        if end < start {
            return Err(ScheduleError::Span(start.since(end).ns()));
        }
        if let Some(at) = rules.day_boundaries.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(ScheduleError::DayOrder(at + 1));
        }
        if rules.max_per_day.is_some() {
            let covered = rules.day_boundaries.first().is_some_and(|first| *first <= start)
                && rules.day_boundaries.last().is_some_and(|last| *last >= end);
            if !covered {
                return Err(ScheduleError::DayCover);
            }
        }
        for (target, &weight) in self.weights.iter().enumerate() {
            if !(weight.is_finite() && weight >= 0.0) {
                return Err(ScheduleError::Weight { target, weight });
            }
        }
        if self.candidates.len() > MAX_CANDIDATES {
            return Err(ScheduleError::TooMany(self.candidates.len()));
        }
        self.validate_candidates()
    }

    fn validate_candidates(&self) -> Result<(), ScheduleError> {
        for (candidate, it) in self.candidates.iter().enumerate() {
            let targets = self.weights.len();
            if it.target >= targets {
                return Err(ScheduleError::Target { candidate, target: it.target, targets });
            }
            let length_ns = it.last_exit.since(it.first_entry).ns();
            let dwell_ns = it.dwell.ns();
            if dwell_ns < 0 || dwell_ns > length_ns {
                return Err(ScheduleError::Dwell { candidate, length_ns, dwell_ns });
            }
            if !self.value(candidate).is_finite() {
                return Err(ScheduleError::Value { candidate });
            }
        }
        self.demands.validate(self.candidates.len())
    }
}

impl Demands {
    /// Whether the demands fit a problem of so many candidates; the first fault.
    fn validate(&self, candidates: usize) -> Result<(), ScheduleError> {
        let entries = |name, entries: usize| {
            let error = ScheduleError::Entries { name, entries, candidates };
            if entries == candidates { Ok(()) } else { Err(error) }
        };
        let exist = |name, list: &[usize]| match list.iter().find(|it| **it >= candidates) {
            Some(&candidate) => Err(ScheduleError::Candidate { name, candidate }),
            None => Ok(()),
        };
        let positive = |name, length: Duration| {
            let error = ScheduleError::Duration { name, ns: length.ns(), must: "be positive" };
            if length.ns() > 0 { Ok(()) } else { Err(error) }
        };
        let price = |name, number: f64| {
            let must = "be finite and not negative";
            let legal = number.is_finite() && number >= 0.0;
            if legal { Ok(()) } else { Err(ScheduleError::Number { name, number, must }) }
        };
        exist("fixed", &self.fixed)?;
        exist("forbidden", &self.forbidden)?;
        exist("avoided", &self.avoided)?;
        if let Some(rule) = self.min_sessions {
            positive("the season of min_sessions", rule.window)?;
        }
        if let Some(rule) = self.longest_gap {
            positive("the longest gap", rule.longest)?;
            price("the price per day of the longest gap", rule.price_per_day)?;
        }
        for rule in &self.diversity {
            entries("scan_angle", rule.sums.len())?;
            let (name, number) = ("rho of scan_angle", rule.rho);
            if !(0.0..=1.0).contains(&number) {
                return Err(ScheduleError::Number { name, number, must: "lie from 0 to 1" });
            }
            let finite = |sums: &[f64; 3]| sums.iter().all(|it| it.abs() < 1e9);
            if let Some(candidate) = rule.sums.iter().position(|sums| !finite(sums)) {
                return Err(ScheduleError::Candidate { name: "scan_angle", candidate });
            }
        }
        if let Some(data) = &self.data {
            if data.rate_bit_s == 0 {
                let (name, must) = ("the data rate", "be positive");
                return Err(ScheduleError::Number { name, number: 0.0, must });
            }
            let mut last = None;
            for (index, it) in data.contacts.iter().enumerate() {
                if it.until < it.from || last.is_some_and(|last| it.from < last) {
                    return Err(ScheduleError::Contacts(index));
                }
                last = Some(it.until);
            }
        }
        if let Some(rule) = self.thermal {
            positive("the thermal window", rule.window)?;
            let (name, ns) = ("the thermal limit", rule.most.ns());
            if ns < 0 {
                return Err(ScheduleError::Duration { name, ns, must: "not be negative" });
            }
        }
        if let Some(previous) = &self.previous {
            exist("the previous plan", &previous.sessions)?;
            price("the price of a change", previous.price)?;
        }
        if !self.values.is_empty() {
            entries("the values of candidates", self.values.len())?;
            self.values.iter().try_for_each(|it| price("the value of a candidate", *it))?;
        }
        if let Some(log) = &self.log {
            entries("the logarithmic objective", log.parts.len())?;
            positive("the offset of the logarithmic objective", log.offset)?;
            positive("the epoch of the logarithmic objective", log.epoch)?;
            log.weights.values().try_for_each(|it| price("the weight of a cell", *it))?;
        }
        Ok(())
    }
}
