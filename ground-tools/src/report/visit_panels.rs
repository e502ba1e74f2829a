//! How often is each target visited, and how long until it comes back.
//!
//! A visit is a maximal time within `calibration.radius_deg` of the mission boresight, counted by
//! crossings, as `gyrfalcon visits` counts without names. Visits per day are means over equal parts of
//! the mission; revisit times fill the ten bins a decade of `gyrfalcon visits`.

use super::names::{grouped, real};
use super::plot::{TimeAxis, colour, n, steps};
use super::source::Source;
use crate::failure::Failure;
use formats::visits::{marks, span};
use maud::{Markup, PreEscaped, html};
use planner::opportunities::{boresight, search};
use planner::visits::{Counting, Visit, VisitStatistics};
use std::fmt::Write;

/// Parts of the mission in which visits are counted.
const PARTS: usize = 72;
/// Width and height of a panel's plot, and what is left and below it for words.
const PLOT: (f64, f64) = (250.0, 90.0);
const LEFT: f64 = 40.0;
const BELOW: f64 = 34.0;
const ABOVE: f64 = 16.0;

pub(super) fn section(source: &Source) -> Result<Markup, Failure> {
    let world = source.world;
    let lines = [boresight(&world.mission)?];
    let mut visits: Vec<Vec<Visit>> = vec![Vec::new(); world.targets.len()];
    for found in search(world, source.table, &lines)? {
        visits[found.target].push(Visit::from(&found.transit));
    }
    let span_of_mission = world.end.since(world.start);
    let told: Vec<VisitStatistics> = visits
        .iter()
        .map(|it| VisitStatistics::of(it, Counting::Crossings, span_of_mission))
        .collect();
    let radius = &world.mission.calibration.radius_deg;
    let cell = |value: Option<f64>| value.map_or_else(|| "\u{2013}".to_owned(), span);
    Ok(html! {
        p { "A visit is a time within " (radius) " deg of the mission boresight; a revisit runs from one entry to the next. The spin period makes visits in a row, precession turns bring them back." }
        div.panels {
            @for (index, (target, told)) in world.targets.iter().zip(&told).enumerate() {
                figure class={ "panel " (colour(index)) } {
                    figcaption { span.swatch aria-hidden="true" {} (target.name()) ": " (grouped(told.visits)) @if told.visits == 1 { " visit" } @else { " visits" } }
                    @if told.visits == 0 {
                        p.none { "The boresight never visits it in this span." }
                    } @else {
                        (per_day(source, target.name(), &visits[index]))
                        (revisits(source, target.name(), told))
                    }
                }
            }
        }
        div.scroll tabindex="0" role="region" aria-label="Visits by target" {
            table {
                caption { "Visits of the mission boresight" }
                thead { tr {
                    th scope="col" { "target" } th.num scope="col" { "visits" } th.num scope="col" { "per day" }
                    th.num scope="col" { "in view" } th.num scope="col" { "shortest revisit" }
                    th.num scope="col" { "median" } th.num scope="col" { "mean" } th.num scope="col" { "longest" }
                } }
                tbody { @for (target, told) in world.targets.iter().zip(&told) {
                    @let spread = told.revisit.spread;
                    tr {
                        th scope="row" { (target.name()) }
                        td.num { (grouped(told.visits)) } td.num { (format!("{:.3}", told.per_day)) }
                        td.num { (span(told.total_dwell.seconds())) }
                        td.num { (cell(spread.map(|it| it.shortest_s))) } td.num { (cell(spread.map(|it| it.median_s))) }
                        td.num { (cell(spread.map(|it| it.mean_s))) } td.num { (cell(spread.map(|it| it.longest_s))) }
                    }
                } }
            }
        }
    })
}

/// An empty panel: frame, the largest value, a title; the plot in the middle.
fn panel(title: &str, label: &str, most: &str, inside: &Markup, below: &Markup) -> Markup {
    let (width, height) = PLOT;
    let whole = (LEFT + width + 16.0, ABOVE + height + BELOW);
    html! {
        svg viewBox={ "0 0 " (n(whole.0)) " " (n(whole.1)) } role="img" aria-label=(label) {
            text x=(n(LEFT)) y="11" { (title) }
            text.end x=(n(LEFT - 5.0)) y=(n(ABOVE + 9.0)) { (most) }
            text.end x=(n(LEFT - 5.0)) y=(n(ABOVE + height)) { "0" }
            g transform={ "translate(" (n(LEFT)) " " (n(ABOVE)) ")" } {
                (inside)
                path.axis d={ "M0 0V" (n(height)) "H" (n(width)) } {}
                (below)
            }
        }
    }
}

