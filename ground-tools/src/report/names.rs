//! Which session is which opportunity: ids, classes, totals.
//!
//! A class is a telescope with a target, numbered by telescope, then by target, in the mission's order.

use super::source::Source;
use crate::failure::Failure;
use ephem::time::{format_tdb, format_utc};
use formats::timeline::Session;
use onboard_core::time::Instant;
use planner::opportunities::Opportunity;
use std::collections::BTreeMap;

/// Names by index, and what stands behind each id.
pub(super) struct Names<'r> {
    pub(super) telescopes: Vec<&'r str>,
    pub(super) targets: Vec<&'r str>,
    /// The session of each opportunity, where it was taken.
    pub(super) taken: Vec<Option<&'r Session>>,
    /// Why each opportunity was not taken; empty where it was.
    pub(super) because: Vec<&'r str>,
}

impl<'r> Names<'r> {
    pub(super) fn new(source: &Source<'r>) -> Result<Self, Failure> {
        let telescopes: Vec<&str> =
            source.world.mission.telescopes.iter().map(|it| &*it.name).collect();
        let targets: Vec<&str> =
            source.world.targets.iter().map(ephem::source::Source::name).collect();
        let list = source.offers.opportunities.list();
        let mut names = Self {
            telescopes,
            targets,
            taken: vec![None; list.len()],
            because: vec![""; list.len()],
        };
        let known: BTreeMap<String, usize> =
            list.iter().enumerate().map(|(index, it)| (names.id(it), index)).collect();
        let find = |id: &str| {
            known.get(id).copied().ok_or_else(|| {
                Failure::Input(format!(
                    "the timeline's {id} is no opportunity of this mission: it was planned from \
                     other passes"
                ))
            })
        };
        for session in &source.timeline.sessions {
            names.taken[find(&session.id)?] = Some(session);
        }
        for rejected in &source.timeline.rejected {
            names.because[find(&rejected.opportunity)?] = &rejected.because;
        }
        Ok(names)
    }

    /// The id that `timeline.json` has.
    pub(super) fn id(&self, it: &Opportunity) -> String {
        format!("{}{:06}", self.prefix(it.telescope, it.target), it.number)
    }

    /// What ids of a class begin with.
    pub(super) fn prefix(&self, telescope: usize, target: usize) -> String {
        format!("{}-{}-", self.telescopes[telescope], self.targets[target])
    }

    pub(super) fn class(&self, it: &Opportunity) -> usize {
        it.telescope * self.targets.len() + it.target
    }

    pub(super) fn classes(&self) -> usize {
        self.telescopes.len() * self.targets.len()
    }
}

/// Indices of the opportunities that a timeline takes, in its order.
///
/// # Errors
/// [`Failure::Input`] names the session that is none of them.
pub fn chosen(source: &Source) -> Result<Vec<usize>, Failure> {
    let names = Names::new(source)?;
    let by_id: BTreeMap<&str, usize> = names
        .taken
        .iter()
        .enumerate()
        .filter_map(|(index, session)| Some((session.as_ref()?.id.as_str(), index)))
        .collect();
    Ok(source.timeline.sessions.iter().filter_map(|it| by_id.get(&*it.id).copied()).collect())
}

/// A count as a number to calculate with.
#[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
pub(super) fn real(count: usize) -> f64 {
    count as f64
}

/// A sum that is +0 where there is nothing to add.
pub(super) fn total(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |sum, number| sum + number)
}

/// A count with its thousands apart.
pub(super) fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// `YYYY-MM-DD hh:mm:ss`, UTC.
pub(super) fn second(at: Instant) -> String {
    apart(&format_utc(at), 19)
}

/// `YYYY-MM-DD hh:mm`, UTC.
pub(super) fn minute(at: Instant) -> String {
    apart(&format_utc(at), 16)
}

/// `YYYY-MM-DD hh:mm`, TDB.
pub(super) fn minute_tdb(at: Instant) -> String {
    apart(&format_tdb(at), 16)
}

/// Date and time apart, without the last places.
fn apart(time: &str, places: usize) -> String {
    time.get(..places).unwrap_or(time).replace('T', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_stand_apart() {
        let texts = [0, 999, 1000, 1_234_567].map(grouped);
        assert_eq!(texts, ["0", "999", "1\u{202f}000", "1\u{202f}234\u{202f}567"]);
    }
}
