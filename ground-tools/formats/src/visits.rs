//! What is told of visits: one report per place and line of sight, with all that a figure needs.
//!
//! Times in seconds, and instants as TDB text and ns of TAI. [`marks`] are the periods that show in
//! histograms of revisits: spin, precession, a year.
//!
//! # Example
//! Three visits of a minute, 20 min apart:
//! ```
//! use formats::visits::{Report, span};
//! use planner::time::{Duration, Instant};
//! use planner::visits::{Counting, Visit, VisitStatistics};
//!
//! let at = |minute: u32| {
//!     Instant::from_tai_ns(0).plus(Duration::from_seconds(60.0 * f64::from(minute)))
//! };
//! let visits = [10, 30, 50].map(|minute| {
//!     let (entry, exit) = (at(minute), at(minute + 1));
//!     Visit { entry, exit, entry_clipped: false, exit_clipped: false }
//! });
//! let found = VisitStatistics::of(&visits, Counting::Crossings, Duration::from_seconds(3600.0));
//! let report = Report::new("jupiter", ("MFT", "-"), &found);
//! assert_eq!((report.visits, report.visits_per_day), (3, 72.0));
//! assert_eq!(report.revisit.median_s.map(span), Some("20.00 min".to_owned()));
//! ```

use ephem::time::format_tdb;
use onboard_core::time::Instant;
use onboard_core::visits::Spacing;
use planner::visits::{Gap, Histogram, Spans, Spread, VisitStatistics};
use planner::world::World;
use serde::Serialize;
use std::fmt::Write;

/// Which ends of a span in view are the mission's own.
#[must_use]
pub const fn clipped(entry: bool, exit: bool) -> &'static str {
    match (entry, exit) {
        (false, false) => "",
        (true, false) => "entry",
        (false, true) => "exit",
        (true, true) => "both",
    }
}

/// 365.25 d in seconds.
const YEAR_S: f64 = 31_557_600.0;

/// A period worth a line in a histogram.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mark {
    /// `spin`, `precession` or `year`.
    pub name: &'static str,
    /// The period.
    pub seconds: f64,
}

/// The visits of one place through one line of sight.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The planet, pixel or direction.
    pub target: String,
    /// Telescope, or `-`.
    pub telescope: String,
    /// Detector, or `-`.
    pub detector: String,
    /// Visits, clipped ones included.
    pub visits: usize,
    /// Visits at the mission's start or end.
    pub clipped: usize,
    /// Visits per day.
    pub visits_per_day: f64,
    /// Time inside altogether.
    pub total_dwell_s: f64,
    /// Of whole visits.
    pub dwell: Told,
    /// Next entry less this entry.
    pub revisit: Told,
    /// Next entry less this exit.
    pub gap: Told,
    /// The longest, the longest first.
    pub longest_gaps: Vec<ToldGap>,
}

/// How spans of one kind are spread; values are null where there are none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Told {
    /// How many.
    pub count: usize,
    /// The shortest.
    pub shortest_s: Option<f64>,
    /// The median.
    pub median_s: Option<f64>,
    /// The mean.
    pub mean_s: Option<f64>,
    /// The longest.
    pub longest_s: Option<f64>,
    /// Ten bins a decade from 1 ms to 1e8 s.
    pub logarithmic: Bars,
    /// Bins of a round width from 0.
    pub linear: Bars,
}

/// A histogram.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bars {
    /// `logarithmic` or `linear`.
    pub spacing: &'static str,
    /// Edges, one more than bins; the lower one belongs to its bin.
    pub edges_s: Vec<f64>,
    /// Values in each bin.
    pub counts: Vec<u64>,
    /// Values below the first bin.
    pub under: u64,
    /// Values at or above the end of the last bin.
    pub over: u64,
}

/// A gap with its times.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ToldGap {
    /// Its length.
    pub seconds: f64,
    /// Exit of the visit before.
    pub from_tdb: String,
    /// Entry of the visit after.
    pub until_tdb: String,
    /// Exit of the visit before, ns of TAI.
    pub from_tai_ns: i64,
    /// Entry of the visit after, ns of TAI.
    pub until_tai_ns: i64,
}

/// The periods of a mission that show in its revisits.
#[must_use]
pub fn marks(world: &World) -> Vec<Mark> {
    let scan = &world.mission.scan;
    let minutes =
        |name, period: &mission::number::Number| Mark { name, seconds: period.to_f64() * 60.0 };
    vec![
        minutes("spin", &scan.spin_period_min),
        minutes("precession", &scan.precession_period_min),
        Mark { name: "year", seconds: YEAR_S },
    ]
}

