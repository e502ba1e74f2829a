//! Visits: histograms against a plain recount, confidence against repeated searches.
#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use onboard_core::ephemeris::EphemerisTable;
use onboard_core::field_of_view::FieldOfView;
use onboard_core::frame::{Boresight, Telescope};
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::scan::{ScanParameters, ScanStrategy};
use onboard_core::sun::SunModel;
use onboard_core::time::{Duration, Instant};
use onboard_core::transit::{Channel, Confidence, Transit};
use onboard_core::uncertainty::ScanCovariance;
use onboard_core::visits::{
    Bins, BinsError, Divisions, Histogram, HistogramBin, LastVisit, Spacing, TargetVisits,
    VisitError, VisitLog,
};
use std::mem::size_of;
use tests::{Noise, Plain, table, transits, turn_rate};

const DAY_NS: i64 = 86_400_000_000_000;
const TARGET: [f64; 3] = [0.6, 0.8, 0.01];

fn divisions() -> Divisions {
    Divisions {
        dwell: Bins::new(Spacing::Linear, 0.0, 40.0).unwrap(),
        revisit: Bins::new(Spacing::Logarithmic, 60.0, 1e6).unwrap(),
        gap: Bins::new(Spacing::Logarithmic, 1.0, 1e5).unwrap(),
    }
}

/// The bin by its edges alone.
fn recount<const BINS: usize>(bins: &Bins, values: &[f64]) -> ([u32; BINS], u32, u32) {
    let mut counts = [0; BINS];
    for (index, count) in counts.iter_mut().enumerate() {
        let (low, high) = (bins.edge_s(index, BINS), bins.edge_s(index + 1, BINS));
        *count = values.iter().filter(|v| **v >= low && **v < high).count() as u32;
    }
    let under = values.iter().filter(|v| **v < bins.edge_s(0, BINS)).count() as u32;
    let over = values.iter().filter(|v| **v >= bins.edge_s(BINS, BINS)).count() as u32;
    (counts, under, over)
}

fn same<const BINS: usize>(histogram: &Histogram<BINS>, bins: &Bins, values: &[f64]) {
    assert_eq!((histogram.counts, histogram.under, histogram.over), recount(bins, values));
    assert_eq!(histogram.total(), values.len() as u32);
}

fn visit(entry_ns: i64, exit_ns: i64) -> Transit {
    Transit {
        channel: 0,
        entry: Instant::from_tai_ns(entry_ns),
        exit: Instant::from_tai_ns(exit_ns),
        closest: Instant::from_tai_ns(entry_ns),
        min_separation_rad: 0.0,
        entry_clipped: false,
        exit_clipped: false,
    }
}

