//! What do the passes of a mission, or of a plan's sessions, teach: sums over all of them.
//!
//! Method: passes come from the flight core's search, one circle per direction, [`REACH`](super::REACH)
//! full widths of the widest beam there; a beam takes those within its own reach. Each pass is a straight chord
//! ([`Crossing`]) and adds its matrix and its times in annuli to the windows that hold its closest
//! approach. Nothing of a pass is kept, so that thousands of detectors fit.
//!
//! Limits: those of the chord, of the noise and of the sources' strengths; a pass that is clipped by the
//! mission's ends counts whole.

use super::beam_map::BeamMap;
use super::error::InformationError;
use super::fisher::Fisher;
use super::noise::{SHORT, antenna_per_thermodynamic, share_left};
use super::pass::{Crossing, Modulation, SIGMA_PER_FWHM};
use super::profile::Profile;
use super::sight::Look;
use super::signal::{Distances, strength};
use super::window::Windows;
use crate::opportunities::{OffersError, SightLine};
use crate::progress::Progress;
use crate::visits::transits;
use crate::world::{TableFault, World, body};
use crate::worth::impact_rad;
use crate::worth::strength::Beam;
use onboard_core::attitude::{Sweep, sweep};
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::hwp::hwp_phase;
use onboard_core::time::Instant;
use onboard_core::transit::{Channel, Transit};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What passes of one target through one line of sight teach in one window.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Lesson {
    /// The information.
    pub fisher: Fisher,
    /// What is learned of the response at a distance from the centre.
    pub profile: Profile,
    /// Passes.
    pub passes: u32,
    /// Of them, those that are not short beside the noise's knee.
    pub long: u32,
}

impl Lesson {
    /// Takes in what others teach.
    pub fn add(&mut self, other: &Self) {
        self.fisher.add(&other.fisher);
        self.profile.add(&other.profile);
        self.passes += other.passes;
        self.long += other.long;
    }
}

/// When a target is looked at through a telescope, both by index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Session {
    /// The target.
    pub target: usize,
    /// The telescope.
    pub telescope: usize,
    /// First entry.
    pub from: Instant,
    /// Last exit.
    pub until: Instant,
}

/// What was left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Left {
    /// Who looks, by index.
    pub look: usize,
    /// The target whose strength in the band is not known; `None` where the receiver's noise is not.
    pub target: Option<usize>,
}

/// What is asked.
#[derive(Debug, Clone, Copy)]
pub struct Question<'q> {
    /// Who looks.
    pub looks: &'q [Look],
    /// Over which windows.
    pub windows: &'q Windows,
    /// Only in these sessions; `None` takes all passes.
    pub sessions: Option<&'q [Session]>,
}

/// What passes teach, by look, target and window.
#[derive(Debug, Clone)]
pub struct Forecast {
    targets: usize,
    windows: usize,
    lessons: Vec<Lesson>,
    /// What was left out.
    pub left: Vec<Left>,
}

impl Forecast {
    /// What a target teaches a look in a window.
    #[must_use]
    pub fn lesson(&self, look: usize, target: usize, window: usize) -> &Lesson {
        &self.lessons[(look * self.targets + target) * self.windows + window]
    }

    /// What all targets teach a look in a window.
    #[must_use]
    pub fn together(&self, look: usize, window: usize) -> Lesson {
        let mut sum = Lesson::default();
        for target in 0..self.targets {
            sum.add(self.lesson(look, target, window));
        }
        sum
    }
}

/// A receiver's numbers, as floats.
#[derive(Debug, Clone, Copy)]
struct Numbers {
    beam: Beam,
    noise_k_rts: f64,
    knee_hz: f64,
}

impl Numbers {
    fn of(look: &Look) -> Option<Self> {
        let (frequency_ghz, bandwidth_ghz) = look.band_ghz()?;
        let net_uk_rts = look.receiver.net_uk_rts.as_ref()?.to_f64();
        let ratio = antenna_per_thermodynamic(frequency_ghz, bandwidth_ghz);
        Some(Self {
            beam: Beam { fwhm_rad: look.receiver.fwhm_rad()?, frequency_ghz: Some(frequency_ghz) },
            noise_k_rts: 1e-6 * net_uk_rts * ratio,
            knee_hz: look.receiver.knee_mhz.as_ref().map_or(0.0, |it| 1e-3 * it.to_f64()),
        })
    }
}

/// One search: a target and the looks that see the same.
struct Pair<'p> {
    target: usize,
    looks: &'p [usize],
}

