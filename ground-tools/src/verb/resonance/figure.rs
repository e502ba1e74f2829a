//! Predicted `sigma_hits / mean` against the precession period, as a chart.
//!
//! Peaks carry the fraction p/q that they belong to, with the sideband's sign; the tolerance box is
//! shaded; the allowance and the bound within the box are lines.
//!
//! Limits: the [`MOST_PEAKS`] highest peaks carry names.

use formats::resonance::minutes;
use pictures::{Axis, Band, Chart, Drawing, Mark, PictureError, Scale, Series, Shape, chart};
use planner::resonance::Recommendation;
use planner::resonance::check::Checked;

/// Peaks that carry names.
pub(super) const MOST_PEAKS: usize = 12;
/// A peak that carries a name is above its surroundings by this share of the floor.
const LEAST_PEAK: f64 = 0.004;
/// Points on either side within which a peak is the highest.
const BESIDE: usize = 3;

/// One precession period of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    /// Precession period in minutes.
    pub minutes: f64,
    /// Predicted `sigma_hits / mean`.
    pub sigma: f64,
    /// The strongest resonance's p, q and m.
    pub strongest: Option<[i32; 3]>,
}

/// Draws a scan with the check that was made and the recommendation.
///
/// # Errors
/// [`PictureError`], which no scan of two points or more causes.
pub(super) fn figure(
    title: &str,
    scan: &[Point],
    checked: &Checked,
    recommended: Option<&Recommendation>,
) -> Result<Drawing, PictureError> {
    let line: Vec<(f64, f64)> = scan.iter().map(|it| (it.minutes, it.sigma)).collect();
    let ends = (line.first().map_or(0.0, |it| it.0), line.last().map_or(1.0, |it| it.0));
    let certificate = &checked.certificate;
    let limit = certificate.sigma_floor * (1.0 + checked.allowed);
    let nominal = minutes(checked.motion.precession_period_s);
    // Errors of the spin period count as ones of the precession period.
    let eta = (checked.motion.precession_period_s / checked.motion.spin_period_s).abs();
    let half = (checked.tolerance.precession_s + eta * checked.tolerance.spin_s) / 60.0;
    let within = (nominal - half, nominal + half);
    let names = peaks(scan, certificate.sigma_floor, minutes(checked.motion.spin_period_s));
    let mut marks: Vec<Mark> = names.iter().map(|(at, name)| Mark { at: *at, name }).collect();
    if let Some(found) = recommended {
        let at = minutes(found.quietest.precession_period_s);
        marks.push(Mark { at, name: "recommended" });
    }
    let allowed = format!("floor and {} %", 100.0 * checked.allowed);
    let bound = format!("bound within tolerance ({})", checked.verdict());
    let allowance = [(ends.0, limit), (ends.1, limit)];
    let bounded = [(within.0, certificate.sigma_bound), (within.1, certificate.sigma_bound)];
    chart(&Chart {
        title,
        x: Axis {
            quantity: "precession period",
            unit: "min",
            scale: Scale::Linear,
            range: Some(ends),
        },
        y: Axis { quantity: "sigma_hits / mean", unit: "", scale: Scale::Linear, range: None },
        series: &[
            Series { name: "predicted", shape: Shape::Line(&line) },
            Series { name: &allowed, shape: Shape::Line(&allowance) },
            Series { name: &bound, shape: Shape::Line(&bounded) },
        ],
        marks: &marks,
        bands: &[Band { range: within, name: "tolerance" }],
        width_px: 1200,
        height_px: 700,
    })
}

/// The highest peak of each sideband with its name, the [`MOST_PEAKS`] highest of them.
fn peaks(scan: &[Point], floor: f64, spin_min: f64) -> Vec<(f64, String)> {
    let mut peaks: Vec<Point> = scan
        .iter()
        .enumerate()
        .filter(|(index, it)| {
            let beside = &scan[index.saturating_sub(BESIDE)..(index + BESIDE + 1).min(scan.len())];
            let highest = beside.iter().fold(0.0_f64, |most, it| most.max(it.sigma));
            it.sigma >= highest && it.sigma > floor * (1.0 + LEAST_PEAK)
        })
        .map(|(_, it)| *it)
        .collect();
    peaks.sort_by(|a, b| b.sigma.total_cmp(&a.sigma).then(a.minutes.total_cmp(&b.minutes)));
    let mut named: Vec<(f64, String)> = Vec::new();
    for Point { minutes, strongest, .. } in peaks {
        let Some([p, q, _]) = strongest.filter(|it| it[1] > 0) else { continue };
        let off = minutes - f64::from(p) / f64::from(q) * spin_min;
        let sign = match off {
            _ if off.abs() < 1e-9 * minutes => "",
            _ if off < 0.0 => "-",
            _ => "+",
        };
        let name = format!("{p}/{q}{sign}");
        if named.len() < MOST_PEAKS && named.iter().all(|(_, other)| *other != name) {
            named.push((minutes, name));
        }
    }
    named
}
