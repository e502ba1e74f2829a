//! When is what seen, and when is it used: an overview for every reader, the zoomable timeline for those
//! with scripts.
//!
//! The overview has a strip for each telescope and target: minutes in view per day, offered and used,
//! in equal parts of the mission. Heights are square roots, so that a few minutes used show beside hours
//! offered; each strip has its own scale, told beside it.

use super::names::{Names, grouped, real};
use super::plot::{TimeAxis, colour, n, steps};
use super::source::Source;
use maud::{Markup, PreEscaped, html};

/// Parts of the mission in the overview.
const PARTS: usize = 240;
const BOX: (f64, f64) = (480.0, 24.0);

/// One telescope and target.
struct Strip<'r> {
    telescope: &'r str,
    target: usize,
    offered: Vec<f64>,
    used: Vec<f64>,
    sessions: usize,
}

pub(super) fn section(source: &Source, names: &Names) -> Markup {
    let axis = TimeAxis { start: source.world.start, end: source.world.end };
    let strips = strips(source, names, &axis);
    html! {
        p {
            "What the passes offer (pale) and what sessions use (solid), in minutes in view per day; heights are square roots, each row to its own scale. "
            span.scripted { "Below, the same in time: zoom in to minutes." }
        }
        figure.overview #overview {
            figcaption.hidden { "Overview of the mission: minutes in view per day by telescope and target" }
            @for strip in &strips {
                @let most = strip.offered.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
                @let path = |values: &[f64]| {
                    steps(&values.iter().map(|it| (it / most).sqrt()).collect::<Vec<_>>(), BOX)
                };
                div class={ "strip " (colour(strip.target)) } {
                    span.name { span.swatch aria-hidden="true" {} (strip.telescope) " " (names.targets[strip.target]) }
                    svg viewBox={ "0 0 " (n(BOX.0)) " " (n(BOX.1)) } preserveAspectRatio="none" role="img"
                        aria-label={ (strip.telescope) " " (names.targets[strip.target]) ": " (strip.sessions) " sessions" } {
                        path.offered d=(PreEscaped(path(&strip.offered))) {}
                        path.used d=(PreEscaped(path(&strip.used))) {}
                    }
                    span.num { (grouped(strip.sessions)) @if strip.sessions == 1 { " session" } @else { " sessions" } ", to " (minutes(most)) " min/d" }
                }
            }
            @if strips.is_empty() { p { "No target passes through any telescope." } }
            div.strip { span {} (axis.words()) span {} }
        }
        div.scripted #zoom {
            div.tools role="toolbar" aria-label="Timeline" aria-controls="chart" {
                button type="button" data-do="in" aria-label="Zoom in" { "+" }
                button type="button" data-do="out" aria-label="Zoom out" { "\u{2212}" }
                button type="button" data-do="left" aria-label="Earlier" { "\u{2190}" }
                button type="button" data-do="right" aria-label="Later" { "\u{2192}" }
                span.group {
                    button type="button" data-span="0" { "Mission" }
                    button type="button" data-span="2592000" { "Month" }
                    button type="button" data-span="604800" { "Week" }
                    button type="button" data-span="86400" { "Day" }
                    button type="button" data-span="7200" { "2 h" }
                }
                span.group {
                    button type="button" data-do="before" { "\u{2039} Session" }
                    button type="button" data-do="next" { "Session \u{203a}" }
                }
                label { "Day " input #day type="date"; }
            }
            div #chart tabindex="0" role="group" aria-label="Timeline of sessions" aria-describedby="keys" {
                canvas aria-hidden="true" {}
                div #tip hidden="" {}
            }
            p.legend {
                span { span.key-offered aria-hidden="true" {} " in view" }
                span { span.key-used aria-hidden="true" {} " in view and used" }
                span { span.key-session aria-hidden="true" {} " session, with setup and cooldown" }
                span #view aria-live="polite" {}
            }
            p.hint #keys { "Drag or \u{2190} \u{2192} to move, + and \u{2212} to zoom (or the wheel, once the chart has the focus, or with Ctrl), Home for the mission, N and P for the next and previous session, click a session for its details." }
            div #details aria-live="polite" { p { "No session chosen." } }
        }
    }
}

/// The rows that have any opportunity.
fn strips<'r>(source: &Source, names: &Names<'r>, axis: &TimeAxis) -> Vec<Strip<'r>> {
    let mut offered = vec![vec![0.0; PARTS]; names.classes()];
    let mut used = offered.clone();
    let mut sessions = vec![0; names.classes()];
    let per_day = real(PARTS) / axis.days() / 60.0;
    for (index, it) in source.offers.opportunities.list().iter().enumerate() {
        let class = names.class(it);
        let part = part(axis.share(it.first_entry));
        offered[class][part] += it.dwell.seconds() * per_day;
        if names.taken[index].is_some() {
            used[class][part] += it.dwell.seconds() * per_day;
            sessions[class] += 1;
        }
    }
    offered
        .into_iter()
        .zip(used)
        .enumerate()
        .filter(|(_, (offered, _))| offered.iter().any(|it| *it > 0.0))
        .map(|(class, (offered, used))| Strip {
            telescope: names.telescopes[class / names.targets.len()],
            target: class % names.targets.len(),
            offered,
            used,
            sessions: sessions[class],
        })
        .collect()
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share from 0 to 1 of a small count"
)]
fn part(share: f64) -> usize {
    ((share * real(PARTS)) as usize).min(PARTS - 1)
}

fn minutes(value: f64) -> String {
    if value < 10.0 { format!("{value:.1}") } else { format!("{value:.0}") }
}
