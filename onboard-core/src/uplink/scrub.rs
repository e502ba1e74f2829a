//! Are the tables in use still what they were when they were loaded.
//!
//! Tables are checked when they are loaded and then read for months, while the memory they lie in
//! ages. A [`Scrub`] goes through the container in place, at most [`SCRUB_BYTES`] bytes a step, and
//! computes its checksums anew: header, directory, section by section, round after round.
//!
//! Method: the regions of a container and their CRCs stand in the container itself; between them they
//! cover every byte, the CRCs included. Where the regions lie, how many there are, and the header's
//! CRC are kept from the load, so that a damaged directory does not lead the scrub astray.
//!
//! Limits: a flipped bit is found at the latest [`Scrub::longest`] steps after it came about, two
//! rounds. Nothing is repaired: a damaged container is no longer to be used ([`ScrubStep::Damaged`]);
//! ask [`super::Slots::active`] which slot is.

use super::{Container, ENTRY_BYTES, HEADER_BYTES, Tables, UplinkError, read_entry};
use crate::bytes::{span, u32_at};
use crate::crc::{CRC_32, crc_32};

/// Most bytes that a step looks at.
pub const SCRUB_BYTES: u32 = 256;

/// What a step found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[must_use]
pub enum ScrubStep {
    /// Nothing so far; the round goes on.
    GoesOn,
    /// A round is over and nothing was found.
    RoundOver,
    /// The container is damaged: hand no tables to the sequencer, and ask the slots anew.
    Damaged(UplinkError),
}

/// How far a round has come, in bytes of the container.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScrubProgress {
    /// The next byte.
    pub at: u32,
    /// Bytes of the container.
    pub length: u32,
}

/// A region under one CRC.
#[derive(Debug, Clone, Copy)]
struct Region {
    start: u32,
    end: u32,
    crc: u32,
}

/// A scrub of one container, in borrowed bytes.
#[derive(Clone)]
pub struct Scrub<'a> {
    bytes: &'a [u8],
    /// Sections, as they were when the tables were loaded.
    sections: u32,
    length: u32,
    header_crc: u32,
    directory_crc: u32,
    /// 0 the header, 1 the directory, then the sections.
    region: u32,
    /// The next byte.
    at: u32,
    /// The CRC-32 of the region so far, not inverted yet.
    register: u32,
}

impl core::fmt::Debug for Scrub<'_> {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(formatter, "Scrub of {} bytes at {}", self.length, self.at)
    }
}

impl<'a> Scrub<'a> {
    /// Begins with the first round of these tables.
    #[must_use]
    pub fn new(tables: &Tables<'a>) -> Self {
        let container = tables.container();
        let Container { bytes, directory, .. } = *container;
        let narrow = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
        Self {
            bytes,
            sections: narrow(directory.len()),
            length: narrow(bytes.len()),
            header_crc: u32_at(bytes, 60).unwrap_or(0),
            directory_crc: u32_at(bytes, 20).unwrap_or(0),
            region: 0,
            at: 0,
            register: CRC_32,
        }
    }

    /// Steps after which a flipped bit is found at the latest.
    #[must_use]
    pub const fn longest(&self) -> u32 {
        // A round ends each region's last step early, and there are at most sections + 2 of them.
        let whole = self.length.div_ceil(SCRUB_BYTES);
        whole.saturating_add(self.sections).saturating_add(2).saturating_mul(2)
    }

    /// How far this round has come.
    #[must_use]
    pub const fn progress(&self) -> ScrubProgress {
        ScrubProgress { at: self.at, length: self.length }
    }

