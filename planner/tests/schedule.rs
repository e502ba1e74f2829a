//! Schedules against exhaustive search, an exact programme for intervals, an independent solver's
//! optimum, and the rules read literally.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

mod random;
mod synthetic;

use ephem::random::SplitMix64;
use onboard_core::time::{Duration, Instant};
use planner::schedule::{
    Because, Candidate, Demands, Exclusive, Problem, Rule, Rules, Schedule, ScheduleError,
    SessionCount, Stopped, Violation, check, schedule,
};
use random::between;
use synthetic::{DAY_NS, default_rules, mission};

fn at(ns: i64) -> Instant {
    Instant::from_tai_ns(ns)
}

fn candidate(target: usize, telescope: usize, times: (i64, i64), dwell: i64) -> Candidate {
    Candidate {
        target,
        telescope,
        first_entry: at(times.0),
        last_exit: at(times.1),
        dwell: Duration::from_ns(dwell),
    }
}

fn no_rules() -> Rules {
    Rules {
        setup: Duration::ZERO,
        cooldown: Duration::ZERO,
        exclusive: Exclusive::None,
        max_per_day: None,
        max_sessions: None,
        day_boundaries: Vec::new(),
    }
}

/// What must hold of any schedule: it meets the rules, its numbers agree, and every candidate left
/// out would break a rule if added alone.
fn hold(problem: &Problem, found: &Schedule) {
    assert_eq!(check(problem, &found.chosen), Ok(()));
    let sum: f64 = found.chosen.iter().map(|&index| problem.value(index)).sum();
    assert!((found.objective - sum).abs() <= 1e-9 * sum);
    assert!(found.objective <= found.upper_bound);
    let gap = if found.upper_bound > 0.0 { 1.0 - found.objective / found.upper_bound } else { 0.0 };
    assert!((found.gap - gap).abs() < 1e-12);
    let mut seen: Vec<usize> = found.chosen.clone();
    // Large problems: a sample, as each look at the rules takes all sessions.
    let stride = found.rejected.len() / 500 + 1;
    for (place, rejection) in found.rejected.iter().enumerate() {
        let index = rejection.candidate;
        seen.push(index);
        if place % stride != 0 {
            continue;
        }
        let mut more = found.chosen.clone();
        more.push(index);
        let broken = check(problem, &more);
        let true_reason = match rejection.because {
            Because::NoValue => problem.value(index) <= 0.0,
            Because::BeforeMission => problem.reserved(index).0 < problem.span.0,
            Because::AfterMission => problem.reserved(index).1 > problem.span.1,
            Because::Conflict { with } => {
                let ((a, b), (c, d)) = (problem.reserved(index), problem.reserved(with));
                found.chosen.contains(&with) && a < d && c < b && broken.is_err()
            }
            Because::TooLongForDay { .. } | Because::DayFull { .. } => {
                check(&only_days(problem), &more).is_err()
            }
            Because::SessionCount { .. } => check(&only_counts(problem), &more).is_err(),
            _ => false,
        };
        assert!(true_reason, "candidate {index}: {:?}", rejection.because);
    }
    seen.sort_unstable();
    assert!(seen.iter().copied().eq(0..problem.candidates.len()), "each candidate exactly once");
}

fn only_days(problem: &Problem) -> Problem {
    let rules = Rules { exclusive: Exclusive::None, max_sessions: None, ..problem.rules.clone() };
    Problem { rules, ..problem.clone() }
}

fn only_counts(problem: &Problem) -> Problem {
    let rules = Rules { exclusive: Exclusive::None, max_per_day: None, ..problem.rules.clone() };
    Problem { rules, ..problem.clone() }
}

/// The best objective over all subsets.
fn exhaustive(problem: &Problem) -> f64 {
    let count = problem.candidates.len();
    let mut best = 0.0_f64;
    for set in 0_u32..1 << count {
        let chosen: Vec<usize> = (0..count).filter(|index| set >> index & 1 == 1).collect();
        let value: f64 = chosen.iter().map(|&index| problem.value(index)).sum();
        if value > best && check(problem, &chosen).is_ok() {
            best = value;
        }
    }
    best
}

