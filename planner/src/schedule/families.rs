//! Rules whose rows are too many to list: rows are made where a schedule breaks them.
//!
//! Method: each family reads the sessions that stand, finds its worst places exactly in integers,
//! and gives the rows that hold there for every schedule.
//!
//! - **Starts in a sliding window**, **reserved time in a sliding window**: the worst window begins at
//!   a session's start or ends at a session's end, where the sum is largest.
//! - **Memory**: the memory holds the largest of `produced - sent` over the stretches that end now, so
//!   it never exceeds its size exactly if every stretch from s to t has
//!   `rate * produced time <= size + sent`.
//! - **Scan angles**: for integers p, q and L at least their norm, `p C + q S <= L R` follows from
//!   `|(C, S)| <= R`. Where rounding leaves a set uncut, the set itself is.

use super::demands::Data;
use super::model::Session;
use crate::program::number::{f64_from_i128, i64_from_f64, i64_from_i128, i64_from_usize};
use crate::program::{Family, Row};

/// Most rows that a family gives at once.
const AT_ONCE: usize = 50;
/// Shares below this are none.
const SHARE: f64 = 1e-6;
/// Shares must break a row by this part of its limit.
const BROKEN: f64 = 1e-4;
/// Windows of reserved time that shares break are at least this part of a window apart.
const WINDOWS_APART: i64 = 24;
/// Length of the direction of a tangent.
pub(super) const DIRECTION: f64 = 1_048_576.0;

/// At most `count` starts in `[t, t + window)`.
#[derive(Debug)]
pub(super) struct Starts<'m> {
    pub(super) sessions: &'m [Session],
    pub(super) count: usize,
    pub(super) window: i64,
}

impl Starts<'_> {
    /// The row of the window from an instant.
    pub(super) fn row(&self, from: i64) -> Row {
        let first = self.sessions.partition_point(|it| it.start < from);
        let until = from.saturating_add(self.window);
        let last = self.sessions.partition_point(|it| it.start < until);
        Row { terms: (first..last).map(|id| (id, 1)).collect(), limit: i64_from_usize(self.count) }
    }
}

impl Family for Starts<'_> {
    fn broken(&self, taken: &[bool]) -> Vec<Row> {
        let standing: Vec<usize> = (0..taken.len()).filter(|&id| taken[id]).collect();
        let mut rows = Vec::new();
        let mut at = 0;
        while let (Some(&first), Some(&last)) = (standing.get(at), standing.get(at + self.count)) {
            let from = self.sessions[first].start;
            if self.sessions[last].start.saturating_sub(from) < self.window {
                rows.push(self.row(from));
                at += self.count;
            }
            at += 1;
            if rows.len() >= AT_ONCE {
                break;
            }
        }
        rows
    }
}

/// At most `most` reserved time in `[t, t + window)`.
#[derive(Debug)]
pub(super) struct Heat<'m> {
    pub(super) sessions: &'m [Session],
    pub(super) longest: i64,
    pub(super) most: i64,
    pub(super) window: i64,
}

impl Heat<'_> {
    /// The row of the window from an instant.
    pub(super) fn row(&self, from: i64) -> Row {
        let until = from.saturating_add(self.window);
        let first =
            self.sessions.partition_point(|it| it.start < from.saturating_sub(self.longest));
        let last = self.sessions.partition_point(|it| it.start < until);
        let terms = (first..last.max(first)).filter_map(|id| {
            let it = &self.sessions[id];
            let inside = it.end.min(until).saturating_sub(it.start.max(from));
            (inside > 0).then_some((id, inside))
        });
        Row { terms: terms.collect(), limit: self.most }
    }
}

