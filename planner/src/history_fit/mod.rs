//! Which spin, precession and alpha did a history of attitudes have.
//!
//! Each attitude, the Sun's and beta's rotation undone, is a precession phase a, an alpha and a spin
//! phase b; their differences from the mission's exact phases, followed over whole turns, are lines
//! in time whose slopes are the errors of the rates.
//!
//! Method: with s = sin alpha and c = cos alpha, the small rotation between two attitudes has the
//! components (-s da, dalpha, db + c da) about the axes after `R_z(a) R_y(alpha)`. Isotropic noise
//! sigma is the same in each, so the three are fitted apart by least squares, and the covariance of
//! (da, dalpha, db) is sigma^2 \[\[1/s^2, 0, -c/s^2\], \[0, 1, 0\], \[-c/s^2, 0, 1/s^2\]\]. Rows are
//! rejected by the median, then again and again by chi-square with three degrees of freedom at a
//! chance of 1 % for the whole file; sigma comes from the residuals.
//!
//! Limits: within 1 deg of 0 or 180 deg of alpha only the sum, or the difference b - a, is fitted.
//! More than a quarter of outliers misleads the medians. `planner/tests/history_fit.rs` shows the coverage.
//!
//! # Example
//! Attitudes every minute of an hour, one part in 10^5 slower in spin than LiteBIRD's mission says:
//! ```
//! use mission::{Mission, Override};
//! use onboard_core::{attitude::attitude, sun::SunModel};
//! use planner::{history_fit::{Measured, fit}, time::Duration, world::World};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let world = |spin| -> Result<World, Box<dyn std::error::Error>> {
//!     let circular = Override::set("orbit.sun=circular")?;
//!     Ok(World::open(Mission::load("litebird", &[circular, Override::set(spin)?])?, None)?)
//! };
//! let (asked, flown) = (world("scan.spin_period_min=20")?, world("scan.spin_period_min=20.0002")?);
//! let sun = SunModel::Circular(asked.circular_sun.ok_or("no circular Sun")?);
//! let at = |minute: u32| asked.start.plus(Duration::from_seconds(60.0 * f64::from(minute)));
//! let measured = |at| Ok(Measured { at, attitude: attitude(&flown.scan, &sun, at)? });
//! let rows = (0..60).map(|minute| measured(at(minute))).collect::<Result<Vec<_>, _>>();
//! let rows = rows.map_err(|error: onboard_core::ephemeris::EphemerisError| format!("{error:?}"))?;
//! let found = fit(&asked.scan, &sun, &rows, 1e-3).map_err(|error| format!("{error:?}"))?;
//! let rate = asked.scan.parameters().spin.rate.radians_per_second();
//! assert!((found.spin.rate.offset / rate + 1e-5).abs() < 1e-8);
//! # Ok(())
//! # }
//! ```

mod angles;
mod follow;
mod solve;

pub use angles::rotation_vector;
pub use follow::Ambiguous;

use angles::{Angles, wrapped};
use follow::{follow, median};
use onboard_core::ephemeris::EphemerisError;
use onboard_core::frame::{AntiSun, Boresight, Ecliptic, Spin};
use onboard_core::rotation::Rotation;
use onboard_core::scan::ScanStrategy;
use onboard_core::sun::SunModel;
use onboard_core::time::{Duration, Instant};
use solve::{Line, Points, Solution};

/// Fewest rows that are fitted.
pub const FEWEST_ROWS: usize = 3;
/// Sine of 1 deg.
const DEGENERATE: f64 = 0.017_452_406_437_283_51;

/// A measured attitude.
#[derive(Debug, Clone, Copy)]
pub struct Measured {
    /// When.
    pub at: Instant,
    /// Boresight frame to ecliptic.
    pub attitude: Rotation<Boresight, Ecliptic>,
}

/// Which of the phases can be told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Observable {
    /// Both, and alpha.
    Both,
    /// Their sum alone: alpha is near 0.
    Sum,
    /// Spin less precession alone: alpha is near 180 deg.
    Difference,
}

/// Why no fit came out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FitError {
    /// Fewer than [`FEWEST_ROWS`] distinct times.
    Few(usize),
    /// The Sun is not known at an instant.
    Sun(EphemerisError),
    /// The rows are too far apart to tell rates of the precession apart.
    Precession(Ambiguous),
    /// The rows are too far apart to tell rates of the spin, or of the sum, apart.
    Spin(Ambiguous),
}

/// A value with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Difference from the mission's value.
    pub offset: f64,
    /// Standard error.
    pub sigma: f64,
}

