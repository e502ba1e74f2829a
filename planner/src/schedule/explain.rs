//! Why was each candidate left out.
//!
//! Method: every candidate that was not taken is offered to the final schedule alone; the reason
//! given is a rule that this would break, so it is true of the schedule as it stands.
//!
//! Limits: the first rule found is named, in the order overlap, day, count, thermal window, memory, scan
//! angles; others may hold too.

use super::draft::Draft;
use super::joint::Built;
use super::reason::{Because, Rejection};

/// Every candidate that was not taken, by index; `screened` are the reasons of those that no schedule
/// can hold.
pub(super) fn rejected(
    built: &Built<'_>,
    draft: &Draft<'_>,
    screened: Vec<Option<Because>>,
) -> Vec<Rejection> {
    let mut reasons = screened;
    for (id, session) in built.model.sessions.iter().enumerate() {
        if !draft.stands(id) {
            reasons[session.candidate] = draft.refusal(session);
        }
    }
    by_families(built, draft, &mut reasons);
    reasons
        .into_iter()
        .enumerate()
        .filter_map(|(candidate, because)| because.map(|because| Rejection { candidate, because }))
        .collect()
}

/// The reason of what fits by overlap, days and windows of starts: the family that refuses it.
fn by_families(built: &Built<'_>, draft: &Draft<'_>, reasons: &mut [Option<Because>]) {
    let mut with = draft.marks().to_vec();
    for (id, session) in built.model.sessions.iter().enumerate() {
        if draft.stands(id) || reasons[session.candidate].is_some() {
            continue;
        }
        with[id] = true;
        let refuses = built.families.iter().map(|family| !family.broken(&with).is_empty());
        let refusal = refuses.zip(&built.refusals).find(|it| it.0).map(|it| *it.1);
        reasons[session.candidate] = Some(refusal.unwrap_or(Because::NotWorth));
        with[id] = false;
    }
}
