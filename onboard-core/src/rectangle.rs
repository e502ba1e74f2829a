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
