//! The elements of a drawing, written as SVG.
//!
//! x to the right, y downwards, in pixels of the PNG. Coordinates have two decimals.

use super::drawing::Drawing;
use super::font::{self, FAMILIES};
use super::render;
use std::fmt::Write;

/// Colour of text and frames.
pub(super) const INK: &str = "#1a1a1a";
/// Colour of what stands back.
pub(super) const FAINT: &str = "#5f5f5f";

/// Where a text stands off its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// How a text looks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Text {
    pub(super) size: f64,
    pub(super) anchor: Anchor,
    pub(super) colour: &'static str,
    /// With a white border, over a map.
    pub(super) halo: bool,
    /// Turned to be read upwards.
    pub(super) upright: bool,
}

impl Text {
    pub(super) const fn new(size: f64, anchor: Anchor) -> Self {
        Self { size, anchor, colour: INK, halo: false, upright: false }
    }
}

/// How a line looks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stroke<'a> {
    pub(super) colour: &'a str,
    pub(super) width: f64,
    pub(super) opacity: f64,
    /// Lengths of dashes and gaps over the width; empty for a whole line.
    pub(super) dashes: &'a [f64],
}

impl<'a> Stroke<'a> {
    pub(super) const fn new(colour: &'a str, width: f64) -> Self {
        Self { colour, width, opacity: 1.0, dashes: &[] }
    }

    fn attributes(&self) -> String {
        let mut text = format!(" stroke=\"{}\" stroke-width=\"{}\"", self.colour, n(self.width));
        if self.opacity < 1.0 {
            let _ = write!(text, " stroke-opacity=\"{}\"", n(self.opacity));
        }
        if !self.dashes.is_empty() {
            let dashes: Vec<_> = self.dashes.iter().map(|dash| n(dash * self.width)).collect();
            let _ = write!(text, " stroke-dasharray=\"{}\"", dashes.join(" "));
        }
        text
    }
}

/// A place that is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rectangle {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Rectangle {
    fn meets(&self, other: &Self) -> bool {
        self.x < other.x + other.width
            && other.x < self.x + self.width
            && self.y < other.y + other.height
            && other.y < self.y + self.height
    }

    /// What a text at a point covers, with some room about it.
    pub(super) fn of_text(x: f64, y: f64, style: Text, text: &str) -> Self {
        let (width, size) = (font::width(text) * style.size, style.size);
        let left = match style.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => width / 2.0,
            Anchor::End => width,
        };
        let room = 0.25 * size;
        Self {
            x: x - left - room,
            y: y - 0.76 * size,
            width: width + 2.0 * room,
            height: 0.98 * size,
        }
    }
}

/// A drawing in the making.
#[derive(Debug)]
pub(super) struct Canvas {
    body: String,
    width: f64,
    height: f64,
    taken: Vec<Rectangle>,
}

/// A number with at most two decimals.
pub(super) fn n(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn escape(text: &str) -> String {
    let legal = text.chars().filter(|c| !c.is_control());
    let mut out = String::new();
    for c in legal {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c => out.push(c),
        }
    }
    out
}

/// A path through points.
pub(super) fn path(points: impl IntoIterator<Item = (f64, f64)>) -> String {
    let mut text = String::new();
    for (x, y) in points {
        let _ = write!(text, "{}{} {}", if text.is_empty() { "M" } else { "L" }, n(x), n(y));
    }
    text
}

impl Canvas {
    pub(super) fn new(width: f64, height: f64) -> Self {
        Self { body: String::new(), width, height, taken: Vec::new() }
    }

    pub(super) fn set_height(&mut self, height: f64) {
        self.height = height;
    }

    pub(super) fn raw(&mut self, element: &str) {
        self.body.push_str(element);
        self.body.push('\n');
    }

    pub(super) fn text(&mut self, x: f64, y: f64, style: Text, text: &str) {
        let anchor = match style.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let mut element = format!(
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{anchor}\" fill=\"{}\"",
            n(x),
            n(y),
            n(style.size),
            style.colour
        );
        if style.halo {
            let width = n(style.size * 0.22);
            let _ = write!(
                element,
                " stroke=\"#ffffff\" stroke-width=\"{width}\" stroke-linejoin=\"round\" paint-order=\"stroke\""
            );
        }
        if style.upright {
            let _ = write!(element, " transform=\"rotate(-90 {} {})\"", n(x), n(y));
        }
        self.raw(&format!("{element}>{}</text>", escape(text)));
    }

    /// A text, unless its place is taken.
    pub(super) fn text_if_free(&mut self, x: f64, y: f64, style: Text, text: &str) -> bool {
        let place = Rectangle::of_text(x, y, style, text);
        let inside = place.x >= 0.0 && place.x + place.width <= self.width;
        if !inside || self.taken.iter().any(|taken| taken.meets(&place)) {
            return false;
        }
        self.taken.push(place);
        self.text(x, y, style, text);
        true
    }

    pub(super) fn line(&mut self, from: (f64, f64), to: (f64, f64), stroke: Stroke) {
        self.path(&path([from, to]), stroke);
    }

    pub(super) fn path(&mut self, data: &str, stroke: Stroke) {
        let attributes = stroke.attributes();
        self.raw(&format!(
            "<path d=\"{data}\" fill=\"none\" stroke-linejoin=\"round\"{attributes}/>"
        ));
    }

    pub(super) fn fill(&mut self, data: &str, colour: &str, opacity: f64) {
        let opacity = n(opacity);
        self.raw(&format!("<path d=\"{data}\" fill=\"{colour}\" fill-opacity=\"{opacity}\"/>"));
    }

    /// A rectangle, filled, framed or both.
    pub(super) fn rectangle(&mut self, place: Rectangle, fill: &str, stroke: Option<Stroke>) {
        let Rectangle { x, y, width, height } = place;
        let frame = stroke.map(|stroke| stroke.attributes()).unwrap_or_default();
        self.raw(&format!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{fill}\"{frame}/>",
            n(x),
            n(y),
            n(width),
            n(height)
        ));
    }

    pub(super) fn image(&mut self, place: Rectangle, png: &[u8]) {
        let Rectangle { x, y, width, height } = place;
        self.raw(&format!(
            "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" href=\"{}\"/>",
            n(x),
            n(y),
            n(width),
            n(height),
            render::data_uri(png)
        ));
    }

    /// Begins a group that shows only within a shape, an SVG element; [`Canvas::end_group`] ends it.
    pub(super) fn clip(&mut self, id: &str, shape: &str) {
        self.raw(&format!(
            "<clipPath id=\"{id}\">{shape}</clipPath>\n<g clip-path=\"url(#{id})\">"
        ));
    }

    pub(super) fn end_group(&mut self) {
        self.raw("</g>");
    }

    pub(super) fn finish(self, title: &str) -> Drawing {
        let (width, height) = (n(self.width.ceil()), n(self.height.ceil()));
        let title = match title {
            "" => String::new(),
            title => format!("<title>{}</title>\n", escape(title)),
        };
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"{FAMILIES}\">\n{title}<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.body
        );
        Drawing { svg }
    }
}
