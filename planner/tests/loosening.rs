//! What giving way in a rule would bring, where a pencil says what it is.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

mod stopping;

use onboard_core::time::{Duration, Instant};
use planner::progress::Quietly;
use planner::schedule::{
    Candidate, Data, Demands, Diversity, Exclusive, Give, Log, LongestGap, Loosening, Problem,
    Rule, Rules, SessionCount, Thermal, loosen, schedule,
};
use std::collections::BTreeMap;
use stopping::Stopping;

const HOUR_S: i64 = 3_600;
const DAY_S: i64 = 86_400;

fn at(seconds: i64) -> Instant {
    Instant::from_tai_ns(seconds * 1_000_000_000)
}

fn lasting(seconds: i64) -> Duration {
    Duration::from_ns(seconds * 1_000_000_000)
}

/// An hour of a target in view every two hours, alternating between two targets, for some days.
fn problem(days: i64) -> Problem {
    let candidates = (0..12 * days)
        .map(|number| {
            let from = 2 * HOUR_S * number;
            Candidate {
                target: usize::try_from(number % 2).unwrap(),
                telescope: 0,
                first_entry: at(from),
                last_exit: at(from + HOUR_S),
                dwell: lasting(HOUR_S),
            }
        })
        .collect();
    Problem {
        span: (at(0), at(days * DAY_S)),
        candidates,
        weights: vec![1.0, 0.5],
        rules: Rules {
            setup: Duration::ZERO,
            cooldown: Duration::ZERO,
            exclusive: Exclusive::Telescope,
            max_per_day: None,
            max_sessions: None,
            day_boundaries: (0..=days).map(|day| at(day * DAY_S)).collect(),
        },
        demands: Demands::default(),
    }
}

fn of(all: &[Loosening], give: Give) -> &Loosening {
    all.iter().find(|it| it.give == give).unwrap()
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-5
}

#[test]
fn ten_minutes_a_day_go_to_the_target_that_waits() {
    // Four hours a day: all for the first target, six hours of which are on offer.
    let mut problem = problem(10);
    problem.rules.max_per_day = Some(lasting(4 * HOUR_S));
    let all = loosen(&problem, &Quietly).unwrap();
    let found = of(&all, Give::DayMinutes);
    assert!(near(found.objective, 10.0 / 240.0), "{found:?}");
    assert!(near(found.dwell[0].unwrap(), 10.0 / 240.0) && found.dwell[1].is_none());
    // Six hours for the first, one for the second: ten minutes more are of the second.
    problem.rules.max_per_day = Some(lasting(7 * HOUR_S));
    let all = loosen(&problem, &Quietly).unwrap();
    let found = of(&all, Give::DayMinutes);
    assert!(near(found.objective, 5.0 / 390.0), "{found:?}");
    assert!(near(found.dwell[0].unwrap(), 0.0) && near(found.dwell[1].unwrap(), 10.0 / 60.0));
}

#[test]
fn each_rule_has_its_step() {
    let mut problem = problem(12);
    problem.rules.max_sessions = Some(SessionCount { count: 4, window: lasting(DAY_S) });
    let found = of(&loosen(&problem, &Quietly).unwrap(), Give::Session).clone();
    assert!(near(found.objective, 0.25), "{found:?}");
    // Sixteen hours of data fill the memory, never sent.
    problem.demands.data =
        Some(Data { rate_bit_s: 1_000, memory_bit: 57_600_000, contacts: Vec::new() });
    let all = loosen(&problem, &Quietly).unwrap();
    let found = of(&all, Give::Memory);
    assert!(near(found.objective, 0.1), "{found:?}");
    assert!(near(of(&all, Give::Session).objective, 0.0));
    problem.demands.data = None;
    problem.rules.max_sessions = None;
    // Five hours of every day: the sliding window allows no more than each day does.
    problem.demands.thermal = Some(Thermal { most: lasting(5 * HOUR_S), window: lasting(DAY_S) });
    let found = of(&loosen(&problem, &Quietly).unwrap(), Give::ThermalMinutes).clone();
    assert!(near(found.objective, 10.0 / 300.0), "{found:?}");
    // Whole sessions of more than a quarter of the limit: ten minutes are no use.
    problem.demands.thermal = Some(Thermal { most: lasting(3 * HOUR_S), window: lasting(DAY_S) });
    let found = of(&loosen(&problem, &Quietly).unwrap(), Give::ThermalMinutes).clone();
    assert!(near(found.objective, 0.0), "{found:?}");
    // No step for a rule that is not there.
    assert!(loosen(&problem, &Quietly).unwrap().iter().all(|it| it.give != Give::Session));
}

