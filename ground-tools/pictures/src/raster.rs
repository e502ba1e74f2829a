//! A map's values at the points of a picture, and their image.
//!
//! Every point shows the pixel that holds its centre. Points outside the sky are infinite, unobserved
//! ones NaN.

use super::colour::{ColourMap, STEPS, Span, UNOBSERVED};
use super::error::PictureError;
use super::projection::View;
use super::render::{Palette, encode};
use super::sky_map::SkyMap;
use rayon::prelude::*;

/// Values of an image, row by row from the top.
pub(super) struct Raster {
    width: u32,
    height: u32,
    values: Vec<f64>,
}

impl Raster {
    pub(super) fn of(map: &SkyMap, view: View, width: u32, height: u32) -> Self {
        let (half_x, half_y) = view.half_size();
        let place = |index: u32, size: u32, half: f64| {
            half * (2.0 * (f64::from(index) + 0.5) / f64::from(size) - 1.0)
        };
        let row = |row: u32| {
            (0..width).map(move |column| {
                let (x, y) = (place(column, width, half_x), -place(row, height, half_y));
                let Some((longitude, latitude)) = view.inverse(x, y) else { return f64::INFINITY };
                let nested = map.nside.pixel_at(longitude, latitude);
                let value = (map.values)(map.nside.numbered(map.ordering, nested));
                if value.is_finite() { value } else { f64::NAN }
            })
        };
        let rows: Vec<Vec<f64>> = (0..height).into_par_iter().map(|r| row(r).collect()).collect();
        Self { width, height, values: rows.concat() }
    }

    pub(super) fn values(&self) -> impl Iterator<Item = f64> {
        self.values.iter().copied().filter(|value| !value.is_infinite())
    }

    /// As a PNG with a palette.
    pub(super) fn png(&self, span: Span, colours: ColourMap) -> Result<Vec<u8>, PictureError> {
        let number = |&value: &f64| {
            if value.is_infinite() {
                STEPS + 1
            } else if value.is_nan() {
                STEPS
            } else {
                step(span.place(value))
            }
        };
        let pixels: Vec<u8> = self.values.par_iter().map(number).collect();
        let last = f64::from(STEPS - 1);
        let mut palette: Vec<_> =
            (0..STEPS).map(|step| colours.at(f64::from(step) / last)).collect();
        palette.extend([UNOBSERVED, [255; 3]]);
        let palette = Palette { colours: palette, clear: STEPS + 1 };
        encode(self.width, self.height, &pixels, Some(&palette))
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to STEPS - 1")]
fn step(place: f64) -> u8 {
    (place.clamp(0.0, 1.0) * f64::from(STEPS - 1)).round() as u8
}