/// A few candidates over uneven days, under random rules.
fn small(random: &mut SplitMix64) -> Problem {
    let mut boundaries = vec![0];
    while boundaries.len() < 6 {
        boundaries.push(boundaries[boundaries.len() - 1] + between(random, 700, 1_299));
    }
    let end = boundaries[5];
    let count = between(random, 1, 12);
    let candidates = (0..count)
        .map(|_| {
            let start = between(random, -20, end - 1);
            let length = between(random, 0, 499);
            // Some values tie.
            let dwell =
                if between(random, 0, 2) == 0 { length / 2 } else { between(random, 0, length) };
            let (target, telescope) = (between(random, 0, 2), between(random, 0, 2));
            let index = |number: i64| usize::try_from(number).unwrap();
            candidate(index(target), index(telescope), (start, start + length), dwell)
        })
        .collect();
    let rules = Rules {
        setup: Duration::from_ns(between(random, 0, 59)),
        cooldown: Duration::from_ns(between(random, 0, 59)),
        exclusive: [Exclusive::None, Exclusive::Telescope, Exclusive::All]
            [usize::try_from(between(random, 0, 2)).unwrap()],
        max_per_day: (between(random, 0, 2) > 0)
            .then(|| Duration::from_ns(between(random, 100, 899))),
        max_sessions: (between(random, 0, 2) > 0).then(|| SessionCount {
            count: u32::try_from(between(random, 0, 3)).unwrap(),
            window: Duration::from_ns(between(random, 1, 2_499)),
        }),
        day_boundaries: boundaries.into_iter().map(at).collect(),
    };
    Problem {
        span: (at(0), at(end)),
        candidates,
        weights: vec![1.0, 0.37, 2.5],
        rules,
        demands: Demands::default(),
    }
}

#[test]
fn small_problems_agree_with_exhaustive_search() {
    let mut random = SplitMix64(20_320_401);
    let (mut optimal, mut worst) = (0, 0.0_f64);
    let rounds = 300;
    for round in 0..rounds {
        let problem = small(&mut random);
        let found = schedule(&problem).unwrap();
        hold(&problem, &found);
        let best = exhaustive(&problem);
        assert!(best <= found.upper_bound * (1.0 + 1e-12), "round {round}: bound below optimum");
        assert!(found.objective <= best * (1.0 + 1e-12), "round {round}: better than the best");
        let short = if best > 0.0 { 1.0 - found.objective / best } else { 0.0 };
        worst = worst.max(short);
        optimal += i32::from(short < 1e-12);
        if found.stopped == Stopped::Optimal {
            assert!(short < 1e-9, "round {round}: called optimal, but {short} short");
        }
    }
    assert!(optimal >= rounds - 2, "optimal in {optimal} of {rounds}");
    assert!(worst <= 0.03, "worst {worst}");
}

#[test]
fn days_share_a_session_that_crosses_midnight_to_the_nanosecond() {
    let rules = Rules {
        max_per_day: Some(Duration::from_ns(100)),
        day_boundaries: [0, 1_000, 2_000].map(at).to_vec(),
        ..no_rules()
    };
    let first = candidate(0, 0, (900, 1_040), 10);
    let fits = candidate(0, 1, (1_500, 1_560), 5);
    let problem = |candidates: Vec<Candidate>| Problem {
        span: (at(0), at(2_000)),
        candidates,
        weights: vec![1.0],
        rules: rules.clone(),
        demands: Demands::default(),
    };
    let both = problem(vec![first, fits]);
    let found = schedule(&both).unwrap();
    assert_eq!(found.chosen, [0, 1]);
    let used: Vec<(Rule, f64)> = found.constraints.iter().map(|it| (it.rule, it.used)).collect();
    assert_eq!(used, [(Rule::Day { day: 0 }, 1e-7), (Rule::Day { day: 1 }, 1e-7)]);

    let longer = problem(vec![first, candidate(0, 1, (1_500, 1_561), 5)]);
    let found = schedule(&longer).unwrap();
    assert_eq!(found.chosen, [0]);
    let day_full =
        Because::DayFull { day: 1, needs: Duration::from_ns(61), left: Duration::from_ns(60) };
    assert_eq!(found.rejected[0].because, day_full);

    let alone = problem(vec![candidate(0, 0, (899, 1_000), 10)]);
    let found = schedule(&alone).unwrap();
    let too_long = Because::TooLongForDay { day: 0, needs: Duration::from_ns(101) };
    assert_eq!(found.rejected[0].because, too_long);
    hold(&alone, &found);
}

