//! The rules as rows of the programme.
//!
//! Method: overlap gives one row per maximal clique of sessions that share an instant; a day, a window, a
//! stretch of memory one row each, a limit on time also one for each number of larger sessions; scan
//! angles rows tangent to their cones. Rows too many to list come from the families, which start here.
//!
//! Limits: of sliding windows and stretches of memory only some are listed.

use super::built::{Angles, Built};
use super::cone::{self, Cone};
use super::heat::Heat;
use super::memory::Memory;
use super::starts::Starts;
use crate::program::Row;
use crate::schedule::demands::Diversity;
use crate::schedule::instants::{cliques, window_starts};
use crate::schedule::reason::Because;
use crate::schedule::rule::Rule;
use onboard_core::time::Instant;
use std::f64::consts::TAU;

/// Directions in which each cone has a tangent from the start.
const TANGENTS: u32 = 24;
/// Windows of reserved time with a row in the length of a window.
const HEAT_WINDOWS: i64 = 16;

impl Built<'_> {
    /// A row per maximal clique of sessions that overlap on a lane.
    pub(super) fn overlaps(&mut self) {
        let model = self.model;
        for lane in 0..model.lanes {
            let on: Vec<usize> =
                (0..model.sessions.len()).filter(|&id| model.sessions[id].lane == lane).collect();
            for at in cliques(model, on.iter().copied()) {
                let earliest = at.saturating_sub(model.longest);
                let first = on.partition_point(|&id| model.sessions[id].start < earliest);
                let near = on[first..].iter().take_while(|id| model.sessions[**id].start <= at);
                let terms = near.filter(|id| model.sessions[**id].end > at).map(|&id| (id, 1));
                self.row(Row { terms: terms.collect(), limit: 1 }, None);
            }
        }
    }

    /// Rows of the reserved time in each day.
    pub(super) fn days(&mut self) {
        let model = self.model;
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

    /// Rows and family of the starts in sliding windows.
    pub(super) fn starts(&mut self) {
        let model = self.model;
        let Some((count, window)) = model.count else { return };
        let family = Starts { sessions: &model.sessions, count, window };
        let all: Vec<usize> = (0..model.sessions.len()).collect();
        for from in window_starts(model, &all) {
            self.row(family.row(from), None);
        }
        self.family(Box::new(family), Because::NotWorth);
    }

    /// Rows and family of the reserved time in sliding windows.
    pub(super) fn heat(&mut self) {
        let model = self.model;
        let Some(thermal) = self.problem.demands.thermal else { return };
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
        self.family(Box::new(family), Because::Thermal);
    }

    /// Rows and family of the memory.
    pub(super) fn memory(&mut self) {
        let (problem, facts) = (self.problem, self.facts);
        let Some(data) = &problem.demands.data else { return };
        let family = Memory { produces: &facts.produces, data };
        // Stretches from the end of a contact to the start of one of the next few.
        let mut ends = vec![problem.span.0.tai_ns()];
        ends.extend(data.contacts.iter().map(|it| it.until.tai_ns()));
        let mut starts: Vec<i64> = data.contacts.iter().map(|it| it.from.tai_ns()).collect();
        starts.push(problem.span.1.tai_ns());
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
        self.family(Box::new(family), Because::Memory);
    }

    /// Tangents and families of one bound on scan angles, per target and telescope.
    pub(super) fn cones(&mut self, diversity: &Diversity) {
        for ((target, telescope), members) in cone::members(self.model, self.facts, diversity) {
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
            self.family(Box::new(cone), Because::ScanAngle { n: diversity.n });
        }
    }
}
