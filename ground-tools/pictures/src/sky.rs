//! A picture of a map of the sky.
//!
//! Longitude increases to the left, north is up; angles are radians of the map's frame. A colour bar
//! gives the values; its pointed ends say that values lie beyond. Unobserved pixels are grey. Planets'
//! tracks lie over the map.
//!
//! Limits: automatic ranges are those of the values shown, one for each point of the image.

use super::canvas::{Anchor, Canvas, FAINT, INK, Rectangle, Stroke, Text, path};
use super::colour::{ColourMap, DASHES, LINES, Range, Scale, Span, UNOBSERVED};
use super::drawing::Drawing;
use super::error::PictureError;
use super::font::{self, DIGIT};
use super::graticule::{Placed, draw_labels, draw_lines};
use super::legend::{Sample, legend};
use super::projection::{View, densified};
use super::raster::Raster;
use super::sky_map::SkyMap;
use super::ticks::{factor, ticks};
use std::fmt::Write;

/// A line over the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Track<'a> {
    /// Whose it is.
    pub name: &'a str,
    /// Longitudes and latitudes in radians of the map's frame; a NaN ends a piece.
    pub points: &'a [(f64, f64)],
}

/// How a map is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkyPicture<'a> {
    /// What stands above it; may be empty.
    pub title: &'a str,
    /// What the colours stand for.
    pub quantity: &'a str,
    /// Its unit; empty where it has none.
    pub unit: &'a str,
    /// What part of the sky.
    pub view: View,
    /// How wide, in pixels.
    pub width_px: u32,
    /// How values are spread over the colours.
    pub scale: Scale,
    /// Which values have colours of their own.
    pub range: Range,
    /// The colours.
    pub colours: ColourMap,
    /// Lines over the map.
    pub tracks: &'a [Track<'a>],
}

/// Draws a map.
///
/// # Errors
/// [`PictureError`] says what is out of range and what would be legal.
pub fn sky_picture(map: &SkyMap, picture: &SkyPicture) -> Result<Drawing, PictureError> {
    if !(200..=8000).contains(&picture.width_px) {
        return Err(PictureError::Width(picture.width_px));
    }
    picture.view.check()?;
    let width = f64::from(picture.width_px);
    let whole = matches!(picture.view, View::WholeSky { .. });
    // Sizes are given for a picture 1600 pixels wide, 1000 for a patch.
    let unit = width / if whole { 1600.0 } else { 1000.0 };
    let (left, right) =
        if whole { (90.0 * unit, 90.0 * unit) } else { (105.0 * unit, 75.0 * unit) };
    let size = 23.0 * unit;
    let top = if picture.title.is_empty() { 40.0 } else { 84.0 } * unit;
    let frame = whole_pixels(left, top, width - left - right, whole);
    let placed = Placed { view: picture.view, frame };
    let [columns, rows] = [frame.width, frame.height].map(pixel_count);

    let raster = Raster::of(map, picture.view, columns, rows);
    let span = Span::of_values(picture.scale, picture.range, picture.colours, raster.values())?;

    let mut canvas = Canvas::new(width, width);
    if !picture.title.is_empty() {
        let fits = (width - 40.0 * unit) / font::width(picture.title).max(1.0);
        let style = Text::new((31.0 * unit).min(fits), Anchor::Middle);
        canvas.text(width / 2.0, 48.0 * unit, style, picture.title);
    }
    canvas.image(frame, &raster.png(span, picture.colours)?);
    canvas.clip("sky", &placed.outline(""));
    draw_lines(&mut canvas, &placed, unit);
    let drawn = draw_tracks(&mut canvas, &placed, picture.tracks, unit);
    canvas.end_group();
    let edge = format!(" fill=\"none\" stroke=\"{INK}\" stroke-width=\"{:.2}\"", 1.8 * unit);
    canvas.raw(&placed.outline(&edge));
    draw_labels(&mut canvas, &placed, size * 0.92);

    let mut y = frame.y + frame.height + if whole { 26.0 } else { 58.0 } * unit;
    let unobserved = raster.values().any(f64::is_nan);
    let beyond = |side: fn(f64) -> bool| raster.values().any(|value| side(span.place(value)));
    let ends = (beyond(|place| place < -1e-9), beyond(|place| place > 1.0 + 1e-9));
    let bar = Bar {
        colours: picture.colours,
        title: (picture.quantity, picture.unit),
        span,
        beyond: ends,
    };
    y += colour_bar(&mut canvas, &bar, (width, y, size));
    let grey = hex(UNOBSERVED);
    let mut entries: Vec<(Sample, &str)> = Vec::new();
    for (number, track) in picture.tracks.iter().enumerate().filter(|(number, _)| drawn[*number]) {
        entries.push((Sample::Line(track_stroke(number, unit)), track.name));
    }
    if unobserved {
        entries.push((Sample::Area(&grey), "not observed"));
    }
    let sides = (20.0 * unit, width - 20.0 * unit);
    y += legend(&mut canvas, &entries, sides, y, size * 0.92);
    let caption = format!("{} coordinates, longitude increases to the left", map.frame.name());
    let style = Text { colour: FAINT, ..Text::new(size * 0.82, Anchor::Middle) };
    y += 1.3 * size;
    canvas.text(width / 2.0, y, style, &caption);
    canvas.set_height(y + 0.9 * size);
    Ok(canvas.finish(picture.title))
}

