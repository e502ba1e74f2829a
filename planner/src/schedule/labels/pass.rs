//! One pass over all items with the labels that live.
//!
//! Method: each label may take each item. Labels stand by falling value; a new one is kept unless one
//! before it is no worse in any resource. Starts that have left the window, and ends that have passed,
//! are forgotten, which lets more labels dominate: every [`AGAIN`] items all are tested again.
//!
//! With [`Keep::Best`] labels of the largest prospects are kept (value less what a label uses of the time to
//! come, at the relaxation's prices), so the result is a schedule. With
//! [`Keep::Merged`] a label absorbs others of at most its value whose resources are at most a slack
//! better, its own lowered to theirs; the slack is doubled until the rest fits. What is absorbed can do
//! no more than what absorbed it, so the largest value at the end bounds every schedule.
//!
//! How many labels may live follows from the [`Effort`] that is left, so that all items are visited in
//! bounded work, which is counted and not timed: equal input gives equal results.

use super::columns::{Columns, Label};
use super::effort::Effort;
use super::items::{FREE, Item, Items};
use crate::progress::Progress;
use std::cmp::Reverse;

/// Items between two tests of all labels.
const AGAIN: usize = 4;
/// First slack of time, in ns: a minute.
const SLACK_NS: i64 = 60_000_000_000;
/// Numbers of a label under the plain rules.
const PLAIN_WEIGHT: usize = 11;
/// Items between two questions whether to stop.
const ASK: usize = 64;
/// Links above which those that no label needs are dropped.
const MANY_LINKS: usize = 1 << 22;

/// What happens to labels beyond what the effort allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Keep {
    /// Those of the least prospects go.
    Best,
    /// They are absorbed by others.
    Merged,
}

/// The largest value at the end of a pass.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Passed {
    /// Items taken, by start; none where labels were absorbed.
    pub(super) taken: Vec<usize>,
    pub(super) value: i64,
    /// No label was cut or absorbed: this is the optimum.
    pub(super) exact: bool,
}

/// Visits all items; `None` when the search is to stop, or no schedule has all that must stand.
pub(super) fn pass(
    items: &Items<'_>,
    keep: Keep,
    effort: Effort,
    progress: &dyn Progress,
) -> Option<Passed> {
    let mut front = Front::new(items, keep, effort);
    for (index, item) in items.list.iter().enumerate() {
        if index % ASK == 0 {
            if progress.stopped() {
                return None;
            }
            progress.advance(u64::try_from(ASK.min(items.len() - index)).unwrap_or(0));
        }
        front.visit(index, item)?;
    }
    front.best()
}

/// The labels that live, by falling value.
struct Front<'i> {
    items: &'i Items<'i>,
    keep: Keep,
    effort: Effort,
    labels: Columns,
    /// Room for the next ones.
    next: Columns,
    new: Vec<Label>,
    /// Session and link before it, of each session of a label; the first is none.
    links: Vec<(u32, u32)>,
    cell: usize,
    /// The last instant visited.
    at: i64,
    /// The first window of the longest gap that has not passed.
    due: usize,
    /// The first line whose window has not passed.
    line: usize,
    /// Reserved intervals of a label's sessions that still count.
    standing: Vec<(i64, i64)>,
    exact: bool,
    /// Numbers of a label, those of 64 bits twice.
    weight: usize,
}

impl<'i> Front<'i> {
    fn new(items: &'i Items<'i>, keep: Keep, effort: Effort) -> Self {
        let empty = || Columns::new(items.amounts(), items.places);
        let mut labels = empty();
        labels.push(&Label::empty(items.last_starts));
        let first = items.list.first();
        Self {
            items,
            keep,
            effort,
            labels,
            next: empty(),
            new: Vec::new(),
            links: vec![(0, 0)],
            cell: first.map_or(0, |it| it.cell),
            at: first.map_or(0, |it| it.start),
            due: 0,
            line: 0,
            standing: Vec::new(),
            exact: items.is_exact(),
            weight: items.places + 2 * items.amounts(),
        }
    }

