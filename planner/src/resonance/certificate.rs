//! Does any period within tolerance resonate.
//!
//! A [`Tolerance`] makes of the two periods a box. [`Predictor::certify`] bounds `sigma_hits / mean`
//! over all of it, whatever the start phases, and names the resonance that weighs most.
//!
//! Method: all that varies in the box is `m* = -(k N_a + j N_b) / N_o` of each pair, and that is
//! `-(T_o / T_a)(k + j eta)` with `eta = T_a / T_b`: the box is cut into slices of eta. In a slice
//!
//! 1. every pair whose band `|m*| <= l_max` meets it is enumerated, for each j the whole numbers k
//!    of one interval: the fractions `k / -j` of the Stern-Brocot tree in the band, and their
//!    multiples;
//! 2. the power of a pair is a smooth function of its `m*`; its supremum is that at points
//!    h apart, a twelfth for one orbit, plus `h^2 / 8` times a bound of its curvature;
//! 3. pairs that can meet at one m somewhere in the slice add amplitudes, others add powers.
//!
//! The slice with the largest bound is halved until the box passes, some point exceeds the allowance
//! or [`MOST_SLICES`] are used. Where the orbit is no circle and a point already exceeds the
//! allowance, products of pairs are bounded coarsely: they cannot change the verdict.
//!
//! An [`Orbit`] whose longitude advances between `1 - r` and `1 + r` times its mean rate spreads a pair
//! over `m* / (1 +- r)`, by the coefficients that it computes. A latitude b tilts the pattern: where
//! `l_max b` is small amplitudes change by that share at most; else the supremum is the largest P(m)
//! of a band that reaches `l_max b` further.
//!
//! Limits: rigorous for the model of [`super::power`], whose terms end 3 m from `m*` (test
//! `no_point_in_a_passing_box_exceeds_its_bound`).

use super::bound::{Band, Bounded, Slice};
use super::box_coefficients::BoxCoefficients;
use super::motion::{Motion, MotionError, Tolerance};
use super::orbit::Orbit;
use super::predictor::{Predictor, gcd};
use std::f64::consts::TAU;
use thiserror::Error;

/// Slices of eta that are bounded at most.
pub const MOST_SLICES: usize = 48;
/// Points of the scan for the floor.
const FLOOR_POINTS: u32 = 101;
/// The floor is sought within this share of the precession period.
const FLOOR_RANGE: f64 = 0.0025;

/// Most pairs of frequencies that come close: time and memory grow with them. LiteBIRD has some 4,000.
pub(super) const MOST_MEETINGS: usize = 300_000;

/// Most of them where periods are recommended, for which some hundred boxes are bounded.
pub(super) const MOST_RECOMMENDED: usize = 40_000;

/// Why there is no certificate.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum CertificateError {
    /// Periods, phases or duration.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// A tolerance that is negative or as wide as its period.
    #[error("the tolerance of {name} is {tolerance_s} s, but must be from 0 to below {period_s} s")]
    Tolerance {
        /// Which period.
        name: &'static str,
        /// Its tolerance in seconds.
        tolerance_s: f64,
        /// Its value in seconds.
        period_s: f64,
    },
    /// The spin is not faster than the precession.
    #[error(
        "the spin period {spin_period_s} s must be shorter than the precession period {precession_period_s} s"
    )]
    Order {
        /// Precession period in seconds.
        precession_period_s: f64,
        /// Spin period in seconds.
        spin_period_s: f64,
    },
    /// Too many frequencies of precession, spin and orbit beat with each other.
    #[error(
        "periods of {precession_period_s} s and {spin_period_s} s beat at {meetings} pairs of frequencies or more; up to {MOST_MEETINGS} are judged"
    )]
    Meetings {
        /// Precession period in seconds.
        precession_period_s: f64,
        /// Spin period in seconds.
        spin_period_s: f64,
        /// Pairs of frequencies that come close.
        meetings: usize,
    },
    /// A rate that varies too much, or a latitude beyond a radian.
    #[error(
        "an orbit whose rate varies by {rate} of itself and whose latitude reaches {latitude_rad} rad cannot be bounded; below 0.5 and 1 are needed"
    )]
    Orbit {
        /// Relative departure of the rate.
        rate: f64,
        /// Latitude in radians.
        latitude_rad: f64,
    },
}

