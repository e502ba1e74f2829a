//! Schedules against brute force, the rules' own words, and a mission of real size.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

mod synthetic;

use onboard_core::time::{Duration, Instant};
use planner::schedule::{
    Because, Candidate, Exclusive, Problem, Rules, Schedule, SessionCount, Stopped, Violation,
    check, schedule,
};
use synthetic::{DAY_NS, START_TAI_NS, SplitMix64, default_rules, mission};

const MINUTE_NS: i64 = 60_000_000_000;

fn at(minutes: i64) -> Instant {
    Instant::from_tai_ns(START_TAI_NS + minutes * MINUTE_NS)
}

fn minutes(count: i64) -> Duration {
    Duration::from_ns(count * MINUTE_NS)
}

/// An integer in `low..high`.
fn between(random: &mut SplitMix64, low: i64, high: i64) -> i64 {
    low + i64::try_from(random.next() % u64::try_from(high - low).unwrap()).unwrap()
}

/// Two days of few candidates under rules that all bind.
fn small(random: &mut SplitMix64) -> Problem {
    let count = between(random, 1, 14);
    let candidates = (0..count)
        .map(|_| {
            let entry = between(random, 0, 2800);
            let length = between(random, 1, 200);
            Candidate {
                target: usize::try_from(between(random, 0, 3)).unwrap(),
                telescope: usize::try_from(between(random, 0, 2)).unwrap(),
                first_entry: at(entry),
                last_exit: at(entry + length),
                dwell: minutes(between(random, 0, length + 1)),
            }
        })
        .collect();
    let exclusive = [Exclusive::None, Exclusive::Telescope, Exclusive::All]
        [usize::try_from(between(random, 0, 3)).unwrap()];
    Problem {
        span: (at(0), at(2880)),
        candidates,
        weights: vec![1.0, random.unit(), 0.5],
        rules: Rules {
            setup: minutes(between(random, 0, 20)),
            cooldown: minutes(between(random, 0, 20)),
            exclusive,
            max_per_day: (random.unit() < 0.7).then(|| minutes(between(random, 30, 400))),
            max_sessions: (random.unit() < 0.7).then(|| SessionCount {
                count: u32::try_from(between(random, 0, 4)).unwrap(),
                window: minutes(between(random, 1, 1500)),
            }),
            day_boundaries: (-1..=2).map(|day| at(day * 1440 + 700)).collect(),
        },
    }
}

/// The best value of any subset that the independent check accepts.
fn brute_force(problem: &Problem) -> f64 {
    let n = problem.candidates.len();
    (0_u32..1 << n)
        .map(|mask| (0..n).filter(|i| mask >> i & 1 == 1).collect::<Vec<_>>())
        .filter(|set| check(problem, set).is_ok())
        .map(|set| set.iter().map(|&i| problem.value(i)).sum())
        .fold(0.0, f64::max)
}

fn is_sound(problem: &Problem, found: &Schedule) {
    check(problem, &found.chosen).unwrap();
    let value: f64 = found.chosen.iter().map(|&i| problem.value(i)).sum();
    assert!((value - found.objective).abs() <= 1e-9 * value.max(1.0));
    assert!(found.objective <= found.upper_bound);
    assert_eq!(found.chosen.len() + found.rejected.len(), problem.candidates.len());
    for rejection in &found.rejected {
        // The reason is true of the schedule as it stands: alone, the candidate would break it.
        if rejection.because != Because::NoValue {
            let mut more = found.chosen.clone();
            more.push(rejection.candidate);
            assert!(check(problem, &more).is_err(), "{rejection:?}");
        }
    }
}

#[test]
fn brute_force_never_exceeds_the_bound() {
    let mut random = SplitMix64(7);
    let (mut reached, mut optimal, mut best) = (0.0, 0, 0.0);
    for _ in 0..400 {
        let problem = small(&mut random);
        let found = schedule(&problem).unwrap();
        is_sound(&problem, &found);
        let optimum = brute_force(&problem);
        assert!(optimum <= found.upper_bound * (1.0 + 1e-12), "{problem:?}");
        assert!(found.objective <= optimum * (1.0 + 1e-12) + 1e-9);
        if found.stopped == Stopped::Optimal {
            assert!(found.objective >= optimum * (1.0 - 1e-9), "{problem:?}");
            optimal += 1;
        }
        reached += found.objective;
        best += optimum;
    }
    assert!(reached >= 0.999 * best, "{reached} of {best}");
    assert!(optimal > 200, "{optimal} proven");
}

#[test]
fn a_mission_of_real_size_is_within_seven_per_cent() {
    let problem = mission(365, 1, false, default_rules(365));
    assert!(problem.candidates.len() > 10_000);
    let found = schedule(&problem).unwrap();
    is_sound(&problem, &found);
    assert!(found.gap <= 0.07, "gap {}", found.gap);
    assert_eq!(found, schedule(&problem).unwrap(), "equal input gives equal output");
}