#[test]
fn seasons_and_gaps_cost_what_they_take() {
    // Four hours a day, one of them for the second target: two sessions in each two days.
    let mut problem = problem(12);
    problem.rules.max_per_day = Some(lasting(4 * HOUR_S));
    problem.demands.min_sessions = Some(SessionCount { count: 2, window: lasting(2 * DAY_S) });
    let found = of(&loosen(&problem, &Quietly).unwrap(), Give::SeasonSession).clone();
    // 6 + 2 / 2 hours before, 7 + 1 / 2 after.
    assert!(near(found.objective, 0.5 / 7.0), "{found:?}");
    assert!(near(found.dwell[0].unwrap(), 1.0 / 6.0) && near(found.dwell[1].unwrap(), -0.5));
    problem.demands.min_sessions = None;
    problem.demands.longest_gap = Some(LongestGap { longest: lasting(DAY_S), price_per_day: 1.0 });
    let found = of(&loosen(&problem, &Quietly).unwrap(), Give::GapDay).clone();
    assert!(near(found.objective, 0.0), "{found:?}");
}

#[test]
fn long_missions_are_judged_by_stretches() {
    let mut problem = problem(1_300);
    problem.rules.max_per_day = Some(lasting(4 * HOUR_S));
    assert!(problem.candidates.len() > 15_000);
    let found = of(&loosen(&problem, &Quietly).unwrap(), Give::DayMinutes).clone();
    assert!((found.objective - 10.0 / 240.0).abs() < 1e-4, "{found:?}");
    let stopped = loosen(&problem, &Stopping).unwrap();
    assert!(stopped.is_empty());
}

#[test]
fn logarithms_gain_less_than_time() {
    let mut problem = problem(40);
    problem.rules.max_per_day = Some(lasting(4 * HOUR_S));
    let parts = problem.candidates.iter().map(|it| vec![(0, it.dwell)]).collect();
    problem.demands.log = Some(Log {
        offset: lasting(600),
        epoch: lasting(10 * DAY_S),
        parts,
        weights: BTreeMap::new(),
    });
    // Each epoch has 40 hours; the second target has half the weight, so a third of the time:
    // 2 / (600 s + t) = 1 / (600 s + u) with t + u = 40 h, up to the hours that are on offer.
    let found = of(&loosen(&problem, &Quietly).unwrap(), Give::DayMinutes).clone();
    let worth = |hours: f64| {
        let all = hours * 3_600.0;
        let second = (all - 600.0) / 3.0;
        (1.0 + (all - second) / 600.0).ln() + 0.5 * (1.0 + second / 600.0).ln()
    };
    let gain = worth(40.0 + 10.0 / 6.0) / worth(40.0) - 1.0;
    assert!(near(found.objective, gain), "{found:?} {gain}");
}

/// The shadow prices of the rules that a function picks.
fn prices(problem: &Problem, pick: impl Fn(&Rule) -> bool) -> Vec<f64> {
    let all = schedule(problem).unwrap().constraints;
    all.iter().filter(|it| pick(&it.rule)).map(|it| it.shadow_price).collect()
}

#[test]
fn a_season_costs_what_its_session_takes_the_place_of() {
    let mut problem = problem(12);
    problem.rules.max_per_day = Some(lasting(4 * HOUR_S));
    problem.demands.min_sessions = Some(SessionCount { count: 2, window: lasting(2 * DAY_S) });

    let found = prices(&problem, |it| matches!(it, Rule::MinSessions { target: 1, .. }));
    assert_eq!(found.len(), 6);
    // An hour of weight 1 for one of weight 1/2.
    assert!(found.iter().all(|it| (it - 1_800.0).abs() < 1.0), "{found:?}");
    let free = prices(&problem, |it| matches!(it, Rule::MinSessions { target: 0, .. }));
    assert!(free.iter().all(|it| it.abs() < 1.0), "{free:?}");
}

#[test]
fn a_bound_on_scan_angles_costs_what_a_larger_one_would_bring() {
    let mut problem = problem(12);
    let psi = |number: usize| if number.is_multiple_of(3) { 1.7_f64 } else { 0.3 };
    let hour = 3_600.0;
    let sums = |number: usize| [hour, hour * psi(number).cos(), hour * psi(number).sin()];
    let sums = (0..problem.candidates.len()).map(sums).collect();
    problem.demands.diversity = vec![Diversity { n: 1, rho: 0.775, sums }];
    let gain = of(&loosen(&problem, &Quietly).unwrap(), Give::ScanAngle).clone();
    let before = schedule(&problem).unwrap();
    let found = prices(&problem, |it| matches!(it, Rule::ScanAngle { .. }));
    assert_eq!(found.len(), 2);
    let told = 0.01 * found.iter().sum::<f64>() / before.objective;
    assert!((told / gain.objective - 1.0).abs() < 0.2, "{told} {gain:?}");
}
