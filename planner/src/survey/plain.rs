//! The plain survey: one sample after the other, by the flight core's attitude and library functions.
//!
//! It decides what the fast kernel leaves open (a sample too near the edge of a pixel), is what the
//! kernel is tested against, and what its speed is compared with.

use super::clock::{phase_at, plate_phase_at};
use super::frame::{Galactic, MapFrame};
use super::moment::Moment;
use super::runs::Run;
use super::sampled::{Pixels, Sampled};
use super::sums::{Sums, steps};
use crate::healpix::Nside;
use onboard_core::direction::Direction;
use onboard_core::ephemeris::EphemerisError;
use onboard_core::frame::{AntiSun, Boresight, Detector, Ecliptic, Spin};
use onboard_core::rotation::Rotation;
use std::f64::consts::{FRAC_2_PI, TAU};

/// One sample of one detector.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// NESTED pixel.
    pub(super) pixel: u32,
    /// Crossing angle in the map's frame in radians, in (-pi, pi].
    pub(super) crossing_angle_rad: f64,
    /// The plate's angle in radians, in [0, 2 pi); 0 without a plate.
    pub(super) plate_angle_rad: f64,
}

/// The attitude of a detector at sample `j`, in the map's frame.
fn attitude(
    sampled: &Sampled<'_>,
    frame: MapFrame,
    (detector, j): (usize, u64),
) -> Result<Rotation<Detector, Galactic>, EphemerisError> {
    let scan = &sampled.clock;
    let sun = sampled.sun.direction(scan, j)?;
    let spin: Rotation<Spin, AntiSun> = Rotation::<Spin, Spin>::about_z_by(phase_at(scan.spin, j))
        .then(Rotation::<Spin, Spin>::about_y(scan.alpha_rad))
        .then(Rotation::about_z_by(phase_at(scan.precession, j)));
    Ok(sampled.detectors[detector]
        .rotation
        .then(Rotation::<Boresight, Spin>::about_y(scan.beta_rad))
        .then(spin)
        .then(Rotation::<AntiSun, Ecliptic>::to_direction_with_x_north(sun))
        .then(frame.from_ecliptic()))
}

/// What detector number `detector` sees at sample `j` on a map.
///
/// # Errors
/// [`EphemerisError::OutOfSpan`] beyond the Sun's table.
pub(super) fn sample(
    sampled: &Sampled<'_>,
    on: Pixels,
    (detector, j): (usize, u64),
) -> Result<Sample, EphemerisError> {
    let attitude = attitude(sampled, on.frame, (detector, j))?;
    let n = attitude.apply(Direction::Z).xyz();
    let x = Direction::new(1.0, 0.0, 0.0).map_or([1.0, 0.0, 0.0], |it| attitude.apply(it).xyz());
    let plate = sampled.detectors[detector].plate.map(|it| plate_phase_at(it, j).turns() * TAU);
    Ok(Sample {
        pixel: pixel_of(on.nside, n),
        // East and north scaled by the sine of the colatitude: (-n_y, n_x, 0), and x . north = x_z.
        crossing_angle_rad: x[2].atan2(x[1] * n[0] - x[0] * n[1]),
        plate_angle_rad: plate.unwrap_or(0.0),
    })
}

/// The NESTED pixel that detector number `detector` sees at sample `j`; pixel 0 beyond the Sun's table, which the run
/// has reported by then.
#[cold]
#[inline(never)]
pub(super) fn pixel(sampled: &Sampled<'_>, on: Pixels, (detector, j): (usize, u64)) -> u32 {
    attitude(sampled, on.frame, (detector, j))
        .map_or(0, |it| pixel_of(on.nside, it.apply(Direction::Z).xyz()))
}

/// The NESTED pixel of a unit vector [Gorski2005, section 4].
fn pixel_of(nside: Nside, [x, y, z]: [f64; 3]) -> u32 {
    let n = f64::from(nside.get());
    let last = i64::from(nside.get()) - 1;
    let quarters = (y.atan2(x) * FRAC_2_PI).rem_euclid(4.0) % 4.0;
    let (face, column, row) = if z.abs() <= 2.0 / 3.0 {
        let (middle, tilt) = (n * (0.5 + quarters), 0.75 * n * z);
        let (down, up) = (floor(middle - tilt), floor(middle + tilt));
        let (from, to) = (down >> nside.depth(), up >> nside.depth());
        let face = match from.cmp(&to) {
            std::cmp::Ordering::Equal => (from & 3) + 4,
            std::cmp::Ordering::Less => from & 3,
            std::cmp::Ordering::Greater => (to & 3) + 8,
        };
        (face, up & last, last - (down & last))
    } else {
        let quadrant = floor(quarters).min(3);
        #[expect(clippy::cast_precision_loss, reason = "a number below 4")]
        let west = quarters - quadrant as f64;
        let scale = n * x.hypot(y) * (3.0 / (1.0 + z.abs())).sqrt();
        let east = floor(west * scale).min(last);
        let back = floor((1.0 - west) * scale).min(last);
        if z > 0.0 { (quadrant, last - back, last - east) } else { (quadrant + 8, east, back) }
    };
    let mut pixel = face << (2 * nside.depth());
    for bit in 0..nside.depth() {
        pixel |= ((column >> bit) & 1) << (2 * bit);
        pixel |= ((row >> bit) & 1) << (2 * bit + 1);
    }
    u32::try_from(pixel).unwrap_or(0)
}

#[expect(clippy::cast_possible_truncation, reason = "pixel coordinates are below 2^16")]
fn floor(x: f64) -> i64 {
    x.floor() as i64
}

/// Collects the samples of a run.
pub(super) fn collect(
    sampled: &Sampled<'_>,
    (on, moments): (Pixels, &[Moment]),
    run: Run,
    sums: &mut Sums,
) -> Result<(), EphemerisError> {
    let count = moments.len();
    let (mut re, mut im) = (vec![0; count], vec![0; count]);
    for j in run.first..run.end {
        for detector in 0..sampled.detectors.len() {
            let it = sample(sampled, on, (detector, j))?;
            for (index, moment) in moments.iter().enumerate() {
                let angle = -(moment.n() * it.crossing_angle_rad + moment.m() * it.plate_angle_rad);
                let (sin, cos) = angle.sin_cos();
                re[index] = steps(cos);
                im[index] = steps(sin);
            }
            sums.add(it.pixel, 1, &re, &im);
        }
    }
    Ok(())
}