impl Family for Heat<'_> {
    fn broken(&self, taken: &[bool]) -> Vec<Row> {
        let standing = (0..taken.len()).filter(|&id| taken[id]).map(|id| self.sessions[id]);
        let standing: Vec<Session> = standing.collect();
        let used = |from: i64| -> i128 {
            let until = from.saturating_add(self.window);
            let first = standing.partition_point(|it| it.start < from.saturating_sub(self.longest));
            let near = standing[first..].iter().take_while(|it| it.start < until);
            near.map(|it| i128::from((it.end.min(until) - it.start.max(from)).max(0))).sum()
        };
        let places = standing.iter().flat_map(|it| [it.start, it.end.saturating_sub(self.window)]);
        let over = places.filter(|&from| used(from) > i128::from(self.most));
        over.take(AT_ONCE).map(|from| self.row(from)).collect()
    }

    fn separate(&self, shares: &[f64]) -> Vec<Row> {
        let standing: Vec<(Session, f64)> = self
            .sessions
            .iter()
            .zip(shares)
            .filter(|it| *it.1 > SHARE)
            .map(|(session, share)| (*session, *share))
            .collect();
        let most = f64_from_i128(i128::from(self.most));
        let used = |from: i64| -> f64 {
            let until = from.saturating_add(self.window);
            let early = from.saturating_sub(self.longest);
            let first = standing.partition_point(|it| it.0.start < early);
            let near = standing[first..].iter().take_while(|it| it.0.start < until);
            let inside = near.map(|(it, share)| {
                let ns = it.end.min(until).saturating_sub(it.start.max(from)).max(0);
                share * f64_from_i128(i128::from(ns))
            });
            inside.sum()
        };
        let places =
            standing.iter().flat_map(|it| [it.0.start, it.0.end.saturating_sub(self.window)]);
        let mut over: Vec<(f64, i64)> = places
            .map(|from| (used(from) - most, from))
            .filter(|it| it.0 > BROKEN * most)
            .collect();
        over.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        // Neighbours say nearly the same.
        let apart = self.window / WINDOWS_APART;
        let mut chosen: Vec<i64> = Vec::new();
        for (_, from) in over {
            let near = |it: &i64| from.abs_diff(*it) < apart.unsigned_abs();
            if chosen.len() < AT_ONCE && !chosen.iter().any(near) {
                chosen.push(from);
            }
        }
        chosen.into_iter().map(|from| self.row(from)).collect()
    }
}

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

/// Session, c, s, r.
pub(super) type Member = (usize, i64, i64, i64);

/// `|(sum c, sum s)| <= sum r` over some sessions, in milliseconds.
#[derive(Debug)]
pub(super) struct Cone {
    pub(super) members: Vec<Member>,
}

impl Cone {
    /// The tangent in a direction.
    pub(super) fn tangent(&self, c: f64, s: f64) -> Row {
        let norm = c.hypot(s).max(f64::MIN_POSITIVE);
        let (p, q) = (
            i64_from_f64((c / norm * DIRECTION).round()),
            i64_from_f64((s / norm * DIRECTION).round()),
        );
        // The least integer whose square is at least p^2 + q^2.
        let square = i128::from(p) * i128::from(p) + i128::from(q) * i128::from(q);
        let mut length = i64_from_f64(f64_from_i128(square).sqrt()).saturating_sub(1).max(0);
        while i128::from(length) * i128::from(length) < square {
            length += 1;
        }
        let terms = self.members.iter().map(|&(id, c, s, r)| (id, p * c + q * s - length * r));
        Row { terms: terms.collect(), limit: 0 }
    }

    fn sums(&self, taken: &[bool]) -> (i128, i128, i128) {
        let standing = self.members.iter().filter(|it| taken[it.0]);
        standing.fold((0, 0, 0), |sum, &(_, c, s, r)| {
            (sum.0 + i128::from(c), sum.1 + i128::from(s), sum.2 + i128::from(r))
        })
    }
}

impl Family for Cone {
    fn broken(&self, taken: &[bool]) -> Vec<Row> {
        let (c, s, r) = self.sums(taken);
        if c * c + s * s <= r * r {
            return Vec::new();
        }
        let tangent = self.tangent(f64_from_i128(c), f64_from_i128(s));
        let used: i128 =
            tangent.terms.iter().filter(|it| taken[it.0]).map(|it| i128::from(it.1)).sum();
        if used > 0 {
            return vec![tangent];
        }
        let sign = |id: usize| if taken[id] { 1 } else { -1 };
        let terms: Vec<(usize, i64)> = self.members.iter().map(|it| (it.0, sign(it.0))).collect();
        let standing = terms.iter().filter(|it| it.1 > 0).count();
        vec![Row { terms, limit: i64_from_usize(standing) - 1 }]
    }

    fn separate(&self, shares: &[f64]) -> Vec<Row> {
        let mut sums = [0.0; 3];
        for &(id, c, s, r) in &self.members {
            for (sum, of) in sums.iter_mut().zip([c, s, r]) {
                *sum += shares[id] * f64_from_i128(i128::from(of));
            }
        }
        let over = sums[0].hypot(sums[1]) > sums[2] * (1.0 + 1e-4) + 1.0;
        if over { vec![self.tangent(sums[0], sums[1])] } else { Vec::new() }
    }
}
