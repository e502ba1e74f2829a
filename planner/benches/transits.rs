//! How long does the certified search take: five planets over three years, each preset's strategy; and
//! how long is a search laid out, whatever the number of a body's spans.

use criterion::{Criterion, criterion_group, criterion_main};
use ephem::apparent::Sky;
use ephem::fit::{FitOptions, FittedTable, fit};
use ephem::source::Source;
use ephem::time::parse_time;
use onboard_core::direction::MotionBounds;
use onboard_core::ephemeris::{BodyRecord, EphemerisTable, SUN, Span, table_header};
use onboard_core::field_of_view::FieldOfView;
use onboard_core::frame::Boresight;
use onboard_core::phase::{Phase, Rotor, TurnRate};
use onboard_core::rotation::Rotation;
use onboard_core::scan::{ScanParameters, ScanStrategy};
use onboard_core::sun::SunModel;
use onboard_core::time::{Duration, Instant};
use onboard_core::transit::{Channel, Step, TransitFinder};
use std::error::Error;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::num::NonZeroU64;

const PLANETS: [&str; 5] = ["mars", "jupiter", "saturn", "uranus", "neptune"];

/// Alpha, beta in degrees, periods of precession and spin in minutes.
const STRATEGIES: [(&str, [f64; 4]); 3] = [
    ("litebird", [45.0, 50.0, 192.348, 20.0]),
    ("pico", [26.0, 69.0, 600.0, 1.0]),
    ("planck", [7.5, 85.0, 262_980.0, 1.0]),
];

fn span() -> Result<(Instant, Instant), Box<dyn Error>> {
    let start = parse_time("2032-04-01T00:00:00 TDB")?;
    Ok((start, start.plus(Duration::from_seconds(1_095.75 * 86_400.0))))
}

fn table() -> Result<FittedTable, Box<dyn Error>> {
    let sources: Vec<Source> =
        PLANETS.iter().map(|name| Source::by_name(name)).collect::<Result<_, _>>()?;
    Ok(fit(&Sky::from_l2(span()?.0), &sources, span()?, &FitOptions::UPLINK)?)
}

fn strategy([alpha, beta, precession, spin]: [f64; 4]) -> Result<ScanStrategy, Box<dyn Error>> {
    let rotor = |minutes: f64| Rotor {
        rate: TurnRate::from_radians_per_second(TAU / (60.0 * minutes)),
        start: Phase::ZERO,
    };
    ScanStrategy::new(ScanParameters {
        start: span()?.0,
        alpha_rad: alpha.to_radians(),
        beta_rad: beta.to_radians(),
        precession: rotor(precession),
        spin: rotor(spin),
    })
    .map_err(|error| format!("{error:?}").into())
}

fn field() -> Result<FieldOfView, Box<dyn Error>> {
    let line_of_sight = Rotation::<Boresight, Boresight>::IDENTITY;
    FieldOfView::circle(line_of_sight, 0.5_f64.to_radians())
        .map_err(|error| format!("{error:?}").into())
}

/// Transits of all bodies but the Sun, one search after another.
fn search(
    turning: &ScanStrategy,
    table: EphemerisTable<'_>,
    field: &FieldOfView,
    span: (Instant, Instant),
) -> usize {
    let Ok(sun) = table.body(SUN).map(SunModel::Table) else { return 0 };
    let bodies = table.bodies().filter(|record| record.body != SUN);
    bodies
        .filter_map(|record| table.body(record.body).ok())
        .map(|body| {
            let mut channels = [Channel::new(turning, sun, body, field, span)];
            let mut finder = TransitFinder::new(&mut channels);
            let mut found = 0;
            loop {
                match finder.step() {
                    Step::Transit(_) => found += 1,
                    Step::Searched(_) => {}
                    Step::Done | Step::Failed { .. } => return found,
                }
            }
        })
        .sum()
}

fn three_years(criterion: &mut Criterion) -> Result<(), Box<dyn Error>> {
    let (fitted, span, field) = (table()?, span()?, field()?);
    let table = EphemerisTable::parse(&fitted.bytes).map_err(|error| format!("{error:?}"))?;
    let mut group = criterion.benchmark_group("three years of transits");
    group.sample_size(10);
    for (name, numbers) in STRATEGIES {
        let turning = strategy(numbers)?;
        group.bench_function(name, |bencher| {
            bencher.iter(|| search(black_box(&turning), table, &field, span));
        });
    }
    group.finish();
    Ok(())
}

/// A body at rest in so many spans.
fn resting(spans: u32) -> Result<Vec<u8>, Box<dyn Error>> {
    let bounds = MotionBounds { max_abs_z: 1.0, ..MotionBounds::NONE };
    let granule_ns = NonZeroU64::new(1_000_000_000).ok_or("a length")?;
    let mut bytes = table_header(1, spans, 3).to_vec();
    bytes.extend(BodyRecord { body: 5, spans, first: 0, bounds }.to_le_bytes());
    for index in 0..spans {
        let start = Instant::from_tai_ns(1_000_000_000 * i64::from(index));
        let span =
            Span { body: 5, coefficients: 1, granules: 1, first: 0, start, granule_ns, bounds };
        bytes.extend(span.to_le_bytes());
    }
    bytes.extend([0.0, 0.6, 0.8_f64].iter().flat_map(|number| number.to_le_bytes()));
    Ok(bytes)
}

fn laying_out(criterion: &mut Criterion) -> Result<(), Box<dyn Error>> {
    let (turning, field) = (strategy(STRATEGIES[0].1)?, field()?);
    let mut group = criterion.benchmark_group("laying out a search");
    for spans in [1, 100, 10_000] {
        let bytes = resting(spans)?;
        let table = EphemerisTable::parse(&bytes).map_err(|error| format!("{error:?}"))?;
        group.bench_function(format!("{spans} spans"), |bencher| {
            bencher.iter(|| {
                let body = table.body(black_box(5))?;
                let sun = SunModel::Table(body);
                let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(1_000));
                Ok::<_, onboard_core::ephemeris::EphemerisError>(black_box(Channel::new(
                    &turning, sun, body, &field, span,
                )))
            });
        });
    }
    group.finish();
    Ok(())
}

fn all(criterion: &mut Criterion) {
    three_years(criterion).expect("a table and strategies");
    laying_out(criterion).expect("a table");
}

criterion_group!(benches, all);
criterion_main!(benches);
