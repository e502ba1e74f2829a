//! Why was a candidate left out, and how far are the rules used.
//!
//! Method: every candidate that was not taken is offered to the final schedule alone; the reason
//! given is a rule that this would break, so it is true of the schedule as it stands.
//!
//! Limits: the first rule found is named, in the order overlap, day, count; others may hold too.

use super::draft::Draft;
use super::model::Model;
use super::price::Prices;
use crate::program::number::{f64_from_i64, i64_from_usize};
use onboard_core::time::{Duration, Instant};
use std::fmt;

/// Why a candidate was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Because {
    /// Its weight or its dwell is zero.
    NoValue,
    /// Its session would begin before the mission.
    BeforeMission,
    /// Its session would end after the mission.
    AfterMission,
    /// Its session alone needs more of a day than the limit.
    TooLongForDay {
        /// Index of the day, from the first boundary.
        day: usize,
        /// What it needs of that day.
        needs: Duration,
    },
    /// It overlaps a session on its telescope, or at all, as the rule says.
    Conflict {
        /// Candidate of that session.
        with: usize,
    },
    /// A day has too little time left.
    DayFull {
        /// Index of the day, from the first boundary.
        day: usize,
        /// What the session needs of that day.
        needs: Duration,
        /// What is left.
        left: Duration,
    },
    /// A sliding window would hold too many starts.
    SessionCount {
        /// Start of such a window.
        from: Instant,
        /// Most sessions that may start in it.
        count: usize,
    },
    /// It touches a blackout.
    Blackout {
        /// Index of the blackout.
        index: usize,
    },
    /// Its line of sight comes too near to a body to avoid.
    Avoided,
    /// A person forbids it.
    Forbidden,
    /// Reserved time in a sliding window would exceed the limit.
    Thermal,
    /// The memory would overflow.
    Memory,
    /// The scan angles of its target and telescope would be too alike.
    ScanAngle {
        /// Multiple of the crossing angle.
        n: u32,
    },
    /// No rule: taking it would bring less than it costs, or only together with other changes.
    NotWorth,
}

impl Because {
    pub(super) const fn day_full(day: usize, needs_ns: i64, left_ns: i64) -> Self {
        Self::DayFull { day, needs: Duration::from_ns(needs_ns), left: Duration::from_ns(left_ns) }
    }
}

impl fmt::Display for Because {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoValue => f.write_str("it has no value: its weight or its dwell is zero"),
            Self::BeforeMission => f.write_str("its setup would begin before the mission"),
            Self::AfterMission => f.write_str("its cooldown would end after the mission"),
            Self::TooLongForDay { day, needs } => write!(
                f,
                "its session alone needs {} s of day {day}, more than the limit",
                needs.seconds()
            ),
            Self::Conflict { with } => write!(f, "it overlaps the session of candidate {with}"),
            Self::DayFull { day, needs, left } => write!(
                f,
                "it needs {} s of day {day}, which has {} s left",
                needs.seconds(),
                left.seconds()
            ),
            Self::SessionCount { from, count } => write!(
                f,
                "the window from {} ns TAI already holds {count} sessions, the most allowed",
                from.tai_ns()
            ),
            Self::Blackout { index } => write!(f, "it touches blackout {index}"),
            Self::Avoided => f.write_str("its line of sight comes too near to a body to avoid"),
            Self::Forbidden => f.write_str("it is forbidden"),
            Self::Thermal => f.write_str("the reserved time in a thermal window would be too long"),
            Self::Memory => f.write_str("the memory would overflow before the next contacts"),
            Self::ScanAngle { n } => {
                write!(f, "the scan angles would be too alike at n = {n}")
            }
            Self::NotWorth => f.write_str("taking it brings less than it costs"),
        }
    }
}

/// A candidate that was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rejection {
    /// Index of the candidate.
    pub candidate: usize,
    /// Why.
    pub because: Because,
}

