//! How long is each telescope without a session, at the longest.
//!
//! A stretch runs from the mission's start to the first session's start, from a session's end to the next
//! one's start, and from the last one's end to the mission's end; start and end hold setup and cooldown.
//! An opportunity belongs to it where all its passes do.

use super::types::Timeline;
use ephem::time::format_utc;
use onboard_core::time::Instant;
use planner::opportunities::Opportunities;
use planner::world::World;
use serde_json::{Value, json};

/// The longest stretch of a telescope without a session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Idle {
    /// The telescope.
    pub telescope: String,
    /// Its sessions in all.
    pub sessions: usize,
    /// Start of the stretch.
    pub from: Instant,
    /// Its end.
    pub until: Instant,
    /// Opportunities of the telescope in it, none of which was taken.
    pub opportunities: usize,
}

/// The longest stretch of every telescope, in the mission's order; of equals the first.
#[must_use]
pub fn idle(world: &World, timeline: &Timeline, opportunities: &Opportunities) -> Vec<Idle> {
    let telescopes = world.mission.telescopes.iter().enumerate();
    telescopes
        .map(|(index, telescope)| {
            let own = timeline.sessions.iter().filter(|it| it.telescope == telescope.name);
            let mut spans: Vec<(Instant, Instant)> = own.map(|it| (it.start(), it.end())).collect();
            spans.sort_unstable();
            let sessions = spans.len();
            spans.push((world.end, world.end));
            let mut longest = (world.start, world.start);
            let mut free = world.start;
            for (start, end) in spans {
                if start.since(free) > longest.1.since(longest.0) {
                    longest = (free, start);
                }
                free = free.max(end);
            }
            let (from, until) = longest;
            let inside = opportunities.list().iter().filter(|it| {
                it.telescope == index && it.first_entry >= from && it.last_exit <= until
            });
            let telescope = telescope.name.clone();
            Idle { telescope, sessions, from, until, opportunities: inside.count() }
        })
        .collect()
}

impl Idle {
    /// Its length in days.
    #[must_use]
    pub fn days(&self) -> f64 {
        self.until.since(self.from).seconds() / 86_400.0
    }

    /// What is to be known of it: `no session for 134.8 d, 2032-05-01 to 2032-09-13: nothing passes`.
    #[must_use]
    pub fn sentence(&self) -> String {
        let why = match self.opportunities {
            0 => "no target passes".to_owned(),
            1 => "1 opportunity, not taken".to_owned(),
            count => format!("{count} opportunities, none taken"),
        };
        if self.sessions == 0 {
            return format!("no session at all: {why}");
        }
        let (from, until) = (format_utc(self.from), format_utc(self.until));
        format!("no session for {:.1} d, {} to {}: {why}", self.days(), &from[..10], &until[..10])
    }

    /// As `plan --json` has it.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "telescope": self.telescope,
            "sessions": self.sessions,
            "longest_gap_days": self.days(),
            "from_utc": format_utc(self.from),
            "until_utc": format_utc(self.until),
            "opportunities": self.opportunities,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timeline::{Session, timeline};
    use mission::{Mission, Override};
    use planner::plan::{Revision, plan};
    use planner::progress::Quietly;

    #[test]
    fn the_longest_stretch_is_free_and_ends_at_sessions_or_the_missions_ends() {
        let days = Override::set("span.duration_days=12").unwrap();
        let world = World::open(Mission::load("litebird", &[days]).unwrap(), None).unwrap();
        let plan = plan(&world, &Revision::default(), &Quietly).unwrap();
        let mut now = timeline(&world, &plan, None).unwrap();
        let list = &plan.offered.offers.opportunities;
        let found = idle(&world, &now, list);
        let names: Vec<&str> = found.iter().map(|it| it.telescope.as_str()).collect();
        assert_eq!(names, ["LFT", "MFT", "HFT"]);
        for it in &found {
            let own = || now.sessions.iter().filter(|of| of.telescope == it.telescope);
            assert_eq!(own().count(), it.sessions);
            assert!(own().all(|of| of.end() <= it.from || of.start() >= it.until));
            let ends: Vec<Instant> = own().map(Session::end).chain([world.start]).collect();
            let starts: Vec<Instant> = own().map(Session::start).chain([world.end]).collect();
            assert!(ends.contains(&it.from) && starts.contains(&it.until), "{it:?}");
            let longer = ends.iter().filter_map(|end| {
                let next = starts.iter().filter(|start| *start >= end).min()?;
                Some(next.since(*end).seconds() / 86_400.0)
            });
            assert!(longer.fold(0.0, f64::max) <= it.days() + 1e-9);
        }
        let mft = 1;
        assert!(found[mft].sessions > 5 && found[mft].sentence().starts_with("no session for "));
        now.sessions.retain(|it| it.telescope != "MFT");
        let bare = &idle(&world, &now, list)[mft];
        assert_eq!((bare.sessions, bare.from, bare.until), (0, world.start, world.end));
        let all = list.list().iter().filter(|it| it.telescope == mft).count();
        assert_eq!(bare.sentence(), format!("no session at all: {all} opportunities, none taken"));
    }
}
