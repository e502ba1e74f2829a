//! What binds the calibration timeline.
//!
//! A constraint that is absent, or `"none"`, does not bind. Durations are exact numbers here and
//! nanoseconds where the methods give them.
//!
//! # Example
//! Saturn worth ten times as much as the rest, and no session longer than 20 min a day:
//! ```
//! use mission::{Mission, Override};
//!
//! let saturn = Override::set("calibration.schedule.weights.saturn=10")?;
//! let day = Override::set("calibration.schedule.max_minutes_per_day=20")?;
//! let rules = Mission::load("litebird", &[saturn, day])?.calibration.schedule;
//! assert_eq!((rules.weight("saturn"), rules.weight("mars")), (10.0, 1.0));
//! assert_eq!(rules.max_per_day().map(|it| it.seconds()), Some(1200.0));
//! assert_eq!((rules.setup().seconds(), rules.cooldown().seconds()), (600.0, 300.0));
//! # Ok::<(), mission::fault::MissionError>(())
//! ```

use crate::fault::Problem;
use crate::file_path::FilePath;
use crate::names::in_any_case;
use crate::number::Number;
use crate::reading::canon::Canon;
use crate::reading::document::{Node, Value};
use crate::reading::range::Range;
use crate::reading::section::{Section, one_of_meant};
use crate::rounding;
use num_rational::BigRational;
use onboard_core::time::Duration;

/// The constraints and the objective.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Schedule {
    /// Reserved before the first entry.
    pub setup_s: Number,
    /// Reserved after the last exit.
    pub cooldown_s: Number,
    /// What sessions exclude each other.
    pub exclusive: Exclusive,
    /// Per UTC day, setup and cooldown included.
    pub max_minutes_per_day: Option<Number>,
    /// At most so many sessions in any window.
    pub max_sessions: Option<SessionLimit>,
    /// At least so many sessions per target and telescope in any window with opportunities.
    pub min_sessions: Option<SessionLimit>,
    /// The longest time without a session, softly.
    pub longest_gain_gap: Option<GainGap>,
    /// Diversity of scan angles.
    pub scan_angle: Vec<ScanAngle>,
    /// Downlink and memory.
    pub data: Option<DataBudget>,
    /// Bodies to stay away from.
    pub avoidance: Vec<Avoidance>,
    /// Times when nothing is allowed: a CSV or an iCalendar file.
    pub blackouts: Option<FilePath>,
    /// Heat.
    pub thermal: Option<Thermal>,
    /// A weight for every target of the mission, then for others named.
    pub weights: Vec<(String, Weight)>,
    /// The objective is logarithmic in the time per cell.
    pub logarithmic: bool,
}

/// What sessions of a target are worth.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Weight {
    /// This for each second in view.
    Plain(Number),
    /// This for each effective second of a purpose.
    ByPurpose(Vec<(Purpose, Number)>),
}

/// What a session is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Purpose {
    /// The beam's shape.
    BeamMap,
    /// The gain.
    Gain,
    /// Where the beam points.
    Pointing,
    /// The angle of polarisation.
    PolarisationAngle,
}

impl Purpose {
    /// All, with their keys.
    pub const EACH: [(&'static str, Self); 4] = [
        ("beam_map", Self::BeamMap),
        ("gain", Self::Gain),
        ("pointing", Self::Pointing),
        ("polarisation_angle", Self::PolarisationAngle),
    ];

    /// Its key.
    #[must_use]
    pub fn key(self) -> &'static str {
        Self::EACH.iter().find(|it| it.1 == self).map_or("", |it| it.0)
    }
}

/// What sessions exclude each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exclusive {
    /// Those of one telescope.
    Telescope,
    /// All.
    All,
}

/// So many sessions in any window.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SessionLimit {
    /// Sessions.
    pub count: u32,
    /// Length of the window.
    pub days: Number,
}

/// The longest time without a session, and what exceeding it costs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GainGap {
    /// The longest gap.
    pub days: Number,
    /// Score lost per day above it.
    pub price_per_day: Number,
}

/// |sum w exp(i n psi)| at most rho times sum w.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScanAngle {
    /// Multiple of the crossing angle.
    pub n: u32,
    /// Bound on the resultant.
    pub rho: Number,
}

/// What can be stored and sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DataBudget {
    /// Data produced in a session.
    pub rate_bit_s: Number,
    /// Memory on board.
    pub memory_bit: Number,
    /// Ground contacts: a CSV.
    pub contacts: FilePath,
}

/// A body to stay away from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Avoidance {
    /// One of [`AVOIDABLE`] or a target.
    pub body: String,
    /// Smallest angle to the line of sight.
    pub angle_deg: Number,
}

