//! nalgebra's arithmetic is libm's, bit for bit, inside the whole workspace.
//!
//! ANISE turns on nalgebra's `std` feature for every crate built beside it; `libm-force` keeps the
//! functions on libm all the same. The target has no other arithmetic, so a difference here would
//! be a difference between ground and flight.

use nalgebra::{ComplexField, Quaternion, RealField, Unit, UnitQuaternion, Vector3};
use tests::Noise;

/// Results per function; eleven functions make more than a million.
const SAMPLES: u64 = 100_000;

fn same(what: &str, nalgebra: f64, libm: f64) {
    assert_eq!(nalgebra.to_bits(), libm.to_bits(), "{what}: {nalgebra:e} {libm:e}");
}

#[test]
fn a_million_results_equal_libms() {
    // The crate that brings in ANISE, and with it nalgebra's `std`, is really part of this build.
    assert_eq!(ephem::time::last_leap_second(), "2016-12-31");
    let mut noise = Noise::new(1);
    for _ in 0..SAMPLES {
        let (a, b, c) = (noise.signed(), noise.signed(), noise.signed());
        let angle = 10.0 * a;
        same("sin", ComplexField::sin(angle), libm::sin(angle));
        same("cos", ComplexField::cos(angle), libm::cos(angle));
        same("tan", ComplexField::tan(angle), libm::tan(angle));
        same("asin", ComplexField::asin(a), libm::asin(a));
        same("acos", ComplexField::acos(a), libm::acos(a));
        same("atan2", RealField::atan2(a, b), libm::atan2(a, b));
        same("exp", ComplexField::exp(angle), libm::exp(angle));
        same("sqrt", ComplexField::sqrt(a.abs()), libm::sqrt(a.abs()));
        same("hypot", ComplexField::hypot(a, b), libm::hypot(a, b));

        let vector = Vector3::new(a, b, c);
        same("norm", vector.norm(), libm::sqrt(a * a + b * b + c * c));
        let axis = Unit::new_unchecked(Vector3::new(0.0, 0.6, 0.8));
        let turn = UnitQuaternion::from_axis_angle(&axis, angle);
        let (sin, cos) = libm::sincos(angle / 2.0);
        same("axis-angle", turn.coords.w, cos);
        same("axis-angle", turn.coords.y, 0.6 * sin);

        // The product as it is written out, in the order that fixes its bits.
        let (left, right) = (Quaternion::new(a, b, c, angle), Quaternion::new(c, a, b, 0.5));
        let product = (left * right).coords.w;
        let (left, right) = (left.coords, right.coords);
        let written = left.w * right.w - left.x * right.x - left.y * right.y - left.z * right.z;
        same("product", product, written);
    }
}
