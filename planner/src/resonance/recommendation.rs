//! Which precession period to fly.
//!
//! Among candidates at one spin period: the one with the smallest bound within the tolerance, the
//! one that survives the largest multiple of it, and the one closest to the golden-ratio rule
//! \[Hoang2017\], `T_alpha / T_beta = n + (sqrt 5 - 1) / 2`.
//!
//! Method: every candidate's `sigma_hits / mean` is predicted. A candidate ranks by the largest
//! prediction within its tolerance on a scan of the whole range, or by its distance from the nearest
//! point of that scan above the allowance; the first [`SHORTLIST`] of either rank are certified, the
//! multiple of the tolerance by bisection.
//!
//! Limits: a scan's ranks stand for the bounds', so that a candidate off the short list may be
//! better by less than the bounds exceed the predictions.

use super::certificate::{Certificate, CertificateError, Tolerance};
use super::motion::Motion;
use super::orbit::Orbit;
use super::power::Predictor;

/// Candidates of either rank that are certified.
pub const SHORTLIST: usize = 5;
/// Points of the scan on which candidates rank.
const SCAN_POINTS: u32 = 400;
/// Halvings of the multiple of a tolerance.
const HALVINGS: u32 = 7;
/// Largest multiple of a tolerance that is tried.
pub const MOST_TOLERANCES: f64 = 8.0;

/// A precession period with its certificate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// In seconds, negative if reversed.
    pub precession_period_s: f64,
    /// At the tolerance asked for.
    pub certificate: Certificate,
    /// The multiple of the tolerance that still passes, to about 6%; zero if not even a hundredth.
    pub tolerances_survived: f64,
}

/// What to fly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recommendation {
    /// The smallest bound.
    pub quietest: Choice,
    /// The largest multiple of the tolerance.
    pub sturdiest: Choice,
    /// The candidate closest to the golden-ratio rule.
    pub golden: Choice,
}

/// What a choice must meet.
#[derive(Debug, Clone, PartialEq)]
pub struct Demand {
    /// Of the two periods.
    pub tolerance: Tolerance,
    /// The orbit.
    pub orbit: Orbit,
    /// Allowed excess over the floor.
    pub allowed: f64,
}

impl Predictor {
    /// The best of candidate precession periods, in seconds with the motion's sense; `None` without
    /// candidates.
    ///
    /// # Errors
    /// [`CertificateError`] naming what is not legal in the motion or a candidate.
    pub fn recommend(
        &mut self,
        motion: &Motion,
        candidates: &[f64],
        demand: &Demand,
    ) -> Result<Option<Recommendation>, CertificateError> {
        let Some(&first) = candidates.first() else { return Ok(None) };
        let at = |precession_period_s: f64| Motion { precession_period_s, ..*motion };
        for &candidate in candidates {
            at(candidate).checked()?;
        }
        let eta = |period: f64| (period / motion.spin_period_s).abs();
        let width = demand.tolerance.precession_s + demand.tolerance.spin_s * eta(first);
        let (low, high) = candidates
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &it| (a.min(it), b.max(it)));
        let (low, high) = (low - MOST_TOLERANCES * width, high + MOST_TOLERANCES * width);
        let scan: Vec<(f64, f64)> = (0..=SCAN_POINTS)
            .map(|i| low + (high - low) * f64::from(i) / f64::from(SCAN_POINTS))
            .chain(candidates.iter().copied())
            .map(|period| (period, self.predict(&at(period)).sigma()))
            .collect();
        let floor = scan.iter().fold(f64::INFINITY, |least, it| least.min(it.1));
        let largest_near = |period: f64| {
            let near = scan.iter().filter(|it| (it.0 - period).abs() <= width);
            near.fold(0.0_f64, |most, it| most.max(it.1))
        };
        let distance = |period: f64| {
            let above = scan.iter().filter(|it| it.1 > floor * (1.0 + demand.allowed));
            above.fold(f64::INFINITY, |least, it| least.min((it.0 - period).abs()))
        };
        let quiet = shortlist(candidates, largest_near);
        let sturdy = shortlist(candidates, |period| -distance(period));
        let golden = shortlist(candidates, |period| {
            (eta(period).fract() - (5.0_f64.sqrt() - 1.0) / 2.0).abs()
        });
        let mut choose = |list: &[f64]| {
            list.iter().map(|&it| self.choice(&at(it), demand)).collect::<Result<Vec<_>, _>>()
        };
        let (quiet, sturdy, golden) = (choose(&quiet)?, choose(&sturdy)?, choose(&golden[..1])?);
        let all = || quiet.iter().chain(&sturdy);
        let quietest =
            all().min_by(|a, b| a.certificate.sigma_bound.total_cmp(&b.certificate.sigma_bound));
        let sturdiest = all().max_by(|a, b| {
            let rank = |it: &Choice| (it.tolerances_survived, -it.certificate.sigma_bound);
            let ((x, p), (y, q)) = (rank(a), rank(b));
            x.total_cmp(&y).then(p.total_cmp(&q))
        });
        let found = quietest.zip(sturdiest).zip(golden.first());
        Ok(found.map(|((&quietest, &sturdiest), &golden)| Recommendation {
            quietest,
            sturdiest,
            golden,
        }))
    }

    fn choice(&mut self, motion: &Motion, demand: &Demand) -> Result<Choice, CertificateError> {
        let limit = [self.floor(motion), demand.allowed];
        let mut passes = |factor: f64| {
            let tolerance = Tolerance {
                precession_s: factor * demand.tolerance.precession_s,
                spin_s: factor * demand.tolerance.spin_s,
            };
            self.certify(motion, tolerance, &demand.orbit, limit)
        };
        let certificate = passes(1.0)?;
        let (mut low, mut high) =
            if certificate.passes { (1.0, MOST_TOLERANCES) } else { (0.0, 1.0) };
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if passes(middle)?.passes {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(Choice {
            precession_period_s: motion.precession_period_s,
            certificate,
            tolerances_survived: low,
        })
    }
}

/// The candidates with the smallest ranks, those first.
fn shortlist(candidates: &[f64], rank: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut ranked: Vec<(f64, f64)> = candidates.iter().map(|&it| (rank(it), it)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    ranked.into_iter().take(SHORTLIST).map(|it| it.1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::healpix::Nside;
    use crate::resonance::Window;

    #[test]
    fn litebird_is_told_to_fly_where_it_does() {
        let window = Window::pixel(Nside::new(128).unwrap()).unwrap();
        let mut predictor = Predictor::new(45_f64.to_radians(), 50_f64.to_radians(), window);
        let motion = Motion::year(192.348 * 60.0, 1200.0);
        let candidates: Vec<f64> = (0..=50).map(|i| (192.0 + 0.02 * f64::from(i)) * 60.0).collect();
        let demand = Demand {
            tolerance: Tolerance { precession_s: 0.3, spin_s: 0.03 },
            orbit: Orbit::CIRCULAR,
            allowed: 0.01,
        };
        let found = predictor.recommend(&motion, &candidates, &demand).unwrap().unwrap();
        for choice in [found.quietest, found.sturdiest] {
            assert!(choice.certificate.passes && choice.tolerances_survived >= 1.0, "{choice:?}");
        }
        assert!(found.quietest.certificate.sigma_bound <= found.golden.certificate.sigma_bound);
        assert!(found.sturdiest.tolerances_survived >= found.golden.tolerances_survived);
        // 9.618 times 20 min.
        assert!((found.golden.precession_period_s / 60.0 - 192.36).abs() < 0.011, "{found:?}");
        assert!(predictor.recommend(&motion, &[], &demand).unwrap().is_none());
    }
}
