//! How far is each rule used, and what would loosening it bring.
//!
//! Rows of the timeline's `constraints` are grouped by rule. A shadow price is the objective per unit of
//! a small loosening in the relaxation. It is told per ten minutes, per day, per hundredth of
//! a scan-angle average, or per session. Above the rows stands what a step for the whole rule would
//! bring, by target (`planner::schedule::loosen`).
//!
//! Limits: a price holds for small changes; what a step would bring is an estimate, not a bound.

use super::names::{grouped, real, total};
use super::plot::{n, steps};
use super::source::Source;
use formats::timeline::{Constraint, Loosened, Unit};
use maud::{Markup, PreEscaped, html};

/// Rows shown of each rule, and further ones behind a fold.
const SHOWN: usize = 3;
const FOLDED: usize = 40;
/// Rows from which on a strip of use is drawn.
const STRIP_FROM: usize = 12;
const PARTS: usize = 240;
const BOX: (f64, f64) = (480.0, 40.0);
/// A target's change below this, in percent, is not told.
const SHARE_SHOWN: f64 = 0.05;

/// The rows of one rule, in the timeline's order.
struct Group<'t> {
    rule: &'t str,
    rows: Vec<&'t Constraint>,
}

/// What a price is told per.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Step {
    words: &'static str,
    units: f64,
}

pub(super) fn section(source: &Source) -> Markup {
    let groups = groups(&source.timeline.constraints);
    let objective = source.timeline.objective;
    html! {
        p {
            "What a rule costs is told by its shadow price: what the objective (" (format!("{objective:.1}"))
            ") would gain from a small loosening. A rule with price 0 holds nothing back."
        }
        @if groups.is_empty() { p { "No rule limits this plan." } }
        @for group in &groups {
            @let loosened: Vec<&Loosened> =
                source.timeline.loosening.iter().filter(|it| it.rule == group.rule).collect();
            (group_table(group, objective, &loosened))
        }
    }
}

fn groups(constraints: &[Constraint]) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for it in constraints {
        let rule = &*it.rule;
        match groups.iter_mut().find(|group| group.rule == rule) {
            Some(group) => group.rows.push(it),
            None => groups.push(Group { rule, rows: vec![it] }),
        }
    }
    groups
}

fn step(it: &Constraint) -> Step {
    match (it.unit, &*it.rule) {
        (Some(Unit::Seconds), _) => Step { words: "10 more minutes", units: 600.0 },
        (Some(Unit::Days), _) => Step { words: "1 more day", units: 1.0 },
        (Some(Unit::Sessions), "min_sessions") => Step { words: "1 session fewer", units: 1.0 },
        (Some(Unit::Sessions), _) => Step { words: "1 more session", units: 1.0 },
        (None, _) => Step { words: "0.01 more", units: 0.01 },
    }
}

/// A value in the unit it is told in.
fn told(it: &Constraint, value: f64) -> String {
    match it.unit {
        Some(Unit::Seconds) => format!("{:.1}", value / 60.0),
        Some(Unit::Days) => format!("{value:.2}"),
        _ => n((value * 1000.0).round() / 1000.0),
    }
}

/// A gain in words: in the objective and as a share of it.
fn gain(value: f64, objective: f64) -> String {
    if value <= 0.0 {
        return "nothing".to_owned();
    }
    let share = if objective > 0.0 { 100.0 * value / objective } else { 0.0 };
    match (value, share) {
        (value, _) if value < 0.005 => "less than 0.01".to_owned(),
        (value, share) if share < 0.001 => format!("{value:.2} (below 0.001 %)"),
        (value, share) if share < 0.1 => format!("{value:.2} ({share:.3} %)"),
        (value, share) => format!("{value:.1} ({share:.2} %)"),
    }
}

fn use_of(it: &Constraint) -> f64 {
    if it.limit > 0.0 { it.used / it.limit } else { 0.0 }
}

