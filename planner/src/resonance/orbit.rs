//! How the anti-Sun direction goes round during a survey.
//!
//! On a circle the longitude advances uniformly. On the Earth's ellipse, or about L2, it is
//! `L(t) = w_o t + delta(t)`, and a pair's coefficient at m is
//!
//! `c_m(m*) = (1 / T) integral exp(i [(m* - m) w_o t - m delta(t)]) dt`,
//!
//! `sinc(pi N_o (m - m*))` where delta vanishes. The sum over m of its squares is that of the circle
//! times the mean of `w_o / L'` (Parseval, the longitude as variable).
//!
//! Method: Gauss and Legendre's nodes over the survey, as many as the fastest phase needs
//! (test `coefficients_meet_their_sum`).
//!
//! Latitudes count from the plane that fits them best: a tilted plane turns the whole map.
//!
//! Limits: a year later the deviation is the same; latitudes are given by the largest one; planes are
//! tilted by a small angle.

use super::coefficients::{REACH, sinc};
use super::motion::Motion;
use crate::harmonics::quadrature::gauss_legendre;
use pulp::{Arch, NullaryFnOnce};
use std::f64::consts::{PI, TAU};

/// Points at which the rate is looked at.
const RATE_POINTS: u32 = 128;
/// Nodes that are taken at a time.
const LANES: usize = 8;
/// Half the share of the survey over which a rate is taken.
const RATE_STEP: f64 = 1e-3;
/// Nodes beside those that oscillation needs.
const SPARE_NODES: f64 = 24.0;
/// Nodes per turn of the fastest phase.
const NODES_PER_TURN: f64 = 1.7;

/// The anti-Sun direction over a survey.
#[derive(Debug, Clone, PartialEq)]
pub struct Orbit {
    /// None on a circle; else for ever larger m, the last for all.
    nodes: Vec<Rule>,
    rate: f64,
    latitude_rad: f64,
    slowness: f64,
}

/// Nodes that suffice to a largest m.
#[derive(Debug, Clone, PartialEq)]
struct Rule {
    largest_m: f64,
    nodes: Vec<Node>,
}

/// An instant of the survey.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    /// Time after the middle of the survey, in surveys.
    time: f64,
    weight: f64,
    /// Longitude less its uniform part.
    deviation_rad: f64,
}

impl Orbit {
    /// Uniform longitude.
    pub const CIRCULAR: Self =
        Self { nodes: Vec::new(), rate: 0.0, latitude_rad: 0.0, slowness: 1.0 };