/// What passes teach every look of every target in every window.
///
/// # Errors
/// [`InformationError`] where nothing can be told of any look, or the tables do not serve their span.
pub fn forecast(
    world: &World,
    table: EphemerisTable<'_>,
    question: &Question<'_>,
    progress: &dyn Progress,
) -> Result<Forecast, InformationError> {
    let numbers: Vec<Option<Numbers>> = question.looks.iter().map(Numbers::of).collect();
    let distances = distances(world)?;
    let (left, known) = known(world, question, &numbers, &distances)?;
    let mut alike: BTreeMap<([u64; 3], usize), Vec<usize>> = BTreeMap::new();
    for target in 0..world.targets.len() {
        for look in 0..question.looks.len() {
            if known[look * world.targets.len() + target] {
                let centre = question.looks[look].line.field.centre().xyz().map(f64::to_bits);
                let key = (centre, target);
                alike.entry(key).or_default().push(look);
            }
        }
    }
    let pairs: Vec<Pair<'_>> =
        alike.iter().map(|((_, target), looks)| Pair { target: *target, looks }).collect();
    progress.begin("passes", u64::try_from(pairs.len()).unwrap_or(u64::MAX));
    let (targets, windows) = (world.targets.len(), question.windows.count());
    let found: Vec<Vec<Lesson>> = pairs
        .par_iter()
        .map(|pair| {
            if progress.stopped() {
                return Err(InformationError::Stopped);
            }
            let scene = Scene { world, table, question, numbers: &numbers };
            let lessons = scene.lessons(pair, &distances[pair.target]);
            progress.advance(1);
            lessons
        })
        .collect::<Result<_, InformationError>>()?;
    let mut lessons = vec![Lesson::default(); question.looks.len() * targets * windows];
    for (pair, found) in pairs.iter().zip(found) {
        for (look, of_windows) in pair.looks.iter().zip(found.chunks(windows.max(1))) {
            let first = (look * targets + pair.target) * windows;
            lessons[first..first + windows].copy_from_slice(of_windows);
        }
    }
    Ok(Forecast { targets, windows, lessons, left })
}

/// What is left out, and of which look and target there are numbers.
fn known(
    world: &World,
    question: &Question<'_>,
    numbers: &[Option<Numbers>],
    distances: &[Distances],
) -> Result<(Vec<Left>, Vec<bool>), InformationError> {
    let targets = world.targets.len();
    let mut left = Vec::new();
    let mut told = vec![false; question.looks.len() * targets];
    for (look, of) in numbers.iter().enumerate() {
        let Some(of) = of else {
            left.push(Left { look, target: None });
            continue;
        };
        for (target, source) in world.targets.iter().enumerate() {
            let km = distances[target].at(world.start);
            if strength(world, source, of.beam, km).antenna_k.is_some() {
                told[look * targets + target] = true;
            } else {
                left.push(Left { look, target: Some(target) });
            }
        }
    }
    if let (false, Some(first)) = (told.contains(&true), left.first()) {
        let receiver = question.looks[first.look].key();
        let noise = question.looks[first.look].receiver.net_uk_rts.is_some();
        return Err(match first.target {
            None => {
                let key = if noise { "frequency_ghz" } else { "net_uk_rts" };
                InformationError::Unknown { receiver, key }
            }
            Some(target) => {
                let target = world.targets[target].name().to_owned();
                InformationError::NoSignal { target, receiver }
            }
        });
    }
    Ok((left, told))
}

/// What a search happens in.
struct Scene<'s> {
    world: &'s World,
    table: EphemerisTable<'s>,
    question: &'s Question<'s>,
    numbers: &'s [Option<Numbers>],
}