/// The outcome of a check.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// Whether the bound keeps within the allowance.
    pub passes: bool,
    /// Whether some point in the box exceeds the allowance, so that no finer bound could pass it.
    pub refuted: bool,
    /// `sigma_hits / mean` at the nominal periods and phases.
    pub sigma_predicted: f64,
    /// The same without resonances.
    pub sigma_smooth: f64,
    /// No point of the box has a larger `sigma_hits / mean`.
    pub sigma_bound: f64,
    /// The floor that it is compared with.
    pub sigma_floor: f64,
    /// `sigma_bound / sigma_floor - 1`.
    pub excess: f64,
    /// Slices that were bounded.
    pub slices: usize,
    /// The resonance with the largest share of the bound.
    pub worst: Option<Worst>,
}

/// A resonance, as reports name it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worst {
    /// Of the reduced fraction `p / q` near `T_alpha / T_beta`: the multiple of the precession's rate.
    pub p: i32,
    /// The multiple of the spin's rate.
    pub q: i32,
    /// Which multiple of the fraction.
    pub multiple: i32,
    /// Azimuthal number at which its power is largest.
    pub m: i32,
    /// Precession period at which it stands there, at the nominal spin period, in seconds.
    pub precession_period_s: f64,
    /// Sign of that period less the commensurable one.
    pub sideband: i32,
    /// Largest power in the box, both conjugates.
    pub power_bound: f64,
    /// Moire wavelength in ecliptic longitude at the nominal periods, in radians.
    pub wavelength_rad: f64,
    /// Time in which the pattern beats at the nominal periods, in seconds.
    pub beat_s: f64,
    /// Share of its power at its largest that lies north of the ecliptic.
    pub northern_share: f64,
    /// Distance of its peak from the nominal precession period, in tolerances of both periods
    /// together; infinite for a point.
    pub distance_in_tolerances: f64,
}

