//! States from packets, SPK types 18 and 19, which ESA's missions use.
//!
//! Subtype 0 has a state and its derivative apart, each interpolated by Hermite; 1 has states for
//! Lagrange; 2 has states whose velocity is the position's derivative. Type 19 is pieces of these, one
//! after the other.
//!
//! Method: NAIF's "SPK Required Reading"; at the ends of a piece windows are cut to what is there.
//!
//! Limits: none of its own.

use crate::interpolation::{Method, PosVel, StateSeries};
use nalgebra::Vector3;

/// Packets of one kind.
#[derive(Debug, Clone)]
pub(super) struct Packets {
    states: StateSeries,
    /// Velocities and their derivatives, where they are interpolated apart.
    velocities: Option<StateSeries>,
}

impl Packets {
    /// Packets at rising times.
    pub(super) fn new(
        subtype: usize,
        times_s: &[f64],
        packets: &[f64],
        window: usize,
    ) -> Option<Self> {
        let vector = |it: &[f64]| match *it {
            [x, y, z] => Vector3::new(x, y, z),
            _ => Vector3::repeat(f64::NAN),
        };
        let width = if subtype == 0 { 12 } else { 6 };
        let pairs = |first: usize| -> Vec<PosVel> {
            let pair = |it: &[f64]| {
                let part = |from: usize| vector(it.get(from..from + 3).unwrap_or_default());
                (part(first), part(first + 3))
            };
            packets.chunks_exact(width).map(pair).collect()
        };
        let method = if subtype == 1 { Method::Lagrange } else { Method::Hermite };
        let series = |states| {
            let series = StateSeries::new(times_s.to_vec(), states, method, window);
            series.map(StateSeries::cut_at_ends)
        };
        let velocities = if subtype == 0 { Some(series(pairs(6))?) } else { None };
        Some(Self { states: series(pairs(0))?, velocities })
    }

    fn at(&self, at_s: f64) -> PosVel {
        let (position, velocity) = self.states.at(at_s);
        match &self.velocities {
            Some(velocities) => (position, velocities.at(at_s).0),
            None => (position, velocity),
        }
    }
}

/// Packets one after the other.
#[derive(Debug, Clone)]
pub(super) struct Pieces {
    /// Bounds of the pieces, one more than there are pieces.
    bounds_s: Vec<f64>,
    packets: Vec<Packets>,
    /// At a bound the later piece counts.
    is_later: bool,
}

impl Pieces {
    /// A single piece.
    pub(super) fn one(packets: Packets) -> Self {
        Self { bounds_s: Vec::new(), packets: vec![packets], is_later: true }
    }

    /// Pieces between rising bounds.
    pub(super) const fn new(bounds_s: Vec<f64>, packets: Vec<Packets>, is_later: bool) -> Self {
        Self { bounds_s, packets, is_later }
    }

    /// The state at a time.
    pub(super) fn at(&self, at_s: f64) -> PosVel {
        let is_past = |bound: &f64| if self.is_later { *bound <= at_s } else { *bound < at_s };
        let index = self.bounds_s.partition_point(is_past).saturating_sub(1);
        let piece = self.packets.get(index.min(self.packets.len().saturating_sub(1)));
        let nowhere = (Vector3::repeat(f64::NAN), Vector3::repeat(f64::NAN));
        piece.map_or(nowhere, |piece| piece.at(at_s))
    }

    /// Times at which the interpolation bends.
    pub(super) fn joints_s(&self) -> Vec<f64> {
        let mut joints = self.bounds_s.clone();
        for piece in &self.packets {
            joints.extend(piece.states.joints_s());
        }
        joints.sort_by(f64::total_cmp);
        joints.dedup();
        joints
    }
}
