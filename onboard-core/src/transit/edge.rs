//! The edge of a field of view: the caps that bound it, or a rectangle with a margin.
//!
//! f is positive inside: `cos(separation) - cos r` of a cap; of an enlarged rectangle, the largest of
//! its points'. Each answer holds for any motion whose f'' stays within the curvature M given.
//!
//! | equation | bound |
//! |---|---|
//! | `f(h) <= f + f' h + M h^2 / 2` | no crossing before the root of the right side, [`crossing_free`] |
//! | the same for each point of a rectangle with a margin, the largest of them | [`Enlarged::stays_outside`] |
//!
//! Proof: Taylor's formula with the remainder at its largest. The right side is a parabola that opens
//! upwards and is at most 0 at h = 0, so it has one root ahead. Of an enlarged rectangle, f is the
//! largest over its points of functions with that bound, so the largest of the bounds bounds it.
//!
//! Requirements: REQ-TRANSIT-2.

use super::SEPARATION_TOLERANCE_RAD;
use super::sight::Sight;
use crate::convert::uncounted;
use crate::frame::{Boresight, Spin};
use crate::rectangle::Rectangle;
use crate::rotation::Rotation;
use crate::trigonometry;
use crate::vector::{cross, dot, minus, plus, times, vector};
use core::f64::consts::FRAC_PI_2;
use nalgebra::Vector3;

/// Slack in radians, or in a cosine, for rounding in the closed forms of the gates.
pub(super) const ROUNDING: f64 = 1e-12;
/// Refinements of the certified step towards an enlarged rectangle.
const CHORDS: usize = 6;

/// A cap `e . w >= cos r`, with its tolerance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cap {
    pub(super) axis: Vector3<f64>,
    /// Sine of the axis' angle from the spin axis.
    pub(super) sin_beta: f64,
    /// `1 - cos r`.
    pub(super) versine: f64,
    /// Depth in f below which a crossing may go either way.
    pub(super) tolerance: f64,
}

/// The field of view's edge.
#[derive(Debug, Clone, Copy)]
pub(super) enum Edge {
    Circle([Cap; 1]),
    Rectangle([Cap; 4]),
    Enlarged(Enlarged),
}

/// A rectangle and all within a margin m of it: `f = max over its points p of p . w - cos m`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Enlarged {
    pub(super) rectangle: Rectangle,
    /// Largest sine of its points' angles from the spin axis.
    pub(super) sin_beta: f64,
    /// `1 - cos m`.
    pub(super) versine: f64,
    /// Depth in f below which a crossing may go either way.
    pub(super) tolerance: f64,
}

impl Cap {
    /// Before a field of view is known.
    pub(super) const NOTHING: Self =
        Self { axis: vector(0.0, 0.0, 0.0), sin_beta: 0.0, versine: 0.0, tolerance: 0.0 };

    /// Becomes a side of a rectangle, by the pole of its great circle.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn set_side(&mut self, into_spin: Rotation<Boresight, Spin>, pole: &Vector3<f64>) {
        self.axis = into_spin.rotate(*pole);
        self.sin_beta = libm::hypot(self.axis.x, self.axis.y);
        self.versine = 1.0;
        self.tolerance = tolerance(FRAC_PI_2);
    }

    /// f = cos(separation) - cos r, and its derivative.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn depth(&self, sight: &Sight) -> (f64, f64) {
        let (closeness, rate) = closeness(&self.axis, sight);
        (self.versine + closeness, rate)
    }
}

impl Enlarged {
    /// `max p . w - 1`, and its derivative.
    pub(super) fn closeness(&self, sight: &Sight) -> (f64, f64) {
        self.rectangle
            .nearest(&sight.direction)
            .map_or((0.0, 0.0), |point| closeness(&point, sight))
    }

    /// f and its derivative.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn depth(&self, sight: &Sight) -> (f64, f64) {
        let (closeness, rate) = self.closeness(sight);
        (self.versine + closeness, rate)
    }

    /// Seconds without an entry by the bound on every point's f'', at most `longest`.
    ///
    /// After h seconds no point's `p . w` exceeds `p . (w + w' h) + M h^2/2`; the largest over all
    /// points, [`Self::ahead`], is convex in h. The point that is nearest now bounds its root from
    /// above; between a point below and one above the root, a chord's root lies below it and a
    /// tangent's above.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn stays_outside(&self, sight: &Sight, curvature: f64, longest: f64) -> f64 {
        let (depth, rate) = self.depth(sight);
        if depth >= 0.0 {
            return 0.0;
        }
        let (mut low, mut f_low) = (0.0, depth - self.tolerance);
        let mut high = libm::fmin(crossing_free(depth, rate, curvature, self.tolerance), longest);
        for _ in 0..uncounted(CHORDS) {
            let (f_high, slope) = self.ahead(sight, curvature, high);
            if f_high <= 0.0 {
                return high;
            }
            let chord = low - f_low * (high - low) / (f_high - f_low);
            let (f_chord, _) = self.ahead(sight, curvature, chord);
            high -= f_high / slope;
            if !(f_chord <= 0.0 && low < chord && chord < high) {
                break;
            }
            (low, f_low) = (chord, f_chord);
        }
        low
    }

    /// The bound on f after `seconds`, less the tolerance, and its slope.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn ahead(&self, sight: &Sight, curvature: f64, seconds: f64) -> (f64, f64) {
        let there = plus(sight.direction, times(sight.rate, seconds));
        let moved = seconds * seconds * squared(&sight.rate);
        let bend = 0.5 * curvature * seconds * seconds - self.tolerance;
        let Some(point) = self.rectangle.nearest(&there) else {
            // The largest p . u is |u|.
            let length = libm::sqrt(1.0 + moved);
            let slope = seconds * squared(&sight.rate) / length + curvature * seconds;
            return (self.versine + moved / (1.0 + length) + bend, slope);
        };
        // p . u - 1 from the chord: |u|^2 = 1 + |w'|^2 h^2.
        let off = minus(point, there);
        let along = dot(point, sight.rate);
        let value = self.versine - 0.5 * squared(&off) + 0.5 * moved + bend;
        (value, along + curvature * seconds)
    }
}