#[test]
fn setup_and_cooldown_must_lie_inside_the_mission_and_may_touch() {
    let rules = Rules {
        setup: Duration::from_ns(10),
        cooldown: Duration::from_ns(5),
        exclusive: Exclusive::All,
        ..no_rules()
    };
    let times = [(9, 12), (10, 20), (35, 40), (90, 96), (90, 95)];
    let problem = Problem {
        span: (at(0), at(100)),
        candidates: times.iter().map(|&time| candidate(0, 0, time, 2)).collect(),
        weights: vec![1.0],
        rules,
        demands: Demands::default(),
    };
    let found = schedule(&problem).unwrap();
    hold(&problem, &found);
    assert_eq!(found.chosen, [1, 2, 4]);
    assert!(found.gap < 1e-5);
    let because: Vec<Because> = found.rejected.iter().map(|it| it.because).collect();
    assert_eq!(because, [Because::BeforeMission, Because::AfterMission]);
}

#[test]
fn windows_of_starts_are_half_open() {
    let rules = Rules {
        max_sessions: Some(SessionCount { count: 2, window: Duration::from_ns(100) }),
        ..no_rules()
    };
    let problem = |last: i64| Problem {
        span: (at(0), at(1_000)),
        candidates: [0, 50, last].map(|start| candidate(0, 0, (start, start + 5), 5)).to_vec(),
        weights: vec![1.0],
        rules: rules.clone(),
        demands: Demands::default(),
    };
    assert_eq!(schedule(&problem(100)).unwrap().chosen.len(), 3);
    let found = schedule(&problem(99)).unwrap();
    assert_eq!(found.chosen.len(), 2);
    assert!(matches!(found.rejected[0].because, Because::SessionCount { count: 2, .. }));
}

#[test]
fn nothing_to_do_is_a_schedule() {
    let empty = Problem {
        span: (at(0), at(10)),
        candidates: Vec::new(),
        weights: vec![],
        rules: no_rules(),
        demands: Demands::default(),
    };
    let found = schedule(&empty).unwrap();
    assert!(found.chosen.is_empty() && found.stopped == Stopped::Optimal);
    assert!(found.objective.is_sign_positive());
    assert!(found.objective.abs() + found.upper_bound.abs() + found.gap.abs() <= 0.0);

    let worthless = Problem {
        candidates: vec![candidate(0, 0, (0, 5), 5), candidate(1, 0, (0, 5), 0)],
        weights: vec![0.0, 1.0],
        ..empty
    };
    let found = schedule(&worthless).unwrap();
    hold(&worthless, &found);
    assert!(found.rejected.iter().all(|it| it.because == Because::NoValue));

    let forbidden = Problem {
        candidates: vec![candidate(0, 0, (0, 5), 5)],
        weights: vec![1.0],
        rules: Rules {
            max_per_day: Some(Duration::ZERO),
            max_sessions: Some(SessionCount { count: 0, window: Duration::from_ns(1) }),
            day_boundaries: vec![at(0), at(10)],
            ..no_rules()
        },
        ..worthless
    };
    let found = schedule(&forbidden).unwrap();
    hold(&forbidden, &found);
    assert!(found.constraints.iter().all(|it| it.shadow_price.is_finite()));
}

#[test]
fn ties_fall_the_same_way_whatever_the_threads() {
    let mut rules = default_rules(12);
    rules.setup = Duration::ZERO;
    let problem = mission(12, 3, false, rules);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| schedule(&problem).unwrap())
    };
    let one = run(1);
    assert_eq!(one, run(1));
    assert_eq!(one, run(4));
}

#[test]
fn weights_of_any_size_scale_the_schedule() {
    let problem = mission(8, 5, true, default_rules(8));
    let found = schedule(&problem).unwrap();
    for factor in [1e-300, 1e-9, 1e300] {
        let scaled = Problem { weights: vec![factor; 5], ..problem.clone() };
        let again = schedule(&scaled).unwrap();
        hold(&scaled, &again);
        assert!((again.gap - found.gap).abs() < 1e-3, "{} {}", again.gap, found.gap);
    }
}

