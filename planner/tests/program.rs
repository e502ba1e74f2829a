//! The integer programme against exhaustive search, a longest path, and stored optima of `HiGHS`.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]
#![expect(clippy::print_stdout, reason = "gaps reached, for the record")]

mod programs;
mod random;

use ephem::random::SplitMix64;
use planner::program::{
    Aids, Cell, Choice, Ended, Family, Gain, Limits, Outcome, Program, Row, solve,
};
use programs::{Instance, Shape, Values, instance, stored};
use random::between;

/// What must hold of any outcome.
fn hold(program: &Program, found: &Outcome) {
    if let Some(taken) = &found.taken {
        assert_eq!(program.evaluate(taken, &[]).unwrap(), Some(found.value));
        assert!(found.bound >= found.value);
    }
    if found.ended == Ended::Proven {
        assert!(found.taken.is_none() || found.bound == found.value);
    }
}

/// The best value over all sets.
fn exhaustive(program: &Program, families: &[&dyn Family]) -> Option<i128> {
    let count = program.values.len();
    let sets = (0_u32..1 << count)
        .map(|set| -> Vec<usize> { (0..count).filter(|at| set >> at & 1 == 1).collect() });
    sets.filter_map(|set| program.evaluate(&set, families).unwrap()).max()
}

/// A programme of every kind of row and gain, small.
fn small(random: &mut SplitMix64) -> Program {
    let count = usize::try_from(between(random, 1, 11)).unwrap();
    let subset = |random: &mut SplitMix64, low: i64, high: i64| -> Vec<(usize, i64)> {
        let all = (0..count).filter(|_| between(random, 0, 2) > 0).collect::<Vec<_>>();
        all.into_iter().map(|at| (at, between(random, low, high))).collect()
    };
    let tied = between(random, 0, 1) == 1;
    let values = (0..count)
        .map(|_| if tied { 7 * between(random, -1, 2) } else { between(random, -20, 1_000) })
        .collect();
    let choices = (0..count)
        .map(|_| match between(random, 0, 15) {
            0 => Choice::Always,
            1 => Choice::Never,
            _ => Choice::Free,
        })
        .collect();
    let rows = (0..between(random, 0, 5))
        .map(|_| match between(random, 0, 3) {
            0 => Row { terms: subset(random, 1, 1), limit: between(random, 0, 3) },
            1 => Row { terms: subset(random, -5, 5), limit: between(random, -4, 10) },
            _ => Row { terms: subset(random, 1, 100), limit: between(random, 0, 300) },
        })
        .collect();
    let cells = (0..between(random, 0, 3))
        .map(|_| {
            let gain = if between(random, 0, 1) == 0 {
                let (wanted, price) = (between(random, 0, 20), between(random, 0, 60));
                Gain::Shortfall { wanted, price }
            } else {
                Gain::Log { scale: between(random, 0, 5_000), offset: between(random, 1, 10) }
            };
            Cell { terms: subset(random, 0, 9), gain, base: between(random, 0, 4) }
        })
        .collect();
    Program { values, choices, rows, cells }
}

#[test]
fn small_programmes_agree_with_exhaustive_search() {
    let mut random = SplitMix64(6);
    let mut infeasible = 0;
    for round in 0..1_500 {
        let program = small(&mut random);
        let best = exhaustive(&program, &[]);
        let Ok(found) = solve(&program, &Limits::default(), &Aids::default()) else {
            assert_eq!(best, None, "round {round}");
            infeasible += 1;
            continue;
        };
        hold(&program, &found);
        assert!(best.is_none_or(|best| best <= found.bound), "round {round}: bound too low");
        match best {
            None => {
                infeasible += 1;
                assert_eq!(found.taken, None, "round {round}");
            }
            Some(best) => {
                assert!(found.taken.is_some(), "round {round}: nothing found, {best} exists");
                assert_eq!(found.value, best, "round {round}");
                assert!(found.bound - best <= best.abs() >> 30, "round {round}");
            }
        }
        assert_eq!(found.ended, Ended::Proven, "round {round}");
    }
    assert!(infeasible > 30, "{infeasible}");
}

