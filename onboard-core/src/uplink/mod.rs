//! What the ground sends up: one container of checked tables.
//!
//! Layout, little-endian, no alignment; CRC is CRC-32 (ISO-HDLC, as in zlib).
//!
//! | bytes | field |
//! |---|---|
//! | 0..8 | magic `GYRFALCN` |
//! | 8..10 | format version, u16 ([`VERSION`]) |
//! | 10..12 | number of sections, u16, at most [`MAX_SECTIONS`] |
//! | 12..16 | length of the container, u32 |
//! | 16..20 | sequence number, u32, growing with every uplink |
//! | 20..24 | CRC of the directory |
//! | 24..32 | valid from, i64 ns of TAI |
//! | 32..40 | valid until, i64 ns of TAI |
//! | 40..56 | first 16 bytes of the resolved mission's SHA-256 |
//! | 56..60 | identity of the spacecraft, u32 |
//! | 60..64 | CRC of bytes 0..60 |
//! | 64.. | directory: kind u16, zero u16, offset u32, length u32, CRC u32 per section |
//! | then | sections: the set's digest, u64, and the contents |
//!
//! Method: nothing is believed before its CRC matches; sections lie behind the directory without
//! gaps, so every byte of the container is covered by a CRC. Each section carries the digest of the
//! whole set ([`SetDigest`]: CRC-64/XZ over the length and the CRC-32 of each section's contents, u32
//! each), so that one exchanged for another set's
//! is refused even where its own CRC was made to match.
//!
//! [`Tables`] is a container with its sections checked against each other, [`Slots`] the two places
//! in flash that hold one each, [`Upload`] and [`Revocation`] the operations that change them,
//! [`RollbackOrder`] the only way back to an older one, [`MissionChangeOrder`] the only way to another
//! spacecraft's.
//!
//! Limits: CRCs guard against damage and mix-ups, not against forgery; authentication belongs to
//! the telecommand link.

mod sequence;
mod mission;
mod plan;
mod rollback;
mod mission_change;
mod tables;
mod scrub;
mod slot_layout;
mod flash;
mod slots;
#[cfg(test)]
mod slot_rules;
#[cfg(test)]
mod power_cuts;

pub use flash::{FlashError, FlashOperation, Revocation, Upload};
pub use mission::{
    AvoidanceRecord, Counts, DetectorRecord, MissionError, MissionTable, SunRecord, TelescopeRecord,
};
pub use mission_change::{MISSION_CHANGE_BYTES, MissionChangeError, MissionChangeOrder};
pub use plan::{PlanError, PlanTable, SESSION_BYTES, SessionRecord};
pub use rollback::{ROLLBACK_BYTES, RollbackError, RollbackOrder};
pub use scrub::{SCRUB_BYTES, Scrub, ScrubProgress, ScrubStep};
pub use sequence::{MAX_SEQUENCE_STEP, SequenceError, check_sequence};
pub use slot_layout::{
    COMMIT_OFFSET, CONTAINER_OFFSET, ERASED, FLOOR_OFFSET, FLOOR_WORDS, REVOKED_OFFSET, Slot,
    Slots, WORD_BYTES, Word, slot_bytes,
};
pub use slots::{Active, NoTables, RollbackRefusal, SlotState, UploadRefusal, committed_head};
pub use tables::{TableError, Tables};

use crate::bytes::{field, i64_at, put, span, u16_at, u32_at, u64_at};
use crate::crc::{CRC_32, CRC_64, crc_32, crc_64};
use crate::time::Instant;

/// First bytes of every container.
pub const MAGIC: [u8; 8] = *b"GYRFALCN";
/// The format version that this crate reads and writes.
pub const VERSION: u16 = 3;
/// Bytes of the header.
pub const HEADER_BYTES: usize = 64;
/// Bytes of one directory entry.
pub const ENTRY_BYTES: usize = 16;
/// Most sections in a container.
pub const MAX_SECTIONS: u16 = 8;
/// Bytes of the set's digest before each section's contents.
pub const DIGEST_BYTES: usize = 8;

/// What a section holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SectionKind {
    /// Direction tables: [`crate::ephemeris::EphemerisTable`].
    Ephemeris,
    /// Scanning strategy, Sun model and telescopes: [`MissionTable`].
    Mission,
    /// Calibration sessions: [`PlanTable`].
    Plan,
}

