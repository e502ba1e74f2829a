//! The sessions as labels visit them: by start, equal lanes as one class.
//!
//! Starts and ends are ranks, which order as the instants do, so that they are compared in 32 bits.

use super::further::{Due, Further, Heat, Memory};
use super::size::{MOST_AMOUNTS, MOST_DAYS, MOST_PLACES};
use crate::program::Choice;
use crate::schedule::model::Model;
use crate::schedule::price::Prices;
use std::ops::Range;

/// Nothing of a place is taken.
pub(super) const FREE: i32 = -1;
/// No session has started on a lane.
pub(super) const NEVER: i32 = 1;

/// Sessions of one class that start and end together: one for each lane of the class.
#[derive(Debug, Clone)]
pub(super) struct Item {
    pub(super) start: i64,
    pub(super) end: i64,
    pub(super) start_rank: i32,
    pub(super) end_rank: i32,
    /// Ends of a lower rank have passed at the start.
    pub(super) begun: i32,
    /// Starts of a lower rank have left the window at the start.
    pub(super) left: i32,
    pub(super) class: usize,
    pub(super) value: i64,
    /// How many of them must stand.
    pub(super) least: u32,
    /// The cell that it starts in.
    pub(super) cell: usize,
    /// Time in that cell and in the following ones, ns.
    pub(super) parts: [i64; MOST_DAYS],
    /// What it does to the memory.
    pub(super) data: Produced,
    /// Place in the list of each lane.
    place: usize,
}

/// Data of an item, in ns of producing. Levels are as if all were there at its start, to be sent from then
/// on.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Produced {
    /// All of it.
    pub(super) all: i64,
    /// What contacts send between its start and its first data.
    pub(super) before: i64,
    /// What contacts cannot have sent at its end.
    pub(super) left: i64,
    /// The most that it is ahead of contacts meanwhile.
    pub(super) peak: i64,
    /// The least level at its start that is not too low at its end: contacts cannot send before there are
    /// data.
    pub(super) floor: i64,
}

/// Lanes with the same sessions, and where their places stand in a label.
#[derive(Debug, Clone)]
pub(super) struct Class {
    pub(super) lanes: Vec<usize>,
    /// Its places among a label's, one for each lane; none where sessions may overlap.
    pub(super) places: Range<usize>,
    /// The places of its last starts; none without windows of the longest gap.
    pub(super) last: Range<usize>,
}

impl Class {
    /// The classes of some lanes, by which of them are alike; no places yet.
    fn of(lanes: usize, alike: impl Fn(usize, usize) -> bool) -> Vec<Self> {
        let mut classes: Vec<Self> = Vec::new();
        for lane in 0..lanes {
            match classes.iter_mut().find(|it| alike(it.lanes[0], lane)) {
                Some(class) => class.lanes.push(lane),
                None => classes.push(Self { lanes: vec![lane], places: 0..0, last: 0..0 }),
            }
        }
        classes
    }

    /// Sessions of one item that can stand together.
    pub(super) const fn copies(&self) -> usize {
        self.lanes.len()
    }
}

impl Produced {
    /// Of an item that starts at an instant and produces from one to another.
    fn new(memory: &Memory, start: i64, (from, until): (i64, i64)) -> Self {
        let all = until - from;
        let left = (all - memory.sent(from, until)).max(0);
        // One ns for what is rounded down.
        let before = memory.sent(start, from) + 1;
        let floor = memory.ahead_at_end(from, until) + memory.sent(start, until) + 1;
        Self { all, before, left, peak: memory.peak(from, until), floor }
    }
}

/// Ascending distinct times.
fn sorted(mut times: Vec<i64>) -> Vec<i64> {
    times.sort_unstable();
    times.dedup();
    times
}

/// The places behind the last starts that classes hold, and the windows of the longest gap by their ends.
fn windows(
    classes: &mut [Class],
    further: &Further<'_>,
    first: usize,
) -> Option<(usize, Vec<(Due, usize)>)> {
    let (mut places, mut dues) = (first, Vec::new());
    for (index, class) in classes.iter_mut().enumerate() {
        let own = further.gaps.get(class.lanes[0]).filter(|it| !it.is_empty());
        if let Some(own) = own {
            let until = places.checked_add(class.lanes.len()).filter(|it| *it <= MOST_PLACES)?;
            class.last = places..until;
            places = until;
            dues.extend(own.iter().map(|due| (*due, index)));
        }
    }
    dues.sort_by_key(|it| (it.0.until, it.0.from, it.1));
    Some((places, dues))
}

