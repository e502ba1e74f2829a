//! Which part of the sky counts as inside.
//!
//! A [`FieldOfView`] is fixed in [`Boresight`]: a circle about a line of sight, or the rectangle of
//! a focal plane. Both are an intersection of at most four caps `e . w >= cos r`, which is all that
//! the transit finder knows: a rectangle's sides are great circles, caps of 90 deg.
//!
//! A rectangle of width w and height h about z holds the directions with z > 0,
//! |atan2(x, z)| <= h/2 and |atan2(y, z)| <= w/2: width along y, height along x of its frame.
//!
//! [`FieldOfView::enlarged`] adds a margin: all directions within that angle of the field. A circle
//! stays a circle; a rectangle gets rounded corners, and the finder asks for its nearest point.
//!
//! Limits: radius in (0, pi]; width and height in (0, pi).

use crate::bytes::put;
use crate::direction::Direction;
use crate::frame::Boresight;
use crate::rectangle::Rectangle;
use crate::rotation::Rotation;
use crate::trigonometry;
use core::f64::consts::{FRAC_PI_2, PI};
use nalgebra::Vector3;

/// Why a field of view cannot be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FieldOfViewError {
    /// A radius (radians) outside (0, pi].
    Radius(f64),
    /// A width or height (radians) outside (0, pi).
    Side(f64),
}

/// Shape and size of a field of view, in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FieldShape {
    /// A circle of this radius.
    Circle(f64),
    /// A rectangle.
    Rectangle {
        /// Its width, along y.
        width_rad: f64,
        /// Its height, along x.
        height_rad: f64,
    },
}

impl FieldShape {
    /// Whether its sizes are in range.
    ///
    /// # Errors
    /// [`FieldOfViewError`] names the size that is not.
    #[inline(never)]
    pub(crate) fn check(self) -> Result<(), FieldOfViewError> {
        match self {
            Self::Circle(radius) if !(radius > 0.0 && radius <= PI) => {
                Err(FieldOfViewError::Radius(radius))
            }
            Self::Rectangle { width_rad, .. } if !(width_rad > 0.0 && width_rad < PI) => {
                Err(FieldOfViewError::Side(width_rad))
            }
            Self::Rectangle { height_rad, .. } if !(height_rad > 0.0 && height_rad < PI) => {
                Err(FieldOfViewError::Side(height_rad))
            }
            Self::Circle(_) | Self::Rectangle { .. } => Ok(()),
        }
    }
}

/// A set of directions fixed in the spacecraft.
#[derive(Debug, Clone, Copy)]
pub struct FieldOfView {
    shape: FieldShape,
    centre: Vector3<f64>,
    /// Radius of a circle about the centre that holds all of it, margin included.
    reach_rad: f64,
    margin_rad: f64,
    caps: Caps,
}

/// The caps whose intersection the field of view is, as (axis, radius).
#[derive(Debug, Clone, Copy)]
pub(crate) enum Caps {
    /// One circle about the centre.
    Circle,
    /// Four hemispheres about these axes.
    Rectangle([Vector3<f64>; 4]),
}

/// Bytes that tell one field of view from another.
pub(crate) const FIELD_BYTES: usize = 80;

impl FieldOfView {
    /// What tells this field of view from another: centre, sizes, reach, margin, and how it is turned.
    #[inline(never)]
    pub(crate) fn to_le_bytes(self) -> [u8; FIELD_BYTES] {
        let (first, second) = match self.shape {
            FieldShape::Circle(radius) => (radius, 0.0),
            FieldShape::Rectangle { width_rad, height_rad } => (width_rad, height_rad),
        };
        let axis = match self.caps {
            Caps::Circle => Vector3::zeros(),
            Caps::Rectangle([axis, ..]) => axis,
        };
        let (centre, sizes) = (self.centre, [first, second, self.reach_rad, self.margin_rad]);
        let mut bytes = [0; FIELD_BYTES];
        let mut offset = 0_usize;
        for number in [centre.x, centre.y, centre.z, axis.x, axis.y, axis.z].iter().chain(&sizes) {
            put(&mut bytes, offset, number.to_le_bytes());
            offset = offset.wrapping_add(8);
        }
        bytes
    }

    /// The field of view of this shape about the line of sight (z) of `frame`.
    ///
    /// # Errors
    /// [`FieldOfViewError`] when a size is out of range.
    pub fn new<F>(
        frame: Rotation<F, Boresight>,
        shape: FieldShape,
    ) -> Result<Self, FieldOfViewError> {
        match shape {
            FieldShape::Circle(radius) => Self::circle(frame, radius),
            FieldShape::Rectangle { width_rad, height_rad } => {
                Self::rectangle(frame, width_rad, height_rad)
            }
        }
    }

