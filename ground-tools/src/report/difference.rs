//! What changed against an earlier plan.
//!
//! A session with the same id in both plans is kept, or moved where its times differ.

use super::names::{grouped, second};
use formats::timeline::{Difference, Entry, Moved};
use maud::{Markup, html};

pub(super) fn section(difference: &Difference) -> Markup {
    let changes = difference.added.len() + difference.dropped.len() + difference.moved.len();
    html! {
        p {
            "Against " strong { (difference.against) } ": "
            @if changes == 0 { "no session changed; " }
            @else {
                (grouped(difference.added.len())) " added, " (grouped(difference.dropped.len())) " dropped, "
                (grouped(difference.moved.len())) " moved, "
            }
            (grouped(difference.kept)) " kept. The objective changes by " (format!("{:+.1}", difference.objective)) "."
        }
        @if !difference.added.is_empty() { (entries("Added", "+", &difference.added)) }
        @if !difference.dropped.is_empty() { (entries("Dropped", "\u{2212}", &difference.dropped)) }
        @if !difference.moved.is_empty() { (moves(&difference.moved)) }
    }
}

fn entries(title: &str, sign: &str, entries: &[Entry]) -> Markup {
    html! {
        details open[entries.len() <= 40] {
            summary { (title) ": " (grouped(entries.len())) }
            div.scroll tabindex="0" role="region" aria-label=(title) {
                table {
                    caption { (title) " sessions" }
                    thead { tr {
                        th scope="col" { "id" } th scope="col" { "telescope" } th scope="col" { "target" }
                        th scope="col" { "start (UTC)" } th scope="col" { "end (UTC)" } th.num scope="col" { "in view (s)" }
                    } }
                    tbody { @for it in entries { tr {
                        th scope="row" { (sign) " " (it.id) } td { (it.telescope) } td { (it.target) }
                        td { (second(it.start)) } td { (second(it.end)) }
                        td.num { (format!("{:.1}", it.dwell_s)) }
                    } } }
                }
            }
        }
    }
}

fn moves(moved: &[Moved]) -> Markup {
    html! {
        details open[moved.len() <= 40] {
            summary { "Moved: " (grouped(moved.len())) }
            div.scroll tabindex="0" role="region" aria-label="Moved" {
                table {
                    caption { "Moved sessions" }
                    thead { tr {
                        th scope="col" { "id" } th scope="col" { "start before (UTC)" } th scope="col" { "start now (UTC)" }
                        th.num scope="col" { "in view before (s)" } th.num scope="col" { "now (s)" }
                    } }
                    tbody { @for it in moved { tr {
                        th scope="row" { (it.now.id) } td { (second(it.before.start)) }
                        td { (second(it.now.start)) } td.num { (format!("{:.1}", it.before.dwell_s)) }
                        td.num { (format!("{:.1}", it.now.dwell_s)) }
                    } } }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ephem::time::parse_time;

    fn entry(id: &str) -> Entry {
        Entry {
            id: id.to_owned(),
            telescope: "MFT".to_owned(),
            target: "jupiter".to_owned(),
            start: parse_time("2032-04-01T05:28:02.730323723Z").unwrap(),
            end: parse_time("2032-04-01T05:43:55.800168283Z").unwrap(),
            dwell_s: 53.07,
        }
    }

    #[test]
    fn every_change_is_told() {
        let difference = Difference {
            against: "old/timeline.json".to_owned(),
            kept: 1234,
            added: vec![entry("MFT-jupiter-000001")],
            dropped: vec![entry("MFT-<b>-000002")],
            moved: vec![Moved { before: entry("x"), now: entry("MFT-jupiter-000003") }],
            objective: -3.25,
        };
        let page = section(&difference).into_string();
        for text in
            ["1 added, 1 dropped, 1 moved", "1\u{202f}234 kept", "MFT-&lt;b&gt;-000002", "-3.2"]
        {
            assert!(page.contains(text), "{text}");
        }
        let same = section(&Difference { kept: 1, ..Difference::default() }).into_string();
        assert!(same.contains("no session changed") && !same.contains("<table"));
    }
}