impl Report {
    /// Of the statistics of a place, and through which telescope and detector.
    #[must_use]
    pub fn new(target: &str, (telescope, detector): (&str, &str), found: &VisitStatistics) -> Self {
        Self {
            target: target.to_owned(),
            telescope: telescope.to_owned(),
            detector: detector.to_owned(),
            visits: found.visits,
            clipped: found.clipped,
            visits_per_day: found.per_day,
            total_dwell_s: found.total_dwell.seconds(),
            dwell: told(&found.dwell),
            revisit: told(&found.revisit),
            gap: told(&found.gap),
            longest_gaps: found.longest_gaps.iter().map(told_gap).collect(),
        }
    }
}

fn told(spans: &Spans) -> Told {
    let pick = |value: fn(&Spread) -> f64| spans.spread.as_ref().map(value);
    Told {
        count: spans.spread.map_or(0, |spread| spread.count),
        shortest_s: pick(|it| it.shortest_s),
        median_s: pick(|it| it.median_s),
        mean_s: pick(|it| it.mean_s),
        longest_s: pick(|it| it.longest_s),
        logarithmic: bars(&spans.logarithmic),
        linear: bars(&spans.linear),
    }
}

fn bars(histogram: &Histogram) -> Bars {
    Bars {
        spacing: match histogram.spacing {
            Spacing::Linear => "linear",
            Spacing::Logarithmic => "logarithmic",
        },
        edges_s: histogram.edges_s.clone(),
        counts: histogram.counts.clone(),
        under: histogram.under,
        over: histogram.over,
    }
}

fn told_gap(gap: &Gap) -> ToldGap {
    ToldGap {
        seconds: gap.length().seconds(),
        from_tdb: format_tdb(gap.from),
        until_tdb: format_tdb(gap.until),
        from_tai_ns: gap.from.tai_ns(),
        until_tai_ns: gap.until.tai_ns(),
    }
}

/// The reports for a person: a table, then the longest gaps.
#[must_use]
pub fn text(title: &str, marks: &[Mark], reports: &[Report]) -> String {
    let mut text = format!("{title}\n");
    let periods: Vec<String> =
        marks.iter().map(|mark| format!("{} {}", mark.name, span(mark.seconds))).collect();
    let _ = writeln!(text, "periods: {}\n", periods.join(", "));
    let names: Vec<String> = reports.iter().map(name).collect();
    let width = names.iter().map(String::len).max().unwrap_or(0).max(6);
    let _ = writeln!(
        text,
        "{:<width$} {:>7} {:>8} {:>10}   revisit: {:>10} {:>10} {:>10} {:>10}",
        "target", "visits", "per day", "dwell", "shortest", "median", "mean", "longest"
    );
    for (name, report) in names.iter().zip(reports) {
        let cell = |value: Option<f64>| value.map_or("-".to_owned(), span);
        let told = &report.revisit;
        let _ = writeln!(
            text,
            "{name:<width$} {:>7} {:>8.3} {:>10}            {:>10} {:>10} {:>10} {:>10}",
            report.visits,
            report.visits_per_day,
            span(report.total_dwell_s),
            cell(told.shortest_s),
            cell(told.median_s),
            cell(told.mean_s),
            cell(told.longest_s),
        );
    }
    for (name, report) in names.iter().zip(reports) {
        if report.visits == 0 {
            let _ = writeln!(text, "\n{name}: no visit");
        } else if !report.longest_gaps.is_empty() {
            let _ = writeln!(text, "\n{name}, longest gaps:");
            for gap in &report.longest_gaps {
                let [from, until] = [gap.from_tai_ns, gap.until_tai_ns].map(second);
                let _ = writeln!(text, "{:>10}  {from} to {until} TDB", span(gap.seconds));
            }
        }
    }
    text
}

/// `YYYY-MM-DDThh:mm:ss`, TDB.
fn second(tai_ns: i64) -> String {
    let mut text = format_tdb(Instant::from_tai_ns(tai_ns));
    text.truncate(19);
    text
}

/// What a report is of: the target, and through which telescope and detector.
#[must_use]
pub fn name(report: &Report) -> String {
    if report.telescope == planner::opportunities::NONE {
        report.target.clone()
    } else {
        format!("{} {}/{}", report.target, report.telescope, report.detector)
    }
}

/// A span in the unit that suits it.
#[must_use]
pub fn span(seconds: f64) -> String {
    let (divisor, unit) = unit(seconds);
    format!("{:.2} {unit}", seconds / divisor)
}

/// The unit that suits a span, and how many seconds it has.
#[must_use]
pub fn unit(seconds: f64) -> (f64, &'static str) {
    match seconds {
        s if s < 120.0 => (1.0, "s"),
        s if s < 7_200.0 => (60.0, "min"),
        s if s < 172_800.0 => (3_600.0, "h"),
        _ => (86_400.0, "d"),
    }
}