/// A rule at one place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// No overlap, on one telescope or (`None`) at all; used and limit in seconds.
    Exclusive {
        /// Index of the telescope.
        telescope: Option<usize>,
    },
    /// Reserved time in a day, from the first boundary; used and limit in seconds.
    Day {
        /// Index of the day.
        day: usize,
    },
    /// Starts in the window that begins here; used and limit in sessions.
    SessionCount {
        /// Start of the window.
        from: Instant,
    },
    /// Sessions in a season; used and limit in sessions, the limit a least number.
    MinSessions {
        /// Index of the target.
        target: usize,
        /// Index of the telescope.
        telescope: usize,
        /// Start of the season.
        from: Instant,
    },
    /// Windows of the longest gap without a session; used in days beyond it, limit 0.
    Gap {
        /// Index of the telescope.
        telescope: usize,
        /// Start of the first window.
        from: Instant,
    },
    /// Reserved time in the window that begins here; used and limit in seconds.
    Thermal {
        /// Start of the window.
        from: Instant,
    },
    /// Data produced in a stretch of time; used and limit in seconds of production.
    Memory {
        /// Start of the stretch.
        from: Instant,
        /// Its end.
        until: Instant,
    },
    /// Mean resultant length of scan angles; used and limit are lengths.
    ScanAngle {
        /// Multiple of the crossing angle.
        n: u32,
        /// Index of the target.
        target: usize,
        /// Index of the telescope.
        telescope: usize,
    },
}

/// How far a rule is used, and what loosening it would bring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstraintUse {
    /// The rule.
    pub rule: Rule,
    /// What the schedule uses.
    pub used: f64,
    /// What the rule allows.
    pub limit: f64,
    /// Objective per second, or per session, that a small loosening would bring in the relaxation;
    /// for exclusivity the mean over the mission.
    pub shadow_price: f64,
}

/// Sets the reason of every session that does not stand.
pub(super) fn left_out(model: &Model, draft: &Draft<'_>, reasons: &mut [Option<Because>]) {
    for (id, session) in model.sessions.iter().enumerate() {
        if !draft.stands(id) {
            reasons[session.candidate] = draft.refusal(session);
        }
    }
}

/// The candidates with a reason, by index.
pub(super) fn rejections(reasons: Vec<Option<Because>>) -> Vec<Rejection> {
    reasons
        .into_iter()
        .enumerate()
        .filter_map(|(candidate, because)| because.map(|because| Rejection { candidate, because }))
        .collect()
}

/// How far the rules are used: each telescope, each day that a session could touch, and each
/// window with a price.
pub(super) fn usage(model: &Model, draft: &Draft<'_>, prices: &Prices) -> Vec<ConstraintUse> {
    let seconds = |ns: i64| Duration::from_ns(ns).seconds();
    let mut rows = Vec::new();
    let mut reserved = vec![0_i64; model.lanes];
    for id in draft.chosen() {
        let session = &model.sessions[id];
        if let Some(sum) = reserved.get_mut(session.lane) {
            *sum += session.length();
        }
    }
    let limit = seconds(model.span_ns);
    for ((&telescope, reserved), ladder) in model.lane_names.iter().zip(reserved).zip(&prices.lanes)
    {
        let price = model.price_from_units(f64_from_i64(ladder.total()));
        rows.push(ConstraintUse {
            rule: Rule::Exclusive { telescope },
            used: seconds(reserved),
            limit,
            shadow_price: if limit > 0.0 { price / limit } else { 0.0 },
        });
    }
    if let Some(limit) = model.day_limit {
        for day in 0..model.cell_count() {
            let price = model.price_from_units(f64_from_i64(prices.cell_worth(day, limit)));
            rows.push(ConstraintUse {
                rule: Rule::Day { day },
                used: seconds(draft.used(day)),
                limit: seconds(limit),
                shadow_price: if limit > 0 { price / seconds(limit) } else { 0.0 },
            });
        }
    }
    if let Some((count, window)) = model.count {
        for (from, price) in prices.windows.points() {
            let used = draft.starts(from, from.saturating_add(window)).count();
            rows.push(ConstraintUse {
                rule: Rule::SessionCount { from: Instant::from_tai_ns(from) },
                used: f64_from_i64(i64_from_usize(used)),
                limit: f64_from_i64(i64_from_usize(count)),
                shadow_price: model.price_from_units(f64_from_i64(price)),
            });
        }
    }
    rows
}
