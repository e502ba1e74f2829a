//! The sessions as labels visit them: by start, equal lanes as one class.
//!
//! Starts and ends are ranks, which order as the instants do, so that they are compared in 32 bits.

use super::{MOST_DAYS, MOST_PLACES};
use crate::program::{Choice, Program};
use crate::schedule::model::Model;
use std::ops::Range;

/// Nothing of a place is taken.
pub(super) const FREE: i32 = -1;

/// Sessions of one class that start and end together: one for each lane of the class.
#[derive(Debug, Clone)]
pub(super) struct Item {
    pub(super) start: i64,
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
    /// Place in the list of each lane.
    place: usize,
}

/// Lanes with the same sessions, and where their places stand in a label.
#[derive(Debug, Clone)]
pub(super) struct Class {
    pub(super) lanes: Vec<usize>,
    /// Its places among a label's, one for each lane; none where sessions may overlap.
    pub(super) places: Range<usize>,
}

impl Class {
    /// Sessions of one item that can stand together.
    pub(super) const fn copies(&self) -> usize {
        self.lanes.len()
    }
}

/// All items, and the rules.
#[derive(Debug)]
pub(super) struct Items {
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
    /// Starts and lanes of a label.
    pub(super) places: usize,
    /// Sessions of each lane by place in its list.
    of_lane: Vec<Vec<usize>>,
}

impl Items {
    /// Sessions that bring something or must stand, with the values and choices of the programme; `None`
    /// where a label would need too many numbers.
    pub(super) fn new(model: &Model, program: &Program) -> Option<Self> {
        let sessions = &model.sessions;
        let must = |id: usize| program.choices[id] == Choice::Always;
        let mut of_lane: Vec<Vec<usize>> = vec![Vec::new(); model.lanes.max(1)];
        for (id, it) in sessions.iter().enumerate() {
            if must(id) || (program.values[id] > 0 && program.choices[id] == Choice::Free) {
                of_lane[it.lane].push(id);
            }
        }
        let facts = |id: usize| {
            let it = &sessions[id];
            (it.start, it.end, program.values[id], must(id))
        };
        let alike = |a: usize, b: usize| {
            let (a, b) = (&of_lane[a], &of_lane[b]);
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| facts(*a) == facts(*b))
        };
        let (count, window) = model.count.unwrap_or((0, 0));
        let mut classes: Vec<Class> = Vec::new();
        for lane in 0..of_lane.len() {
            match classes.iter_mut().find(|it| alike(it.lanes[0], lane)) {
                Some(class) => class.lanes.push(lane),
                None => classes.push(Class { lanes: vec![lane], places: 0..0 }),
            }
        }
        let mut places = count;
        for class in &mut classes {
            let own = if model.lanes == 0 { 0 } else { class.lanes.len() };
            let until = places.checked_add(own).filter(|it| *it <= MOST_PLACES)?;
            class.places = places..until;
            places = until;
        }
        let rank = |list: &[i64], at: i64| i32::try_from(list.partition_point(|it| *it < at)).ok();
        let sorted = |times: Vec<i64>| {
            let mut times = times;
            times.sort_unstable();
            times.dedup();
            times
        };
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
                    start_rank: rank(&starts, session.start)?,
                    end_rank: rank(&ends, session.end)?,
                    begun: rank(&ends, session.start.saturating_add(1))?,
                    left: rank(&starts, session.start.saturating_sub(window).saturating_add(1))?,
                    class,
                    value: program.values[id],
                    least: if must(id) { u32::try_from(it.lanes.len()).ok()? } else { 0 },
                    cell: model.cell_at(session.start),
                    parts,
                    place,
                });
            }
        }
        list.sort_by_key(|it| (it.start_rank, it.end_rank, it.class, it.place));
        let day_limit = model.day_limit;
        Some(Self { list, classes, starts, ends, day_limit, days, count, window, places, of_lane })
    }

    pub(super) const fn len(&self) -> usize {
        self.list.len()
    }

    /// The sessions of items taken, by start: each goes to the first lane of its class that is free.
    pub(super) fn sessions(&self, taken: &[usize]) -> Vec<usize> {
        let mut busy_until = vec![FREE; self.of_lane.len()];
        let mut ids: Vec<usize> = Vec::with_capacity(taken.len());
        for item in taken.iter().map(|&it| &self.list[it]) {
            let class = &self.classes[item.class];
            let free = |lane: &&usize| class.places.is_empty() || busy_until[**lane] < item.begun;
            if let Some(&lane) = class.lanes.iter().find(free) {
                busy_until[lane] = item.end_rank;
                ids.push(self.of_lane[lane][item.place]);
            }
        }
        ids.sort_unstable();
        ids
    }
}
