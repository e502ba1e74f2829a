//! What the field of view can reach, and for how long it provably cannot.
//!
//! All answers are spans in seconds from the instant of a [`Sight`] during which no entry (or, when
//! inside, no exit) can happen. Each bound holds for any motion within the tables' bounds.

use super::edge::{
    Cap, Edge, Enlarged, closeness, crossing_free, newton, separation, tolerance, versine,
};
use super::sight::{Motion, Sight};
use crate::field_of_view::{Caps, FieldOfView, FieldShape};
use crate::rectangle::Rectangle;
use crate::sun::RelativeBounds;
use crate::trigonometry;
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use nalgebra::Vector3;

/// Slack in radians, or in a cosine, for rounding in the closed forms.
const ROUNDING: f64 = 1e-12;
/// Horizons tried by the precession gate, the longest first; each is an eighth of the one before.
const HORIZONS: usize = 3;
/// Margin in radians that the longest horizon may cost where the field of view is smaller.
const LONGEST_MARGIN_RAD: f64 = 4e-3;
/// Relative inflation of the bound on f'' for rounding.
const CURVATURE_ROUNDING: f64 = 1.0 + 1e-9;

/// Least and largest angle of a field's points from an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edges {
    pub(super) near: f64,
    pub(super) far: f64,
}

/// The precession gate's margins for one horizon.
#[derive(Debug, Clone, Copy)]
struct Horizon {
    seconds: f64,
    /// Cosine of the annulus' far edge, widened.
    cos_far: f64,
    /// Cosine of its near edge, widened.
    cos_near: f64,
}

/// One channel's field of view about the spin axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    centre: Vector3<f64>,
    edge: Edge,
    /// Radius of the circle that separations count from: 0, or an enlarged circle's own.
    core_rad: f64,
    /// A circle's radius, or an enlarged rectangle's margin.
    margin_rad: f64,
    gamma_min: f64,
    gamma_max: f64,
    horizons: [Horizon; HORIZONS],
    /// Half-width in azimuth about the spin axis; none where the field holds the axis.
    half_width: Option<f64>,
    bounds: RelativeBounds,
    /// Longest certified step of the last kind, s.
    longest_step: f64,
    /// Largest rate of delta, rad/s.
    delta_rate: f64,
}

impl Reach {
    /// Before a field of view is known.
    pub(super) const NOTHING: Self = {
        let zero = Vector3::new(0.0, 0.0, 0.0);
        let horizon = Horizon { seconds: 0.0, cos_far: 0.0, cos_near: 0.0 };
        Self {
            centre: zero,
            edge: Edge::Circle([Cap { axis: zero, sin_beta: 0.0, versine: 0.0, tolerance: 0.0 }]),
            core_rad: 0.0,
            margin_rad: 0.0,
            gamma_min: 0.0,
            gamma_max: 0.0,
            horizons: [horizon; HORIZONS],
            half_width: None,
            bounds: RelativeBounds { rate: 0.0, acceleration: 0.0 },
            longest_step: 0.0,
            delta_rate: 0.0,
        }
    };

    /// Takes up a field of view, in place.
    #[inline(never)]
    pub(super) fn set(&mut self, motion: &Motion, field: &FieldOfView, bounds: RelativeBounds) {
        self.bounds = bounds;
        self.centre = motion.scan.boresight_in_spin().rotate(field.centre().vector());
        let margin = field.margin_rad();
        (self.core_rad, self.margin_rad) = match field.shape() {
            FieldShape::Circle(radius) if margin > 0.0 => (radius, field.reach_rad()),
            FieldShape::Circle(_) => (0.0, field.reach_rad()),
            FieldShape::Rectangle(..) => (0.0, margin),
        };
        self.longest_step = TAU / 16.0 / (libm::fabs(motion.precession) + libm::fabs(motion.spin));
        self.delta_rate = libm::fabs(motion.precession) * motion.sin_alpha + bounds.rate;
        self.set_gates(motion, field.reach_rad());
        self.set_edge(motion, field);
    }

