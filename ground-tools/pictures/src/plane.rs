//! A picture of values over square cells of a plane, with contours and rings about its middle.
//!
//! x to the right, y up. Cells without a value are grey. Contours run where the values between the cells'
//! middles, joined in straight lines, pass a level.
//!
//! Method: marching squares, the two ambiguous cases told apart by the mean of the four corners.

use super::canvas::{Anchor, Canvas, INK, Rectangle, Stroke, Text, path};
use super::colour::{ColourMap, Range, STEPS, Scale, Span, UNOBSERVED};
use super::drawing::Drawing;
use super::error::PictureError;
use super::font::{self, DIGIT};
use super::legend::{Sample, legend};
use super::render::{Palette, encode};
use super::sky::{Bar, colour_bar, titled};
use super::ticks::ticks;

/// A circle about the middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring<'a> {
    /// Its radius in the axes' unit.
    pub radius: f64,
    /// Its name.
    pub name: &'a str,
}

/// Lines over the cells along which another quantity has a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contours<'a> {
    /// That quantity in the same cells; NaN where there is none.
    pub values: &'a [f64],
    /// Its levels.
    pub levels: &'a [f64],
    /// What the lines show, with the levels.
    pub meaning: &'a str,
}

/// How values over a plane are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanePicture<'a> {
    /// What stands above it; may be empty.
    pub title: &'a str,
    /// What the colours stand for.
    pub quantity: &'a str,
    /// Its unit.
    pub unit: &'a str,
    /// What the axes show, x and y.
    pub axes: [&'a str; 2],
    /// The axes' unit.
    pub axes_unit: &'a str,
    /// From the middle to each edge in that unit.
    pub half: f64,
    /// Values row by row from the lowest y, x rising; NaN where there is none.
    pub values: &'a [f64],
    /// Cells along each side.
    pub side: usize,
    /// Lines over them.
    pub contours: Option<Contours<'a>>,
    /// Circles about the middle.
    pub rings: &'a [Ring<'a>],
}

const WIDTH: f64 = 1000.0;
/// Light enough for the cells, dark enough for the paper.
const CONTOUR: Stroke<'_> = Stroke::new("#f2a7c3", 2.4);

/// Draws values over a plane.
///
/// # Errors
/// [`PictureError`], which no square of finite values causes.
pub fn plane_picture(picture: &PlanePicture) -> Result<Drawing, PictureError> {
    let size = 21.0;
    let range = Range::Percentiles(0.0, 99.0);
    let shown = picture.values.iter().copied().filter(|it| it.is_finite());
    let span = Span::of_values(Scale::Linear, range, ColourMap::Viridis, shown)?;
    let top = if picture.title.is_empty() { 30.0 } else { 76.0 };
    let frame = Rectangle { x: 150.0, y: top, width: 768.0, height: 768.0 };
    let mut canvas = Canvas::new(WIDTH, WIDTH);
    let fits = (WIDTH - 40.0) / font::width(picture.title).max(1.0);
    let style = Text::new(28.0_f64.min(fits), Anchor::Middle);
    canvas.text(WIDTH / 2.0, 46.0, style, picture.title);
    canvas.image(frame, &image(picture, span)?);
    let across = |x: f64| frame.x + frame.width * (x / picture.half + 1.0) / 2.0;
    let up = |y: f64| frame.y + frame.height * (1.0 - y / picture.half) / 2.0;
    let Rectangle { x, y, width, height } = frame;
    canvas.clip(
        "plane",
        &format!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/>"),
    );
    if let Some(lines) = picture.contours {
        for &level in lines.levels {
            for [from, to] in contour(lines.values, picture, level) {
                let place = |(x, y): (f64, f64)| (across(x), up(y));
                canvas.line(place(from), place(to), CONTOUR);
            }
        }
    }
    for ring in picture.rings {
        let points = (0..=180_u8).map(|n| {
            let (sin, cos) = (2.0 * f64::from(n)).to_radians().sin_cos();
            (across(ring.radius * cos), up(ring.radius * sin))
        });
        let stroke = Stroke { dashes: &[3.0, 1.8], ..Stroke::new(INK, 2.4) };
        let points = path(points);
        canvas.path(&points, Stroke { opacity: 0.7, ..Stroke::new("#ffffff", 5.0) });
        canvas.path(&points, stroke);
    }
    canvas.end_group();
    for ring in picture.rings {
        let style = Text { halo: true, ..Text::new(size * 0.9, Anchor::Middle) };
        canvas.text_if_free(across(0.0), up(ring.radius) - 0.35 * size, style, ring.name);
    }
    axes(&mut canvas, picture, frame, size)?;
    let mut below = frame.y + frame.height + 4.4 * size;
    let beyond = picture.values.iter().any(|it| it.is_finite() && *it > span.high);
    let title = (picture.quantity, picture.unit);
    let bar = Bar { colours: ColourMap::Viridis, title, span, beyond: (false, beyond) };
    below += colour_bar(&mut canvas, &bar, (WIDTH, below, size));
    let grey = format!("#{0:02x}{0:02x}{0:02x}", UNOBSERVED[0]);
    let mut entries: Vec<(Sample, &str)> = Vec::new();
    if let Some(lines) = picture.contours {
        entries.push((Sample::Line(CONTOUR), lines.meaning));
    }
    if picture.values.iter().any(|it| !it.is_finite()) {
        entries.push((Sample::Area(&grey), "no pass"));
    }
    below += legend(&mut canvas, &entries, (20.0, WIDTH - 20.0), below, size * 0.92);
    canvas.set_height(below + 0.8 * size);
    Ok(canvas.finish(picture.title))
}

