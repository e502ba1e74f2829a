//! The flight core as the oracle of somebody else's attitude code.
//!
//! `cargo run -p ground-tools --example oracle`
//!
//! What follows uses only `onboard-core`, as a host test of another crate would: `theirs` stands for
//! the code under test, here plain rotation matrices from floating-point phases.

use onboard_core::attitude::{attitude, sweep};
use onboard_core::detector::detector_at;
use onboard_core::direction::Direction;
use onboard_core::frame::{Boresight, Ecliptic};
use onboard_core::phase::{Phase, Rotor, TurnRate};
use onboard_core::rotation::Rotation;
use onboard_core::scan::{ScanParameters, ScanStrategy};
use onboard_core::sun::SunModel;
use onboard_core::time::{Duration, Instant};
use std::error::Error;

const SPIN_S: u64 = 1200;
const PRECESSION_S: u64 = 11_541;
const YEAR_S: u64 = 31_557_600;

/// A turn in a whole number of seconds: 2^128 over the ns, rounded down.
fn turn_in(seconds: u64) -> Rotor {
    let rate = TurnRate::from_bits(u128::MAX / (u128::from(seconds) * 1_000_000_000));
    Rotor { rate, start: Phase::ZERO }
}

type Matrix = [[f64; 3]; 3];

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    let cell = |i: usize, j: usize| (0..3).map(|k| a[i][k] * b[k][j]).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| cell(i, j)))
}

fn about_y(angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
}

fn about_z(angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
}

/// The code under test: boresight frame to ecliptic after `elapsed_ns`.
fn theirs(alpha: f64, beta: f64, elapsed_ns: u64) -> Matrix {
    let phase = |period_s: u64| {
        let period_ns = period_s * 1_000_000_000;
        let rest = Duration::from_ns(i64::try_from(elapsed_ns % period_ns).unwrap_or(0));
        let whole = Duration::from_ns(i64::try_from(period_ns).unwrap_or(1));
        std::f64::consts::TAU * rest.seconds() / whole.seconds()
    };
    let longitude = phase(YEAR_S);
    let (s, c) = longitude.sin_cos();
    // Columns: x north, y = z cross x, z along the anti-Sun direction.
    let frame = [[0.0, s, c], [0.0, -c, s], [1.0, 0.0, 0.0]];
    let scan =
        times(&times(&about_z(phase(PRECESSION_S)), &about_y(alpha)), &about_z(phase(SPIN_S)));
    times(&times(&frame, &scan), &about_y(beta))
}

/// Angle between the same axis of two attitudes, the largest of three: no sign of a quaternion to
/// mind.
fn apart(ours: Rotation<Boresight, Ecliptic>, theirs: &Matrix) -> Result<f64, Box<dyn Error>> {
    let mut largest = 0.0_f64;
    for (axis, unit) in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].iter().enumerate() {
        let [x, y, z] = *unit;
        let ours = ours.apply(Direction::new(x, y, z).ok_or("no direction")?);
        let [x, y, z] = theirs.map(|row| row[axis]);
        let seen = Direction::new(x, y, z).ok_or("the matrix under test is no rotation")?;
        largest = largest.max(ours.separation_rad(seen));
    }
    Ok(largest)
}

#[expect(clippy::print_stdout, reason = "an example shows its result")]
fn main() -> Result<(), Box<dyn Error>> {
    let start = Instant::from_tai_ns(1_017_662_367_814_344_741);
    let (alpha, beta) = (45.0_f64.to_radians(), 50.0_f64.to_radians());
    let scan = ScanStrategy::new(ScanParameters {
        start,
        alpha_rad: alpha,
        beta_rad: beta,
        precession: turn_in(PRECESSION_S),
        spin: turn_in(SPIN_S),
    })
    .map_err(|error| format!("{error:?}"))?;
    let sun = SunModel::Circular(turn_in(YEAR_S));

    let mut worst = 0.0_f64;
    let mut elapsed_ns = 0_u64;
    for _ in 0..10_000 {
        elapsed_ns += 9_467_279_947_013;
        let at = start.plus(Duration::from_ns(i64::try_from(elapsed_ns)?));
        let ours = attitude(&scan, &sun, at).map_err(|error| format!("{error:?}"))?;
        worst = worst.max(apart(ours, &theirs(alpha, beta, elapsed_ns))?);
    }
    println!("10000 attitudes over three years agree to {worst:.1e} rad");
    if worst > 1e-12 {
        return Err(format!("the code under test is off by {worst:e} rad").into());
    }

    // A detector 3 deg off the line of sight: direction, crossing angle and speed at one instant.
    let detector = detector_at(3.0_f64.to_radians(), 0.5, 0.0);
    let seen = sweep(&scan, &sun, detector, start).map_err(|error| format!("{error:?}"))?;
    println!(
        "a detector starts at psi {:.6} deg and {:.6} deg/s",
        seen.crossing_angle_rad.to_degrees(),
        seen.speed_rad_s.to_degrees()
    );
    Ok(())
}
