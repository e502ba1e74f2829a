//! Sums and products of vectors, component by component.
//!
//! With the bits of nalgebra's operators, whose loops a build for size neither unrolls nor keeps in
//! registers: each cost 24 bytes of stack and as many of code.

use nalgebra::Vector3;

type Vector = Vector3<f64>;

pub(crate) const fn vector(x: f64, y: f64, z: f64) -> Vector {
    Vector3::new(x, y, z)
}

pub(crate) fn plus(a: Vector, b: Vector) -> Vector {
    vector(a.x + b.x, a.y + b.y, a.z + b.z)
}

pub(crate) fn minus(a: Vector, b: Vector) -> Vector {
    vector(a.x - b.x, a.y - b.y, a.z - b.z)
}

pub(crate) fn negated(a: Vector) -> Vector {
    vector(-a.x, -a.y, -a.z)
}

pub(crate) fn times(a: Vector, factor: f64) -> Vector {
    vector(a.x * factor, a.y * factor, a.z * factor)
}

pub(crate) fn over(a: Vector, divisor: f64) -> Vector {
    vector(a.x / divisor, a.y / divisor, a.z / divisor)
}

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any() -> impl Strategy<Value = Vector> {
        [-9.0..9.0_f64, -9.0..9.0_f64, -9.0..9.0_f64].prop_map(|[x, y, z]| vector(x, y, z))
    }

    proptest! {
        #[test]
        fn the_bits_are_those_of_the_operators(a in any(), b in any(), k in -9.0..9.0_f64) {
            let pairs = [
                (plus(a, b), a + b),
                (minus(a, b), a - b),
                (negated(a), -a),
                (times(a, k), a * k),
                (over(a, k), a / k),
                (cross(a, b), a.cross(&b)),
            ];
            for (own, other) in pairs {
                prop_assert_eq!(own.map(f64::to_bits), other.map(f64::to_bits));
            }
            prop_assert_eq!(dot(a, b).to_bits(), (a.x * b.x + a.y * b.y + a.z * b.z).to_bits());
        }
    }
}
