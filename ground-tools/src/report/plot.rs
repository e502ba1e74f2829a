//! What the page's figures share: time over the mission, ticks, paths, lines told apart without colour.
//!
//! Colours are in the style sheet, by class, so that figures follow a dark screen and print; words of
//! an axis over the whole width are HTML, which keeps its size on a phone.

use ephem::time::{civil_from_day, utc_day, utc_midnight};
use formats::timeline::date;
use maud::{Markup, html};
use onboard_core::time::Instant;
use std::fmt::Write;

/// Number of colours that the style sheet has.
const COLOURS: usize = 8;
/// Most words along an axis of time.
const MOST_TICKS: usize = 8;

/// The class of a series' colour; from the ninth on they come again.
pub(super) fn colour(index: usize) -> String {
    format!("c{}", index % COLOURS)
}

/// The pattern of a series' line.
pub(super) const fn dashes(index: usize) -> &'static str {
    ["none", "9 4", "2 3", "9 3 2 3", "5 2", "12 3 2 3 2 3", "1 5", "16 4"][index % COLOURS]
}

/// A coordinate with two decimals at most.
pub(super) fn n(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// The data of a path through points.
pub(super) fn path(points: impl IntoIterator<Item = (f64, f64)>) -> String {
    let mut text = String::new();
    for (index, (x, y)) in points.into_iter().enumerate() {
        let _ = write!(text, "{}{} {}", if index == 0 { "M" } else { "L" }, n(x), n(y));
    }
    text
}

/// Steps of equal width as a filled path: heights from 0 to 1 in a box, zero at the bottom.
pub(super) fn steps(heights: &[f64], (width, height): (f64, f64)) -> String {
    let step = width / super::names::real(heights.len().max(1));
    let mut text = format!("M0 {}", n(height));
    let mut last = None;
    for (index, share) in heights.iter().enumerate() {
        let top = n(height * (1.0 - share));
        if last.as_ref() != Some(&top) {
            let _ = write!(text, "H{}V{top}", n(step * super::names::real(index)));
        }
        last = Some(top);
    }
    let _ = write!(text, "H{}V{}Z", n(width), n(height));
    text
}

/// A span of time as an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct TimeAxis {
    pub(super) start: Instant,
    pub(super) end: Instant,
}

impl TimeAxis {
    /// The share of the span that has gone by, from 0 to 1.
    pub(super) fn share(&self, at: Instant) -> f64 {
        (at.since(self.start).seconds() / self.end.since(self.start).seconds()).clamp(0.0, 1.0)
    }

    /// Its length in days.
    pub(super) fn days(&self) -> f64 {
        self.end.since(self.start).seconds() / 86_400.0
    }

    /// Midnights UTC worth a word: shares of the span, and dates.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        let days = || utc_day(self.start) + 1..=utc_day(self.end);
        let share = |day: i64| self.share(utc_midnight(day));
        for step in [1, 2, 7] {
            let ticks: Vec<i64> = days().filter(|day| day % step == 0).collect();
            if ticks.len() <= MOST_TICKS {
                let words = |day: i64| date(utc_midnight(day));
                return ticks.into_iter().map(|day| (share(day), words(day))).collect();
            }
        }
        let firsts: Vec<_> =
            days().map(|day| (day, civil_from_day(day))).filter(|it| it.1.2 == 1).collect();
        for months in [1, 2, 3, 6, 12, 24, 60, 120, 600, 1200] {
            let ticks: Vec<_> = firsts
                .iter()
                .filter(|(_, (year, month, _))| (12 * year + month - 1) % months == 0)
                .map(|&(day, (year, month, _))| (share(day), format!("{year:04}-{month:02}")))
                .collect();
            if ticks.len() <= MOST_TICKS {
                return ticks;
            }
        }
        Vec::new()
    }

    /// The words under a figure that is as wide as the page.
    pub(super) fn words(&self) -> Markup {
        html! {
            div.words aria-hidden="true" {
                @for (share, text) in self.ticks() {
                    span style={ "left:" (n(100.0 * share)) "%" } { (text) }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use onboard_core::time::Duration;

    #[test]
    fn ticks_are_few_and_in_order() {
        let start = utc_midnight(11_779);
        for days in [0.01, 1.0, 3.0, 30.0, 90.0, 400.0, 1095.75, 3652.5, 36_525.0] {
            let end = start.plus(Duration::from_seconds(86_400.0 * days));
            let ticks = TimeAxis { start, end }.ticks();
            assert!(ticks.len() <= MOST_TICKS && (days < 1.0 || !ticks.is_empty()), "{days}");
            assert!(ticks.is_sorted_by(|a, b| a.0 < b.0 && a.1 < b.1));
        }
    }

    #[test]
    fn steps_close_at_the_bottom() {
        assert_eq!(steps(&[0.5, 0.5, 1.0], (30.0, 10.0)), "M0 10H0V5H20V0H30V10Z");
    }
}