#[test]
fn ill_posed_problems_are_refused() {
    let good = Problem {
        span: (at(0), at(1_000)),
        candidates: vec![candidate(0, 0, (10, 20), 5)],
        weights: vec![1.0],
        rules: no_rules(),
        demands: Demands::default(),
    };
    let refused = |change: &dyn Fn(&mut Problem)| {
        let mut problem = good.clone();
        change(&mut problem);
        schedule(&problem).unwrap_err()
    };
    for weight in [f64::NAN, f64::INFINITY, -1.0] {
        let error = refused(&|problem| problem.weights[0] = weight);
        assert!(matches!(error, ScheduleError::Weight { target: 0, .. }));
    }
    let error = refused(&|problem| {
        problem.weights[0] = 1e308;
        problem.candidates[0] = candidate(0, 0, (0, 20_000_000_000), 20_000_000_000);
    });
    assert_eq!(error, ScheduleError::Value { candidate: 0 });
    let error = refused(&|problem| problem.candidates[0].target = 3);
    assert!(matches!(error, ScheduleError::Target { target: 3, targets: 1, .. }));
    for dwell in [-1, 11] {
        let error = refused(&|problem| problem.candidates[0].dwell = Duration::from_ns(dwell));
        assert!(matches!(error, ScheduleError::Dwell { candidate: 0, .. }));
    }
    let error = refused(&|problem| problem.candidates[0] = candidate(0, 0, (20, 10), 0));
    assert!(matches!(error, ScheduleError::Dwell { length_ns: -10, .. }));
    let error = refused(&|problem| problem.span = (at(5), at(0)));
    assert_eq!(error, ScheduleError::Span(5));
    let error = refused(&|problem| problem.rules.setup = Duration::from_ns(-1));
    assert!(error.to_string().contains("the setup is -1 ns, but must not be negative"));
    let error = refused(&|problem| {
        let window = Duration::ZERO;
        problem.rules.max_sessions = Some(SessionCount { count: 1, window });
    });
    assert!(matches!(error, ScheduleError::Duration { .. }));
    let error = refused(&|problem| problem.rules.day_boundaries = vec![at(0), at(0)]);
    assert_eq!(error, ScheduleError::DayOrder(1));
    let error = refused(&|problem| {
        problem.rules.max_per_day = Some(Duration::from_ns(1));
        problem.rules.day_boundaries = vec![at(0), at(999)];
    });
    assert_eq!(error, ScheduleError::DayCover);
}

#[test]
fn the_checker_sees_each_broken_rule() {
    let rules = Rules {
        setup: Duration::from_ns(1),
        cooldown: Duration::from_ns(1),
        exclusive: Exclusive::Telescope,
        max_per_day: Some(Duration::from_ns(60)),
        max_sessions: Some(SessionCount { count: 2, window: Duration::from_ns(50) }),
        day_boundaries: [0, 100, 200].map(at).to_vec(),
    };
    let times = [
        (0, 0, 5),
        (0, 10, 20),
        (0, 21, 30),
        (1, 20, 30),
        (1, 40, 50),
        (1, 70, 105),
        (1, 107, 170),
        (2, 194, 199),
    ];
    let problem = Problem {
        span: (at(0), at(199)),
        candidates: times
            .iter()
            .map(|&(telescope, entry, exit)| candidate(0, telescope, (entry, exit), 1))
            .collect(),
        weights: vec![1.0],
        rules,
        demands: Demands::default(),
    };
    assert_eq!(check(&problem, &[1, 3]), Ok(()));
    assert_eq!(check(&problem, &[99]), Err(Violation::Unknown(99)));
    assert_eq!(check(&problem, &[1, 1]), Err(Violation::Twice(1)));
    assert_eq!(check(&problem, &[0]), Err(Violation::Outside(0)));
    assert_eq!(check(&problem, &[7]), Err(Violation::Outside(7)));
    assert_eq!(check(&problem, &[2, 1]), Err(Violation::Overlap(1, 2)));
    let day = |day, used_ns| Err(Violation::Day { day, used_ns, limit_ns: 60 });
    // Cooldown to 106 touches setup from 106; the second day holds 6 + 65 ns.
    assert_eq!(check(&problem, &[5, 6]), day(1, 71));
    let count = Violation::Count { from_tai_ns: 9, starts: 3, count: 2 };
    assert_eq!(check(&problem, &[4, 3, 1]), Err(count));
}

/// The best objective on one telescope after another where only overlap counts.
fn intervals(problem: &Problem) -> f64 {
    (0..3)
        .map(|telescope| {
            let mut all: Vec<(i64, i64, f64)> = (0..problem.candidates.len())
                .filter(|&index| problem.candidates[index].telescope == telescope)
                .map(|index| (problem.reserved(index), problem.value(index)))
                .filter(|((start, end), _)| *start >= problem.span.0 && *end <= problem.span.1)
                .map(|((start, end), value)| (end.tai_ns(), start.tai_ns(), value))
                .collect();
            all.sort_by_key(|it| (it.0, it.1));
            let mut best = vec![0.0_f64];
            for (index, &(_, start, value)) in all.iter().enumerate() {
                let before = all.partition_point(|it| it.0 <= start).min(index);
                best.push(best[index].max(best[before] + value));
            }
            best[all.len()]
        })
        .sum()
}