/// Seconds back to f = 0 where f' has the sign given; 0 or infinity where Newton cannot tell.
#[cfg_attr(target_os = "none", inline(never))]
pub(super) fn newton((depth, rate): (f64, f64), sense: f64) -> f64 {
    if rate * sense > 0.0 {
        libm::fmax(depth / rate, 0.0)
    } else if sense > 0.0 {
        f64::INFINITY
    } else {
        0.0
    }
}

/// Angle between two unit vectors.
#[cfg_attr(target_os = "none", inline(never))]
pub(super) fn separation(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    let across = cross(*a, *b);
    libm::atan2(libm::sqrt(squared(&across)), dot(*a, *b))
}

pub(super) fn squared(v: &Vector3<f64>) -> f64 {
    dot(*v, *v)
}

/// `e . w - 1` from the chord, so that small separations keep their digits, and its derivative.
#[cfg_attr(target_os = "none", inline(never))]
pub(super) fn closeness(axis: &Vector3<f64>, sight: &Sight) -> (f64, f64) {
    let chord = minus(*axis, sight.direction);
    (-0.5 * squared(&chord), dot(chord, sight.rate))
}

/// `1 - cos r`.
pub(super) fn versine(radius: f64) -> f64 {
    let sin = trigonometry::sin(0.5 * radius);
    2.0 * sin * sin
}

/// The separation tolerance expressed in f, with a floor for rounding.
#[cfg_attr(target_os = "none", inline(never))]
pub(super) fn tolerance(radius: f64) -> f64 {
    SEPARATION_TOLERANCE_RAD * libm::fabs(trigonometry::sin(radius)) + 2e-15 * versine(radius)
}

/// Seconds h up to which `f + f' h + M h^2/2` stays below `tolerance`, for f <= 0.
#[cfg_attr(target_os = "none", inline(never))]
pub(super) fn crossing_free(f: f64, rate: f64, curvature: f64, tolerance: f64) -> f64 {
    let missing = tolerance - f;
    let root = libm::sqrt(rate * rate + 2.0 * curvature * missing);
    // Two forms of the same root, each without cancellation.
    if rate >= 0.0 { 2.0 * missing / (rate + root) } else { (root - rate) / curvature }
}

#[cfg(test)]
mod tests {
    use super::super::cases::{Case, noise};
    use super::*;

    #[test]
    fn nothing_crosses_before_the_parabolas_root() {
        let mut longest = 0.0_f64;
        for index in 0..2_000 {
            let number = |k: u64| noise(index * 8 + k);
            let (f, rate) = (-number(0) * number(1), 2.0 * number(2) - 1.0);
            let (curvature, slack) = (0.1 + number(3), 1e-9 * number(4));
            let seconds = crossing_free(f, rate, curvature, slack);
            let parabola = |h: f64| f + rate * h + 0.5 * curvature * h * h;
            for share in [0.0, 0.1, 0.5, 0.9, 1.0] {
                assert!(parabola(share * seconds) <= slack + 1e-12);
            }
            longest = longest.max(libm::fabs(parabola(seconds) - slack));
        }
        assert!(longest < 1e-12, "{longest:e}");
    }

    #[test]
    // REQ-TRANSIT-2.
    fn nothing_crosses_within_a_certified_step() {
        let (mut inside, mut outside) = (0, 0);
        for case in Case::many(6_000) {
            let reach = case.reach();
            let t = noise(11) * 50.0;
            let sight = case.sight(t);
            let now = reach.inside(&sight);
            let seconds = if now {
                inside += 1;
                reach.stays_inside(&case.motion, &sight)
            } else {
                outside += 1;
                reach.approach(&case.motion, &sight)
            };
            for k in 0..50 {
                // Up to the edge, which may go either way.
                let there = case.sight(t + 0.9999 * seconds * f64::from(k) / 49.0);
                assert_eq!(reach.inside(&there), now, "{case:?} at {t} for {seconds}");
            }
        }
        assert!(inside > 40 && outside > 1_000, "{inside} {outside}");
    }

