//! How long is each target in view: used and offered, by telescope.

use super::names::{Names, grouped, total};
use super::plot::{colour, n};
use super::source::Source;
use maud::{Markup, html};

pub(super) fn section(source: &Source, names: &Names) -> Markup {
    let list = source.offers.opportunities.list();
    let offered = |target: usize, telescope: Option<usize>| {
        let here = list.iter().filter(|it| it.target == target);
        let here = here.filter(|it| telescope.is_none_or(|index| it.telescope == index));
        total(here.map(|it| it.dwell.seconds())) / 3600.0
    };
    let sessions = |target: usize, telescope: Option<usize>| {
        source.timeline.sessions.iter().filter(move |it| {
            it.target == names.targets[target]
                && telescope.is_none_or(|index| it.telescope == names.telescopes[index])
        })
    };
    let used = |target, telescope| total(sessions(target, telescope).map(|it| it.dwell_s)) / 3600.0;
    let rows: Vec<usize> = (0..names.targets.len()).collect();
    let most = rows.iter().map(|&it| offered(it, None)).fold(f64::MIN_POSITIVE, f64::max);
    let width = |hours: f64| format!("width:{}%", n(100.0 * hours / most));
    let all = |of: &dyn Fn(usize) -> f64| total(rows.iter().map(|&it| of(it)));
    let percent = |used: f64, offered: f64| {
        if offered > 0.0 {
            format!("{:.1} %", 100.0 * used / offered)
        } else {
            "\u{2013}".to_owned()
        }
    };
    html! {
        p { "Time with the target inside a telescope's field of view; detectors that see it together count once. The bar is what the passes offer, its filled part what sessions use." }
        div.scroll tabindex="0" role="region" aria-label="Hours by target" {
            table.hours {
                caption { "Integrated hours by target" }
                thead { tr {
                    th scope="col" { "target" } th.wide scope="col" { "used of offered" }
                    th.num scope="col" { "used (h)" } th.num scope="col" { "offered (h)" }
                    th.num scope="col" { "share" } th.num scope="col" { "sessions" }
                    @for telescope in &names.telescopes { th.num scope="col" { (telescope) " (h)" } }
                } }
                tbody { @for &target in &rows {
                    tr class=(colour(target)) {
                        th scope="row" { span.swatch aria-hidden="true" {} (names.targets[target]) }
                        td.wide { div.bar aria-hidden="true" {
                            div.offered style=(width(offered(target, None))) {}
                            div.used style=(width(used(target, None))) {}
                        } }
                        td.num { (format!("{:.2}", used(target, None))) }
                        td.num { (format!("{:.2}", offered(target, None))) }
                        td.num { (percent(used(target, None), offered(target, None))) }
                        td.num { (grouped(sessions(target, None).count())) }
                        @for telescope in 0..names.telescopes.len() {
                            td.num { (format!("{:.2}", used(target, Some(telescope)))) }
                        }
                    }
                } }
                tfoot { tr {
                    th scope="row" { "total" } td {}
                    td.num { (format!("{:.2}", all(&|it| used(it, None)))) }
                    td.num { (format!("{:.2}", all(&|it| offered(it, None)))) }
                    td.num { (percent(all(&|it| used(it, None)), all(&|it| offered(it, None)))) }
                    td.num { (grouped(source.timeline.sessions.len())) }
                    @for telescope in 0..names.telescopes.len() {
                        td.num { (format!("{:.2}", all(&|it| used(it, Some(telescope))))) }
                    }
                } }
            }
        }
    }
}
