//! Schedules under every demand against exhaustive search, the demands read literally.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

mod random;
mod stopping;

use ephem::random::SplitMix64;
use onboard_core::time::{Duration, Instant};
use planner::schedule::{
    Candidate, Contact, Data, Demands, Diversity, Exclusive, Log, LongestGap, Previous, Problem,
    RuleName, Rules, ScheduleError, SessionCount, Stopped, Thermal, check, schedule,
    schedule_until,
};
use random::between;
use std::collections::BTreeMap;
use stopping::Stopping;

const MINUTE: i64 = 60_000_000_000;
const DAY: i64 = 1_440 * MINUTE;

fn at(minute: i64) -> Instant {
    Instant::from_tai_ns(minute * MINUTE)
}

fn minutes(count: i64) -> Duration {
    Duration::from_ns(count * MINUTE)
}

fn problem(candidates: Vec<Candidate>, days: i64) -> Problem {
    Problem {
        span: (at(0), at(1_440 * days)),
        candidates,
        weights: vec![1.0, 0.5],
        rules: Rules {
            setup: minutes(10),
            cooldown: minutes(5),
            exclusive: Exclusive::Telescope,
            max_per_day: Some(minutes(400)),
            max_sessions: Some(SessionCount { count: 3, window: minutes(1_440) }),
            day_boundaries: (0..=days).map(|day| at(1_440 * day)).collect(),
        },
        demands: Demands::default(),
    }
}

fn candidate(target: usize, telescope: usize, start: i64, length: i64) -> Candidate {
    Candidate {
        target,
        telescope,
        first_entry: at(start),
        last_exit: at(start + length),
        dwell: minutes(length / 2),
    }
}

fn index(number: i64) -> usize {
    usize::try_from(number).unwrap()
}

/// A few candidates over four days, under random demands.
fn small(random: &mut SplitMix64) -> Problem {
    let count = between(random, 3, 11);
    let candidates: Vec<Candidate> = (0..count)
        .map(|_| {
            candidate(
                index(between(random, 0, 1)),
                index(between(random, 0, 1)),
                between(random, 5, 5_600),
                between(random, 30, 150),
            )
        })
        .collect();
    let chance = |random: &mut SplitMix64, of: i64| between(random, 0, of - 1) == 0;
    let pick = |random: &mut SplitMix64| index(between(random, 0, count - 1));
    let mut demands = Demands::default();
    if chance(random, 3) {
        demands.min_sessions = Some(SessionCount { count: 1, window: minutes(2_880) });
    }
    if chance(random, 2) {
        demands.longest_gap = Some(LongestGap {
            longest: minutes(between(random, 400, 2_000)),
            price_per_day: 2_000.0,
        });
    }
    if chance(random, 3) {
        let sums = candidates.iter().map(|it| {
            let angle = f64::from(i32::try_from(between(random, 0, 359)).unwrap()).to_radians();
            let w = it.dwell.seconds();
            [w, w * (2.0 * angle).cos(), w * (2.0 * angle).sin()]
        });
        demands.diversity = vec![Diversity { n: 2, rho: 0.6, sums: sums.collect() }];
    }
    if chance(random, 2) {
        let contacts = (0..4).map(|day| Contact {
            from: at(1_440 * day + 600),
            until: at(1_440 * day + 700),
            bit_s: 300,
        });
        demands.data =
            Some(Data { rate_bit_s: 1_000, memory_bit: 9_000_000, contacts: contacts.collect() });
    }
    if chance(random, 2) {
        let most = minutes(between(random, 120, 300));
        demands.thermal = Some(Thermal { most, window: minutes(700) });
    }
    if chance(random, 3) {
        demands.blackouts = vec![(at(1_000), at(1_400)), (at(3_000), at(3_100))];
    }
    if chance(random, 3) {
        demands.avoided = vec![pick(random)];
    }
    if chance(random, 4) {
        demands.fixed = vec![pick(random)];
    }
    if chance(random, 4) {
        demands.forbidden = vec![pick(random)];
    }
    if chance(random, 3) {
        let sessions = (0..index(count)).filter(|_| between(random, 0, 2) == 0).collect();
        demands.previous = Some(Previous { sessions, price: 700.0 });
    }
    if chance(random, 3) {
        let parts = candidates.iter().map(|it| {
            let first = it.dwell.ns() / 3;
            let rest = Duration::from_ns(it.dwell.ns() - first);
            vec![(0, Duration::from_ns(first)), (u32::from(chance(random, 2)) + 1, rest)]
        });
        let parts = parts.collect();
        let mut weights = BTreeMap::new();
        if chance(random, 2) {
            weights.extend([((0, 1), 0.25), ((1, 2), 1.75)]);
        }
        demands.log = Some(Log { offset: minutes(10), epoch: minutes(2_880), parts, weights });
        demands.longest_gap = demands.longest_gap.map(|it| LongestGap { price_per_day: 0.7, ..it });
        if let Some(previous) = &mut demands.previous {
            previous.price = 0.3;
        }
    }
    if demands.log.is_none() && chance(random, 3) {
        let mut value = || f64::from(i32::try_from(between(random, 1, 4_000)).unwrap()) * 1.5;
        demands.values = candidates.iter().map(|_| value()).collect();
    }
    Problem { demands, ..problem(candidates, 4) }
}