/// What a step brings, in words: the objective, and each target that gains or loses.
fn told_loosening(it: &Loosened) -> String {
    if it.objective_percent <= 0.0 {
        return format!("{} would add nothing.", it.step);
    }
    let targets: Vec<String> = it
        .dwell_percent
        .iter()
        .filter(|(_, percent)| percent.abs() >= SHARE_SHOWN)
        .map(|(target, percent)| format!("{percent:+.1} % for {target}"))
        .collect();
    let targets = if targets.is_empty() {
        String::new()
    } else {
        format!("; time in view: {}", targets.join(", "))
    };
    format!("{} would add about {:.1} % to the objective{targets}.", it.step, it.objective_percent)
}

fn group_table(group: &Group, objective: f64, loosened: &[&Loosened]) -> Markup {
    let step = step(group.rows[0]);
    let sum = step.units * total(group.rows.iter().map(|it| it.shadow_price));
    let full = group.rows.iter().filter(|it| use_of(it) >= 0.999).count();
    let priced = group.rows.iter().filter(|it| it.shadow_price > 0.0).count();
    let mut order: Vec<&Constraint> = group.rows.clone();
    order.sort_by(|a, b| {
        b.shadow_price.total_cmp(&a.shadow_price).then(use_of(b).total_cmp(&use_of(a)))
    });
    let all = if group.rows.len() == 1 { "" } else { " in every row" };
    let (shown, rest) = order.split_at(SHOWN.min(order.len()));
    let folded = &rest[..FOLDED.min(rest.len())];
    html! {
        h3 { code { (group.rule) } }
        p {
            (grouped(group.rows.len())) @if group.rows.len() == 1 { " row" } @else { " rows" }
            ", " (grouped(full)) " used to the full, " (grouped(priced)) " with a price. "
            @if loosened.is_empty() {
                strong { (step.words) (all) " would add about " (gain(sum, objective)) @if sum > 0.0 { " to the objective" } "." }
            } @else {
                @for it in loosened { strong { (told_loosening(it)) } }
            }
        }
        @if group.rows.len() >= STRIP_FROM { (strip(group)) }
        div.scroll tabindex="0" role="region" aria-label={ "Rule " (group.rule) } {
            table.rules {
                caption { @if rest.is_empty() { "Its rows" } @else { "The " (shown.len()) " dearest of its rows" } }
                (head(group.rows[0]))
                tbody { @for it in shown { (row(it, step, objective)) } }
            }
        }
        @if !folded.is_empty() {
            details {
                summary { "The next " (folded.len()) " by price" @if rest.len() > folded.len() { "; all " (grouped(group.rows.len())) " are in timeline.json" } }
                div.scroll tabindex="0" role="region" aria-label={ "More rows of rule " (group.rule) } {
                    table.rules {
                        caption { "Further rows of " (group.rule) }
                        (head(group.rows[0]))
                        tbody { @for it in folded { (row(it, step, objective)) } }
                    }
                }
            }
        }
    }
}

fn head(it: &Constraint) -> Markup {
    let unit = match it.unit {
        Some(Unit::Seconds) => " (min)",
        Some(Unit::Days) => " (d)",
        Some(Unit::Sessions) | None => "",
    };
    html! { thead { tr {
        th scope="col" { "where" } th.num scope="col" { "used" (unit) } th.num scope="col" { "limit" (unit) }
        th.num scope="col" { "use" } th scope="col" { "loosening" }
    } } }
}

fn row(it: &Constraint, step: Step, objective: f64) -> Markup {
    let place = to_the_second(it.place());
    html! { tr {
        th scope="row" { @if place.is_empty() { "the mission" } @else { (place) } }
        td.num { (told(it, it.used)) } td.num { (told(it, it.limit)) }
        td.num { (format!("{:.0} %", 100.0 * use_of(it))) }
        td { (step.words) " would add " (gain(it.shadow_price * step.units, objective)) }
    } }
}

