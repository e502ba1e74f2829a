//! The sessions of a plan: when, of what, through which telescope, and the passes that they hold.
//!
//! Crossing, scan-beam and plate angles and impact parameters are those at closest approach, in
//! radians; see `docs/conventions.md`.

use crate::opportunities::{Found, Opportunity};
use crate::world::{TableFault, World, body};
use crate::worth::strength::Strength;
use crate::worth::{Scene, WorthError, hwp_coverage, impact_rad, strength};
use onboard_core::attitude::sweep;
use onboard_core::hwp::hwp_phase;
use onboard_core::time::{Duration, Instant};
use onboard_core::transit::Transit;

/// One session.
#[derive(Debug, Clone, PartialEq)]
pub struct Session {
    /// Telescope, target and number of the opportunity.
    pub id: String,
    /// Target's name.
    pub target: String,
    /// Telescope's name.
    pub telescope: String,
    /// Start, setup included.
    pub start: Instant,
    /// End, cooldown included.
    pub end: Instant,
    /// Time with the target in view.
    pub dwell: Duration,
    /// What it adds to the objective.
    pub value: f64,
    /// The target's strength in the telescope's beam.
    pub strength: Strength,
    /// How evenly its passes cover the half-wave plate's phases; none without a plate.
    pub hwp_coverage: Option<f64>,
    /// Its passes by entry.
    pub passes: Vec<SessionPass>,
}

/// One pass of a session.
#[derive(Debug, Clone, PartialEq)]
pub struct SessionPass {
    /// Detector's name, or `-` for a field of view.
    pub detector: String,
    /// Entry, exit, closest approach.
    pub transit: Transit,
    /// Crossing angle.
    pub crossing_angle_rad: f64,
    /// Scan-beam angle.
    pub scan_beam_angle_rad: f64,
    /// Impact parameter.
    pub impact_rad: f64,
    /// Angle of the half-wave plate, where there is one.
    pub hwp_rad: Option<f64>,
}

/// The id of an opportunity's session: telescope, target and number.
#[must_use]
pub fn session_id(world: &World, it: &Opportunity) -> String {
    let telescope = &world.mission.telescopes[it.telescope].name;
    format!("{telescope}-{}-{:06}", world.targets[it.target].name(), it.number)
}

impl Scene<'_> {
    /// The session of an opportunity over a reserved time, and what it adds to the objective.
    pub(super) fn session(
        &self,
        opportunity: &Opportunity,
        (start, end): (Instant, Instant),
        value: f64,
    ) -> Result<Session, WorthError> {
        let world = self.world;
        let passes = self.offers.opportunities.passes(opportunity);
        let found = || passes.iter().map(|&pass| &self.offers.found[pass]);
        let line = found().next().map(|it| &self.offers.lines[it.line]);
        Ok(Session {
            id: session_id(world, opportunity),
            target: world.targets[opportunity.target].name().to_owned(),
            telescope: world.mission.telescopes[opportunity.telescope].name.clone(),
            start,
            end,
            dwell: opportunity.dwell,
            value,
            strength: strength(world, opportunity)?,
            hwp_coverage: line.and_then(|line| hwp_coverage(world, line, found())),
            passes: found().map(|it| self.pass(it)).collect::<Result<_, _>>()?,
        })
    }

    fn pass(&self, found: &Found) -> Result<SessionPass, TableFault> {
        let (line, transit) = (&self.offers.lines[found.line], &found.transit);
        let at = transit.closest;
        let seen = sweep(&self.world.scan, &self.sun, line.rotation, at)?;
        let target = body(self.table, self.world.targets[found.target].body())?;
        let target = target.state(at)?.direction;
        Ok(SessionPass {
            detector: line.detector_name.clone(),
            transit: *transit,
            crossing_angle_rad: seen.crossing_angle_rad,
            scan_beam_angle_rad: seen.scan_beam_angle_rad,
            impact_rad: impact_rad(&seen, target),
            hwp_rad: line.hwp.map(|plate| hwp_phase(&self.world.scan, plate, at).radians()),
        })
    }
}
