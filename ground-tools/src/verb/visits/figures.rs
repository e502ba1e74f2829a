//! What do visits look like: histograms of revisit time, gap and dwell, as PNG and SVG.
//!
//! A figure per place and line of sight, quantity and bins:
//! `PLACE[-TELESCOPE-DETECTOR]-QUANTITY-BINS.png`, quantity `revisit`, `gap` or `dwell`, bins `log` or
//! `linear`. Of names only letters, digits, `.`, `_`, `+` and `-` stay; all else is `-`. A name that is
//! taken gets `-2`, `-3` and so on.
//!
//! Spin and precession period are in every logarithmic figure of revisits and gaps; where else they
//! and the year lie in range they are marked too. Counts are on a logarithmic axis from
//! [`LOGARITHMIC_FROM`] on, so that single long gaps are seen beside thousands of short ones.
//!
//! Limits: at most [`MOST_PAIRS`] places and lines of sight.

use crate::failure::Failure;
use crate::output::figures::Figure;
use formats::visits::{Bars, Mark, Report, Told, name, span, unit};
use pictures::{self, Axis, Chart, Drawing, Scale, Series, Shape};
use planner::opportunities::NONE;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Most places and lines of sight, six figures each.
pub(super) const MOST_PAIRS: usize = 50;
/// Largest count of a bin from which counts are drawn by their logarithms.
pub(super) const LOGARITHMIC_FROM: u64 = 50;

const WIDTH_PX: u32 = 1000;
const HEIGHT_PX: u32 = 620;
/// Room beside the outermost bins and marks on a logarithmic axis, as a ratio.
const BESIDE: f64 = 1.5;

/// What figures have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Setting<'a> {
    /// The mission.
    pub mission: &'a str,
    /// How visits were counted and when, such as `by crossings, 2032-04-01 to 2035-04-01 TDB`.
    pub counted: &'a str,
    /// Periods that are marked.
    pub marks: &'a [Mark],
}

#[derive(Clone, Copy, PartialEq)]
enum Quantity {
    Revisit,
    Gap,
    Dwell,
}

impl Quantity {
    const ALL: [Self; 3] = [Self::Revisit, Self::Gap, Self::Dwell];

    const fn name(self) -> &'static str {
        match self {
            Self::Revisit => "revisit",
            Self::Gap => "gap",
            Self::Dwell => "dwell",
        }
    }

    const fn axis(self) -> &'static str {
        match self {
            Self::Revisit => "revisit time",
            Self::Gap => "gap",
            Self::Dwell => "dwell",
        }
    }

    const fn of(self, report: &Report) -> &Told {
        match self {
            Self::Revisit => &report.revisit,
            Self::Gap => &report.gap,
            Self::Dwell => &report.dwell,
        }
    }
}

/// Says whether so many places and lines of sight can be drawn.
///
/// # Errors
/// [`Failure::Input`] with the number and the most.
pub(super) fn check(places: usize, lines: usize) -> Result<(), Failure> {
    if places.saturating_mul(lines) > MOST_PAIRS {
        return Err(Failure::Input(format!(
            "figures of {places} places through {lines} lines of sight are too many: at most \
             {MOST_PAIRS} pairs of both are drawn; name fewer places, or a --detector"
        )));
    }
    Ok(())
}

/// The six figures of every report, in the reports' order.
///
/// # Errors
/// [`Failure`] where a chart is refused.
pub(super) fn figures(setting: &Setting, reports: &[Report]) -> Result<Vec<Figure>, Failure> {
    let mut taken = BTreeSet::new();
    let stems: Vec<String> = reports.iter().map(|report| free_stem(report, &mut taken)).collect();
    let drawn: Result<Vec<Vec<Figure>>, Failure> = reports
        .par_iter()
        .zip(&stems)
        .map(|(report, stem)| {
            let mut figures = Vec::new();
            for quantity in Quantity::ALL {
                for (scale, bins) in [(Scale::Log, "log"), (Scale::Linear, "linear")] {
                    figures.push(Figure {
                        stem: format!("{stem}-{}-{bins}", quantity.name()),
                        drawing: draw(setting, report, (quantity, scale))?,
                    });
                }
            }
            Ok(figures)
        })
        .collect();
    Ok(drawn?.into_iter().flatten().collect())
}

fn free_stem(report: &Report, taken: &mut BTreeSet<String>) -> String {
    let whole = if report.telescope == NONE {
        report.target.clone()
    } else if report.detector == NONE {
        format!("{}-{}", report.target, report.telescope)
    } else {
        format!("{}-{}-{}", report.target, report.telescope, report.detector)
    };
    let plain = |c: char| if c.is_ascii_alphanumeric() || "._+-".contains(c) { c } else { '-' };
    let stem: String = whole.chars().map(plain).collect();
    let mut free = stem.clone();
    let mut number = 2;
    // Without regard to case, as some file systems have it.
    while !taken.insert(free.to_lowercase()) {
        free = format!("{stem}-{number}");
        number += 1;
    }
    free
}

