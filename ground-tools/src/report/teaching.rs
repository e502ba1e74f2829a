//! What does the plan teach: requirements, errors by channel, what cannot be told apart.

use super::names::grouped;
use super::source::Source;
use formats::forecast::{COLUMNS, apart, left_out, lines, shown};
use maud::{Markup, html};
use planner::information::Teaching;

pub(super) fn section(source: &Source) -> Markup {
    let taught = source.taught;
    html! {
        @match &taught.teaching {
            Err(error) => p.none { "Nothing can be told of what the sessions teach: " (error) "." },
            Ok(teaching) => {
                @if !taught.required.is_empty() { (required(source)) }
                (errors(teaching))
                (degenerate(teaching))
                @let left = left_out(source.world, teaching);
                @if !left.is_empty() { ul { @for it in &left { li { (it) "." } } } }
            }
        }
    }
}

fn required(source: &Source) -> Markup {
    html! {
        div.scroll tabindex="0" role="region" aria-label="Requirements" {
            table.rules {
                caption { "Requirements" }
                thead { tr { th scope="col" { "what is required" } th scope="col" { "of this plan" } } }
                tbody { @for it in &source.taught.required { tr {
                    th scope="row" { (it.name()) }
                    td class=(if it.is_missed() { "bad" } else { "good" }) { (it.sentence()) }
                } } }
            }
        }
    }
}

fn errors(teaching: &Teaching) -> Markup {
    html! {
        p { "Errors at one standard deviation with all other parameters free, by the passes inside sessions, all targets together; of each channel the detector nearest its middle, or the telescope's axis. \u{2212}20 dB and \u{2212}30 dB: radius up to which the beam's response is known to that; seen: up to which it exceeds its error; at most two full widths." }
        div.scroll tabindex="0" role="region" aria-label="Errors by channel" {
            table.errors {
                caption { "Errors by channel" }
                thead { tr {
                    th scope="col" { "detector or channel" }
                    @for (name, unit, _) in &COLUMNS { th.num scope="col" { (name) " (" (unit) ")" } }
                } }
                tbody { @for line in lines(teaching) { tr {
                    th scope="row" { (line.name) }
                    @for cell in line.cells { td.num {
                        @if cell.is_some() { (shown(cell)) } @else { "\u{2013}" }
                    } }
                } } }
            }
        }
    }
}

fn degenerate(teaching: &Teaching) -> Markup {
    let apart = apart(teaching);
    html! {
        @if apart.is_empty() { p { "No two errors are correlated by 0.9 or more." } }
        @else {
            details {
                summary { "Hard to tell apart: " (grouped(apart.len())) " pairs, with the strongest correlation of their errors" }
                ul { @for it in &apart { li { (it) } } }
            }
        }
    }
}
