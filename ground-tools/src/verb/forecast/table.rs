//! A forecast as text: errors per detector or channel, what cannot be told apart, requirements.
//!
//! Limits: of more than [`MOST_LINES`] detectors the median and the worst of each channel are shown.

use super::answer::Answer;
use ephem::source::Source;
use formats::forecast::Told;
use planner::information::{Measure, Parameter, Row, SHORT, verdicts};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Detectors that have a line each.
const MOST_LINES: usize = 40;

/// What columns show.
const COLUMNS: [(&str, Measure); 11] = [
    ("gain", Measure::Parameter(Parameter::Gain)),
    ("x", Measure::Parameter(Parameter::OffsetX)),
    ("y", Measure::Parameter(Parameter::OffsetY)),
    ("width", Measure::Parameter(Parameter::Width)),
    ("e_plus", Measure::Parameter(Parameter::EPlus)),
    ("e_cross", Measure::Parameter(Parameter::ECross)),
    ("tau", Measure::Parameter(Parameter::TimeConstant)),
    ("angle", Measure::Parameter(Parameter::PolarisationAngle)),
    ("-20 dB", Measure::Known(-20.0)),
    ("-30 dB", Measure::Known(-30.0)),
    ("seen", Measure::Seen),
];
const UNITS: [&str; 11] =
    ["%", "arcsec", "arcsec", "%", "%", "%", "ms", "deg", "arcmin", "arcmin", "arcmin"];

/// The whole text.
pub(super) fn text(answer: &Answer<'_>) -> String {
    let windows = answer.windows.of_kind(0).len();
    let targets: Vec<&str> = answer.world.targets.iter().map(Source::name).collect();
    let mut text = format!(
        "{}: errors at one standard deviation, all others free, {} together{}{}\n\n",
        answer.world.mission.name,
        targets.join(", "),
        if answer.sessions.is_some() { ", in the plan's sessions" } else { "" },
        if windows > 1 { format!(", the worst of {windows} windows") } else { String::new() },
    );
    line(&mut text, "", COLUMNS.iter().map(|it| it.0.to_owned()));
    line(&mut text, "", UNITS.iter().map(|it| (*it).to_owned()));
    for (name, cells) in lines(answer) {
        line(&mut text, &name, cells.iter().map(|it| shown(*it)));
    }
    apart(&mut text, answer);
    required(&mut text, answer);
    text
}

fn line(text: &mut String, name: &str, cells: impl Iterator<Item = String>) {
    let _ = write!(text, "{name:<22}");
    for cell in cells {
        let _ = write!(text, " {cell:>8}");
    }
    text.push('\n');
}

/// Three digits; a dash for what is not measured.
fn shown(value: Option<f64>) -> String {
    match value {
        None => "-".to_owned(),
        Some(value) if value >= 1e5 || (value > 0.0 && value < 1e-3) => format!("{value:.1e}"),
        Some(value) if value >= 100.0 => format!("{value:.0}"),
        Some(value) if value >= 10.0 => format!("{value:.1}"),
        Some(value) if value >= 1.0 => format!("{value:.2}"),
        Some(value) => format!("{value:.4}"),
    }
}

type Cells = [Option<f64>; COLUMNS.len()];

/// A line per look, the worst window; or the median and the worst per channel.
fn lines(answer: &Answer<'_>) -> Vec<(String, Cells)> {
    let mut of_looks: Vec<Cells> = vec![[Some(0.0); COLUMNS.len()]; answer.looks.len()];
    for row in answer.rows.iter().filter(|it| it.target.is_none() && it.requirement.is_none()) {
        let Some(column) = COLUMNS.iter().position(|it| same(&it.1, &row.measure)) else {
            continue;
        };
        let cell = &mut of_looks[row.look][column];
        let value = row.value.map(|value| row.told(value).1);
        let radius = column >= 8;
        *cell = match (*cell, value) {
            (Some(worst), Some(value)) if radius && worst > 0.0 => Some(worst.min(value)),
            (Some(worst), Some(value)) => Some(worst.max(value)),
            _ => None,
        };
    }
    if answer.looks.len() <= MOST_LINES {
        return answer.looks.iter().map(planner::information::Look::key).zip(of_looks).collect();
    }
    let mut channels: BTreeMap<String, Vec<Cells>> = BTreeMap::new();
    for (look, cells) in answer.looks.iter().zip(of_looks) {
        let channel = look.channel.as_deref().unwrap_or("-");
        let name = format!("{}/{channel}", look.line.telescope_name);
        channels.entry(name).or_default().push(cells);
    }
    let mut lines = Vec::new();
    for (name, all) in channels {
        let at = |rank: &dyn Fn(usize) -> usize| -> Cells {
            std::array::from_fn(|column| {
                let mut values: Vec<f64> = all
                    .iter()
                    .map(|it| it[column].unwrap_or(if column >= 8 { 0.0 } else { f64::INFINITY }))
                    .collect();
                values.sort_by(f64::total_cmp);
                if column >= 8 {
                    values.reverse();
                }
                values.get(rank(values.len())).copied().filter(|it| it.is_finite() && *it > 0.0)
            })
        };
        lines.push((format!("{name} median"), at(&|count| count / 2)));
        lines.push((format!("{name} worst of {}", all.len()), at(&|count| count - 1)));
    }
    lines
}

