//! Who watches a search learns its steps, changes nothing, and may end it.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

#[expect(dead_code, reason = "the stored instances are for another test")]
mod programs;
mod random;
mod stopping;
mod synthetic;

use planner::program::{Aids, Ended, Limits, solve};
use planner::progress::Progress;
use planner::schedule::{loosen, schedule, schedule_until};
use programs::{Shape, Values, instance};
use std::sync::Mutex;
use stopping::Stopping;
use synthetic::{default_rules, mission};

/// A step's name, its units and those that were done.
type Step = (String, u64, u64);

/// The steps that were told, and the number of calls.
#[derive(Default)]
struct Watcher(Mutex<(Vec<Step>, usize)>);

impl Progress for Watcher {
    fn begin(&self, step: &str, units: u64) {
        let mut told = self.0.lock().unwrap();
        told.0.push((step.to_owned(), units, 0));
        told.1 += 1;
    }

    fn advance(&self, units: u64) {
        let mut told = self.0.lock().unwrap();
        told.0.last_mut().unwrap().2 += units;
        told.1 += 1;
    }
}

impl Watcher {
    /// What was told; no step did more than its units, and there were few calls.
    fn told(self) -> Vec<String> {
        let (steps, calls) = self.0.into_inner().unwrap();
        assert!(calls < 500, "{calls}");
        for (step, units, done) in &steps {
            assert!(done <= units && !step.is_empty() && step.len() < 40, "{step}: {done} {units}");
        }
        steps.into_iter().map(|it| it.0).collect()
    }
}

#[test]
fn a_watched_schedule_is_the_same_and_tells_its_steps() {
    let problem = mission(20, 3, true, default_rules(20));
    let watcher = Watcher::default();
    let found = schedule_until(&problem, &watcher).unwrap();
    assert_eq!(found, schedule(&problem).unwrap());
    let told = watcher.told();
    assert!(told.iter().any(|it| it == "labels"), "{told:?}");
    let watcher = Watcher::default();
    assert!(!loosen(&problem, &watcher).unwrap().is_empty());
    assert_eq!(watcher.told(), ["loosened rules"]);
}

#[test]
fn a_programme_tells_its_search_and_ends_where_it_is_asked_to() {
    let shape = Shape {
        opportunities: 200,
        budgets: 6,
        telescopes: 2,
        values: Values::Uniform,
        depth: 5,
        tight: 10,
        local: false,
    };
    let program = instance(&shape, 1_002).program;
    let watcher = Watcher::default();
    let aids = Aids { progress: &watcher, ..Aids::default() };
    let whole = solve(&program, &Limits::default(), &aids).unwrap();
    assert_eq!(whole, solve(&program, &Limits::default(), &Aids::default()).unwrap());
    let told = watcher.told();
    assert!(told.iter().any(|it| it == "branch and bound"), "{told:?}");
    let aids = Aids { progress: &Stopping, ..Aids::default() };
    let stopped = solve(&program, &Limits::default(), &aids).unwrap();
    assert_eq!(stopped.ended, Ended::Stopped);
    assert!(stopped.taken.is_some() && stopped.value <= whole.value);
    assert!(stopped.bound >= whole.value);
}