impl Predictor {
    /// The smallest `sigma_hits / mean` predicted within 0.25% of the precession period.
    pub fn floor(&mut self, motion: &Motion) -> f64 {
        let half = f64::from(FLOOR_POINTS / 2);
        (0..FLOOR_POINTS)
            .map(|i| 1.0 + FLOOR_RANGE * (f64::from(i) / half - 1.0))
            .map(|factor| motion.precession_period_s * factor)
            .map(|precession_period_s| {
                self.predict(&Motion { precession_period_s, ..*motion }).sigma()
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Bounds `sigma_hits / mean` over the tolerances and compares it with `floor` times
    /// `1 + allowed`.
    ///
    /// # Errors
    /// [`CertificateError`] naming what is not legal.
    pub fn certify(
        &mut self,
        motion: &Motion,
        tolerance: Tolerance,
        orbit: &Orbit,
        [floor, allowed]: [f64; 2],
    ) -> Result<Certificate, CertificateError> {
        let motion = motion.checked()?;
        let whole = checked_box(&motion, tolerance, orbit)?;
        let nominal = self.predict(&motion);
        let l_max = f64::from(self.l_max());
        let without = nominal.smooth_variance + nominal.beyond_variance;
        let mut common = BoxCoefficients::new(motion, orbit, without, l_max);
        let limit = (floor * (1.0 + allowed)).powi(2);
        let beside = self.smooth_beside(&mut common);
        common.smooth += beside;
        let parts: Vec<(Slice, f64)> =
            whole.parts().map(|it| (it, self.middle(&common, tolerance, it))).collect();
        let mut refuted = nominal.variance > limit || parts.iter().any(|it| it.1 > limit);
        if refuted {
            common.refuted();
        }
        let mut slices: Vec<Bounded> =
            parts.into_iter().map(|part| self.bound(&mut common, part)).collect();
        while slices.len() < MOST_SLICES && !refuted {
            slices.sort_by(|a, b| a.variance.total_cmp(&b.variance));
            let Some(top) = slices.last().copied() else { break };
            let [low, high] = top.slice.eta;
            let middle = f64::midpoint(low, high);
            if top.variance <= limit || !(low < middle && middle < high) {
                break;
            }
            slices.pop();
            for eta in [[low, middle], [middle, high]] {
                let half = Slice { eta, ..top.slice };
                let variance = self.middle(&common, tolerance, half);
                refuted |= variance > limit;
                slices.push(self.bound(&mut common, (half, variance)));
            }
        }
        let bound = slices.iter().fold(0.0_f64, |most, it| most.max(it.variance)).sqrt();
        let excess = bound / floor - 1.0;
        // The strongest where the middle of a slice has the largest variance.
        let worst = slices
            .iter()
            .filter_map(|it| Some((it, it.worst?)))
            .max_by(|(a, _), (b, _)| a.middle.total_cmp(&b.middle))
            .map(|(_, band)| self.describe(&common, tolerance, band));
        Ok(Certificate {
            passes: excess <= allowed,
            refuted,
            sigma_predicted: nominal.sigma(),
            sigma_smooth: nominal.smooth_sigma(),
            sigma_bound: bound,
            sigma_floor: floor,
            excess,
            slices: slices.len(),
            worst,
        })
    }

    fn describe(
        &mut self,
        common: &BoxCoefficients<'_>,
        tolerance: Tolerance,
        band: Band,
    ) -> Worst {
        let motion = &common.motion;
        let [k, j] = band.frequencies;
        let multiple = gcd(k, j).max(1);
        let l_max = self.l_max();
        let m = (0..=l_max)
            .map(|m| (m, self.pair_power(band.pair, m)))
            .fold((0, -1.0), |best, it| if it.1 > best.1 { it } else { best })
            .0;
        // k / T_a + j / T_b = -m / T_o
        let peak = |m: f64| {
            f64::from(k) / (-m / motion.orbit_period_s - f64::from(j) / motion.spin_period_s)
        };
        let nominal = motion.precession_period_s;
        let (above, below) = (peak(f64::from(m)), peak(f64::from(-m)));
        let nearer_above = (above - nominal).abs() <= (below - nominal).abs();
        let at = if nearer_above { above } else { below };
        let commensurable = peak(0.0);
        let width =
            tolerance.precession_s + tolerance.spin_s * (nominal / motion.spin_period_s).abs();
        let m_star = motion.standing(k, j).abs();
        Worst {
            p: k / multiple,
            q: (j / multiple).abs(),
            multiple,
            m,
            precession_period_s: at,
            sideband: if at.abs() >= commensurable.abs() { 1 } else { -1 },
            power_bound: 2.0 * band.power,
            wavelength_rad: TAU / m_star,
            beat_s: motion.orbit_period_s.abs() / m_star,
            northern_share: self.northern_share(band.pair, !nearer_above, m),
            distance_in_tolerances: (at - nominal).abs() / width,
        }
    }
}

fn checked_box(
    motion: &Motion,
    tolerance: Tolerance,
    orbit: &Orbit,
) -> Result<Slice, CertificateError> {
    let (a, b) = (motion.precession_period_s, motion.spin_period_s);
    if b.abs() >= a.abs() {
        return Err(CertificateError::Order { precession_period_s: a, spin_period_s: b });
    }
    for (name, tolerance_s, period_s) in [
        ("the precession period", tolerance.precession_s, a.abs()),
        ("the spin period", tolerance.spin_s, b.abs()),
    ] {
        if !(0.0..period_s).contains(&tolerance_s) {
            return Err(CertificateError::Tolerance { name, tolerance_s, period_s });
        }
    }
    if !(0.0..0.5).contains(&orbit.rate()) || !(0.0..1.0).contains(&orbit.latitude_rad()) {
        return Err(CertificateError::Orbit {
            rate: orbit.rate(),
            latitude_rad: orbit.latitude_rad(),
        });
    }
    let precession_s = [a - tolerance.precession_s, a + tolerance.precession_s];
    let spin_s = [b - tolerance.spin_s, b + tolerance.spin_s];
    let mut eta = [f64::INFINITY, f64::NEG_INFINITY];
    for a in precession_s {
        for b in spin_s {
            eta = [eta[0].min(a / b), eta[1].max(a / b)];
        }
    }
    Ok(Slice { eta, precession_s })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::healpix::Nside;
    use crate::resonance::Window;
    use crate::resonance::orbit::ellipse;

    fn litebird() -> Predictor {
        let window = Window::pixel(Nside::new(128).unwrap()).unwrap();
        Predictor::new(45_f64.to_radians(), 50_f64.to_radians(), window)
    }

    fn check(minutes: f64, [precession_s, spin_s]: [f64; 2]) -> Certificate {
        let mut predictor = litebird();
        let motion = Motion::year(minutes * 60.0, 1200.0);
        let floor = predictor.floor(&motion);
        let tolerance = Tolerance { precession_s, spin_s };
        predictor.certify(&motion, tolerance, &Orbit::CIRCULAR, [floor, 0.01]).unwrap()
    }

    #[test]
    fn litebird_passes_at_its_tolerance_only() {
        let preset = check(192.348, [0.6, 0.06]);
        assert!(preset.passes && !preset.refuted, "{preset:?}");
        assert!(check(192.348, [0.0, 0.0]).passes);
        for (minutes, tolerance, p, q) in [
            (192.348, [1.5, 0.16], 125, 13),
            (192.08, [0.6, 0.06], 48, 5),
            (192.0, [0.6, 0.06], 48, 5),
        ] {
            let found = check(minutes, tolerance);
            assert!(!found.passes && found.refuted, "{found:?}");
            let worst = found.worst.unwrap();
            assert_eq!((worst.p, worst.q, worst.multiple), (p, q, 1), "{found:?}");
        }
        let upper = check(192.08, [0.6, 0.06]).worst.unwrap();
        assert_eq!(upper.sideband, 1);
        assert!((upper.precession_period_s / 60.0 - 192.08).abs() < 0.01, "{upper:?}");
        // 360 deg in M = 54.8 waves; the south is the worse half.
        assert!((upper.wavelength_rad.to_degrees() - 6.573).abs() < 0.01, "{upper:?}");
        assert!(upper.northern_share < 0.3, "{upper:?}");
    }

    /// A generator of numbers from 0 to 1.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = self.0;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            f64::from(u32::try_from((z ^ (z >> 31)) >> 32).unwrap()) / f64::from(u32::MAX)
        }

        fn signed(&mut self) -> f64 {
            2.0 * self.next() - 1.0
        }
    }

    /// Certifies boxes of many kinds and looks for points above the bound.
    fn points_stay_below(boxes: u32, points: u32, nside: u32) {
        let mut numbers = Numbers(u64::from(boxes));
        let (mut passed, mut tightest) = (0, f64::INFINITY);
        for number in 0..boxes {
            let window = Window::pixel(Nside::new(nside).unwrap()).unwrap();
            let (alpha, beta) =
                [(45.0_f64, 50.0_f64), (30.0, 60.0), (50.0, 45.0)][number as usize % 3];
            let mut predictor = Predictor::new(alpha.to_radians(), beta.to_radians(), window);
            let spin = if number % 4 == 3 { -1200.0 } else { 1200.0 };
            let years = [1.0, 1.0, 3.0, 0.7][number as usize / 2 % 4];
            let motion = Motion {
                duration_s: years * super::super::motion::YEAR_S,
                ..Motion::year((192.5 + 0.5 * numbers.signed()) * 60.0, spin)
            };
            let tolerance =
                Tolerance { precession_s: 0.9 * numbers.next(), spin_s: 0.09 * numbers.next() };
            // Any allowance: the bound itself is on trial.
            let limit = [0.25, [0.0, 10.0][number as usize % 2]];
            let found = predictor.certify(&motion, tolerance, &Orbit::CIRCULAR, limit).unwrap();
            passed += u32::from(found.passes);
            for _ in 0..points {
                let point = Motion {
                    precession_period_s: motion.precession_period_s
                        + numbers.signed() * tolerance.precession_s,
                    spin_period_s: spin + numbers.signed() * tolerance.spin_s,
                    precession_phase_rad: 7.0 * numbers.next(),
                    spin_phase_rad: 7.0 * numbers.next(),
                    longitude_rad: 7.0 * numbers.next(),
                    ..motion
                };
                let sigma = predictor.predict(&point).sigma();
                assert!(sigma <= found.sigma_bound, "{sigma} {point:?} {found:?}");
                tightest = tightest.min(found.sigma_bound / sigma - 1.0);
            }
        }
        assert!(passed > 0 && tightest < 0.05, "{passed} of {boxes} pass, {tightest:e} at least");
    }

    #[test]
    fn no_point_in_a_passing_box_exceeds_its_bound() {
        points_stay_below(25, 40, 64);
    }

    #[test]
    fn none_of_10_000_points_exceeds_its_bound() {
        points_stay_below(50, 200, 128);
    }

    /// The largest bounds are those of finer and finer boxes about a point.
    #[test]
    fn bounds_of_points_are_tight() {
        for minutes in [192.0825, 192.2, 192.348, 192.5] {
            let found = check(minutes, [0.0, 0.0]);
            assert!(found.sigma_bound >= found.sigma_predicted, "{found:?}");
            assert!(found.sigma_bound < 1.02 * found.sigma_predicted, "{found:?}");
        }
    }

    #[test]
    fn bounds_follow_the_orbit() {
        let mut predictor = litebird();
        let ellipse = ellipse(1.0);
        let mut bound = |minutes: f64, width: f64, orbit: &Orbit| {
            let motion = Motion::year(minutes * 60.0, 1200.0);
            let tolerance = Tolerance { precession_s: width, spin_s: 0.1 * width };
            let floor = predictor.floor(&motion);
            predictor.certify(&motion, tolerance, orbit, [floor, 0.01]).unwrap()
        };
        // Simulated on DE440's orbit 0.28037, on a circle 0.28174.
        for (orbit, simulated) in [(&Orbit::CIRCULAR, 0.28174), (&ellipse, 0.28037)] {
            let found = bound(192.0825, 0.0, orbit).sigma_bound;
            assert!(found > simulated - 1e-4 && found < 1.01 * simulated, "{found} {simulated}");
        }
        let beside = [&Orbit::CIRCULAR, &ellipse].map(|it| bound(192.09, 0.0, it).sigma_bound);
        assert!(beside[1] > 0.98 * beside[0], "{beside:?}");
        assert!(bound(192.348, 0.6, &ellipse).passes);
    }

    #[test]
    fn illegal_requests_are_named() {
        let mut predictor = litebird();
        let mut refused = |a: f64, b: f64, precession_s: f64, spin_s: f64| {
            let tolerance = Tolerance { precession_s, spin_s };
            let motion = Motion::year(a, b);
            predictor.certify(&motion, tolerance, &Orbit::CIRCULAR, [0.25, 0.01]).unwrap_err()
        };
        assert!(matches!(refused(1200.0, 1200.0, 0.0, 0.0), CertificateError::Order { .. }));
        assert!(matches!(refused(0.0, 1200.0, 0.0, 0.0), CertificateError::Motion(_)));
        for (da, db) in [(-1.0, 0.0), (0.0, -1.0), (12_000.0, 0.0), (0.0, 1200.0), (f64::NAN, 0.0)]
        {
            let error = refused(11_541.0, 1200.0, da, db);
            assert!(matches!(error, CertificateError::Tolerance { .. }), "{error}");
        }
    }
}
