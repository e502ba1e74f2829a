//! Pictures: B spectra of residuals beside lensing and the tensors of r = 1e-3, both axes logarithmic;
//! Q and U of residuals.

use super::options::{Named, Setting};
use super::outcome::Outcome;
use crate::output::figures::Figure;
use pictures::{
    Axis, Chart, ColourMap, Drawing, PictureError, Range, Scale, Series, Shape, SkyMap, SkyPicture,
    View, chart, sky_picture,
};
use planner::healpix::Ordering;
use planner::survey::MapFrame;
use planner::systematics::Residual;

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
pub(super) fn spectra(
    mission: &str,
    effects: &[(&Named, &Outcome)],
    setting: &Setting,
) -> Result<Drawing, PictureError> {
    let degrees = setting.likelihood.degrees;
    let mut lines = vec![
        ("lensing".to_owned(), points(&setting.cmb.bb, 1.0, degrees)),
        (format!("tensors, r = {R}"), points(&setting.cmb.tensor_bb, R, degrees)),
    ];
    for (named, outcome) in effects {
        lines.push((named.text.clone(), points(&outcome.found.bb, 1.0, degrees)));
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

/// Draws Q and U of an effect's residual.
///
/// # Errors
/// [`PictureError`] where no pixel has a value.
pub(super) fn maps(
    (number, effect): (usize, &str),
    residual: &Residual,
    frame: MapFrame,
) -> Result<Vec<Figure>, PictureError> {
    let q = |pixel: u32| residual.polarisation[pixel as usize].re;
    let u = |pixel: u32| residual.polarisation[pixel as usize].im;
    let drawn = |(name, values): (&str, &(dyn Fn(u32) -> f64 + Sync))| {
        let (nside, ordering, frame) = (residual.nside(), Ordering::Ring, frame.into());
        let picture = SkyPicture {
            title: effect,
            quantity: &format!("residual {}", name.to_uppercase()),
            unit: "uK",
            view: View::WholeSky { longitude_rad: 0.0 },
            width_px: 1600,
            scale: Scale::Linear,
            range: Range::Percentiles(0.5, 99.5),
            colours: ColourMap::BlueRed,
            tracks: &[],
        };
        let drawing = sky_picture(&SkyMap { nside, ordering, frame, values }, &picture)?;
        Ok(Figure { stem: format!("residual-{number}-{name}"), drawing })
    };
    [("q", &q as &(dyn Fn(u32) -> f64 + Sync)), ("u", &u)].into_iter().map(drawn).collect()
}
