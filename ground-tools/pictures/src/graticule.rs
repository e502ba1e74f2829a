//! Lines of longitude and latitude over a map, and their numbers.
//!
//! On the whole sky every 30 deg: longitudes are written along the equator, latitudes at the left
//! edge. On a patch a round number of degrees, written where the lines meet the frame, or on the line
//! where they do not. A number whose place is taken is left out.

use super::View;
use super::canvas::{Anchor, Canvas, Rectangle, Stroke, Text, path};
use super::font::DIGIT;
use super::projection::wrapped;
use std::f64::consts::PI;

/// Where the plane of a view lies on the canvas.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    pub(super) view: View,
    pub(super) frame: Rectangle,
}

impl Placed {
    /// The canvas point of a direction.
    pub(super) fn point(&self, longitude_rad: f64, latitude_rad: f64) -> Option<(f64, f64)> {
        let (x, y) = self.view.forward(longitude_rad, latitude_rad)?;
        let (half_x, half_y) = self.view.half_size();
        let Rectangle { x: left, y: top, width, height } = self.frame;
        let place =
            (left + width * (x / half_x + 1.0) / 2.0, top + height * (1.0 - y / half_y) / 2.0);
        let near = (place.0 - left).abs() < 4.0 * width && (place.1 - top).abs() < 4.0 * height;
        near.then_some(place)
    }

    /// The sky's outline, as an SVG element.
    pub(super) fn outline(&self, attributes: &str) -> String {
        let Rectangle { x, y, width, height } = self.frame;
        match self.view {
            View::WholeSky { .. } => format!(
                "<ellipse cx=\"{}\" cy=\"{}\" rx=\"{}\" ry=\"{}\"{attributes}/>",
                x + width / 2.0,
                y + height / 2.0,
                width / 2.0,
                height / 2.0
            ),
            View::Patch { .. } => format!(
                "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"{attributes}/>"
            ),
        }
    }
}

/// Degrees between lines, and the range of each coordinate.
struct Lines {
    longitudes: Vec<f64>,
    latitudes: Vec<f64>,
    longitude_span: (f64, f64),
    latitude_span: (f64, f64),
    decimals: usize,
}

fn step_of(span_deg: f64, steps: f64) -> f64 {
    let all = [45.0, 30.0, 15.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005];
    all.into_iter().find(|step| span_deg / step >= steps).unwrap_or(0.002)
}

fn multiples(step: f64, (low, high): (f64, f64)) -> Vec<f64> {
    let mut found = Vec::new();
    let mut count = (low / step - 1e-9).ceil();
    while count * step <= high + 1e-9 && found.len() < 200 {
        found.push(count * step);
        count += 1.0;
    }
    found
}

fn decimals(step: f64) -> usize {
    (0_usize..4)
        .find(|&count| {
            let scaled = step * [1.0, 10.0, 100.0, 1000.0][count];
            (scaled - scaled.round()).abs() < 1e-6
        })
        .unwrap_or(3)
}

impl Lines {
    fn of(view: View) -> Self {
        match view {
            View::WholeSky { longitude_rad } => {
                let center = longitude_rad.to_degrees();
                let span = (center - 180.0, center + 180.0);
                Self {
                    longitudes: multiples(30.0, (span.0 + 1e-6, span.1 - 1e-6)),
                    latitudes: multiples(30.0, (-60.0, 60.0)),
                    longitude_span: span,
                    latitude_span: (-90.0, 90.0),
                    decimals: 0,
                }
            }
            View::Patch { longitude_rad, latitude_rad, side_rad } => {
                let (lon, lat) = (longitude_rad.to_degrees(), latitude_rad.to_degrees());
                let side = side_rad.to_degrees();
                let reach = side.min(89.0);
                let span = ((lat - reach).max(-90.0), (lat + reach).min(90.0));
                let highest = (lat.abs() + side / 2.0).min(90.0);
                let pole = lat.abs() + 0.75 * side >= 90.0;
                let width = if pole { 180.0 } else { side / highest.to_radians().cos() };
                let width = width.min(180.0);
                let across = if pole { 360.0 } else { side / lat.to_radians().cos() };
                let (step_lon, step_lat) = (step_of(across, 4.0), step_of(side, 4.0));
                let low = lon - width + if width >= 180.0 { 1e-6 } else { 0.0 };
                Self {
                    longitudes: multiples(step_lon, (low, lon + width)),
                    latitudes: multiples(step_lat, span),
                    longitude_span: (lon - width, lon + width),
                    latitude_span: span,
                    decimals: decimals(step_lon).max(decimals(step_lat)),
                }
            }
        }
    }

