//! Lines and histograms over a pair of axes.
//!
//! Either axis is linear or logarithmic; vertical marks carry names, such as the periods of spin and
//! precession. Names of series and of marks stand above the axes, where nothing lies under them.

use super::canvas::{Anchor, Canvas, INK, Rectangle, Stroke, Text, path};
use super::colour::{DASHES, LINES, Scale, Span};
use super::drawing::Drawing;
use super::error::PictureError;
use super::font::{self, DIGIT};
use super::legend::{Sample, legend};
use super::sky::titled;
use super::ticks::{Ticks, ticks};

/// One axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis<'a> {
    /// What it shows.
    pub quantity: &'a str,
    /// Its unit; empty where it has none.
    pub unit: &'a str,
    /// How values are spread.
    pub scale: Scale,
    /// Its ends; none takes those of what is drawn.
    pub range: Option<(f64, f64)>,
}

/// What a series draws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape<'a> {
    /// A line through points (x, y); NaN interrupts it.
    Line(&'a [(f64, f64)]),
    /// Bins: rising edges, one more than values.
    Histogram {
        /// Edges on the x axis.
        edges: &'a [f64],
        /// Values on the y axis.
        counts: &'a [f64],
    },
}

/// A named line or histogram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Series<'a> {
    /// Its name; empty leaves it out of the legend.
    pub name: &'a str,
    /// What is drawn.
    pub shape: Shape<'a>,
}

/// A vertical line with a name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark<'a> {
    /// Where on the x axis.
    pub at: f64,
    /// Its name.
    pub name: &'a str,
}

/// A range of the x axis, shaded, with a name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band<'a> {
    /// Its ends on the x axis.
    pub range: (f64, f64),
    /// Its name.
    pub name: &'a str,
}

/// A chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chart<'a> {
    /// What stands above it; may be empty.
    pub title: &'a str,
    /// The horizontal axis.
    pub x: Axis<'a>,
    /// The vertical axis.
    pub y: Axis<'a>,
    /// What is drawn, the first at the bottom.
    pub series: &'a [Series<'a>],
    /// Vertical lines.
    pub marks: &'a [Mark<'a>],
    /// Shaded ranges, under everything.
    pub bands: &'a [Band<'a>],
    /// Width in pixels.
    pub width_px: u32,
    /// Height in pixels.
    pub height_px: u32,
}

/// Colour of bands.
const SHADE: &str = "#e0a030";

