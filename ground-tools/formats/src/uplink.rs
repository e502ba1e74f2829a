//! The container that goes on board, written and told.
//!
//! The layouts are the flight core's (`onboard_core::uplink`); this module only puts them together.
//!
//! # Example
//! The table for the uplink of a week's plan, as the flight core loads it:
//! ```
//! use formats::uplink::{Contents, records};
//! use mission::{Mission, Override};
//! use onboard_core::uplink::Tables;
//! use planner::plan::{Revision, plan};
//! use planner::{progress::Quietly, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=7")?])?;
//! let world = &World::open(mission, None)?;
//! let plan = plan(world, &Revision::default(), &Quietly)?;
//! let sessions = records(world, &plan)?;
//! let ephemeris = &plan.offered.tables.fitted.bytes;
//! let contents = Contents { world, ephemeris, sessions: Some(&sessions), sequence: 1 };
//! let bytes = contents.to_bytes()?;
//! let tables = Tables::load(&bytes).map_err(|error| format!("{error:?}"))?;
//! let first = tables.plan().session(0).ok_or("no session")?;
//! assert_eq!((first.body, first.start), (5, sessions[0].start));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use ephem::kernel::body_name;
use ephem::source::SUN_AS_TARGET;
use ephem::time::format_tdb;
use mission::Mission;
use mission::digest::sha256_hex;
use onboard_core::ephemeris::{FIRST_USER_BODY, SUN};
use onboard_core::time::Instant;
use onboard_core::uplink::{
    Container, ENTRY_BYTES, HEADER_BYTES, Header, MAX_SEQUENCE_STEP, SectionKind, SequenceError,
    SessionRecord, SetDigest, TableError, Tables, UplinkError, UploadRefusal, checksum,
    committed_head, entry_to_le_bytes, slot_bytes,
};
use planner::onboard::{BeyondRecord, TooMany, longest_checks, mission_section, record};
use planner::plan::Plan;
use planner::world::{TableFault, World};
use thiserror::Error;

/// What the container's format cannot hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum TooLarge {
    /// More bytes than its lengths can name.
    #[error("the uplink table would take {0} bytes: it holds 4294967295")]
    Bytes(usize),
    /// More of something than its counts can name.
    #[error(transparent)]
    Count(#[from] TooMany),
    /// A session's number that its record cannot hold.
    #[error(transparent)]
    Session(#[from] BeyondRecord),
}

/// The sessions of a plan as the uplink table holds them, by start.
///
/// # Errors
/// [`TooLarge`] where a number exceeds the format.
pub fn records(world: &World, plan: &Plan) -> Result<Vec<SessionRecord>, TooLarge> {
    let one = |&candidate: &usize| {
        Ok(record(world, &plan.offered.offers, plan.offered.opportunity(candidate))?)
    };
    plan.schedule.chosen.iter().map(one).collect()
}

/// What a container is made from.
#[derive(Debug)]
pub struct Contents<'c> {
    /// The mission among the planets.
    pub world: &'c World,
    /// The fitted ephemeris table.
    pub ephemeris: &'c [u8],
    /// The sessions by start; `None` leaves the plan out.
    pub sessions: Option<&'c [SessionRecord]>,
    /// Grows with every uplink.
    pub sequence: u32,
}

impl Contents<'_> {
    /// The container's bytes.
    ///
    /// # Errors
    /// [`TooLarge`] where something is too large for the format.
    pub fn to_bytes(&self) -> Result<Vec<u8>, TooLarge> {
        let mission = mission_section(self.world)?;
        let mut sections: Vec<(SectionKind, Vec<u8>)> = vec![
            (SectionKind::Ephemeris, self.ephemeris.to_vec()),
            (SectionKind::Mission, mission),
        ];
        if let Some(sessions) = self.sessions {
            sections.push((SectionKind::Plan, plan_section(sessions)?));
        }
        let mut set = SetDigest::new();
        for (_, contents) in &sections {
            set.update(contents);
        }
        let carried = set.value().to_le_bytes();
        let mut directory = Vec::new();
        let mut offset = HEADER_BYTES + ENTRY_BYTES * sections.len();
        for (kind, bytes) in &mut sections {
            bytes.splice(0..0, carried);
            directory.extend(entry_to_le_bytes(
                *kind,
                length(offset)?,
                length(bytes.len())?,
                checksum(bytes),
            ));
            offset += bytes.len();
        }
        let header = Header {
            sequence: self.sequence,
            valid_from: self.world.start,
            valid_until: self.world.end,
            mission_digest: digest(&self.world.mission),
            spacecraft: spacecraft(&self.world.mission),
        };
        let count = TooMany::checked("sections", sections.len())?;
        let mut bytes = header.to_le_bytes(length(offset)?, count, checksum(&directory)).to_vec();
        bytes.extend(directory);
        for (_, section) in &sections {
            bytes.extend(section);
        }
        Ok(bytes)
    }
}

