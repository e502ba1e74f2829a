//! A picture of a square table of correlations: a coloured cell for each pair, with its number.
//!
//! Blue is negative, red positive; a cell without a number is grey. Notes stand below.

use super::canvas::{Anchor, Canvas, FAINT, INK, Rectangle, Stroke, Text};
use super::colour::{ColourMap, UNOBSERVED};
use super::drawing::Drawing;
use super::error::PictureError;
use super::font::{self, DIGIT};

/// A table of correlations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MatrixPicture<'a> {
    /// What stands above it.
    pub title: &'a str,
    /// Names of rows and columns.
    pub names: &'a [&'a str],
    /// Values from -1 to 1, row by row.
    pub values: &'a [Option<f64>],
    /// Lines below.
    pub notes: &'a [String],
}

const WIDTH: f64 = 1000.0;
/// From here on a number is written in white.
const DARK: f64 = 0.6;

/// Draws a table of correlations.
///
/// # Errors
/// [`PictureError::Width`] where it has no rows.
pub fn matrix_picture(picture: &MatrixPicture) -> Result<Drawing, PictureError> {
    let count = u32::try_from(picture.names.len()).unwrap_or(u32::MAX);
    if count == 0 || picture.values.len() != picture.names.len() * picture.names.len() {
        return Err(PictureError::Width(0));
    }
    let size = 20.0;
    let mut canvas = Canvas::new(WIDTH, WIDTH);
    let fits = (WIDTH - 40.0) / font::width(picture.title).max(1.0);
    canvas.text(WIDTH / 2.0, 46.0, Text::new(28.0_f64.min(fits), Anchor::Middle), picture.title);
    let widest = picture.names.iter().map(|it| font::width(it) * size).fold(0.0, f64::max);
    let (left, top) = (widest + 46.0, 76.0);
    let pitch = (WIDTH - left - 36.0) / f64::from(count);
    let high = 0.62 * pitch;
    for (row, cells) in picture.values.chunks(picture.names.len()).enumerate() {
        let y = top + high * f64::from(u32::try_from(row).unwrap_or(0));
        let name = picture.names[row];
        let middle = y + high / 2.0 + DIGIT * size / 2.0;
        canvas.text(left - 0.6 * size, middle, Text::new(size, Anchor::End), name);
        for (column, value) in cells.iter().enumerate() {
            let x = left + pitch * f64::from(u32::try_from(column).unwrap_or(0));
            let [red, green, blue] = match value {
                Some(value) => ColourMap::BlueRed.at(0.5 + 0.5 * value),
                None => UNOBSERVED,
            };
            let place = Rectangle { x, y, width: pitch, height: high };
            let colour = format!("#{red:02x}{green:02x}{blue:02x}");
            canvas.rectangle(place, &colour, Some(Stroke::new("#ffffff", 1.5)));
            if let Some(value) = value {
                let colour = if value.abs() > DARK { "#ffffff" } else { INK };
                let style = Text { colour, ..Text::new(size, Anchor::Middle) };
                canvas.text(x + pitch / 2.0, middle, style, &number(*value));
            }
        }
    }
    let bottom = top + high * f64::from(count);
    let mut rows = 1.0;
    for (column, name) in picture.names.iter().enumerate() {
        let x = left + pitch * (f64::from(u32::try_from(column).unwrap_or(0)) + 0.5);
        // Names wider than their column take turns in two rows.
        let wide = font::width(name) * size * 0.86 > pitch - 8.0;
        let second = wide && column % 2 == 1;
        if second {
            rows = 2.0;
        }
        let baseline = bottom + if second { 2.35 } else { 1.25 } * size;
        canvas.text(x, baseline, Text::new(size * 0.86, Anchor::Middle), name);
    }
    let mut y = bottom + (1.9 + 1.1 * rows) * size;
    for note in picture.notes {
        let fits = (WIDTH - 40.0) / font::width(note).max(1.0);
        let style = Text { colour: FAINT, ..Text::new((size * 0.9).min(fits), Anchor::Start) };
        canvas.text(20.0, y, style, note);
        y += 1.35 * size;
    }
    canvas.set_height(y);
    Ok(canvas.finish(picture.title))
}

/// Two decimals, none of them a negative zero; four where it would be one.
fn number(value: f64) -> String {
    if value.abs() < 0.005 {
        return "0.00".to_owned();
    }
    if value.abs() < 1.0 && value.abs() >= 0.995 {
        return format!("{value:.4}");
    }
    format!("{value:.2}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_shows_its_numbers_and_notes() {
        let names = ["gain", "width"];
        let values = [Some(1.0), Some(-0.5), Some(-0.5), None];
        let notes = ["gain, width (-0.5)".to_owned()];
        let picture = MatrixPicture { title: "t", names: &names, values: &values, notes: &notes };
        let drawn = matrix_picture(&picture).unwrap();
        assert!(drawn.svg().contains(">-0.50<") && drawn.svg().contains("gain, width"));
        assert_eq!([number(0.99871), number(-0.004)], ["0.9987", "0.00"]);
        assert!(matrix_picture(&MatrixPicture { names: &[], ..picture }).is_err());
    }
}