    #[inline(never)]
    fn set_gates(&mut self, motion: &Motion, reach: f64) {
        let sin_beta = libm::hypot(self.centre.x, self.centre.y);
        let beta = libm::atan2(sin_beta, self.centre.z);
        let alpha = motion.scan.parameters().alpha_rad;
        let rate = self.bounds.rate;
        let widest = libm::fmax(reach, LONGEST_MARGIN_RAD);
        let longest =
            libm::fmin(TAU / libm::fabs(motion.precession), libm::fmin(widest / rate, f64::MAX));
        for (horizon, share) in self.horizons.iter_mut().zip([1.0, 8.0, 64.0]) {
            let seconds = longest / share;
            let margin = rate * seconds + ROUNDING;
            let (near, far) = (beta - reach - margin, beta + reach + margin);
            horizon.seconds = seconds;
            horizon.cos_far = if far >= PI { -2.0 } else { trigonometry::cos(far) - ROUNDING };
            horizon.cos_near = if near <= 0.0 { 2.0 } else { trigonometry::cos(near) + ROUNDING };
        }
        self.gamma_min = libm::fabs(alpha - beta) - reach - ROUNDING;
        self.gamma_max = PI - libm::fabs(PI - alpha - beta) + reach + ROUNDING;
        let holds_axis = reach + ROUNDING >= beta || reach + ROUNDING >= PI - beta;
        self.half_width = (!holds_axis)
            .then(|| libm::asin(libm::fmin(trigonometry::sin(reach) / sin_beta, 1.0)) + ROUNDING);
    }

    fn set_edge(&mut self, motion: &Motion, field: &FieldOfView) {
        match field.shape() {
            FieldShape::Circle(_) => self.edge = Edge::Circle([self.circle(field.reach_rad())]),
            FieldShape::Rectangle(..) if field.margin_rad() > 0.0 => {
                self.set_enlarged(motion, field);
            }
            FieldShape::Rectangle(..) => self.set_sides(motion, field),
        }
    }

    #[inline(never)]
    fn circle(&self, reach: f64) -> Cap {
        Cap {
            axis: self.centre,
            sin_beta: libm::hypot(self.centre.x, self.centre.y),
            versine: versine(reach),
            tolerance: tolerance(reach),
        }
    }

    #[inline(never)]
    fn set_sides(&mut self, motion: &Motion, field: &FieldOfView) {
        let Caps::Rectangle(poles) = field.caps() else { return };
        let into_spin = motion.scan.boresight_in_spin();
        self.edge = Edge::Rectangle(poles.map(|pole| Cap::side(into_spin.rotate(pole))));
    }

    #[inline(never)]
    fn set_enlarged(&mut self, motion: &Motion, field: &FieldOfView) {
        let Some(rectangle) = field.rectangle_axes() else { return };
        let (reach, margin) = (field.reach_rad(), field.margin_rad());
        let centre = self.centre;
        let beta = libm::atan2(libm::hypot(centre.x, centre.y), centre.z);
        let into_spin = motion.scan.boresight_in_spin();
        self.edge = Edge::Enlarged(Enlarged {
            rectangle: Rectangle {
                x: into_spin.rotate(rectangle.x),
                y: into_spin.rotate(rectangle.y),
                z: centre,
                ..rectangle
            },
            sin_beta: largest_sine(beta, reach - margin),
            versine: versine(margin),
            tolerance: tolerance(margin),
        });
    }

    /// Whether the edge is made of sides, along which the separation from the centre differs.
    pub(super) const fn has_sides(&self) -> bool {
        matches!(self.edge, Edge::Rectangle(_))
    }

    /// The caps whose intersection the field is; none for an enlarged rectangle.
    fn caps(&self) -> &[Cap] {
        match &self.edge {
            Edge::Circle(caps) => caps,
            Edge::Rectangle(caps) => caps,
            Edge::Enlarged(_) => &[],
        }
    }

    /// Minus half the squared chord to the centre (of an enlarged rectangle, to its nearest point),
    /// and its derivative: largest when closest.
    pub(super) fn closeness(&self, sight: &Sight) -> (f64, f64) {
        match &self.edge {
            Edge::Enlarged(enlarged) => enlarged.closeness(sight),
            _ => closeness(&self.centre, sight),
        }
    }