/// First 16 bytes of the resolved mission's SHA-256.
#[must_use]
pub fn digest(mission: &Mission) -> [u8; 16] {
    let hex = mission.digest();
    std::array::from_fn(|index| {
        let pair = hex.get(2 * index..2 * index + 2).unwrap_or("00");
        u8::from_str_radix(pair, 16).unwrap_or(0)
    })
}

/// The name of a body in a table.
#[must_use]
pub fn body_told(number: i32) -> String {
    match number {
        SUN => "sun_to_spacecraft".to_owned(),
        SUN_AS_TARGET => "sun".to_owned(),
        own if own >= FIRST_USER_BODY => format!("source {own}"),
        body => body_name(body).to_owned(),
    }
}

/// The identity of the mission's spacecraft: the first 4 bytes of the SHA-256 of its name, the key
/// `product.object_name`, little-endian.
#[must_use]
pub fn spacecraft(mission: &Mission) -> u32 {
    let hex = sha256_hex(&mission.product.object_name);
    let first = hex.get(..8).and_then(|first| u32::from_str_radix(first, 16).ok());
    first.unwrap_or(0).swap_bytes()
}

/// A slot in which a sound container is committed, as the flight core leaves it there.
///
/// # Errors
/// [`UplinkError`] where the container is not sound.
pub fn slot_image(container: &[u8]) -> Result<Vec<u8>, UplinkError> {
    let mut slot = committed_head(&Container::parse(container)?).to_vec();
    slot.extend(container);
    slot.resize(slot_bytes(container.len()).unwrap_or(slot.len()), 0xff);
    Ok(slot)
}

fn length(bytes: usize) -> Result<u32, TooLarge> {
    u32::try_from(bytes).map_err(|_| TooLarge::Bytes(bytes))
}

fn plan_section(sessions: &[SessionRecord]) -> Result<Vec<u8>, TooLarge> {
    let mut bytes = length(sessions.len())?.to_le_bytes().to_vec();
    bytes.extend([0; 4]);
    for session in sessions {
        bytes.extend(session.to_le_bytes());
    }
    Ok(bytes)
}

/// Ticks of the sequencer in an hour, one every 10 s.
const TICKS_OF_AN_HOUR: usize = 360;

/// Telescopes whose sessions take the sequencer on board longer to check than an hour, in words.
///
/// A check takes two ticks at least for each detector, and as many for each avoidance limit.
#[must_use]
pub fn slow_checks(world: &World) -> Vec<String> {
    let searches = 1 + world.avoided.len();
    let telescopes = world.mission.telescopes.iter().filter_map(|telescope| {
        let detectors = telescope.detectors.len();
        let ticks = 2 * searches * detectors;
        (ticks > TICKS_OF_AN_HOUR).then(|| {
            format!(
                "telescope {} has {detectors} detectors, all of which go on board: the sequencer's \
                 check of one of its sessions takes at least {ticks} ticks, so check_ahead must be \
                 longer than that, or fewer detectors selected",
                telescope.name
            )
        })
    });
    telescopes.collect()
}

/// Telescopes of which a planned session has so many passes that its check takes longer than it is begun
/// before the session, in words; none where the bytes are no container's.
#[must_use]
pub fn long_checks(world: &World, uplink: &[u8]) -> Vec<String> {
    let Ok(tables) = Tables::load(uplink) else { return Vec::new() };
    let told = |(telescope, ticks): (u16, i64)| {
        let name = world.mission.telescopes.get(usize::from(telescope)).map_or("", |it| &it.name);
        format!(
            "telescope {name}: the sequencer's check of its longest session takes {ticks} ticks, so \
             check_ahead must be longer than that, or calibration.session.longest_min shorter"
        )
    };
    longest_checks(&tables).into_iter().map(told).collect()
}