/// What a schedule is worth, from the words of the demands.
fn worth(problem: &Problem, chosen: &[usize]) -> f64 {
    let demands = &problem.demands;
    let mut worth = match &demands.log {
        None => chosen.iter().map(|&it| problem.value(it)).sum::<f64>(),
        Some(log) => {
            let mut cells: BTreeMap<(usize, usize, i64, u32), f64> = BTreeMap::new();
            for &it in chosen {
                let epoch = problem.reserved(it).0.tai_ns() / log.epoch.ns();
                let of = &problem.candidates[it];
                for &(bin, time) in &log.parts[it] {
                    *cells.entry((of.target, of.telescope, epoch, bin)).or_default() +=
                        time.seconds();
                }
            }
            cells
                .iter()
                .map(|(key, t)| {
                    let own = log.weights.get(&(key.0, key.3));
                    let weight = own.unwrap_or(&problem.weights[key.0]);
                    weight * (1.0 + t / log.offset.seconds()).ln()
                })
                .sum()
        }
    };
    if let Some(gap) = demands.longest_gap {
        // Candidates that can never stand leave a window without an opportunity.
        let possible = |it: &usize| {
            let mut alone = problem.clone();
            alone.demands = Demands {
                blackouts: demands.blackouts.clone(),
                avoided: demands.avoided.clone(),
                forbidden: demands.forbidden.clone(),
                ..Demands::default()
            };
            problem.value(*it) > 0.0 && check(&alone, &[*it]).is_ok()
        };
        let open: Vec<usize> = (0..problem.candidates.len()).filter(possible).collect();
        for telescope in 0..2 {
            let mut from = problem.span.0;
            while from.plus(gap.longest) <= problem.span.1 {
                let inside = |it: &&usize| {
                    let start = problem.reserved(**it).0;
                    problem.candidates[**it].telescope == telescope
                        && (from..from.plus(gap.longest)).contains(&start)
                };
                if open.iter().any(|it| inside(&it)) && !chosen.iter().any(|it| inside(&it)) {
                    worth -= gap.price_per_day * gap.step().seconds() / 86_400.0;
                }
                from = from.plus(gap.step());
            }
        }
    }
    if let Some(previous) = &demands.previous {
        let count = problem.candidates.len();
        let changed =
            (0..count).filter(|it| chosen.contains(it) != previous.sessions.contains(it)).count();
        worth -= previous.price * f64::from(u32::try_from(changed).unwrap());
    }
    worth
}

