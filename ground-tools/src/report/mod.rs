//! `report.html`: the page that a mission-operations meeting looks at.
//!
//! One file without a link to anything outside: style, script, figures and data are in it. It can be
//! read with scripts off: headline, an overview of sessions, every session by month, hours, visits,
//! tracks, scan angles, rules and inputs are there as text, tables and inline SVG. The script adds the
//! timeline to zoom, details of a session, and the list of rejected opportunities with its filters.
//!
//! Frames and signs: `docs/conventions.md`; times are UTC where not said otherwise.
//!
//! Method: everything is taken from the timeline and from the passes it was planned from; opportunities
//! and reasons go in as a stream of small numbers, about 25 bytes each.
//!
//! Limits: in the zoomable timeline, passes are whole seconds; `timeline.json` has all digits.

mod source;
mod encoding;
mod plot;
mod names;
mod headline;
mod schedule_view;
mod opportunity_data;
mod session_table;
mod hours;
mod teaching;
mod visit_panels;
mod tracks;
mod scan_angles;
mod rule_table;
mod rejections;
mod difference;
mod inputs;

pub use names::chosen;
pub use source::Source;

use crate::failure::Failure;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use names::Names;

const STYLE: &str = include_str!("style.css");
const SCRIPTS: [&str; 5] = [
    include_str!("data.js"),
    include_str!("axis.js"),
    include_str!("timeline.js"),
    include_str!("rejected.js"),
    include_str!("page.js"),
];
/// Nothing is fetched, whatever the page's texts may hold.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

/// A section of the page.
struct Section {
    id: &'static str,
    title: &'static str,
    body: Markup,
}

/// The page.
///
/// # Errors
/// [`Failure::Input`] where the timeline is not of these passes, [`Failure::Internal`] where the table
/// does not serve its own span.
pub fn page(source: &Source) -> Result<Vec<u8>, Failure> {
    let names = Names::new(source)?;
    let data = opportunity_data::Data::new(source, &names)?;
    let mut sections = vec![
        Section { id: "timeline", title: "Timeline", body: schedule_view::section(source, &names) },
        Section { id: "sessions", title: "Sessions", body: session_table::section(source) },
    ];
    if let Some(difference) = source.difference {
        let body = difference::section(difference);
        sections.push(Section { id: "difference", title: "Difference", body });
    }
    sections.extend([
        Section { id: "teaching", title: "What the plan teaches", body: teaching::section(source) },
        Section { id: "hours", title: "Hours in view", body: hours::section(source, &names) },
        Section { id: "visits", title: "Visits", body: visit_panels::section(source)? },
        Section { id: "tracks", title: "Sky tracks", body: tracks::section(source)? },
        Section { id: "angles", title: "Scan angles", body: scan_angles::section(source, &names) },
        Section { id: "rules", title: "Rules", body: rule_table::section(source) },
        Section {
            id: "rejected",
            title: "Rejected",
            body: rejections::section(source, &names, &data),
        },
        Section { id: "inputs", title: "Inputs", body: inputs::section(source) },
    ]);
    let name = &source.world.mission.name;
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="generator" content=(source.timeline.provenance.program);
                title { (name) ": calibration plan" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                a.skip href="#main" { "Skip to the plan" }
                header.top {
                    (headline::title(source))
                    nav aria-label="Sections" {
                        ul { @for it in &sections { li { a href={ "#" (it.id) } { (it.title) } } } }
                    }
                }
                main #main {
                    (headline::section(source, &names))
                    @for it in &sections {
                        section #(it.id) aria-labelledby={ (it.id) "-title" } {
                            h2 id={ (it.id) "-title" } { (it.title) }
                            (it.body)
                        }
                    }
                }
                script #data type="application/json" { (PreEscaped(data.json())) }
                @for script in SCRIPTS { script { (PreEscaped(script)) } }
            }
        }
    };
    let mut bytes = page.into_string().into_bytes();
    bytes.push(b'\n');
    Ok(bytes)
}
