//! Rules beyond overlap, days and starts that labels know exactly or nearly: gaps, memory, heat.
//!
//! - **Gaps**: each window that no session of a lane starts in costs its price, once it has passed. A label
//!   holds the last start on each lane; the later it is the better.
//! - **Memory**: what it holds, in ns of producing. What contacts send counts from one item to the next. For
//!   a schedule the level after a session is right, and not too low where sessions overlap; for a bound it is
//!   never too high.
//! - **Heat**: the reserved time in windows that begin at some instants, the **lines**.
//!
//! Limits: the bound leaves out data that may be sent while it is produced, and windows between the lines;
//! the schedule is checked window by window.

use super::size::MOST_LINES;
use crate::schedule::demands::Data;
use crate::schedule::joint::Built;
use crate::schedule::rule::Rule;

const NS: i128 = 1_000_000_000;

/// A window of the longest gap on a lane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Due {
    pub(super) from: i64,
    pub(super) until: i64,
    /// What it costs when it is empty, in units.
    pub(super) price: i64,
}

/// What labels are told beyond the plain rules.
#[derive(Debug, Default)]
pub(in crate::schedule) struct Further<'a> {
    /// Windows of the longest gap of each lane, by time; none where they are charged elsewhere.
    pub(super) gaps: Vec<Vec<Due>>,
    pub(super) memory: Option<(&'a Data, &'a [(i64, i64)])>,
    /// Most reserved ns in a window, and its length.
    pub(super) heat: Option<(i64, i64)>,
}

impl<'a> Further<'a> {
    /// The rules of a problem; gaps where labels are to charge them.
    pub(in crate::schedule) fn of(built: &Built<'a>, with_gaps: bool) -> Self {
        let demands = &built.problem.demands;
        let mut gaps: Vec<Vec<Due>> = Vec::new();
        if let Some(rule) = demands.longest_gap.filter(|_| with_gaps && Self::knows_gaps(built)) {
            gaps = vec![Vec::new(); built.model.lanes];
            for (gap, price) in built.gaps.iter().zip(built.gap_prices()) {
                let Rule::Gap { telescope, from } = gap.rule else { continue };
                let lane = built.model.lane_names.iter().position(|it| *it == Some(telescope));
                let until = from.plus(rule.longest).tai_ns();
                if let Some(lane) = lane {
                    gaps[lane].push(Due { from: from.tai_ns(), until, price });
                }
            }
        }
        let memory = demands.data.as_ref().map(|data| (data, &built.facts.produces[..]));
        let heat = demands.thermal.map(|it| (it.most.ns(), it.window.ns()));
        Self { gaps, memory, heat }
    }

    /// Whether labels charge gaps: where each telescope has a lane.
    pub(in crate::schedule) fn knows_gaps(built: &Built<'_>) -> bool {
        built.model.lane_names.iter().all(Option::is_some) && built.model.lanes > 0
    }
}

/// The memory, in ns of producing data.
#[derive(Debug)]
pub(super) struct Memory {
    pub(super) size: i64,
    rate_bit_s: i128,
    /// From, until, bits per second.
    contacts: Vec<(i64, i64, i128)>,
}

impl Memory {
    pub(super) fn new(data: &Data) -> Self {
        let rate_bit_s = i128::from(data.rate_bit_s.max(1));
        let size = i128::from(data.memory_bit) * NS / rate_bit_s;
        let contacts = data.contacts.iter();
        Self {
            size: i64::try_from(size).unwrap_or(i64::MAX / 4).min(i64::MAX / 4),
            rate_bit_s,
            contacts: contacts
                .map(|it| (it.from.tai_ns(), it.until.tai_ns(), i128::from(it.bit_s)))
                .collect(),
        }
    }

    /// What contacts send in `[from, until)`, rounded down.
    pub(super) fn sent(&self, from: i64, until: i64) -> i64 {
        let first = self.contacts.partition_point(|it| it.1 <= from);
        let within = self.contacts[first..].iter().take_while(|it| it.0 < until);
        let bits: i128 =
            within.map(|it| it.2 * i128::from((it.1.min(until) - it.0.max(from)).max(0))).sum();
        i64::try_from(bits / self.rate_bit_s).unwrap_or(i64::MAX / 4).min(i64::MAX / 4)
    }

    /// Starts and ends of contacts in `[from, until]`, and the two.
    fn changes(&self, from: i64, until: i64) -> impl Iterator<Item = i64> {
        let first = self.contacts.partition_point(|it| it.1 <= from);
        let within = self.contacts[first..].iter().take_while(move |it| it.0 < until);
        within.flat_map(move |it| [it.0.max(from), it.1.min(until)]).chain([from, until])
    }

    /// The most that producing in `[from, until)` is ahead of what contacts send meanwhile.
    pub(super) fn peak(&self, from: i64, until: i64) -> i64 {
        let ahead = |at: i64| (at - from) - self.sent(from, at);
        self.changes(from, until).map(ahead).max().unwrap_or(0)
    }

    /// What an empty memory holds after producing in `[from, until)`: the most that was produced since some
    /// instant less what contacts sent since.
    pub(super) fn ahead_at_end(&self, from: i64, until: i64) -> i64 {
        let since = |at: i64| (until - at) - self.sent(at, until);
        self.changes(from, until).map(since).max().unwrap_or(0)
    }
}