/// A frame on whole pixels, so that the image's points are the picture's.
fn whole_pixels(left: f64, top: f64, width: f64, whole: bool) -> Rectangle {
    let width = (width / 2.0).floor().max(1.0) * 2.0;
    let height = if whole { width / 2.0 } else { width };
    Rectangle { x: left.round(), y: top.round(), width, height }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 8000")]
fn pixel_count(size: f64) -> u32 {
    size as u32
}

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn track_stroke(number: usize, unit: f64) -> Stroke<'static> {
    let colour = LINES[(number + 1) % LINES.len()];
    Stroke { dashes: DASHES[number % DASHES.len()], ..Stroke::new(colour, 3.4 * unit) }
}

/// Draws lines over the map; says which of them show.
fn draw_tracks(canvas: &mut Canvas, placed: &Placed, tracks: &[Track], unit: f64) -> Vec<bool> {
    let Rectangle { x, y, width, height } = placed.frame;
    let mut drawn = vec![false; tracks.len()];
    for (number, track) in tracks.iter().enumerate() {
        let stroke = track_stroke(number, unit);
        let whole = |point: &(f64, f64)| point.0.is_finite() && point.1.is_finite();
        for line in track.points.split(|point| !whole(point)) {
            let mut pieces: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
            for (longitude, latitude) in densified(line, 0.25_f64.to_radians()) {
                let point = placed.point(longitude, latitude);
                let last = pieces.last().and_then(|piece| piece.last()).copied();
                let jumps = match (point, last) {
                    (Some(point), Some(last)) => (point.0 - last.0).abs() > width / 4.0,
                    (None, Some(_)) => true,
                    _ => false,
                };
                if jumps {
                    pieces.push(Vec::new());
                }
                if let (Some(point), Some(piece)) = (point, pieces.last_mut()) {
                    piece.push(point);
                    drawn[number] |=
                        (x..=x + width).contains(&point.0) && (y..=y + height).contains(&point.1);
                }
            }
            for piece in pieces.into_iter().filter(|piece| piece.len() > 1) {
                let data = path(piece);
                let halo = Stroke { opacity: 0.85, ..Stroke::new("#ffffff", 6.4 * unit) };
                canvas.path(&data, halo);
                canvas.path(&data, stroke);
            }
        }
    }
    drawn
}

/// What a colour bar says.
pub(super) struct Bar<'b> {
    /// The colours.
    pub(super) colours: ColourMap,
    /// What they stand for, and its unit.
    pub(super) title: (&'b str, &'b str),
    /// The values at its ends.
    pub(super) span: Span,
    /// Whether values lie below and above.
    pub(super) beyond: (bool, bool),
}

/// Draws the colour bar with its numbers and title; gives the height that it takes.
pub(super) fn colour_bar(
    canvas: &mut Canvas,
    &Bar { colours, title: (quantity, unit), span, beyond: (below, above) }: &Bar<'_>,
    (width, y, size): (f64, f64, f64),
) -> f64 {
    const STOPS: u32 = 48;
    let (long, high) = (width * 0.56, 1.0 * size);
    let x = (width - long) / 2.0;
    let mut stops = String::new();
    for stop in 0..=STOPS {
        let place = f64::from(stop) / f64::from(STOPS);
        let colour = hex(colours.at(place));
        let _ = write!(stops, "<stop offset=\"{place:.4}\" stop-color=\"{colour}\"/>");
    }
    canvas.raw(&format!("<linearGradient id=\"colours\">{stops}</linearGradient>"));
    let frame = Stroke::new(INK, 0.06 * size);
    let place = Rectangle { x, y, width: long, height: high };
    canvas.rectangle(place, "url(#colours)", Some(frame));
    let tip = 0.9 * size;
    for (shown, edge, tip, place) in [(below, x, -tip, 0.0), (above, x + long, tip, 1.0)] {
        if shown {
            let corners = [(edge, y), (edge + tip, y + high / 2.0), (edge, y + high)];
            let data = path(corners);
            canvas.fill(&data, &hex(colours.at(place)), 1.0);
            canvas.path(&data, frame);
        }
    }
    let marks = ticks(span, 6);
    let bottom = y + high;
    for tick in &marks.ticks {
        let place = x + long * span.place(tick.value);
        let length = if tick.label.is_empty() { 0.2 } else { 0.35 } * size;
        canvas.line((place, bottom), (place, bottom + length), frame);
        let style = Text::new(size * 0.92, Anchor::Middle);
        let baseline = bottom + 0.5 * size + DIGIT * size;
        if !tick.label.is_empty() {
            canvas.text_if_free(place, baseline, style, &tick.label);
        }
    }
    let title = titled(quantity, unit, marks.exponent);
    canvas.text(width / 2.0, bottom + 2.5 * size, Text::new(size, Anchor::Middle), &title);
    high + 3.3 * size
}

/// A quantity with the power of ten that its numbers leave out, and its unit.
pub(super) fn titled(quantity: &str, unit: &str, exponent: i32) -> String {
    let factor = factor(exponent);
    match (factor.is_empty(), unit.is_empty()) {
        (true, true) => quantity.to_owned(),
        (true, false) => format!("{quantity} [{unit}]"),
        (false, true) => format!("{quantity} [{factor}]"),
        (false, false) => format!("{quantity} [{factor} {unit}]"),
    }
}
