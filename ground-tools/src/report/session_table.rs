//! Every session, month by month, for those who read or print without scripts.

use super::names::{grouped, second, total};
use super::opportunity_data::psi_range;
use super::source::Source;
use ephem::time::{civil_from_day, utc_day};
use formats::timeline::Session;
use maud::{Markup, html};
use onboard_core::time::Instant;

pub(super) fn section(source: &Source) -> Markup {
    let sessions = &source.timeline.sessions;
    let months: Vec<&[Session]> =
        sessions.chunk_by(|a, b| month_of(a.start()) == month_of(b.start())).collect();
    html! {
        p { "Start and end (UTC) hold setup and cooldown; psi is the crossing angle and impact the offset across the scan, both at closest approach, of all passes of a session; signal is the antenna temperature at the beam's centre; HWP says how evenly the time in view covers the plate's phases, from 0 to 1. " code { "timeline.json" } " has TDB, TAI and every pass." }
        @if months.is_empty() { p { "There is no session." } }
        div.months { @for (index, month) in months.iter().enumerate() {
            @let name = month.first().map_or_else(String::new, |it| named(month_of(it.start())));
            details open[index == 0 && month.len() <= 60] {
                summary {
                    (name) ": " (grouped(month.len())) @if month.len() == 1 { " session, " } @else { " sessions, " }
                    (format!("{:.2}", total(month.iter().map(|it| it.dwell_s)) / 3600.0)) " h"
                }
                div.scroll tabindex="0" role="region" aria-label={ "Sessions of " (name) } {
                    table.sessions {
                        caption { "Sessions that start in " (name) }
                        thead { tr {
                            th scope="col" { "id" } th scope="col" { "start (UTC)" } th scope="col" { "end" }
                            th.num scope="col" { "passes" } th.num scope="col" { "in view (s)" } th.num scope="col" { "psi (deg)" }
                            th.num scope="col" { "impact (deg)" } th.num scope="col" { "signal (mK)" } th.num scope="col" { "HWP" }
                        } }
                        tbody { @for it in *month { (row(it)) } }
                    }
                }
            }
        } }
    }
}

/// Year and month, UTC.
fn month_of(at: Instant) -> (i64, i64) {
    let (year, month, _) = civil_from_day(utc_day(at));
    (year, month)
}

fn named((year, month): (i64, i64)) -> String {
    format!("{year:04}-{month:02}")
}

fn row(it: &Session) -> Markup {
    let (start, end) = (second(it.start()), second(it.end()));
    let same_day = utc_day(it.start()) == utc_day(it.end());
    let (low, high) = psi_range(it);
    let psi = span(low, high, 1);
    html! { tr {
        td { (it.id) }
        td { (start) }
        td { (if same_day { end.get(11..).unwrap_or(&end) } else { &end }) }
        td { (it.transits.len()) }
        td { (format!("{:.1}", it.dwell_s)) }
        td { (psi) }
        td { (span(it.impact_min_deg, it.impact_max_deg, 2)) }
        td { (it.signal.antenna_temperature_mk.map_or_else(String::new, significant)) }
        td { (it.hwp_coverage.map_or_else(String::new, |it| format!("{it:.3}"))) }
    } }
}

/// A range, or one number where it has no length to see.
fn span(low: f64, high: f64, digits: usize) -> String {
    let texts = [low, high].map(|it| format!("{it:.digits$}"));
    if texts[0] == texts[1] { texts[0].clone() } else { format!("{} to {}", texts[0], texts[1]) }
}

/// Three digits that count.
fn significant(number: f64) -> String {
    match number {
        it if it >= 100.0 => format!("{it:.0}"),
        it if it >= 10.0 => format!("{it:.1}"),
        it if it >= 1.0 => format!("{it:.2}"),
        it => format!("{it:.3}"),
    }
}
