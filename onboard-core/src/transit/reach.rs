//! What the field of view can reach, and for how long it provably cannot.
//!
//! All answers are spans in seconds from the instant of a [`Sight`] during which no entry (or, when
//! inside, no exit) can happen: the longest that one of the gates gives. Each gate has its equation,
//! bound and proof at its head (`anti_sun_gate.rs`, `precession_gate.rs`, `spin_gate.rs`; the bound on
//! f'' in `rates.rs`, what follows from it in `edge.rs`), and holds for any motion within the tables'
//! bounds. That each is longest somewhere only makes the search fast; none changes its result.

use super::anti_sun_gate::AntiSunGate;
use super::edge::{
    Cap, Edge, Enlarged, closeness, crossing_free, newton, separation, tolerance, versine,
};
use super::precession_gate::PrecessionGate;
use super::rates::Rates;
use super::sight::{Motion, Sight};
use super::spin_gate::SpinGate;
use crate::field_of_view::{Caps, FieldOfView, FieldShape};
use crate::rectangle::Rectangle;
use crate::sun::RelativeBounds;
use crate::trigonometry;
use crate::vector::negated;
use core::f64::consts::{FRAC_PI_2, PI};
use nalgebra::Vector3;

/// Least and largest angle of a field's points from an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edges {
    pub(super) near: f64,
    pub(super) far: f64,
}

/// One channel's field of view about the spin axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    pub(super) centre: Vector3<f64>,
    edge: Edge,
    /// Radius of the circle that separations count from: 0, or an enlarged circle's own.
    core_rad: f64,
    /// A circle's radius, or an enlarged rectangle's margin.
    margin_rad: f64,
    anti_sun: AntiSunGate,
    precession: PrecessionGate,
    spin: SpinGate,
    rates: Rates,
}

impl Reach {
    /// Before a field of view is known.
    pub(super) const NOTHING: Self = {
        let zero = Vector3::new(0.0, 0.0, 0.0);
        Self {
            centre: zero,
            edge: Edge::Circle([Cap::NOTHING]),
            core_rad: 0.0,
            margin_rad: 0.0,
            anti_sun: AntiSunGate::NOTHING,
            precession: PrecessionGate::NOTHING,
            spin: SpinGate::NOTHING,
            rates: Rates::NOTHING,
        }
    };