    /// Points of a line: of one longitude, or of one latitude.
    fn trace(&self, placed: &Placed, fixed: f64, is_longitude: bool) -> Vec<Vec<(f64, f64)>> {
        const POINTS: u32 = 400;
        let (from, to) = if is_longitude { self.latitude_span } else { self.longitude_span };
        let margin = if is_longitude { 0.0 } else { 1e-7 };
        let mut pieces = vec![Vec::new()];
        for count in 0..=POINTS {
            let share = f64::from(count) / f64::from(POINTS);
            let free = (from + margin) + share * (to - from - 2.0 * margin);
            let (lon, lat) = if is_longitude { (fixed, free) } else { (free, fixed) };
            match placed.point(lon.to_radians(), lat.to_radians()) {
                Some(point) => pieces.last_mut().map(|piece| piece.push(point)).unwrap_or_default(),
                None => pieces.push(Vec::new()),
            }
        }
        pieces.retain(|piece| piece.len() > 1);
        pieces
    }
}

/// Draws the lines; within the sky's outline only.
pub(super) fn draw_lines(canvas: &mut Canvas, placed: &Placed, unit: f64) {
    let lines = Lines::of(placed.view);
    for (fixed, is_longitude) in all(&lines) {
        for piece in lines.trace(placed, fixed, is_longitude) {
            let data = path(piece);
            for (colour, width, opacity) in [("#000000", 2.4, 0.18), ("#ffffff", 1.2, 0.6)] {
                let stroke = Stroke { opacity, ..Stroke::new(colour, width * unit) };
                canvas.path(&data, stroke);
            }
        }
    }
}

fn all(lines: &Lines) -> impl Iterator<Item = (f64, bool)> {
    let longitudes = lines.longitudes.iter().map(|&longitude| (longitude, true));
    longitudes.chain(lines.latitudes.iter().map(|&latitude| (latitude, false)))
}

fn label(value: f64, is_longitude: bool, decimals: usize) -> String {
    if is_longitude {
        let whole = value.rem_euclid(360.0);
        let whole = if 360.0 - whole < 1e-6 { 0.0 } else { whole };
        return format!("{whole:.decimals$}°");
    }
    let sign = if value > 1e-9 {
        "+"
    } else if value < -1e-9 {
        "\u{2212}"
    } else {
        ""
    };
    format!("{sign}{:.decimals$}°", value.abs())
}

/// Writes the numbers.
pub(super) fn draw_labels(canvas: &mut Canvas, placed: &Placed, size: f64) {
    match placed.view {
        View::WholeSky { longitude_rad } => whole_sky_labels(canvas, placed, longitude_rad, size),
        View::Patch { longitude_rad, .. } => patch_labels(canvas, placed, longitude_rad, size),
    }
}

