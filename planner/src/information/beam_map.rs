//! Where in a beam did sources pass, and how well is its response known there.
//!
//! Frames: x and y of the detector's frame in full widths of the beam, the beam's centre in the middle;
//! cell (column, row) has its middle at x = (column + 1/2) / 8 - 2, y likewise.
//!
//! Method: a pass is the straight chord w = b n - s v of [`Crossing`]; it is cut where it crosses lines of
//! the grid, and each piece gives its length over the speed to the cell that holds its middle
//! \[Siddon1985\]. Cells have the size of [`super::Profile`]'s.
//!
//! Limits: as those of a profile; the source is taken as small against a cell.

use super::pass::Crossing;
use super::profile::CELLS_PER_FWHM;
use super::sight::REACH;

/// Cells along each side.
pub const SIDE: usize = 32;

/// Time and information over the cells of a beam.
#[derive(Debug, Clone, PartialEq)]
pub struct BeamMap {
    seconds: Vec<f64>,
    information: Vec<f64>,
}

impl Default for BeamMap {
    fn default() -> Self {
        Self { seconds: vec![0.0; SIDE * SIDE], information: vec![0.0; SIDE * SIDE] }
    }
}

impl BeamMap {
    /// Takes in a pass; `share` is the part of its information that 1/f noise leaves.
    pub(super) fn pass(&mut self, it: &Crossing, fwhm_rad: f64, share: f64) {
        let cells = f64::from(CELLS_PER_FWHM);
        let half = REACH * cells;
        let (sin, cos) = it.scan_beam_angle_rad.sin_cos();
        let b = it.impact_rad / fwhm_rad * cells;
        // In cells from the map's corner: start + s step.
        let start = [half - b * cos, half + b * sin];
        let step = [-sin, -cos];
        let reach = 2.0 * half;
        let (mut first, mut last) = (-reach, reach);
        let mut cuts = Vec::with_capacity(2 * SIDE + 4);
        for (start, step) in start.into_iter().zip(step) {
            if step.abs() < 1e-12 {
                if !(0.0..=reach).contains(&start) {
                    return;
                }
                continue;
            }
            let ends = [-start / step, (reach - start) / step];
            first = first.max(ends[0].min(ends[1]));
            last = last.min(ends[0].max(ends[1]));
            for line in 0..=u8::try_from(SIDE).unwrap_or(u8::MAX) {
                cuts.push((f64::from(line) - start) / step);
            }
        }
        if first >= last {
            return;
        }
        cuts.retain(|at| first < *at && *at < last);
        cuts.push(last);
        cuts.sort_by(f64::total_cmp);
        let ratio = it.signal_k / it.noise_k_rts;
        let weight = ratio * ratio * share;
        let seconds_per_cell = fwhm_rad / cells / it.speed_rad_s;
        let mut from = first;
        for at in cuts {
            let middle = f64::midpoint(from, at);
            let cell = |axis: usize| whole(start[axis] + middle * step[axis]);
            let index = cell(1) * SIDE + cell(0);
            let seconds = (at - from) * seconds_per_cell;
            self.seconds[index] += seconds;
            self.information[index] += weight * seconds;
            from = at;
        }
    }

    /// Seconds of source in a cell.
    #[must_use]
    pub fn seconds(&self, column: usize, row: usize) -> f64 {
        self.seconds[row * SIDE + column]
    }

    /// Error of the normalised response in a cell; infinite where nothing passed.
    #[must_use]
    pub fn error(&self, column: usize, row: usize) -> f64 {
        1.0 / self.information[row * SIDE + column].sqrt()
    }

    /// The middle of a column or a row in full widths of the beam.
    #[must_use]
    pub fn middle_fwhm(index: usize) -> f64 {
        let whole = u8::try_from(index).unwrap_or(u8::MAX);
        (f64::from(whole) + 0.5) / f64::from(CELLS_PER_FWHM) - REACH
    }
}

