//! Effects by name, with their parameters: what a person can ask for.
//!
//! Angles are radians, times seconds, sizes of beams square radians.

use super::super::orientation::Polarimeter;
use super::super::signal::Effect;
use super::{
    Ellipticity, Gain, HwpIp, HwpTwoF, IpForm, PairEllipticity, PairGain, PairPointing, Pointing,
    PolarisationAngle, Sidelobe, TimeConstant, Wedge,
};
use thiserror::Error;

/// What a parameter is given in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// A number.
    Number,
    /// An angle, in radians.
    Angle,
    /// A time, in seconds.
    Time,
}

/// A parameter: its name, what it is given in, its value where it is not.
pub type Parameter = (&'static str, Measure, Option<f64>);

/// What acts on which sky.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActsOn {
    /// The solar dipole, far larger than the rest.
    Dipole,
    /// The CMB's anisotropies.
    Cmb,
}

/// What the survey has to do with effects of the detector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motions {
    /// Rate of the plate, its sign included.
    pub plate_rad_s: f64,
    /// Speed of the line of sight along the scan.
    pub sweep_rad_s: f64,
}

type Maker = fn(&[f64], &Motions) -> Box<dyn Effect>;

/// An effect that has a name.
#[derive(Debug, Clone, Copy)]
pub struct EffectKind {
    /// Its name.
    pub name: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// The sky that it is asked for by default.
    pub acts_on: ActsOn,
    /// What measures it.
    pub polarimeter: Polarimeter,
    make: Maker,
}

