//! What lies between tabulated states.
//!
//! A [`StateSeries`] holds positions and velocities at rising times; between them it interpolates
//! over a window of states: Lagrange on position and velocity apart, or Hermite on both, whose
//! derivative is the velocity. OEM files and SPK segments of types 8, 9, 12, 13, 18, 19 are read into it.
//!
//! Method: windows as SPICE chooses them: with an even number of states the interval in the middle,
//! with an odd number the nearest state in the middle, moved inwards at the ends. Neville's scheme,
//! and Newton's divided differences on doubled nodes, in time scaled to the window.
//!
//! Limits: an even Hermite window gives a track with continuous velocity; an odd window, or
//! Lagrange, jumps by its own error where windows change.

use crate::convert::f64_from_usize;
use core::ops::Range;
use nalgebra::Vector3;

/// How a window of states becomes a polynomial.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Method {
    Lagrange,
    Hermite,
}

/// Position in km, velocity in km/s.
pub(crate) type PosVel = (Vector3<f64>, Vector3<f64>);

/// Most states in a window.
pub(crate) const MAX_WINDOW: usize = 32;

/// Tabulated states and how to interpolate them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StateSeries {
    times_s: Vec<f64>,
    states: Vec<PosVel>,
    method: Method,
    window: usize,
    /// Windows at the ends are cut, not moved inwards.
    is_cut: bool,
}

impl StateSeries {
    /// Checks nothing but sizes; `window` is cut to the number of states.
    ///
    /// Times rise strictly and numbers are finite: the readers see to that.
    pub(crate) fn new(
        times_s: Vec<f64>,
        states: Vec<PosVel>,
        method: Method,
        window: usize,
    ) -> Option<Self> {
        let window = window.min(states.len());
        let legal = times_s.len() == states.len() && (1..=MAX_WINDOW).contains(&window);
        legal.then_some(Self { times_s, states, method, window, is_cut: false })
    }

    /// The same, but at the ends windows are cut to the states that are there, as SPICE does in types
    /// 18 and 19.
    pub(crate) const fn cut_at_ends(mut self) -> Self {
        self.is_cut = true;
        self
    }

    /// Times at which the window changes: at states for an even one, half-way for an odd one.
    pub(crate) fn joints_s(&self) -> Vec<f64> {
        if self.window.is_multiple_of(2) {
            return self.times_s.clone();
        }
        self.times_s.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect()
    }

    /// The state at `at_s`; beyond the ends the outermost window is continued.
    pub(crate) fn at(&self, at_s: f64) -> PosVel {
        let after = self.times_s.partition_point(|time| *time <= at_s);
        let range = if self.is_cut {
            cut_window(&self.times_s, after, at_s, self.window)
        } else {
            let first = window_start(&self.times_s, after, at_s, self.window);
            first..first + self.window
        };
        let (Some(times), Some(states)) = (self.times_s.get(range.clone()), self.states.get(range))
        else {
            return (Vector3::repeat(f64::NAN), Vector3::repeat(f64::NAN));
        };
        match self.method {
            Method::Lagrange => lagrange(times, states, at_s),
            Method::Hermite => hermite(times, states, at_s),
        }
    }
}

/// The window around `at_s`, cut at the ends, `after` the number of times at or before it.
fn cut_window(times_s: &[f64], after: usize, at_s: f64, window: usize) -> Range<usize> {
    let left = after.saturating_sub(1);
    let middle = if window.is_multiple_of(2) { left } else { nearest(times_s, left, at_s) };
    let before = window.div_ceil(2) - 1;
    let end = middle + window / 2 + 1;
    middle.saturating_sub(before)..end.min(times_s.len())
}

/// The index of the time nearest to `at_s`, of `left` and the one after it.
fn nearest(times_s: &[f64], left: usize, at_s: f64) -> usize {
    let nearer_right = match (times_s.get(left), times_s.get(left + 1)) {
        (Some(here), Some(next)) => next - at_s < at_s - here,
        _ => false,
    };
    left + usize::from(nearer_right)
}

/// First index of the window around `at_s`, `after` the number of times at or before it.
fn window_start(times_s: &[f64], after: usize, at_s: f64, window: usize) -> usize {
    let left = after.saturating_sub(1);
    if window.is_multiple_of(2) {
        return central_window(times_s.len(), left, window);
    }
    let nearest = nearest(times_s, left, at_s);
    nearest.saturating_sub(window / 2).min(times_s.len().saturating_sub(window))
}

