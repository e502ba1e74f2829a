//! How long the main jobs take: `cargo bench -p ground-tools`.
//!
//! Transits are searched on one thread, tables fitted beforehand; `plan` is the whole process.

use criterion::{Criterion, criterion_group, criterion_main};
use mission::{Mission, Override};
use planner::opportunities::search;
use planner::opportunities::select;
use planner::world::World;
use std::hint::black_box;
use std::process::{Command, Stdio};

fn world(preset: &str) -> World {
    let phase = Override::set("scan.spin_phase_deg=180").expect("a key and a value");
    let mission = Mission::load(preset, &[phase]).expect("a preset");
    World::open(mission, None).expect("a world")
}

/// Three years of five planets through the boresight, one thread.
fn transits(criterion: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut group = criterion.benchmark_group("transits, 3 years, 5 planets");
    group.sample_size(10);
    for preset in ["litebird", "pico", "planck"] {
        let world = world(preset);
        let tables = world.tables(&world.ground_options()).expect("tables");
        let table = tables.parse().expect("a table");
        let lines = select(&world.mission, None, None).expect("the boresight");
        group.bench_function(preset, |bencher| {
            bencher.iter(|| pool.install(|| search(black_box(&world), table, &lines)));
        });
    }
    group.finish();
}

/// Fitting the table that goes on board.
fn fit(criterion: &mut Criterion) {
    let world = world("litebird");
    criterion.bench_function("fit the uplink table", |bencher| {
        bencher.iter(|| black_box(&world).tables(&ephem::fit::FitOptions::UPLINK));
    });
}

/// The main job, whole process.
fn plan(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("plan");
    let mut group = criterion.benchmark_group("plan, whole process");
    group.sample_size(10);
    group.bench_function("litebird", |bencher| {
        bencher.iter(|| {
            let status = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
                .args(["plan", "--quiet", "--out"])
                .arg(&out)
                .stdout(Stdio::null())
                .status()
                .expect("the command runs");
            assert!(status.success());
        });
    });
    group.finish();
}

criterion_group!(speed, transits, fit, plan);
criterion_main!(speed);