    /// `None` where there are more links than can be told apart.
    fn visit(&mut self, index: usize, item: &Item) -> Option<()> {
        self.forget(item);
        self.take(item);
        if item.least > 0 {
            self.labels.clear();
        } else if self.new.is_empty() {
            return Some(());
        }
        self.new.sort_by_key(|it| Reverse(it.value));
        self.merge(index)?;
        let width = self.effort.width(self.items.len() - index);
        match self.keep {
            Keep::Best => {
                if self.labels.len() > width {
                    self.exact = false;
                    let prospects = self.prospects(item);
                    self.labels.keep_best(&prospects, width);
                }
            }
            Keep::Merged => {
                let mut slack = SLACK_NS;
                while self.labels.len() > width {
                    self.exact = false;
                    self.absorb(item, slack);
                    slack = slack.checked_mul(2)?;
                }
            }
        }
        if self.links.len() > MANY_LINKS {
            self.drop_links();
        }
        Some(())
    }

    /// What each label is worth less what it uses of the time to come, at the relaxation's prices.
    fn prospects(&self, item: &Item) -> Vec<i64> {
        let (items, prices) = (self.items, self.items.prices);
        let mut prospects = self.labels.value.clone();
        for (ahead, column) in self.labels.used[..items.days].iter().enumerate() {
            for (prospect, used) in prospects.iter_mut().zip(column) {
                *prospect = prospect.saturating_sub(prices.cell_cost(item.cell + ahead, *used));
            }
        }
        let at = |times: &[i64], rank: i32| {
            usize::try_from(rank).ok().and_then(|rank| times.get(rank)).copied()
        };
        let open = item.start.saturating_sub(items.window).saturating_add(1);
        for column in &self.labels.places[..items.count] {
            for (prospect, rank) in prospects.iter_mut().zip(column) {
                if let Some(start) = at(&items.starts, *rank) {
                    let pays = prices.windows.sum(open, start.saturating_add(1));
                    *prospect = prospect.saturating_sub(pays);
                }
            }
        }
        for class in &items.classes {
            let Some(lane) = prices.lanes.get(class.lanes[0]) else { continue };
            for column in &self.labels.places[class.places.clone()] {
                for (prospect, rank) in prospects.iter_mut().zip(column) {
                    if let Some(end) = at(&items.ends, *rank) {
                        *prospect = prospect.saturating_sub(lane.sum(item.start, end));
                    }
                }
            }
        }
        prospects
    }

    /// Drops the links that no label needs: each leads to an earlier one.
    fn drop_links(&mut self) {
        let mut needed = vec![false; self.links.len()];
        for link in self.labels.links() {
            let mut at = *link as usize;
            while !std::mem::replace(&mut needed[at], true) {
                at = self.links[at].0 as usize;
            }
        }
        let mut place = vec![0_u32; self.links.len()];
        let mut kept = 0_u32;
        let mut links = Vec::new();
        for (at, needed) in needed.into_iter().enumerate() {
            if needed {
                place[at] = kept;
                kept += 1;
                links.push((place[self.links[at].0 as usize], self.links[at].1));
            }
        }
        self.labels.links_mut().iter_mut().for_each(|it| *it = place[*it as usize]);
        self.links = links;
    }

    /// Forgets days, starts and ends that have passed, sends data, charges gaps.
    fn forget(&mut self, item: &Item) {
        self.charge(item.start);
        let days = &mut self.labels.used[..self.items.days];
        while self.cell < item.cell {
            days.rotate_left(1);
            if let Some(last) = days.last_mut() {
                last.fill(0);
            }
            self.cell += 1;
        }
        if let Some(memory) = &self.items.memory {
            let over = i64::from(self.keep == Keep::Merged);
            let sent = memory.sent(self.at, item.start) + over;
            let fill = &mut self.labels.used[self.items.fill()];
            for held in fill.iter_mut() {
                *held = held.saturating_sub(sent).max(0);
            }
        }
        self.at = item.start;
        if let Some(heat) = &self.items.heat {
            let first = self.items.first_line();
            while let Some(line) = heat.lines.get(self.line)
                && line.saturating_add(heat.window) <= item.start
                && !heat.complete
            {
                self.labels.used[first + self.line % heat.slots].fill(0);
                self.line += 1;
            }
        }
        let places = &mut self.labels.places[..self.items.last_starts];
        let (starts, lanes) = places.split_at_mut(self.items.count);
        for (columns, passed) in [(starts, item.left), (lanes, item.begun)] {
            for place in columns.iter_mut().flatten() {
                *place = if *place < passed { FREE } else { *place };
            }
        }
    }