    /// Separation in radians for a closeness: from the centre, of an enlarged field from the field
    /// as it was.
    #[inline(never)]
    pub(super) fn separation_rad(&self, closeness: f64) -> f64 {
        let chord = libm::sqrt(libm::fmax(-0.5 * closeness, 0.0));
        libm::fmax(2.0 * libm::asin(libm::fmin(chord, 1.0)) - self.core_rad, 0.0)
    }

    /// Largest second derivative of the closeness near the sight.
    #[inline(never)]
    pub(super) fn closeness_curvature(&self, motion: &Motion, sight: &Sight) -> f64 {
        let sin_beta = match &self.edge {
            Edge::Enlarged(enlarged) => enlarged.sin_beta,
            _ => libm::hypot(self.centre.x, self.centre.y),
        };
        self.curvature(motion, sight, sin_beta)
    }

    /// Whether the target is inside.
    #[inline(never)]
    pub(super) fn inside(&self, sight: &Sight) -> bool {
        match &self.edge {
            Edge::Enlarged(enlarged) => enlarged.depth(sight).0 >= 0.0,
            _ => self.caps().iter().all(|cap| cap.depth(sight).0 >= 0.0),
        }
    }

    /// Seconds back from a sight just inside to the entry, by one Newton step.
    #[inline(never)]
    pub(super) fn since_entry(&self, sight: &Sight) -> f64 {
        if let Edge::Enlarged(enlarged) = &self.edge {
            return newton(enlarged.depth(sight), 1.0);
        }
        // The last cap to be entered is the one entered most recently.
        let caps = self.caps().iter();
        caps.map(|cap| newton(cap.depth(sight), 1.0)).fold(f64::INFINITY, libm::fmin)
    }

    /// Seconds back from a sight just outside to the exit, by one Newton step.
    #[inline(never)]
    pub(super) fn since_exit(&self, sight: &Sight) -> f64 {
        if let Edge::Enlarged(enlarged) = &self.edge {
            return newton(enlarged.depth(sight), -1.0);
        }
        let left = self.caps().iter().filter(|cap| cap.depth(sight).0 < 0.0);
        left.map(|cap| newton(cap.depth(sight), -1.0)).fold(0.0, libm::fmax)
    }

    /// The gradient of f in w at the edge that is crossed, entered (`sense` 1) or left (-1).
    pub(super) fn crossed(&self, sight: &Sight, sense: f64) -> Vector3<f64> {
        if let Edge::Enlarged(enlarged) = &self.edge {
            return enlarged.rectangle.nearest(&sight.direction).unwrap_or(self.centre);
        }
        // Of the caps crossed in this sense the one whose edge is nearest in time.
        let mut least = f64::INFINITY;
        let mut axis = self.centre;
        for cap in self.caps() {
            let (depth, rate) = cap.depth(sight);
            let seconds = libm::fabs(depth / rate);
            if rate * sense > 0.0 && seconds < least {
                (least, axis) = (seconds, cap.axis);
            }
        }
        axis
    }

    /// The point that separations count from.
    pub(super) fn nearest(&self, sight: &Sight) -> Vector3<f64> {
        match &self.edge {
            Edge::Enlarged(enlarged) => {
                enlarged.rectangle.nearest(&sight.direction).unwrap_or(self.centre)
            }
            _ => self.centre,
        }
    }

    /// Least and largest angle of the field's points from an axis; 0 and pi where it holds the axis
    /// or its opposite.
    pub(super) fn edges_from(&self, axis: &Vector3<f64>) -> Edges {
        Edges { near: self.angle_to(axis), far: PI - self.angle_to(&-axis) }
    }