    /// The circle of `radius_rad` about the line of sight (z) of `frame`.
    ///
    /// # Errors
    /// [`FieldOfViewError::Radius`].
    pub fn circle<F>(
        frame: Rotation<F, Boresight>,
        radius_rad: f64,
    ) -> Result<Self, FieldOfViewError> {
        Self::of_circle(frame.of_any_frame(), radius_rad)
    }

    #[inline(never)]
    fn of_circle(
        frame: Rotation<Boresight, Boresight>,
        radius_rad: f64,
    ) -> Result<Self, FieldOfViewError> {
        FieldShape::Circle(radius_rad).check()?;
        let centre = frame.apply(Direction::Z).vector();
        let shape = FieldShape::Circle(radius_rad);
        Ok(Self { shape, centre, reach_rad: radius_rad, margin_rad: 0.0, caps: Caps::Circle })
    }

    /// The rectangle of `width_rad` along y and `height_rad` along x of `frame`, about its z.
    ///
    /// # Errors
    /// [`FieldOfViewError::Side`].
    pub fn rectangle<F>(
        frame: Rotation<F, Boresight>,
        width_rad: f64,
        height_rad: f64,
    ) -> Result<Self, FieldOfViewError> {
        Self::of_rectangle(frame.of_any_frame(), width_rad, height_rad)
    }

    #[inline(never)]
    fn of_rectangle(
        frame: Rotation<Boresight, Boresight>,
        width_rad: f64,
        height_rad: f64,
    ) -> Result<Self, FieldOfViewError> {
        FieldShape::Rectangle { width_rad, height_rad }.check()?;
        let (sin_w, cos_w) = trigonometry::sin_cos(0.5 * width_rad);
        let (sin_h, cos_h) = trigonometry::sin_cos(0.5 * height_rad);
        let axis = |x: f64, y: f64, z: f64| frame.rotate(Vector3::new(x, y, z));
        // A corner lies at (tan h/2, tan w/2, 1).
        let (tan_w, tan_h) = (sin_w / cos_w, sin_h / cos_h);
        Ok(Self {
            shape: FieldShape::Rectangle { width_rad, height_rad },
            centre: axis(0.0, 0.0, 1.0),
            reach_rad: libm::atan(libm::hypot(tan_w, tan_h)),
            margin_rad: 0.0,
            caps: Caps::Rectangle([
                axis(cos_h, 0.0, sin_h),
                axis(-cos_h, 0.0, sin_h),
                axis(0.0, cos_w, sin_w),
                axis(0.0, -cos_w, sin_w),
            ]),
        })
    }

    /// All directions within `margin_rad` of this field of view; none where that is every direction,
    /// or where the margin is not positive.
    ///
    /// A rectangle's farthest direction is opposite its centre, as a circle's.
    #[must_use]
    #[inline(never)]
    pub fn enlarged(&self, margin_rad: f64) -> Option<Self> {
        let reach_rad = self.reach_rad + margin_rad;
        (margin_rad > 0.0 && reach_rad < PI).then_some(Self {
            reach_rad,
            margin_rad: self.margin_rad + margin_rad,
            ..*self
        })
    }

    /// The margin by which it was enlarged, in radians.
    #[must_use]
    pub const fn margin_rad(&self) -> f64 {
        self.margin_rad
    }

    /// Its shape and size without the margin.
    #[must_use]
    pub const fn shape(&self) -> FieldShape {
        self.shape
    }

    /// The direction that separations are measured from.
    #[must_use]
    pub const fn centre(&self) -> Direction<Boresight> {
        Direction::from_unit(self.centre)
    }

    /// Radius in radians of a circle about the centre that holds the field of view.
    #[must_use]
    pub const fn reach_rad(&self) -> f64 {
        self.reach_rad
    }

    pub(crate) const fn caps(&self) -> &Caps {
        &self.caps
    }

    /// The rectangle in its own axes; none for a circle.
    pub(crate) fn rectangle_axes(&self) -> Option<Rectangle> {
        match self.caps {
            Caps::Circle => None,
            Caps::Rectangle(sides) => Some(Rectangle::from_sides(self.centre, sides)),
        }
    }

    /// Angle in radians from a direction to the nearest point of the field of view, 0 inside.
    #[must_use]
    pub fn angle_to_rad(&self, direction: Direction<Boresight>) -> f64 {
        let beyond = match self.rectangle_axes() {
            None => self.centre().separation_rad(direction) - self.reach_rad,
            Some(rectangle) => rectangle.nearest(&direction.vector()).map_or(0.0, |nearest| {
                Direction::<Boresight>::from_unit(nearest).separation_rad(direction)
                    - self.margin_rad
            }),
        };
        libm::fmax(beyond, 0.0)
    }