impl SectionKind {
    /// The number that stands for the kind in a directory.
    #[must_use]
    pub const fn number(self) -> u16 {
        match self {
            Self::Ephemeris => 1,
            Self::Mission => 2,
            Self::Plan => 3,
        }
    }
}

/// Why a container is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum UplinkError {
    /// Shorter than a header, or than the length in it (the bytes needed).
    Truncated(u32),
    /// The first bytes are not the magic.
    NotAContainer,
    /// Another format version (the one found).
    Version(u16),
    /// The header's CRC does not match.
    HeaderCrc,
    /// The directory's CRC does not match.
    DirectoryCrc,
    /// The directory's counts, offsets or lengths contradict each other.
    BadDirectory,
    /// Bytes follow the container's end.
    TooLong,
    /// A section's CRC does not match (its kind's number).
    SectionCrc(u16),
    /// A section (its kind's number) comes from another set than the contents that lie here.
    MixedSet(u16),
    /// The section is not there.
    NoSuchSection(SectionKind),
}

/// What a container says about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Header {
    /// Grows with every uplink.
    pub sequence: u32,
    /// First instant that the tables serve.
    pub valid_from: Instant,
    /// Last instant that the tables serve.
    pub valid_until: Instant,
    /// First 16 bytes of the resolved mission's SHA-256; another one after every edit of the file.
    pub mission_digest: [u8; 16],
    /// Identity of the spacecraft: first 4 bytes of the SHA-256 of its name, whatever else the mission
    /// file says.
    pub spacecraft: u32,
}

/// A checked container in borrowed bytes.
#[derive(Debug, Clone, Copy)]
pub struct Container<'a> {
    bytes: &'a [u8],
    directory: &'a [[u8; ENTRY_BYTES]],
    header: Header,
    set_digest: u64,
}

/// The digest of a set's contents, section after section in the directory's order.
#[derive(Debug, Clone)]
pub struct SetDigest {
    /// The CRC-64 so far, not inverted yet.
    register: u64,
}

impl Default for SetDigest {
    fn default() -> Self {
        Self::new()
    }
}

impl SetDigest {
    /// The digest of no section yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { register: CRC_64 }
    }

    /// Takes in the next section's contents.
    #[inline(never)]
    pub fn update(&mut self, contents: &[u8]) {
        let length = u32::try_from(contents.len()).unwrap_or(u32::MAX);
        // The length, then the CRC-32.
        let pair = u64::from(length) | u64::from(checksum(contents)) << 32_u32;
        self.register = crc_64(self.register, pair.to_le_bytes());
    }

    /// The digest of all contents taken in.
    #[must_use]
    pub const fn value(self) -> u64 {
        !self.register
    }
}

/// CRC-32 of bytes, as the container uses it.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u32 {
    !crc_32(CRC_32, bytes)
}

impl Header {
    /// The header's bytes for a container of `length` bytes with this directory.
    #[must_use]
    pub fn to_le_bytes(
        &self,
        length: u32,
        sections: u16,
        directory_crc: u32,
    ) -> [u8; HEADER_BYTES] {
        let mut bytes = [0; HEADER_BYTES];
        put(&mut bytes, 0, MAGIC);
        put(&mut bytes, 8, VERSION.to_le_bytes());
        put(&mut bytes, 10, sections.to_le_bytes());
        put(&mut bytes, 12, length.to_le_bytes());
        put(&mut bytes, 16, self.sequence.to_le_bytes());
        put(&mut bytes, 20, directory_crc.to_le_bytes());
        put(&mut bytes, 24, self.valid_from.tai_ns().to_le_bytes());
        put(&mut bytes, 32, self.valid_until.tai_ns().to_le_bytes());
        put(&mut bytes, 40, self.mission_digest);
        put(&mut bytes, 56, self.spacecraft.to_le_bytes());
        let crc = bytes.first_chunk::<60>().map_or(0, |covered| checksum(covered));
        put(&mut bytes, 60, crc.to_le_bytes());
        bytes
    }
}

/// The bytes of one directory entry.
#[must_use]
pub fn entry_to_le_bytes(
    kind: SectionKind,
    offset: u32,
    length: u32,
    crc: u32,
) -> [u8; ENTRY_BYTES] {
    let mut bytes = [0; ENTRY_BYTES];
    put(&mut bytes, 0, kind.number().to_le_bytes());
    put(&mut bytes, 4, offset.to_le_bytes());
    put(&mut bytes, 8, length.to_le_bytes());
    put(&mut bytes, 12, crc.to_le_bytes());
    bytes
}

