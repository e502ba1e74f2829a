//! Checks the numbers of one SPK segment, and reads its states.
//!
//! Everything that evaluation indexes or divides by is held against what NAIF's "SPK Required
//! Reading" lays down for the segment's type.

use super::error::{LegalNumber, SpkError};
use crate::convert::{count_from_f64, f64_from_usize};
use crate::daf::Summary;
use crate::interpolation::{MAX_WINDOW, Method, PosVel, StateSeries, equal_steps};
use nalgebra::Vector3;

/// NAIF's number of the frame J2000, whose axes DE440 takes as the ICRF's.
const FRAME_J2000: i32 = 1;
/// Beyond a light year nothing here has a state in km.
const LARGEST_KM: f64 = 1e13;
/// Longest series of a Chebyshev record.
const MOST_COEFFICIENTS: usize = 100;
/// Slack in seconds between a segment's coverage and its records.
const TIME_SLACK_S: f64 = 1e-3;

/// A segment that cannot be evaluated, though its file is sound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unsupported {
    Type(i32),
    Frame(i32),
}

/// What a segment holds.
#[derive(Debug, Clone)]
pub(super) enum Content {
    Chebyshev,
    ChebyshevWithVelocity,
    Discrete(StateSeries),
    Unsupported(Unsupported),
}

/// Checks one segment's numbers.
pub(super) struct Reader<'a> {
    /// Segment, counted from 1.
    pub(super) number: usize,
    pub(super) summary: Summary,
    pub(super) numbers: &'a [f64],
}