fn lagrange(times: &[f64], states: &[PosVel], at_s: f64) -> PosVel {
    // Neville: p_i..j = ((t - t_i) p_i+1..j - (t - t_j) p_i..j-1) / (t_j - t_i).
    let mut work: Vec<PosVel> = states.to_vec();
    for order in 1..times.len() {
        for i in 0..times.len() - order {
            let (low, high) = (times[i], times[i + order]);
            let width = high - low;
            let (a, b) = ((high - at_s) / width, (at_s - low) / width);
            work[i] = (work[i].0 * a + work[i + 1].0 * b, work[i].1 * a + work[i + 1].1 * b);
        }
    }
    work[0]
}

fn hermite(times: &[f64], states: &[PosVel], at_s: f64) -> PosVel {
    // Time in units of half the window, from its middle: |x| <= 1 keeps the differences tame.
    let count = times.len();
    let (low, high) = (times[0], times[count - 1]);
    let scale = if count > 1 { (high - low) / 2.0 } else { 1.0 };
    let x = |time: f64| (time - (low + (high - low) / 2.0)) / scale;
    let node = |index: usize| x(times[index / 2]);
    // Divided differences on doubled nodes, in place: row r of column k ends at index r.
    let mut table: Vec<Vector3<f64>> = states.iter().flat_map(|s| [s.0, s.0]).collect();
    for order in 1..2 * count {
        for row in (order..2 * count).rev() {
            table[row] = if order == 1 && row % 2 == 1 {
                states[row / 2].1 * scale
            } else {
                (table[row] - table[row - 1]) / (node(row) - node(row - order))
            };
        }
    }
    let at = x(at_s);
    let (mut value, mut slope) = (table[2 * count - 1], Vector3::zeros());
    for row in (0..2 * count - 1).rev() {
        let step = at - node(row);
        slope = slope * step + value;
        value = value * step + table[row];
    }
    (value, slope / scale)
}

/// Lagrange weights of `times` at `time`, all in the same unit; they sum to one.
pub(crate) fn lagrange_weights<const N: usize>(times: &[f64], time: f64) -> [f64; N] {
    let mut weights = [0.0; N];
    for (i, weight) in weights.iter_mut().enumerate().take(times.len()) {
        let mut product = 1.0;
        for (j, other) in times.iter().enumerate() {
            if j != i {
                product *= (time - other) / (times[i] - other);
            }
        }
        *weight = product;
    }
    weights
}

/// First index of a window of `window` rows out of `count` with the interval after `left` central.
pub(crate) fn central_window(count: usize, left: usize, window: usize) -> usize {
    (left + 1).saturating_sub(window / 2).min(count.saturating_sub(window))
}

/// `count` times from `start_s` in equal steps.
pub(crate) fn equal_steps(start_s: f64, step_s: f64, count: usize) -> Vec<f64> {
    (0..count).map(|index| start_s + step_s * f64_from_usize(index)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quintic(t: f64) -> PosVel {
        let p = |t: f64| 3.0 - t + 0.5 * t.powi(3) - 0.01 * t.powi(5);
        let v = |t: f64| -1.0 + 1.5 * t.powi(2) - 0.05 * t.powi(4);
        (Vector3::new(p(t), 2.0 * p(t), -p(t)), Vector3::new(v(t), 2.0 * v(t), -v(t)))
    }

    #[test]
    fn polynomials_of_its_degree_come_back() {
        let times: Vec<f64> = [0.0, 0.7, 1.1, 2.0, 2.3, 3.1, 4.0, 4.2].to_vec();
        let states: Vec<PosVel> = times.iter().map(|t| quintic(*t)).collect();
        for (method, window) in [(Method::Hermite, 3), (Method::Hermite, 4), (Method::Lagrange, 6)]
        {
            let series = StateSeries::new(times.clone(), states.clone(), method, window).unwrap();
            for t in [0.0, 0.1, 0.7, 1.6, 2.0, 3.9, 4.2] {
                let ((p, v), (q, w)) = (series.at(t), quintic(t));
                assert!((p - q).norm() < 1e-12, "{method:?} {window} {t}");
                assert!((v - w).norm() < 2e-11, "{method:?} {window} {t} {v} {w}");
            }
        }
    }

    #[test]
    fn windows_are_centred() {
        let times = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let start = |t: f64, window| {
            let after = times.partition_point(|time| *time <= t);
            window_start(&times, after, t, window)
        };
        assert_eq!(start(2.4, 4), 1);
        assert_eq!(start(2.4, 3), 1);
        assert_eq!(start(2.6, 3), 2);
        assert_eq!((start(0.1, 4), start(4.9, 4), start(5.0, 4), start(-1.0, 3)), (0, 2, 2, 0));
    }

    #[test]
    fn one_state_is_a_line() {
        let series = StateSeries::new(vec![1.0], vec![quintic(1.0)], Method::Hermite, 4).unwrap();
        let (p, _) = series.at(1.5);
        assert!((p - quintic(1.0).0 - quintic(1.0).1 * 0.5).norm() < 1e-15);
    }
}
