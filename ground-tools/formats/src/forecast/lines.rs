//! A table of errors: a line per detector or channel, and what cannot be told apart.
//!
//! Of several windows the worst counts, of those in which anything is measured at all; how many these
//! are stands beside it. Of radii the worst is the smallest.
//!
//! Limits: of more than [`MOST_LINES`] detectors the median and the worst of each channel are shown.

use planner::information::{Look, Measure, Parameter, Teaching};
use std::collections::BTreeMap;

/// Detectors that have a line each.
const MOST_LINES: usize = 40;

/// What columns show: a name, a unit, and what it is.
pub const COLUMNS: [(&str, &str, Measure); 11] = [
    ("gain", "%", Measure::Parameter(Parameter::Gain)),
    ("x", "arcsec", Measure::Parameter(Parameter::OffsetX)),
    ("y", "arcsec", Measure::Parameter(Parameter::OffsetY)),
    ("width", "%", Measure::Parameter(Parameter::Width)),
    ("e_plus", "%", Measure::Parameter(Parameter::EPlus)),
    ("e_cross", "%", Measure::Parameter(Parameter::ECross)),
    ("tau", "ms", Measure::Parameter(Parameter::TimeConstant)),
    ("angle", "deg", Measure::Parameter(Parameter::PolarisationAngle)),
    ("-20 dB", "arcmin", Measure::Known(-20.0)),
    ("-30 dB", "arcmin", Measure::Known(-30.0)),
    ("seen", "arcmin", Measure::Seen),
];

/// A value per column; `None` where nothing is measured.
pub type Cells = [Option<f64>; COLUMNS.len()];

/// A line of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// `TELESCOPE/DETECTOR`, or `TELESCOPE/CHANNEL` with what is shown of it.
    pub name: String,
    /// The values.
    pub cells: Cells,
    /// Windows in which something is measured.
    pub measured: usize,
}

/// Whether a column's worst value is its smallest.
const fn is_radius(column: usize) -> bool {
    !matches!(COLUMNS[column].2, Measure::Parameter(_))
}

/// The worse of two values of a column.
fn worse(column: usize, one: f64, other: f64) -> f64 {
    if is_radius(column) { one.min(other) } else { one.max(other) }
}

/// The table of all targets together.
#[must_use]
pub fn lines(teaching: &Teaching) -> Vec<Line> {
    let looks: Vec<Line> = (0..teaching.looks.len()).map(|look| of_look(teaching, look)).collect();
    if looks.len() <= MOST_LINES {
        return looks;
    }
    let mut channels: BTreeMap<String, Vec<&Line>> = BTreeMap::new();
    for (look, line) in teaching.looks.iter().zip(&looks) {
        channels.entry(channel(look)).or_default().push(line);
    }
    let mut lines = Vec::new();
    for (name, all) in channels {
        let measured = all.iter().map(|it| it.measured).min().unwrap_or(0);
        // From the best to the worst; what is not measured is worst.
        let at = |rank: usize| -> Cells {
            std::array::from_fn(|column| {
                let lost = if is_radius(column) { f64::NEG_INFINITY } else { f64::INFINITY };
                let mut values: Vec<f64> =
                    all.iter().map(|it| it.cells[column].unwrap_or(lost)).collect();
                values.sort_by(f64::total_cmp);
                if is_radius(column) {
                    values.reverse();
                }
                values.get(rank).copied().filter(|it| it.is_finite())
            })
        };
        let median = Line { name: format!("{name} median"), cells: at(all.len() / 2), measured };
        let worst = format!("{name} worst of {}", all.len());
        lines.extend([median, Line { name: worst, cells: at(all.len() - 1), measured }]);
    }
    lines
}

fn channel(look: &Look) -> String {
    format!("{}/{}", look.line.telescope_name, look.channel.as_deref().unwrap_or("-"))
}

/// The worst of the windows in which anything is measured.
fn of_look(teaching: &Teaching, look: usize) -> Line {
    let name = teaching.looks[look].key();
    let plain = |it: &&planner::information::Row| {
        it.look == look && it.target.is_none() && it.requirement.is_none()
    };
    let mut windows: BTreeMap<i64, Cells> = BTreeMap::new();
    for row in teaching.rows.iter().filter(plain) {
        let Some(column) = COLUMNS.iter().position(|it| same(&it.2, &row.measure)) else {
            continue;
        };
        let cells = windows.entry(row.window.0.tai_ns()).or_default();
        cells[column] = row.value.map(|value| row.told(value).1);
    }
    let mut measured = windows.into_values().filter(|it| it.iter().any(Option::is_some));
    let first = measured.next();
    let mut count = usize::from(first.is_some());
    let mut worst = first.unwrap_or_default();
    for cells in measured {
        count += 1;
        worst = std::array::from_fn(|column| Some(worse(column, worst[column]?, cells[column]?)));
    }
    Line { name, cells: worst, measured: count }
}

/// Whether two measures are the same column's.
fn same(one: &Measure, other: &Measure) -> bool {
    match (one, other) {
        (Measure::Known(a), Measure::Known(b)) => (a - b).abs() < 0.5,
        _ => one == other,
    }
}

/// Three digits that count; a dash for what is not measured.
#[must_use]
pub fn shown(value: Option<f64>) -> String {
    let Some(value) = value else { return "-".to_owned() };
    match value.abs() {
        size if size >= 1e5 || (size > 0.0 && size < 9.995e-4) => format!("{value:.1e}"),
        size if size >= 99.95 => format!("{value:.0}"),
        size if size >= 9.995 => format!("{value:.1}"),
        size if size >= 0.9995 => format!("{value:.2}"),
        size if size >= 0.099_95 => format!("{value:.3}"),
        size if size >= 0.009_995 => format!("{value:.4}"),
        _ => format!("{value:.5}"),
    }
}

/// What cannot be told apart, in sentences: once per pair, with the number of detectors or channels.
#[must_use]
pub fn apart(teaching: &Teaching) -> Vec<String> {
    let mut pairs: BTreeMap<(Parameter, Parameter), (usize, f64, &'static str)> = BTreeMap::new();
    for look in 0..teaching.looks.len() {
        for it in teaching.errors(look).degeneracies {
            let entry = pairs.entry((it.one, it.other)).or_insert((0, 0.0, it.broken_by()));
            entry.0 += 1;
            if it.correlation.abs() > entry.1.abs() {
                entry.1 = it.correlation;
            }
        }
    }
    let of = teaching.looks.len();
    pairs
        .into_iter()
        .map(|((one, other), (count, correlation, broken_by))| {
            let (one, other) = (one.name(), other.name());
            let digits = if correlation.abs() > 0.9995 { 7 } else { 3 };
            format!(
                "{one} and {other}: {correlation:.digits$}, {count} of {of}; told apart by {broken_by}"
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let texts = [0.035_51, 0.9996, 0.1641, 238.4, 9.999, 6.1e-4, 2.2e5, 0.003_459, -43.21]
            .map(|it| shown(Some(it)));
        let expected =
            ["0.0355", "1.00", "0.164", "238", "10.0", "6.1e-4", "2.2e5", "0.00346", "-43.2"];
        assert_eq!(texts, expected);
        assert_eq!(shown(None), "-");
    }
}