#[test]
fn exclusivity_alone_is_solved_to_the_bound() {
    let rules =
        Rules { max_per_day: None, max_sessions: None, day_boundaries: vec![], ..default_rules(0) };
    let problem = mission(60, 2, true, rules);
    let found = schedule(&problem).unwrap();
    is_sound(&problem, &found);
    assert!(found.gap <= 0.005, "gap {}", found.gap);
    let free = Rules { exclusive: Exclusive::None, ..problem.rules.clone() };
    let problem = Problem { rules: free, ..problem };
    let found = schedule(&problem).unwrap();
    is_sound(&problem, &found);
    assert!(found.gap <= 1e-6, "gap {}", found.gap);
}

#[test]
fn ties_fall_the_same_way() {
    let twin = |telescope| Candidate {
        target: 0,
        telescope,
        first_entry: at(100),
        last_exit: at(110),
        dwell: minutes(5),
    };
    let problem = Problem {
        span: (at(0), at(1000)),
        candidates: vec![twin(0), twin(0), twin(0)],
        weights: vec![1.0],
        rules: Rules { day_boundaries: vec![], max_per_day: None, ..default_rules(0) },
    };
    let found = schedule(&problem).unwrap();
    assert_eq!(found.chosen, [0]);
    assert_eq!(found.stopped, Stopped::Optimal);
    assert!(
        found.rejected.iter().all(|it| it.because == Because::Conflict { with: 0 }),
        "{found:?}"
    );
}

#[test]
fn nothing_to_schedule_is_a_schedule() {
    let problem = Problem {
        span: (at(0), at(1000)),
        candidates: vec![],
        weights: vec![],
        rules: Rules { day_boundaries: vec![at(-5), at(2000)], ..default_rules(0) },
    };
    let found = schedule(&problem).unwrap();
    assert!(found.chosen.is_empty() && found.gap.abs() < 1e-12);
}

#[test]
fn a_session_over_midnight_counts_in_both_days() {
    let long = |first: i64, last: i64| Candidate {
        target: 0,
        telescope: 0,
        first_entry: at(first),
        last_exit: at(last),
        dwell: minutes(10),
    };
    let problem = |limit| Problem {
        span: (at(0), at(2880)),
        candidates: vec![long(1340, 1540)],
        weights: vec![1.0],
        rules: Rules {
            setup: Duration::ZERO,
            cooldown: Duration::ZERO,
            exclusive: Exclusive::All,
            max_per_day: Some(minutes(limit)),
            max_sessions: None,
            day_boundaries: vec![at(0), at(1440), at(2880)],
        },
    };
    assert_eq!(schedule(&problem(100)).unwrap().chosen, [0]);
    let refused = schedule(&problem(99)).unwrap();
    assert_eq!(refused.rejected[0].because, Because::TooLongForDay { day: 0, needs: minutes(100) });
}

#[test]
fn the_check_catches_seeded_violations() {
    let session = |telescope, entry: i64| Candidate {
        target: 0,
        telescope,
        first_entry: at(entry),
        last_exit: at(entry + 100),
        dwell: minutes(10),
    };
    let problem = Problem {
        span: (at(0), at(2880)),
        candidates: vec![session(0, 100), session(0, 199), session(1, 150), session(0, 2800)],
        weights: vec![1.0],
        rules: Rules {
            setup: Duration::ZERO,
            cooldown: Duration::ZERO,
            exclusive: Exclusive::Telescope,
            max_per_day: Some(minutes(150)),
            max_sessions: Some(SessionCount { count: 1, window: minutes(60) }),
            day_boundaries: vec![at(0), at(1440), at(2880)],
        },
    };
    assert!(matches!(check(&problem, &[0, 1]), Err(Violation::Overlap(..))));
    assert!(matches!(check(&problem, &[3]), Err(Violation::Outside(3))));
    assert!(matches!(check(&problem, &[9]), Err(Violation::Unknown(9))));
    assert!(matches!(check(&problem, &[0, 0]), Err(Violation::Twice(0))));
    assert!(check(&problem, &[0, 2]).is_err(), "200 minutes in a day, and two starts in an hour");
    assert!(check(&problem, &[0]).is_ok());
}

#[test]
fn impossible_weights_are_refused() {
    for weight in [f64::NAN, f64::INFINITY, -1.0] {
        let problem = Problem {
            span: (at(0), at(DAY_NS / MINUTE_NS)),
            candidates: vec![],
            weights: vec![weight],
            rules: default_rules(3),
        };
        let error = schedule(&problem).unwrap_err().to_string();
        assert!(error.contains("must be finite and not negative"), "{error}");
    }
}