/// The best worth by exhaustive search; `None` where no set meets the rules.
fn exhaustive(problem: &Problem) -> Option<f64> {
    let count = problem.candidates.len();
    let sets = (0_u32..1 << count).map(|set| (0..count).filter(move |it| set >> it & 1 == 1));
    let sets = sets.map(Iterator::collect::<Vec<usize>>);
    let allowed = sets.filter(|chosen| check(problem, chosen).is_ok());
    allowed.map(|chosen| worth(problem, &chosen)).reduce(f64::max)
}

/// Schedule and bound are those of exhaustive search; false where the rules contradict each other.
fn agrees(problem: &Problem, round: usize) -> bool {
    match (schedule(problem), exhaustive(problem)) {
        (Ok(found), Some(best)) => {
            assert_eq!(check(problem, &found.chosen), Ok(()), "round {round}");
            let own = worth(problem, &found.chosen);
            let close = 1e-6 * best.abs().max(1.0);
            assert!((found.objective - own).abs() < close, "round {round}: {own}");
            assert!(found.upper_bound >= best - close, "round {round}: bound too low");
            assert!(found.objective >= best - close, "round {round}: {found:?} {best}");
            assert_eq!(found.stopped, Stopped::Optimal, "round {round}");
            assert!(found.gap.abs() < 1e-6, "round {round}: {}", found.gap);
            let all = found.chosen.len() + found.rejected.len();
            let count = problem.candidates.len();
            assert_eq!(all, count, "round {round}: a reason for each that is left out");
            true
        }
        (Err(ScheduleError::Infeasible(conflict)), None) => {
            assert!(conflict.possible < conflict.wanted && !conflict.rules.is_empty());
            false
        }
        (found, best) => panic!("round {round}: {found:?}, best {best:?}"),
    }
}

#[test]
fn small_problems_with_every_demand_agree_with_exhaustive_search() {
    let mut random = SplitMix64(2_032);
    let (mut infeasible, mut kinds) = (0, [0; 3]);
    for round in 0..400 {
        let problem = small(&mut random);
        kinds[0] += i32::from(problem.demands.log.is_some());
        kinds[1] += i32::from(problem.demands.data.is_some());
        infeasible += i32::from(!agrees(&problem, round));
    }
    assert!(infeasible > 20 && infeasible < 300, "{infeasible}");
    assert!(kinds[0] > 50 && kinds[1] > 50, "{kinds:?}");
}

/// A gap's price far above what sessions are worth is not cut.
#[test]
fn gaps_may_cost_any_price() {
    let mut random = SplitMix64(51);
    for round in 0..100 {
        let mut problem = small(&mut random);
        let price_per_day = [1e5, 1e6, 1e7][round % 3];
        let longest = minutes(between(&mut random, 400, 2_000));
        problem.demands.longest_gap = Some(LongestGap { longest, price_per_day });
        agrees(&problem, round);
    }
}

/// Contacts before, during and after sessions that overlap on two telescopes; reserved time in windows.
#[test]
fn memory_and_thermal_windows_agree_with_exhaustive_search() {
    let mut random = SplitMix64(77);
    for round in 0..200 {
        let mut list = Vec::new();
        for _ in 0..between(&mut random, 6, 11) {
            let (target, telescope) = (0, index(between(&mut random, 0, 1)));
            let start = between(&mut random, 15, 1_300);
            list.push(candidate(target, telescope, start, between(&mut random, 30, 120)));
        }
        let mut problem = problem(list, 1);
        problem.rules.max_per_day = None;
        problem.rules.max_sessions = None;
        if round % 3 < 2 {
            let mut contacts = Vec::new();
            let mut at_minute = between(&mut random, 0, 60);
            while at_minute < 1_300 {
                let until = at_minute + between(&mut random, 5, 90);
                let bit_s = between(&mut random, 300, 4_000).unsigned_abs();
                contacts.push(Contact { from: at(at_minute), until: at(until), bit_s });
                at_minute = until + between(&mut random, 5, 150);
            }
            let memory_bit = between(&mut random, 5_000_000, 12_000_000).unsigned_abs();
            problem.demands.data = Some(Data { rate_bit_s: 1_000, memory_bit, contacts });
        }
        if round % 3 > 0 {
            let most = minutes(between(&mut random, 120, 260));
            let window = minutes(between(&mut random, 200, 1_500));
            problem.demands.thermal = Some(Thermal { most, window });
        }
        assert!(agrees(&problem, round));
    }
}