/// Draws a chart.
///
/// # Errors
/// [`PictureError`] says what is out of range and what would be legal.
pub fn chart(chart: &Chart) -> Result<Drawing, PictureError> {
    check(chart)?;
    let (width, height) = (f64::from(chart.width_px), f64::from(chart.height_px));
    let unit = width / 1000.0;
    let size = 19.0 * unit;
    let x_span = span_of(&chart.x, extent(chart, true), Room::None)?;
    let histogram = chart.series.iter().any(|s| matches!(s.shape, Shape::Histogram { .. }));
    let room = if histogram { Room::Base } else { Room::Margins };
    let y_span = span_of(&chart.y, extent(chart, false), room)?;
    let x_ticks = ticks(x_span, 7);
    let y_ticks = ticks(y_span, 6);

    let mut canvas = Canvas::new(width, height);
    let mut top = 16.0 * unit;
    if !chart.title.is_empty() {
        let fits = (width - 30.0 * unit) / font::width(chart.title).max(1.0);
        let style = Text::new((24.0 * unit).min(fits), Anchor::Middle);
        canvas.text(width / 2.0, top + 22.0 * unit, style, chart.title);
        top += 38.0 * unit;
    }
    let entries: Vec<(Sample, &str)> = (chart.series.iter().enumerate())
        .filter(|(_, series)| !series.name.is_empty())
        .map(|(number, series)| (Sample::Line(stroke(number, unit)), series.name))
        .collect();
    let sides = (20.0 * unit, width - 20.0 * unit);
    top += legend(&mut canvas, &entries, sides, top, size);

    let widest = y_ticks.ticks.iter().map(|tick| font::width(&tick.label) * size);
    let left = widest.fold(0.0, f64::max) + 3.4 * size;
    let right = width - 1.8 * size;
    let marks: Vec<Mark> = (chart.marks.iter().copied())
        .filter(|mark| (-1e-9..=1.0 + 1e-9).contains(&x_span.place(mark.at)))
        .collect();
    let at = |mark: &Mark| left + (right - left) * x_span.place(mark.at);
    let shaded: Vec<(Band, (f64, f64))> = (chart.bands.iter())
        .map(|band| {
            (*band, (x_span.place(band.range.0).max(0.0), x_span.place(band.range.1).min(1.0)))
        })
        .filter(|(_, (low, high))| low <= high)
        .collect();
    let middles = shaded
        .iter()
        .map(|(band, _)| Mark { at: f64::midpoint(band.range.0, band.range.1), name: band.name });
    let named: Vec<Mark> = marks.iter().copied().chain(middles).collect();
    top += mark_names(&mut canvas, &named, at, (top, width, size));
    let bottom = (height - 3.6 * size).max(top + 20.0 * unit);
    let plot = Plot {
        place: Rectangle { x: left, y: top, width: right - left, height: bottom - top },
        x: x_span,
        y: y_span,
    };

    plot.grid(&mut canvas, &x_ticks, &y_ticks, unit);
    let Rectangle { x, y, width: w, height: h } = plot.place;
    canvas.clip(
        "axes",
        &format!("<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{w:.2}\" height=\"{h:.2}\"/>"),
    );
    for (_, (low, high)) in &shaded {
        let across = |share: f64| x + w * share;
        // At least a line.
        let (low, high) = (across(*low), across(*high).max(across(*low) + unit));
        let corners = [(low, y), (high, y), (high, y + h), (low, y + h)];
        canvas.fill(&path(corners), SHADE, 0.3);
    }
    for (number, series) in chart.series.iter().enumerate() {
        plot.series(&mut canvas, series.shape, stroke(number, unit));
    }
    for mark in &marks {
        let stroke = Stroke { dashes: &[5.0, 3.0], ..Stroke::new(INK, 1.4 * unit) };
        canvas.line((at(mark), top), (at(mark), bottom), stroke);
    }
    canvas.end_group();
    plot.axes(&mut canvas, &x_ticks, &y_ticks, size);
    let x_title = titled(chart.x.quantity, chart.x.unit, x_ticks.exponent);
    let y_title = titled(chart.y.quantity, chart.y.unit, y_ticks.exponent);
    let fit = |room: f64, text: &str| size.min(room / font::width(text).max(1.0));
    let style = Text::new(fit(right - left, &x_title), Anchor::Middle);
    canvas.text(f64::midpoint(left, right), bottom + 2.85 * size, style, &x_title);
    let upright = Text { upright: true, ..Text::new(fit(height, &y_title), Anchor::Middle) };
    let half = font::width(&y_title) * upright.size / 2.0 + 4.0 * unit;
    let middle = f64::midpoint(top, bottom).max(half).min((height - half).max(half));
    canvas.text(1.4 * size, middle, upright, &y_title);
    Ok(canvas.finish(chart.title))
}

fn check(chart: &Chart) -> Result<(), PictureError> {
    if !(200..=8000).contains(&chart.width_px) {
        return Err(PictureError::Width(chart.width_px));
    }
    if !(150..=8000).contains(&chart.height_px) {
        return Err(PictureError::Height(chart.height_px));
    }
    for series in chart.series {
        if let Shape::Histogram { edges, counts } = series.shape {
            let rising = edges.iter().zip(edges.iter().skip(1)).all(|(low, high)| low < high);
            if edges.len() != counts.len() + 1 || !rising || edges.iter().any(|e| !e.is_finite()) {
                return Err(PictureError::Bins {
                    name: series.name.to_owned(),
                    edges: edges.len(),
                    counts: counts.len(),
                });
            }
        }
    }
    Ok(())
}

fn stroke(number: usize, unit: f64) -> Stroke<'static> {
    let dashes = DASHES[number % DASHES.len()];
    Stroke { dashes, ..Stroke::new(LINES[number % LINES.len()], 2.4 * unit) }
}

