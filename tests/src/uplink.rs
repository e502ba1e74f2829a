//! Containers from plain pieces, as the ground writes them.

use crate::Plain;
use onboard_core::phase::Rotor;
use onboard_core::uplink::{
    Container, Counts, DIGEST_BYTES, ENTRY_BYTES, FlashOperation, HEADER_BYTES, Header,
    MissionTable, SectionKind, SessionRecord, SetDigest, Slot, SunRecord, TelescopeRecord,
    WORD_BYTES, checksum, committed_head, entry_to_le_bytes, slot_bytes,
};

/// The bytes of a container with these contents.
///
/// # Panics
/// When something is too long for the format.
#[must_use]
pub fn container(header: &Header, contents: &[(SectionKind, &[u8])]) -> Vec<u8> {
    let mut digest = SetDigest::new();
    for (_, bytes) in contents {
        digest.update(bytes);
    }
    let carried = digest.value().to_le_bytes();
    let mut directory = Vec::new();
    let mut sections = Vec::new();
    let first = HEADER_BYTES + ENTRY_BYTES * contents.len();
    let short = |length: usize| u32::try_from(length).expect("a short container");
    for (kind, bytes) in contents {
        let section = [&carried, *bytes].concat();
        assert_eq!(section.len(), bytes.len() + DIGEST_BYTES);
        let offset = short(first + sections.len());
        let entry = entry_to_le_bytes(*kind, offset, short(section.len()), checksum(&section));
        directory.extend(entry);
        sections.extend(section);
    }
    let count = u16::try_from(contents.len()).expect("few sections");
    let length = short(first + sections.len());
    let head = header.to_le_bytes(length, count, checksum(&directory));
    [&head[..], &directory, &sections].concat()
}

/// Carries an operation out on two slots in memory.
///
/// # Panics
/// When a slot is too short.
pub fn carry_out(operation: FlashOperation, [a, b]: [&mut [u8]; 2]) {
    match operation {
        FlashOperation::Erase(Slot::A) => a.fill(0xff),
        FlashOperation::Erase(Slot::B) => b.fill(0xff),
        FlashOperation::Program { slot, offset, word } => {
            let bytes = if slot == Slot::A { a } else { b };
            bytes[offset..offset + WORD_BYTES].copy_from_slice(&word);
        }
    }
}

/// A slot with this container, committed.
///
/// # Panics
/// When it is not sound.
#[must_use]
pub fn slot_with(container: &[u8]) -> Vec<u8> {
    let whole = Container::parse(container).expect("a sound container");
    let mut slot = committed_head(&whole).to_vec();
    slot.extend(container);
    slot.resize(slot_bytes(container.len()).expect("a short container"), 0xff);
    slot
}

/// The contents of a mission section with the circular Sun and telescopes without detectors.
///
/// # Panics
/// When there are too many telescopes.
#[must_use]
pub fn mission(plain: &Plain, sun: Rotor, telescopes: &[TelescopeRecord]) -> Vec<u8> {
    let count = u16::try_from(telescopes.len()).expect("few telescopes");
    let counts = Counts { telescopes: count, ..Counts::default() };
    let scan = plain.strategy();
    let circular = SunRecord::Circular(sun);
    let mut bytes =
        MissionTable::fixed_to_le_bytes(scan.parameters(), circular, counts, 0.01).to_vec();
    for telescope in telescopes {
        bytes.extend(telescope.to_le_bytes());
    }
    bytes
}

/// The contents of a plan section.
///
/// # Panics
/// When there are too many sessions.
#[must_use]
pub fn plan(sessions: &[SessionRecord]) -> Vec<u8> {
    let count = u32::try_from(sessions.len()).expect("few sessions");
    let mut bytes = [count.to_le_bytes(), [0; 4]].concat();
    for session in sessions {
        bytes.extend(session.to_le_bytes());
    }
    bytes
}