impl<'a> Container<'a> {
    /// Checks a container and every section's CRC.
    ///
    /// # Errors
    /// [`UplinkError`], the first thing found wrong.
    #[inline(never)]
    // REQ-CONT-1.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, UplinkError> {
        let short = UplinkError::Truncated(64);
        let (header, rest) = bytes.split_first_chunk::<HEADER_BYTES>().ok_or(short)?;
        let covered = header.first_chunk::<60>().ok_or(short)?;
        if field(header, 0) != Some(MAGIC) {
            return Err(UplinkError::NotAContainer);
        }
        let version = u16_at(header, 8).ok_or(short)?;
        if version != VERSION {
            return Err(UplinkError::Version(version));
        }
        if u32_at(header, 60) != Some(checksum(covered)) {
            return Err(UplinkError::HeaderCrc);
        }
        let length = u32_at(header, 12).ok_or(short)?;
        match usize::try_from(length) {
            Ok(length) if length == bytes.len() => {}
            Ok(length) if length < bytes.len() => return Err(UplinkError::TooLong),
            _ => return Err(UplinkError::Truncated(length)),
        }
        let sections = u16_at(header, 10).ok_or(short)?;
        let directory_bytes = usize::from(sections).wrapping_mul(ENTRY_BYTES);
        let directory = match rest.get(..directory_bytes) {
            Some(directory) if sections <= MAX_SECTIONS => directory,
            _ => return Err(UplinkError::BadDirectory),
        };
        if u32_at(header, 20) != Some(checksum(directory)) {
            return Err(UplinkError::DirectoryCrc);
        }
        let mut container = Self {
            bytes,
            set_digest: 0,
            directory: directory.as_chunks::<ENTRY_BYTES>().0,
            header: Header {
                sequence: u32_at(header, 16).ok_or(short)?,
                valid_from: Instant::from_tai_ns(i64_at(header, 24).ok_or(short)?),
                valid_until: Instant::from_tai_ns(i64_at(header, 32).ok_or(short)?),
                mission_digest: field(header, 40).ok_or(short)?,
                spacecraft: u32_at(header, 56).ok_or(short)?,
            },
        };
        container.check_sections(length)?;
        container.set_digest = container.check_set()?;
        Ok(container)
    }

    /// The digest of the contents, which every section must carry.
    #[inline(never)]
    fn check_set(&self) -> Result<u64, UplinkError> {
        let mut digest = SetDigest::new();
        for (_, offset, size, _) in self.directory.iter().filter_map(read_entry) {
            digest.update(self.contents(offset, size).ok_or(UplinkError::BadDirectory)?);
        }
        let found = digest.value();
        for (kind, offset, _, _) in self.directory.iter().filter_map(read_entry) {
            if span(self.bytes, offset, 8).and_then(|carried| u64_at(carried, 0)) != Some(found) {
                return Err(UplinkError::MixedSet(kind));
            }
        }
        Ok(found)
    }

    /// A section's bytes behind the set's digest.
    fn contents(&self, offset: u32, size: u32) -> Option<&'a [u8]> {
        span(self.bytes, offset, size)?.get(DIGEST_BYTES..)
    }

    /// Sections follow one another from the directory's end to the container's, each with its CRC.
    #[inline(never)]
    fn check_sections(&self, length: u32) -> Result<(), UplinkError> {
        let bad = UplinkError::BadDirectory;
        let entries = u32::try_from(self.directory.len()).map_err(|_| bad)?;
        let mut expected = entries.wrapping_mul(16).wrapping_add(64);
        let mut kinds_before: &[[u8; ENTRY_BYTES]] = &[];
        for (index, entry) in self.directory.iter().enumerate() {
            let (kind, offset, size, crc) = read_entry(entry).ok_or(bad)?;
            let twice = kinds_before.iter().any(|other| u16_at(other, 0) == Some(kind));
            if offset != expected || twice {
                return Err(bad);
            }
            let section = span(self.bytes, offset, size).ok_or(bad)?;
            if checksum(section) != crc {
                return Err(UplinkError::SectionCrc(kind));
            }
            expected = expected.checked_add(size).ok_or(bad)?;
            kinds_before = self.directory.get(..=index).unwrap_or(&[]);
        }
        if expected == length && self.header.valid_from <= self.header.valid_until {
            Ok(())
        } else {
            Err(bad)
        }
    }

    /// What the container says about itself.
    #[must_use]
    pub const fn header(&self) -> Header {
        self.header
    }

    /// The digest of the whole set's contents.
    #[must_use]
    pub const fn set_digest(&self) -> u64 {
        self.set_digest
    }

    /// The contents of a section.
    ///
    /// # Errors
    /// [`UplinkError::NoSuchSection`].
    #[inline(never)]
    pub fn section(&self, kind: SectionKind) -> Result<&'a [u8], UplinkError> {
        self.directory
            .iter()
            .filter_map(read_entry)
            .find(|(number, ..)| *number == kind.number())
            .and_then(|(_, offset, length, _)| self.contents(offset, length))
            .ok_or(UplinkError::NoSuchSection(kind))
    }
}

