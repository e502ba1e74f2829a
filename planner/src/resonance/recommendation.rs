//! Which periods to fly.
//!
//! Among candidate pairs of precession and spin period: the one with the smallest bound within the
//! tolerance, the one that survives the largest multiple of it, and the one closest to the
//! golden-ratio rule \[Hoang2017\], `T_alpha / T_beta = n + (sqrt 5 - 1) / 2`.
//!
//! Method: every candidate's `sigma_hits / mean` is predicted. A candidate ranks by the largest
//! prediction within its tolerance on a scan of all precession periods at its spin period, or by its
//! distance from the nearest point of that scan above the allowance, in tolerances; the first
//! [`SHORTLIST`] of either rank are certified, the multiple of the tolerance by bisection.
//!
//! Limits: a scan's ranks stand for the bounds', so that a candidate off the short list may be
//! better by less than the bounds exceed the predictions.

use super::certificate::{Certificate, CertificateError};
use super::motion::{Motion, Tolerance};
use super::orbit::Orbit;
use super::predictor::Predictor;
use std::collections::BTreeMap;

/// Candidates of either rank that are certified.
pub const SHORTLIST: usize = 3;
/// Points of the scan on which candidates rank.
const SCAN_POINTS: u32 = 400;
/// Halvings of the multiple of a tolerance.
const HALVINGS: u32 = 6;
/// Largest multiple of a tolerance that is tried.
pub const MOST_TOLERANCES: f64 = 8.0;
/// The fraction that fractions approach most slowly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A pair of periods with its certificate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// In seconds, negative if reversed.
    pub precession_period_s: f64,
    /// In seconds, negative if reversed.
    pub spin_period_s: f64,
    /// At the tolerance asked for.
    pub certificate: Certificate,
    /// The multiple of the tolerance that still passes, to a ninth, at most
    /// [`MOST_TOLERANCES`]; zero where not even the smallest tried does.
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

/// A candidate and how it ranks; small is good.
#[derive(Debug, Clone, Copy)]
struct Ranked {
    periods_s: [f64; 2],
    quiet: f64,
    sturdy: f64,
    golden: f64,
}

impl Predictor {
    /// The best of candidate pairs of precession and spin period, in seconds with the motion's
    /// senses; `None` without candidates.
    ///
    /// # Errors
    /// [`CertificateError`] naming what is not legal in the motion or a candidate.
    pub fn recommend(
        &mut self,
        motion: &Motion,
        candidates: &[[f64; 2]],
        demand: &Demand,
    ) -> Result<Option<Recommendation>, CertificateError> {
        let at = |[precession_period_s, spin_period_s]: [f64; 2]| Motion {
            precession_period_s,
            spin_period_s,
            ..*motion
        };
        let mut by_spin: BTreeMap<u64, Vec<[f64; 2]>> = BTreeMap::new();
        for &candidate in candidates {
            at(candidate).checked()?;
            by_spin.entry(candidate[1].to_bits()).or_default().push(candidate);
        }
        let ranked: Vec<Ranked> =
            by_spin.values().flat_map(|candidates| self.rank(motion, candidates, demand)).collect();
        let quiet = shortlist(&ranked, |it| it.quiet);
        let sturdy = shortlist(&ranked, |it| it.sturdy);
        let Some(&golden) = shortlist(&ranked, |it| it.golden).first() else { return Ok(None) };
        let mut choices: Vec<Choice> = Vec::new();
        for periods in quiet.into_iter().chain(sturdy).chain([golden]) {
            if !choices.iter().any(|it| it.is(periods)) {
                choices.push(self.choice(&at(periods), demand)?);
            }
        }
        let quietest = choices
            .iter()
            .min_by(|a, b| a.certificate.sigma_bound.total_cmp(&b.certificate.sigma_bound));
        let sturdiest = choices.iter().max_by(|a, b| {
            let rank = |it: &Choice| (it.tolerances_survived, -it.certificate.sigma_bound);
            let ((x, p), (y, q)) = (rank(a), rank(b));
            x.total_cmp(&y).then(p.total_cmp(&q))
        });
        let golden = choices.iter().find(|it| it.is(golden));
        let found = quietest.zip(sturdiest).zip(golden);
        Ok(found.map(|((&quietest, &sturdiest), &golden)| Recommendation {
            quietest,
            sturdiest,
            golden,
        }))
    }