/// All items, and the rules.
#[derive(Debug)]
pub(in crate::schedule) struct Items<'m> {
    /// Prices of overlap, days and windows of starts in the relaxation.
    pub(super) prices: &'m Prices,
    pub(super) list: Vec<Item>,
    pub(super) classes: Vec<Class>,
    /// Ascending distinct starts and ends, by rank.
    pub(super) starts: Vec<i64>,
    pub(super) ends: Vec<i64>,
    /// Most ns of a cell.
    pub(super) day_limit: Option<i64>,
    /// Cells that a session may touch beyond which nothing is counted.
    pub(super) days: usize,
    /// Most starts in a window; 0 without the rule.
    pub(super) count: usize,
    /// Length of the window in ns.
    pub(super) window: i64,
    /// Starts, lanes and last starts of a label.
    pub(super) places: usize,
    /// The first of the last starts.
    pub(super) last_starts: usize,
    /// Windows of the longest gap, by their ends, and the class that each is of.
    pub(super) dues: Vec<(Due, usize)>,
    pub(super) memory: Option<Memory>,
    pub(super) heat: Option<Heat>,
    /// Sessions of each lane by place in its list.
    of_lane: Vec<Vec<usize>>,
}

impl<'m> Items<'m> {
    /// Sessions that bring something or must stand, with the values and choices of the programme; `None`
    /// where a label would need too many numbers.
    pub(in crate::schedule) fn new(
        (model, prices): (&Model, &'m Prices),
        (values, choices): (&[i64], &[Choice]),
        further: &Further<'_>,
    ) -> Option<Self> {
        let sessions = &model.sessions;
        let must = |id: usize| choices[id] == Choice::Always;
        let mut of_lane: Vec<Vec<usize>> = vec![Vec::new(); model.lanes.max(1)];
        for (id, it) in sessions.iter().enumerate() {
            // What brings nothing may still end a gap.
            let serves = values[id] > 0 || !further.gaps.is_empty();
            if must(id) || (serves && choices[id] == Choice::Free) {
                of_lane[it.lane].push(id);
            }
        }
        let facts = |id: usize| {
            let it = &sessions[id];
            (it.start, it.end, values[id], must(id))
        };
        let alike = |a: usize, b: usize| {
            let (a, b) = (&of_lane[a], &of_lane[b]);
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| facts(*a) == facts(*b))
        };
        let alike = |a: usize, b: usize| alike(a, b) && further.gaps.get(a) == further.gaps.get(b);
        let (count, window) = model.count.unwrap_or((0, 0));
        let mut classes = Class::of(of_lane.len(), alike);
        let own = |class: &Class| if model.lanes == 0 { 0 } else { class.lanes.len() };
        let last_starts = classes.iter_mut().try_fold(count, |from, class| {
            let until = from.checked_add(own(class)).filter(|it| *it <= MOST_PLACES)?;
            class.places = from..until;
            Some(until)
        })?;
        let (places, dues) = windows(&mut classes, further, last_starts)?;
        let memory = further.memory.map(|it| Memory::new(it.0));
        let produced = |id: usize| match (&memory, further.memory) {
            (Some(memory), Some((_, produces))) => {
                Produced::new(memory, sessions[id].start, produces[id])
            }
            _ => Produced::default(),
        };
        let rank = |list: &[i64], at: i64| i32::try_from(list.partition_point(|it| *it < at)).ok();
        let starts = sorted(sessions.iter().map(|it| it.start).collect());
        let ends = sorted(sessions.iter().map(|it| it.end).collect());
        let (mut list, mut days) = (Vec::new(), 1);
        for (class, it) in classes.iter().enumerate() {
            for (place, &id) in of_lane[it.lanes[0]].iter().enumerate() {
                let session = &sessions[id];
                let mut parts = [0; MOST_DAYS];
                if model.day_limit.is_some() {
                    for (index, (_, ns)) in model.shares(session).enumerate() {
                        *parts.get_mut(index)? = ns;
                        days = days.max(index + 1);
                    }
                }
                list.push(Item {
                    start: session.start,
                    end: session.end,
                    start_rank: rank(&starts, session.start)?,
                    end_rank: rank(&ends, session.end)?,
                    begun: rank(&ends, session.start.saturating_add(1))?,
                    left: rank(&starts, session.start.saturating_sub(window).saturating_add(1))?,
                    class,
                    value: values[id],
                    least: if must(id) { u32::try_from(it.lanes.len()).ok()? } else { 0 },
                    cell: model.cell_at(session.start),
                    parts,
                    data: produced(id),
                    place,
                });
            }
        }
        list.sort_by_key(|it| (it.start_rank, it.end_rank, it.class, it.place));
        // A limit on windows of a day or more binds each day as well.
        let day = model.cells.windows(2).map(|it| it[1] - it[0]).max().unwrap_or(i64::MAX);
        let heat_limit = further.heat.filter(|it| it.1 >= day).map(|it| it.0);
        let day_limit = model.day_limit.map(|it| it.min(heat_limit.unwrap_or(it)));
        let heat = further.heat.map(|rule| {
            let starts = sorted(list.iter().map(|it: &Item| it.start).collect());
            let ends = sorted(list.iter().map(|it: &Item| it.end).collect());
            Heat::new(rule, &starts, &ends, model.longest)
        });
        let amounts = days + usize::from(memory.is_some()) + heat.as_ref().map_or(0, |it| it.slots);
        if amounts > MOST_AMOUNTS {
            return None;
        }
        Some(Self {
            prices,
            list,
            classes,
            starts,
            ends,
            day_limit,
            days,
            count,
            window,
            places,
            last_starts,
            dues,
            memory,
            heat,
            of_lane,
        })
    }