impl Scene<'_> {
    /// The lessons of a pair's looks, one after the other, by window.
    fn lessons(&self, pair: &Pair<'_>, km: &Distances) -> Result<Vec<Lesson>, InformationError> {
        let windows = self.question.windows;
        let mut lessons = vec![Lesson::default(); pair.looks.len() * windows.count()];
        self.each(pair, km, |index, at, crossing, of| {
            let lesson = taught(crossing, of);
            for window in windows.at(at) {
                lessons[index * windows.count() + window].add(&lesson);
            }
        })?;
        Ok(lessons)
    }

    /// Every pass of a pair: the look's place among the pair's, closest approach, the chord.
    fn each(
        &self,
        pair: &Pair<'_>,
        km: &Distances,
        mut take: impl FnMut(usize, Instant, &Crossing, &Numbers),
    ) -> Result<(), InformationError> {
        let world = self.world;
        let sun = world.sun(self.table)?;
        let source = &world.targets[pair.target];
        let place = body(self.table, source.body())?;
        // The widest field holds the passes of all.
        let fields = pair.looks.iter().map(|&look| &self.question.looks[look].line.field);
        let widest = fields.max_by(|a, b| a.reach_rad().total_cmp(&b.reach_rad()));
        let Some(field) = widest else { return Ok(()) };
        let channel = Channel::new(&world.scan, sun, place, field, (world.start, world.end));
        let outside = |error| InformationError::from(TableFault(error));
        let found = transits(channel).map_err(|error| OffersError::Search {
            target: source.name().to_owned(),
            fault: TableFault(error),
        })?;
        for transit in &found {
            let at = transit.closest;
            let direction = place.state(at).map_err(outside)?.direction;
            let distance_km = km.at(at);
            let mut seen: Option<([u64; 4], Sweep)> = None;
            for (index, &look) in pair.looks.iter().enumerate() {
                let Some(of) = &self.numbers[look] else { continue };
                let line = &self.question.looks[look].line;
                let inside = transit.min_separation_rad <= line.field.reach_rad();
                if !inside || !self.in_session(look, pair.target, transit) {
                    continue;
                }
                // Both sides of a pixel look along the same frame.
                let frame = line.rotation.to_xyzw().map(f64::to_bits);
                let sweep = match seen {
                    Some((other, sweep)) if other == frame => sweep,
                    _ => sweep(&world.scan, &sun, line.rotation, at).map_err(outside)?,
                };
                seen = Some((frame, sweep));
                let strength = strength(world, source, of.beam, distance_km);
                let Some(signal_k) = strength.antenna_k else { continue };
                let crossing = Crossing {
                    signal_k,
                    noise_k_rts: of.noise_k_rts,
                    beam_sigma_rad: of.beam.fwhm_rad * SIGMA_PER_FWHM,
                    speed_rad_s: sweep.speed_rad_s,
                    impact_rad: impact_rad(&sweep, direction),
                    scan_beam_angle_rad: sweep.scan_beam_angle_rad,
                    modulation: Modulation {
                        fraction: strength.polarised_k.map_or(0.0, |it| it / signal_k),
                        ..modulation(world, line, &sweep, at)
                    },
                };
                take(index, at, &crossing, of);
            }
        }
        Ok(())
    }

    fn in_session(&self, look: usize, target: usize, transit: &Transit) -> bool {
        let Some(sessions) = self.question.sessions else { return true };
        let telescope = self.question.looks[look].line.telescope;
        sessions.iter().any(|it| {
            it.target == target
                && Some(it.telescope) == telescope
                && (it.from..=it.until).contains(&transit.closest)
        })
    }
}

/// The phase of polarisation at an instant, 2 psi - 4 phi, and its rate.
fn modulation(world: &World, line: &SightLine, sweep: &Sweep, at: Instant) -> Modulation {
    let (phase, rate) = line.hwp.map_or((0.0, 0.0), |plate| {
        (hwp_phase(&world.scan, plate, at).radians(), plate.rate.radians_per_second())
    });
    Modulation {
        fraction: 0.0,
        phase_rad: 2.0 * (sweep.crossing_angle_rad + line.polarisation_rad) - 4.0 * phase,
        rate_rad_s: -4.0 * rate,
    }
}

/// The map of a look's beam by the passes of all targets whose strength is known.
///
/// # Errors
/// As [`forecast`], for this look alone.
pub fn beam_map(
    world: &World,
    table: EphemerisTable<'_>,
    look: &Look,
    sessions: Option<&[Session]>,
) -> Result<BeamMap, InformationError> {
    let windows = Windows::new((world.start, world.end), &[None]);
    let looks = std::slice::from_ref(look);
    let question = Question { looks, windows: &windows, sessions };
    let numbers = [Numbers::of(look)];
    let distances = distances(world)?;
    let (_, known) = known(world, &question, &numbers, &distances)?;
    let scene = Scene { world, table, question: &question, numbers: &numbers };
    let mut map = BeamMap::default();
    for (target, distances) in distances.iter().enumerate().filter(|it| known[it.0]) {
        let pair = Pair { target, looks: &[0] };
        scene.each(&pair, distances, |_, _, crossing, of| {
            map.pass(crossing, of.beam.fwhm_rad, share(crossing, of));
        })?;
    }
    Ok(map)
}

fn distances(world: &World) -> Result<Vec<Distances>, InformationError> {
    Ok(world.targets.iter().map(|it| Distances::of(world, it)).collect::<Result<Vec<_>, _>>()?)
}

/// The part of a pass's information that 1/f noise leaves.
fn share(crossing: &Crossing, of: &Numbers) -> f64 {
    share_left(of.knee_hz, crossing.beam_sigma_rad, crossing.speed_rad_s)
}

/// What one pass teaches.
fn taught(crossing: &Crossing, of: &Numbers) -> Lesson {
    let share = share(crossing, of);
    // Noise that is as much stronger as its information is less.
    let noisier = Crossing { noise_k_rts: crossing.noise_k_rts / share.sqrt(), ..*crossing };
    let mut profile = Profile::default();
    profile.pass(crossing, of.beam.fwhm_rad, share);
    Lesson { fisher: noisier.fisher(), profile, passes: 1, long: u32::from(share < SHORT) }
}
