//! The rules of a problem as an integer programme over its sessions.
//!
//! Method: choice i is session i of the model. Overlap gives one row per maximal set of sessions that
//! share an instant; a day, a window, a stretch of memory one row each; scan angles rows tangent to
//! their cones. Seasons and gaps are cells that pay per session up to what is wanted, so a shortage
//! costs its price: one that outweighs sessions for seasons, the given price for gaps. Rows too many
//! to list come from `families.rs`.

use super::demands::{Demands, Diversity};
use super::explain::Rule;
use super::families::{Cone, Heat, Member, Memory, Starts};
use super::model::Model;
use super::{Problem, relaxation};
use crate::program::number::{f64_from_i64, i64_from_f64, i64_from_usize};
use crate::program::{Cell, Choice, Family, Gain, Program, Row};
use onboard_core::time::{Duration, Instant};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use std::ops::Range;

/// A session missing in a season costs as much as so many of the most valuable.
const SEASON_PRICE: f64 = 12.0;
/// Directions in which each cone has a tangent from the start.
const TANGENTS: u32 = 24;
/// Windows of reserved time with a row in the length of a window.
const HEAT_WINDOWS: i64 = 16;
/// A limit on time also limits how many of the larger sessions stand, up to this number.
const LAYERS: i64 = 3;
/// Units of the logarithmic objective's largest cell.
const LARGEST_CELL: f64 = 68_719_476_736.0;
const MS: i64 = 1_000_000;
const DAY_S: f64 = 86_400.0;

/// Target, telescope, epoch and range of scan angles.
type CellKey = (usize, usize, i64, u32);

/// A season of one target on one telescope.
#[derive(Debug, Clone)]
pub(super) struct Season {
    pub(super) rule: Rule,
    pub(super) wanted: usize,
    /// Sessions that count.
    pub(super) sessions: Vec<usize>,
    /// Its cell of the programme.
    pub(super) cell: usize,
}

/// A bound on the scan angles of one target on one telescope.
#[derive(Debug, Clone)]
pub(super) struct Angles {
    pub(super) rule: Rule,
    /// Its tangents among the programme's rows.
    pub(super) rows: Range<usize>,
    /// Its family, which adds further ones.
    pub(super) family: usize,
}

/// A window that a session should start in.
#[derive(Debug, Clone)]
pub(super) struct Gap {
    pub(super) rule: Rule,
    pub(super) sessions: Vec<usize>,
}

/// A problem as a programme.
pub(super) struct Built<'m> {
    pub(super) program: Program,
    /// The rule of each row, where one row is one rule at one place.
    pub(super) rules: Vec<Option<Rule>>,
    /// The rows before this one are those of overlap, days and starts.
    pub(super) further: usize,
    pub(super) families: Vec<Box<dyn Family + 'm>>,
    /// What the programme's values are above those of the schedule, in units.
    pub(super) offset: i128,
    /// Units per value, and the value they are of: their quotient may not be a number.
    unit: (f64, f64),
    pub(super) seasons: Vec<Season>,
    pub(super) gaps: Vec<Gap>,
    pub(super) angles: Vec<Angles>,
    /// Rows that families added to the programme, and which family.
    pub(super) grown: Vec<(usize, usize)>,
    /// Objective lost per empty window.
    pub(super) gap_charge: f64,
}

/// Everything about the sessions that rows need.
#[derive(Debug)]
pub(super) struct Facts {
    /// Per session, from when until when it produces data.
    pub(super) produces: Vec<(i64, i64)>,
    /// Target and telescope.
    pub(super) of: Vec<(usize, usize)>,
}

impl Facts {
    pub(super) fn new(problem: &Problem, model: &Model) -> Self {
        let candidates = model.sessions.iter().map(|it| &problem.candidates[it.candidate]);
        Self {
            produces: candidates
                .clone()
                .map(|it| (it.first_entry.tai_ns(), it.last_exit.tai_ns()))
                .collect(),
            of: candidates.map(|it| (it.target, it.telescope)).collect(),
        }
    }
}