    /// Whether a direction is inside, by the definition: the slow oracle of the transit finder.
    #[must_use]
    pub fn contains(&self, direction: Direction<Boresight>) -> bool {
        match self.caps {
            Caps::Circle => {
                Direction::<Boresight>::from_unit(self.centre).separation_rad(direction)
                    <= self.reach_rad
            }
            Caps::Rectangle(_) if self.margin_rad > 0.0 => self.angle_to_rad(direction) <= 0.0,
            Caps::Rectangle(axes) => axes.iter().all(|axis| {
                Direction::<Boresight>::from_unit(*axis).separation_rad(direction) <= FRAC_PI_2
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Telescope;

    #[test]
    fn a_rectangle_is_wide_along_y() {
        let frame = Rotation::<Telescope, Boresight>::IDENTITY;
        let rectangle =
            FieldOfView::rectangle(frame, 18.0_f64.to_radians(), 8.0_f64.to_radians()).unwrap();
        let at = |x_deg: f64, y_deg: f64| {
            let (x, y) = (x_deg.to_radians().tan(), y_deg.to_radians().tan());
            rectangle.contains(Direction::new(x, y, 1.0).unwrap())
        };
        assert!(at(3.99, 8.99) && at(-3.99, -8.99) && at(0.0, 8.99));
        assert!(!at(4.01, 0.0) && !at(0.0, 9.01) && !at(-4.01, 0.0) && !at(0.0, -9.01));
        assert!(!rectangle.contains(Direction::new(0.0, 0.0, -1.0).unwrap()));
        let corner =
            libm::atan(libm::hypot(4.0_f64.to_radians().tan(), 9.0_f64.to_radians().tan()));
        assert!((rectangle.reach_rad() - corner).abs() < 1e-15);
    }

    #[test]
    fn sizes_have_a_legal_range() {
        let frame = Rotation::<Telescope, Boresight>::IDENTITY;
        for bad in [0.0, -1.0, 3.15, f64::NAN] {
            assert!(FieldOfView::circle(frame, bad).is_err());
            assert!(FieldOfView::rectangle(frame, bad, 0.1).is_err());
            assert!(FieldOfView::rectangle(frame, 0.1, bad).is_err());
        }
        assert!(FieldOfView::circle(frame, PI).is_ok());
    }

    #[test]
    // REQ-AVOID-1.
    fn margins_add_up_and_end_where_all_is_inside() {
        let frame = Rotation::<Telescope, Boresight>::IDENTITY;
        let beside = |angle: f64| Direction::new(angle.sin(), 0.0, angle.cos()).unwrap();
        let circle = FieldOfView::circle(frame, 0.3).unwrap();
        let rectangle = FieldOfView::rectangle(frame, 0.2, 0.6).unwrap();
        for field in [circle, rectangle] {
            assert_eq!(field.margin_rad().to_bits(), 0);
            let reach = field.reach_rad();
            let once = field.enlarged(0.2).unwrap();
            let twice = once.enlarged(0.5).unwrap();
            assert!((once.margin_rad() - 0.2).abs() < 1e-15);
            assert!((twice.margin_rad() - 0.7).abs() < 1e-15);
            assert!((twice.reach_rad() - reach - 0.7).abs() < 1e-15);
            assert_eq!(twice.shape(), field.shape());
            for margin in [0.0, -0.1, PI - reach, 3.2] {
                assert!(field.enlarged(margin).is_none(), "{margin}");
            }
            assert!(field.enlarged(PI - reach - 1e-9).is_some());
            // Half the height, and the circle's radius, is 0.3 along x.
            for (own, edge) in [(field, 0.3), (once, 0.5), (twice, 1.0)] {
                assert!((own.angle_to_rad(beside(edge + 0.4)) - 0.4).abs() < 1e-14);
                assert!(own.angle_to_rad(beside(edge - 0.01)) <= 0.0);
                assert!(own.contains(beside(edge - 1e-9)) && !own.contains(beside(edge + 1e-9)));
                assert!(own.contains(beside(1e-9 - edge)) && !own.contains(beside(-edge - 1e-9)));
            }
        }
    }

    #[test]
    fn sizes_end_where_they_say() {
        let frame = Rotation::<Telescope, Boresight>::IDENTITY;
        assert_eq!(
            FieldOfView::circle(frame, PI.next_up()).err(),
            Some(FieldOfViewError::Radius(PI.next_up()))
        );
        assert!(FieldOfView::rectangle(frame, PI.next_down(), 0.1).is_ok());
        assert_eq!(FieldOfView::rectangle(frame, 0.1, PI).err(), Some(FieldOfViewError::Side(PI)));
        let of = |shape| FieldOfView::new(frame, shape).map(|field| field.shape());
        assert_eq!(of(FieldShape::Circle(0.2)), Ok(FieldShape::Circle(0.2)));
        let shape = FieldShape::Rectangle { width_rad: 0.2, height_rad: 0.1 };
        assert_eq!(of(shape), Ok(shape));
    }
}