/// The cell that holds a place, at the edges the one inside.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float saturates; then at most the last cell"
)]
fn whole(place: f64) -> usize {
    (place as usize).min(SIDE - 1)
}

#[cfg(test)]
mod tests {
    use super::super::pass::Modulation;
    use super::super::profile::Profile;
    use super::*;

    const FWHM: f64 = 0.01;

    fn crossing(impact_fwhm: f64, zeta: f64) -> Crossing {
        Crossing {
            signal_k: 0.1,
            noise_k_rts: 1e-3,
            beam_sigma_rad: 0.4 * FWHM,
            speed_rad_s: 0.005,
            impact_rad: impact_fwhm * FWHM,
            scan_beam_angle_rad: zeta,
            modulation: Modulation::default(),
        }
    }

    #[test]
    fn a_chord_along_y_fills_one_column() {
        // zeta = 0: the sight line moves along y, and positive impacts lie at negative x.
        let mut map = BeamMap::default();
        map.pass(&crossing(0.3, 0.0), FWHM, 1.0);
        // x = -0.3 full widths: column 16 - 2.4 -> 13.
        let cell = FWHM / 8.0 / 0.005;
        for row in 0..SIDE {
            for column in 0..SIDE {
                let expected = if column == 13 { cell } else { 0.0 };
                assert!((map.seconds(column, row) - expected).abs() < 1e-12, "{column} {row}");
            }
        }
        assert!((map.error(13, 5) - 1e-2 / cell.sqrt()).abs() < 1e-12);
        assert!(map.error(12, 5).is_infinite());
        assert!((BeamMap::middle_fwhm(13) + 0.3125).abs() < 1e-12);
    }

    #[test]
    fn time_is_the_chords_length_and_lies_where_samples_lie() {
        for (impact, zeta) in [(0.0, 0.7), (0.4, 2.0), (-1.3, -2.7), (1.9, 0.3), (0.0, 0.0)] {
            let it = crossing(impact, zeta);
            let mut map = BeamMap::default();
            map.pass(&it, FWHM, 1.0);
            let mut sampled = BeamMap::default();
            let (sin, cos) = zeta.sin_cos();
            let count = 400_000;
            let step_s = 6.0 * FWHM / it.speed_rad_s / f64::from(count);
            for n in 0..count {
                let run = it.speed_rad_s * (f64::from(n) + 0.5 - f64::from(count) / 2.0) * step_s;
                let x = (-it.impact_rad * cos - run * sin) / FWHM;
                let y = (it.impact_rad * sin - run * cos) / FWHM;
                if x.abs() < 2.0 && y.abs() < 2.0 {
                    let index = whole((y + 2.0) * 8.0) * SIDE + whole((x + 2.0) * 8.0);
                    sampled.seconds[index] += step_s;
                }
            }
            for (found, expected) in map.seconds.iter().zip(&sampled.seconds) {
                assert!((found - expected).abs() < 3.0 * step_s, "{impact} {zeta}");
            }
        }
    }

    #[test]
    fn cells_and_annuli_hold_the_same_time() {
        let (mut map, mut profile) = (BeamMap::default(), Profile::default());
        for n in -60..=60 {
            let it = crossing(f64::from(n) / 30.0, 0.1 * f64::from(n));
            map.pass(&it, FWHM, 1.0);
            profile.pass(&it, FWHM, 1.0);
        }
        // Per cell, because cells cover the circle only on average.
        let inside: f64 = (0..8).map(|annulus| profile.seconds(annulus)).sum();
        let per_cell = inside / (std::f64::consts::PI * 64.0);
        let (mut count, mut cells) = (0.0, 0.0);
        for index in 0..SIDE * SIDE {
            let x = BeamMap::middle_fwhm(index % SIDE);
            if x.hypot(BeamMap::middle_fwhm(index / SIDE)) < 1.0 {
                count += 1.0;
                cells += map.seconds[index];
            }
        }
        assert!((cells / count / per_cell - 1.0).abs() < 0.02, "{cells} {count} {inside}");
    }
}
