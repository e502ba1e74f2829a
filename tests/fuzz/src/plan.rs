//! The plan section, without a container about it.

use crate::ephemeris::instants;
use onboard_core::time::Instant;
use onboard_core::uplink::{PlanTable, SessionRecord};

/// Reads the bytes as a plan.
pub fn run(data: &[u8]) {
    if let Ok(plan) = PlanTable::parse(data) {
        let sessions: Vec<SessionRecord> = plan.sessions().collect();
        assert_eq!(tests::uplink::plan(&sessions), data);
        check(plan, data.len() as u64);
    }
}

/// Asks an accepted plan for everything that it can answer.
pub fn check(plan: PlanTable<'_>, seed: u64) {
    let sessions: Vec<SessionRecord> = plan.sessions().collect();
    let count = sessions.len() as u32;
    assert_eq!(plan.session(count), None);
    assert_eq!(plan.session(u32::MAX), None);
    for (index, session) in (0..count).zip(&sessions) {
        assert_eq!(plan.session(index), Some(*session));
        assert!(session.start <= session.first_entry && session.last_exit <= session.end);
    }
    let starts: Vec<Instant> = sessions.iter().take(8).map(|it| it.start).collect();
    for at in instants(&starts, seed) {
        let before = sessions.iter().filter(|session| session.start < at).count();
        assert_eq!(plan.first_from(at) as usize, before);
    }
}