    /// Charges the windows of the longest gap that have passed by an instant to the labels of which no
    /// session starts in them.
    fn charge(&mut self, at: i64) {
        let mut charged = false;
        while let Some((due, class)) = self.items.dues.get(self.due).filter(|it| it.0.until <= at) {
            let starts = &self.items.starts;
            let from = i32::try_from(starts.partition_point(|it| *it < due.from));
            let from = from.unwrap_or(i32::MAX);
            for place in self.items.classes[*class].last.clone() {
                for (value, last) in self.labels.value.iter_mut().zip(&self.labels.places[place]) {
                    if *last > -from {
                        *value = value.saturating_sub(due.price);
                        charged = true;
                    }
                }
            }
            self.due += 1;
        }
        if charged {
            self.labels.sort();
        }
    }

    /// New labels: each that can takes the item, as often as it can.
    fn take(&mut self, item: &Item) {
        self.new.clear();
        for index in 0..self.labels.len() {
            if !self.may_fit(index, item) {
                continue;
            }
            let mut label = self.labels.get(index);
            for _ in 0..self.items.classes[item.class].copies() {
                if !self.fits(&label, item) || !self.cools(&label, item) {
                    break;
                }
                self.add(&mut label, item);
                if label.copies >= item.least {
                    self.new.push(label);
                }
            }
        }
    }

    /// Whether a label has room for the item by its columns alone.
    fn may_fit(&self, index: usize, item: &Item) -> bool {
        let free = |place: usize| self.labels.places[place][index] == FREE;
        let lane = self.items.classes[item.class].places.clone().last();
        let within = |most| self.labels.used[0][index].saturating_add(item.parts[0]) <= most;
        lane.is_none_or(free)
            && self.items.count.checked_sub(1).is_none_or(free)
            && self.items.day_limit.is_none_or(within)
    }

    fn fits(&self, label: &Label, item: &Item) -> bool {
        let free = |place: usize| label.places[place] == FREE;
        let lane = self.items.classes[item.class].places.clone().last();
        let mut days = label.used.iter().zip(item.parts).take(self.items.days);
        let holds = |size: i64| {
            let held = label.used[self.items.fill()];
            size >= match self.keep {
                Keep::Best => held.saturating_add(item.data.peak),
                Keep::Merged => held.saturating_sub(item.data.before).max(0) + item.data.left,
            }
        };
        lane.is_none_or(free)
            && self.items.count.checked_sub(1).is_none_or(free)
            && self.items.day_limit.is_none_or(|most| {
                days.all(|(used, part)| part == 0 || used.saturating_add(part) <= most)
            })
            && self.items.memory.as_ref().is_none_or(|it| holds(it.size))
    }

    /// Whether thermal windows have room for the item.
    fn cools(&mut self, label: &Label, item: &Item) -> bool {
        let Some(heat) = &self.items.heat else { return true };
        let used = &label.used[self.items.first_line()..];
        let new = (item.start, item.end);
        let fits = |(slot, part): (usize, i64)| used[slot].saturating_add(part) <= heat.most;
        if !heat.touched(self.line, new).all(fits) {
            return false;
        }
        if heat.complete || self.keep == Keep::Merged {
            return true;
        }
        self.standing.clear();
        self.standing.extend(std::iter::repeat_n(new, label.copies as usize));
        let earliest = item.start.saturating_sub(heat.window).saturating_sub(heat.longest);
        let mut link = label.link;
        while let Some(&(before, index)) = self.links.get(link as usize).filter(|_| link > 0) {
            let it = &self.items.list[index as usize];
            if it.start < earliest {
                break;
            }
            self.standing.push((it.start, it.end));
            link = before;
        }
        self.effort.spend(self.standing.len().pow(2));
        heat.allows(&self.standing, new)
    }

