//! The mean resultant of scan angles stays short: rows tangent to a second-order cone.
//!
//! Method: for integers p, q and L at least their norm, `p C + q S <= L R` follows from
//! `|(C, S)| <= R`. Where rounding leaves a set uncut, the set itself is excluded.

use super::facts::Facts;
use crate::program::number::{f64_from_i128, i64_from_f64, i64_from_usize};
use crate::program::{Family, Row};
use crate::schedule::demands::Diversity;
use crate::schedule::model::Model;
use std::collections::BTreeMap;

/// Length of the direction of a tangent.
pub(crate) const DIRECTION: f64 = 1_048_576.0;

/// Session, c, s, r.
pub(super) type Member = (usize, i64, i64, i64);

/// `|(sum c, sum s)| <= sum r` over some sessions, in milliseconds.
#[derive(Debug)]
pub(super) struct Cone {
    pub(super) members: Vec<Member>,
}

impl Cone {
    /// The tangent in a direction.
    pub(super) fn tangent(&self, c: f64, s: f64) -> Row {
        let norm = c.hypot(s).max(f64::MIN_POSITIVE);
        let (p, q) = (
            i64_from_f64((c / norm * DIRECTION).round()),
            i64_from_f64((s / norm * DIRECTION).round()),
        );
        // The least integer whose square is at least p^2 + q^2.
        let square = i128::from(p) * i128::from(p) + i128::from(q) * i128::from(q);
        let mut length = i64_from_f64(f64_from_i128(square).sqrt()).saturating_sub(1).max(0);
        while i128::from(length) * i128::from(length) < square {
            length += 1;
        }
        let terms = self.members.iter().map(|&(id, c, s, r)| (id, p * c + q * s - length * r));
        Row { terms: terms.collect(), limit: 0 }
    }

    fn sums(&self, taken: &[bool]) -> (i128, i128, i128) {
        let standing = self.members.iter().filter(|it| taken[it.0]);
        standing.fold((0, 0, 0), |sum, &(_, c, s, r)| {
            (sum.0 + i128::from(c), sum.1 + i128::from(s), sum.2 + i128::from(r))
        })
    }
}

impl Family for Cone {
    fn broken(&self, taken: &[bool]) -> Vec<Row> {
        let (c, s, r) = self.sums(taken);
        if c * c + s * s <= r * r {
            return Vec::new();
        }
        let tangent = self.tangent(f64_from_i128(c), f64_from_i128(s));
        let used: i128 =
            tangent.terms.iter().filter(|it| taken[it.0]).map(|it| i128::from(it.1)).sum();
        if used > 0 {
            return vec![tangent];
        }
        let sign = |id: usize| if taken[id] { 1 } else { -1 };
        let terms: Vec<(usize, i64)> = self.members.iter().map(|it| (it.0, sign(it.0))).collect();
        let standing = terms.iter().filter(|it| it.1 > 0).count();
        vec![Row { terms, limit: i64_from_usize(standing) - 1 }]
    }

    fn separate(&self, shares: &[f64]) -> Vec<Row> {
        let mut sums = [0.0; 3];
        for &(id, c, s, r) in &self.members {
            for (sum, of) in sums.iter_mut().zip([c, s, r]) {
                *sum += shares[id] * f64_from_i128(i128::from(of));
            }
        }
        let over = sums[0].hypot(sums[1]) > sums[2] * (1.0 + 1e-4) + 1.0;
        if over { vec![self.tangent(sums[0], sums[1])] } else { Vec::new() }
    }
}

/// Members of each cone, by target and telescope.
pub(crate) fn members(
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