/// A place whose instants are cut to the second: nanoseconds say nothing here.
fn to_the_second(place: &str) -> String {
    let word = |word: &str| match word.split_once('.') {
        Some((second, rest)) if rest.ends_with('Z') => format!("{}Z", second.replace('T', " ")),
        _ => word.to_owned(),
    };
    place.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// The largest use in each part of the rows, which stand in time.
fn strip(group: &Group) -> Markup {
    let parts = PARTS.min(group.rows.len());
    let mut uses = vec![0.0_f64; parts];
    for (index, it) in group.rows.iter().enumerate() {
        let part = index * parts / group.rows.len();
        uses[part] = uses[part].max(use_of(it).clamp(0.0, 1.0));
    }
    let mean = total(group.rows.iter().map(|it| use_of(it))) / real(group.rows.len());
    html! {
        figure.use-strip {
            svg viewBox={ "0 0 " (n(BOX.0)) " " (n(BOX.1)) } preserveAspectRatio="none" role="img"
                aria-label={ "Use of " (group.rule) " row by row; " (format!("{:.0}", 100.0 * mean)) " % in the mean" } {
                path.limit d={ "M0 0.5H" (n(BOX.0)) } {}
                path.used d=(PreEscaped(steps(&uses, BOX))) {}
            }
            figcaption { "Use of the limit, row by row in the order of time: " (format!("{:.0} %", 100.0 * mean)) " in the mean; the line on top is the limit" }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row_of(rule: &str, unit: Option<Unit>, place: &str) -> Constraint {
        Constraint {
            name: format!("{rule} {place}"),
            rule: rule.to_owned(),
            unit,
            used: 0.0,
            limit: 1.0,
            shadow_price: 0.0,
        }
    }

    #[test]
    fn rules_keep_their_order_and_their_units() {
        let rows = [
            row_of("max_minutes_per_day", Some(Unit::Seconds), "2032-04-01 (s)"),
            row_of("max_sessions", Some(Unit::Sessions), "from x"),
            row_of("max_minutes_per_day", Some(Unit::Seconds), "b (s)"),
        ];
        let found: Vec<(&str, usize)> =
            groups(&rows).iter().map(|it| (it.rule, it.rows.len())).collect();
        assert_eq!(found, [("max_minutes_per_day", 2), ("max_sessions", 1)]);
        assert_eq!(step(&rows[0]).words, "10 more minutes");
        assert_eq!(step(&rows[1]).words, "1 more session");
        let gap = row_of("longest_gain_gap", Some(Unit::Days), "x (days)");
        assert_eq!(step(&gap).words, "1 more day");
        assert_eq!(step(&row_of("exclusive", Some(Unit::Seconds), "all")).words, "10 more minutes");
        assert_eq!(rows.each_ref().map(Constraint::place), ["2032-04-01", "from x", "b"]);
        assert_eq!(gap.place(), "x");
    }

    #[test]
    fn places_are_told_to_the_second() {
        let place = "jupiter on MFT from 2032-04-01T00:00:00.123456789Z";
        assert_eq!(to_the_second(place), "jupiter on MFT from 2032-04-01 00:00:00Z");
    }

    #[test]
    fn a_step_is_told_with_the_targets_that_it_moves() {
        let dwell = [("jupiter", 4.04), ("mars", -0.2), ("neptune", 0.04)];
        let mut it = Loosened {
            rule: "max_minutes_per_day".to_owned(),
            step: "10 more minutes per day".to_owned(),
            objective_percent: 2.449,
            dwell_percent: dwell.map(|(name, share)| (name.to_owned(), share)).into(),
        };
        assert_eq!(
            told_loosening(&it),
            "10 more minutes per day would add about 2.4 % to the objective; time in view: \
             +4.0 % for jupiter, -0.2 % for mars."
        );
        it.objective_percent = 0.0;
        assert_eq!(told_loosening(&it), "10 more minutes per day would add nothing.");
    }

    #[test]
    fn gains_are_told_with_their_share() {
        assert_eq!(gain(0.0, 10.0), "nothing");
        assert_eq!(gain(0.001, 10.0), "less than 0.01");
        assert_eq!(gain(34.2, 1000.0), "34.2 (3.42 %)");
        assert_eq!(gain(0.5, 1000.0), "0.50 (0.050 %)");
    }
}