#[test]
fn statistics_agree_with_a_plain_recount() {
    const TARGETS: usize = 3;
    const BINS: usize = 12;
    let mut memory = [TargetVisits::<BINS>::EMPTY; TARGETS];
    let mut log = VisitLog::new(&divisions(), &mut memory);
    let mut noise = Noise::new(5);
    let mut taken: [Vec<Transit>; TARGETS] = Default::default();
    let mut now = -5 * DAY_NS;
    for _ in 0..20_000 {
        // Waits over eight decades, entries of all targets in one order.
        now += 10.0_f64.powf(6.0 + 8.0 * noise.unit()) as i64;
        let target = (noise.bits() % 3) as usize;
        let mut transit = visit(now, now + (60e9 * noise.unit()) as i64);
        transit.entry_clipped = noise.unit() < 0.05;
        transit.exit_clipped = noise.unit() < 0.05;
        let before = taken[target].last();
        if let Some(last) = before.filter(|last| transit.entry < last.exit) {
            let error = VisitError::Overlap { entry: transit.entry, exit: last.exit };
            assert_eq!(log.record(target, &transit), Err(error));
            continue;
        }
        log.record(target, &transit).unwrap();
        taken[target].push(transit);
    }
    for (target, visits) in log.targets().iter().zip(&taken) {
        let whole = |t: &&Transit| !t.entry_clipped && !t.exit_clipped;
        let dwell: Vec<f64> = visits.iter().filter(whole).map(|t| t.dwell().seconds()).collect();
        let pairs = || visits.windows(2).filter(|pair| !pair[1].entry_clipped);
        let revisit: Vec<f64> = pairs()
            .filter(|pair| !pair[0].entry_clipped)
            .map(|pair| pair[1].entry.since(pair[0].entry).seconds())
            .collect();
        let gap: Vec<f64> = pairs()
            .filter(|pair| !pair[0].exit_clipped)
            .map(|pair| pair[1].entry.since(pair[0].exit).seconds())
            .collect();
        assert!(gap.len() > 1_000, "{}", gap.len());
        same(&target.dwell, &log.divisions().dwell, &dwell);
        same(&target.revisit, &log.divisions().revisit, &revisit);
        same(&target.gap, &log.divisions().gap, &gap);
        assert_eq!(target.visits as usize, visits.len());
        assert_eq!(target.clipped as usize, visits.len() - dwell.len());
        let longest = target.longest_gap.unwrap().seconds();
        assert!((longest - gap.iter().copied().fold(0.0, f64::max)).abs() < 1e-9);
        assert!((target.dwell_sum.seconds() - dwell.iter().sum::<f64>()).abs() < 1e-3);
    }
}

#[test]
fn bins_hold_their_edges() {
    let mut noise = Noise::new(8);
    for spacing in [Spacing::Linear, Spacing::Logarithmic] {
        for _ in 0..2_000 {
            let low = 10.0_f64.powf(8.0 * noise.unit() - 8.0);
            let high = low * (1.0 + 10.0_f64.powf(9.0 * noise.unit() - 3.0));
            let bins = Bins::new(spacing, low, high).unwrap();
            let count = 1 + (noise.bits() % 64) as usize;
            for index in 0..count {
                let edge = bins.edge_s(index, count);
                assert_eq!(bins.bin(edge, count), HistogramBin::Bin(index));
                if index > 0 {
                    assert_eq!(bins.bin(edge.next_down(), count), HistogramBin::Bin(index - 1));
                }
            }
            assert_eq!(bins.bin(high, count), HistogramBin::Overflow);
            assert_eq!(bins.bin(f64::INFINITY, count), HistogramBin::Overflow);
            assert_eq!(bins.bin(low.next_down(), count), HistogramBin::Underflow);
            assert_eq!(bins.bin(f64::NAN, count), HistogramBin::Underflow);
        }
    }
    let bins = |spacing, low, high| Bins::new(spacing, low, high).unwrap_err();
    assert_eq!(bins(Spacing::Logarithmic, 0.0, 1.0), BinsError::Low(0.0));
    assert_eq!(bins(Spacing::Linear, -1.0, 1.0), BinsError::Low(-1.0));
    assert_eq!(bins(Spacing::Linear, 1.0, 1.0), BinsError::High(1.0));
    assert_eq!(bins(Spacing::Linear, 1.0, f64::INFINITY), BinsError::High(f64::INFINITY));
}

#[test]
// REQ-VISIT-1.
fn what_is_out_of_order_is_refused_and_changes_nothing() {
    let mut memory = [TargetVisits::<4>::EMPTY; 2];
    let mut log = VisitLog::new(&divisions(), &mut memory);
    log.record(0, &visit(100, 200)).unwrap();
    let before = log.targets().to_vec();
    let at = Instant::from_tai_ns;
    assert_eq!(log.record(2, &visit(300, 400)), Err(VisitError::NoSuchTarget(2)));
    assert_eq!(
        log.record(1, &visit(400, 300)),
        Err(VisitError::Reversed { entry: at(400), exit: at(300) })
    );
    assert_eq!(
        log.record(0, &visit(99, 300)),
        Err(VisitError::OutOfOrder { entry: at(99), latest: at(100) })
    );
    assert_eq!(
        log.record(0, &visit(150, 300)),
        Err(VisitError::Overlap { entry: at(150), exit: at(200) })
    );
    assert_eq!(log.targets(), before);
    // Another target's visit may lie before: its search may have stood still for a while.
    log.record(1, &visit(40, 300)).unwrap();
    let last =
        LastVisit { entry: at(40), exit: at(300), entry_clipped: false, exit_clipped: false };
    assert_eq!(log.targets()[1].last, Some(last));
}

