//! Passes with short pauses between them, cut where they go on for long.
//!
//! Passes of one target over one telescope belong together while no pause exceeds the gap. What lasts
//! longer than the longest session is cut into the passes that begin in each slot of that length, slots
//! counted from the mission's start; passes with hardly a pause between them stay on one side of a cut.
//! A number is that of the slot of the first entry, times the gaps that a slot holds, plus the gaps in the
//! slot before the entry: two first entries in one slot are more than a gap apart.
//!
//! Limits: a piece lasts longer than the longest session by what begins just before a slot's end.

use super::pass::Pass;
use mission::sessions::Sessions;
use onboard_core::time::Instant;
use std::ops::Range;

/// Passes of one target over one telescope, by entry, in groups with their numbers.
pub(super) fn by_pause(
    passes: &[&Pass],
    start: Instant,
    sessions: Sessions,
) -> Vec<(u64, Range<usize>)> {
    let Sessions::ByPause { gap, longest, breath } = sessions else { return Vec::new() };
    let (gap_ns, longest_ns) = (gap.ns().max(1), longest.ns().max(1));
    let per_slot = longest_ns.saturating_add(gap_ns - 1) / gap_ns;
    let place = |it: &Pass| {
        let since_ns = it.entry.since(start).ns();
        (since_ns / longest_ns, since_ns % longest_ns / gap_ns)
    };
    let number = |it: &Pass| {
        let (slot, within) = place(it);
        u64::try_from(slot.saturating_mul(per_slot).saturating_add(within)).unwrap_or(0)
    };
    let mut groups = Vec::new();
    for burst in apart(passes, 0..passes.len(), gap_ns) {
        let last_exit = passes[burst.clone()].iter().map(|it| it.exit).max();
        let first_entry = passes[burst.start].entry;
        let lasts_ns = last_exit.map_or(0, |it| it.since(first_entry).ns());
        if lasts_ns <= longest_ns {
            groups.push((number(passes[burst.start]), burst));
            continue;
        }
        let breaths = apart(passes, burst, breath.ns());
        for slot in breaths.chunk_by(|a, b| place(passes[a.start]).0 == place(passes[b.start]).0) {
            let members = slot[0].start..slot[slot.len() - 1].end;
            groups.push((number(passes[members.start]), members));
        }
    }
    groups
}

/// Runs of passes with no pause above this between them.
fn apart(passes: &[&Pass], members: Range<usize>, pause_ns: i64) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    let mut covered_to = Instant::from_tai_ns(i64::MIN);
    for index in members {
        let pass = passes[index];
        match runs.last_mut() {
            Some(run) if pass.entry.since(covered_to).ns() <= pause_ns => run.end = index + 1,
            _ => runs.push(index..index + 1),
        }
        covered_to = covered_to.max(pass.exit);
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use onboard_core::time::Duration;

    fn pass((entry, exit): (i64, i64)) -> Pass {
        let at = Instant::from_tai_ns;
        let (entry, exit) = (at(entry), at(exit));
        let (entry_clipped, exit_clipped, closest) = (false, false, entry);
        let (target, telescope, detector) = (0, 0, 0);
        Pass { target, telescope, detector, entry, exit, closest, entry_clipped, exit_clipped }
    }

    fn grouped(times: &[(i64, i64)], numbers: [i64; 3]) -> Vec<(u64, Range<usize>)> {
        let [gap, longest, breath] = numbers.map(Duration::from_ns);
        let passes: Vec<Pass> = times.iter().map(|&it| pass(it)).collect();
        let passes: Vec<&Pass> = passes.iter().collect();
        by_pause(&passes, Instant::from_tai_ns(0), Sessions::ByPause { gap, longest, breath })
    }

    #[test]
    fn pauses_part_and_what_is_short_is_not_cut() {
        // Pauses of 10 and 11 at a gap of 10; the second group lies across the slot's end at 100.
        let found = grouped(&[(0, 5), (15, 20), (31, 80), (85, 120)], [10, 100, 1]);
        assert_eq!(found, [(0, 0..2), (3, 2..4)]);
    }

    #[test]
    fn what_lasts_long_is_cut_between_breaths() {
        // Slots of 100: the pass at 101 follows another within a breath.
        let times = [(40, 42), (60, 62), (80, 82), (99, 100), (101, 103), (121, 123), (199, 210)];
        assert_eq!(grouped(&times, [80, 100, 2]), [(0, 0..5), (2, 5..7)]);
        // One that covers others.
        assert_eq!(
            grouped(&[(0, 150), (10, 20), (160, 170)], [20, 100, 2]),
            [(0, 0..2), (8, 2..3)]
        );
    }

    #[test]
    fn numbers_are_each_once() {
        let mut at = 0;
        let times: Vec<(i64, i64)> = (0..5_000)
            .map(|index: i64| {
                at += 1 + index * index % 37;
                (at, at + 1 + index % 3)
            })
            .collect();
        for (gap, longest) in [(1, 7), (7, 5), (9, 100), (13, 90), (1000, 64)] {
            let mut numbers: Vec<u64> =
                grouped(&times, [gap, longest, 1]).iter().map(|it| it.0).collect();
            let all = numbers.len();
            numbers.sort_unstable();
            numbers.dedup();
            assert_eq!(numbers.len(), all, "{gap} {longest}");
        }
    }
}