fn draw(
    setting: &Setting,
    report: &Report,
    (quantity, scale): (Quantity, Scale),
) -> Result<Drawing, Failure> {
    let told = quantity.of(report);
    let bars = if scale == Scale::Log { &told.logarithmic } else { &told.linear };
    let filled = filled(bars);
    // Marks that the axis stretches to hold.
    let held: Vec<f64> = setting
        .marks
        .iter()
        .filter(|mark| mark.name != "year" && quantity != Quantity::Dwell)
        .map(|mark| mark.seconds)
        .collect();
    let seconds = match (scale, filled) {
        (Scale::Log, filled) => logarithmic_range(filled.map(|(low, high, _)| (low, high)), &held),
        (Scale::Linear, Some((_, high, _))) => (0.0, 1.04 * high),
        (Scale::Linear, None) => (0.0, held.iter().copied().fold(60.0, f64::max) * 1.1),
    };
    let (divisor, unit) = if scale == Scale::Log { (1.0, "s") } else { unit(seconds.1) };
    let most = filled.map_or(0, |(_, _, most)| most);
    let counts_by = if most >= LOGARITHMIC_FROM { Scale::Log } else { Scale::Linear };
    let edges: Vec<f64> = bars.edges_s.iter().map(|edge| edge / divisor).collect();
    let counts: Vec<f64> = bars.counts.iter().map(|&count| real(count)).collect();
    let names: Vec<String> = setting
        .marks
        .iter()
        .map(|mark| match mark.name {
            "year" => "year".to_owned(),
            name => format!("{name} {}", span(mark.seconds)),
        })
        .collect();
    let marks: Vec<pictures::Mark> = setting
        .marks
        .iter()
        .zip(&names)
        .map(|(mark, name)| pictures::Mark { at: mark.seconds / divisor, name })
        .collect();
    let title = format!("{}: {} of {}", setting.mission, quantity.axis(), name(report));
    let legend = legend(report, told, bars, quantity, setting.counted);
    let chart = Chart {
        title: &title,
        x: Axis {
            quantity: quantity.axis(),
            unit,
            scale,
            range: Some((seconds.0 / divisor, seconds.1 / divisor)),
        },
        y: Axis {
            quantity: "count in bin",
            unit: "",
            scale: counts_by,
            range: Some(match counts_by {
                Scale::Log => (0.5, 2.0 * real(most)),
                // Ticks stay whole numbers.
                Scale::Linear => (0.0, 1.06 * real(most).max(5.0)),
            }),
        },
        series: &[Series {
            name: &legend,
            shape: Shape::Histogram { edges: &edges, counts: &counts },
        }],
        marks: &marks,
        bands: &[],
        width_px: WIDTH_PX,
        height_px: HEIGHT_PX,
    };
    Ok(pictures::chart(&chart)?)
}

/// What is counted, or why nothing is.
fn legend(report: &Report, told: &Told, bars: &Bars, quantity: Quantity, counted: &str) -> String {
    let visits = match report.visits {
        0 => return format!("no visit {counted}"),
        1 => "1 visit".to_owned(),
        more => format!("{more} visits"),
    };
    let values = match (told.count, quantity) {
        (0, Quantity::Dwell) => "; none is whole".to_owned(),
        (0, _) => format!("; no {} between whole ones", quantity.name()),
        _ => String::new(),
    };
    let outside = match (bars.under, bars.over) {
        (0, 0) => String::new(),
        (under, 0) => format!("; {under} below the first bin"),
        (0, over) => format!("; {over} above the last bin"),
        (under, over) => format!("; {under} below the first bin, {over} above the last"),
    };
    format!("{visits} {counted}{values}{outside}")
}

/// Lower edge of the first filled bin, upper edge of the last, and the largest count.
fn filled(bars: &Bars) -> Option<(f64, f64, u64)> {
    let mut found: Option<(f64, f64, u64)> = None;
    for ((&low, &high), &count) in
        bars.edges_s.iter().zip(bars.edges_s.iter().skip(1)).zip(&bars.counts)
    {
        if count > 0 {
            let (first, _, most) = found.unwrap_or((low, high, count));
            found = Some((first, high, most.max(count)));
        }
    }
    found
}

/// A range that holds the filled bins and the marks, with a little beside them; at least a decade.
fn logarithmic_range(filled: Option<(f64, f64)>, held: &[f64]) -> (f64, f64) {
    let ends = filled.into_iter().chain(held.iter().map(|&mark| (mark, mark)));
    let (low, high) =
        ends.reduce(|(a, b), (low, high)| (a.min(low), b.max(high))).unwrap_or((1.0, 1000.0));
    let (low, high) = (low / BESIDE, high * BESIDE);
    let missing = (10.0 * low / high).max(1.0).sqrt();
    (low / missing, high * missing)
}

#[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
fn real(count: u64) -> f64 {
    count as f64
}