/// A contact while the second session is set up empties the memory for it.
#[test]
fn a_contact_during_the_setup_makes_room() {
    let mut problem = problem(vec![candidate(0, 0, 100, 100), candidate(0, 0, 215, 100)], 1);
    problem.demands.data = Some(Data {
        rate_bit_s: 1_000,
        memory_bit: 6_500_000,
        contacts: vec![Contact { from: at(205), until: at(215), bit_s: 10_000 }],
    });
    assert_eq!(schedule(&problem).unwrap().chosen, [0, 1]);
    assert!(agrees(&problem, 0));
}

#[test]
fn a_contradiction_is_named_with_the_least_change() {
    // Two sessions a season are asked for; the blackout leaves one.
    let candidates = vec![
        candidate(0, 0, 100, 60),
        candidate(0, 0, 600, 60),
        candidate(0, 0, 1_700, 60),
        candidate(1, 1, 300, 60),
    ];
    let mut problem = problem(candidates, 2);
    problem.demands.blackouts = vec![(at(500), at(1_800))];
    problem.demands.min_sessions = Some(SessionCount { count: 2, window: minutes(2_880) });
    let Err(ScheduleError::Infeasible(conflict)) = schedule(&problem) else { panic!("feasible") };
    assert_eq!(conflict.rules, [RuleName::MinSessions, RuleName::Blackouts]);
    assert_eq!((conflict.wanted, conflict.possible), (2, 1));
    assert_eq!(conflict.season, Some((0, 0, at(0))));
    problem.demands.min_sessions = Some(SessionCount { count: 1, window: minutes(2_880) });
    assert!(schedule(&problem).is_ok());
    // Two that overlap cannot both be fixed.
    problem.demands = Demands { fixed: vec![0, 3], ..Demands::default() };
    assert!(schedule(&problem).is_ok());
    problem.candidates[3] = candidate(1, 0, 120, 60);
    let Err(ScheduleError::Infeasible(conflict)) = schedule(&problem) else { panic!("feasible") };
    assert_eq!(conflict.rules, [RuleName::Exclusive, RuleName::Fixed]);
    assert_eq!((conflict.wanted, conflict.possible), (2, 1));
}

#[test]
fn an_earlier_plan_changes_as_little_as_its_price_says() {
    let candidates: Vec<Candidate> = (0..40)
        .map(|it| {
            candidate(
                it % 2,
                it % 2,
                20 + 140 * i64::try_from(it).unwrap(),
                60 + i64::try_from(it).unwrap(),
            )
        })
        .collect();
    let mut problem = problem(candidates, 4);
    problem.rules.max_sessions = Some(SessionCount { count: 2, window: minutes(1_440) });
    let before: Vec<usize> = (0..3).map(|day| 10 * day).collect();
    assert_eq!(check(&problem, &before), Ok(()));
    let plan = |price: f64| {
        let previous = Some(Previous { sessions: before.clone(), price });
        let demands = Demands { previous, ..Demands::default() };
        schedule(&Problem { demands, ..problem.clone() }).unwrap()
    };
    assert_eq!(plan(1e9).chosen, before);
    assert_eq!(plan(1e9).changes, 0);
    assert!(plan(0.0).changes > 0);
}