#[test]
fn sessions_that_overlap_in_a_chain_exclude_each_other_in_pairs() {
    // The first overlaps the last, though two between them have come and gone.
    let times = [(0, 100), (5, 8), (7, 12), (30, 400), (120, 130)];
    let rules = Rules { exclusive: Exclusive::All, ..no_rules() };
    let mut candidates: Vec<Candidate> = Vec::new();
    for block in 0..40 {
        let shift = 1_000 * block;
        let shifted =
            times.map(|(from, until)| candidate(0, 0, (shift + from, shift + until), until - from));
        candidates.extend(shifted);
    }
    let span = (at(0), at(40_000));
    let problem =
        Problem { span, candidates, weights: vec![1.0], rules, demands: Demands::default() };
    let found = schedule(&problem).unwrap();
    hold(&problem, &found);
    assert!((found.objective - 40.0 * 3.75e-7).abs() < 1e-12, "{}", found.objective);
    assert_eq!(found.stopped, Stopped::Optimal);
}

#[test]
fn overlap_alone_is_solved_to_the_end() {
    let rules = Rules { max_per_day: None, max_sessions: None, ..default_rules(120) };
    let problem = mission(120, 2, true, rules);
    let found = schedule(&problem).unwrap();
    hold(&problem, &found);
    let best = intervals(&problem);
    assert!(found.upper_bound >= best * (1.0 - 1e-12));
    assert!(found.objective >= best * (1.0 - 1e-5), "{} {best}", found.objective);
    assert!(found.gap < 1e-5);

    let free = Problem { rules: no_rules(), ..problem };
    let found = schedule(&free).unwrap();
    assert_eq!(found.chosen.len(), free.candidates.len());
    assert!(found.gap < 1e-9);
}

/// Optimum of `mission(20, 1, false, default_rules(20))`: the mixed-integer programme with every
/// clique, day and window row, solved by `HiGHS` 1.15.1 through highspy to a proved gap of 0 (relative
/// tolerance 1e-6).
const HIGHS_OPTIMUM_20_DAYS: f64 = 20_672.255_742_5;

#[test]
fn twenty_days_agree_with_an_independent_solver() {
    let problem = mission(20, 1, false, default_rules(20));
    let found = schedule(&problem).unwrap();
    hold(&problem, &found);
    assert!(found.upper_bound >= HIGHS_OPTIMUM_20_DAYS * (1.0 - 1e-6));
    assert!(found.objective <= HIGHS_OPTIMUM_20_DAYS * (1.0 + 1e-6));
    assert!(found.gap < 1e-6, "gap {} {} {}", found.gap, found.objective, found.upper_bound);
}

#[test]
fn three_years_reach_the_stated_gap() {
    let problem = mission(1_096, 1, false, default_rules(1_096));
    assert!((60_000..80_000).contains(&problem.candidates.len()));
    let found = schedule(&problem).unwrap();
    hold(&problem, &found);
    assert!(found.gap < 0.01, "gap {}", found.gap);
}

#[test]
#[ignore = "minutes: cargo test -p planner --test schedule -- --ignored"]
fn other_rules_reach_the_stated_gaps() {
    let window = Duration::from_ns(30 * DAY_NS);
    let base = default_rules(180);
    let cases = [
        (Rules { max_sessions: None, ..base.clone() }, 0.012),
        (Rules { max_per_day: None, ..base.clone() }, 0.005),
        (Rules { exclusive: Exclusive::All, max_sessions: None, ..base.clone() }, 0.015),
        (Rules { max_sessions: Some(SessionCount { count: 20, window }), ..base.clone() }, 0.03),
        (Rules { max_per_day: Some(Duration::from_seconds(86_400.0)), ..base }, 0.01),
    ];
    for (case, (rules, most)) in cases.into_iter().enumerate() {
        let problem = mission(180, 7, true, rules);
        let found = schedule(&problem).unwrap();
        hold(&problem, &found);
        assert!(found.gap < most, "case {case}: gap {}", found.gap);
    }
}