/// Kind, offset, length and CRC of a directory entry; `None` when its spare bytes are not zero.
#[inline(never)]
fn read_entry(entry: &[u8; ENTRY_BYTES]) -> Option<(u16, u32, u32, u32)> {
    let spare = u16_at(entry, 2)?;
    let fields = (u16_at(entry, 0)?, u32_at(entry, 4)?, u32_at(entry, 8)?, u32_at(entry, 12)?);
    (spare == 0).then_some(fields)
}

#[cfg(test)]
pub(crate) mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    const HEADER: Header = Header {
        sequence: 7,
        valid_from: Instant::from_tai_ns(-5),
        valid_until: Instant::from_tai_ns(900),
        mission_digest: [9; 16],
        spacecraft: 0x1234_5678,
    };

    /// A container of these contents, as the ground writes it.
    pub(crate) fn container_of(header: &Header, contents: &[(SectionKind, &[u8])]) -> Vec<u8> {
        let mut digest = SetDigest::new();
        for (_, bytes) in contents {
            digest.update(bytes);
        }
        let carried = digest.value().to_le_bytes();
        let mut directory = Vec::new();
        let mut sections = Vec::new();
        let first = HEADER_BYTES + ENTRY_BYTES * contents.len();
        for (kind, bytes) in contents {
            let section = [&carried, *bytes].concat();
            let offset = u32::try_from(first + sections.len()).unwrap();
            let size = u32::try_from(section.len()).unwrap();
            directory.extend(entry_to_le_bytes(*kind, offset, size, checksum(&section)));
            sections.extend(section);
        }
        let length = u32::try_from(first + sections.len()).unwrap();
        let count = u16::try_from(contents.len()).unwrap();
        let head = header.to_le_bytes(length, count, checksum(&directory));
        [&head[..], &directory, &sections].concat()
    }

    fn container() -> Vec<u8> {
        container_of(&HEADER, &[(SectionKind::Plan, &[1, 2, 3]), (SectionKind::Mission, &[4, 5])])
    }

    #[test]
    fn a_container_comes_back() {
        let bytes = container();
        let container = Container::parse(&bytes).unwrap();
        assert_eq!(container.header(), HEADER);
        assert_eq!(container.section(SectionKind::Plan).unwrap(), [1, 2, 3]);
        assert_eq!(container.section(SectionKind::Mission).unwrap(), [4, 5]);
        assert_eq!(
            container.section(SectionKind::Ephemeris).unwrap_err(),
            UplinkError::NoSuchSection(SectionKind::Ephemeris)
        );
    }

    #[test]
    // REQ-CONT-1.
    fn every_flipped_bit_and_every_cut_is_refused() {
        let good = container();
        for length in 0..good.len() {
            assert!(Container::parse(&good[..length]).is_err());
        }
        for bit in 0..good.len() * 8 {
            let mut bad = good.clone();
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(Container::parse(&bad).is_err(), "bit {bit}");
        }
        let mut long = good;
        long.push(0);
        assert_eq!(Container::parse(&long).unwrap_err(), UplinkError::TooLong);
    }

    #[test]
    // REQ-CONT-1.
    fn a_section_of_another_set_is_refused_with_its_crcs_made_right() {
        let mut bytes = container();
        // The plan's contents become another set's; its CRC and the directory's and header's follow.
        bytes[96 + 8] = 7;
        let crc = checksum(&bytes[96..107]);
        bytes[76..80].copy_from_slice(&crc.to_le_bytes());
        let directory = checksum(&bytes[64..96]);
        bytes[20..24].copy_from_slice(&directory.to_le_bytes());
        let header = checksum(&bytes[..60]);
        bytes[60..64].copy_from_slice(&header.to_le_bytes());
        let plan = SectionKind::Plan.number();
        assert_eq!(Container::parse(&bytes).unwrap_err(), UplinkError::MixedSet(plan));
    }

    #[test]
    fn an_older_version_is_named() {
        let mut bytes = container();
        bytes[8] = 2;
        assert_eq!(Container::parse(&bytes).unwrap_err(), UplinkError::Version(2));
    }

    /// With directory and header changed in place, and their CRCs made right.
    fn with(change: impl FnOnce(&mut Vec<u8>)) -> Result<(), UplinkError> {
        let mut bytes = container();
        change(&mut bytes);
        let directory = checksum(&bytes[64..96]);
        bytes[20..24].copy_from_slice(&directory.to_le_bytes());
        let header = checksum(&bytes[..60]);
        bytes[60..64].copy_from_slice(&header.to_le_bytes());
        Container::parse(&bytes).map(|_| ())
    }

    #[test]
    // REQ-CONT-1.
    fn a_cut_is_told_from_what_is_too_long() {
        let good = container();
        let whole = u32::try_from(good.len()).unwrap();
        for length in 0..good.len() {
            let least = if length < HEADER_BYTES { 64 } else { whole };
            assert_eq!(
                Container::parse(&good[..length]).err(),
                Some(UplinkError::Truncated(least))
            );
        }
    }

    #[test]
    // REQ-CONT-1.
    fn sections_fill_the_container_one_after_the_other_each_once() {
        let bad = Err(UplinkError::BadDirectory);
        assert_eq!(with(|_| {}), Ok(()));
        // Offsets of the two sections: 96 and 107; the second's CRC made right for its place.
        let moved = |bytes: &mut Vec<u8>| {
            bytes[84..88].copy_from_slice(&106_u32.to_le_bytes());
            let crc = checksum(&bytes[106..116]);
            bytes[92..96].copy_from_slice(&crc.to_le_bytes());
        };
        assert_eq!(with(moved), bad, "overlapping sections");
        let longer = |bytes: &mut Vec<u8>| {
            bytes.push(0);
            let length = u32::try_from(bytes.len()).unwrap();
            bytes[12..16].copy_from_slice(&length.to_le_bytes());
        };
        assert_eq!(with(longer), bad, "bytes that belong to no section");
        assert_eq!(with(|bytes| bytes[96 + 9] ^= 1), Err(UplinkError::SectionCrc(3)));
        let twice = container_of(&HEADER, &[(SectionKind::Plan, &[1]), (SectionKind::Plan, &[2])]);
        assert_eq!(Container::parse(&twice).map(|_| ()), bad);
        let ended = Header { valid_until: HEADER.valid_from, ..HEADER };
        let instant = container_of(&ended, &[(SectionKind::Plan, &[1])]);
        assert!(Container::parse(&instant).is_ok(), "valid at one instant");
        let before = HEADER.valid_from.plus(crate::time::Duration::from_ns(-1));
        let never = Header { valid_until: before, ..HEADER };
        let never = container_of(&never, &[(SectionKind::Plan, &[1])]);
        assert_eq!(Container::parse(&never).map(|_| ()), bad);
    }

    #[test]
    // REQ-CONT-1.
    fn there_are_no_more_sections_than_stated() {
        let parse = |count: u16| {
            let contents: Vec<(SectionKind, &[u8])> =
                (0..count).map(|_| (SectionKind::Plan, &[1_u8][..])).collect();
            let mut bytes = container_of(&HEADER, &contents);
            // Each of a kind of its own.
            for index in 0..usize::from(count) {
                bytes[64 + 16 * index] = u8::try_from(index + 1).unwrap();
            }
            let directory = checksum(&bytes[64..64 + 16 * usize::from(count)]);
            bytes[20..24].copy_from_slice(&directory.to_le_bytes());
            let header = checksum(&bytes[..60]);
            bytes[60..64].copy_from_slice(&header.to_le_bytes());
            Container::parse(&bytes).map(|_| ())
        };
        assert_eq!(parse(MAX_SECTIONS), Ok(()));
        assert_eq!(parse(MAX_SECTIONS + 1), Err(UplinkError::BadDirectory));
    }
}
