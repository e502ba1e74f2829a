//! What the reading of a mission found wrong, and the nearest legal key of each unknown one; the
//! names nearest to one that is not there.
//!
//! Method: Jaro-Winkler similarity of the last segment, which favours a common start (`fwhm_deg` for
//! `fwhm_arcmin`); a key of another table counts 0.85 of it.
//!
//! Limits: legal keys are those that the reading asked for.

use crate::fault::{Fault, Problem};
use crate::reading::document::Place;

/// What the reading of a mission found.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    pub(crate) faults: Vec<Fault>,
    /// Every legal key met.
    pub(crate) known: Vec<String>,
    /// Keys that nobody asked for.
    pub(crate) unknown: Vec<(Place, String)>,
}

impl Findings {
    /// All faults, by line; unknown keys with the nearest of the known ones.
    pub(crate) fn into_faults(mut self) -> Vec<Fault> {
        for (place, key) in std::mem::take(&mut self.unknown) {
            let nearest = nearest(&key, &self.known).to_owned();
            self.faults.push(place.fault(Problem::UnknownKey { key, nearest }));
        }
        self.faults.sort_by_key(|fault| fault.line);
        self.faults
    }
}

/// The legal key nearest to an unknown one; the first of equals.
fn nearest<'k>(unknown: &str, known: &'k [String]) -> &'k str {
    let (parent, last) = split(unknown);
    let similarity = |key: &str| {
        let (known_parent, known_last) = split(key);
        let weight = if known_parent == parent { 1.0 } else { 0.85 };
        weight * strsim::jaro_winkler(last, known_last)
    };
    let by_similarity = |a: &&String, b: &&String| similarity(a).total_cmp(&similarity(b));
    known.iter().rev().max_by(by_similarity).map_or("", String::as_str)
}

/// A dotted path's table and last segment.
fn split(path: &str) -> (&str, &str) {
    path.rsplit_once('.').unwrap_or(("", path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_key_is_a_sibling_or_the_same_key_elsewhere() {
        let known = [
            "base",
            "scan",
            "scan.alpha_deg",
            "scan.beta_deg",
            "orbit",
            "orbit.sun",
            "orbit.aberration",
            "telescope",
            "telescope.A.name",
            "telescope.A.fwhm_arcmin",
        ]
        .map(str::to_owned);
        for (unknown, expected) in [
            ("scan.alpa_deg", "scan.alpha_deg"),
            ("scan.alpha", "scan.alpha_deg"),
            ("orbit.alpha_deg", "scan.alpha_deg"),
            ("scna", "scan"),
            ("beta_deg", "scan.beta_deg"),
            ("telescopes", "telescope"),
            ("telescope.A.fwhm_deg", "telescope.A.fwhm_arcmin"),
        ] {
            assert_eq!(nearest(unknown, &known), expected, "{unknown}");
        }
    }
}