fn per_day(source: &Source, target: &str, visits: &[Visit]) -> Markup {
    let axis = TimeAxis { start: source.world.start, end: source.world.end };
    let mut counts = vec![0_usize; PARTS];
    for visit in visits {
        let share = axis.share(visit.entry);
        let part = (0..PARTS).rfind(|&part| real(part) <= share * real(PARTS)).unwrap_or(0);
        counts[part] += 1;
    }
    let rates: Vec<f64> = counts.iter().map(|&it| real(it) * real(PARTS) / axis.days()).collect();
    let most = rates.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let heights: Vec<f64> = rates.iter().map(|it| it / most).collect();
    let ticks = axis.ticks();
    let every = ticks.len().div_ceil(4).max(1);
    let below = html! {
        @for (share, text) in ticks.iter().step_by(every) {
            path.axis d={ "M" (n(share * PLOT.0)) " " (n(PLOT.1)) "v4" } {}
            text.mid x=(n(share * PLOT.0)) y=(n(PLOT.1 + 16.0)) { (text) }
        }
    };
    let inside = html! { path.used d=(PreEscaped(steps(&heights, PLOT))) {} };
    let label = format!("{target}: visits per day over the mission, {most:.2} at most");
    panel("visits per day", &label, &format!("{most:.1}"), &inside, &below)
}

fn revisits(source: &Source, target: &str, told: &VisitStatistics) -> Markup {
    let histogram = &told.revisit.logarithmic;
    let marks = marks(source.world);
    // From below the spin period to above the longest wait, whole decades.
    let longest = told.revisit.spread.map_or(1.0, |it| it.longest_s);
    let shortest = told.revisit.spread.map_or(longest, |it| it.shortest_s);
    let least = shortest.min(marks[0].seconds).log10().floor();
    let largest = longest.max(marks[1].seconds).log10().floor() + 1.0;
    let x = |seconds: f64| PLOT.0 * (seconds.log10() - least) / (largest - least);
    let most = histogram.counts.iter().copied().max().unwrap_or(0).max(1);
    #[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
    let height = |count: u64| {
        if count == 0 { 0.0 } else { PLOT.1 * (1.0 + count as f64).ln() / (1.0 + most as f64).ln() }
    };
    let edges = histogram.edges_s.windows(2);
    let mut bars = String::new();
    for (edge, &count) in edges.zip(&histogram.counts).filter(|it| *it.1 > 0) {
        let (left, right, up) = (x(edge[0]), x(edge[1]), height(count));
        let [left, right] = [left, right].map(n);
        let _ = write!(bars, "M{left} {}H{right}v{}H{left}Z", n(PLOT.1), n(-up));
    }
    let decades: Vec<f64> = {
        let mut at = least;
        let mut all = Vec::new();
        while at <= largest {
            all.push(at);
            at += 1.0;
        }
        all
    };
    let below = html! {
        @for &decade in &decades {
            path.axis d={ "M" (n(x(10.0_f64.powf(decade)))) " " (n(PLOT.1)) "v4" } {}
        }
        @for (seconds, name) in [(60.0, "1 min"), (3600.0, "1 h"), (86_400.0, "1 d"), (2_592_000.0, "30 d"), (31_557_600.0, "1 y")] {
            @let at = x(seconds);
            @if (0.0..=PLOT.0).contains(&at) {
                path.axis d={ "M" (n(at)) " " (n(PLOT.1)) "v7" } {}
                text.mid x=(n(at)) y=(n(PLOT.1 + 19.0)) { (name) }
            }
        }
    };
    let inside = html! {
        path.used d=(PreEscaped(bars)) {}
        @for mark in marks.iter().filter(|it| it.name != "year") {
            @let at = x(mark.seconds);
            path.mark d={ "M" (n(at)) " 0V" (n(PLOT.1)) } {}
            text.small x=(n(at + 3.0)) y="9" { (mark.name) }
        }
    };
    let label = format!(
        "{target}: histogram of revisit times, logarithmic, {} values, from {} to {}",
        told.revisit.spread.map_or(0, |it| it.count),
        span(shortest),
        span(longest)
    );
    panel("revisit time (counts by logarithm)", &label, &most.to_string(), &inside, &below)
}
