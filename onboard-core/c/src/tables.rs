//! Tables of an uplinked container: directions, mission, plan.

use crate::error::gyr_error_t;
use crate::memory::{State, answer, bytes, clear, content, fill, output};
use onboard_core::ephemeris::BodyTable;
use onboard_core::phase::{Phase, Rotor, TurnRate};
use onboard_core::rotation::Rotation;
use onboard_core::sun::SunModel;
use onboard_core::time::Instant;
use onboard_core::uplink::{SessionRecord, Tables};

/// 64-bit words of a gyr_tables_t.
pub const GYR_TABLES_WORDS: usize = 32;

/// A container's tables, checked; made by gyr_tables_load or gyr_slots_active.
///
/// It points into the container's bytes: they must stay where and as they are until
/// gyr_tables_unload, after which every function refuses these tables.
#[repr(C)]
pub struct gyr_tables_t {
    opaque: [u64; GYR_TABLES_WORDS],
}

/// Tables, and the bytes that they borrow.
#[derive(Clone, Copy)]
pub(crate) struct Loaded {
    pub(crate) tables: Tables<'static>,
    pub(crate) bytes: &'static [u8],
}

impl State for gyr_tables_t {
    type Content = Loaded;
    const KIND: [u8; 8] = *b"gyrtable";
}

const _: () = assert!(<gyr_tables_t as State>::FITS);

/// Which tables a state was made with: their contents and where they lie.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Identity {
    address: usize,
    length: usize,
    set_digest: u64,
    sequence: u32,
}

impl Loaded {
    pub(crate) fn identity(&self) -> Identity {
        Identity {
            address: self.bytes.as_ptr().addr(),
            length: self.bytes.len(),
            set_digest: self.tables.set_digest(),
            sequence: self.tables.header().sequence,
        }
    }

    /// Refused where a state was made with other tables.
    pub(crate) fn check(&self, made_with: &Identity) -> Result<(), gyr_error_t> {
        if self.identity() == *made_with { Ok(()) } else { Err(gyr_error_t::GYR_ARGUMENT_TABLES) }
    }

    pub(crate) fn sun(&self) -> Result<SunModel<'static>, gyr_error_t> {
        Ok(self.tables.sun()?)
    }

    pub(crate) fn body(&self, number: i32) -> Result<BodyTable<'static>, gyr_error_t> {
        Ok(self.tables.ephemeris().body(number)?)
    }
}

/// What a container says about itself.
#[repr(C)]
pub struct gyr_header_t {
    /// Digest of the set's contents.
    pub set_digest: u64,
    /// First and last instant that the tables serve, ns of TAI.
    pub valid_from_tai_ns: i64,
    /// See `valid_from_tai_ns`.
    pub valid_until_tai_ns: i64,
    /// Grows with every uplink.
    pub sequence: u32,
    /// Numbers of telescopes, listed detectors and avoidance limits.
    pub telescopes: u16,
    /// See `telescopes`.
    pub detectors: u16,
    /// See `telescopes`.
    pub avoidance_limits: u16,
    /// Identity of the spacecraft.
    pub spacecraft: u32,
    /// First 16 bytes of the mission's digest.
    pub mission_digest: [u8; 16],
}

/// A session of the plan.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct gyr_session_t {
    /// Start and end, setup and cooldown included, ns of TAI.
    pub start_tai_ns: i64,
    /// See `start_tai_ns`.
    pub end_tai_ns: i64,
    /// First entry and last exit of the target, ns of TAI.
    pub first_entry_tai_ns: i64,
    /// See `first_entry_tai_ns`.
    pub last_exit_tai_ns: i64,
    /// The target's number in the ephemeris.
    pub body: i32,
    /// The spin turn of the first entry, as the ground counts it.
    pub turn: u32,
    /// The telescope's index.
    pub telescope: u16,
    /// Passes within the session.
    pub passes: u16,
}

/// A uniform rotation, exact: a rate of (rate_high 2^64 + rate_low) / 2^128 turns per ns, two's
/// complement, and the phase at the mission's start in 2^-64 turn.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct gyr_rotor_t {
    /// Low half of the rate.
    pub rate_low: u64,
    /// High half of the rate.
    pub rate_high: u64,
    /// Phase at the mission's start.
    pub start: u64,
}

/// A rotation: a unit quaternion; v_B = q v_A q* for a rotation from frame A to frame B.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct gyr_quaternion_t {
    /// Along the first axis.
    pub x: f64,
    /// Along the second axis.
    pub y: f64,
    /// Along the third axis.
    pub z: f64,
    /// The scalar.
    pub w: f64,
}

/// A telescope of the mission.
#[repr(C)]
pub struct gyr_telescope_t {
    /// Its frame in the mission boresight frame.
    pub rotation: gyr_quaternion_t,
    /// Its half-wave plate; all zero without one.
    pub hwp: gyr_rotor_t,
    /// Whether it has a half-wave plate.
    pub has_hwp: bool,
}

/// A direction in the ecliptic frame of J2000, and its change.
#[repr(C)]
pub struct gyr_direction_t {
    /// Unit vector.
    pub xyz: [f64; 3],
    /// Its derivative, per s.
    pub rate_per_s: [f64; 3],
}

impl gyr_session_t {
    pub(crate) const NONE: Self = Self {
        start_tai_ns: 0,
        end_tai_ns: 0,
        first_entry_tai_ns: 0,
        last_exit_tai_ns: 0,
        body: 0,
        turn: 0,
        telescope: 0,
        passes: 0,
    };
}