    /// Angle from a direction to the nearest point of the field, 0 inside.
    fn angle_to(&self, direction: &Vector3<f64>) -> f64 {
        let (point, margin) = match &self.edge {
            Edge::Circle(_) => (Some(self.centre), self.margin_rad),
            Edge::Rectangle([a, b, c, d]) => {
                let sides = [a.axis, b.axis, c.axis, d.axis];
                (Rectangle::from_sides(self.centre, sides).nearest(direction), 0.0)
            }
            Edge::Enlarged(enlarged) => (enlarged.rectangle.nearest(direction), self.margin_rad),
        };
        let apart = point.map_or(0.0, |point| separation(&point, direction));
        libm::fmax(apart - margin, 0.0)
    }

    /// Seconds without an exit, from a sight that is inside.
    #[inline(never)]
    pub(super) fn stays_inside(&self, motion: &Motion, sight: &Sight) -> f64 {
        let holds = |(depth, rate): (f64, f64), sin_beta: f64, tolerance: f64| {
            crossing_free(
                -libm::fmax(depth, 0.0),
                -rate,
                self.curvature(motion, sight, sin_beta),
                tolerance,
            )
        };
        if let Edge::Enlarged(enlarged) = &self.edge {
            // Inside while the point that is nearest now stays within the margin.
            let seconds = holds(enlarged.depth(sight), enlarged.sin_beta, enlarged.tolerance);
            return libm::fmin(seconds, self.longest_step);
        }
        let caps = self.caps().iter();
        caps.map(|cap| holds(cap.depth(sight), cap.sin_beta, cap.tolerance))
            .fold(self.longest_step, libm::fmin)
    }

    /// Seconds without an entry, from a sight that is outside.
    #[inline(never)]
    pub(super) fn stays_outside(&self, motion: &Motion, sight: &Sight) -> f64 {
        let gamma = libm::atan2(sight.sin_gamma, sight.cos_gamma);
        let short = libm::fmax(self.gamma_min - gamma, gamma - self.gamma_max);
        if short > 0.0 {
            return short / self.bounds.rate;
        }
        // A gate alone would creep up to its edge in ever smaller steps: near it, the bound on f''
        // takes over, since most passages of an edge are no transits.
        let mut wait = 0.0;
        for horizon in &self.horizons {
            wait = precession_gate(motion, sight, horizon, 0.0);
            if wait > 0.0 {
                break;
            }
        }
        if wait < self.longest_step {
            wait = libm::fmax(wait, self.spin_gate(motion, sight));
            if wait >= self.longest_step {
                let [longest, ..] = &self.horizons;
                wait = precession_gate(motion, sight, longest, wait);
            }
        }
        if wait < self.longest_step {
            wait = libm::fmax(wait, self.approach(motion, sight));
        }
        wait
    }

    /// Seconds until the field's azimuth about the spin axis can match the target's.
    #[inline(never)]
    fn spin_gate(&self, motion: &Motion, sight: &Sight) -> f64 {
        let Some(half_width) = self.half_width else { return 0.0 };
        let (e, w) = (self.centre, sight.direction);
        let azimuth = libm::atan2(e.x * w.y - e.y * w.x, e.x * w.x + e.y * w.y);
        if libm::fabs(azimuth) <= half_width {
            return 0.0;
        }
        // Over the horizon delta stays within half its distance from the nearer pole.
        let delta = libm::atan2(sight.sin_delta, sight.cos_delta);
        let pole = libm::fmin(delta, PI - delta);
        let mean = motion.spin + motion.precession * motion.cos_alpha;
        let horizon = libm::fmin(
            TAU / (libm::fabs(motion.spin) + libm::fabs(motion.precession)),
            0.5 * pole / self.delta_rate,
        );
        let closest_to_pole = pole - self.delta_rate * horizon;
        let (sin, cos) = trigonometry::sin_cos(closest_to_pole);
        let spread = (libm::fabs(motion.precession) * motion.sin_alpha * libm::fabs(cos)
            + self.bounds.rate)
            / libm::fmax(sin, ROUNDING);
        // azimuth' lies in -mean +- spread.
        let ahead = if libm::fabs(mean) > spread {
            let along = if mean < 0.0 { azimuth } else { -azimuth };
            if along < 0.0 { -along - half_width } else { TAU - along - half_width }
        } else {
            libm::fabs(azimuth) - half_width
        };
        libm::fmin(ahead / (libm::fabs(mean) + spread), horizon)
    }

