//! What changed against an earlier plan.
//!
//! A session with the same id in both plans is kept, or moved where its times differ.

use super::names::{grouped, second};
use crate::timeline::Against;
use maud::{Markup, html};

/// What an earlier plan and this one do not share.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Difference {
    /// What the earlier plan is called: its file, and its digest where there is one.
    pub against: String,
    /// Sessions in both at the same times.
    pub kept: usize,
    /// Sessions that the earlier plan did not have, by start.
    pub added: Vec<Entry>,
    /// Sessions that only the earlier plan had, by start.
    pub dropped: Vec<Entry>,
    /// Sessions in both at other times, by their new start.
    pub moved: Vec<Moved>,
    /// This plan's objective less the earlier one's.
    pub objective: f64,
}

impl Difference {
    /// As the timeline holds it; `sha256` is of the earlier plan.
    #[must_use]
    pub fn by_ids(&self, sha256: &str) -> Against {
        let ids = |list: &[Entry]| list.iter().map(|it| it.id.clone()).collect();
        Against {
            sha256: sha256.to_owned(),
            kept: self.kept,
            added: ids(&self.added),
            dropped: ids(&self.dropped),
            moved: self.moved.iter().map(|it| it.now.id.clone()).collect(),
        }
    }
}

/// A session as the timeline tells it.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Telescope, target and precession turn.
    pub id: String,
    /// Telescope's name.
    pub telescope: String,
    /// Target's name.
    pub target: String,
    /// Start, setup included, UTC.
    pub start_utc: String,
    /// End, cooldown included, UTC.
    pub end_utc: String,
    /// Time with the target in view.
    pub dwell_s: f64,
}

/// A session at other times than before.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// As it was.
    pub before: Entry,
    /// As it is.
    pub now: Entry,
}

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
                        td { (second(&it.start_utc)) } td { (second(&it.end_utc)) }
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
                        th scope="row" { (it.now.id) } td { (second(&it.before.start_utc)) }
                        td { (second(&it.now.start_utc)) } td.num { (format!("{:.1}", it.before.dwell_s)) }
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

    fn entry(id: &str) -> Entry {
        Entry {
            id: id.to_owned(),
            telescope: "MFT".to_owned(),
            target: "jupiter".to_owned(),
            start_utc: "2032-04-01T05:28:02.730323723Z".to_owned(),
            end_utc: "2032-04-01T05:43:55.800168283Z".to_owned(),
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