#[test]
fn sizes_are_as_stated() {
    assert_eq!(size_of::<Histogram<32>>(), 4 * 32 + 8);
    assert!(size_of::<TargetVisits<32>>() <= 3 * size_of::<Histogram<32>>() + 80);
    assert!(size_of::<VisitLog<'_, 32>>() <= 128);
}

fn sun() -> SunModel<'static> {
    SunModel::Circular(Rotor {
        rate: turn_rate(31_557_600_000_000_000, 1),
        start: Phase::from_radians(-1.0),
    })
}

fn circle(degrees: f64) -> FieldOfView {
    FieldOfView::circle(Rotation::<Boresight, Boresight>::IDENTITY, degrees.to_radians()).unwrap()
}

fn rectangle() -> FieldOfView {
    let tilted = Rotation::<Telescope, Boresight>::about_z(0.3)
        .then(Rotation::<Boresight, Boresight>::about_x(0.1));
    FieldOfView::rectangle(tilted, 18.0_f64.to_radians(), 8.0_f64.to_radians()).unwrap()
}

/// The strategy with errors in precession phase, alpha and spin phase.
fn shifted(scan: &ScanStrategy, errors: [f64; 3]) -> ScanStrategy {
    let parameters = *scan.parameters();
    let turned =
        |rotor: Rotor, by: f64| Rotor { start: rotor.start.plus(Phase::from_radians(by)), ..rotor };
    ScanStrategy::new(ScanParameters {
        alpha_rad: parameters.alpha_rad + errors[1],
        precession: turned(parameters.precession, errors[0]),
        spin: turned(parameters.spin, errors[2]),
        ..parameters
    })
    .unwrap()
}

/// Covariance of one angle alone, or of all with weights `g g^T sigma^2`.
fn rank_one(weights: [f64; 3], sigma: f64) -> ScanCovariance {
    let [a, b, c] = weights.map(|weight| weight * sigma);
    ScanCovariance { variances: [a * a, b * b, c * c], covariances: [a * b, a * c, b * c] }
}

fn search(
    scan: &ScanStrategy,
    field: &FieldOfView,
    bytes: &[u8],
    span: (i64, i64),
) -> Vec<Transit> {
    let body = EphemerisTable::parse(bytes).unwrap().body(5).unwrap();
    let span = (Instant::from_tai_ns(span.0), Instant::from_tai_ns(span.1));
    transits(&mut [Channel::new(scan, sun(), body, field, span)])
}

/// The transits of twenty days with what is said of each.
fn predicted(
    scan: &ScanStrategy,
    field: &FieldOfView,
    bytes: &[u8],
    covariance: &ScanCovariance,
) -> Vec<(Transit, Confidence)> {
    let body = EphemerisTable::parse(bytes).unwrap().body(5).unwrap();
    let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(20 * DAY_NS));
    let mut channels = [Channel::new(scan, sun(), body, field, span)];
    let found = transits(&mut channels);
    let sure = |t: &Transit| channels[0].confidence(t, covariance).unwrap();
    found.iter().map(|transit| (*transit, sure(transit))).collect()
}

fn still() -> Vec<u8> {
    table(5, 0, 20 * DAY_NS as u64, &[vec![TARGET]])
}

