//! What the tracker refuses, what a correction keeps, and how a saved state goes on.

use onboard_core::attitude::attitude;
use onboard_core::direction::Direction;
use onboard_core::ephemeris::{EphemerisError, EphemerisTable};
use onboard_core::frame::{Boresight, Icrf};
use onboard_core::rotation::Rotation;
use onboard_core::scan::ScanStrategy;
use onboard_core::sun::SunModel;
use onboard_core::time::Duration;
use onboard_core::tracking::{
    Measurement, MeasurementRefusal, ResumeError, ScanAngle, ScanAngles, TRACKER_BYTES, Tracker,
    TrackerSettings, TrackerSettingsError, TrackerState,
};
use std::f64::consts::PI;
use tests::attitudes::{
    ARCSEC, DAY_NS, MINUTE_NS, NOISE_RAD, SETTINGS, Truth, at, errors, measured, sun, tracked,
};
use tests::{Noise, Plain, table};

/// The spacecraft of the saved states.
const SPACECRAFT: u32 = 7;

/// A tracker that has seen an hour of attitudes, and the truth.
fn settled() -> (ScanStrategy, Tracker) {
    let mut noise = Noise::new(40);
    let model = Plain::LITEBIRD.strategy();
    let truth = Truth::drawn(&mut noise).of(&model);
    let tracker = tracked(&model, &truth, (7, 10 * MINUTE_NS), &mut noise);
    (truth, tracker)
}

/// The state's bytes, without the counter that a refusal moves and the CRC.
fn frozen(tracker: &Tracker) -> Vec<u8> {
    tracker.state().to_le_bytes(SPACECRAFT)[..TRACKER_BYTES - 8].to_vec()
}

/// Hands the measurement to a copy of the tracker; it must be refused and change nothing.
fn refusal(tracker: &Tracker, sun: &SunModel<'_>, m: &Measurement, now: i64) -> MeasurementRefusal {
    let mut tracker = *tracker;
    let (before, refused) = (frozen(&tracker), tracker.refused_in_a_row());
    let why = tracker.update(sun, m, at(now)).unwrap_err();
    assert_eq!(frozen(&tracker), before, "{why:?}");
    assert_eq!(tracker.refused_in_a_row(), refused + 1);
    why
}

#[test]
// REQ-TRACK-1.
fn what_cannot_be_used_is_refused_and_changes_nothing() {
    let (truth, tracker) = settled();
    let ns = 70 * MINUTE_NS;
    let last = tracker.epoch();
    assert_eq!(last, at(60 * MINUTE_NS));
    let mut noise = Noise::new(41);
    let good = measured(&truth, ns, NOISE_RAD, &mut noise);
    let refused = |m: &Measurement, now: i64| refusal(&tracker, &sun(), m, now);

    for sigma_rad in [0.0, -1e-5, 1e-8, 1.1e-3, f64::INFINITY] {
        let m = Measurement { sigma_rad, ..good };
        assert_eq!(refused(&m, ns), MeasurementRefusal::Sigma(sigma_rad));
    }
    let unknown = refused(&Measurement { sigma_rad: f64::NAN, ..good }, ns);
    assert!(matches!(unknown, MeasurementRefusal::Sigma(sigma) if sigma.is_nan()));

    let age = SETTINGS.max_age.ns() + 1;
    assert_eq!(refused(&good, ns + age), MeasurementRefusal::Stale(Duration::from_ns(age)));
    let lead = SETTINGS.max_lead.ns() + 1;
    assert_eq!(refused(&good, ns - lead), MeasurementRefusal::Future(Duration::from_ns(lead)));
    assert_eq!(refused(&good, i64::MIN), MeasurementRefusal::Future(Duration::from_ns(i64::MAX)));
    for ns in [last.tai_ns(), last.tai_ns() - 1] {
        let m = measured(&truth, ns, NOISE_RAD, &mut noise);
        assert_eq!(refused(&m, ns), MeasurementRefusal::NotAfter(last));
    }

    // 300 arcsec about one axis, where a few are believed.
    let turn = Rotation::<Boresight, Boresight>::about_x(300.0 * ARCSEC);
    let outlier = Measurement { attitude: turn.then(good.attitude), ..good };
    match refused(&outlier, ns) {
        MeasurementRefusal::Outlier(residuals) => {
            assert!(residuals.chi2 > 100.0, "{residuals:?}");
            let off = residuals.innovation_rad.map(f64::abs);
            assert!(off[1] > 5.0 * residuals.sigma_rad[1] || off[0] > 5.0 * residuals.sigma_rad[0]);
        }
        other => panic!("{other:?}"),
    }

    for alpha_deg in [0.5, 179.5] {
        let plain = Plain { alpha_deg, beta_deg: 0.0, ..Plain::LITEBIRD };
        let flat = plain.strategy();
        let upright = attitude(&flat, &sun(), at(ns)).unwrap();
        let tracker = Tracker::new(&flat, &SETTINGS, at(0)).unwrap();
        let m = Measurement { attitude: upright, ..good };
        match refusal(&tracker, &sun(), &m, ns) {
            MeasurementRefusal::Unobservable(alpha) => {
                assert!((alpha.to_degrees() - alpha_deg).abs() < 1e-12);
            }
            other => panic!("{other:?}"),
        }
    }

    let bytes = table(10, 0, (ns - 1) as u64, &[vec![[1.0, 0.0, 0.0]]]);
    let short = SunModel::Table(EphemerisTable::parse(&bytes).unwrap().body(10).unwrap());
    let outside = MeasurementRefusal::Ephemeris(EphemerisError::OutOfSpan(at(ns)));
    assert_eq!(refusal(&tracker, &short, &good, ns), outside);

    // What was refused all along is accepted when nothing is wrong with it, now or a little early.
    for now in [ns, ns + SETTINGS.max_age.ns(), ns - SETTINGS.max_lead.ns()] {
        let mut tracker = tracker;
        let residuals = tracker.update(&sun(), &good, at(now)).unwrap();
        assert!(residuals.chi2 < SETTINGS.gate);
        assert_eq!((tracker.epoch(), tracker.accepted()), (at(ns), 8));
    }
}

