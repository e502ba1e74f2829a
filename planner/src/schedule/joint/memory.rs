//! The memory never overflows: data that sessions produce, less what contacts send.
//!
//! Method: the memory holds the largest of `produced - sent` over the stretches that end now, so it never
//! exceeds its size exactly if every stretch from s to t has `rate * produced time <= size + sent`.
//! Events in order give the level and its lowest value so far; a stretch from there is a row.

use super::separation::{AT_ONCE, BROKEN, SHARE};
use crate::program::number::{f64_from_i128, i64_from_i128};
use crate::program::{Family, Row};
use crate::schedule::demands::Data;

/// The memory never overflows. Sessions here are the intervals that produce data.
#[derive(Debug)]
pub(super) struct Memory<'m> {
    /// Per session, from when until when it produces data.
    pub(super) produces: &'m [(i64, i64)],
    pub(super) data: &'m Data,
}

const NS: i128 = 1_000_000_000;

impl Memory<'_> {
    /// Bits sent in `[from, until)`, times 1e9.
    fn sent(&self, from: i64, until: i64) -> i128 {
        let contacts = &self.data.contacts;
        let first = contacts.partition_point(|it| it.until.tai_ns() <= from);
        let within = contacts[first..].iter().take_while(|it| it.from.tai_ns() < until);
        within
            .map(|it| {
                let span = it.until.tai_ns().min(until) - it.from.tai_ns().max(from);
                i128::from(it.bit_s) * i128::from(span.max(0))
            })
            .sum()
    }

    /// The row of a stretch of time.
    pub(super) fn row(&self, from: i64, until: i64) -> Row {
        let room = i128::from(self.data.memory_bit) * NS + self.sent(from, until);
        let terms = self.produces.iter().enumerate().filter_map(|(id, &(start, end))| {
            let inside = end.min(until).saturating_sub(start.max(from));
            (inside > 0).then_some((id, inside))
        });
        let limit = i64_from_i128(room / i128::from(self.data.rate_bit_s.max(1)));
        Row { terms: terms.collect(), limit: limit.min(1 << 52) }
    }
}

impl Family for Memory<'_> {
    fn broken(&self, taken: &[bool]) -> Vec<Row> {
        // Slopes of `produced - sent` change here.
        let mut changes: Vec<(i64, i128)> = Vec::new();
        let rate = i128::from(self.data.rate_bit_s);
        for (&(start, end), _) in self.produces.iter().zip(taken).filter(|it| *it.1) {
            changes.extend([(start, rate), (end, -rate)]);
        }
        for contact in &self.data.contacts {
            let sends = i128::from(contact.bit_s);
            changes.extend([(contact.from.tai_ns(), -sends), (contact.until.tai_ns(), sends)]);
        }
        changes.sort_unstable();
        let size = i128::from(self.data.memory_bit) * NS;
        let (mut level, mut slope, mut at) = (0_i128, 0_i128, i64::MIN);
        let (mut lowest, mut since) = (0_i128, changes.first().map_or(0, |it| it.0));
        let mut rows = Vec::new();
        for (when, change) in changes {
            if at > i64::MIN {
                level += slope * i128::from(when - at);
            }
            at = when;
            slope += change;
            if level < lowest {
                (lowest, since) = (level, when);
            }
            if level - lowest > size {
                rows.push(self.row(since, when));
                (lowest, since) = (level, when);
                if rows.len() >= AT_ONCE {
                    break;
                }
            }
        }
        rows
    }

    fn separate(&self, shares: &[f64]) -> Vec<Row> {
        let bits = |rate: u64| f64_from_i128(i128::from(rate)) / f64_from_i128(NS);
        let mut changes: Vec<(i64, f64)> = Vec::new();
        for (&(start, end), share) in self.produces.iter().zip(shares) {
            if *share > SHARE {
                let rate = bits(self.data.rate_bit_s) * share;
                changes.extend([(start, rate), (end, -rate)]);
            }
        }
        for contact in &self.data.contacts {
            let sends = bits(contact.bit_s);
            changes.extend([(contact.from.tai_ns(), -sends), (contact.until.tai_ns(), sends)]);
        }
        changes.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let size = bits(self.data.memory_bit) * f64_from_i128(NS);
        let mut rows = Vec::new();
        // The worst stretch between two lowest levels, and the first that is too much.
        let (mut level, mut slope, mut at) = (0.0, 0.0, i64::MIN);
        let (mut lowest, mut since) = (0.0, changes.first().map_or(0, |it| it.0));
        let mut worst: Option<(f64, i64, i64)> = None;
        let mut first: Option<(i64, i64)> = None;
        let mut end = |worst: &mut Option<(f64, i64, i64)>, first: &mut Option<(i64, i64)>| {
            let found = worst.take().map(|it| (it.1, it.2));
            let first = first.take().filter(|it| Some(*it) != found);
            rows.extend(found.into_iter().chain(first).map(|(from, until)| self.row(from, until)));
        };
        for (when, change) in changes {
            if at > i64::MIN {
                level += slope * f64_from_i128(i128::from(when) - i128::from(at));
            }
            at = when;
            slope += change;
            if level < lowest {
                end(&mut worst, &mut first);
                (lowest, since) = (level, when);
            }
            let over = level - lowest - size;
            if over > BROKEN * size && worst.is_none_or(|it| over > it.0) {
                worst = Some((over, since, when));
                first = first.or(Some((since, when)));
            }
        }
        end(&mut worst, &mut first);
        rows
    }
}