/// The programme of a problem.
pub(super) fn build<'m>(problem: &'m Problem, model: &'m Model, facts: &'m Facts) -> Built<'m> {
    let demands = &problem.demands;
    let unit = match &demands.log {
        None => model.unit(),
        Some(log) => {
            let weights = problem.weights.iter().chain(log.weights.values());
            (LARGEST_CELL, weights.copied().fold(f64::MIN_POSITIVE, f64::max))
        }
    };
    let count = model.sessions.len();
    let mut fixed = vec![false; problem.candidates.len()];
    for &candidate in &demands.fixed {
        fixed[candidate] = true;
    }
    let choice = |id: usize| {
        if fixed[model.sessions[id].candidate] { Choice::Always } else { Choice::Free }
    };
    let linear = demands.log.is_none();
    let mut built = Built {
        program: Program {
            values: model.sessions.iter().map(|it| if linear { it.value } else { 0 }).collect(),
            choices: (0..count).map(choice).collect(),
            rows: Vec::new(),
            cells: Vec::new(),
        },
        rules: Vec::new(),
        further: 0,
        families: Vec::new(),
        offset: 0,
        unit,
        seasons: Vec::new(),
        gaps: Vec::new(),
        angles: Vec::new(),
        grown: Vec::new(),
        gap_charge: 0.0,
    };
    built.overlaps(model);
    built.days(model);
    built.starts(model);
    built.further = built.program.rows.len();
    built.heat(model, demands);
    built.memory(facts, demands, problem.span);
    for diversity in &demands.diversity {
        built.cones(model, facts, diversity);
    }
    built.logarithms(problem, model, facts);
    built.previous(model, demands);
    built.season_cells(problem, model, facts);
    built.gap_cells(problem, model, facts);
    built
}

impl<'m> Built<'m> {
    /// A value in units.
    fn units(&self, value: f64) -> f64 {
        value / self.unit.1.max(f64::MIN_POSITIVE) * self.unit.0
    }

    /// Units as a value.
    pub(super) fn value(&self, units: f64) -> f64 {
        units / self.unit.0 * self.unit.1
    }

    fn row(&mut self, row: Row, rule: Option<Rule>) {
        let most: i128 = row.terms.iter().map(|it| i128::from(it.1.max(0))).sum();
        if most > i128::from(row.limit) {
            self.program.rows.push(row);
            self.rules.push(rule);
        }
    }

    /// A limit on time, and what follows from it: of sessions that each use more than 1/(k + 1) of
    /// the limit, at most k.
    fn limit(&mut self, row: Row, rule: Option<Rule>) {
        for most in 1..=LAYERS {
            let large = |it: &&(usize, i64)| {
                i128::from(it.1) * i128::from(most + 1) > i128::from(row.limit)
            };
            let terms = row.terms.iter().filter(large).map(|it| (it.0, 1)).collect();
            self.row(Row { terms, limit: most }, None);
        }
        self.row(row, rule);
    }

    fn overlaps(&mut self, model: &Model) {
        for lane in 0..model.lanes {
            let on: Vec<usize> =
                (0..model.sessions.len()).filter(|&id| model.sessions[id].lane == lane).collect();
            for at in relaxation::cliques(model, on.iter().copied()) {
                let earliest = at.saturating_sub(model.longest);
                let first = on.partition_point(|&id| model.sessions[id].start < earliest);
                let near = on[first..].iter().take_while(|id| model.sessions[**id].start <= at);
                let terms = near.filter(|id| model.sessions[**id].end > at).map(|&id| (id, 1));
                self.row(Row { terms: terms.collect(), limit: 1 }, None);
            }
        }
    }

    fn days(&mut self, model: &Model) {
        let Some(limit) = model.day_limit else { return };
        let mut days: Vec<Vec<(usize, i64)>> = vec![Vec::new(); model.cell_count()];
        for (id, session) in model.sessions.iter().enumerate() {
            for (cell, ns) in model.shares(session) {
                days[cell].push((id, ns));
            }
        }
        for terms in days {
            self.limit(Row { terms, limit }, None);
        }
    }

    fn starts(&mut self, model: &'m Model) {
        let Some((count, window)) = model.count else { return };
        let family = Starts { sessions: &model.sessions, count, window };
        let all: Vec<usize> = (0..model.sessions.len()).collect();
        for from in relaxation::window_starts(model, &all) {
            self.row(family.row(from), None);
        }
        self.families.push(Box::new(family));
    }

    fn heat(&mut self, model: &'m Model, demands: &Demands) {
        let Some(thermal) = demands.thermal else { return };
        let (most, window) = (thermal.most.ns(), thermal.window.ns());
        let family = Heat { sessions: &model.sessions, longest: model.longest, most, window };
        let step = (window / HEAT_WINDOWS).max(1);
        let mut from = i64::MIN;
        for session in &model.sessions {
            if session.start.saturating_sub(from) >= step || from == i64::MIN {
                from = session.start;
                let rule = Rule::Thermal { from: Instant::from_tai_ns(from) };
                self.limit(family.row(from), Some(rule));
            }
        }
        self.families.push(Box::new(family));
    }