/// Numbers and titles of both axes.
fn axes(
    canvas: &mut Canvas,
    picture: &PlanePicture,
    frame: Rectangle,
    size: f64,
) -> Result<(), PictureError> {
    let stroke = Stroke::new(INK, 1.6);
    canvas.rectangle(frame, "none", Some(stroke));
    let span = Span::given(Scale::Linear, -picture.half, picture.half)?;
    let marks = ticks(span, 7);
    let bottom = frame.y + frame.height;
    for tick in marks.ticks.iter().filter(|tick| !tick.label.is_empty()) {
        let x = frame.x + frame.width * span.place(tick.value);
        canvas.line((x, bottom), (x, bottom + 0.36 * size), stroke);
        let baseline = bottom + 0.7 * size + DIGIT * size;
        canvas.text_if_free(x, baseline, Text::new(size, Anchor::Middle), &tick.label);
        let y = frame.y + frame.height * (1.0 - span.place(tick.value));
        canvas.line((frame.x - 0.36 * size, y), (frame.x, y), stroke);
        let baseline = y + DIGIT * size / 2.0;
        canvas.text_if_free(
            frame.x - 0.6 * size,
            baseline,
            Text::new(size, Anchor::End),
            &tick.label,
        );
    }
    let [x, y] = picture.axes.map(|axis| titled(axis, picture.axes_unit, marks.exponent));
    let middle = (frame.x + frame.width / 2.0, frame.y + frame.height / 2.0);
    canvas.text(middle.0, bottom + 2.9 * size, Text::new(size, Anchor::Middle), &x);
    let upright = Text { upright: true, ..Text::new(size, Anchor::Middle) };
    canvas.text(frame.x - 4.0 * size, middle.1, upright, &y);
    Ok(())
}

/// The cells as an image of 24 points each.
fn image(picture: &PlanePicture, span: Span) -> Result<Vec<u8>, PictureError> {
    const POINTS: usize = 24;
    let clear = STEPS + 1;
    let mut colours: Vec<[u8; 3]> = (0..STEPS)
        .map(|step| ColourMap::Viridis.at(f64::from(step) / f64::from(STEPS - 1)))
        .collect();
    colours.push(UNOBSERVED);
    let number = |value: f64| {
        if !value.is_finite() {
            return STEPS;
        }
        let place = span.place(value).clamp(0.0, 1.0) * f64::from(STEPS - 1);
        (0..STEPS).rfind(|&step| f64::from(step) <= place).unwrap_or(0)
    };
    let numbers: Vec<u8> = picture.values.iter().map(|&it| number(it)).collect();
    let wide = picture.side * POINTS;
    let mut pixels = Vec::with_capacity(wide * wide);
    for row in (0..picture.side).rev() {
        let cells = &numbers[row * picture.side..(row + 1) * picture.side];
        let line: Vec<u8> = cells.iter().flat_map(|&it| [it; POINTS]).collect();
        for _ in 0..POINTS {
            pixels.extend_from_slice(&line);
        }
    }
    colours.push([0, 0, 0]);
    let wide = u32::try_from(wide).map_err(|error| PictureError::Render(error.to_string()))?;
    encode(wide, wide, &pixels, Some(&Palette { colours, clear }))
}