    /// The orbit whose anti-Sun longitude and latitude, in radians, `direction` gives at a share of
    /// the survey from 0 to 1, for degrees to `l_max`.
    ///
    /// # Errors
    /// The first that `direction` returns.
    pub fn follow<E>(
        motion: &Motion,
        l_max: usize,
        direction: impl Fn(f64) -> Result<[f64; 2], E>,
    ) -> Result<Self, E> {
        let orbits = motion.orbits();
        let [start, _] = direction(0.0)?;
        // Less the uniform advance, within half a turn.
        let deviation = |share: f64| -> Result<[f64; 2], E> {
            let [longitude, latitude] = direction(share)?;
            let off = longitude - start - TAU * orbits * share;
            Ok([off - TAU * (off / TAU).round(), latitude])
        };
        let (mut rate, mut slowness) = (0.0_f64, 0.0);
        let mut seen = Vec::new();
        for i in 0..RATE_POINTS {
            let share = (f64::from(i) + 0.5) / f64::from(RATE_POINTS);
            let [before, latitude] = deviation(share - RATE_STEP)?;
            let [after, _] = deviation(share + RATE_STEP)?;
            let faster = (after - before) / (2.0 * RATE_STEP * TAU * orbits);
            rate = rate.max(faster.abs());
            slowness += 1.0 / ((1.0 + faster) * f64::from(RATE_POINTS));
            seen.push([start + TAU * orbits * share + before, latitude]);
        }
        let latitude_rad = off_plane(&seen);
        #[expect(clippy::cast_precision_loss, reason = "a degree")]
        let l_max = l_max as f64;
        let mut nodes = Vec::new();
        for share in [0.25, 0.5, 1.0] {
            let largest_m = share * l_max;
            let turns = orbits.abs() * (REACH + 2.0 * rate * largest_m);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "saturates"
            )]
            let order = (SPARE_NODES + NODES_PER_TURN * turns).min(1e4) as u32;
            let mut rule = Vec::new();
            for (share, weight) in gauss_legendre(order) {
                let [deviation_rad, _] = deviation(share)?;
                rule.push(Node { time: share - 0.5, weight, deviation_rad });
            }
            let mean: f64 = rule.iter().map(|it| it.weight * it.deviation_rad).sum();
            for node in &mut rule {
                node.deviation_rad -= mean;
            }
            nodes.push(Rule { largest_m, nodes: rule });
        }
        Ok(Self { nodes, rate, latitude_rad, slowness })
    }

    /// Largest relative departure of the longitude's rate from its mean.
    #[must_use]
    pub const fn rate(&self) -> f64 {
        self.rate
    }

    /// Largest latitude about the orbit's plane in radians.
    #[must_use]
    pub const fn latitude_rad(&self) -> f64 {
        self.latitude_rad
    }

    /// Whether the longitude advances uniformly.
    #[must_use]
    pub const fn is_circular(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Mean of `w_o / L'`.
    pub(super) const fn slowness(&self) -> f64 {
        self.slowness
    }

    /// `|c_m|^2` where `m* - m` is `first + i` steps, for `count` values of i.
    pub(super) fn squares(
        &self,
        (m, orbits): (f64, f64),
        step: f64,
        (first, count): (f64, usize),
    ) -> Vec<f64> {
        let fitting = self.nodes.iter().find(|rule| m.abs() <= rule.largest_m);
        let Some(rule) = fitting.or(self.nodes.last()) else {
            let mut x = first - 1.0;
            let square = || {
                x += 1.0;
                sinc(PI * orbits * x * step).powi(2)
            };
            return std::iter::repeat_with(square).take(count).collect();
        };
        let turn = TAU * orbits * step;
        let phasors = rule.nodes.chunks(LANES).map(|nodes| {
            let mut phasor = Phasor::default();
            for (i, node) in nodes.iter().enumerate() {
                let (s, c) = (turn * first * node.time - m * node.deviation_rad).sin_cos();
                (phasor.re[i], phasor.im[i]) = (node.weight * c, node.weight * s);
                (phasor.step_im[i], phasor.step_re[i]) = (turn * node.time).sin_cos();
            }
            phasor
        });
        let phasors = phasors.collect();
        Arch::new().dispatch(Squares { phasors, count })
    }
}

