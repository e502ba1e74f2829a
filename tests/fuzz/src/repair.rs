//! Bytes turned into something whose lengths, CRCs and digest are right, whatever else is wrong.

use onboard_core::uplink::{
    DIGEST_BYTES, ENTRY_BYTES, HEADER_BYTES, MAGIC, MAX_SECTIONS, SetDigest, VERSION, checksum,
};

fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    bytes[at..at + value.len()].copy_from_slice(value);
}

/// A container of these bytes: magic, version, number of sections, offsets, lengths, digest and
/// CRCs are made right, the sections' kinds, the other fields and the contents stay.
///
/// The sections' lengths are kept as far as they fit; the last section takes the rest.
#[must_use]
pub fn container(bytes: &[u8]) -> Vec<u8> {
    let mut image = bytes.to_vec();
    if image.len() < HEADER_BYTES {
        image.resize(HEADER_BYTES, 0);
    }
    let fitting = (image.len() - HEADER_BYTES) / (ENTRY_BYTES + DIGEST_BYTES);
    let sections = usize::from(u16_at(&image, 10)).min(usize::from(MAX_SECTIONS)).min(fitting);
    let first = HEADER_BYTES + ENTRY_BYTES * sections;
    if sections == 0 {
        image.truncate(first);
    }
    let spans = layout(&image, sections, first);
    let mut digest = SetDigest::new();
    for (start, end) in &spans {
        digest.update(&image[start + DIGEST_BYTES..*end]);
    }
    let carried = digest.value().to_le_bytes();
    for (index, (start, end)) in spans.iter().enumerate() {
        put(&mut image, *start, &carried);
        let crc = checksum(&image[*start..*end]);
        let entry = HEADER_BYTES + ENTRY_BYTES * index;
        put(&mut image, entry + 2, &[0; 2]);
        put(&mut image, entry + 4, &(*start as u32).to_le_bytes());
        put(&mut image, entry + 8, &((end - start) as u32).to_le_bytes());
        put(&mut image, entry + 12, &crc.to_le_bytes());
    }
    put(&mut image, 0, &MAGIC);
    put(&mut image, 8, &VERSION.to_le_bytes());
    put(&mut image, 10, &(sections as u16).to_le_bytes());
    let length = image.len() as u32;
    put(&mut image, 12, &length.to_le_bytes());
    let crc = checksum(&image[HEADER_BYTES..first]);
    put(&mut image, 20, &crc.to_le_bytes());
    let crc = checksum(&image[..60]);
    put(&mut image, 60, &crc.to_le_bytes());
    image
}

/// Where each section begins and ends.
fn layout(image: &[u8], sections: usize, first: usize) -> Vec<(usize, usize)> {
    let mut spans = Vec::new();
    let mut start = first;
    for index in 0..sections {
        let after = sections - index - 1;
        let most = image.len() - after * DIGEST_BYTES;
        let entry = HEADER_BYTES + ENTRY_BYTES * index + 8;
        let wanted = u32::from_le_bytes([
            image[entry],
            image[entry + 1],
            image[entry + 2],
            image[entry + 3],
        ]);
        let end = if after == 0 {
            image.len()
        } else {
            start.saturating_add(wanted as usize).clamp(start + DIGEST_BYTES, most)
        };
        spans.push((start, end));
        start = end;
    }
    spans
}

/// A record of these bytes with its magic and its CRC, which covers all but the last four bytes.
#[must_use]
pub fn record<const N: usize>(bytes: &[u8; N], magic: [u8; 8]) -> [u8; N] {
    let mut image = *bytes;
    put(&mut image, 0, &magic);
    let crc = checksum(&image[..N - 4]);
    put(&mut image, N - 4, &crc.to_le_bytes());
    image
}