type Point = (f64, f64);

/// Pieces of a contour.
fn contour(values: &[f64], picture: &PlanePicture, level: f64) -> Vec<[Point; 2]> {
    let side = picture.side;
    let value = |column: usize, row: usize| values[row * side + column];
    let middle = |index: usize| {
        let whole = u32::try_from(index).unwrap_or(u32::MAX);
        let count = u32::try_from(side).unwrap_or(u32::MAX);
        picture.half * ((2.0 * f64::from(whole) + 1.0) / f64::from(count) - 1.0)
    };
    let mut pieces = Vec::new();
    for row in 0..side.saturating_sub(1) {
        for column in 0..side - 1 {
            // Counter-clockwise from the lower left.
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(right, above)| {
                let (column, row) = (column + right, row + above);
                ((middle(column), middle(row)), value(column, row))
            });
            if corners.iter().any(|it| !it.1.is_finite()) {
                continue;
            }
            let mut crossings = Vec::new();
            for edge in 0..4 {
                let (from, to) = (corners[edge], corners[(edge + 1) % 4]);
                if (from.1 < level) != (to.1 < level) {
                    let part = (level - from.1) / (to.1 - from.1);
                    let (a, b) = (from.0, to.0);
                    crossings.push((a.0 + part * (b.0 - a.0), a.1 + part * (b.1 - a.1)));
                }
            }
            match crossings[..] {
                [a, b] => pieces.push([a, b]),
                [a, b, c, d] => {
                    let mean = corners.iter().map(|it| it.1).sum::<f64>() / 4.0;
                    // The first corner's side of the middle is joined to the middle's.
                    if (mean < level) == (corners[0].1 < level) {
                        pieces.extend([[a, b], [c, d]]);
                    } else {
                        pieces.extend([[d, a], [b, c]]);
                    }
                }
                _ => {}
            }
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture<'a>(values: &'a [f64], rings: &'a [Ring<'a>]) -> PlanePicture<'a> {
        PlanePicture {
            title: "a plane",
            quantity: "error",
            unit: "dB",
            axes: ["x", "y"],
            axes_unit: "arcmin",
            half: 2.0,
            values,
            side: 16,
            contours: Some(Contours { values, levels: &[1.0], meaning: "error of 1 dB" }),
            rings,
        }
    }

    #[test]
    fn a_cones_contour_is_a_circle() {
        let middle = |index: usize| {
            2.0 * ((2.0 * f64::from(u8::try_from(index).unwrap()) + 1.0) / 16.0 - 1.0)
        };
        let values: Vec<f64> = (0..256).map(|it| middle(it % 16).hypot(middle(it / 16))).collect();
        let plane = picture(&values, &[]);
        let pieces = contour(&values, &plane, 1.0);
        assert!(pieces.len() > 20);
        for (x, y) in pieces.into_iter().flatten() {
            assert!((x.hypot(y) - 1.0).abs() < 0.02, "{x} {y}");
        }
    }

    #[test]
    fn cells_without_a_value_are_told() {
        let mut values = vec![0.5; 256];
        values[3] = f64::NAN;
        let rings = [Ring { radius: 1.0, name: "-3 dB" }];
        let drawn = plane_picture(&picture(&values, &rings)).unwrap();
        assert!(drawn.svg().contains("no pass") && drawn.svg().contains("-3 dB"));
        assert!(drawn.svg().contains("error of 1 dB"));
    }
}
