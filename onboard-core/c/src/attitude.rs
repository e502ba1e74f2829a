//! The scanning strategy and what it says: attitude, sweep of a detector, half-wave plate.

use crate::error::gyr_error_t;
use crate::memory::{State, answer, content, fill, input, output};
use crate::tables::{gyr_quaternion_t, gyr_rotor_t, gyr_tables_t};
use onboard_core::attitude::{attitude, sweep};
use onboard_core::frame::{Boresight, Detector};
use onboard_core::hwp::hwp_phase;
use onboard_core::phase::{Phase, Rotor};
use onboard_core::scan::{ScanParameters, ScanStrategy};
use onboard_core::time::Instant;

/// 64-bit words of a gyr_strategy_t.
pub const GYR_STRATEGY_WORDS: usize = 20;

/// A legal scanning strategy; holds no pointer.
#[repr(C)]
pub struct gyr_strategy_t {
    opaque: [u64; GYR_STRATEGY_WORDS],
}

impl State for gyr_strategy_t {
    type Content = ScanStrategy;
    const KIND: [u8; 8] = *b"gyrstrat";
}

const _: () = assert!(<gyr_strategy_t as State>::FITS);

/// What defines a scanning strategy.
#[repr(C)]
pub struct gyr_scan_t {
    /// Instant at which both phases have their start values, ns of TAI.
    pub start_tai_ns: i64,
    /// Angle from the anti-Sun axis to the spin axis.
    pub alpha_rad: f64,
    /// Angle from the spin axis to the boresight.
    pub beta_rad: f64,
    /// Precession.
    pub precession: gyr_rotor_t,
    /// Spin.
    pub spin: gyr_rotor_t,
}

/// Where the scan stands.
#[repr(C)]
pub struct gyr_phases_t {
    /// Precession phase in 2^-64 turn.
    pub precession: u64,
    /// Spin phase in 2^-64 turn.
    pub spin: u64,
    /// Completed precession turns since the start.
    pub precession_turns: u64,
    /// Completed spin turns since the start.
    pub spin_turns: u64,
}

/// What a detector does on the sky.
#[repr(C)]
pub struct gyr_sweep_t {
    /// From the detector's frame to the ecliptic.
    pub attitude: gyr_quaternion_t,
    /// Line of sight in the ecliptic frame.
    pub direction_xyz: [f64; 3],
    /// Crossing angle psi, in (-pi, pi].
    pub crossing_angle_rad: f64,
    /// Speed of the line of sight on the sky.
    pub speed_rad_s: f64,
    /// Scan-beam angle zeta, in (-pi, pi].
    pub scan_beam_angle_rad: f64,
}

/// Makes a strategy of its parameters.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_strategy_init(
    strategy: *mut gyr_strategy_t,
    parameters: *const gyr_scan_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let given = unsafe { input(parameters) }?;
        let made = ScanStrategy::new(ScanParameters {
            start: Instant::from_tai_ns(given.start_tai_ns),
            alpha_rad: given.alpha_rad,
            beta_rad: given.beta_rad,
            precession: (&given.precession).into(),
            spin: (&given.spin).into(),
        })?;
        // SAFETY: as above.
        unsafe { fill(strategy, made) }
    })
}

/// Makes the mission's strategy, as the tables have it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_strategy_of_tables(
    strategy: *mut gyr_strategy_t,
    tables: *const gyr_tables_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let mission = unsafe { content(tables) }?.tables.mission();
        // SAFETY: as above.
        unsafe { fill(strategy, mission.strategy()) }
    })
}

/// The strategy's parameters.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_strategy_parameters(
    strategy: *const gyr_strategy_t,
    parameters: *mut gyr_scan_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let own = *unsafe { content(strategy) }?.parameters();
        let answer = gyr_scan_t {
            start_tai_ns: own.start.tai_ns(),
            alpha_rad: own.alpha_rad,
            beta_rad: own.beta_rad,
            precession: own.precession.into(),
            spin: own.spin.into(),
        };
        // SAFETY: as above.
        unsafe { output(parameters, answer) }
    })
}

/// Phases and completed turns at an instant.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_strategy_phases(
    strategy: *const gyr_strategy_t,
    at_tai_ns: i64,
    phases: *mut gyr_phases_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let strategy = unsafe { content(strategy) }?;
        let at = Instant::from_tai_ns(at_tai_ns);
        let ((precession, spin), turns) = (strategy.phases(at), strategy.turns(at));
        let answer = gyr_phases_t {
            precession: precession.bits(),
            spin: spin.bits(),
            precession_turns: turns.0,
            spin_turns: turns.1,
        };
        // SAFETY: as above.
        unsafe { output(phases, answer) }
    })
}

/// The rotation from the mission boresight frame to the ecliptic at an instant.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_attitude(
    strategy: *const gyr_strategy_t,
    tables: *const gyr_tables_t,
    at_tai_ns: i64,
    boresight: *mut gyr_quaternion_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let strategy = unsafe { content(strategy) }?;
        // SAFETY: as above.
        let sun = unsafe { content(tables) }?.sun()?;
        let answer = attitude(strategy, &sun, Instant::from_tai_ns(at_tai_ns))?;
        // SAFETY: as above.
        unsafe { output(boresight, answer.to_xyzw().into()) }
    })
}

/// What a detector does on the sky at an instant; `detector` is the rotation from its frame to the
/// mission boresight frame (a telescope's serves as well).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_sweep(
    strategy: *const gyr_strategy_t,
    tables: *const gyr_tables_t,
    detector: *const gyr_quaternion_t,
    at_tai_ns: i64,
    result: *mut gyr_sweep_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let strategy = unsafe { content(strategy) }?;
        // SAFETY: as above.
        let sun = unsafe { content(tables) }?.sun()?;
        // SAFETY: as above.
        let detector = unsafe { input(detector) }?.rotation::<Detector, Boresight>()?;
        let seen = sweep(strategy, &sun, detector, Instant::from_tai_ns(at_tai_ns))?;
        let answer = gyr_sweep_t {
            attitude: seen.attitude.to_xyzw().into(),
            direction_xyz: seen.direction.xyz(),
            crossing_angle_rad: seen.crossing_angle_rad,
            speed_rad_s: seen.speed_rad_s,
            scan_beam_angle_rad: seen.scan_beam_angle_rad,
        };
        // SAFETY: as above.
        unsafe { output(result, answer) }
    })
}

/// A half-wave plate's angle at an instant, in 2^-64 turn; `plate` as a telescope has it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_hwp_phase(
    strategy: *const gyr_strategy_t,
    plate: *const gyr_rotor_t,
    at_tai_ns: i64,
    phase: *mut u64,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let strategy = unsafe { content(strategy) }?;
        // SAFETY: as above.
        let plate = Rotor::from(unsafe { input(plate) }?);
        let answer = hwp_phase(strategy, plate, Instant::from_tai_ns(at_tai_ns));
        // SAFETY: as above.
        unsafe { output(phase, answer.bits()) }
    })
}

/// A phase (2^-64 turn) in radians, in [-pi, pi).
#[unsafe(no_mangle)]
pub extern "C" fn gyr_phase_rad(phase: u64) -> f64 {
    Phase::from_bits(phase).radians()
}
