//! Every session, month by month, for those who read or print without scripts.

use super::Source;
use super::names::{grouped, second, total};
use super::opportunity_data::psi_range;
use crate::timeline::Session;
use maud::{Markup, html};

pub(super) fn section(source: &Source) -> Markup {
    let sessions = &source.timeline.sessions;
    let months: Vec<&[Session]> =
        sessions.chunk_by(|a, b| a.start_utc.get(..7) == b.start_utc.get(..7)).collect();
    html! {
        p { "Start and end (UTC) hold setup and cooldown; psi is the crossing angle at closest approach, of all passes of a session. " code { "timeline.json" } " has TDB, TAI and every pass." }
        @if months.is_empty() { p { "There is no session." } }
        div.months { @for (index, month) in months.iter().enumerate() {
            @let name = month.first().and_then(|it| it.start_utc.get(..7)).unwrap_or_default();
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
                        } }
                        tbody { @for it in *month { (row(it)) } }
                    }
                }
            }
        } }
    }
}

fn row(it: &Session) -> Markup {
    let (start, end) = (second(&it.start_utc), second(&it.end_utc));
    let same_day = start.get(..10) == end.get(..10);
    let (low, high) = psi_range(it);
    let psi =
        if high - low < 0.05 { format!("{low:.1}") } else { format!("{low:.1} to {high:.1}") };
    html! { tr {
        td { (it.id) }
        td { (start) }
        td { (if same_day { end.get(11..).unwrap_or(&end) } else { &end }) }
        td { (it.transits.len()) }
        td { (format!("{:.1}", it.dwell_s)) }
        td { (psi) }
    } }
}
