//! Where are the detectors of a grid laid out over a field of view.
//!
//! Frames: offsets (u, v) along x and y of the telescope's frame; a detector at radial offset r and
//! position angle a stands as `R_z(a) R_y(r) R_z(-a)` in it: its polarisation angle is 0.
//!
//! Method: (u, v) are whole multiples of the spacing, the line of sight among them. In a circle they
//! are the components of the radial offset, r = |(u, v)|, a = atan2(v, u); in a rectangle the two
//! angles that bound it, along (tan u, tan v, 1). Those inside or on the edge are kept, in order of
//! u, then v.
//!
//! Limits: a square grid in these angles, so that neighbours away from the centre are nearer on the
//! sky than the spacing; at most [`MAX_DETECTORS`].

use onboard_core::field_of_view::FieldShape;
use onboard_core::frame::{Detector, Telescope};
use onboard_core::rotation::Rotation;

/// Detectors that a grid may have.
pub(crate) const MAX_DETECTORS: u64 = 10_000;
/// Rounding of sizes and spacing, so that a detector on the edge is inside.
const SLACK: f64 = 1.0 + 1e-12;

/// The number of detectors that a grid would have, which is more than it may.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TooMany(pub(crate) f64);

/// The detectors of spacing `spacing_rad` over a field of view about the line of sight.
pub(crate) fn lay_out(
    shape: FieldShape,
    spacing_rad: f64,
) -> Result<Vec<Rotation<Detector, Telescope>>, TooMany> {
    let rows = Rows::new(shape, spacing_rad);
    let count = rows.count().ok_or_else(|| TooMany(rows.estimate()))?;
    let mut detectors = Vec::with_capacity(usize::try_from(count).unwrap_or(0));
    for row in -rows.last..=rows.last {
        let half = rows.half(row);
        for column in -half..=half {
            let (u, v) = (f64::from(row) * spacing_rad, f64::from(column) * spacing_rad);
            let (r, a) = match shape {
                FieldShape::Circle(_) => (u.hypot(v), v.atan2(u)),
                FieldShape::Rectangle { .. } => {
                    let (x, y) = (u.tan(), v.tan());
                    (x.hypot(y).atan(), y.atan2(x))
                }
            };
            detectors.push(at(r, a));
        }
    }
    Ok(detectors)
}

/// `R_z(a) R_y(r) R_z(-a)`.
fn at(r: f64, a: f64) -> Rotation<Detector, Telescope> {
    Rotation::<Detector, Detector>::about_z(-a)
        .then(Rotation::<Detector, Detector>::about_y(r))
        .then(Rotation::about_z(a))
}

/// A shape in steps.
enum Extent {
    Circle { radius: f64 },
    Rectangle { half_width: f64, half_height: f64 },
}

/// Rows of equal u, each symmetric about v = 0.
struct Rows {
    extent: Extent,
    /// The last row; the first is its negative.
    last: i32,
}

impl Rows {
    fn new(shape: FieldShape, spacing_rad: f64) -> Self {
        let steps = |angle: f64| angle / spacing_rad * SLACK;
        let extent = match shape {
            FieldShape::Circle(radius_rad) => Extent::Circle { radius: steps(radius_rad) },
            FieldShape::Rectangle { width_rad, height_rad } => Extent::Rectangle {
                half_width: steps(0.5 * width_rad),
                half_height: steps(0.5 * height_rad),
            },
        };
        let last = match extent {
            Extent::Circle { radius } => whole(radius),
            Extent::Rectangle { half_height, .. } => whole(half_height),
        };
        Self { extent, last }
    }

    /// Steps from v = 0 to the last detector of a row.
    fn half(&self, row: i32) -> i32 {
        match self.extent {
            Extent::Circle { radius } => {
                let u = f64::from(row);
                whole((radius * radius - u * u).max(0.0).sqrt() * SLACK)
            }
            Extent::Rectangle { half_width, .. } => whole(half_width),
        }
    }

    /// The number of detectors; none where there are too many.
    fn count(&self) -> Option<u64> {
        if u64::from(self.last.unsigned_abs()) > MAX_DETECTORS {
            return None;
        }
        let row = |row: i32| 2 * u64::from(self.half(row).unsigned_abs()) + 1;
        let count = (-self.last..=self.last).map(row).sum();
        (count <= MAX_DETECTORS).then_some(count)
    }