fn whole_sky_labels(canvas: &mut Canvas, placed: &Placed, center_rad: f64, size: f64) {
    let lines = Lines::of(placed.view);
    for &latitude in &lines.latitudes {
        // Just inside the left edge of the sky.
        let edge = center_rad + PI * (1.0 - 1e-9);
        if let Some((x, y)) = placed.point(edge, latitude.to_radians()) {
            let lift = latitude.signum() * if latitude == 0.0 { 0.0 } else { 0.3 * size };
            let style = Text::new(size, Anchor::End);
            let text = label(latitude, false, 0);
            canvas.text_if_free(x - 0.5 * size, y - lift + DIGIT * size / 2.0, style, &text);
        }
    }
    for &longitude in &lines.longitudes {
        let sixth = (longitude / 60.0 - (longitude / 60.0).round()).abs() < 1e-9;
        let offset = wrapped(longitude.to_radians() - center_rad).abs();
        if !sixth || offset > 170_f64.to_radians() {
            continue;
        }
        if let Some((x, y)) = placed.point(longitude.to_radians(), 0.0) {
            let style = Text { halo: true, ..Text::new(size, Anchor::Middle) };
            let text = label(longitude, true, 0);
            canvas.text_if_free(x, y + DIGIT * size + 0.45 * size, style, &text);
        }
    }
}

/// Which edge of the frame.
#[derive(Clone, Copy, PartialEq)]
enum Edge {
    Bottom,
    Top,
    Left,
    Right,
}

fn patch_labels(canvas: &mut Canvas, placed: &Placed, center_rad: f64, size: f64) {
    let lines = Lines::of(placed.view);
    for (fixed, is_longitude) in all(&lines) {
        let pieces = lines.trace(placed, fixed, is_longitude);
        let edges = if is_longitude {
            [Edge::Bottom, Edge::Top, Edge::Left, Edge::Right]
        } else {
            [Edge::Left, Edge::Right, Edge::Bottom, Edge::Top]
        };
        let text = label(fixed, is_longitude, lines.decimals);
        let at_edge = edges.iter().take(if is_longitude { 4 } else { 2 }).any(|&edge| {
            pieces.iter().filter_map(|piece| crossing(piece, placed.frame, edge)).any(|(x, y)| {
                let (x, y, anchor) = match edge {
                    Edge::Bottom => (x, y + 1.15 * size, Anchor::Middle),
                    Edge::Top => (x, y - 0.45 * size, Anchor::Middle),
                    Edge::Left => (x - 0.4 * size, y + DIGIT * size / 2.0, Anchor::End),
                    Edge::Right => (x + 0.4 * size, y + DIGIT * size / 2.0, Anchor::Start),
                };
                canvas.text_if_free(x, y, Text::new(size, anchor), &text)
            })
        });
        if at_edge || is_longitude {
            continue;
        }
        if let Some((x, y)) = placed.point(center_rad, fixed.to_radians()) {
            let Rectangle { x: left, y: top, width, height } = placed.frame;
            let inside = (left..left + width).contains(&x)
                && (top + 2.0 * size..top + height - 2.0 * size).contains(&y);
            if inside && fixed.abs() < 90.0 - 1e-9 {
                let style = Text { halo: true, ..Text::new(size, Anchor::Middle) };
                canvas.text_if_free(x, y + DIGIT * size / 2.0, style, &text);
            }
        }
    }
}

/// Where a line first meets an edge of the frame.
fn crossing(piece: &[(f64, f64)], frame: Rectangle, edge: Edge) -> Option<(f64, f64)> {
    let Rectangle { x, y, width, height } = frame;
    let across = |(px, py): (f64, f64)| match edge {
        Edge::Bottom => py - (y + height),
        Edge::Top => py - y,
        Edge::Left => px - x,
        Edge::Right => px - (x + width),
    };
    piece.iter().zip(piece.iter().skip(1)).find_map(|(&from, &to)| {
        let (a, b) = (across(from), across(to));
        if (a < 0.0) == (b < 0.0) {
            return None;
        }
        let share = a / (a - b);
        let point = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
        let on_edge = match edge {
            Edge::Bottom | Edge::Top => (x..=x + width).contains(&point.0),
            Edge::Left | Edge::Right => (y..=y + height).contains(&point.1),
        };
        on_edge.then_some(point)
    })
}
