//! Checks the numbers of one SPK segment, and reads its states.
//!
//! Everything that evaluation indexes or divides by is held against what NAIF's "SPK Required
//! Reading" lays down for the segment's type.

use super::difference::DifferenceLines;
use super::error::{LegalNumber, SpkError};
use super::packets::{Packets, Pieces};
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
/// Most orders of a difference line.
const MOST_DIFFERENCES: usize = 25;
/// Orders of a difference line of type 1.
const DIMENSION_OF_TYPE_1: usize = 15;
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
    Differences(DifferenceLines),
    Pieces(Pieces),
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
            1 => self.differences(1, DIMENSION_OF_TYPE_1).map(Content::Differences),
            21 => {
                let dimension = self.footer_count(2, "the dimension of differences")?;
                self.differences(2, dimension).map(Content::Differences)
            }
            18 => {
                let packets = self.packets(self.numbers)?;
                Ok(Content::Pieces(Pieces::one(packets)))
            }
            19 => self.pieces().map(Content::Pieces),
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
        self.check_rising(times)?;
        self.series(times.to_vec(), method, window)
    }

    /// Types 1 and 21: difference lines, their last times, every hundredth of these; then, in type
    /// 21, the dimension, and in both the count.
    fn differences(&self, footer: usize, dimension: usize) -> Result<DifferenceLines, SpkError> {
        let count = self.footer_count(1, "the number of records")?;
        if count == 0 {
            return Err(self.bad("the number of records", 0.0, LegalNumber::Such("1 or more")));
        }
        if !(1..=MOST_DIFFERENCES).contains(&dimension) {
            let found = f64_from_usize(dimension);
            return Err(self.bad(
                "the dimension of differences",
                found,
                LegalNumber::Such("1 to 25"),
            ));
        }
        let line = 4 * dimension + 11;
        let length = count.checked_mul(line + 1).and_then(|n| n.checked_add(count / 100 + footer));
        self.check_length(length)?;
        let (lines, rest) = self.numbers.split_at_checked(count * line).unwrap_or_default();
        let ends = rest.get(..count).unwrap_or_default();
        self.check_rising(ends)?;
        self.check_coverage(f64::NEG_INFINITY, ends.last().copied().unwrap_or(f64::NAN))?;
        self.check_size(lines)?;
        DifferenceLines::new(ends.to_vec(), lines.to_vec(), dimension).map_err(|(what, found)| {
            self.bad(what, found, LegalNumber::Such("as SPICE writes difference lines"))
        })
    }

    fn check_rising(&self, times: &[f64]) -> Result<(), SpkError> {
        let rising = |pair: &[f64]| matches!(pair, [a, b] if a < b && b.is_finite());
        if let Some(pair) = times.windows(2).find(|pair| !rising(pair)) {
            let found = pair.last().copied().unwrap_or(f64::NAN);
            return Err(self.bad("a time", found, LegalNumber::Such("later than the one before")));
        }
        match times.first().filter(|time| !time.is_finite()) {
            Some(first) => Err(self.bad("the first time", *first, LegalNumber::Such("finite"))),
            None => Ok(()),
        }
    }

    /// Type 18, and a piece of type 19: packets, times, every hundredth time; then subtype, window,
    /// count.
    fn packets(&self, numbers: &[f64]) -> Result<Packets, SpkError> {
        let part = Reader { numbers, ..*self };
        let subtype = part.footer_count(3, "the subtype")?;
        let width = match subtype {
            0 => 12,
            1 | 2 => 6,
            _ => {
                let found = f64_from_usize(subtype);
                return Err(self.bad("the subtype", found, LegalNumber::Such("0, 1 or 2")));
            }
        };
        let window = part.footer_count(2, "the window")?;
        if !(1..=MAX_WINDOW).contains(&window) {
            let found = f64_from_usize(window);
            return Err(self.bad("the window", found, LegalNumber::States(MAX_WINDOW)));
        }
        let count = part.footer_count(1, "the number of packets")?;
        if count == 0 {
            return Err(self.bad("the number of packets", 0.0, LegalNumber::Such("1 or more")));
        }
        let length =
            count.checked_mul(width + 1).and_then(|n| n.checked_add((count - 1) / 100 + 3));
        part.check_length(length)?;
        let (packets, rest) = numbers.split_at_checked(count * width).unwrap_or_default();
        let times = rest.get(..count).unwrap_or_default();
        part.check_rising(times)?;
        part.check_size(packets)?;
        Packets::new(subtype, times, packets, window).ok_or_else(|| {
            self.bad("the window", f64_from_usize(window), LegalNumber::States(MAX_WINDOW))
        })
    }

    /// Type 19: pieces as of type 18, their bounds, every hundredth bound, the first address of each
    /// piece; then which piece counts at a bound, and the count.
    fn pieces(&self) -> Result<Pieces, SpkError> {
        let count = self.footer_count(1, "the number of pieces")?;
        let later = self.footer_count(2, "the choice at bounds")? == 1;
        let pointers = self
            .numbers
            .len()
            .checked_sub(count.saturating_add(3))
            .and_then(|first| self.numbers.get(first..first + count + 1))
            .filter(|_| count > 0);
        let Some(pointers) = pointers else {
            let found = f64_from_usize(count);
            return Err(self.bad("the number of pieces", found, LegalNumber::Such("1 or more")));
        };
        let wrong = |found| self.bad("the address of a piece", found, LegalNumber::Such("rising"));
        let address = |found: f64| {
            count_from_f64(found).and_then(|it| it.checked_sub(1)).ok_or_else(|| wrong(found))
        };
        let mut pieces = Vec::new();
        for pair in pointers.windows(2) {
            let [first, end] = *pair else { continue };
            let numbers = self.numbers.get(address(first)?..address(end)?);
            pieces.push(self.packets(numbers.ok_or_else(|| wrong(first))?)?);
        }
        let first = address(pointers.last().copied().unwrap_or(f64::NAN))?;
        let bounds = first.checked_add(count + 1).and_then(|end| self.numbers.get(first..end));
        let bounds = bounds.unwrap_or_default();
        self.check_rising(bounds)?;
        let [from, .., until] = *bounds else {
            return Err(self.bad(
                "the number of bounds",
                0.0,
                LegalNumber::Such("one more than pieces"),
            ));
        };
        self.check_coverage(from, until)?;
        Ok(Pieces::new(bounds.to_vec(), pieces, later))
    }
}