    /// Looks at the next bytes; after the last region the next round begins.
    #[inline(never)]
    // REQ-SCRUB-1.
    pub fn step(&mut self) -> ScrubStep {
        let Some(region) = self.current() else {
            self.begin(0);
            return ScrubStep::Damaged(UplinkError::BadDirectory);
        };
        let until = self.at.saturating_add(SCRUB_BYTES).min(region.end);
        match span(self.bytes, self.at, until.saturating_sub(self.at)) {
            Some(piece) => self.register = crc_32(self.register, piece),
            None => return ScrubStep::Damaged(UplinkError::BadDirectory),
        }
        self.at = until;
        if until < region.end {
            return ScrubStep::GoesOn;
        }
        if !self.register != region.crc || !self.is_linked() {
            let damage = self.damage();
            self.begin(0);
            return ScrubStep::Damaged(damage);
        }
        let last = self.region > self.sections;
        self.begin(if last { 0 } else { self.region.wrapping_add(1) });
        if last { ScrubStep::RoundOver } else { ScrubStep::GoesOn }
    }

    #[inline(never)]
    fn begin(&mut self, region: u32) {
        self.region = region;
        self.at = self.current().map_or(0, |region| region.start);
        self.register = CRC_32;
    }

    /// The region under way, from the directory for a section.
    #[inline(never)]
    fn current(&self) -> Option<Region> {
        match self.region {
            0 => Some(Region { start: 0, end: 60, crc: self.header_crc }),
            1 => {
                let end = self.sections.wrapping_mul(16).wrapping_add(64);
                Some(Region { start: 64, end, crc: self.directory_crc })
            }
            section => {
                let index = section.wrapping_sub(2).wrapping_mul(16).wrapping_add(64);
                let entry = span(self.bytes, index, 16)?.first_chunk::<ENTRY_BYTES>()?;
                let (_, start, length, crc) = read_entry(entry)?;
                let end = start.checked_add(length)?;
                (end <= self.length && start < end).then_some(Region { start, end, crc })
            }
        }
    }

    /// The header's CRC still is what it was.
    fn is_linked(&self) -> bool {
        let header = self.bytes.first_chunk::<HEADER_BYTES>();
        self.region != 0 || header.is_some_and(|header| u32_at(header, 60) == Some(self.header_crc))
    }

