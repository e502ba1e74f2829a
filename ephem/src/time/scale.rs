//! Time scales that texts are on.

/// A time scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Barycentric dynamical time, as SPICE's ephemeris time.
    Tdb,
    /// International atomic time.
    Tai,
    /// Terrestrial time, TAI + 32.184 s.
    Tt,
    /// Coordinated universal time, with leap seconds.
    Utc,
}

impl Scale {
    /// The scale called `TDB`, `TAI`, `TT` or `UTC`, in letters of any case.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        [("TDB", Self::Tdb), ("TAI", Self::Tai), ("TT", Self::Tt), ("UTC", Self::Utc)]
            .into_iter()
            .find_map(|(known, scale)| known.eq_ignore_ascii_case(name).then_some(scale))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_known_in_any_case() {
        assert_eq!(Scale::from_name("tdb"), Some(Scale::Tdb));
        assert_eq!(Scale::from_name("Utc"), Some(Scale::Utc));
        assert_eq!((Scale::from_name("GPS"), Scale::from_name("")), (None, None));
    }
}
