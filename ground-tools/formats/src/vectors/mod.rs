//! What must flight code compute: the flight core's own answers, to the bit.
//!
//! A [`VectorSet`] holds lines of sight, what each of them does at each instant, and the transits of
//! the targets through them. Frames, signs and units are the core's (`docs/conventions.md`): angles
//! in radians, times in integer ns, phases as binary fractions of a turn.
//!
//! Method: calls of the core; no arithmetic of its own.
//!
//! Limits: the Sun's direction comes from a table; each vector states the one used, so that the
//! attitude can be tested apart from the table.
//!
//! # Example
//! What the mission boresight does 3700 s after the start, and its transits of Jupiter in 20 days:
//! ```
//! use formats::vectors::VectorSet;
//! use mission::{Mission, Override};
//! use planner::{opportunities::boresight, time::Duration, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=20")?])?;
//! let mut world = World::open(mission, None)?;
//! world.keep_targets(&["jupiter".to_owned()])?;
//! let tables = world.tables(&world.ground_options())?;
//! let lines = [boresight(&world.mission)?];
//! let later = [Duration::from_seconds(3700.0)];
//! let set = VectorSet::new(&world, tables.parse()?, &lines, later.into_iter())?;
//! assert_eq!((set.vectors[0].precession_count, set.vectors[0].spin_count), (0, 3));
//! assert_eq!((set.transits.len(), set.transits[0].target, set.transits[0].body), (15, "jupiter", 5));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod c_header;

use crate::rows::Column;
use crate::rows::Field::{Count, Number, Truth, Whole, Word};
use onboard_core::attitude::sweep;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::hwp::hwp_phase;
use onboard_core::phase::Phase;
use onboard_core::time::{Duration, Instant};
use planner::opportunities::{Found, OffersError, SightLine, search};
use planner::world::{TableFault, World};
use std::borrow::Cow;
use thiserror::Error;

/// Why a table serves no vectors.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum VectorsError {
    /// It lacks a target.
    #[error("the table has no {target}: a table with it is needed")]
    NoSuchBody {
        /// The target.
        target: String,
    },
    /// It does not hold the Sun, or not at all instants.
    #[error(transparent)]
    Table(#[from] TableFault),
    /// Its transits cannot be found.
    #[error(transparent)]
    Offers(#[from] OffersError),
}

/// What one line of sight does at one instant.
#[derive(Debug, Clone)]
pub struct Vector<'w> {
    /// Telescope's name, or `-`.
    pub telescope: &'w str,
    /// Detector's name, or `-`.
    pub detector: &'w str,
    /// The instant, ns of TAI since 2000-01-01T12:00:00 TAI.
    pub tai_ns: i64,
    /// ns of TAI since the mission's start.
    pub elapsed_ns: i64,
    /// Sun to spacecraft, ecliptic unit vector.
    pub sun_x: f64,
    /// Its y.
    pub sun_y: f64,
    /// Its z.
    pub sun_z: f64,
    /// Detector frame to ecliptic, scalar last, `q_w` >= 0.
    pub q_x: f64,
    /// Its y.
    pub q_y: f64,
    /// Its z.
    pub q_z: f64,
    /// Its scalar.
    pub q_w: f64,
    /// Line of sight, ecliptic unit vector.
    pub x: f64,
    /// Its y.
    pub y: f64,
    /// Its z.
    pub z: f64,
    /// Crossing angle.
    pub psi_rad: f64,
    /// Scan-beam angle.
    pub zeta_rad: f64,
    /// Speed of the line of sight on the sky.
    pub scan_speed_rad_s: f64,
    /// Precession phase.
    pub precession_phase: Phase,
    /// Spin phase.
    pub spin_phase: Phase,
    /// Half-wave plate's phase, where there is a plate.
    pub hwp_phase: Option<Phase>,
    /// Completed precession turns since the start.
    pub precession_count: u64,
    /// Completed spin turns since the start.
    pub spin_count: u64,
}

/// One transit.
#[derive(Debug, Clone)]
pub struct TransitVector<'w> {
    /// Target's name.
    pub target: &'w str,
    /// Its number in the table.
    pub body: i32,
    /// Telescope's name, or `-`.
    pub telescope: &'w str,
    /// Detector's name, or `-`.
    pub detector: &'w str,
    /// First instant inside.
    pub entry_tai_ns: i64,
    /// Last instant inside.
    pub exit_tai_ns: i64,
    /// Instant of smallest separation.
    pub closest_tai_ns: i64,
    /// The separation there.
    pub min_separation_rad: f64,
    /// Inside already at the mission's start.
    pub entry_clipped: bool,
    /// Still inside at the mission's end.
    pub exit_clipped: bool,
}

