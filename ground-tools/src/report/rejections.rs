//! What was not taken, and why: a table by reason, and with scripts the whole list with filters.
//!
//! Reasons are counted by what they say, leaving ids, dates and numbers out.

use super::encoding::label;
use super::names::{Names, grouped, total};
use super::opportunity_data::Data;
use super::source::Source;
use maud::{Markup, html};
use std::collections::BTreeMap;

pub(super) fn section(source: &Source, names: &Names, data: &Data) -> Markup {
    let list = source.offers.opportunities.list();
    let mut reasons: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    let labels: Vec<String> = data.templates.iter().map(|it| label(it)).collect();
    let mission = &source.world.mission;
    for index in 0..list.len() {
        if names.taken[index].is_none() {
            reasons.entry(labels[data.template[index]].clone()).or_default().push(index);
        }
    }
    let mut reasons: Vec<(String, Vec<usize>)> = reasons.into_iter().collect();
    reasons.sort_by(|a, b| b.1.len().cmp(&a.1.len()).then_with(|| a.0.cmp(&b.0)));
    let hours = |rows: &[usize]| total(rows.iter().map(|&it| list[it].dwell.seconds())) / 3600.0;
    let all: usize = reasons.iter().map(|it| it.1.len()).sum();
    html! {
        p { "For each opportunity that was left out, a rule that taking it would break in this schedule." }
        div.scroll tabindex="0" role="region" aria-label="Reasons" {
            table {
                caption { (grouped(all)) " rejected opportunities by reason" }
                thead { tr {
                    th scope="col" { "reason" } th.num scope="col" { "opportunities" } th.num scope="col" { "hours in view" }
                    @for telescope in &mission.telescopes { th.num scope="col" { (telescope.name) } }
                } }
                tbody { @for (reason, rows) in &reasons {
                    tr {
                        th scope="row" { (reason) } td.num { (grouped(rows.len())) }
                        td.num { (format!("{:.2}", hours(rows))) }
                        @for telescope in 0..mission.telescopes.len() {
                            td.num { (grouped(rows.iter().filter(|it| list[**it].telescope == telescope).count())) }
                        }
                    }
                } }
            }
        }
        div.scripted #filters {
            form.tools role="search" aria-label="Rejected opportunities" {
                label { "Target " select #by-target { option value="" { "all" } @for (index, it) in source.world.targets.iter().enumerate() { option value=(index) { (it.name()) } } } }
                label { "Telescope " select #by-telescope { option value="" { "all" } @for (index, it) in mission.telescopes.iter().enumerate() { option value=(index) { (it.name) } } } }
                label { "Reason " select #by-reason { option value="" { "any" } @for (reason, _) in &reasons { option { (reason) } } } }
                label { "Contains " input #by-text type="search" placeholder="id, date, words"; }
                button type="reset" { "Clear" }
            }
            p #matches aria-live="polite" {}
            div.scroll tabindex="0" role="region" aria-label="List of rejected opportunities" {
                table #rejected-list {
                    caption { "Rejected opportunities, by time" }
                    thead { tr {
                        th scope="col" { "id" } th scope="col" { "first entry (UTC)" }
                        th.num scope="col" { "in view (s)" } th scope="col" { "why not" }
                    } }
                    tbody {}
                }
            }
            div.tools role="group" aria-label="Pages" {
                button type="button" data-page="first" { "First" }
                button type="button" data-page="before" { "\u{2039} Earlier" }
                button type="button" data-page="next" { "Later \u{203a}" }
                button type="button" data-page="last" { "Last" }
            }
        }
        noscript { p { "The whole list with its filters needs scripts; " code { "timeline.json" } " has it under " code { "rejected" } "." } }
    }
}