    /// Seconds without an entry by the bound on f''.
    #[inline(never)]
    fn approach(&self, motion: &Motion, sight: &Sight) -> f64 {
        if let Edge::Enlarged(enlarged) = &self.edge {
            let curvature = self.curvature(motion, sight, enlarged.sin_beta);
            return enlarged.stays_outside(sight, curvature, self.longest_step);
        }
        let mut longest = 0.0;
        for cap in self.caps() {
            let (depth, rate) = cap.depth(sight);
            if depth < 0.0 {
                let curvature = self.curvature(motion, sight, cap.sin_beta);
                longest = libm::fmax(longest, crossing_free(depth, rate, curvature, cap.tolerance));
            }
        }
        libm::fmin(longest, self.longest_step)
    }

    /// Bound on |f''| for an axis at `sin_beta` from the spin axis, over the longest step.
    ///
    /// `n'' = w_a^2 z x (z x n) + 2 w_a w_b z x (s x n) + w_b^2 s x (s x n)`, projected on the target:
    /// at most `w_a^2 sin gamma + 2 |w_a w_b| sin gamma sin beta + w_b^2 sin delta sin beta`; the
    /// target's own motion adds `2 |n'| rate + acceleration`.
    #[inline(never)]
    fn curvature(&self, motion: &Motion, sight: &Sight, sin_beta: f64) -> f64 {
        let (a, b) = (libm::fabs(motion.precession), libm::fabs(motion.spin));
        let sin_gamma = libm::fmin(sight.sin_gamma + self.bounds.rate * self.longest_step, 1.0);
        let sin_delta = libm::fmin(sight.sin_delta + self.delta_rate * self.longest_step, 1.0);
        let scan =
            a * a * sin_gamma + 2.0 * a * b * sin_gamma * sin_beta + b * b * sin_delta * sin_beta;
        let drift = 2.0 * (b * sin_beta + a) * self.bounds.rate + self.bounds.acceleration;
        (scan + drift) * CURVATURE_ROUNDING
    }
}

/// Largest sine of the angles within `reach` of `beta`.
fn largest_sine(beta: f64, reach: f64) -> f64 {
    if libm::fabs(beta - FRAC_PI_2) <= reach {
        return 1.0;
    }
    libm::fmax(trigonometry::sin(beta - reach), trigonometry::sin(beta + reach))
}

/// Seconds, not less than `from`, until the target's angle from the spin axis can be within the
/// field's annulus.
///
/// `cos delta = cos alpha cos gamma + sin alpha sin gamma cos x`, x the precession phase from the
/// target's azimuth; gamma and the azimuth move by less than the horizon's margin.
fn precession_gate(motion: &Motion, sight: &Sight, horizon: &Horizon, from: f64) -> f64 {
    let mean = motion.cos_alpha * sight.cos_gamma;
    let swing = motion.sin_alpha * sight.sin_gamma;
    if from >= horizon.seconds {
        return from;
    }
    if mean + swing < horizon.cos_far || mean - swing > horizon.cos_near {
        return horizon.seconds;
    }
    if swing < ROUNDING {
        return from;
    }
    let outer = libm::acos((horizon.cos_far - mean).max(-swing).min(swing) / swing);
    let inner = libm::acos((horizon.cos_near - mean).max(-swing).min(swing) / swing);
    let (east, north) = sight.precessed;
    let turned = libm::fabs(motion.precession) * from;
    let now = libm::atan2(libm::copysign(north, -north * motion.precession), east) + turned;
    let x = now - TAU * libm::round(now / TAU);
    let ahead = if x < -outer {
        -outer - x
    } else if x <= -inner {
        0.0
    } else if x < inner {
        inner - x
    } else if x <= outer {
        0.0
    } else {
        TAU - outer - x
    };
    let wait = from + libm::fmax(ahead - ROUNDING, 0.0) / libm::fabs(motion.precession);
    libm::fmin(wait, horizon.seconds)
}
