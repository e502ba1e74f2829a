//! What lines and colours stand for: names in rows, each behind a sample.

use super::canvas::{Anchor, Canvas, Rectangle, Stroke, Text};
use super::font::{self, DIGIT};

/// What stands before a name.
pub(super) enum Sample<'a> {
    /// A line, in white's company where it crosses a map.
    Line(Stroke<'a>),
    /// A filled area.
    Area(&'a str),
}

/// Draws entries in centred rows from `top`; gives the height that they take.
pub(super) fn legend(
    canvas: &mut Canvas,
    entries: &[(Sample, &str)],
    (left, right): (f64, f64),
    top: f64,
    size: f64,
) -> f64 {
    let (sample, gap, spacing) = (2.2 * size, 0.5 * size, 1.8 * size);
    let width = |name: &str| sample + gap + font::width(name) * size;
    let mut rows: Vec<(f64, Vec<usize>)> = Vec::new();
    for (index, (_, name)) in entries.iter().enumerate() {
        let wide = width(name);
        match rows.last_mut() {
            Some((used, row)) if *used + spacing + wide <= right - left => {
                *used += spacing + wide;
                row.push(index);
            }
            _ => rows.push((wide, vec![index])),
        }
    }
    let pitch = 1.55 * size;
    let mut y = top;
    for (used, row) in &rows {
        let mut x = f64::midpoint(left, right) - used / 2.0;
        let middle = y + pitch / 2.0;
        for (kind, name) in row.iter().filter_map(|&index| entries.get(index)) {
            match kind {
                Sample::Line(stroke) => canvas.line((x, middle), (x + sample, middle), *stroke),
                Sample::Area(colour) => {
                    let height = 0.9 * size;
                    let place = Rectangle { x, y: middle - height / 2.0, width: sample, height };
                    canvas.rectangle(place, colour, None);
                }
            }
            let baseline = middle + DIGIT * size / 2.0;
            canvas.text(x + sample + gap, baseline, Text::new(size, Anchor::Start), name);
            x += width(name) + spacing;
        }
        y += pitch;
    }
    y - top
}