    fn memory(&mut self, facts: &'m Facts, demands: &'m Demands, span: (Instant, Instant)) {
        let Some(data) = &demands.data else { return };
        let family = Memory { produces: &facts.produces, data };
        // Stretches from the end of a contact to the start of one of the next few.
        let mut ends = vec![span.0.tai_ns()];
        ends.extend(data.contacts.iter().map(|it| it.until.tai_ns()));
        let mut starts: Vec<i64> = data.contacts.iter().map(|it| it.from.tai_ns()).collect();
        starts.push(span.1.tai_ns());
        for (place, &from) in ends.iter().enumerate() {
            for ahead in [0, 1, 3] {
                if let Some(&until) = starts.get(place + ahead)
                    && until > from
                {
                    let at = Instant::from_tai_ns;
                    let rule = Rule::Memory { from: at(from), until: at(until) };
                    self.row(family.row(from, until), Some(rule));
                }
            }
        }
        self.families.push(Box::new(family));
    }

    fn cones(&mut self, model: &Model, facts: &Facts, diversity: &Diversity) {
        for ((target, telescope), members) in cone_members(model, facts, diversity) {
            let cone = Cone { members };
            let first = self.program.rows.len();
            for direction in 0..TANGENTS {
                let angle = TAU * f64::from(direction) / f64::from(TANGENTS);
                self.row(cone.tangent(angle.cos(), angle.sin()), None);
            }
            self.angles.push(Angles {
                rule: Rule::ScanAngle { n: diversity.n, target, telescope },
                rows: first..self.program.rows.len(),
                family: self.families.len(),
            });
            self.families.push(Box::new(cone));
        }
    }

    fn logarithms(&mut self, problem: &Problem, model: &Model, facts: &Facts) {
        let Some(log) = &problem.demands.log else { return };
        let mut cells: BTreeMap<CellKey, Vec<(usize, i64)>> = BTreeMap::new();
        for (id, session) in model.sessions.iter().enumerate() {
            let epoch = epoch(problem, session.start, log.epoch);
            let (target, telescope) = facts.of[id];
            for &(bin, time) in &log.parts[session.candidate] {
                let ms = time.ns() / MS;
                let terms = cells.entry((target, telescope, epoch, bin)).or_default();
                match terms.last_mut() {
                    Some(last) if last.0 == id => last.1 += ms,
                    _ => terms.push((id, ms)),
                }
            }
        }
        let offset = (log.offset.ns() / MS).max(1);
        for ((target, _, _, bin), terms) in cells {
            let weight = log.weight(&problem.weights, target, bin);
            let scale = i64_from_f64(self.units(weight).ceil());
            let gain = Gain::Log { scale, offset };
            self.program.cells.push(Cell { terms, gain, base: 0 });
        }
    }

    fn previous(&mut self, model: &Model, demands: &Demands) {
        let Some(previous) = &demands.previous else { return };
        let price = i64_from_f64(self.units(previous.price).floor()).clamp(0, 1 << 44);
        // Each session of that plan pays its price unless it stands, whether or not it can.
        let before: BTreeSet<usize> = previous.sessions.iter().copied().collect();
        for (id, session) in model.sessions.iter().enumerate() {
            let kept = before.contains(&session.candidate);
            self.program.values[id] += if kept { price } else { -price };
        }
        self.offset += i128::from(price) * i128::from(i64_from_usize(before.len()));
    }

    /// The programme with every season as a rule instead of at a price alone.
    pub(super) fn with_seasons_met(&self) -> Program {
        let mut strict = self.program.clone();
        strict.rows.extend(self.seasons.iter().map(|season| Row {
            terms: season.sessions.iter().map(|&id| (id, -1)).collect(),
            limit: -i64_from_usize(season.wanted),
        }));
        strict
    }

    fn season_cells(&mut self, problem: &Problem, model: &Model, facts: &Facts) {
        self.seasons = seasons(problem, model, facts);
        let largest = self.program.values.iter().map(|it| it.abs()).max().unwrap_or(1);
        let largest = f64_from_i64(largest).max(if problem.demands.log.is_some() {
            4.0 * LARGEST_CELL
        } else {
            1.0
        });
        let price = i64_from_f64((SEASON_PRICE * largest).ceil());
        for season in &mut self.seasons {
            season.cell = self.program.cells.len();
            let wanted = i64_from_usize(season.wanted);
            let terms = season.sessions.iter().map(|&id| (id, 1)).collect();
            let gain = Gain::Shortfall { wanted, price };
            self.program.cells.push(Cell { terms, gain, base: 0 });
            self.offset += i128::from(price) * i128::from(wanted);
        }
    }