/// Some thermal windows of fixed length, each from its line on.
#[derive(Debug)]
pub(super) struct Heat {
    pub(super) most: i64,
    pub(super) window: i64,
    /// Ascending instants at which windows begin.
    pub(super) lines: Vec<i64>,
    /// Lines that a label holds at a time.
    pub(super) slots: usize,
    /// Longest reserved time.
    pub(super) longest: i64,
    /// One window holds all sessions.
    pub(super) complete: bool,
}

impl Heat {
    /// Windows that end with sessions; of too many every second, again and again.
    pub(super) fn new(
        (most, window): (i64, i64),
        starts: &[i64],
        ends: &[i64],
        longest: i64,
    ) -> Self {
        let first = starts.first().copied().unwrap_or(0);
        let last = ends.last().copied().unwrap_or(0);
        if last.saturating_sub(first) <= window {
            return Self { most, window, lines: vec![first], slots: 1, longest, complete: true };
        }
        let mut lines: Vec<i64> = ends.iter().map(|it| it - window).collect();
        let together = |lines: &[i64]| {
            let until = |at: usize| lines[at].saturating_add(window).saturating_add(longest);
            let ahead = |at: usize| lines.partition_point(|it| *it <= until(at)) - at;
            (0..lines.len()).map(ahead).max().unwrap_or(1)
        };
        while together(&lines) > MOST_LINES {
            let mut keep = false;
            lines.retain(|_| {
                keep = !keep;
                keep
            });
        }
        let slots = together(&lines).max(1);
        Self { most, window, lines, slots, longest, complete: false }
    }

    /// The lines, of those from one on, whose windows a reserved interval touches, and its part in each.
    pub(super) fn touched(
        &self,
        first: usize,
        (from, until): (i64, i64),
    ) -> impl Iterator<Item = (usize, i64)> {
        let lines = self.lines.iter().enumerate().skip(first).take_while(move |it| *it.1 < until);
        lines.filter_map(move |(index, line)| {
            let part = until.min(line.saturating_add(self.window)) - from.max(*line);
            (part > 0).then_some((index % self.slots, part))
        })
    }

    /// Whether reserved intervals that meet the rule still do with one more that starts no earlier.
    pub(super) fn allows(&self, standing: &[(i64, i64)], new: (i64, i64)) -> bool {
        let used = |from: i64| -> i64 {
            let until = from.saturating_add(self.window);
            let all = standing.iter().chain(std::iter::once(&new));
            all.map(|it| (it.1.min(until) - it.0.max(from)).max(0)).sum()
        };
        let with_new = |from: &i64| *from < new.1 && from.saturating_add(self.window) > new.0;
        let all = standing.iter().chain(std::iter::once(&new));
        all.flat_map(|it| [it.0, it.1 - self.window])
            .filter(with_new)
            .all(|it| used(it) <= self.most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::demands::Contact;
    use onboard_core::time::Instant;

    /// A contact of 10 s from 100 s on that sends twice what is produced, and one of 20 s from 140 s on that
    /// sends half of it.
    fn memory() -> Memory {
        let at = |seconds: i64| Instant::from_tai_ns(seconds * 1_000_000_000);
        let contact = |from, until, bit_s| Contact { from: at(from), until: at(until), bit_s };
        let contacts = vec![contact(100, 110, 2_000), contact(140, 160, 500)];
        Memory::new(&Data { rate_bit_s: 1_000, memory_bit: 60_000, contacts })
    }

    fn seconds(count: i64) -> i64 {
        count * 1_000_000_000
    }

    #[test]
    fn a_memory_counts_in_time_of_producing() {
        let memory = memory();
        assert_eq!(memory.size, seconds(60));
        assert_eq!(memory.sent(seconds(105), seconds(150)), seconds(10 + 5));
        // From 90 s on: 10 s at first, then none, then all that the second contact leaves.
        assert_eq!(memory.peak(seconds(90), seconds(130)), seconds(20));
        assert_eq!(memory.peak(seconds(90), seconds(111)), seconds(10));
        // The first contact cannot send what is produced after it.
        assert_eq!(memory.ahead_at_end(seconds(90), seconds(130)), seconds(20));
        assert_eq!(memory.ahead_at_end(seconds(100), seconds(160)), seconds(30 + 10));
        assert_eq!(memory.ahead_at_end(seconds(100), seconds(110)), 0);
    }

    #[test]
    fn a_window_may_begin_with_any_session_or_end_with_it() {
        let heat = Heat::new((50, 100), &[0, 500], &[30, 530], 40);
        assert!(!heat.complete);
        // [20, 120) would hold 10 + 41.
        assert!(heat.allows(&[(0, 30)], (80, 120)));
        assert!(!heat.allows(&[(0, 30)], (79, 120)));
        // Two at a time.
        assert!(!heat.allows(&[(0, 30)], (0, 30)));
        let touched: Vec<(usize, i64)> = heat.touched(0, (10, 40)).collect();
        assert_eq!(touched, [(0, 20)]);
    }

    #[test]
    fn one_window_holds_a_short_mission() {
        let heat = Heat::new((50, 1_000), &[5, 500], &[30, 530], 40);
        assert!(heat.complete && heat.slots == 1);
        assert_eq!(heat.touched(0, (500, 530)).collect::<Vec<_>>(), [(0, 30)]);
    }
}
