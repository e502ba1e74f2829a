//! The rules and reasons of a schedule in words, with the names of targets and telescopes.

use super::types::{Constraint, Loosened, Unit};
use ephem::time::format_utc;
use onboard_core::time::{Duration, Instant};
use planner::plan::Offered;
use planner::schedule::{self, Because, ConstraintUse, Loosening, Rule};
use planner::world::World;

/// What names the parts of a schedule.
#[derive(Clone, Copy)]
pub(super) struct Words<'w> {
    pub(super) world: &'w World,
    pub(super) offered: &'w Offered,
}

impl Words<'_> {
    /// The UTC date on which a day of the schedule begins.
    fn date(&self, day: usize) -> String {
        let midnight = self.offered.problem.rules.day_boundaries.get(day);
        midnight.map_or_else(String::new, |at| date(*at))
    }

    pub(super) fn because(&self, because: &Because) -> String {
        match *because {
            Because::Conflict { with } => {
                format!("it overlaps the session {}", self.offered.id(self.world, with))
            }
            Because::DayFull { day, needs, left } => format!(
                "it needs {} min of {} UTC, which has {} min left",
                minutes(needs),
                self.date(day),
                minutes(left)
            ),
            Because::TooLongForDay { day, needs } => format!(
                "its session alone needs {} min of {} UTC, more than max_minutes_per_day",
                minutes(needs),
                self.date(day)
            ),
            Because::SessionCount { from, count } => format!(
                "the window from {} already holds {count} sessions, as many as max_sessions allows",
                format_utc(from)
            ),
            Because::Blackout { index } => {
                let it = &self.offered.blackouts[index];
                format!(
                    "it touches the blackout from {} to {}: {}",
                    format_utc(it.from),
                    format_utc(it.until),
                    it.reason
                )
            }
            Because::NoValue
            | Because::BeforeMission
            | Because::AfterMission
            | Because::Avoided
            | Because::Skipped(_)
            | Because::Forbidden
            | Because::Thermal
            | Because::Memory
            | Because::ScanAngle { .. }
            | Because::NotWorth => because.to_string(),
        }
    }

    pub(super) fn loosening(&self, it: &Loosening) -> Loosened {
        let names = self.world.targets.iter().map(|target| target.name().to_owned());
        let dwell = names.zip(&it.dwell);
        Loosened {
            rule: it.give.rule().to_owned(),
            step: it.give.to_string(),
            objective_percent: percent(it.objective),
            dwell_percent: dwell
                .filter_map(|(name, share)| Some((name, percent((*share)?))))
                .collect(),
        }
    }

    pub(super) fn constraint(&self, it: &ConstraintUse) -> Constraint {
        let (rule, place) = match it.rule {
            Rule::Exclusive { telescope: None } => ("exclusive", "all".to_owned()),
            Rule::Exclusive { telescope: Some(index) } => {
                ("exclusive", format!("{} (s)", self.world.mission.telescopes[index].name))
            }
            Rule::Day { day } => ("max_minutes_per_day", format!("{} (s)", self.date(day))),
            Rule::SessionCount { from } => ("max_sessions", format!("from {}", format_utc(from))),
            Rule::MinSessions { target, telescope, from } => (
                "min_sessions",
                format!("{} from {}", self.pair(target, telescope), format_utc(from)),
            ),
            Rule::Gap { telescope, from } => {
                let telescope = &self.world.mission.telescopes[telescope].name;
                ("longest_gain_gap", format!("{telescope} from {} (days)", format_utc(from)))
            }
            Rule::Thermal { from } => ("thermal", format!("from {} (s)", format_utc(from))),
            Rule::Memory { from, until } => {
                ("data", format!("from {} to {} (s)", format_utc(from), format_utc(until)))
            }
            Rule::ScanAngle { n, target, telescope } => {
                ("scan_angle", format!("n = {n} {}", self.pair(target, telescope)))
            }
        };
        Constraint {
            name: format!("{rule} {place}"),
            rule: rule.to_owned(),
            unit: match it.unit() {
                schedule::Unit::Seconds => Some(Unit::Seconds),
                schedule::Unit::Days => Some(Unit::Days),
                schedule::Unit::Sessions => Some(Unit::Sessions),
                schedule::Unit::None => None,
            },
            used: it.used,
            limit: it.limit,
            shadow_price: it.shadow_price,
        }
    }

    /// `target on TELESCOPE`.
    fn pair(&self, target: usize, telescope: usize) -> String {
        let telescope = &self.world.mission.telescopes[telescope].name;
        format!("{} on {telescope}", self.world.targets[target].name())
    }
}

/// The date of an instant, UTC.
#[must_use]
pub fn date(at: Instant) -> String {
    format_utc(at).chars().take_while(|letter| *letter != 'T').collect()
}

/// A share in percent, to the hundredths that the relaxation is good for.
fn percent(share: f64) -> f64 {
    let hundredths = (share * 1e4).round();
    // No negative zero.
    if hundredths == 0.0 { 0.0 } else { hundredths / 100.0 }
}

/// Minutes to a tenth, for sentences.
fn minutes(span: Duration) -> String {
    format!("{:.1}", span.seconds() / 60.0)
}
