//! A stand-in for the sky that is quick to evaluate.
//!
//! The search for the shortest table looks at a body some ten thousand times. A [`Master`] samples
//! the true direction once, as short Chebyshev pieces of fixed order, halved until their last
//! coefficients vanish, and answers from those.
//!
//! Limits: a smooth direction, once resolved, gains many digits per halving. Where two halvings in
//! turn gain less than a factor of four near the end, tabulated data is rough there; halving ends,
//! and the piece stands if its roughness is small against the tolerance.

use crate::chebyshev::{Transform, value};
use crate::convert::{f64_from_i64, i64_from_f64};
use nalgebra::Vector3;

/// Coefficients of a piece.
pub(super) const ORDERS: usize = 32;
/// Trailing coefficients that must vanish.
const TAIL: usize = 3;
/// Pieces are cut from this length, 128 d.
const LONGEST_NS: i64 = 128 * 86_400 * 1_000_000_000;
/// Shortest piece, and shortest granule of a table.
pub(super) const SHORTEST_NS: i64 = 60 * 1_000_000_000;
/// Most pieces: a low orbit of the Earth for three years takes half of them.
const MOST_PIECES: usize = 1 << 16;
/// Roughness is looked for below this multiple of the accuracy, and below this angle.
const ROUGH_SHARE: f64 = 1e6;
const ROUGH_RAD: f64 = 1e-6;
/// Share of the tolerance that may be roughness.
const NOISE_SHARE: f64 = 0.2;
/// Share of the tolerance, and least angle, that the sampling itself may miss.
const ACCURACY_SHARE: f64 = 0.02;
const ACCURACY_FLOOR_RAD: f64 = 1e-13;
/// A halving that gains less is slow, and this many in turn are rough.
const SLOW_GAIN: f64 = 4.0;
const SLOW_HALVINGS: u32 = 2;

struct Piece {
    start_ns: i64,
    length_ns: i64,
    series: Vec<Vector3<f64>>,
}

/// A direction over one span, by ns from the span's start.
pub(super) struct Master {
    pieces: Vec<Piece>,
}

/// Where the true direction would not become smooth.
pub(super) struct Rough {
    pub(super) at_ns: i64,
    pub(super) reached_rad: f64,
}

/// Why there is no master.
pub(super) enum MasterError<E> {
    Rough(Rough),
    Sample(E),
}

/// An interval that waits for its piece.
struct Interval {
    start_ns: i64,
    end_ns: i64,
    /// Tail of the interval it is half of.
    parent_tail: f64,
    /// Slow halvings in turn.
    slow: u32,
}

impl Master {
    /// Samples `truth` (by ns from the span's start) for a fit to `tolerance_rad`.
    pub(super) fn build<E>(
        transform: &Transform,
        truth: impl Fn(i64) -> Result<Vector3<f64>, E>,
        length_ns: i64,
        tolerance_rad: f64,
    ) -> Result<Self, MasterError<E>> {
        let accuracy_rad = (ACCURACY_SHARE * tolerance_rad).max(ACCURACY_FLOOR_RAD);
        let parts = (length_ns / LONGEST_NS) + 1;
        let edge = |part: i64| length_ns / parts * part + (length_ns % parts) * part / parts;
        let mut waiting: Vec<Interval> = (0..parts)
            .rev()
            .map(|part| Interval {
                start_ns: edge(part),
                end_ns: edge(part + 1),
                parent_tail: f64::INFINITY,
                slow: 0,
            })
            .collect();
        let mut pieces = Vec::new();
        while let Some(Interval { start_ns, end_ns, parent_tail, slow }) = waiting.pop() {
            let length_ns = end_ns - start_ns;
            let values = transform
                .nodes()
                .iter()
                .map(|x| truth(start_ns + i64_from_f64(f64_from_i64(length_ns) * (1.0 + x) / 2.0)))
                .collect::<Result<Vec<_>, E>>()
                .map_err(MasterError::Sample)?;
            let series = transform.series(&values);
            let tail = series.iter().skip(ORDERS - TAIL).map(Vector3::norm).fold(0.0, f64::max);
            if tail <= accuracy_rad {
                pieces.push(Piece { start_ns, length_ns, series });
                continue;
            }
            let near_the_end = tail < (ROUGH_SHARE * accuracy_rad).min(ROUGH_RAD);
            let is_slow = near_the_end && tail * SLOW_GAIN > parent_tail;
            let slow = if is_slow { slow + 1 } else { 0 };
            let many = pieces.len() + waiting.len() >= MOST_PIECES;
            if slow >= SLOW_HALVINGS && tail <= NOISE_SHARE * tolerance_rad {
                pieces.push(Piece { start_ns, length_ns, series });
                continue;
            }
            if slow >= SLOW_HALVINGS || length_ns / 2 < SHORTEST_NS || many {
                return Err(MasterError::Rough(Rough { at_ns: start_ns, reached_rad: tail }));
            }
            let middle = start_ns + length_ns / 2;
            let half = |start_ns, end_ns| Interval { start_ns, end_ns, parent_tail: tail, slow };
            waiting.push(half(middle, end_ns));
            waiting.push(half(start_ns, middle));
        }
        Ok(Self { pieces })
    }

    /// The direction `offset_ns` after the span's start; the outer pieces are continued.
    pub(super) fn at(&self, offset_ns: f64) -> Vector3<f64> {
        let after = self.pieces.partition_point(|piece| f64_from_i64(piece.start_ns) <= offset_ns);
        self.pieces.get(after.saturating_sub(1)).map_or(Vector3::zeros(), |piece| {
            let within = offset_ns - f64_from_i64(piece.start_ns);
            value(&piece.series, 2.0 * within / f64_from_i64(piece.length_ns) - 1.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turning(angle: f64) -> Vector3<f64> {
        Vector3::new(angle.cos(), angle.sin(), 0.0)
    }

    fn build(angle_of_day: impl Fn(f64) -> f64, tolerance_rad: f64) -> Option<Master> {
        let truth = |ns: i64| Ok::<_, ()>(turning(angle_of_day(f64_from_i64(ns) / 8.64e13)));
        let year_ns = 365 * 86_400 * 1_000_000_000;
        Master::build(&Transform::new(ORDERS), truth, year_ns, tolerance_rad).ok()
    }

    #[test]
    fn a_smooth_direction_comes_back() {
        let angle = |day: f64| 0.2 * day + 0.05 * (3.0 * day).sin();
        let master = build(angle, 1e-11).unwrap();
        for day in [0.0, 1.0, 77.7, 200.2, 365.0] {
            assert!((master.at(day * 8.64e13) - turning(angle(day))).norm() < 1e-12);
        }
    }

    #[test]
    fn roughness_ends_the_halving_unless_it_is_small() {
        // Hourly bends of 1e-9 rad, as a track rounded to its last digit has them.
        let rough = |day: f64| 0.01 * day + 1e-9 * (24.0 * day * core::f64::consts::PI).sin().abs();
        assert!(build(rough, 1e-12).is_none());
        let master = build(rough, 5e-8).unwrap();
        assert!((master.at(8.64e15) - turning(rough(100.0))).norm() < 5e-9);
        assert!(master.pieces.len() < 50);
    }
}