/// At most so many session minutes in any window of hours.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Thermal {
    /// Session minutes.
    pub minutes: Number,
    /// Length of the window.
    pub window_hours: Number,
}

/// Bodies that can be avoided though they are no targets.
pub const AVOIDABLE: [&str; 2] = ["sun", "earth"];

const PADDING: Range = Range::closed("a duration", 0.0, 31_557_600.0, "s");
const COUNT: Range = Range::closed("a whole number", 1.0, 1_000_000.0, "");
const WINDOW: Range = Range::positive("a duration", 36525.0, "days");
const PRICE: Range = Range::closed("a price", 0.0, 1e12, "");
const MULTIPLE: Range = Range::closed("a whole number", 1.0, 100.0, "");
const RATIO: Range = Range::closed("a ratio", 0.0, 1.0, "");
const DATA_RATE: Range = Range::positive("a rate", 1e18, "bit/s");
const MEMORY: Range = Range::positive("a size", 1e21, "bit");
const ANGLE: Range = Range::positive("an angle", 180.0, "deg");
const HEAT_MINUTES: Range = Range::positive("a duration", 52_596_000.0, "min");
const HEAT_WINDOW: Range = Range::positive("a duration", 876_600.0, "hours");
const WEIGHT: Range = Range::closed("a weight", 0.0, 1e12, "");
const MINUTES_PER_DAY: f64 = 1440.0;

impl Schedule {
    pub(crate) fn read(
        section: &mut Section<'_>,
        telescopes: usize,
        targets: &[String],
        legal: &[&str],
    ) -> Self {
        // Sessions of different telescopes may run at the same time, and each counts.
        let day = MINUTES_PER_DAY * f64::from(u32::try_from(telescopes.max(1)).unwrap_or(u32::MAX));
        let exclusive = [("telescope", Exclusive::Telescope), ("all", Exclusive::All)];
        let mut schedule = Self {
            setup_s: section.number("setup_s", &PADDING, Some("0.0")),
            cooldown_s: section.number("cooldown_s", &PADDING, Some("0.0")),
            exclusive: section.choice("exclusive", &exclusive).unwrap_or(Exclusive::Telescope),
            max_minutes_per_day: section
                .optional_number("max_minutes_per_day", &Range::positive("a duration", day, "min")),
            max_sessions: section.inline("max_sessions", SessionLimit::read),
            min_sessions: section.inline("min_sessions", SessionLimit::read),
            longest_gain_gap: section.inline("longest_gain_gap", |s| GainGap {
                days: s.number("days", &WINDOW, None),
                price_per_day: s.number("price_per_day", &PRICE, None),
            }),
            scan_angle: section.inline_tables("scan_angle", |s| ScanAngle {
                n: s.count("n", &MULTIPLE),
                rho: s.number("rho", &RATIO, None),
            }),
            data: section.inline("data", |s| DataBudget {
                rate_bit_s: s.number("rate_bit_s", &DATA_RATE, None),
                memory_bit: s.number("memory_bit", &MEMORY, None),
                contacts: FilePath::read(s, "contacts"),
            }),
            avoidance: section.inline_tables("avoidance", |s| Avoidance::read(s, legal)),
            blackouts: FilePath::read_optional(section, "blackouts"),
            thermal: section.inline("thermal", |s| Thermal {
                minutes: s.number("minutes", &HEAT_MINUTES, None),
                window_hours: s.number("window_hours", &HEAT_WINDOW, None),
            }),
            weights: weights(section, targets, legal),
            logarithmic: false,
        };
        schedule.logarithmic =
            section.choice("objective", &[("linear", false), ("log", true)]) == Some(true);
        schedule
    }

    /// Reserved before the first entry.
    #[must_use]
    pub fn setup(&self) -> Duration {
        rounded(self.setup_s.exact())
    }

    /// Reserved after the last exit.
    #[must_use]
    pub fn cooldown(&self) -> Duration {
        rounded(self.cooldown_s.exact())
    }

    /// The most session time in a UTC day.
    #[must_use]
    pub fn max_per_day(&self) -> Option<Duration> {
        self.max_minutes_per_day.as_ref().map(|minutes| rounded(&minutes.times(60, 1)))
    }

    /// A target's weight per second in view: 1 where none is given, 0 where it has purposes.
    #[must_use]
    pub fn weight(&self, target: &str) -> f64 {
        match self.weights.iter().find(|(name, _)| name == target) {
            None => 1.0,
            Some((_, Weight::Plain(weight))) => weight.to_f64(),
            Some((_, Weight::ByPurpose(_))) => 0.0,
        }
    }

