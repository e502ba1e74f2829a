//! Does a schedule meet every rule.
//!
//! Method: straight from the problem's own words, in wide integers, sharing no code with the modules
//! that build schedules: overlap by a sweep over sorted intervals, minutes per day by clipping each
//! interval to each day, starts per window by counting from every start, reserved time by sums over
//! every window that begins or ends with a session, memory by filling and draining it event by event,
//! scan angles by squares.
//!
//! Limits: the first rule broken is named; others may be.

use super::problem::Problem;
use super::rule::Exclusive;
use super::violation::Violation;
use crate::program::number::i128_from_f64;
use onboard_core::time::{Duration, Instant};
use std::collections::BTreeMap;

const NS: i128 = 1_000_000_000;

fn ns(at: Instant) -> i128 {
    i128::from(at.tai_ns())
}

/// A reserved interval.
#[derive(Debug, Clone, Copy)]
struct Interval {
    candidate: usize,
    from: i128,
    until: i128,
}

/// Checks a set of candidates against every rule of its problem.
///
/// # Errors
/// The first [`Violation`] found.
pub fn check(problem: &Problem, chosen: &[usize]) -> Result<(), Violation> {
    let rules = &problem.rules;
    let length = |span: Duration| i128::from(span.ns());
    let mut all = Vec::with_capacity(chosen.len());
    for &candidate in chosen {
        let it = problem.candidates.get(candidate).ok_or(Violation::Unknown(candidate))?;
        let from = ns(it.first_entry) - length(rules.setup);
        let until = ns(it.last_exit) + length(rules.cooldown);
        if from < ns(problem.span.0) || until > ns(problem.span.1) {
            return Err(Violation::Outside(candidate));
        }
        all.push(Interval { candidate, from, until });
    }
    let mut sorted = chosen.to_vec();
    sorted.sort_unstable();
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Violation::Twice(pair[0]));
    }
    check_overlap(problem, &all)?;
    check_days(problem, &all)?;
    check_counts(problem, &all)?;
    check_demands(problem, chosen)
}

fn check_overlap(problem: &Problem, all: &[Interval]) -> Result<(), Violation> {
    let mut groups: BTreeMap<usize, Vec<Interval>> = BTreeMap::new();
    for interval in all {
        let group = match problem.rules.exclusive {
            Exclusive::None => return Ok(()),
            Exclusive::Telescope => problem.candidates[interval.candidate].telescope,
            Exclusive::All => 0,
        };
        groups.entry(group).or_default().push(*interval);
    }
    for group in groups.values_mut() {
        group.sort_unstable_by_key(|it| (it.from, it.until, it.candidate));
        for pair in group.windows(2) {
            if pair[1].from < pair[0].until {
                return Err(Violation::Overlap(pair[0].candidate, pair[1].candidate));
            }
        }
    }
    Ok(())
}

fn check_days(problem: &Problem, all: &[Interval]) -> Result<(), Violation> {
    let Some(limit) = problem.rules.max_per_day else { return Ok(()) };
    let mut ordered = all.to_vec();
    ordered.sort_unstable_by_key(|it| it.from);
    let longest = ordered.iter().map(|it| it.until - it.from).max().unwrap_or(0);
    for (day, pair) in problem.rules.day_boundaries.windows(2).enumerate() {
        let (from, until) = (i128::from(pair[0].tai_ns()), i128::from(pair[1].tai_ns()));
        let first = ordered.partition_point(|it| it.from < from - longest);
        let used_ns: i128 = ordered[first..]
            .iter()
            .take_while(|it| it.from < until)
            .map(|it| (it.until.min(until) - it.from.max(from)).max(0))
            .sum();
        if used_ns > i128::from(limit.ns()) {
            return Err(Violation::Day { day, used_ns, limit_ns: limit.ns() });
        }
    }
    Ok(())
}

fn check_counts(problem: &Problem, all: &[Interval]) -> Result<(), Violation> {
    let Some(rule) = problem.rules.max_sessions else { return Ok(()) };
    let mut starts: Vec<i128> = all.iter().map(|it| it.from).collect();
    starts.sort_unstable();
    let mut last = 0;
    for (first, &from_tai_ns) in starts.iter().enumerate() {
        while last < starts.len() && starts[last] < from_tai_ns + i128::from(rule.window.ns()) {
            last += 1;
        }
        let inside = last - first;
        if u32::try_from(inside).map_or(true, |inside| inside > rule.count) {
            return Err(Violation::Count { from_tai_ns, starts: inside, count: rule.count });
        }
    }
    Ok(())
}