    /// Whether labels hold all that the rules need.
    pub(super) fn is_exact(&self) -> bool {
        self.memory.is_none()
            && self.heat.as_ref().is_none_or(|it| it.complete)
            && self.classes.iter().all(|it| it.last.len() < 2)
    }

    /// The place of what the memory holds among a label's amounts.
    pub(super) const fn fill(&self) -> usize {
        self.days
    }

    /// The place of the first line of thermal windows among a label's amounts.
    pub(super) fn first_line(&self) -> usize {
        self.days + usize::from(self.memory.is_some())
    }

    /// Amounts of a label.
    pub(super) fn amounts(&self) -> usize {
        self.first_line() + self.heat.as_ref().map_or(0, |it| it.slots)
    }

    pub(in crate::schedule) const fn len(&self) -> usize {
        self.list.len()
    }

    /// The sessions of items taken, by start: each goes to the free lane of its class that waits longest.
    pub(super) fn sessions(&self, taken: &[usize]) -> Vec<usize> {
        let mut busy_until = vec![FREE; self.of_lane.len()];
        let mut last_start = vec![FREE; self.of_lane.len()];
        let mut ids: Vec<usize> = Vec::with_capacity(taken.len());
        for item in taken.iter().map(|&it| &self.list[it]) {
            let class = &self.classes[item.class];
            let free = |lane: &&usize| class.places.is_empty() || busy_until[**lane] < item.begun;
            let waits = |lane: &&usize| last_start[**lane];
            if let Some(&lane) = class.lanes.iter().filter(free).min_by_key(waits) {
                (busy_until[lane], last_start[lane]) = (item.end_rank, item.start_rank);
                ids.push(self.of_lane[lane][item.place]);
            }
        }
        ids.sort_unstable();
        ids
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::demands::{Contact, Data};
    use onboard_core::time::Instant;

    #[test]
    fn what_a_contact_sends_before_there_are_data_is_not_taken_off() {
        let at = |seconds: i64| Instant::from_tai_ns(seconds * 1_000_000_000);
        let contacts = vec![Contact { from: at(100), until: at(110), bit_s: 2_000 }];
        let memory = Memory::new(&Data { rate_bit_s: 1_000, memory_bit: 60_000, contacts });
        let seconds = |count: i64| count * 1_000_000_000;
        // Set up from 100 s on, data from 105 to 140 s: the contact sends 10 s before and 10 s of them.
        let it = Produced::new(&memory, seconds(100), (seconds(105), seconds(140)));
        assert_eq!((it.all, it.left, it.peak), (seconds(35), seconds(25), seconds(25)));
        // Of an empty memory the first 5 s are sent and no more: 30 s at the end, with 20 s to be sent by then.
        assert_eq!((it.before, it.floor), (seconds(10) + 1, seconds(30 + 20) + 1));
    }
}
