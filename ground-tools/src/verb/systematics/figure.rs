//! B spectra of residuals beside lensing and the tensors of r = 1e-3, both axes logarithmic.

use super::options::{Named, Setting};
use crate::picture::{Axis, Chart, Drawing, PictureError, Scale, Series, Shape, chart};
use planner::systematics::Found;

/// The tensors that are drawn for scale.
const R: f64 = 1e-3;

/// `l (l + 1) C_l / 2 pi` by l, what is above zero.
fn points(spectrum: &[f64], scale: f64, [from, to]: [usize; 2]) -> Vec<(f64, f64)> {
    let number = |l: usize| f64::from(u32::try_from(l).unwrap_or(u32::MAX));
    (from..=to)
        .filter_map(|l| Some((number(l), *spectrum.get(l)?)))
        .map(|(l, power)| (l, scale * l * (l + 1.0) * power / std::f64::consts::TAU))
        .filter(|(_, power)| *power > 0.0)
        .collect()
}

/// Draws the spectra.
///
/// # Errors
/// [`PictureError`] where nothing is above zero.
pub(super) fn figure(
    mission: &str,
    named: &[Named],
    found: &[Found],
    setting: &Setting,
) -> Result<Drawing, PictureError> {
    let degrees = setting.likelihood.degrees;
    let mut lines = vec![
        ("lensing".to_owned(), points(&setting.cmb.bb, 1.0, degrees)),
        (format!("tensors, r = {R}"), points(&setting.cmb.tensor_bb, R, degrees)),
    ];
    for (named, found) in named.iter().zip(found) {
        lines.push((named.text.clone(), points(&found.bb, 1.0, degrees)));
    }
    let series: Vec<Series<'_>> =
        lines.iter().map(|(name, points)| Series { name, shape: Shape::Line(points) }).collect();
    chart(&Chart {
        title: &format!("{mission}: B of systematic residuals"),
        x: Axis { quantity: "l", unit: "", scale: Scale::Log, range: None },
        y: Axis { quantity: "l (l + 1) C_l / 2 pi", unit: "uK^2", scale: Scale::Log, range: None },
        series: &series,
        marks: &[],
        bands: &[],
        width_px: 1200,
        height_px: 700,
    })
}