#[test]
fn a_search_that_is_stopped_returns_the_best_so_far() {
    let mut random = SplitMix64(5);
    let candidates = (0..300).map(|_| {
        let telescope = index(between(&mut random, 0, 2));
        candidate(
            index(between(&mut random, 0, 1)),
            telescope,
            between(&mut random, 20, 40_000),
            between(&mut random, 30, 150),
        )
    });
    let mut problem = problem(candidates.collect(), 30);
    problem.demands.thermal = Some(Thermal { most: minutes(200), window: Duration::from_ns(DAY) });
    let found = schedule_until(&problem, &Stopping).unwrap();
    assert_eq!(check(&problem, &found.chosen), Ok(()));
    assert_eq!(found.stopped, Stopped::Interrupted);
    assert!(found.objective > 0.0 && found.upper_bound.is_finite());
    let whole = schedule(&problem).unwrap();
    assert!(whole.objective >= found.objective && whole.objective <= found.upper_bound);
    // Reserved time in windows that slide leaves the bound weak: no small gap is claimed.
    assert!(whole.gap < 0.11, "{}", whole.gap);
}

/// Sixty days of 24 opportunities each over three telescopes and two targets, more than the memory, the
/// seasons and the gaps leave room for.
fn campaign() -> Problem {
    let mut random = SplitMix64(77);
    let candidates = (0..60 * 24).map(|_| {
        let length = between(&mut random, 30, 110);
        let telescope = index(between(&mut random, 0, 2));
        let target = index(between(&mut random, 0, 1));
        let start = between(&mut random, 20, 86_200);
        let dwell = minutes(length * between(&mut random, 20, 70) / 100);
        Candidate { dwell, ..candidate(target, telescope, start, length) }
    });
    let mut problem = problem(candidates.collect(), 60);
    let contacts = (0..60).filter(|day| day % 7 != 4).map(|day| Contact {
        from: at(1_440 * day + 780),
        until: at(1_440 * day + 1_020),
        bit_s: 8_000_000,
    });
    problem.demands = Demands {
        min_sessions: Some(SessionCount { count: 4, window: minutes(15 * 1_440) }),
        longest_gap: Some(LongestGap { longest: minutes(3 * 1_440), price_per_day: 4_000.0 }),
        data: Some(Data {
            rate_bit_s: 20_000_000,
            memory_bit: 200_000_000_000,
            contacts: contacts.collect(),
        }),
        ..Demands::default()
    };
    problem
}

#[test]
fn memory_seasons_and_gaps_that_bind_together_leave_a_small_gap() {
    let problem = campaign();
    let found = schedule(&problem).unwrap();
    assert_eq!(check(&problem, &found.chosen), Ok(()));
    assert!((found.objective - worth(&problem, &found.chosen)).abs() < 1e-6 * found.objective);
    assert!(found.gap < 0.05, "{} of {}: {}", found.objective, found.upper_bound, found.gap);
}

#[test]
fn scan_angles_that_single_sessions_break_are_taken_together() {
    let mut random = SplitMix64(13);
    let candidates: Vec<Candidate> = (0..240)
        .map(|_| {
            let (target, telescope) =
                (index(between(&mut random, 0, 1)), index(between(&mut random, 0, 2)));
            candidate(
                target,
                telescope,
                between(&mut random, 20, 43_000),
                between(&mut random, 30, 110),
            )
        })
        .collect();
    let mut problem = problem(candidates, 30);
    let sums = problem.candidates.iter().map(|it| {
        let angle = f64::from(i32::try_from(between(&mut random, 0, 359)).unwrap()).to_radians();
        let w = it.dwell.seconds();
        [w, w * (2.0 * angle).cos(), w * (2.0 * angle).sin()]
    });
    let sums = sums.collect();
    problem.demands.diversity = vec![Diversity { n: 2, rho: 0.1, sums }];
    let found = schedule(&problem).unwrap();
    assert_eq!(check(&problem, &found.chosen), Ok(()));
    assert!(!found.chosen.is_empty());
    assert!(found.gap < 0.05, "{} of {}: {}", found.objective, found.upper_bound, found.gap);
}