impl Vector<'_> {
    /// Its columns; phases are the 64 bits in hexadecimal digits.
    #[must_use]
    pub fn columns<'r>() -> [Column<&'r Self>; 23] {
        [
            Column::new("kind", Word(|_| Some("vector".into()))),
            Column::new("telescope", Word(|it| Some(it.telescope.into()))),
            Column::new("detector", Word(|it| Some(it.detector.into()))),
            Column::new("tai_ns", Whole(|it| Some(it.tai_ns))),
            Column::new("elapsed_ns", Whole(|it| Some(it.elapsed_ns))),
            Column::new("sun_x", Number(|it| Some(it.sun_x))),
            Column::new("sun_y", Number(|it| Some(it.sun_y))),
            Column::new("sun_z", Number(|it| Some(it.sun_z))),
            Column::new("q_x", Number(|it| Some(it.q_x))),
            Column::new("q_y", Number(|it| Some(it.q_y))),
            Column::new("q_z", Number(|it| Some(it.q_z))),
            Column::new("q_w", Number(|it| Some(it.q_w))),
            Column::new("x", Number(|it| Some(it.x))),
            Column::new("y", Number(|it| Some(it.y))),
            Column::new("z", Number(|it| Some(it.z))),
            Column::new("psi_rad", Number(|it| Some(it.psi_rad))),
            Column::new("zeta_rad", Number(|it| Some(it.zeta_rad))),
            Column::new("scan_speed_rad_s", Number(|it| Some(it.scan_speed_rad_s))),
            Column::new("precession_phase", Word(|it| Some(hexadecimal(it.precession_phase)))),
            Column::new("spin_phase", Word(|it| Some(hexadecimal(it.spin_phase)))),
            Column::new("hwp_phase", Word(|it| it.hwp_phase.map(hexadecimal))),
            Column::new("precession_count", Count(|it| Some(it.precession_count))),
            Column::new("spin_count", Count(|it| Some(it.spin_count))),
        ]
    }
}

impl TransitVector<'_> {
    /// Its columns.
    #[must_use]
    pub fn columns<'r>() -> [Column<&'r Self>; 11] {
        [
            Column::new("kind", Word(|_| Some("transit".into()))),
            Column::new("target", Word(|it| Some(it.target.into()))),
            Column::new("body", Whole(|it| Some(it.body.into()))),
            Column::new("telescope", Word(|it| Some(it.telescope.into()))),
            Column::new("detector", Word(|it| Some(it.detector.into()))),
            Column::new("entry_tai_ns", Whole(|it| Some(it.entry_tai_ns))),
            Column::new("exit_tai_ns", Whole(|it| Some(it.exit_tai_ns))),
            Column::new("closest_tai_ns", Whole(|it| Some(it.closest_tai_ns))),
            Column::new("min_separation_rad", Number(|it| Some(it.min_separation_rad))),
            Column::new("entry_clipped", Truth(|it| it.entry_clipped)),
            Column::new("exit_clipped", Truth(|it| it.exit_clipped)),
        ]
    }
}

fn hexadecimal(phase: Phase) -> Cow<'static, str> {
    format!("{:#018x}", phase.bits()).into()
}

/// Vectors and transits of a mission.
#[derive(Debug)]
pub struct VectorSet<'w> {
    /// The mission among the planets.
    pub world: &'w World,
    /// The lines of sight.
    pub lines: &'w [SightLine],
    /// By instant, then line of sight.
    pub vectors: Vec<Vector<'w>>,
    /// By entry, then target, then line of sight.
    pub transits: Vec<TransitVector<'w>>,
}

impl<'w> VectorSet<'w> {
    /// What the flight core answers on this table.
    ///
    /// # Errors
    /// [`VectorsError`] where the table lacks a body or an instant.
    pub fn new(
        world: &'w World,
        table: EphemerisTable<'_>,
        lines: &'w [SightLine],
        times: impl Iterator<Item = Duration>,
    ) -> Result<Self, VectorsError> {
        let sun = world.sun(table)?;
        if let Some(source) = world.targets.iter().find(|it| table.body(it.body()).is_err()) {
            return Err(VectorsError::NoSuchBody { target: source.name().to_owned() });
        }
        let mut vectors = Vec::new();
        for elapsed in times {
            let at = world.zero().plus(elapsed);
            let anti_sun = sun.state(world.zero(), at).map_err(TableFault)?;
            let (precession, spin) = world.scan.phases(at);
            let (precession_count, spin_count) = world.scan.turns(at);
            for line in lines {
                let seen = sweep(&world.scan, &sun, line.rotation, at).map_err(TableFault)?;
                let [sun_x, sun_y, sun_z] = anti_sun.direction.xyz();
                let [q_x, q_y, q_z, q_w] = seen.attitude.to_xyzw();
                let [x, y, z] = seen.direction.xyz();
                vectors.push(Vector {
                    telescope: &line.telescope_name,
                    detector: &line.detector_name,
                    tai_ns: at.tai_ns(),
                    elapsed_ns: elapsed.ns(),
                    sun_x,
                    sun_y,
                    sun_z,
                    q_x,
                    q_y,
                    q_z,
                    q_w,
                    x,
                    y,
                    z,
                    psi_rad: seen.crossing_angle_rad,
                    zeta_rad: seen.scan_beam_angle_rad,
                    scan_speed_rad_s: seen.speed_rad_s,
                    precession_phase: precession,
                    spin_phase: spin,
                    hwp_phase: line.hwp.map(|plate| hwp_phase(&world.scan, plate, at)),
                    precession_count,
                    spin_count,
                });
            }
        }
        let found = search(world, table, lines)?;
        let transits = found.iter().map(|it| transit(world, lines, it)).collect();
        Ok(Self { world, lines, vectors, transits })
    }
}

fn transit<'w>(world: &'w World, lines: &'w [SightLine], found: &Found) -> TransitVector<'w> {
    let Found { target, line, transit } = found;
    let (source, line) = (&world.targets[*target], &lines[*line]);
    let ns = |at: Instant| at.tai_ns();
    TransitVector {
        target: source.name(),
        body: source.body(),
        telescope: &line.telescope_name,
        detector: &line.detector_name,
        entry_tai_ns: ns(transit.entry),
        exit_tai_ns: ns(transit.exit),
        closest_tai_ns: ns(transit.closest),
        min_separation_rad: transit.min_separation_rad,
        entry_clipped: transit.entry_clipped,
        exit_clipped: transit.exit_clipped,
    }
}