const STRATEGIES: [Plain; 3] = [
    Plain::LITEBIRD,
    Plain { signs: (-1, 1), ..Plain::LITEBIRD },
    Plain {
        alpha_deg: 22.5,
        beta_deg: 70.0,
        precession_ns: 3_600_000_000_000,
        spin_ns: 129_000_000_000,
        signs: (1, -1),
        ..Plain::LITEBIRD
    },
];

#[test]
fn the_derivatives_are_those_of_the_whole_search() {
    let bytes = still();
    let mut compared = 0;
    for plain in STRATEGIES {
        for field in [circle(3.0), rectangle(), circle(2.0).enlarged(0.02).unwrap()] {
            let scan = plain.strategy();
            // Each angle alone, and two mixtures in which signs matter.
            for weights in [
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0],
                [1.0, -2.0, 0.7],
                [-0.5, 1.0, 1.0],
            ] {
                let step = 1e-5;
                let said = predicted(&scan, &field, &bytes, &rank_one(weights, step));
                for (transit, confidence) in said.iter().step_by(7) {
                    let near = (
                        transit.entry.tai_ns() - 5_000_000_000,
                        transit.exit.tai_ns() + 5_000_000_000,
                    );
                    let dwell = transit.dwell().seconds();
                    // Grazing edges are not linear.
                    if transit.entry_clipped || transit.exit_clipped || near.0 < 0 || dwell < 3.0 {
                        continue;
                    }
                    let at = |sign: f64| {
                        let found = search(
                            &shifted(&scan, weights.map(|w| sign * w * step)),
                            &field,
                            &bytes,
                            near,
                        );
                        assert_eq!(found.len(), 1, "{transit:?}");
                        found[0]
                    };
                    let (more, less) = (at(1.0), at(-1.0));
                    let slope = |a: Instant, b: Instant| 0.5 * a.since(b).seconds().abs();
                    let close = |found: f64, said: f64, slack_s: f64| {
                        assert!(
                            (found - said).abs() < 1e-3 * said + slack_s,
                            "{found:e} {said:e} {weights:?} {plain:?} {transit:?}"
                        );
                    };
                    close(slope(more.entry, less.entry), confidence.entry_sigma_s, 3e-9);
                    close(slope(more.exit, less.exit), confidence.exit_sigma_s, 3e-9);
                    if transit.min_separation_rad > 1e-3 {
                        // Flat at its minimum, the separation fixes its instant to a microsecond.
                        close(slope(more.closest, less.closest), confidence.closest_sigma_s, 1e-6);
                        let moved = 0.5 * (more.min_separation_rad - less.min_separation_rad).abs();
                        if field.margin_rad().abs() < 1e-12
                            && matches!(
                                field.shape(),
                                onboard_core::field_of_view::FieldShape::Circle(_)
                            )
                        {
                            let said = confidence.separation_sigma_rad;
                            assert!(
                                (moved - said).abs() < 2e-3 * said + 1e-11,
                                "{moved:e} {said:e}"
                            );
                        }
                    }
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 200, "{compared}");
}

/// Two numbers of the standard normal distribution.
fn normal(noise: &mut Noise) -> (f64, f64) {
    let radius = (-2.0 * (1.0 - noise.unit()).ln()).sqrt();
    let (sin, cos) = (std::f64::consts::TAU * noise.unit()).sin_cos();
    (radius * cos, radius * sin)
}

/// Errors drawn with independent angles but one correlation: spin with precession phase.
fn draw(noise: &mut Noise, sigmas: [f64; 3]) -> [f64; 3] {
    let ((u, v), (w, _)) = (normal(noise), normal(noise));
    [sigmas[0] * u, sigmas[1] * v, sigmas[2] * (0.8 * w - 0.6 * u)]
}

fn drawn_from(sigmas: [f64; 3]) -> ScanCovariance {
    let [a, b, c] = sigmas;
    ScanCovariance { variances: [a * a, b * b, c * c], covariances: [0.0, -0.6 * a * c, 0.0] }
}

#[test]
// REQ-FORECAST-2.
fn the_stated_interval_holds_the_truth() {
    let bytes = still();
    let sigmas = [3e-4, 1e-4, 5e-4];
    let draws = 1_000;
    for field in [circle(3.0), rectangle()] {
        let scan = Plain::LITEBIRD.strategy();
        let said = predicted(&scan, &field, &bytes, &drawn_from(sigmas));
        let (transit, confidence) =
            said.iter().find(|(t, _)| !t.entry_clipped && t.dwell().seconds() > 15.0).unwrap();
        assert!(confidence.probability > 1.0 - 1e-9, "{confidence:?}");
        let near =
            (transit.entry.tai_ns() - 30_000_000_000, transit.exit.tai_ns() + 30_000_000_000);
        let mut noise = Noise::new(21);
        let (mut entries, mut exits, mut whole) = (0, 0, 0);
        for _ in 0..draws {
            let truth = search(&shifted(&scan, draw(&mut noise, sigmas)), &field, &bytes, near);
            let [truth] = truth[..] else { panic!("{truth:?}") };
            let within = |found: Instant, said: Instant, sigma: f64| {
                u32::from(found.since(said).seconds().abs() <= 1.96 * sigma)
            };
            entries += within(truth.entry, transit.entry, confidence.entry_sigma_s);
            exits += within(truth.exit, transit.exit, confidence.exit_sigma_s);
            whole += u32::from(
                confidence.earliest_entry <= truth.entry && truth.exit <= confidence.latest_exit,
            );
        }
        println!("entries {entries}, exits {exits}, whole visits {whole} of {draws}");
        assert!((930..=970).contains(&entries), "{entries}");
        assert!((930..=970).contains(&exits), "{exits}");
        assert!((930..=980).contains(&whole), "{whole}");
    }
}

#[test]
fn the_stated_probability_is_the_share_of_searches_that_find_the_visit() {
    let bytes = still();
    // Radians: comparable with the depth of shallow transits.
    let sigmas = [4e-3, 2e-3, 3e-3];
    for field in [circle(1.0), rectangle(), circle(0.1)] {
        let scan = Plain::LITEBIRD.strategy();
        let said = predicted(&scan, &field, &bytes, &drawn_from(sigmas));
        let unsure: Vec<_> =
            said.iter().filter(|(_, c)| c.probability > 0.05 && c.probability < 0.95).collect();
        assert!(!unsure.is_empty(), "{}", said.len());
        for (transit, confidence) in unsure.iter().take(3) {
            let middle = transit.closest.tai_ns();
            let near = (middle - 300_000_000_000, middle + 300_000_000_000);
            let mut noise = Noise::new(22);
            let draws = 1_000;
            let happened = (0..draws)
                .filter(|_| {
                    let errors = draw(&mut noise, sigmas);
                    !search(&shifted(&scan, errors), &field, &bytes, near).is_empty()
                })
                .count();
            let share = happened as f64 / f64::from(draws);
            println!("stated {}, found {share}", confidence.probability);
            // Three standard deviations of a share of 1,000, and the first order's own error.
            assert!(
                (share - confidence.probability).abs() < 0.048 + 0.02,
                "{share} {confidence:?}"
            );
        }
    }
}

#[test]
fn certain_angles_make_a_certain_visit() {
    let bytes = still();
    let said = predicted(&Plain::LITEBIRD.strategy(), &circle(3.0), &bytes, &ScanCovariance::ZERO);
    assert!(!said.is_empty());
    for (transit, confidence) in said {
        assert!((confidence.probability - 1.0).abs() < 1e-12, "{confidence:?}");
        assert_eq!(confidence.earliest_entry.since(transit.entry), Duration::ZERO);
        assert_eq!(confidence.latest_exit.since(transit.exit), Duration::ZERO);
    }
}