impl From<SessionRecord> for gyr_session_t {
    fn from(session: SessionRecord) -> Self {
        Self {
            start_tai_ns: session.start.tai_ns(),
            end_tai_ns: session.end.tai_ns(),
            first_entry_tai_ns: session.first_entry.tai_ns(),
            last_exit_tai_ns: session.last_exit.tai_ns(),
            body: session.body,
            turn: session.turn,
            telescope: session.telescope,
            passes: session.passes,
        }
    }
}

impl From<[f64; 4]> for gyr_quaternion_t {
    fn from([x, y, z, w]: [f64; 4]) -> Self {
        Self { x, y, z, w }
    }
}

impl gyr_quaternion_t {
    /// The rotation, where the quaternion is one.
    pub(crate) fn rotation<A, B>(&self) -> Result<Rotation<A, B>, gyr_error_t> {
        Ok(Rotation::from_xyzw([self.x, self.y, self.z, self.w])?)
    }
}

impl From<&gyr_rotor_t> for Rotor {
    fn from(rotor: &gyr_rotor_t) -> Self {
        let bits = (u128::from(rotor.rate_high) << 64_u32) | u128::from(rotor.rate_low);
        Self { rate: TurnRate::from_bits(bits), start: Phase::from_bits(rotor.start) }
    }
}

impl From<Rotor> for gyr_rotor_t {
    fn from(rotor: Rotor) -> Self {
        let [low, high] = halves(rotor.rate.bits());
        Self { rate_low: low, rate_high: high, start: rotor.start.bits() }
    }
}

/// Low and high half.
fn halves(bits: u128) -> [u64; 2] {
    let half = |shift: u32| u64::try_from((bits >> shift) & u128::from(u64::MAX)).unwrap_or(0);
    [half(0), half(64)]
}

fn count<T>(records: impl Iterator<Item = T>) -> u16 {
    records.fold(0, |number, _| number.saturating_add(1))
}

/// Checks a container and makes `tables` of it. Reads all of the container: once per change of
/// tables, not per cycle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tables_load(
    container: *const u8,
    length: usize,
    tables: *mut gyr_tables_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold; the bytes stay until gyr_tables_unload.
        let bytes: &'static [u8] = unsafe { bytes(container, length) }?;
        let loaded = Loaded { tables: Tables::load(bytes)?, bytes };
        // SAFETY: as above.
        unsafe { fill(tables, loaded) }
    })
}

/// Ends the use of the container's bytes: the tables are no state any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tables_unload(tables: *mut gyr_tables_t) -> gyr_error_t {
    // SAFETY: what every caller must hold.
    answer(|| unsafe { clear(tables) })
}

/// What the container says about itself.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tables_header(
    tables: *const gyr_tables_t,
    header: *mut gyr_header_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let tables = &unsafe { content(tables) }?.tables;
        let (own, mission) = (tables.header(), tables.mission());
        let answer = gyr_header_t {
            set_digest: tables.set_digest(),
            valid_from_tai_ns: own.valid_from.tai_ns(),
            valid_until_tai_ns: own.valid_until.tai_ns(),
            sequence: own.sequence,
            telescopes: count(mission.telescopes()),
            detectors: count(mission.detectors()),
            avoidance_limits: count(mission.avoidance()),
            spacecraft: own.spacecraft,
            mission_digest: own.mission_digest,
        };
        // SAFETY: as above.
        unsafe { output(header, answer) }
    })
}

/// The session of this index in the plan; GYR_ARGUMENT_RANGE behind the last.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tables_session(
    tables: *const gyr_tables_t,
    index: u32,
    session: *mut gyr_session_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let tables = &unsafe { content(tables) }?.tables;
        let found = tables.plan().session(index).ok_or(gyr_error_t::GYR_ARGUMENT_RANGE)?;
        // SAFETY: as above.
        unsafe { output(session, found.into()) }
    })
}

/// The telescope of this index in the mission; GYR_ARGUMENT_RANGE behind the last.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tables_telescope(
    tables: *const gyr_tables_t,
    index: u16,
    telescope: *mut gyr_telescope_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let mission = unsafe { content(tables) }?.tables.mission();
        let found = mission.telescope(index).ok_or(gyr_error_t::GYR_ARGUMENT_RANGE)?;
        let none = gyr_rotor_t { rate_low: 0, rate_high: 0, start: 0 };
        let answer = gyr_telescope_t {
            rotation: found.rotation.to_xyzw().into(),
            hwp: found.hwp.map_or(none, gyr_rotor_t::from),
            has_hwp: found.hwp.is_some(),
        };
        // SAFETY: as above.
        unsafe { output(telescope, answer) }
    })
}

/// The apparent direction of a body of the ephemeris at an instant; of body 10 the direction from
/// the Sun to the spacecraft.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tables_direction(
    tables: *const gyr_tables_t,
    body: i32,
    at_tai_ns: i64,
    direction: *mut gyr_direction_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let loaded = unsafe { content(tables) }?;
        let state = loaded.body(body)?.state(Instant::from_tai_ns(at_tai_ns))?;
        let answer = gyr_direction_t { xyz: state.direction.xyz(), rate_per_s: state.rate_per_s };
        // SAFETY: as above.
        unsafe { output(direction, answer) }
    })
}
