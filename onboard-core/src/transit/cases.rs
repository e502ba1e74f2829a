//! Strategies, fields and tracks without a pattern, the same in every run, to hold the gates to.
//!
//! A track turns about a fixed axis by `angle(t) = amplitude sin(frequency t)`, so that its rate is at
//! most `amplitude frequency` and its second derivative at most that squared plus
//! `amplitude frequency^2`. Times are seconds, strategies turn in a minute or so.

use super::rates::Rates;
use super::reach::Reach;
use super::sight::{Motion, Seen, Sight};
use crate::convert::f64_from_u64;
use crate::direction::{Direction, DirectionState};
use crate::field_of_view::FieldOfView;
use crate::frame::{Boresight, Telescope};
use crate::phase::{Phase, Rotor, TurnRate};
use crate::rotation::Rotation;
use crate::scan::{ScanParameters, ScanStrategy};
use crate::sun::RelativeBounds;
use crate::time::Instant;
use core::f64::consts::{PI, TAU};
use nalgebra::{Rotation3, Unit, Vector3};

/// A strategy, a field of view and a target.
#[derive(Debug, Clone, Copy)]
pub(super) struct Case {
    pub(super) motion: Motion,
    pub(super) field: FieldOfView,
    /// Angle of the field's centre from the spin axis.
    pub(super) beta: f64,
    pub(super) amplitude: f64,
    frequency: f64,
    axis: Unit<Vector3<f64>>,
    start: Vector3<f64>,
}

/// The number of this index in [0, 1), by splitmix64.
pub(super) fn noise(index: u64) -> f64 {
    let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    f64_from_u64((z ^ (z >> 31)) >> 32) / 4_294_967_296.0
}

/// Angle between two unit vectors.
pub(super) fn angle(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    libm::atan2(a.cross(b).norm(), a.dot(b))
}

impl Case {
    /// The first of the cases.
    pub(super) fn many(count: u64) -> impl Iterator<Item = Self> {
        (0..count).map(Self::new)
    }

    fn new(index: u64) -> Self {
        let number = |k: u64| noise(index * 40 + k + 1_000);
        let signed = |k: u64| 2.0 * number(k) - 1.0;
        let vector = |k: u64| Vector3::new(signed(k), signed(k + 1), signed(k + 2)).normalize();
        let rotor = |k: u64, slowest: f64| {
            let rate = slowest * libm::pow(10.0, 1.5 * number(k)) * f64::signum(signed(k + 1));
            Rotor {
                rate: TurnRate::from_radians_per_second(rate),
                start: Phase::from_radians(TAU * number(k + 2)),
            }
        };
        let alpha = PI * number(0) * number(1);
        let scan = ScanStrategy::new(ScanParameters {
            start: Instant::from_tai_ns(0),
            alpha_rad: alpha,
            beta_rad: (PI - alpha) * number(2),
            precession: rotor(3, 0.02),
            spin: rotor(6, 0.1),
        })
        .unwrap();
        let mut motion = Motion::NOTHING;
        motion.set(&scan);
        let tilt = 0.3 * number(9);
        let frame = Rotation::<Telescope, Boresight>::about_z(TAU * number(10)).then(Rotation::<
            Boresight,
            Boresight,
        >::about_y(
            tilt
        ));
        let size = libm::pow(10.0, -2.5 * number(11));
        let field = if index.is_multiple_of(3) {
            FieldOfView::circle(frame, 0.7 * size).unwrap()
        } else {
            let sides = FieldOfView::rectangle(frame, size, (0.1 + number(12)) * size).unwrap();
            if index % 3 == 1 { sides } else { sides.enlarged(0.5 * size).unwrap() }
        };
        let centre = scan.boresight_in_spin().rotate(field.centre().vector());
        Self {
            motion,
            field,
            beta: angle(&centre, &Vector3::z()),
            amplitude: libm::pow(10.0, -3.0 * number(13)),
            frequency: 0.05 * number(14),
            axis: Unit::new_normalize(vector(15)),
            start: vector(18),
        }
    }

    pub(super) fn alpha(&self) -> f64 {
        self.motion.scan.parameters().alpha_rad
    }

    /// The track's bounds.
    pub(super) fn bounds(&self) -> RelativeBounds {
        let rate = self.amplitude * self.frequency;
        RelativeBounds { rate, acceleration: rate * rate + rate * self.frequency }
    }

    pub(super) fn rates(&self) -> Rates {
        Rates::new(&self.motion, self.bounds())
    }

    pub(super) fn reach(&self) -> Reach {
        let mut reach = Reach::NOTHING;
        reach.set(&self.motion, &self.field, self.bounds());
        reach
    }

    /// The target, seen from the spinning spacecraft at `t` seconds.
    pub(super) fn sight(&self, t: f64) -> Sight {
        let turned = self.amplitude * libm::sin(self.frequency * t);
        let speed = self.amplitude * self.frequency * libm::cos(self.frequency * t);
        let p = Rotation3::from_axis_angle(&self.axis, turned) * self.start;
        let rate = self.axis.cross(&p) * speed;
        let target = DirectionState {
            direction: Direction::from_unit(p),
            rate_per_s: [rate.x, rate.y, rate.z],
        };
        let parameters = self.motion.scan.parameters();
        let phase = |rotor: Rotor| rotor.start.radians() + rotor.rate.radians_per_second() * t;
        let sines =
            [parameters.precession, parameters.spin].map(|rotor| libm::sincos(phase(rotor)));
        Sight::new(&self.motion, &Seen::of(target, sines))
    }
}