/// The largest latitude about the plane that fits longitudes and latitudes best.
fn off_plane(seen: &[[f64; 2]]) -> f64 {
    // Latitude a sin(longitude) + b cos(longitude), by least squares.
    let (mut ss, mut sc, mut cc, mut sy, mut cy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for &[longitude, latitude] in seen {
        let (s, c) = longitude.sin_cos();
        (ss, sc, cc) = (ss + s * s, sc + s * c, cc + c * c);
        (sy, cy) = (sy + s * latitude, cy + c * latitude);
    }
    let determinant = ss * cc - sc * sc;
    let [a, b] = if determinant > 1e-6 * (ss + cc).powi(2) {
        [(sy * cc - cy * sc) / determinant, (cy * ss - sy * sc) / determinant]
    } else {
        [0.0, 0.0]
    };
    let off = seen.iter().map(|&[longitude, latitude]| {
        let (s, c) = longitude.sin_cos();
        (latitude - a * s - b * c).abs()
    });
    off.fold(0.0, f64::max)
}

/// Phasors of [`LANES`] nodes, and what a step turns them by.
#[derive(Default, Clone, Copy)]
struct Phasor {
    re: [f64; LANES],
    im: [f64; LANES],
    step_re: [f64; LANES],
    step_im: [f64; LANES],
}

/// The squares of the phasors' sum, a step between each.
struct Squares {
    phasors: Vec<Phasor>,
    count: usize,
}

impl NullaryFnOnce for Squares {
    type Output = Vec<f64>;

    /// Sums in the same order on every instruction set.
    #[expect(clippy::inline_always, reason = "compiled for each instruction set")]
    #[inline(always)]
    fn call(mut self) -> Vec<f64> {
        let mut squares = Vec::with_capacity(self.count);
        for _ in 0..self.count {
            let (mut sum_re, mut sum_im) = ([0.0; LANES], [0.0; LANES]);
            for Phasor { re, im, step_re, step_im } in &mut self.phasors {
                let (a, b) = (*re, *im);
                for i in 0..LANES {
                    sum_re[i] += a[i];
                    sum_im[i] += b[i];
                    re[i] = a[i] * step_re[i] - b[i] * step_im[i];
                    im[i] = a[i] * step_im[i] + b[i] * step_re[i];
                }
            }
            let (re, im) = (sum_re.iter().sum::<f64>(), sum_im.iter().sum::<f64>());
            squares.push(re * re + im * im);
        }
        squares
    }
}

/// A year or more on the Earth's ellipse, from perihelion.
#[cfg(test)]
pub(super) fn ellipse(years: f64) -> Orbit {
    let motion = Motion { duration_s: years * super::motion::YEAR_S, ..Motion::year(1e4, 1e3) };
    let e = 0.0167_f64;
    let direction = |share: f64| -> Result<[f64; 2], std::convert::Infallible> {
        let mean = TAU * years * share;
        let mut eccentric = mean;
        for _ in 0..20 {
            eccentric = mean + e * eccentric.sin();
        }
        let (s, c) = eccentric.sin_cos();
        Ok([((1.0 - e * e).sqrt() * s).atan2(c - e), 0.0])
    };
    Orbit::follow(&motion, 768, direction).unwrap_or(Orbit::CIRCULAR)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_meet_their_sum() {
        for years in [1.0, 2.0] {
            let orbit = ellipse(years);
            assert!((orbit.rate() - 0.0340).abs() < 6e-4, "{}", orbit.rate());
            for (m, share) in [(0.0, 0.0), (17.0, 0.3), (50.0, 0.5), (300.0, 0.9), (768.0, 0.1)] {
                // All m near a given m*.
                let m_star = m + share;
                let mut sum = 0.0;
                let room = [8, 16, 32][usize::from(m > 100.0) + usize::from(m > 400.0)];
                for other in -room..=room {
                    let m = m + f64::from(other);
                    sum += orbit.squares((m, years), 1.0, (m_star - m, 1))[0];
                }
                let mut all = 1.0 / years;
                if years > 1.0 {
                    all *= 1.0 + (TAU * m_star).cos();
                }
                // Terms further away are a tail of 1 / x^2.
                assert!((sum - all * orbit.slowness()).abs() < 0.03, "{m_star}: {sum} {all}");
            }
        }
    }

    #[test]
    fn a_tilted_plane_is_no_latitude() {
        let motion = Motion::year(1e4, 1e3);
        let tilted = |latitude: f64, ripple: f64| {
            let direction = |share: f64| -> Result<[f64; 2], std::convert::Infallible> {
                let at = TAU * share;
                Ok([at, latitude * (at - 1.0).sin() + ripple * (2.0 * at).sin()])
            };
            let Ok(orbit) = Orbit::follow(&motion, 768, direction);
            orbit.latitude_rad()
        };
        assert!(tilted(1e-3, 0.0) < 1e-12);
        assert!((tilted(1e-3, 1e-4) / 1e-4 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_circle_has_the_sinc() {
        let motion = Motion::year(1e4, 1e3);
        let uniform = |share: f64| -> Result<[f64; 2], std::convert::Infallible> {
            Ok([(1.0 + TAU * share).rem_euclid(TAU), 0.0])
        };
        let Ok(orbit) = Orbit::follow(&motion, 768, uniform);
        assert!(orbit.rate() < 1e-9 && (orbit.slowness() - 1.0).abs() < 1e-9);
        let found = orbit.squares((300.0, 1.0), 0.25, (-12.0, 25));
        let expected = Orbit::CIRCULAR.squares((300.0, 1.0), 0.25, (-12.0, 25));
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }
}