#[test]
fn limits_hold_where_the_gate_would_let_pass() {
    let model = Plain::LITEBIRD.strategy();
    let first = |settings: &TrackerSettings, angles: [f64; 3], ns: i64| {
        let truth = Truth { angles, rates: [0.0; 2] }.of(&model);
        let tracker = Tracker::new(&model, settings, at(0)).unwrap();
        let m = measured(&truth, ns, NOISE_RAD, &mut Noise::new(42));
        refusal(&tracker, &sun(), &m, ns)
    };
    let limits_rad = [1e-3, 1e-4, 1e-3];
    let narrow = TrackerSettings { limits_rad, angle_sigmas_rad: [0.1; 3], ..SETTINGS };
    for (i, angle) in [ScanAngle::Precession, ScanAngle::Alpha, ScanAngle::Spin].iter().enumerate()
    {
        let mut angles = [0.0; 3];
        angles[i] = -0.01;
        match first(&narrow, angles, 0) {
            MeasurementRefusal::Correction(which, value) => {
                assert_eq!(which, *angle);
                assert!((value + 0.01).abs() < 1e-3, "{value}");
            }
            other => panic!("{other:?}"),
        }
    }
    // A spin known to 0.01 % may be anywhere after ten weeks.
    let loose = TrackerSettings { rate_sigmas: [0.0, 1e-4], ..SETTINGS };
    let why = first(&loose, [0.0; 3], 70 * DAY_NS);
    assert!(
        matches!(why, MeasurementRefusal::Ambiguous(ScanAngle::Spin, sigma) if sigma > 3.0),
        "{why:?}"
    );
    // At alpha + beta = 180 deg a larger alpha is no strategy.
    let full = Plain { alpha_deg: 90.0, beta_deg: 90.0, ..Plain::LITEBIRD }.strategy();
    let beyond = Plain { alpha_deg: 90.01, beta_deg: 89.99, ..Plain::LITEBIRD }.strategy();
    let seen = attitude(&beyond, &sun(), at(0)).unwrap();
    let mended = Rotation::<Boresight, Boresight>::about_y(0.01_f64.to_radians()).then(seen);
    let m = Measurement { at: at(0), attitude: mended, sigma_rad: NOISE_RAD };
    let tracker = Tracker::new(&full, &SETTINGS, at(0)).unwrap();
    let why = refusal(&tracker, &sun(), &m, 0);
    assert!(matches!(why, MeasurementRefusal::Strategy(_)), "{why:?}");
}

#[test]
fn illegal_settings_are_named() {
    let settings = TrackerSettings { gate: 0.0, ..SETTINGS };
    let model = Plain::LITEBIRD.strategy();
    assert_eq!(
        Tracker::new(&model, &settings, at(0)).unwrap_err(),
        TrackerSettingsError::Gate(0.0)
    );
}

#[test]
fn a_model_that_is_truly_wrong_is_left_by_a_restart() {
    let (_, mut tracker) = settled();
    let mut noise = Noise::new(43);
    // The spin was stopped and started elsewhere.
    let truth = Plain { phases_rad: (1.0, -2.0), ..Plain::LITEBIRD }.strategy();
    for i in 7..12 {
        let m = measured(&truth, i * 10 * MINUTE_NS, NOISE_RAD, &mut noise);
        assert!(matches!(tracker.update(&sun(), &m, m.at), Err(MeasurementRefusal::Outlier(_))));
    }
    assert_eq!((tracker.accepted(), tracker.refused_in_a_row()), (7, 5));
    tracker.restart(&truth, at(120 * MINUTE_NS));
    assert_eq!((tracker.accepted(), tracker.refused_in_a_row()), (0, 0));
    let m = measured(&truth, 120 * MINUTE_NS, NOISE_RAD, &mut noise);
    tracker.update(&sun(), &m, m.at).unwrap();
    assert_eq!((tracker.accepted(), tracker.refused_in_a_row()), (1, 0));
}