impl Reader<'_> {
    /// What the segment holds.
    pub(super) fn content(&self) -> Result<Content, SpkError> {
        let s = &self.summary;
        if s.frame != FRAME_J2000 {
            return Ok(Content::Unsupported(Unsupported::Frame(s.frame)));
        }
        if s.target == s.center {
            let found = f64::from(s.center);
            return Err(self.bad(
                "the centre",
                found,
                LegalNumber::Such("another body than the target"),
            ));
        }
        match s.data_type {
            2 => self.chebyshev(3).map(|()| Content::Chebyshev),
            3 => self.chebyshev(6).map(|()| Content::ChebyshevWithVelocity),
            8 => self.equal_steps(Method::Lagrange),
            9 => self.unequal_steps(Method::Lagrange),
            12 => self.equal_steps(Method::Hermite),
            13 => self.unequal_steps(Method::Hermite),
            other => Ok(Content::Unsupported(Unsupported::Type(other))),
        }
    }

    fn bad(&self, what: &'static str, found: f64, legal: LegalNumber) -> SpkError {
        let (segment, body) = (self.number, self.summary.target);
        SpkError::Segment { segment, body, what, found, legal }
    }

    /// The number `back` places before the segment's end.
    fn footer(&self, back: usize) -> f64 {
        let index = self.numbers.len().checked_sub(back);
        index.and_then(|index| self.numbers.get(index)).copied().unwrap_or(f64::NAN)
    }

    fn footer_count(&self, back: usize, what: &'static str) -> Result<usize, SpkError> {
        let found = self.footer(back);
        count_from_f64(found)
            .ok_or_else(|| self.bad(what, found, LegalNumber::Such("a whole number")))
    }

    fn check_length(&self, expected: Option<usize>) -> Result<(), SpkError> {
        if expected == Some(self.numbers.len()) {
            return Ok(());
        }
        let legal = expected.map_or(LegalNumber::Such("one that fits the file"), |n| {
            LegalNumber::Exactly(f64_from_usize(n))
        });
        Err(self.bad("the length in doubles", f64_from_usize(self.numbers.len()), legal))
    }

    fn check_coverage(&self, first_s: f64, last_s: f64) -> Result<(), SpkError> {
        let s = &self.summary;
        if first_s > s.start_s + TIME_SLACK_S {
            return Err(self.bad("the first time", first_s, LegalNumber::AtMost(s.start_s)));
        }
        if last_s < s.end_s - TIME_SLACK_S {
            return Err(self.bad("the last time", last_s, LegalNumber::AtLeast(s.end_s)));
        }
        Ok(())
    }

    fn check_size(&self, numbers: &[f64]) -> Result<(), SpkError> {
        match numbers.iter().find(|n| !(n.is_finite() && n.abs() < LARGEST_KM)) {
            Some(found) => {
                Err(self.bad("a coefficient", *found, LegalNumber::Such("finite, below 1e13 km")))
            }
            None => Ok(()),
        }
    }

    /// Types 2 and 3: records of midpoint, radius, coefficients; then start, length, size, count.
    fn chebyshev(&self, per_axis: usize) -> Result<(), SpkError> {
        let (start, length) = (self.footer(4), self.footer(3));
        let size = self.footer_count(2, "the record size")?;
        let count = self.footer_count(1, "the number of records")?;
        let orders = size.saturating_sub(2) / per_axis;
        if !(1..=MOST_COEFFICIENTS).contains(&orders) || size != 2 + orders * per_axis {
            let legal = LegalNumber::RecordSize { per_axis, most: MOST_COEFFICIENTS };
            return Err(self.bad("the record size", f64_from_usize(size), legal));
        }
        if count == 0 {
            return Err(self.bad("the number of records", 0.0, LegalNumber::Such("1 or more")));
        }
        self.check_length(size.checked_mul(count).and_then(|n| n.checked_add(4)))?;
        if !(length.is_finite() && length > 0.0) {
            return Err(self.bad(
                "the record length in seconds",
                length,
                LegalNumber::Such("positive"),
            ));
        }
        if !start.is_finite() {
            return Err(self.bad("the first time", start, LegalNumber::Such("finite")));
        }
        self.check_coverage(start, start + length * f64_from_usize(count))?;
        for (index, record) in self.numbers.chunks_exact(size).take(count).enumerate() {
            let (head, coefficients) = record.split_at_checked(2).unwrap_or_default();
            let expected = start + length * (f64_from_usize(index) + 0.5);
            let [middle, radius] = head else { continue };
            let near = |found: f64, expected: f64| (found - expected).abs() <= TIME_SLACK_S;
            if !near(*middle, expected) {
                return Err(self.bad(
                    "a record's midpoint",
                    *middle,
                    LegalNumber::Exactly(expected),
                ));
            }
            if !near(*radius, length / 2.0) {
                return Err(self.bad(
                    "a record's radius",
                    *radius,
                    LegalNumber::Exactly(length / 2.0),
                ));
            }
            self.check_size(coefficients)?;
        }
        Ok(())
    }

    fn window(&self, back: usize, method: Method) -> Result<usize, SpkError> {
        // Both kinds store the window less one; for Lagrange that is the degree.
        let window = self.footer_count(back, "the window")?.saturating_add(1);
        if (2..=MAX_WINDOW).contains(&window) || (window == 1 && method == Method::Hermite) {
            return Ok(window);
        }
        Err(self.bad("the window", f64_from_usize(window), LegalNumber::States(MAX_WINDOW)))
    }

    fn series(&self, times: Vec<f64>, method: Method, window: usize) -> Result<Content, SpkError> {
        let states = self.numbers.get(..6 * times.len()).unwrap_or_default();
        self.check_size(states)?;
        let (Some(first), Some(last)) = (times.first(), times.last()) else {
            return Err(self.bad("the number of states", 0.0, LegalNumber::Such("1 or more")));
        };
        self.check_coverage(*first, *last)?;
        let states: Vec<PosVel> = states
            .as_chunks::<6>()
            .0
            .iter()
            .map(|[x, y, z, vx, vy, vz]| (Vector3::new(*x, *y, *z), Vector3::new(*vx, *vy, *vz)))
            .collect();
        let found = f64_from_usize(states.len());
        StateSeries::new(times, states, method, window).map(Content::Discrete).ok_or_else(|| {
            self.bad("the number of states", found, LegalNumber::Such("one per time"))
        })
    }

    /// Types 8 and 12: states; then start, step, window, count.
    fn equal_steps(&self, method: Method) -> Result<Content, SpkError> {
        let (start, step) = (self.footer(4), self.footer(3));
        let window = self.window(2, method)?;
        let count = self.footer_count(1, "the number of states")?;
        self.check_length(count.checked_mul(6).and_then(|n| n.checked_add(4)))?;
        if !(step.is_finite() && step > 0.0) {
            return Err(self.bad("the step in seconds", step, LegalNumber::Such("positive")));
        }
        if !start.is_finite() {
            return Err(self.bad("the first time", start, LegalNumber::Such("finite")));
        }
        self.series(equal_steps(start, step, count), method, window)
    }

    /// Types 9 and 13: states, times, every hundredth time; then window, count.
    fn unequal_steps(&self, method: Method) -> Result<Content, SpkError> {
        let window = self.window(2, method)?;
        let count = self.footer_count(1, "the number of states")?;
        let directory = count.saturating_sub(1) / 100;
        let length = count.checked_mul(7).and_then(|n| n.checked_add(directory + 2));
        self.check_length(length)?;
        let times = self.numbers.get(6 * count..7 * count).unwrap_or_default();
        let rising = |pair: &[f64]| matches!(pair, [a, b] if a < b && b.is_finite());
        if let Some(pair) = times.windows(2).find(|pair| !rising(pair)) {
            let found = pair.last().copied().unwrap_or(f64::NAN);
            return Err(self.bad("a time", found, LegalNumber::Such("later than the one before")));
        }
        if let Some(first) = times.first().filter(|time| !time.is_finite()) {
            return Err(self.bad("the first time", *first, LegalNumber::Such("finite")));
        }
        self.series(times.to_vec(), method, window)
    }
}