/// Smallest and largest value that an axis has to show.
fn extent(chart: &Chart, of_x: bool) -> Option<(f64, f64)> {
    let scale = if of_x { chart.x.scale } else { chart.y.scale };
    let mut found: Option<(f64, f64)> = None;
    let mut take = |value: f64| {
        if value.is_finite() && (scale == Scale::Linear || value > 0.0) {
            let (low, high) = found.unwrap_or((value, value));
            found = Some((low.min(value), high.max(value)));
        }
    };
    for series in chart.series {
        match series.shape {
            Shape::Line(points) => {
                for &(x, y) in points {
                    take(if of_x { x } else { y });
                }
            }
            Shape::Histogram { edges, counts } => {
                (if of_x { edges } else { counts }).iter().copied().for_each(&mut take);
            }
        }
    }
    if of_x {
        chart.marks.iter().for_each(|mark| take(mark.at));
    }
    found
}

/// What an axis has to hold besides its values.
#[derive(Clone, Copy, PartialEq)]
enum Room {
    /// Nothing: data reach its ends.
    None,
    /// A little at both ends.
    Margins,
    /// Zero, or half the smallest on a logarithmic scale, and a little above.
    Base,
}

fn span_of(axis: &Axis, extent: Option<(f64, f64)>, room: Room) -> Result<Span, PictureError> {
    if let Some((low, high)) = axis.range {
        return Span::given(axis.scale, low, high);
    }
    let (low, high) = (extent.map(|(low, _)| low), extent.map(|(_, high)| high));
    let Span { scale, low, high } = Span::about(axis.scale, low, high);
    let margin = 0.05 * (high - low);
    let ratio = (high / low).powf(0.05);
    let (low, high) = match (scale, room) {
        (_, Room::None) => (low, high),
        (Scale::Linear, Room::Margins) => (low - margin, high + margin),
        (Scale::Linear, Room::Base) => (low.min(0.0) * 1.06, high.max(0.0) * 1.06),
        (Scale::Log, Room::Margins) => (low / ratio, high * ratio),
        (Scale::Log, Room::Base) => (low * 0.5, high * 2.0),
    };
    Ok(Span { scale, low, high })
}

/// Writes the names of marks above their lines, in as many rows as keep them apart.
fn mark_names(
    canvas: &mut Canvas,
    marks: &[Mark],
    at: impl Fn(&Mark) -> f64,
    (top, width, size): (f64, f64, f64),
) -> f64 {
    let mut rows: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut placed = Vec::new();
    let mut sorted: Vec<&Mark> = marks.iter().collect();
    sorted.sort_by(|a, b| at(a).total_cmp(&at(b)));
    for mark in sorted {
        let half = font::width(mark.name) * size * 0.92 / 2.0;
        // Within the picture, near its edge beside the line.
        let x = at(mark).min(width - half - 0.3 * size).max(half + 0.3 * size);
        let (low, high) = (x - half - 0.3 * size, x + half + 0.3 * size);
        let free = |row: &Vec<(f64, f64)>| row.iter().all(|&(a, b)| high < a || b < low);
        let row = rows.iter().position(free).unwrap_or(rows.len());
        if row == rows.len() {
            rows.push(Vec::new());
        }
        if let Some(row) = rows.get_mut(row) {
            row.push((low, high));
        }
        placed.push((x, row, mark.name));
    }
    let count = rows.len();
    let pitch = 1.25 * size;
    for (x, row, name) in placed {
        #[expect(clippy::cast_precision_loss, reason = "a few rows")]
        let baseline = top + pitch * (count - row) as f64 - 0.25 * size;
        canvas.text(x, baseline, Text::new(size * 0.92, Anchor::Middle), name);
    }
    #[expect(clippy::cast_precision_loss, reason = "a few rows")]
    let height = pitch * count as f64;
    height + 0.35 * size
}

/// The area within the axes.
struct Plot {
    place: Rectangle,
    x: Span,
    y: Span,
}

