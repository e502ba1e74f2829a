//! Differences within a pair of detectors without a plate, one along, one across `psi_pol`.
//!
//! `d = (d_T - d_B) / 2`, in which I cancels but for what differs. T has half of the difference, B
//! half of it with the other sign, so that the polarisation has none to first order.
//!
//! Gain, and bandpass on a sky of what the bands see differently: `S_00 = g I / 2`. Pointing:
//! `S_(-1,0) = -(rho/4) i e^(i chi) eth I`. Ellipticity: `S_(-2,0) = -(D/16) e^(-2i major) eth^2 I`,
//! D the difference of `sx^2 - sy^2` \[Hoang2017\] \[`McCallum2021`\].

use super::super::signal::{Effect, SkyField, Term};
use super::{Ellipticity, Pointing};

/// T's gain less B's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairGain {
    /// Over their mean.
    pub g: f64,
}

impl Effect for PairGain {
    fn terms(&self) -> Vec<Term> {
        vec![Term { n: 0, m: 0, field: SkyField::I, factor: (0.25 * self.g).into() }]
    }
}

/// T's line of sight less B's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairPointing(pub Pointing);

impl Effect for PairPointing {
    fn terms(&self) -> Vec<Term> {
        halved(self.0.terms())
    }
}

/// T's ellipticity less B's, about the same axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairEllipticity(pub Ellipticity);

impl Effect for PairEllipticity {
    fn terms(&self) -> Vec<Term> {
        halved(self.0.terms())
    }
}

/// Half of what acts on the temperature.
fn halved(terms: Vec<Term>) -> Vec<Term> {
    let of_temperature = |term: &Term| matches!(term.field, SkyField::Temperature(_));
    let halved = |term: Term| Term { factor: term.factor * 0.5, ..term };
    terms.into_iter().filter(of_temperature).map(halved).collect()
}