/// A phase's fit: difference from the mission's, rad and rad/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turning {
    /// Phase at the epoch.
    pub at_epoch: Estimate,
    /// Phase at the mission's start.
    pub at_start: Estimate,
    /// Rate.
    pub rate: Estimate,
}

/// What the rows say.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Which phases.
    pub observable: Observable,
    /// Mean time of the rows used.
    pub epoch: Instant,
    /// Precession, where it is observable.
    pub precession: Option<Turning>,
    /// Spin; the sum or the difference where only that is observable.
    pub spin: Turning,
    /// Alpha, where it is observable.
    pub alpha: Option<Estimate>,
    /// Covariance of the two rates, rad^2/s^2.
    pub rate_covariance: f64,
    /// Standard deviation of one axis of one row, rad.
    pub sigma_rad: f64,
    /// For each row, whether it was used.
    pub used: Vec<bool>,
}

/// A row's angles less the mission's.
struct Offset {
    time_s: f64,
    precession: f64,
    alpha: f64,
    spin: f64,
    sum: f64,
    difference: f64,
}

/// Fits a history in time order; `search` is the largest relative error of a rate looked for.
///
/// # Errors
/// [`FitError`].
pub fn fit(
    scan: &ScanStrategy,
    sun: &SunModel<'_>,
    rows: &[Measured],
    search: f64,
) -> Result<Fit, FitError> {
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
        return Err(FitError::Few(0));
    };
    let distinct = 1 + rows.windows(2).filter(|pair| pair[0].at < pair[1].at).count();
    if distinct < FEWEST_ROWS {
        return Err(FitError::Few(distinct));
    }
    let middle = first.at.plus(Duration::from_ns(last.at.since(first.at).ns() / 2));
    let parameters = scan.parameters();
    let (sin, cos) = parameters.alpha_rad.sin_cos();
    let observable = match (sin >= DEGENERATE, cos > 0.0) {
        (true, _) => Observable::Both,
        (false, true) => Observable::Sum,
        (false, false) => Observable::Difference,
    };
    let offsets = rows
        .iter()
        .map(|row| offset(scan, sun, row, middle))
        .collect::<Result<Vec<Offset>, _>>()
        .map_err(FitError::Sun)?;
    let times: Vec<f64> = offsets.iter().map(|it| it.time_s).collect();
    let rates = [parameters.precession, parameters.spin]
        .map(|rotor| (rotor.rate.radians_per_second() * search).abs());
    let context = Context { times: &times, scan, middle, observable };
    if observable == Observable::Both {
        both(&context, &offsets, rates)
    } else {
        one(&context, &offsets, rates[0] + rates[1])
    }
}

struct Context<'c> {
    times: &'c [f64],
    scan: &'c ScanStrategy,
    middle: Instant,
    observable: Observable,
}

fn offset(
    scan: &ScanStrategy,
    sun: &SunModel<'_>,
    row: &Measured,
    middle: Instant,
) -> Result<Offset, EphemerisError> {
    let parameters = scan.parameters();
    let anti_sun = sun.state(parameters.start, row.at)?;
    let frame = Rotation::<AntiSun, Ecliptic>::to_direction_with_x_north(anti_sun.direction);
    let turned: Rotation<Spin, AntiSun> =
        scan.boresight_in_spin().inverse().then(row.attitude).then(frame.inverse());
    let seen = Angles::of(turned);
    let (precession, spin) = scan.phases(row.at);
    let (precession, spin) = (precession.radians(), spin.radians());
    Ok(Offset {
        time_s: row.at.since(middle).seconds(),
        precession: seen.precession_rad() - precession,
        alpha: seen.alpha_rad - parameters.alpha_rad,
        spin: seen.spin_rad() - spin,
        sum: seen.sum_rad - precession - spin,
        difference: seen.difference_rad - (spin - precession),
    })
}