    /// Takes up a field of view, in place.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn set(&mut self, motion: &Motion, field: &FieldOfView, bounds: RelativeBounds) {
        self.rates = Rates::new(motion, bounds);
        self.centre = motion.scan.boresight_in_spin().rotate(field.centre().vector());
        let margin = field.margin_rad();
        (self.core_rad, self.margin_rad) = match field.shape() {
            FieldShape::Circle(radius) if margin > 0.0 => (radius, field.reach_rad()),
            FieldShape::Circle(_) => (0.0, field.reach_rad()),
            FieldShape::Rectangle { .. } => (0.0, margin),
        };
        self.set_gates(motion, field.reach_rad());
        self.set_edge(motion, field);
    }

    #[cfg_attr(target_os = "none", inline(never))]
    fn set_gates(&mut self, motion: &Motion, reach: f64) {
        let sin_beta = libm::hypot(self.centre.x, self.centre.y);
        let beta = libm::atan2(sin_beta, self.centre.z);
        self.precession.set(motion, (beta, reach), self.rates.target.rate);
        self.anti_sun = AntiSunGate::new(motion.scan.parameters().alpha_rad, beta, reach);
        self.spin = SpinGate::new((sin_beta, beta), reach);
    }

    fn set_edge(&mut self, motion: &Motion, field: &FieldOfView) {
        match field.shape() {
            FieldShape::Circle(_) => self.edge = Edge::Circle([self.circle(field.reach_rad())]),
            FieldShape::Rectangle { .. } if field.margin_rad() > 0.0 => {
                self.set_enlarged(motion, field);
            }
            FieldShape::Rectangle { .. } => self.set_sides(motion, field),
        }
    }

    #[cfg_attr(target_os = "none", inline(never))]
    fn circle(&self, reach: f64) -> Cap {
        Cap {
            axis: self.centre,
            sin_beta: libm::hypot(self.centre.x, self.centre.y),
            versine: versine(reach),
            tolerance: tolerance(reach),
        }
    }

    #[cfg_attr(target_os = "none", inline(never))]
    fn set_sides(&mut self, motion: &Motion, field: &FieldOfView) {
        let Caps::Rectangle(poles) = field.caps() else { return };
        let into_spin = motion.scan.boresight_in_spin();
        self.edge = Edge::Rectangle([Cap::NOTHING; 4]);
        if let Edge::Rectangle(sides) = &mut self.edge {
            for (side, pole) in sides.iter_mut().zip(poles) {
                side.set_side(into_spin, pole);
            }
        }
    }

    #[cfg_attr(target_os = "none", inline(never))]
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
    #[cfg_attr(target_os = "none", inline(never))]
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
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn separation_rad(&self, closeness: f64) -> f64 {
        let chord = libm::sqrt(libm::fmax(-0.5 * closeness, 0.0));
        libm::fmax(2.0 * libm::asin(libm::fmin(chord, 1.0)) - self.core_rad, 0.0)
    }

    /// Largest second derivative of the closeness near the sight.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn closeness_curvature(&self, motion: &Motion, sight: &Sight) -> f64 {
        let sin_beta = match &self.edge {
            Edge::Enlarged(enlarged) => enlarged.sin_beta,
            _ => libm::hypot(self.centre.x, self.centre.y),
        };
        self.rates.curvature(motion, sight, sin_beta)
    }

    /// Whether the target is inside.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn inside(&self, sight: &Sight) -> bool {
        match &self.edge {
            Edge::Enlarged(enlarged) => enlarged.depth(sight).0 >= 0.0,
            Edge::Circle([cap]) => cap.depth(sight).0 >= 0.0,
            Edge::Rectangle(_) => self.caps().iter().all(|cap| cap.depth(sight).0 >= 0.0),
        }
    }

    /// Seconds back from a sight just inside to the entry, by one Newton step.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn since_entry(&self, sight: &Sight) -> f64 {
        if let Edge::Enlarged(enlarged) = &self.edge {
            return newton(enlarged.depth(sight), 1.0);
        }
        // The last cap to be entered is the one entered most recently.
        let caps = self.caps().iter();
        caps.map(|cap| newton(cap.depth(sight), 1.0)).fold(f64::INFINITY, libm::fmin)
    }

    /// Seconds back from a sight just outside to the exit, by one Newton step.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn since_exit(&self, sight: &Sight) -> f64 {
        if let Edge::Enlarged(enlarged) = &self.edge {
            return newton(enlarged.depth(sight), -1.0);
        }
        let left = self.caps().iter().filter(|cap| cap.depth(sight).0 < 0.0);
        left.map(|cap| newton(cap.depth(sight), -1.0)).fold(0.0, libm::fmax)
    }

    /// The gradient of f in w at the edge that is crossed, entered (`sense` 1) or left (-1).
    #[cfg_attr(target_os = "none", inline(never))]
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
    #[cfg_attr(target_os = "none", inline(never))]
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
        Edges { near: self.angle_to(axis), far: PI - self.angle_to(&negated(*axis)) }
    }

    /// Angle from a direction to the nearest point of the field, 0 inside.
    #[cfg_attr(target_os = "none", inline(never))]
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
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn stays_inside(&self, motion: &Motion, sight: &Sight) -> f64 {
        let holds = |(depth, rate): (f64, f64), sin_beta: f64, tolerance: f64| {
            crossing_free(
                -libm::fmax(depth, 0.0),
                -rate,
                self.rates.curvature(motion, sight, sin_beta),
                tolerance,
            )
        };
        if let Edge::Enlarged(enlarged) = &self.edge {
            // Inside while the point that is nearest now stays within the margin.
            let seconds = holds(enlarged.depth(sight), enlarged.sin_beta, enlarged.tolerance);
            return libm::fmin(seconds, self.rates.longest_step_s);
        }
        let caps = self.caps().iter();
        caps.map(|cap| holds(cap.depth(sight), cap.sin_beta, cap.tolerance))
            .fold(self.rates.longest_step_s, libm::fmin)
    }

    /// Seconds without an entry, from a sight that is outside.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn stays_outside(&self, motion: &Motion, sight: &Sight) -> f64 {
        let seconds = self.anti_sun.seconds(sight, self.rates.target.rate);
        if seconds > 0.0 {
            return seconds;
        }
        // A gate alone would creep up to its edge in ever smaller steps: near it, the bound on f''
        // takes over, since most passages of an edge are no transits.
        let longest_step = self.rates.longest_step_s;
        let mut wait = self.precession.seconds(motion, sight);
        if wait < longest_step {
            let turning = self.spin.seconds(motion, sight, (&self.centre, &self.rates));
            wait = libm::fmax(wait, turning);
            if wait >= longest_step {
                wait = self.precession.seconds_from(motion, sight, wait);
            }
        }
        if wait < longest_step {
            wait = libm::fmax(wait, self.approach(motion, sight));
        }
        wait
    }

    /// Seconds without an entry by the bound on f''.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn approach(&self, motion: &Motion, sight: &Sight) -> f64 {
        if let Edge::Enlarged(enlarged) = &self.edge {
            let curvature = self.rates.curvature(motion, sight, enlarged.sin_beta);
            return enlarged.stays_outside(sight, curvature, self.rates.longest_step_s);
        }
        let mut longest = 0.0;
        for cap in self.caps() {
            let (depth, rate) = cap.depth(sight);
            if depth < 0.0 {
                let curvature = self.rates.curvature(motion, sight, cap.sin_beta);
                longest = libm::fmax(longest, crossing_free(depth, rate, curvature, cap.tolerance));
            }
        }
        libm::fmin(longest, self.rates.longest_step_s)
    }
}

/// Largest sine of the angles within `reach` of `beta`.
fn largest_sine(beta: f64, reach: f64) -> f64 {
    if libm::fabs(beta - FRAC_PI_2) <= reach {
        return 1.0;
    }
    libm::fmax(trigonometry::sin(beta - reach), trigonometry::sin(beta + reach))
}