    /// About as many, from the area.
    fn estimate(&self) -> f64 {
        match self.extent {
            Extent::Circle { radius } => (std::f64::consts::PI * radius * radius).round(),
            Extent::Rectangle { half_width, half_height } => {
                ((2.0 * half_width.floor() + 1.0) * (2.0 * half_height.floor() + 1.0)).round()
            }
        }
    }
}

/// The whole steps in a non-negative number of them, held to what is far too many.
#[expect(clippy::cast_possible_truncation, reason = "held to the range of i32 before")]
fn whole(steps: f64) -> i32 {
    steps.min(1e9).floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use onboard_core::detector::detector_at;
    use onboard_core::direction::Direction;
    use onboard_core::field_of_view::FieldOfView;
    use onboard_core::frame::Boresight;

    fn degrees(angle: f64) -> f64 {
        angle.to_radians()
    }

    fn rectangle(width_deg: f64, height_deg: f64) -> FieldShape {
        FieldShape::Rectangle { width_rad: degrees(width_deg), height_rad: degrees(height_deg) }
    }

    fn directions(shape: FieldShape, spacing_deg: f64) -> Vec<[f64; 3]> {
        let grid = lay_out(shape, degrees(spacing_deg)).unwrap();
        grid.iter().map(|it| it.apply(Direction::Z).xyz()).collect()
    }

    #[test]
    fn a_rectangle_is_filled_to_its_edges() {
        // 18 deg along y, 8 deg along x, every 2 deg: 9 columns from -8 to 8, 5 rows from -4 to 4.
        let found = directions(rectangle(18.0, 8.0), 2.0);
        assert_eq!(found.len(), 45);
        let rows = [-4.0, -2.0, 0.0, 2.0, 4.0];
        let columns = [-8.0, -6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0, 8.0];
        let expected = rows.iter().flat_map(|u| columns.iter().map(move |v| (*u, *v)));
        for ([x, y, z], (u, v)) in found.iter().zip(expected) {
            assert!((x.atan2(*z) - degrees(u)).abs() < 1e-14, "{u} {v}");
            assert!((y.atan2(*z) - degrees(v)).abs() < 1e-14, "{u} {v}");
        }
    }

    #[test]
    fn a_circle_holds_the_lattice_points_within_its_radius() {
        // Gauss's circle problem: lattice points within radius 0, 1, 2, 5, 7 and 14.
        for (radius, count) in [(0.5, 1), (1.0, 5), (2.0, 13), (5.0, 81), (7.0, 149), (14.0, 613)] {
            let shape = FieldShape::Circle(degrees(radius));
            let found = directions(shape, 1.0);
            assert_eq!(found.len(), count, "{radius}");
            let frame = Rotation::<Telescope, Boresight>::IDENTITY;
            let around = FieldOfView::circle(frame, degrees(radius) + 1e-12).unwrap();
            for [x, y, z] in found {
                assert!(around.contains(Direction::new(x, y, z).unwrap()), "{radius}: {x} {y} {z}");
            }
        }
    }

    #[test]
    fn a_detector_stands_as_the_flight_core_would_place_it() {
        for (shape, spacing) in [
            (FieldShape::Circle(degrees(14.0)), degrees(3.0)),
            (rectangle(18.0, 8.0), degrees(1.5)),
            (FieldShape::Circle(3.1), 0.4),
        ] {
            for detector in lay_out(shape, spacing).unwrap() {
                let [x, y, z] = detector.apply(Direction::Z).xyz();
                let core = detector_at(x.hypot(y).atan2(z), y.atan2(x), 0.0);
                for (ours, theirs) in detector.to_xyzw().iter().zip(core.to_xyzw()) {
                    assert!((ours - theirs).abs() < 1e-15, "{detector:?} {core:?}");
                }
            }
        }
    }

    #[test]
    fn too_many_are_refused_before_they_are_laid_out() {
        let shape = FieldShape::Circle(degrees(14.0));
        assert_eq!(lay_out(shape, degrees(0.25)).unwrap().len(), 9845);
        assert!(lay_out(shape, degrees(0.2)).unwrap_err().0 > 15_000.0);
        assert!(lay_out(shape, 1e-300).unwrap_err().0 > 1e100);
        let row = rectangle(179.0, 0.1);
        assert_eq!(lay_out(row, degrees(0.02)).unwrap_err(), TooMany(8951.0 * 5.0));
    }
}