    /// Where the damage is.
    fn damage(&self) -> UplinkError {
        match self.region {
            0 => UplinkError::HeaderCrc,
            1 => UplinkError::DirectoryCrc,
            section => {
                let index = section.wrapping_sub(2).wrapping_mul(16).wrapping_add(64);
                let entry = span(self.bytes, index, 16).and_then(|entry| entry.first_chunk());
                let kind = entry.and_then(read_entry).map_or(0, |(kind, ..)| kind);
                UplinkError::SectionCrc(kind)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::uplink::slot_rules::{uplink, uplink_for};
    use std::vec::Vec;

    /// Steps of a copy of the scrub, gone on in damaged bytes, until it says so.
    fn found_after(scrub: &Scrub<'_>, bytes: &[u8], most: u32) -> Option<(u32, UplinkError)> {
        let mut scrub = Scrub { bytes, ..scrub.clone() };
        (1..=most).find_map(|step| match scrub.step() {
            ScrubStep::Damaged(error) => Some((step, error)),
            ScrubStep::GoesOn | ScrubStep::RoundOver => None,
        })
    }

    /// From every point of a round, every flipped bit.
    #[test]
    // REQ-SCRUB-1.
    fn a_flipped_bit_is_found_within_two_rounds() {
        let good = uplink(4, (0, 900));
        let tables = Tables::load(&good).unwrap();
        let mut scrub = Scrub::new(&tables);
        let longest = scrub.longest();
        assert_eq!(longest, 2 * (u32::try_from(good.len()).unwrap().div_ceil(256) + 4));
        let mut latest = 0;
        loop {
            for bit in 0..good.len() * 8 {
                let mut bad = good.clone();
                bad[bit / 8] ^= 1 << (bit % 8);
                let found = found_after(&scrub, &bad, longest);
                let (steps, _) = found.unwrap_or_else(|| std::panic!("bit {bit} not found"));
                latest = latest.max(steps);
            }
            if scrub.step() == ScrubStep::RoundOver {
                break;
            }
        }
        assert!(latest <= longest, "{latest} steps");
    }

    #[test]
    fn damage_is_named_and_soundness_is_not() {
        let good = uplink(4, (0, 900));
        let tables = Tables::load(&good).unwrap();
        let mut scrub = Scrub::new(&tables);
        let mut rounds = Vec::new();
        for step in 1..=30_usize {
            match scrub.step() {
                ScrubStep::RoundOver => rounds.push(step),
                ScrubStep::GoesOn => {}
                ScrubStep::Damaged(error) => std::panic!("{error:?} at {step}"),
            }
        }
        let one = rounds[0];
        assert!(rounds.iter().zip(1..).all(|(at, round)| *at == one * round), "{rounds:?}");
        let named = |at: usize| {
            let mut bad = good.clone();
            bad[at] ^= 1;
            found_after(&Scrub::new(&tables), &bad, 30).unwrap().1
        };
        assert_eq!(named(0), UplinkError::HeaderCrc);
        assert_eq!(named(61), UplinkError::HeaderCrc);
        assert_eq!(named(20), UplinkError::HeaderCrc);
        assert_eq!(named(70), UplinkError::DirectoryCrc);
        assert_eq!(named(100), UplinkError::SectionCrc(1));
        assert_eq!(named(good.len() - 1), UplinkError::SectionCrc(2));
    }

    #[test]
    // REQ-SCRUB-1.
    fn a_step_looks_at_no_more_than_its_share() {
        let good = uplink(4, (0, 900));
        let mut scrub = Scrub::new(&Tables::load(&good).unwrap());
        for _ in 0..30 {
            let before = scrub.at;
            let region = scrub.current().unwrap();
            let _ = scrub.step();
            let passed = if scrub.at > before && scrub.at < region.end {
                scrub.at - before
            } else {
                region.end - before
            };
            assert!(passed <= SCRUB_BYTES);
        }
    }

    #[test]
    // REQ-SCRUB-1.
    fn a_section_longer_than_a_step_is_sound_in_several() {
        let good = uplink_for(1, 4, (0, 900), 25);
        let mut scrub = Scrub::new(&Tables::load(&good).unwrap());
        assert_eq!(std::format!("{scrub:?}"), std::format!("Scrub of {} bytes at 0", good.len()));
        let steps: Vec<ScrubStep> = (0..12).map(|_| scrub.step()).collect();
        // Header, directory, ephemeris of 760 bytes in three, mission.
        for round in steps.chunks(6) {
            assert_eq!(round[..5], [ScrubStep::GoesOn; 5]);
            assert_eq!(round[5], ScrubStep::RoundOver);
        }
    }

    #[test]
    // REQ-SCRUB-1.
    fn a_section_that_has_lost_its_length_is_damage() {
        let good = uplink(4, (0, 900));
        let mut scrub = Scrub::new(&Tables::load(&good).unwrap());
        assert_eq!([scrub.step(), scrub.step()], [ScrubStep::GoesOn; 2]);
        // After the directory's turn: the first section's length, 0 or beyond the container.
        let length = 64 + 8;
        assert!(u32_at(&good, length).unwrap() > 100);
        for wrong in [[0; 4], [0xff, 0xff, 0, 0]] {
            let mut bad = good.clone();
            bad[length..length + 4].copy_from_slice(&wrong);
            let mut scrub = Scrub { bytes: &bad, ..scrub.clone() };
            assert_eq!(scrub.step(), ScrubStep::Damaged(UplinkError::BadDirectory), "{wrong:?}");
            // The next round looks at the header, then at the directory.
            assert_eq!(scrub.step(), ScrubStep::GoesOn);
            assert_eq!(scrub.step(), ScrubStep::Damaged(UplinkError::DirectoryCrc));
        }
    }
}