#[test]
// REQ-TRACK-3.
fn a_saved_state_goes_on_with_the_same_bits() {
    let (truth, mut tracker) = settled();
    let saved = tracker.state().to_le_bytes(SPACECRAFT);
    let model = Plain::LITEBIRD.strategy();
    let mut other = Tracker::new(&model, &SETTINGS, at(0)).unwrap();
    other.resume(&TrackerState::from_le_bytes(&saved, SPACECRAFT).unwrap()).unwrap();
    assert_eq!(other.state(), tracker.state());
    let m = measured(&truth, 70 * MINUTE_NS, NOISE_RAD, &mut Noise::new(44));
    let (ours, theirs) = (tracker.update(&sun(), &m, m.at), other.update(&sun(), &m, m.at));
    assert_eq!(ours.unwrap(), theirs.unwrap());
    assert_eq!(other.state(), tracker.state());

    let mut stranger = Tracker::new(&Plain::PICO.strategy(), &SETTINGS, at(0)).unwrap();
    assert_eq!(stranger.resume(&tracker.state()), Err(ResumeError::OtherStrategy));
}

#[test]
fn corrections_keep_the_start_and_hold_exactly_at_the_measurement() {
    let sigmas = [0.3, 0.05, 0.3];
    let settings = TrackerSettings { angle_sigmas_rad: sigmas, limits_rad: [1.0; 3], ..SETTINGS };
    let mut noise = Noise::new(45);
    let mut cases = 0;
    for alpha_deg in [1.1, 7.5, 45.0, 90.0, 135.0, 178.9] {
        for signs in [(1, 1), (-1, 1), (1, -1), (-1, -1)] {
            // Phases on both sides of a whole turn, before and after.
            for start in [-1e-9, 0.0, 1e-9, PI, 2.0] {
                let plain = Plain {
                    alpha_deg,
                    beta_deg: 0.5,
                    signs,
                    phases_rad: (start, -start),
                    ..Plain::LITEBIRD
                };
                let model = plain.strategy();
                let angles = [0.4 * noise.signed(), 1e-3 * noise.signed(), 0.4 * noise.signed()];
                let truth = Truth { angles, rates: [1e-6, -1e-6] }.of(&model);
                let mut tracker = Tracker::new(&model, &settings, at(0)).unwrap();
                let ns = 1 + (noise.unit() * 7e12) as i64;
                let seen = attitude(&truth, &sun(), at(ns)).unwrap();
                let m = Measurement { at: at(ns), attitude: seen, sigma_rad: 1e-6 };
                let residuals = tracker.update(&sun(), &m, at(ns)).unwrap();
                let before = errors(&truth, &model, ns);
                for (shown, really) in residuals.innovation_rad.iter().zip(before) {
                    assert!((shown - really).abs() < 1e-12, "{shown} {really}");
                }
                // A prior of 0.3 rad against 1e-6 / sin alpha leaves no more than this.
                let s = alpha_deg.to_radians().sin();
                for left in errors(&truth, tracker.strategy(), ns) {
                    assert!(left.abs() < 0.4 * (1e-6 / s / 0.05).powi(2) + 1e-13, "{left:e}");
                }
                let (new, old) = (tracker.strategy().parameters(), model.parameters());
                assert_eq!(
                    (new.start, new.beta_rad.to_bits()),
                    (old.start, old.beta_rad.to_bits())
                );
                cases += 1;
            }
        }
    }
    assert_eq!(cases, 120);
}

#[test]
fn equatorial_attitudes_come_in_by_the_obliquity() {
    let scan = Plain::LITEBIRD.strategy();
    let ecliptic = attitude(&scan, &sun(), at(MINUTE_NS)).unwrap();
    // Equatorial components by the textbook's rotation of vectors.
    let (sin, cos) = (84_381.448 * ARCSEC).sin_cos();
    let [x, y, z] = ecliptic.apply(Direction::Z).xyz();
    let expected = Direction::<Icrf>::new(x, cos * y - sin * z, sin * y + cos * z).unwrap();
    let icrf = ecliptic.then(Rotation::by_obliquity().inverse());
    assert!(icrf.apply(Direction::Z).separation_rad(expected) < 1e-15);
    let back = icrf.then(Rotation::by_obliquity());
    let seen = ScanAngles::measured(back, &scan, &sun(), at(MINUTE_NS)).unwrap();
    for off in seen.minus(&ScanAngles::modelled(&scan, at(MINUTE_NS))) {
        assert!(off.abs() < 1e-14);
    }
}