    fn gap_cells(&mut self, problem: &Problem, model: &Model, facts: &Facts) {
        let Some(gap) = problem.demands.longest_gap else { return };
        let step = gap.step();
        self.gap_charge = gap.price_per_day * step.seconds() / DAY_S;
        let price = i64_from_f64(self.units(self.gap_charge).floor()).clamp(0, 1 << 44);
        let mut telescopes: Vec<usize> = facts.of.iter().map(|it| it.1).collect();
        telescopes.sort_unstable();
        telescopes.dedup();
        for telescope in telescopes {
            let on: Vec<usize> =
                (0..facts.of.len()).filter(|&id| facts.of[id].1 == telescope).collect();
            let mut from = problem.span.0;
            while from.plus(gap.longest) <= problem.span.1 {
                let until = from.plus(gap.longest).tai_ns();
                let start = |id: &usize| model.sessions[*id].start;
                let first = on.partition_point(|id| start(id) < from.tai_ns());
                let last = on.partition_point(|id| start(id) < until);
                if last > first {
                    let sessions = on[first..last].to_vec();
                    let terms = sessions.iter().map(|&id| (id, 1)).collect();
                    let gain = Gain::Shortfall { wanted: 1, price };
                    self.program.cells.push(Cell { terms, gain, base: 0 });
                    self.offset += i128::from(price);
                    self.gaps.push(Gap { rule: Rule::Gap { telescope, from }, sessions });
                }
                from = from.plus(step);
            }
        }
    }
}

/// Members of each cone, by target and telescope.
pub(super) fn cone_members(
    model: &Model,
    facts: &Facts,
    diversity: &Diversity,
) -> BTreeMap<(usize, usize), Vec<Member>> {
    let mut cones: BTreeMap<(usize, usize), Vec<Member>> = BTreeMap::new();
    for (id, session) in model.sessions.iter().enumerate() {
        let [weight, cos, sin] = diversity.sums[session.candidate].map(|it| it * 1e3);
        let member = (
            id,
            i64_from_f64(cos.round()),
            i64_from_f64(sin.round()),
            i64_from_f64((diversity.rho * weight).floor()),
        );
        cones.entry(facts.of[id]).or_default().push(member);
    }
    cones
}

/// Number of the epoch that holds an instant.
fn epoch(problem: &Problem, at: i64, length: Duration) -> i64 {
    at.saturating_sub(problem.span.0.tai_ns()).div_euclid(length.ns().max(1))
}

/// The seasons, with what each wants.
fn seasons(problem: &Problem, model: &Model, facts: &Facts) -> Vec<Season> {
    let Some(rule) = problem.demands.min_sessions else { return Vec::new() };
    let mission = problem.span.1.since(problem.span.0).ns();
    let length = rule.window.ns();
    let mut avoided = vec![false; problem.candidates.len()];
    for &candidate in &problem.demands.avoided {
        avoided[candidate] = true;
    }
    // Opportunities count whether or not the other rules let them stand.
    let mut offered: BTreeMap<(usize, usize, i64), usize> = BTreeMap::new();
    for (candidate, it) in problem.candidates.iter().enumerate() {
        let (start, end) = problem.reserved(candidate);
        let inside = start >= problem.span.0 && end <= problem.span.1;
        if inside && !avoided[candidate] && problem.value(candidate) > 0.0 {
            let season = epoch(problem, start.tai_ns(), rule.window);
            *offered.entry((it.target, it.telescope, season)).or_default() += 1;
        }
    }
    let mut sessions: BTreeMap<(usize, usize, i64), Vec<usize>> = BTreeMap::new();
    for (id, session) in model.sessions.iter().enumerate() {
        let season = epoch(problem, session.start, rule.window);
        let (target, telescope) = facts.of[id];
        sessions.entry((target, telescope, season)).or_default().push(id);
    }
    let seasons = offered.into_iter().filter_map(|(key, offered)| {
        let (target, telescope, season) = key;
        let rest = mission.saturating_sub(season.saturating_mul(length)).clamp(0, length);
        let share = i128::from(rule.count) * i128::from(rest) / i128::from(length.max(1));
        let wanted = usize::try_from(share).unwrap_or(usize::MAX).min(offered);
        let from = problem.span.0.plus(Duration::from_ns(season.saturating_mul(length)));
        (wanted > 0).then(|| Season {
            rule: Rule::MinSessions { target, telescope, from },
            wanted,
            sessions: sessions.remove(&key).unwrap_or_default(),
            cell: usize::MAX,
        })
    });
    seasons.collect()
}
