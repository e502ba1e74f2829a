//! Names of inertial frames.

/// Inertial axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axes {
    /// Those of DE440, the ICRF's.
    Icrf,
    /// The ecliptic of J2000.
    Ecliptic,
}

impl Axes {
    /// The axes of an inertial frame, its name in letters of any case; `None` for all other frames.
    ///
    /// ICRF are `ICRF`, `GCRF`, their realisations 1 to 3, such as `ICRF3`, which agree to 0.1 mas,
    /// and `EME2000` and `J2000`, whose bias of 23 mas at most is not applied. The ecliptic is
    /// SPICE's `ECLIPJ2000`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let name = name.to_ascii_uppercase();
        match name.strip_suffix(['1', '2', '3']).unwrap_or(&name) {
            "ICRF" | "GCRF" => Some(Self::Icrf),
            _ => match name.as_str() {
                "EME2000" | "J2000" => Some(Self::Icrf),
                "ECLIPJ2000" => Some(Self::Ecliptic),
                _ => None,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inertial_frames_are_known_in_any_case() {
        for name in ["ICRF", "icrf", "Gcrf", "eme2000", "J2000", "icrf2", "ICRF3", "GCRF1"] {
            assert_eq!(Axes::from_name(name), Some(Axes::Icrf), "{name}");
        }
        assert_eq!(Axes::from_name("eclipj2000"), Some(Axes::Ecliptic));
        for name in ["", "TOD", "ITRF2000", "ICRF4", "ICRF33", "SC_BODY_1", "EME20001", "1"] {
            assert_eq!(Axes::from_name(name), None, "{name}");
        }
    }
}
