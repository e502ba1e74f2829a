//! How long does a schedule of the default mission's size take.

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use criterion::{Criterion, criterion_group, criterion_main};
use planner::schedule::schedule;
use std::hint::black_box;

fn three_years(criterion: &mut Criterion) {
    let problem = synthetic::mission(1_096, 1, false, synthetic::default_rules(1_096));
    let mut group = criterion.benchmark_group("schedule");
    group.sample_size(10);
    group.bench_function("three years, default rules", |bencher| {
        bencher.iter(|| schedule(black_box(&problem)));
    });
    group.finish();
}

criterion_group!(benches, three_years);
criterion_main!(benches);