    fn add(&self, label: &mut Label, item: &Item) {
        label.value = label.value.saturating_add(item.value);
        label.copies += 1;
        for (used, part) in label.used.iter_mut().zip(item.parts) {
            *used = used.saturating_add(part);
        }
        if self.items.memory.is_some() {
            let fill = &mut label.used[self.items.fill()];
            *fill = match self.keep {
                Keep::Best => fill.saturating_add(item.data.all).max(item.data.floor),
                Keep::Merged => fill.saturating_add(item.data.left),
            };
        }
        if let Some(heat) = &self.items.heat {
            let used = &mut label.used[self.items.first_line()..];
            for (slot, part) in heat.touched(self.line, (item.start, item.end)) {
                used[slot] = used[slot].saturating_add(part);
            }
        }
        let last = &mut label.places[self.items.classes[item.class].last.clone()];
        if let Some(place) = last.last_mut() {
            *place = -item.start_rank;
            last.rotate_right(1);
        }
        let starts = &mut label.places[..self.items.count];
        if let Some(last) = starts.last_mut() {
            *last = item.start_rank;
            starts.rotate_right(1);
        }
        let lanes = &mut label.places[self.items.classes[item.class].places.clone()];
        if let Some(last) = lanes.last_mut() {
            *last = item.end_rank;
            lanes.sort_unstable_by_key(|end| Reverse(*end));
        }
    }

    /// Old and new labels by falling value, dominated ones left out.
    fn merge(&mut self, index: usize) -> Option<()> {
        let again = index.is_multiple_of(AGAIN);
        let mut new = std::mem::take(&mut self.new);
        let mut news = new.iter_mut().peekable();
        self.next.clear();
        for old in 0..self.labels.len() {
            let value = self.labels.value[old];
            while let Some(label) = news.next_if(|it| it.value > value) {
                self.keep_new(label, index)?;
            }
            let label = self.labels.get(old);
            if !again || self.seek(&label).is_none() {
                self.next.push(&label);
            }
        }
        for label in news {
            self.keep_new(label, index)?;
        }
        self.new = new;
        std::mem::swap(&mut self.labels, &mut self.next);
        Some(())
    }

    /// Adds a new label, unless one before it dominates it.
    fn keep_new(&mut self, label: &mut Label, index: usize) -> Option<()> {
        if self.seek(label).is_some() {
            return Some(());
        }
        let copies = if self.keep == Keep::Best || self.exact { label.copies } else { 0 };
        for _ in 0..copies {
            let link = u32::try_from(self.links.len()).ok()?;
            self.links.push((label.link, u32::try_from(index).ok()?));
            label.link = link;
        }
        label.copies = 0;
        self.next.push(label);
        Some(())
    }

    /// The first of the next labels that is no worse than this one.
    fn seek(&mut self, label: &Label) -> Option<usize> {
        let found = self.next.no_worse(label, self.next.len());
        self.effort
            .spend(found.unwrap_or(self.next.len()).saturating_mul(self.weight) / PLAIN_WEIGHT);
        found
    }

    /// Lets each label absorb those of at most its value that are better by at most `slack_ns`.
    fn absorb(&mut self, item: &Item, slack_ns: i64) {
        self.next.clear();
        let items = self.items;
        let (starts, ends) = (&items.starts, &items.ends);
        let left = item.start.saturating_sub(self.items.window);
        let later = |times: &[i64], rank: i32, passed: i64| {
            let at = usize::try_from(rank).ok().and_then(|rank| times.get(rank)).copied();
            let until = at.unwrap_or(passed).saturating_add(slack_ns);
            let count = i32::try_from(times.partition_point(|it| *it <= until));
            count.map_or(i32::MAX, |count| count - 1)
        };
        for index in 0..self.labels.len() {
            let label = self.labels.get(index);
            let mut limit = label;
            for used in &mut limit.used {
                *used = used.saturating_add(slack_ns);
            }
            // Last starts get no slack: bounds have gaps dualised.
            let places = &mut limit.places[..items.last_starts];
            let (first, lanes) = places.split_at_mut(items.count);
            for place in first {
                *place = later(starts, *place, left);
            }
            for place in lanes {
                *place = later(ends, *place, item.start);
            }
            match self.seek(&limit) {
                Some(other) => self.next.lower(other, &label),
                None => self.next.push(&label),
            }
        }
        std::mem::swap(&mut self.labels, &mut self.next);
    }

    fn best(mut self) -> Option<Passed> {
        self.charge(i64::MAX);
        // They stand by falling value.
        let best = (self.labels.len() > 0).then(|| self.labels.get(0))?;
        let mut taken = Vec::new();
        let mut link = if self.keep == Keep::Best || self.exact { best.link } else { 0 };
        while let Some(&(before, index)) = self.links.get(link as usize).filter(|_| link > 0) {
            taken.extend(usize::try_from(index));
            link = before;
        }
        taken.reverse();
        Some(Passed { taken, value: best.value, exact: self.exact })
    }
}
