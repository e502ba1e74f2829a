//! The point of a rectangular field of view that lies nearest to a direction.
//!
//! Frames: any fixed frame; the rectangle is that of [`FieldOfView`](crate::field_of_view), width
//! along its y, height along its x, about its z.
//!
//! Method: symmetry folds the direction into the quadrant x, y >= 0. There the nearest point of the
//! convex polygon is the foot on a side if the foot lies on the side's arc (at most one does,
//! because a local minimum of the distance to a convex set below 90 deg is the only one), else the
//! corner. For directions more than 90 deg away it is a corner too: a point of the polygon is a sum
//! of corners with weights >= 0, longer than the sum's length, so no point comes nearer than all
//! four.
//!
//! Limits: width and height in (0, pi). `tests/tests/avoidance.rs` compares with a dense outline.

use crate::vector::{dot, minus, over, plus, times};
use nalgebra::Vector3;

/// A rectangle with its axes, all in one frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rectangle {
    pub(crate) x: Vector3<f64>,
    pub(crate) y: Vector3<f64>,
    pub(crate) z: Vector3<f64>,
    /// Sine and cosine of half the height, along x.
    pub(crate) height: (f64, f64),
    /// Sine and cosine of half the width, along y.
    pub(crate) width: (f64, f64),
}

impl Rectangle {
    /// From its centre and the axes of its sides' hemispheres: two along +-x, two along +-y.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) fn from_sides(centre: Vector3<f64>, sides: [Vector3<f64>; 4]) -> Self {
        let [up, down, right, left] = sides;
        // (+-cos h/2, 0, sin h/2) and (0, +-cos w/2, sin w/2).
        let (x, y) = (times(minus(up, down), 0.5), times(minus(right, left), 0.5));
        let (cos_h, cos_w) = (libm::sqrt(dot(x, x)), libm::sqrt(dot(y, y)));
        Self {
            x: over(x, cos_h),
            y: over(y, cos_w),
            z: centre,
            height: (dot(up, centre), cos_h),
            width: (dot(right, centre), cos_w),
        }
    }

    /// The rectangle's point p with the largest `p . u`; none where `u` points inside it.
    ///
    /// `u` is any vector but zero.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) fn nearest(&self, u: &Vector3<f64>) -> Option<Vector3<f64>> {
        let (along_x, along_y, z) = (dot(self.x, *u), dot(self.y, *u), dot(self.z, *u));
        let (x, y) = (libm::fabs(along_x), libm::fabs(along_y));
        let ((sin_h, cos_h), (sin_w, cos_w)) = (self.height, self.width);
        let beyond_x = x * cos_h - z * sin_h;
        let beyond_y = y * cos_w - z * sin_w;
        if beyond_x <= 0.0 && beyond_y <= 0.0 {
            return None;
        }
        // Components along each side's middle; a corner lies at (tan h/2, tan w/2, 1).
        let middle_x = x * sin_h + z * cos_h;
        let middle_y = y * sin_w + z * cos_w;
        let foot = if beyond_x > 0.0 && y * cos_w <= middle_x * cos_h * sin_w {
            Vector3::new(middle_x * sin_h, y, middle_x * cos_h)
        } else if beyond_y > 0.0 && x * cos_h <= middle_y * cos_w * sin_h {
            Vector3::new(x, middle_y * sin_w, middle_y * cos_w)
        } else {
            Vector3::new(sin_h * cos_w, cos_h * sin_w, cos_h * cos_w)
        };
        let length = libm::sqrt(dot(foot, foot));
        let on_x = times(self.x, libm::copysign(foot.x, along_x) / length);
        let on_y = times(self.y, libm::copysign(foot.y, along_y) / length);
        Some(plus(plus(on_x, on_y), times(self.z, foot.z / length)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direction::Direction;
    use crate::field_of_view::FieldOfView;
    use crate::frame::{Boresight, Telescope};
    use crate::rotation::Rotation;

    fn frame() -> Rotation<Telescope, Boresight> {
        Rotation::<Telescope, Boresight>::about_z(0.4)
            .then(Rotation::<Boresight, Boresight>::about_x(1.1))
    }

    const SIDES: [(f64, f64); 5] = [(0.3, 0.1), (0.05, 0.6), (1.2, 1.0), (2.9, 0.2), (2.8, 3.0)];

    /// Largest `p . u` over points of the outline, at most 0.008 rad apart.
    fn largest_on_outline((width, height): (f64, f64), u: &Vector3<f64>) -> f64 {
        let shares = || (-200..=200_i16).map(|k| f64::from(k) / 400.0);
        let point = |x: f64, y: f64| {
            let (x, y) = ((x * height).tan(), (y * width).tan());
            frame().rotate(Vector3::new(x, y, 1.0).normalize()).dot(u)
        };
        let ends = [-0.5, 0.5];
        let along_y = shares().flat_map(|y| ends.map(|x| point(x, y)));
        let along_x = shares().flat_map(|x| ends.map(|y| point(x, y)));
        along_x.chain(along_y).fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn the_axes_come_back_from_the_sides() {
        for (width, height) in SIDES {
            let field = FieldOfView::rectangle(frame(), width, height).unwrap();
            let it = field.rectangle_axes().unwrap();
            let axis = |x: f64, y: f64, z: f64| frame().rotate(Vector3::new(x, y, z));
            for (own, expected) in [
                (it.x, axis(1.0, 0.0, 0.0)),
                (it.y, axis(0.0, 1.0, 0.0)),
                (it.z, axis(0.0, 0.0, 1.0)),
            ] {
                assert!((own - expected).norm() < 1e-14);
            }
            let off = |own: (f64, f64), side: f64| {
                (own.0 - (0.5 * side).sin()).abs() + (own.1 - (0.5 * side).cos()).abs()
            };
            assert!(off(it.height, height) < 1e-14 && off(it.width, width) < 1e-14);
        }
    }

    #[test]
    // REQ-AVOID-1.
    fn no_point_of_the_outline_is_nearer() {
        for (width, height) in SIDES {
            let field = FieldOfView::rectangle(frame(), width, height).unwrap();
            let it = field.rectangle_axes().unwrap();
            let (mut inside, mut outside) = (0, 0);
            for k in 0..600_u32 {
                // Evenly over the sphere, in a spiral of 600 steps of the golden angle.
                let z = 1.0 - (f64::from(k) + 0.5) / 300.0;
                let longitude = 2.399_963_229_728_653 * f64::from(k);
                let direction = Direction::from_longitude_latitude(longitude, z.asin());
                let u = direction.vector() * (0.5 + 1.5 * f64::from(k % 7) / 6.0);
                let Some(nearest) = it.nearest(&u) else {
                    assert!(field.contains(direction));
                    inside += 1;
                    continue;
                };
                outside += 1;
                assert!(!field.contains(direction));
                assert!((nearest.norm() - 1.0).abs() < 1e-14);
                let on_edge = Direction::<Boresight>::from_unit(nearest);
                let inwards = nearest + it.z * 1e-9;
                let inwards = Direction::new(inwards.x, inwards.y, inwards.z).unwrap();
                assert!(field.contains(inwards), "{width} {height} {k}");
                let along = nearest.dot(&u);
                let most = largest_on_outline((width, height), &u);
                assert!(along > most - 1e-12 * u.norm(), "{width} {height} {k}");
                assert!(along < most + 1e-3 * u.norm(), "{width} {height} {k}");
                let apart = on_edge.separation_rad(direction);
                assert!((field.angle_to_rad(direction) - apart).abs() < 1e-12);
            }
            assert!(outside > 150 && inside + outside == 600);
        }
    }
}
