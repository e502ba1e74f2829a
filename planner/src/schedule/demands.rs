//! What a schedule must respect beyond [`Rules`](super::Rules), and what else it may aim at.
//!
//! Each part is absent unless given. Times are instants of TAI, durations nanoseconds, prices in units
//! of the objective.
//!
//! Limits: a season is a fixed window, consecutive from the mission's start, not one that slides; the
//! longest gap is charged in steps (see [`LongestGap`]); scan angles count in whole milliseconds.

use super::rule::SessionCount;
use onboard_core::sequencer::SkipReason;
use onboard_core::time::{Duration, Instant};
use std::collections::BTreeMap;

const DAY_S: f64 = 86_400.0;

/// Further rules, and the objective.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Demands {
    /// At least `count` sessions of each target on each telescope in each season of length `window`,
    /// or as many as it has opportunities there. Seasons follow each other from the mission's start; a
    /// shorter last one asks for its share, rounded down.
    pub min_sessions: Option<SessionCount>,
    /// The longest time without a session on a telescope, and what exceeding it costs.
    pub longest_gap: Option<LongestGap>,
    /// Bounds on scan angles, per target and telescope.
    pub diversity: Vec<Diversity>,
    /// Memory and downlink.
    pub data: Option<Data>,
    /// Reserved time in a sliding window.
    pub thermal: Option<Thermal>,
    /// Half-open intervals that no session may touch.
    pub blackouts: Vec<(Instant, Instant)>,
    /// Candidates that the spacecraft would not begin, ascending: a field of view comes too near to a
    /// body to avoid, or what `skipped` says.
    pub avoided: Vec<usize>,
    /// Why the spacecraft would not begin some of `avoided`, where that is no body to avoid.
    pub skipped: BTreeMap<usize, SkipReason>,
    /// Candidates that must stand.
    pub fixed: Vec<usize>,
    /// Candidates that must not stand.
    pub forbidden: Vec<usize>,
    /// An earlier plan.
    pub previous: Option<Previous>,
    /// The objective is logarithmic.
    pub log: Option<Log>,
    /// What each candidate is worth instead of weight times dwell; empty where that stands.
    pub values: Vec<f64>,
}

/// Each day that a telescope goes without a session beyond `longest` costs `price_per_day`.
///
/// The charge is exact for windows of length `longest` whose starts are [`LongestGap::step`] apart:
/// each that no session starts in, though some opportunity does, costs a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LongestGap {
    /// The longest gap that is free, positive.
    pub longest: Duration,
    /// Objective lost per day beyond it, finite and not negative.
    pub price_per_day: f64,
}

impl LongestGap {
    /// Time between the starts of two windows: an eighth of the gap.
    #[must_use]
    pub fn step(&self) -> Duration {
        Duration::from_ns((self.longest.ns() / 8).max(1))
    }

    /// Objective lost per window that no session starts in.
    #[must_use]
    pub fn charge(&self) -> f64 {
        self.price_per_day * self.step().seconds() / DAY_S
    }
}

/// `|sum w exp(i n psi)| <= rho sum w` over the passes of each target on each telescope.
#[derive(Debug, Clone, PartialEq)]
pub struct Diversity {
    /// Multiple of the crossing angle.
    pub n: u32,
    /// Largest mean resultant length, 0 to 1.
    pub rho: f64,
    /// Per candidate: the sums over its passes of w, w cos(n psi) and w sin(n psi), w in seconds.
    pub sums: Vec<[f64; 3]>,
}

/// A ground contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Contact {
    /// Its start.
    pub from: Instant,
    /// Its end.
    pub until: Instant,
    /// Whole bits sent per second.
    pub bit_s: u64,
}

/// Sessions produce data between first entry and last exit; contacts drain the memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Data {
    /// Whole bits produced per second, positive.
    pub rate_bit_s: u64,
    /// Bits that the memory holds.
    pub memory_bit: u64,
    /// Contacts in order, not overlapping.
    pub contacts: Vec<Contact>,
}

/// At most `most` reserved time of all sessions together in any window of length `window`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Thermal {
    /// Most reserved time.
    pub most: Duration,
    /// Length of the window, positive.
    pub window: Duration,
}

/// A plan to stay close to.
#[derive(Debug, Clone, PartialEq)]
pub struct Previous {
    /// Its sessions, as candidates of this problem.
    pub sessions: Vec<usize>,
    /// Objective that each session added or dropped must bring, finite and not negative.
    pub price: f64,
}

/// The objective is `sum over cells of weight ln(1 + t / offset)`, t the time in view in the cell: a
/// target on a telescope in an epoch at a range of scan angles.
#[derive(Debug, Clone, PartialEq)]
pub struct Log {
    /// The time that counts as one unit of information, positive.
    pub offset: Duration,
    /// Length of an epoch, positive.
    pub epoch: Duration,
    /// Per candidate: bins, such as ranges of scan angles, and the time in each.
    pub parts: Vec<Vec<(u32, Duration)>>,
    /// Weights of cells by target and bin, where it is not the target's, finite and not negative.
    pub weights: BTreeMap<(usize, u32), f64>,
}

impl Log {
    /// The weight of a target's cells at a bin.
    #[must_use]
    pub fn weight(&self, by_target: &[f64], target: usize, bin: u32) -> f64 {
        self.weights.get(&(target, bin)).copied().unwrap_or(by_target[target])
    }
}

impl Demands {
    /// The largest charge at one place: for an empty window of the longest gap, or a change of the earlier
    /// plan.
    pub(super) fn largest_charge(&self) -> f64 {
        let gap = self.longest_gap.map(|it| it.charge());
        let change = self.previous.as_ref().map(|it| it.price);
        gap.into_iter().chain(change).fold(0.0, f64::max)
    }

    /// Whether nothing is asked for but other values.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self { values: self.values.clone(), ..Self::default() }
    }
}