    /// A target's weights by purpose; none where it has a plain one.
    #[must_use]
    pub fn purposes(&self, target: &str) -> &[(Purpose, Number)] {
        match self.weights.iter().find(|(name, _)| name == target) {
            Some((_, Weight::ByPurpose(weights))) => weights,
            _ => &[],
        }
    }
}

impl SessionLimit {
    fn read(section: &mut Section<'_>) -> Self {
        Self { count: section.count("count", &COUNT), days: section.number("days", &WINDOW, None) }
    }

    /// Length of the window.
    #[must_use]
    pub fn window(&self) -> Duration {
        rounded(&self.days.times(86400, 1))
    }
}

impl Avoidance {
    fn read(section: &mut Section<'_>, legal: &[&str]) -> Self {
        let legal: Vec<&str> = AVOIDABLE.into_iter().chain(legal.iter().copied()).collect();
        let written = section.name("body", None);
        let found = in_any_case(&written, &legal);
        if !written.is_empty()
            && found.is_none()
            && let Some(node) = section.node_of("body")
        {
            section.not_legal("body", node, &one_of_meant(&written, &legal));
        }
        let body = found.map_or(written.clone(), str::to_owned);
        Self { body, angle_deg: section.number("angle_deg", &ANGLE, None) }
    }
}

/// Whole nanoseconds; every range above fits.
fn rounded(seconds: &BigRational) -> Duration {
    rounding::duration(seconds).unwrap_or(Duration::ZERO)
}

/// A weight for each target, 1 where none is given, then the others by name.
fn weights(section: &mut Section<'_>, targets: &[String], legal: &[&str]) -> Vec<(String, Weight)> {
    let one = Number::parse("1.0").unwrap_or_else(|_| Number::zero());
    let mut weights: Vec<(String, Weight)> =
        targets.iter().map(|target| (target.clone(), Weight::Plain(one.clone()))).collect();
    match section.find("weights") {
        None => {}
        Some(node) => {
            if let Value::Table(table) = &node.value {
                for (name, node) in table {
                    let name = in_any_case(name, legal).unwrap_or(name);
                    let key = format!("weights.{name}");
                    if !legal.contains(&name) {
                        let (key, nearest) = (section.key(&key), nearest(name, legal));
                        let nearest = section.key(&format!("weights.{nearest}"));
                        section.fault(&node.place, Problem::UnknownKey { key, nearest });
                        continue;
                    }
                    let Some(weight) = weight(section, &key, node) else { continue };
                    match weights.iter_mut().find(|(target, _)| target == name) {
                        Some(entry) => entry.1 = weight,
                        None => weights.push((name.to_owned(), weight)),
                    }
                }
            } else {
                section.not_legal(
                    "weights",
                    node,
                    &"a table such as { jupiter = 1.0, mars = { beam_map = 1.0, gain = 0.5 } }",
                );
            }
        }
    }
    let mut canon = Canon::default();
    for (name, weight) in &weights {
        canon.line(name, weight.toml());
    }
    section.record("weights", canon.inline());
    weights
}

/// One target's weight: a number, or a table of numbers by purpose.
fn weight(section: &Section<'_>, key: &str, node: &Node) -> Option<Weight> {
    let Value::Table(table) = &node.value else {
        return section.number_of(key, node, &WEIGHT).map(Weight::Plain);
    };
    let names = Purpose::EACH.map(|it| it.0);
    let mut weights = Vec::new();
    for (name, node) in table {
        let path = format!("{key}.{name}");
        if let Some(&(_, purpose)) = Purpose::EACH.iter().find(|it| it.0 == name) {
            weights.push((purpose, section.number_of(&path, node, &WEIGHT)?));
        } else {
            let nearest = section.key(&format!("{key}.{}", nearest(name, &names)));
            let key = section.key(&path);
            section.fault(&node.place, Problem::UnknownKey { key, nearest });
        }
    }
    weights.sort_by_key(|it| it.0);
    Some(Weight::ByPurpose(weights))
}

impl Weight {
    fn toml(&self) -> String {
        match self {
            Self::Plain(number) => number.toml(),
            Self::ByPurpose(weights) => {
                let item = |it: &(Purpose, Number)| format!("{} = {}", it.0.key(), it.1.toml());
                let items: Vec<String> = weights.iter().map(item).collect();
                format!("{{ {} }}", items.join(", "))
            }
        }
    }
}

fn nearest<'n>(name: &str, legal: &[&'n str]) -> &'n str {
    let similarity = |known: &str| strsim::jaro_winkler(name, known);
    legal.iter().copied().max_by(|a, b| similarity(a).total_cmp(&similarity(b))).unwrap_or_default()
}
