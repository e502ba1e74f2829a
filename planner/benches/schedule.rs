//! Scheduling three years of a made-up mission of real size: `cargo bench -p planner`.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use criterion::{Criterion, criterion_group, criterion_main};
use planner::schedule::schedule;
use std::hint::black_box;

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

fn three_years(criterion: &mut Criterion) {
    let problem = synthetic::mission(1096, 1, false, synthetic::default_rules(1096));
    let mut group = criterion.benchmark_group("schedule");
    group.sample_size(10);
    group.bench_function("three years, 240 min and 4 sessions a day", |bencher| {
        bencher.iter(|| schedule(black_box(&problem)));
    });
    group.finish();
}

criterion_group!(benches, three_years);
criterion_main!(benches);
