//! What was it made from, and how is it made again.

use super::source::Source;
use maud::{Markup, html};

pub(super) fn section(source: &Source) -> Markup {
    html! {
        div.scroll tabindex="0" role="region" aria-label="Inputs" {
            table.inputs {
                caption { "Inputs and their SHA-256" }
                tbody {
                    @for (key, value) in source.timeline.provenance.lines() {
                        tr { th scope="row" { (key.replace('_', " ")) } td { code { (value) } } }
                    }
                }
            }
        }
        p {
            "The mission's digest is that of its resolved form: what " code { "gyrfalcon missions NAME --resolved" }
            " prints. "
            "The same program with a mission and a kernel of these digests makes the same bytes: "
            code { "gyrfalcon plan --mission NAME" } " for the whole plan, "
            code { "gyrfalcon report FOLDER --mission NAME" } " for this page from its " code { "timeline.json" }
            "; options that changed the mission must be given again."
        }
    }
}