    #[test]
    fn depths_and_their_rates_are_derivatives_of_each_other() {
        for case in Case::many(500) {
            let (reach, t, h) = (case.reach(), noise(12) * 50.0, 1e-6);
            let at = |t: f64| reach.closeness(&case.sight(t));
            let slope = (at(t + h).0 - at(t - h).0) / (2.0 * h);
            assert!((slope - at(t).1).abs() < 1e-6, "{slope} {}", at(t).1);
        }
    }

    /// A direction and its rate, in the frame of the rectangle's own axes.
    fn moving(direction: Vector3<f64>, rate: Vector3<f64>) -> Sight {
        let direction = direction.normalize();
        Sight {
            cos_gamma: 0.0,
            sin_gamma: 0.0,
            precessed: (0.0, 0.0),
            cos_delta: 0.0,
            sin_delta: 0.0,
            direction,
            rate: rate - direction * direction.dot(&rate),
        }
    }

    /// An enlarged rectangle, and a target that moves somewhere near it.
    fn beside(index: u64) -> (Enlarged, Sight) {
        let number = |k: u64| noise(index * 16 + k + 77);
        let signed = |k: u64| 2.0 * number(k) - 1.0;
        let sides = [0.1 + 0.4 * number(0), 0.1 + 0.4 * number(1)];
        let [height, width] = sides.map(|side| libm::sincos(0.5 * side));
        let margin = 0.02 + 0.5 * number(2) * number(3);
        let enlarged = Enlarged {
            rectangle: Rectangle {
                x: Vector3::x(),
                y: Vector3::y(),
                z: Vector3::z(),
                height,
                width,
            },
            sin_beta: 1.0,
            versine: versine(margin),
            tolerance: tolerance(margin),
        };
        let direction = Vector3::new(1.5 * signed(4), 1.5 * signed(5), 1.0);
        let towards = Vector3::new(signed(6), signed(7), signed(8)) - direction * number(9);
        (enlarged, moving(direction, towards * number(10)))
    }

    /// Largest `p . u` over a grid of the rectangle's points.
    fn largest(rectangle: &Rectangle, u: &Vector3<f64>) -> f64 {
        let [tan_h, tan_w] = [rectangle.height, rectangle.width].map(|(sin, cos)| sin / cos);
        let shares = || (-30..=30_i8).map(|k| f64::from(k) / 30.0);
        shares()
            .flat_map(|x| shares().map(move |y| (x, y)))
            .map(|(x, y)| Vector3::new(x * tan_h, y * tan_w, 1.0).normalize().dot(u))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn what_lies_ahead_is_the_largest_over_all_points() {
        let (mut within, curvature) = (0, 0.3);
        for index in 0..600 {
            let (enlarged, sight) = beside(index);
            for seconds in [0.0, 0.2, 0.7, 1.5, 3.0] {
                let u = sight.direction + sight.rate * seconds;
                let (value, slope) = enlarged.ahead(&sight, curvature, seconds);
                let points = largest(&enlarged.rectangle, &u) - 1.0 + enlarged.versine;
                let expected = points + 0.5 * curvature * seconds * seconds - enlarged.tolerance;
                // The grid's points stand 0.01 rad apart.
                let off = value - expected;
                assert!(off > -1e-12 && off < 5e-5 * u.norm(), "{index} {seconds}: {off:e}");
                let at = |t: f64| enlarged.ahead(&sight, curvature, t).0;
                let numeric = (at(seconds + 1e-6) - at(seconds - 1e-6)) / 2e-6;
                assert!((slope - numeric).abs() < 1e-5, "{index} {seconds}: {slope} {numeric}");
                within += usize::from(enlarged.rectangle.nearest(&u).is_none());
            }
        }
        assert!(within > 20, "{within}");
    }

    #[test]
    // REQ-TRANSIT-2.
    fn a_certified_step_reaches_nearly_to_the_bound() {
        let (mut outside, mut tight) = (0, 0);
        for index in 0..2_000 {
            let (enlarged, sight) = beside(index);
            let (curvature, longest) = (0.3, 2.0);
            let seconds = enlarged.stays_outside(&sight, curvature, longest);
            if enlarged.depth(&sight).0 >= 0.0 {
                assert!(seconds <= 0.0);
                continue;
            }
            let at = |t: f64| enlarged.ahead(&sight, curvature, t).0;
            // The convex bound's root, by bisection.
            let (mut low, mut high) = (0.0, longest);
            while at(longest) > 0.0 && high - low > 1e-12 {
                let middle = 0.5 * (low + high);
                *(if at(middle) > 0.0 { &mut high } else { &mut low }) = middle;
            }
            assert!(seconds <= high + 1e-9, "{index}: {seconds} of {high}");
            outside += 1;
            tight += usize::from(seconds > 0.99 * high);
        }
        assert!(outside > 1_500 && 100 * tight > 89 * outside, "{tight} of {outside}");
    }
}