/// Precession, alpha and spin.
fn both(context: &Context<'_>, offsets: &[Offset], rates: [f64; 2]) -> Result<Fit, FitError> {
    let column = |of: fn(&Offset) -> f64| offsets.iter().map(of).collect::<Vec<f64>>();
    let precession = follow(context.times, &column(|it| it.precession), rates[0])
        .map_err(FitError::Precession)?;
    let spin = follow(context.times, &column(|it| it.spin), rates[1]).map_err(FitError::Spin)?;
    let alpha = median(&mut column(|it| it.alpha));
    let (s, c) = (context.scan.parameters().alpha_rad + alpha).sin_cos();
    let values = offsets
        .iter()
        .map(|it| {
            let da = precession.unwrap(it.time_s, it.precession);
            let db = spin.unwrap(it.time_s, it.spin);
            [s * da, it.alpha, db + c * da]
        })
        .collect();
    let points = Points { times: context.times, values, dimensions: 3 };
    let first = [
        Line::new(s * precession.at_zero_rad, s * precession.rate_rad_s),
        Line::new(alpha, 0.0),
        Line::new(
            spin.at_zero_rad + c * precession.at_zero_rad,
            spin.rate_rad_s + c * precession.rate_rad_s,
        ),
    ];
    let found = points.solve(first);
    let known = Known::new(context, &found);
    let [a, alpha, b] = found.lines;
    // Back from the components to the phases; 1/s is the noise of either.
    let precession = known.turning(a.at_mean / s, a.slope / s, 1.0 / s);
    let spin = known.turning(b.at_mean - c / s * a.at_mean, b.slope - c / s * a.slope, 1.0 / s);
    Ok(Fit {
        observable: context.observable,
        epoch: known.epoch,
        precession: Some(precession),
        spin,
        alpha: Some(Estimate { offset: alpha.at_mean, sigma: known.value }),
        rate_covariance: -c * (known.slope / s).powi(2),
        sigma_rad: found.sigma,
        used: found.used,
    })
}

/// The sum or the difference alone.
fn one(context: &Context<'_>, offsets: &[Offset], rate: f64) -> Result<Fit, FitError> {
    let sum = context.observable == Observable::Sum;
    let phases: Vec<f64> =
        offsets.iter().map(|it| if sum { it.sum } else { it.difference }).collect();
    let followed = follow(context.times, &phases, rate).map_err(FitError::Spin)?;
    let values = context
        .times
        .iter()
        .zip(&phases)
        .map(|(time, phase)| [0.0, 0.0, followed.unwrap(*time, *phase)])
        .collect();
    let points = Points { times: context.times, values, dimensions: 1 };
    let still = Line::new(0.0, 0.0);
    let found = points.solve([still, still, Line::new(followed.at_zero_rad, followed.rate_rad_s)]);
    let known = Known::new(context, &found);
    let spin = known.turning(found.lines[2].at_mean, found.lines[2].slope, 1.0);
    Ok(Fit {
        observable: context.observable,
        epoch: known.epoch,
        precession: None,
        spin,
        alpha: None,
        rate_covariance: 0.0,
        sigma_rad: found.sigma,
        used: found.used,
    })
}

/// How well a line's values are known.
struct Known {
    epoch: Instant,
    /// Mission's start less epoch, s.
    to_start: f64,
    /// Standard error at the epoch.
    value: f64,
    /// Standard error of the slope.
    slope: f64,
}

impl Known {
    fn new(context: &Context<'_>, found: &Solution) -> Self {
        let epoch = context.middle.plus(Duration::from_seconds(found.lines[2].mean_time));
        Self {
            epoch,
            to_start: context.scan.parameters().start.since(epoch).seconds(),
            value: found.sigma / found.rows.max(1.0).sqrt(),
            slope: found.sigma / found.spread.sqrt(),
        }
    }

    /// A phase and its rate, both with this many times the line's noise.
    fn turning(&self, phase: f64, rate: f64, noise: f64) -> Turning {
        let estimate = |offset, sigma| Estimate { offset, sigma: sigma * noise };
        Turning {
            at_epoch: estimate(wrapped(phase), self.value),
            at_start: estimate(
                wrapped(phase + rate * self.to_start),
                self.value.hypot(self.slope * self.to_start),
            ),
            rate: estimate(rate, self.slope),
        }
    }
}

impl Fit {
    /// The fitted attitude at an instant.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] beyond the Sun's table.
    pub fn attitude(
        &self,
        scan: &ScanStrategy,
        sun: &SunModel<'_>,
        at: Instant,
    ) -> Result<Rotation<Boresight, Ecliptic>, EphemerisError> {
        let parameters = scan.parameters();
        let since = at.since(self.epoch).seconds();
        let offset = |it: &Turning| it.at_epoch.offset + it.rate.offset * since;
        let precession_off = self.precession.as_ref().map_or(0.0, offset);
        let alpha_off = self.alpha.map_or(0.0, |it| it.offset);
        let (precession, spin) = scan.phases(at);
        let anti_sun = sun.state(parameters.start, at)?;
        Ok(scan
            .boresight_in_spin()
            .then(Rotation::<Spin, Spin>::about_z(offset(&self.spin)))
            .then(Rotation::<Spin, Spin>::about_z_by(spin))
            .then(Rotation::<Spin, Spin>::about_y(parameters.alpha_rad + alpha_off))
            .then(Rotation::<Spin, Spin>::about_z(precession_off))
            .then(Rotation::<Spin, AntiSun>::about_z_by(precession))
            .then(Rotation::to_direction_with_x_north(anti_sun.direction)))
    }
}