/// Minutes of a block, and how many follow each other.
const BLOCK: i64 = 5_760;
const BLOCKS: i64 = 10;

/// Blocks of four days, candidates on the second and third alone, so that no rule joins two of them; the
/// memory is empty at the end of each.
fn blocks(lists: &[Vec<Candidate>], demands: &Demands) -> Problem {
    let moved = |(block, list): (i64, &Vec<Candidate>)| -> Vec<Candidate> {
        let by = minutes(BLOCK * block);
        let later = |it: &Candidate| Candidate {
            first_entry: it.first_entry.plus(by),
            last_exit: it.last_exit.plus(by),
            ..*it
        };
        list.iter().map(later).collect()
    };
    let candidates: Vec<Candidate> = (0..).zip(lists).flat_map(moved).collect();
    let count = i64::try_from(lists.len()).unwrap();
    let contacts = (0..count).flat_map(|block| {
        let contact = |from: i64, until: i64, bit_s| Contact {
            from: at(BLOCK * block + from),
            until: at(BLOCK * block + until),
            bit_s,
        };
        [contact(2_700, 2_760, 10), contact(4_600, 5_700, 1_000_000)]
    });
    let contacts: Vec<Contact> = contacts.collect();
    let data = demands.data.clone().map(|data| Data { contacts, ..data });
    let demands = Demands { data, ..demands.clone() };
    Problem { demands, ..problem(candidates, 4 * count) }
}

/// The best worth of a problem of one block, by trying every set.
fn best_of(problem: &Problem) -> Option<f64> {
    let count = problem.candidates.len();
    let sets = (0_u32..1 << count)
        .map(|set| (0..count).filter(|it| set >> it & 1 == 1).collect::<Vec<usize>>());
    let legal = sets.filter(|chosen| check(problem, chosen).is_ok());
    legal.map(|chosen| worth(problem, &chosen)).reduce(f64::max)
}

#[test]
fn bounds_over_many_sessions_are_not_below_the_optimum() {
    let mut random = SplitMix64(31);
    for round in 0..5 {
        let mut demands = Demands {
            min_sessions: Some(SessionCount { count: 1, window: minutes(BLOCK) }),
            longest_gap: Some(LongestGap {
                longest: minutes(1_440),
                price_per_day: f64::from(i32::try_from(between(&mut random, 0, 9_000)).unwrap()),
            }),
            data: Some(Data {
                rate_bit_s: 100,
                memory_bit: between(&mut random, 300_000, 1_500_000).unsigned_abs(),
                contacts: Vec::new(),
            }),
            ..Demands::default()
        };
        if round % 3 == 0 {
            let most = minutes(between(&mut random, 150, 320));
            demands.thermal = Some(Thermal { most, window: minutes(1_440) });
        }
        let mut lists = Vec::new();
        let mut best = 0.0;
        while lists.len() < index(BLOCKS) {
            let list: Vec<Candidate> = (0..7)
                .map(|_| {
                    let (target, telescope) =
                        (between(&mut random, 0, 1), between(&mut random, 0, 1));
                    let start = between(&mut random, 1_500, 4_000);
                    candidate(index(target), index(telescope), start, between(&mut random, 30, 150))
                })
                .collect();
            // Blocks that cannot be met are drawn again.
            if let Some(worth) = best_of(&blocks(std::slice::from_ref(&list), &demands)) {
                best += worth;
                lists.push(list);
            }
        }
        let problem = blocks(&lists, &demands);
        let found = schedule(&problem).unwrap();
        let close = 1e-6 * best.abs().max(1.0);
        assert_eq!(check(&problem, &found.chosen), Ok(()), "round {round}");
        assert!((worth(&problem, &found.chosen) - found.objective).abs() < close, "round {round}");
        assert!(found.objective <= best + close, "round {round}: {} {best}", found.objective);
        assert!(found.upper_bound >= best - close, "round {round}: bound too low");
        assert!(found.objective >= best - close, "round {round}: {} {best}", found.objective);
    }
}
