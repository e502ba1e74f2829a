//! Sums over degrees on several pairs of mirrored rings side by side.
//!
//! To the rings, of one order m: `F_m = sum_l c_l d^l_(m,-s)(theta)` and, with coefficients of its own,
//! `F_(-m) = sum_l c'_l d^l_(m,s)(theta)`, on a ring and on its mirror image; to the degrees, the sums
//! over rings with the same functions.
//!
//! Method: the recurrence of [`super::ladder`], compiled for the instruction set that is there; all
//! operations on all lanes alike, so that results have the same bits on every one.

use super::circle::Circle;
use super::ladder::{Ladder, number};
use super::wigner::{LARGE, UNIT};
use pulp::Arch;

/// Pairs of rings side by side.
pub(super) const PAIRS: usize = 8;
/// Functions: `d_(m,-s)` of all pairs, `d_(m,s)` of all pairs.
const LANES: usize = 2 * PAIRS;

/// `F_m` on the ring, `F_(-m)`, both on its mirror image: real and imaginary parts.
pub(super) type OnRings = [[f64; PAIRS]; 8];
/// Coefficients of one degree: those of `F_m`, of `F_(-m)`; both with the sign `(-1)^(l + m)`.
pub(super) type Column = [f64; 8];
/// Sums over rings of one degree: with `F_m`, with `F_(-m)`, real and imaginary parts.
pub(super) type Gathered = [[f64; PAIRS]; 4];

/// The functions of a block of rings as they climb.
struct Climb {
    now: [f64; LANES],
    before: [f64; LANES],
    units: [u32; LANES],
    cos: [f64; LANES],
    /// Of the coupling m s.
    sense: [f64; LANES],
}

impl Climb {
    fn new(ladder: &Ladder, circles: &[Circle; PAIRS]) -> Self {
        let first = circles.map(|circle| ladder.first(&circle));
        Self {
            now: std::array::from_fn(|lane| first[lane % PAIRS][lane / PAIRS].x),
            before: [0.0; LANES],
            units: std::array::from_fn(|lane| first[lane % PAIRS][lane / PAIRS].units),
            cos: std::array::from_fn(|lane| circles[lane % PAIRS].cos()),
            sense: std::array::from_fn(|lane| if lane < PAIRS { 1.0 } else { -1.0 }),
        }
    }

    /// The values, zero where they are too small to count.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "compiled for the instruction set of its caller")]
    fn values(&self) -> [f64; LANES] {
        std::array::from_fn(|lane| if self.units[lane] == 0 { self.now[lane] } else { 0.0 })
    }

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "compiled for the instruction set of its caller")]
    fn step(&mut self, step: [f64; 3]) {
        for lane in 0..LANES {
            let factor = step[0] * self.cos[lane] + step[1] * self.sense[lane];
            let above = factor * self.now[lane] - step[2] * self.before[lane];
            self.before[lane] = self.now[lane];
            self.now[lane] = above;
        }
    }

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "compiled for the instruction set of its caller")]
    fn rescale(&mut self) {
        for lane in 0..LANES {
            if self.units[lane] > 0 && self.now[lane].abs() > LARGE {
                self.now[lane] *= UNIT;
                self.before[lane] *= UNIT;
                self.units[lane] -= 1;
            }
        }
    }
}

/// The fields of one order on a block of rings; `columns` from the ladder's lowest degree.
pub(super) fn to_rings(ladder: &Ladder, circles: &[Circle; PAIRS], columns: &[Column]) -> OnRings {
    let mut climb = Climb::new(ladder, circles);
    Arch::new().dispatch(|| spread(ladder, &mut climb, columns))
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled for the instruction set of its caller")]
fn spread(ladder: &Ladder, climb: &mut Climb, columns: &[Column]) -> OnRings {
    let mut sums = [[0.0; PAIRS]; 8];
    let mut degrees = ladder.steps.iter().zip(columns);
    while climb.units != [0; LANES] {
        let Some((&step, column)) = degrees.next() else { return sums };
        add(&mut sums, column, &climb.values());
        climb.step(step);
        climb.rescale();
    }
    for (&step, column) in degrees {
        add(&mut sums, column, &climb.now);
        climb.step(step);
    }
    sums
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled for the instruction set of its caller")]
fn add(sums: &mut OnRings, column: &Column, values: &[f64; LANES]) {
    for pair in 0..PAIRS {
        let (a, b) = (values[pair], values[PAIRS + pair]);
        sums[0][pair] += column[0] * a;
        sums[1][pair] += column[1] * a;
        sums[2][pair] += column[2] * b;
        sums[3][pair] += column[3] * b;
        sums[4][pair] += column[4] * b;
        sums[5][pair] += column[5] * b;
        sums[6][pair] += column[6] * a;
        sums[7][pair] += column[7] * a;
    }
}

/// Adds a block of rings to the sums of each degree, from the ladder's lowest.
pub(super) fn to_degrees(
    ladder: &Ladder,
    circles: &[Circle; PAIRS],
    fields: &OnRings,
    sums: &mut [Gathered],
) {
    let mut climb = Climb::new(ladder, circles);
    // (-1)^(l + m) at the lowest degree.
    let even = ladder.is_even();
    Arch::new().dispatch(|| gather(ladder, (&mut climb, even), fields, sums));
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled for the instruction set of its caller")]
fn gather(
    ladder: &Ladder,
    (climb, even): (&mut Climb, bool),
    fields: &OnRings,
    sums: &mut [Gathered],
) {
    let mut sign = if even { 1.0 } else { -1.0 };
    let mut degrees = ladder.steps.iter().zip(sums);
    while climb.units != [0; LANES] {
        let Some((&step, sums)) = degrees.next() else { return };
        collect(sums, fields, &climb.values(), sign);
        sign = -sign;
        climb.step(step);
        climb.rescale();
    }
    for (&step, sums) in degrees {
        collect(sums, fields, &climb.now, sign);
        sign = -sign;
        climb.step(step);
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled for the instruction set of its caller")]
fn collect(sums: &mut Gathered, fields: &OnRings, values: &[f64; LANES], sign: f64) {
    for pair in 0..PAIRS {
        let (a, b) = (values[pair], values[PAIRS + pair]);
        let (a_mirrored, b_mirrored) = (sign * a, sign * b);
        sums[0][pair] += a * fields[0][pair] + b_mirrored * fields[4][pair];
        sums[1][pair] += a * fields[1][pair] + b_mirrored * fields[5][pair];
        sums[2][pair] += b * fields[2][pair] + a_mirrored * fields[6][pair];
        sums[3][pair] += b * fields[3][pair] + a_mirrored * fields[7][pair];
    }
}

/// `sqrt((2l + 1) / 4 pi)`.
pub(super) fn normalisation(l: usize) -> f64 {
    ((2.0 * number(l) + 1.0) / (4.0 * std::f64::consts::PI)).sqrt()
}
