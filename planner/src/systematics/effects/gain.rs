//! Constant error of the gain: everything is too large by the same share.
//!
//! `d = g (I + Re[P z*])`: `S_00 = g I`, `S_(-2,4) = -g P / 2`. It scales the map; I does not leak.

use super::super::signal::{Effect, SkyField, Term};

/// An error of the gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// True gain less the assumed one, over the latter.
    pub g: f64,
}

impl Effect for Gain {
    fn terms(&self) -> Vec<Term> {
        let half = (0.5 * self.g).into();
        vec![
            Term { n: 0, m: 0, field: SkyField::I, factor: half },
            Term { n: -2, m: 4, field: SkyField::P, factor: -half },
        ]
    }
}
