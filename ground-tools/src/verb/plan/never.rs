//! Opportunities that could not stand in any schedule.

use planner::schedule::{Because, Rejection};
use std::collections::BTreeMap;

/// A rule that excludes a session by itself, in words; `None` where it depends on the others.
const fn alone(because: Because) -> Option<&'static str> {
    match because {
        Because::NoValue => Some("have no value"),
        Because::BeforeMission | Because::AfterMission => Some("reach beyond the mission"),
        Because::TooLongForDay { .. } => {
            Some("need more of a day than calibration.schedule.max_minutes_per_day")
        }
        Because::Blackout { .. } => Some("touch a blackout"),
        Because::Avoided => Some("come too near to a body to avoid"),
        Because::Skipped(_) => Some("would be skipped by the spacecraft"),
        _ => None,
    }
}

/// A warning where more than half of so many opportunities can never stand.
pub(super) fn never(rejected: &[Rejection], opportunities: usize) -> Option<String> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for it in rejected.iter().filter_map(|it| alone(it.because)) {
        *counts.entry(it).or_default() += 1;
    }
    let total: usize = counts.values().sum();
    let mut counts: Vec<(&str, usize)> = counts.into_iter().collect();
    counts.sort_by_key(|it| std::cmp::Reverse(it.1));
    let parts: Vec<String> = counts.iter().map(|(why, count)| format!("{count} {why}")).collect();
    (2 * total > opportunities).then(|| {
        format!(
            "{total} of {opportunities} opportunities cannot stand in any schedule: {}",
            parts.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use onboard_core::time::Duration;

    #[test]
    fn reasons_are_counted_where_most_can_never_stand() {
        let day = Because::TooLongForDay { day: 3, needs: Duration::ZERO };
        let reasons = [day, Because::NotWorth, day, Because::Avoided];
        let of = |(candidate, &because)| Rejection { candidate, because };
        let rejected: Vec<Rejection> = reasons.iter().enumerate().map(of).collect();
        assert_eq!(
            never(&rejected, 5).unwrap(),
            "3 of 5 opportunities cannot stand in any schedule: 2 need more of a day than \
             calibration.schedule.max_minutes_per_day, 1 come too near to a body to avoid"
        );
        assert_eq!(never(&rejected, 6), None);
    }
}