/// Why a container is refused, in words.
#[must_use]
pub fn told(error: UplinkError) -> String {
    match error {
        UplinkError::Truncated(needed) => {
            format!("it is cut short: at least {needed} bytes are needed")
        }
        UplinkError::NotAContainer => {
            "it is not an uplink table: its first 8 bytes are not GYRFALCN".to_owned()
        }
        UplinkError::Version(found) => format!(
            "its format version is {found}: version {} is needed; build it again with gyrfalcon \
             table build",
            onboard_core::uplink::VERSION
        ),
        UplinkError::HeaderCrc => "it is damaged: the header's CRC does not match".to_owned(),
        UplinkError::DirectoryCrc => "it is damaged: the directory's CRC does not match".to_owned(),
        UplinkError::BadDirectory => {
            "its directory contradicts itself in counts, offsets or lengths".to_owned()
        }
        UplinkError::TooLong => "bytes follow its end".to_owned(),
        UplinkError::SectionCrc(kind) => {
            format!("it is damaged: the CRC of section {} does not match", section_name(kind))
        }
        UplinkError::MixedSet(kind) => format!(
            "its sections come from different sets: section {} carries another set's digest",
            section_name(kind)
        ),
        UplinkError::NoSuchSection(kind) => {
            format!("it has no section {}", section_name(kind.number()))
        }
        other => other.to_string(),
    }
}

/// Why the flight core refuses a container's contents, in words.
#[must_use]
pub fn contents_told(error: TableError) -> String {
    match error {
        TableError::Container(error) => told(error),
        TableError::Ephemeris(error) => TableFault(error).to_string(),
        TableError::Mission(error) => format!("its mission is refused: {error:?}"),
        TableError::Plan(error) => format!("its plan is refused: {error:?}"),
        TableError::Coverage(body) => {
            format!("body {body} of its ephemeris does not cover its validity")
        }
        TableError::SessionOutside(index) => {
            format!("session {index} of its plan lies outside its validity")
        }
        TableError::SessionTelescope(index) => {
            format!("session {index} of its plan names a telescope that its mission does not have")
        }
        other => other.to_string(),
    }
}

/// Why a spacecraft would refuse a container, in words.
#[must_use]
pub fn refusal_told(refusal: UploadRefusal) -> String {
    match refusal {
        UploadRefusal::Unsound(error) => contents_told(error),
        UploadRefusal::Expired(until) => {
            format!("its validity ends at {} TDB", format_tdb(until))
        }
        UploadRefusal::NotYetValid(from) => {
            format!("its validity begins at {} TDB", format_tdb(from))
        }
        UploadRefusal::Sequence(error) => sequence_told(error),
        UploadRefusal::OtherSpacecraft { candidate, flown } => format!(
            "it is another spacecraft's (identity {candidate:08x}, flown {flown:08x}): the same \
             product.object_name is needed, or an order of table change"
        ),
        UploadRefusal::TooLong(room, needed) => {
            format!("it takes {needed} bytes where the slot has {room}")
        }
        other => format!("the flight core refuses it: {other:?}"),
    }
}

/// Why a sequence number may not follow, in words.
#[must_use]
pub fn sequence_told(error: SequenceError) -> String {
    let (candidate, newest, why) = match error {
        SequenceError::Older { candidate, newest } => (candidate, newest, "is not above"),
        SequenceError::StepTooLarge { candidate, newest } => {
            (candidate, newest, "is too far above")
        }
        other => return format!("the flight core refuses its sequence number: {other:?}"),
    };
    format!("its sequence number {candidate} {why} {newest}: build it with {}", legal(newest))
}

/// The sequence numbers that may follow `newest`, as an option.
#[must_use]
pub fn legal(newest: u32) -> String {
    let (first, last) = (newest.saturating_add(1), newest.saturating_add(MAX_SEQUENCE_STEP));
    format!("--sequence {first} to {last}")
}

/// A section's name by its kind's number.
#[must_use]
pub fn section_name(kind: u16) -> String {
    match kind {
        1 => "ephemeris".to_owned(),
        2 => "mission".to_owned(),
        3 => "plan".to_owned(),
        other => format!("of kind {other}"),
    }
}

/// A span of time in words.
#[must_use]
pub fn span_told(from: Instant, until: Instant) -> String {
    format!("{} to {} TDB", format_tdb(from), format_tdb(until))
}
