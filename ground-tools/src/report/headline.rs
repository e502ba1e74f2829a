//! What is planned, and how sure is it: the numbers that a meeting starts with.

use super::names::{Names, grouped, minute, minute_tdb, real, total};
use super::source::Source;
use maud::{Markup, html};
use serde_json::Value;

/// The mission and its span.
pub(super) fn title(source: &Source) -> Markup {
    let mission = &source.world.mission;
    let (start, end) = (source.world.start, source.world.end);
    let days = if source.world.mission_span() == (start, end) {
        mission.span.duration_days.text().to_owned()
    } else {
        format!("{:.3}", end.since(start).seconds() / 86_400.0)
    };
    html! {
        h1 { (mission.name) " " span.what { "calibration plan" } }
        p.span {
            (minute_tdb(source.world.start)) " TDB for " (days) " days, "
            (mission.telescopes.len()) @if mission.telescopes.len() == 1 { " telescope" } @else { " telescopes" }
            ", " (source.world.targets.len()) @if source.world.targets.len() == 1 { " target" } @else { " targets" }
        }
    }
}

/// The headline.
pub(super) fn section(source: &Source, names: &Names) -> Markup {
    let timeline = source.timeline;
    let hours = total(timeline.sessions.iter().map(|it| it.dwell_s)) / 3600.0;
    let offered =
        total(source.offers.opportunities.list().iter().map(|it| it.dwell.seconds())) / 3600.0;
    let share = if offered > 0.0 { 100.0 * hours / offered } else { 0.0 };
    let passes: usize = timeline.sessions.iter().map(|it| it.transits.len()).sum();
    let resonance = resonance(timeline.resonance.as_ref());
    html! {
        section.headline aria-label="Headline" {
            (alerts(source))
            dl.cards {
                div {
                    dt { "Sessions" }
                    dd { (grouped(timeline.sessions.len())) }
                    dd.note { "of " (grouped(names.taken.len())) " opportunities, with " (grouped(passes)) " passes" }
                }
                div {
                    dt { "Hours in view" }
                    dd { (format!("{hours:.2}")) }
                    dd.note { (format!("of {offered:.2} offered, {share:.1} %")) }
                }
                div {
                    dt { "Proven gap" }
                    dd { (format!("{:.3} %", 100.0 * timeline.gap)) }
                    dd.note {
                        "objective " (format!("{:.1}", timeline.objective)) "; no schedule exceeds "
                        (format!("{:.1}", timeline.upper_bound))
                    }
                }
                div class={ @if source.violation.is_none() { "good" } @else { "bad" } } {
                    dt { "Constraint violations" }
                    dd {
                        @if source.violation.is_none() { span.sign aria-hidden="true" { "\u{2713} " } "none" }
                        @else { span.sign aria-hidden="true" { "\u{2717} " } "found" }
                    }
                    dd.note {
                        @match source.violation {
                            None => "every rule checked again in exact integer arithmetic, apart from the search",
                            Some(violation) => (violation),
                        }
                    }
                }
                div class=(resonance.class) {
                    dt { "Resonance" }
                    dd { span.sign aria-hidden="true" { (resonance.sign) " " } (resonance.verdict) }
                    dd.note { (resonance.note) }
                }
                (required(source))
                (longest_gap(source))
            }
            p.sure {
                "The search ended because: " (timeline.stopped) ". "
                @if let Some((target, hours)) = most_seen(source) {
                    "Most time goes to " (target) (format!(": {hours:.2} h. "))
                }
                (first_and_last(source))
            }
        }
    }
}

/// What is wrong, before all else.
fn alerts(source: &Source) -> Markup {
    let alerts = source.taught.alerts();
    html! {
        @if !alerts.is_empty() {
            ul.alerts aria-label="Alerts" {
                @for it in &alerts { li { span.sign aria-hidden="true" { "\u{2717} " } (it) } }
            }
        }
    }
}

/// How many requirements are met, where there are any.
fn required(source: &Source) -> Markup {
    let all = &source.taught.required;
    let met = all.iter().filter(|it| !it.is_missed()).count();
    let (class, sign) = if met == all.len() { ("good", "\u{2713}") } else { ("bad", "\u{2717}") };
    html! {
        @if !all.is_empty() {
            div class=(class) {
                dt { "Requirements" }
                dd { span.sign aria-hidden="true" { (sign) " " } (met) " of " (all.len()) " met" }
                dd.note { a href="#teaching" { "which, by how much, and why" } }
            }
        }
    }
}

/// The longest time that a telescope is without a session.
fn longest_gap(source: &Source) -> Markup {
    let idle = &source.taught.idle;
    let longest = idle.iter().max_by(|a, b| a.days().total_cmp(&b.days()));
    html! {
        @if let Some(longest) = longest {
            div class=(if idle.iter().any(|it| it.sessions == 0) { "bad" } else { "unknown" }) {
                dt { "Longest gap" }
                dd { (format!("{:.1} d", longest.days())) }
                @for it in idle { dd.note { (it.telescope) ": " (it.sentence()) } }
            }
        }
    }
}

fn most_seen<'s>(source: &'s Source) -> Option<(&'s str, f64)> {
    let hours = |name: &str| {
        let sessions = source.timeline.sessions.iter().filter(|it| it.target == name);
        total(sessions.map(|it| it.dwell_s)) / 3600.0
    };
    let all = source.world.targets.iter().map(|it| (it.name(), hours(it.name())));
    all.filter(|it| it.1 > 0.0).max_by(|a, b| a.1.total_cmp(&b.1))
}

fn first_and_last(source: &Source) -> String {
    let sessions = &source.timeline.sessions;
    let (Some(first), Some(last)) = (sessions.first(), sessions.last()) else {
        return "There is no session.".to_owned();
    };
    let days = source.world.end.since(source.world.start).seconds() / 86_400.0;
    format!(
        "The first session begins on {} UTC, the last ends on {} UTC; {:.2} a day in the mean.",
        minute(first.start()),
        minute(last.end()),
        real(sessions.len()) / days
    )
}

/// The verdict on the periods.
struct Resonance {
    class: &'static str,
    sign: &'static str,
    verdict: &'static str,
    note: String,
}

fn resonance(checked: Option<&Value>) -> Resonance {
    let Some(checked) = checked else {
        let note = "the periods cannot be judged for this scanning strategy".to_owned();
        return Resonance { class: "unknown", sign: "?", verdict: "not judged", note };
    };
    let number = |key: &str| checked[key].as_f64().unwrap_or(f64::NAN);
    let passes = checked["verdict"] == "pass";
    let recommended = checked["recommended"]["precession_period_min"].as_f64();
    let better = recommended.map_or_else(String::new, |minutes| {
        format!("; nearby, {minutes:.4} min has the smallest bound")
    });
    let note = format!(
        "at {} min and {} min, within {:.3} s and {:.3} s, the hits' spread stays at most {:.2} % above \
         its floor; {} % is allowed{better}",
        number("precession_period_min"),
        number("spin_period_min"),
        number("precession_tolerance_s"),
        number("spin_tolerance_s"),
        100.0 * number("excess"),
        100.0 * number("allowed_excess"),
    );
    if passes {
        Resonance { class: "good", sign: "\u{2713}", verdict: "pass", note }
    } else {
        Resonance { class: "bad", sign: "\u{2717}", verdict: "FAIL", note }
    }
}