    /// Ranks candidates of one spin period on a scan of their precession periods.
    fn rank(&mut self, motion: &Motion, candidates: &[[f64; 2]], demand: &Demand) -> Vec<Ranked> {
        let Some(&[first, spin_period_s]) = candidates.first() else { return Vec::new() };
        let eta = |period: f64| (period / spin_period_s).abs();
        let width = demand.tolerance.precession_s + demand.tolerance.spin_s * eta(first);
        let (low, high) = candidates
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &[it, _]| (a.min(it), b.max(it)));
        let (low, high) = (low - MOST_TOLERANCES * width, high + MOST_TOLERANCES * width);
        let scan: Vec<(f64, f64)> = (0..=SCAN_POINTS)
            .map(|i| low + (high - low) * f64::from(i) / f64::from(SCAN_POINTS))
            .chain(candidates.iter().map(|it| it[0]))
            .map(|precession_period_s| {
                let motion = Motion { precession_period_s, spin_period_s, ..*motion };
                (precession_period_s, self.predict(&motion).sigma())
            })
            .collect();
        let floor = scan.iter().fold(f64::INFINITY, |least, it| least.min(it.1));
        let ranked = candidates.iter().map(|&periods_s| {
            let apart = |it: &&(f64, f64)| (it.0 - periods_s[0]).abs();
            let near = scan.iter().filter(|it| apart(it) <= width);
            let loud = scan.iter().filter(|it| it.1 > floor * (1.0 + demand.allowed));
            let distance = loud.fold(f64::INFINITY, |least, it| least.min(apart(&it)));
            Ranked {
                periods_s,
                quiet: near.fold(0.0, |most, it| it.1.max(most)),
                sturdy: -distance / width.max(f64::MIN_POSITIVE),
                golden: (eta(periods_s[0]).fract() - GOLDEN).abs(),
            }
        });
        ranked.collect()
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
            spin_period_s: motion.spin_period_s,
            certificate,
            tolerances_survived: low,
        })
    }
}

impl Choice {
    fn is(&self, periods_s: [f64; 2]) -> bool {
        [self.precession_period_s, self.spin_period_s].map(f64::to_bits)
            == periods_s.map(f64::to_bits)
    }
}

/// The candidates with the smallest ranks, those first.
fn shortlist(candidates: &[Ranked], rank: impl Fn(&Ranked) -> f64) -> Vec<[f64; 2]> {
    let mut ranked: Vec<(f64, [f64; 2])> =
        candidates.iter().map(|it| (rank(it), it.periods_s)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
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
        let candidates: Vec<[f64; 2]> =
            (0..=50).map(|i| [(192.0 + 0.02 * f64::from(i)) * 60.0, 1200.0]).collect();
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

    #[test]
    fn pairs_are_compared_across_spin_periods() {
        let window = Window::pixel(Nside::new(32).unwrap()).unwrap();
        let mut predictor = Predictor::new(45_f64.to_radians(), 50_f64.to_radians(), window);
        let motion = Motion::year(192.348 * 60.0, -1200.0);
        let mut candidates = Vec::new();
        for spin in [1190.0, 1200.0, 1210.0] {
            candidates.extend((0..20).map(|i| [11_400.0 + 10.0 * f64::from(i), -spin]));
        }
        let demand = Demand {
            tolerance: Tolerance { precession_s: 1.0, spin_s: 0.1 },
            orbit: Orbit::CIRCULAR,
            allowed: 0.01,
        };
        let found = predictor.recommend(&motion, &candidates, &demand).unwrap().unwrap();
        // No candidate's prediction is below the smallest bound by more than the tolerance can do.
        let least = candidates
            .iter()
            .map(|&[precession_period_s, spin_period_s]| {
                let motion = Motion { precession_period_s, spin_period_s, ..motion };
                predictor.predict(&motion).sigma()
            })
            .fold(f64::INFINITY, f64::min);
        let quietest = found.quietest.certificate.sigma_bound;
        assert!((1.0..1.02).contains(&(quietest / least)), "{quietest} {least}");
        assert!(found.quietest.spin_period_s < 0.0);
    }
}