/// The best value where only overlap counts: a longest path per telescope.
fn longest_path(instance: &Instance, telescopes: usize) -> i128 {
    (0..telescopes)
        .map(|lane| {
            let mut all: Vec<(i64, i64, i64)> = instance
                .intervals
                .iter()
                .zip(&instance.program.values)
                .filter(|(it, _)| it.0 == lane)
                .map(|(it, &value)| (it.2, it.1, value))
                .collect();
            all.sort_unstable();
            let mut best = vec![0_i128];
            for (at, &(_, start, value)) in all.iter().enumerate() {
                let before = all.partition_point(|it| it.0 <= start).min(at);
                best.push(best[at].max(best[before] + i128::from(value)));
            }
            best[all.len()]
        })
        .sum()
}

#[test]
fn intervals_alone_are_solved_exactly() {
    for (seed, values) in
        [(1, Values::Uniform), (2, Values::Length), (3, Values::Tied), (4, Values::Tied)]
    {
        for opportunities in [50, 400, 3_000] {
            let shape = Shape {
                opportunities,
                budgets: 0,
                telescopes: 3,
                values,
                depth: 4,
                tight: 100,
                local: false,
            };
            let instance = instance(&shape, seed);
            let found = solve(&instance.program, &Limits::default(), &Aids::default()).unwrap();
            hold(&instance.program, &found);
            assert_eq!(found.value, longest_path(&instance, 3));
            assert_eq!((found.bound, found.ended), (found.value, Ended::Proven));
        }
    }
}

/// Optimum and proved bound per instance, by `HiGHS`.
fn optima() -> Vec<(String, f64, f64)> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/program_optima.csv");
    let text = std::fs::read_to_string(path).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    rows.map(|line| {
        let mut cells = line.split(',');
        let name = cells.next().unwrap().to_owned();
        let mut number = || cells.next().unwrap().parse().unwrap();
        (name, number(), number())
    })
    .collect()
}

/// Relative difference of two numbers of units.
fn gap(bound: i128, value: i128) -> f64 {
    let float = |number: i128| f64::from(i32::try_from(number).unwrap());
    float(bound - value) / float(bound)
}

/// Solves stored instances; the best of `HiGHS`, and whether it is proved, go with each outcome.
fn against_highs(pick: impl Fn(&str) -> bool, judge: impl Fn(&str, &Outcome, f64, bool)) {
    let optima = optima();
    for (name, shape, seed) in stored().into_iter().filter(|it| pick(&it.0)) {
        let program = instance(&shape, seed).program;
        let found = solve(&program, &Limits::default(), &Aids::default()).unwrap();
        hold(&program, &found);
        let (_, best, bound) = optima.iter().find(|it| it.0 == name).unwrap();
        let value = f64::from(i32::try_from(found.bound).unwrap());
        assert!(value >= best * (1.0 - 1e-9), "{name}: bound {value} below {best}");
        println!("{name}: gap {:.2e} {} nodes", gap(found.bound, found.value), found.nodes);
        judge(&name, &found, *best, bound - best < 0.5);
    }
}

/// Values that follow what is used: hard for every solver.
fn is_slow(name: &str) -> bool {
    name.starts_with("1000") || name == "200-6-10-Correlated" || name == "200-6-5-Correlated"
}

#[test]
fn budgeted_programmes_reach_the_optimum_of_highs() {
    against_highs(
        |name| !is_slow(name),
        |name, found, best, proved| {
            assert!(proved, "{name}: HiGHS proves it");
            let value = f64::from(i32::try_from(found.value).unwrap());
            assert!((value - best).abs() <= 1e-6 * best, "{name}: {value} {best}");
            assert_eq!(found.ended, Ended::Proven, "{name}");
        },
    );
}

#[test]
#[ignore = "minutes: cargo test -p planner --test program -- --ignored hard --nocapture"]
fn hard_and_large_programmes_come_close() {
    against_highs(is_slow, |name, found, best, _| {
        let value = f64::from(i32::try_from(found.value).unwrap());
        assert!(value >= best * 0.999, "{name}: {value} {best}");
        assert!(gap(found.bound, found.value) <= 0.003, "{name}");
    });
}

#[test]
#[ignore = "a minute: cargo test -p planner --test program -- --ignored ten --nocapture"]
fn ten_thousand_opportunities_with_fifty_budgets() {
    for local in [false, true] {
        let shape = Shape {
            opportunities: 10_000,
            budgets: 50,
            telescopes: 3,
            values: Values::Uniform,
            depth: 4,
            tight: 12,
            local,
        };
        let program = instance(&shape, 77).program;
        let found = solve(&program, &Limits::default(), &Aids::default()).unwrap();
        hold(&program, &found);
        println!("local {local}: gap {:.2e}", gap(found.bound, found.value));
        assert!(gap(found.bound, found.value) <= 0.005);
    }
}