/// The first demand that a schedule breaks.
fn check_demands(problem: &Problem, chosen: &[usize]) -> Result<(), Violation> {
    let demands = &problem.demands;
    for &candidate in chosen {
        let (from, until) = problem.reserved(candidate);
        if demands.forbidden.contains(&candidate) {
            return Err(Violation::Forbidden(candidate));
        }
        if demands.avoided.contains(&candidate) {
            return Err(Violation::Avoided(candidate));
        }
        if demands.blackouts.iter().any(|it| it.0 < until && from < it.1) {
            return Err(Violation::Blackout(candidate));
        }
    }
    if let Some(&missing) = demands.fixed.iter().find(|it| !chosen.contains(it)) {
        return Err(Violation::Fixed(missing));
    }
    heat(problem, chosen)?;
    memory(problem, chosen)?;
    angles(problem, chosen)?;
    seasons(problem, chosen)
}

fn heat(problem: &Problem, chosen: &[usize]) -> Result<(), Violation> {
    let Some(rule) = problem.demands.thermal else { return Ok(()) };
    let mut all: Vec<(i128, i128)> = chosen
        .iter()
        .map(|&it| problem.reserved(it))
        .map(|(from, until)| (ns(from), ns(until)))
        .collect();
    all.sort_unstable();
    let window = i128::from(rule.window.ns());
    let longest = all.iter().map(|it| it.1 - it.0).max().unwrap_or(0);
    for from in all.iter().flat_map(|it| [it.0, it.1 - window]) {
        let first = all.partition_point(|it| it.0 < from - longest);
        let near = all[first..].iter().take_while(|it| it.0 < from + window);
        let used: i128 = near.map(|it| (it.1.min(from + window) - it.0.max(from)).max(0)).sum();
        if used > i128::from(rule.most.ns()) {
            return Err(Violation::Thermal { from_tai_ns: from, used_ns: used });
        }
    }
    Ok(())
}

fn memory(problem: &Problem, chosen: &[usize]) -> Result<(), Violation> {
    let Some(data) = &problem.demands.data else { return Ok(()) };
    // Rates in force between events, in bits per second.
    let mut events: BTreeMap<i128, i128> = BTreeMap::new();
    let mut add = |from: Instant, until: Instant, rate: i128| {
        *events.entry(ns(from)).or_default() += rate;
        *events.entry(ns(until)).or_default() -= rate;
    };
    for &candidate in chosen {
        let it = &problem.candidates[candidate];
        add(it.first_entry, it.last_exit, i128::from(data.rate_bit_s));
    }
    for contact in &data.contacts {
        add(contact.from, contact.until, -i128::from(contact.bit_s));
    }
    let (mut held, mut rate, mut last) = (0_i128, 0_i128, None::<i128>);
    for (at, change) in events {
        if let Some(last) = last {
            held = (held + rate * (at - last)).max(0);
        }
        if held > i128::from(data.memory_bit) * NS {
            return Err(Violation::Memory { at_tai_ns: at, held_bit: held / NS });
        }
        rate += change;
        last = Some(at);
    }
    Ok(())
}

fn angles(problem: &Problem, chosen: &[usize]) -> Result<(), Violation> {
    for rule in &problem.demands.diversity {
        let mut sums: BTreeMap<(usize, usize), [i128; 3]> = BTreeMap::new();
        for &candidate in chosen {
            let it = &problem.candidates[candidate];
            let [weight, cos, sin] = rule.sums[candidate];
            let whole =
                [(rule.rho * (weight * 1e3)).floor(), (cos * 1e3).round(), (sin * 1e3).round()];
            let sum = sums.entry((it.target, it.telescope)).or_default();
            for (sum, of) in sum.iter_mut().zip(whole) {
                *sum += i128_from_f64(of);
            }
        }
        for ((target, telescope), [most, c, s]) in sums {
            if c * c + s * s > most * most {
                return Err(Violation::ScanAngle { n: rule.n, target, telescope });
            }
        }
    }
    Ok(())
}

fn seasons(problem: &Problem, chosen: &[usize]) -> Result<(), Violation> {
    let Some(rule) = problem.demands.min_sessions else { return Ok(()) };
    let start = ns(problem.span.0);
    let length = i128::from(rule.window.ns());
    let season = |candidate: usize| (ns(problem.reserved(candidate).0) - start).div_euclid(length);
    let mut counts: BTreeMap<(usize, usize, i128), (i128, i128)> = BTreeMap::new();
    for (candidate, it) in problem.candidates.iter().enumerate() {
        let (from, until) = problem.reserved(candidate);
        let inside = from >= problem.span.0 && until <= problem.span.1;
        if inside && problem.value(candidate) > 0.0 && !problem.demands.avoided.contains(&candidate)
        {
            counts.entry((it.target, it.telescope, season(candidate))).or_default().0 += 1;
        }
    }
    for &candidate in chosen {
        let it = &problem.candidates[candidate];
        counts.entry((it.target, it.telescope, season(candidate))).or_default().1 += 1;
    }
    for ((target, telescope, season), (offered, held)) in counts {
        let end = (start + (season + 1) * length).min(ns(problem.span.1));
        let part = end - (start + season * length);
        let wanted = (i128::from(rule.count) * part / length).min(offered);
        if held < wanted {
            return Err(Violation::Season { target, telescope, held, wanted });
        }
    }
    Ok(())
}