/// Whether two measures are the same column's.
fn same(one: &Measure, other: &Measure) -> bool {
    match (one, other) {
        (Measure::Known(a), Measure::Known(b)) => (a - b).abs() < 0.5,
        _ => one == other,
    }
}

/// What cannot be told apart, once per pair with the number of looks.
fn apart(text: &mut String, answer: &Answer<'_>) {
    let mut pairs: BTreeMap<(Parameter, Parameter), (usize, f64, &'static str)> = BTreeMap::new();
    for look in 0..answer.looks.len() {
        for it in answer.errors(look).degeneracies {
            let entry = pairs.entry((it.one, it.other)).or_insert((0, 0.0, it.broken_by()));
            entry.0 += 1;
            if it.correlation.abs() > entry.1.abs() {
                entry.1 = it.correlation;
            }
        }
    }
    if pairs.is_empty() {
        text.push_str("\nNo two errors are correlated by 0.9 or more.\n");
        return;
    }
    text.push_str("\nHard to tell apart (correlation of errors, the strongest):\n");
    for ((one, other), (count, correlation, broken_by)) in pairs {
        let of = answer.looks.len();
        let _ = writeln!(
            text,
            "  {} and {}: {correlation:.3}, {count} of {of}; told apart by {broken_by}",
            one.name(),
            other.name()
        );
    }
}

/// Whether it is enough.
fn required(text: &mut String, answer: &Answer<'_>) {
    let requirements = &answer.world.mission.calibration.requirements;
    if requirements.is_empty() {
        return;
    }
    text.push_str("\nRequirements:\n");
    for (it, verdict) in requirements.iter().zip(verdicts(&answer.rows, requirements.len())) {
        let every = it.every_days.as_ref().map(|days| format!(" every {days} d"));
        let _ = write!(
            text,
            "  {} {}{} of {}: ",
            it.quantity.key(),
            it.sigma_text,
            every.unwrap_or_default(),
            it.telescope
        );
        let Some(verdict) = verdict else {
            text.push_str("nobody asked for is meant\n");
            continue;
        };
        let told = Told::new(answer.world, answer.looks, &verdict.worst);
        let worst = worst(answer, &verdict.worst, &told);
        if verdict.met == verdict.of {
            let _ = writeln!(text, "met; least by {worst}");
        } else {
            let missed = verdict.of - verdict.met;
            let _ = writeln!(text, "MISSED in {missed} of {} cases; most by {worst}", verdict.of);
        }
    }
}

fn worst(answer: &Answer<'_>, row: &Row, told: &Told) -> String {
    let value = match told.sigma {
        Some(sigma) => format!("{} {}", shown_signed(sigma), told.unit),
        None => "not measured".to_owned(),
    };
    let from = &ephem::time::format_utc(row.window.0)[..10];
    let until = &ephem::time::format_utc(row.window.1)[..10];
    format!("{} ({} {value}, {from} to {until})", answer.looks[row.look].key(), told.quantity)
}

fn shown_signed(value: f64) -> String {
    if value < 0.0 { format!("{value:.1}") } else { shown(Some(value)) }
}

/// What is left out, in sentences.
pub(super) fn left_out(answer: &Answer<'_>) -> Vec<String> {
    let mut by_target: BTreeMap<Option<usize>, Vec<String>> = BTreeMap::new();
    for left in &answer.forecast.left {
        by_target.entry(left.target).or_default().push(answer.looks[left.look].key());
    }
    let few = |names: &[String]| match names {
        [first, .., last] if names.len() > 4 => {
            format!("{} lines of sight from {first} to {last}", names.len())
        }
        _ => names.join(", "),
    };
    let mut told: Vec<String> = by_target
        .iter()
        .map(|(target, names)| match target {
            None => format!("left out for want of net_uk_rts or frequency_ghz: {}", few(names)),
            Some(target) => format!(
                "{} has no known strength in the bands of {}",
                answer.world.targets[*target].name(),
                few(names)
            ),
        })
        .collect();
    let long: Vec<String> = (0..answer.looks.len())
        .filter(|&look| {
            answer.windows.of_kind(0).any(|window| answer.forecast.together(look, window).long > 0)
        })
        .map(|look| answer.looks[look].key())
        .collect();
    if !long.is_empty() {
        told.push(format!(
            "passes are not short beside the noise's knee, 1/f leaves less than {} % of the information: {}",
            100.0 * SHORT,
            few(&long)
        ));
    }
    told
}