impl Plot {
    fn across(&self, x: f64) -> f64 {
        self.place.x + self.place.width * self.x.place(x).clamp(-10.0, 11.0)
    }

    fn up(&self, y: f64) -> f64 {
        self.place.y + self.place.height * (1.0 - self.y.place(y).clamp(-10.0, 11.0))
    }

    fn grid(&self, canvas: &mut Canvas, x_ticks: &Ticks, y_ticks: &Ticks, unit: f64) {
        let Rectangle { x, y, width, height } = self.place;
        let grey = Stroke::new("#e4e4e4", unit);
        for tick in x_ticks.ticks.iter().filter(|tick| !tick.label.is_empty()) {
            let place = self.across(tick.value);
            canvas.line((place, y), (place, y + height), grey);
        }
        for tick in y_ticks.ticks.iter().filter(|tick| !tick.label.is_empty()) {
            let place = self.up(tick.value);
            canvas.line((x, place), (x + width, place), grey);
        }
    }

    fn axes(&self, canvas: &mut Canvas, x_ticks: &Ticks, y_ticks: &Ticks, size: f64) {
        let Rectangle { x, y, height, .. } = self.place;
        let stroke = Stroke::new(INK, 0.075 * size);
        canvas.rectangle(self.place, "none", Some(stroke));
        let bottom = y + height;
        for tick in &x_ticks.ticks {
            let place = self.across(tick.value);
            let length = if tick.label.is_empty() { 0.2 } else { 0.36 } * size;
            canvas.line((place, bottom), (place, bottom + length), stroke);
            if !tick.label.is_empty() {
                let style = Text::new(size, Anchor::Middle);
                let baseline = bottom + 0.7 * size + DIGIT * size;
                canvas.text_if_free(place, baseline, style, &tick.label);
            }
        }
        for tick in &y_ticks.ticks {
            let place = self.up(tick.value);
            let length = if tick.label.is_empty() { 0.2 } else { 0.36 } * size;
            canvas.line((x - length, place), (x, place), stroke);
            if !tick.label.is_empty() {
                let style = Text::new(size, Anchor::End);
                let baseline = place + DIGIT * size / 2.0;
                canvas.text_if_free(x - 0.6 * size, baseline, style, &tick.label);
            }
        }
    }

    fn series(&self, canvas: &mut Canvas, shape: Shape, stroke: Stroke) {
        match shape {
            Shape::Line(points) => {
                let whole = |&(x, y): &(f64, f64)| {
                    let on = |span: &Span, v: f64| span.scale == Scale::Linear || v > 0.0;
                    x.is_finite() && y.is_finite() && on(&self.x, x) && on(&self.y, y)
                };
                for piece in points.split(|point| !whole(point)) {
                    let place: Vec<_> =
                        piece.iter().map(|&(x, y)| (self.across(x), self.up(y))).collect();
                    if place.len() > 1 {
                        canvas.path(&path(place.iter().copied()), stroke);
                    }
                    if points.len() <= 40 || place.len() == 1 {
                        for (x, y) in place {
                            let radius = 1.5 * stroke.width;
                            canvas.raw(&format!(
                                "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" fill=\"{}\"/>",
                                stroke.colour
                            ));
                        }
                    }
                }
            }
            Shape::Histogram { edges, counts } => {
                let base = match self.y.scale {
                    Scale::Linear => self.up(0.0),
                    Scale::Log => self.up(self.y.low) + 10.0 * stroke.width,
                };
                let mut outline = Vec::new();
                for ((&low, &high), &count) in edges.iter().zip(edges.iter().skip(1)).zip(counts) {
                    let empty = !count.is_finite() || (self.y.scale == Scale::Log && count <= 0.0);
                    let top = if empty { base } else { self.up(count) };
                    outline.extend([(self.across(low), top), (self.across(high), top)]);
                }
                if let (Some(&first), Some(&last)) = (outline.first(), outline.last()) {
                    let closed =
                        [(first.0, base)].into_iter().chain(outline).chain([(last.0, base)]);
                    let data = path(closed);
                    canvas.fill(&data, stroke.colour, 0.16);
                    canvas.path(&data, stroke);
                }
            }
        }
    }
}