/// Why there is no such effect.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum NameError {
    /// No effect has the name.
    #[error("no effect {0}")]
    Effect(String),
    /// It has no such parameter.
    #[error("no parameter {0}")]
    Parameter(String),
    /// A parameter is missing.
    #[error("{0} is missing")]
    Missing(&'static str),
    /// A parameter that is not a number.
    #[error("{0} is not finite")]
    Value(&'static str),
}

const PHASE: Parameter = ("phase", Measure::Angle, Some(0.0));
const CHI: Parameter = ("chi", Measure::Angle, Some(0.0));
const RHO: Parameter = ("rho", Measure::Angle, None);

const fn kind(
    name: &'static str,
    (acts_on, polarimeter): (ActsOn, Polarimeter),
    parameters: &'static [Parameter],
    make: Maker,
) -> EffectKind {
    EffectKind { name, parameters, acts_on, polarimeter, make }
}

const ON_CMB: (ActsOn, Polarimeter) = (ActsOn::Cmb, Polarimeter::PLATE);
const ON_DIPOLE: (ActsOn, Polarimeter) = (ActsOn::Dipole, Polarimeter::PLATE);

fn pointing(of: &[f64]) -> Pointing {
    Pointing { rho_rad: of[0], chi_rad: of[1] }
}

fn ellipticity(of: &[f64]) -> Ellipticity {
    // FWHM along both axes: sigma^2 = FWHM^2 / (8 ln 2)
    let difference_rad2 = (of[0] * of[0] - of[1] * of[1]) / (8.0 * std::f64::consts::LN_2);
    Ellipticity { difference_rad2, major_rad: of[2] }
}

const AXES: &[Parameter] = &[
    ("major", Measure::Angle, None),
    ("minor", Measure::Angle, None),
    ("angle", Measure::Angle, Some(0.0)),
];

/// All effects.
pub const KINDS: &[EffectKind] = &[
    kind("pointing", ON_CMB, &[RHO, CHI], |of, _| Box::new(pointing(of))),
    kind("wedge", ON_CMB, &[RHO, CHI], |of, _| Box::new(Wedge { rho_rad: of[0], chi_rad: of[1] })),
    kind("hwp_ip", ON_DIPOLE, &[("eps", Measure::Number, None), PHASE], |of, _| {
        Box::new(HwpIp { epsilon: of[0], phi_qi_rad: of[1], form: IpForm::Physical })
    }),
    kind("hwp_ip_printed", ON_DIPOLE, &[("eps", Measure::Number, None), PHASE], |of, _| {
        Box::new(HwpIp { epsilon: of[0], phi_qi_rad: of[1], form: IpForm::Literal })
    }),
    kind("hwp_2f", ON_DIPOLE, &[("eps", Measure::Number, None), PHASE], |of, _| {
        Box::new(HwpTwoF { epsilon: of[0], phase_rad: of[1] })
    }),
    kind("ellipticity", ON_CMB, AXES, |of, _| Box::new(ellipticity(of))),
    kind("angle", ON_CMB, &[("delta", Measure::Angle, None)], |of, _| {
        Box::new(PolarisationAngle { delta_rad: of[0] })
    }),
    kind("gain", ON_CMB, &[("g", Measure::Number, None)], |of, _| Box::new(Gain { g: of[0] })),
    kind("time_constant", ON_CMB, &[("tau", Measure::Time, None)], |of, motions| {
        let Motions { plate_rad_s, sweep_rad_s } = *motions;
        Box::new(TimeConstant { tau_s: of[0], plate_rad_s, sweep_rad_s })
    }),
    kind("sidelobe", ON_DIPOLE, SIDELOBE, |of, _| Box::new(sidelobe(of, false))),
    kind("sidelobe_4f", ON_DIPOLE, SIDELOBE, |of, _| Box::new(sidelobe(of, true))),
    kind(
        "pair_gain",
        (ActsOn::Dipole, Polarimeter::PAIR),
        &[("g", Measure::Number, None)],
        |of, _| Box::new(PairGain { g: of[0] }),
    ),
    kind("pair_pointing", (ActsOn::Cmb, Polarimeter::PAIR), &[RHO, CHI], |of, _| {
        Box::new(PairPointing(pointing(of)))
    }),
    kind("pair_ellipticity", (ActsOn::Cmb, Polarimeter::PAIR), AXES, |of, _| {
        Box::new(PairEllipticity(ellipticity(of)))
    }),
];

const SIDELOBE: &[Parameter] = &[
    ("gain", Measure::Number, None),
    ("polar", Measure::Angle, None),
    ("azimuth", Measure::Angle, Some(0.0)),
];

fn sidelobe(of: &[f64], modulated: bool) -> Sidelobe {
    Sidelobe { gain: of[0], polar_rad: of[1], azimuth_rad: of[2], modulated }
}

impl EffectKind {
    /// The effect of a name.
    ///
    /// # Errors
    /// [`NameError::Effect`] where none has it.
    pub fn named(name: &str) -> Result<&'static Self, NameError> {
        let found = KINDS.iter().find(|kind| kind.name == name);
        found.ok_or_else(|| NameError::Effect(name.to_owned()))
    }

    /// Amplitude and phase, where the effect is instrumental polarisation of the plate, which has a
    /// closed form on a dipole ([`super::super::DipoleLeak`]).
    #[must_use]
    pub fn leak(&self, given: &[(String, f64)]) -> Option<[f64; 2]> {
        let value = |&(name, _, default): &Parameter| {
            given.iter().rev().find(|(it, _)| it == name).map(|(_, value)| *value).or(default)
        };
        let [epsilon, phase] = self.parameters else { return None };
        ["hwp_ip", "hwp_ip_printed"]
            .contains(&self.name)
            .then(|| Some([value(epsilon)?, value(phase)?]))?
    }

    /// With parameters by name.
    ///
    /// # Errors
    /// [`NameError`] for parameters that are unknown, missing or not finite.
    pub fn effect(
        &self,
        given: &[(String, f64)],
        motions: &Motions,
    ) -> Result<Box<dyn Effect>, NameError> {
        let known = |name: &str| self.parameters.iter().any(|parameter| parameter.0 == name);
        if let Some((name, _)) = given.iter().find(|(name, _)| !known(name)) {
            return Err(NameError::Parameter(name.clone()));
        }
        let value = |&(name, _, default): &Parameter| {
            let found = given.iter().rev().find(|(it, _)| it == name).map(|(_, value)| *value);
            let value = found.or(default).ok_or(NameError::Missing(name))?;
            if value.is_finite() { Ok(value) } else { Err(NameError::Value(name)) }
        };
        let values: Vec<f64> = self.parameters.iter().map(value).collect::<Result<_, _>>()?;
        Ok((self.make)(&values, motions))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOTIONS: Motions = Motions { plate_rad_s: 6.0, sweep_rad_s: 0.004 };

    #[test]
    fn every_effect_has_terms_with_its_parameters() {
        for kind in KINDS {
            let given: Vec<(String, f64)> =
                kind.parameters.iter().map(|it| (it.0.to_owned(), 0.25)).collect();
            let terms = kind.effect(&given, &MOTIONS).unwrap().terms();
            assert!(!terms.is_empty(), "{}", kind.name);
            if kind.polarimeter.pair {
                assert!(terms.iter().all(|term| term.m == 0), "{}", kind.name);
            }
        }
    }

    #[test]
    fn instrumental_polarisation_has_a_closed_form() {
        let leak = |name: &str| {
            let given = [("eps".to_owned(), 1e-5), ("phase".to_owned(), 0.4)];
            EffectKind::named(name).unwrap().leak(&given)
        };
        assert_eq!(leak("hwp_ip"), Some([1e-5, 0.4]));
        assert_eq!(leak("hwp_ip_printed"), Some([1e-5, 0.4]));
        assert_eq!((leak("hwp_2f"), leak("pointing")), (None, None));
    }

    #[test]
    fn names_that_are_wrong_are_told() {
        let refused = EffectKind::named("wobble").unwrap_err();
        assert_eq!(refused, NameError::Effect("wobble".to_owned()));
        let pointing = EffectKind::named("pointing").unwrap();
        let make = |given: &[(&str, f64)]| {
            let given: Vec<(String, f64)> =
                given.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
            pointing.effect(&given, &MOTIONS).map(|it| it.terms())
        };
        assert_eq!(make(&[]), Err(NameError::Missing("rho")));
        assert_eq!(make(&[("rho", f64::NAN)]), Err(NameError::Value("rho")));
        assert_eq!(make(&[("eps", 1.0)]), Err(NameError::Parameter("eps".to_owned())));
        let expected = Pointing { rho_rad: 0.1, chi_rad: 0.0 }.terms();
        assert_eq!(make(&[("rho", 0.1)]), Ok(expected));
    }
}
