//! A file of payloads or packets, read from its front to its end.

use super::fault::{Fault, Found};
use super::row::Row;
use onboard_core::telemetry::{
    EVENT_BYTES, HOUSEKEEPING_BYTES, IDLE_APID, LAYOUT_VERSION, PACKET_HEADER_BYTES, PacketHeader,
    Payload, TelemetryError, payload_bytes,
};
use std::io::Read;
use std::sync::Arc;

/// Bytes of the longest packet.
const LONGEST: usize = PACKET_HEADER_BYTES + 65_536;
/// Bytes read at once.
const PIECE: usize = 1 << 18;

/// What is to be read of a file.
#[derive(Debug, Clone, Default)]
pub struct Wanted {
    /// The mission's spacecraft; another one's payload is refused.
    pub spacecraft: u32,
    /// The mission's telescopes, by index.
    pub telescopes: Arc<[String]>,
    /// The packets of this APID alone.
    pub apid: Option<u16>,
    /// Damage is passed over, and counted.
    pub skip_damaged: bool,
}

/// What was passed over.
#[derive(Debug, Default)]
pub struct Passed {
    /// Packets that are idle, or of another APID.
    pub packets: u64,
    /// Damaged places.
    pub damaged: u64,
    /// Their bytes.
    pub damaged_bytes: u64,
    /// The first of them.
    pub first: Option<Fault>,
}

/// The rows of a file, as they come.
#[derive(Debug)]
pub struct Reports<R> {
    source: R,
    wanted: Wanted,
    /// Bytes read and not yet looked at, from `at` on.
    held: Vec<u8>,
    at: usize,
    ended: bool,
    /// Bytes of the file before `at`.
    offset: u64,
    passed: Passed,
    /// Nothing more is read.
    over: bool,
}

/// What stands at a place.
enum Look {
    Row(Box<Row>, usize),
    Pass(usize),
}

impl<R: Read> Reports<R> {
    /// The rows of this file.
    pub const fn new(source: R, wanted: Wanted) -> Self {
        let passed = Passed { packets: 0, damaged: 0, damaged_bytes: 0, first: None };
        let held = Vec::new();
        Self { source, wanted, held, at: 0, ended: false, offset: 0, passed, over: false }
    }

    /// What was passed over so far.
    pub const fn passed(&self) -> &Passed {
        &self.passed
    }

    /// What was passed over, at the end.
    pub fn into_passed(self) -> Passed {
        self.passed
    }

    /// Holds the longest packet, or all that is left.
    fn fill(&mut self) -> std::io::Result<()> {
        if self.ended || self.held.len() - self.at >= LONGEST {
            return Ok(());
        }
        self.held.drain(..self.at);
        self.at = 0;
        let before = self.held.len();
        let room = (PIECE - before) as u64;
        self.ended = self.source.by_ref().take(room).read_to_end(&mut self.held)? == 0;
        Ok(())
    }

    fn take(&mut self, bytes: usize) {
        self.at += bytes;
        self.offset += bytes as u64;
    }

    fn step(&mut self) -> Result<Option<Row>, Found> {
        loop {
            self.fill()?;
            let rest = &self.held[self.at..];
            if rest.is_empty() {
                return Ok(None);
            }
            match look(rest, self.offset, &self.wanted) {
                Ok(Look::Row(row, bytes)) => {
                    self.take(bytes);
                    return Ok(Some(*row));
                }
                Ok(Look::Pass(bytes)) => {
                    self.passed.packets += 1;
                    self.take(bytes);
                }
                Err(found) if self.wanted.skip_damaged && !is_foreign(&found) => {
                    self.skip(found)?;
                }
                Err(found) => return Err(found),
            }
        }
    }

    /// On to the next whole payload.
    fn skip(&mut self, found: Found) -> Result<(), Found> {
        let from = self.offset;
        self.passed.damaged += 1;
        self.passed.first.get_or_insert(Fault { offset: from, found });
        loop {
            self.take(1);
            self.fill()?;
            let rest = &self.held[self.at..];
            let whole = match look(rest, self.offset, &self.wanted) {
                Ok(Look::Row(..)) => true,
                Ok(Look::Pass(_)) => false,
                Err(found) => is_foreign(&found),
            };
            if rest.is_empty() || whole {
                self.passed.damaged_bytes += self.offset - from;
                return Ok(());
            }
        }
    }
}

/// A whole payload, but another spacecraft's: no damage.
const fn is_foreign(found: &Found) -> bool {
    matches!(found, Found::Spacecraft { .. } | Found::Io(_))
}

impl<R: Read> Iterator for Reports<R> {
    type Item = Result<Row, Fault>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.over {
            return None;
        }
        let step = self.step();
        self.over = !matches!(step, Ok(Some(_)));
        step.map_err(|found| Fault { offset: self.offset, found }).transpose()
    }
}

/// What begins with the first of these bytes.
fn look(rest: &[u8], offset: u64, wanted: &Wanted) -> Result<Look, Found> {
    let needs = |needed: usize| {
        let left = rest.len();
        rest.get(..needed).ok_or(Found::End { needed, left })
    };
    let first = *needs(1)?.first().unwrap_or(&0);
    if first == LAYOUT_VERSION {
        let kind = needs(2)?[1];
        let size = payload_bytes(kind).ok_or(Found::Payload(TelemetryError::Kind(kind)))?;
        let row = row(needs(size)?, offset, (None, wanted))?;
        return Ok(Look::Row(Box::new(row), size));
    }
    if first >= 0x20 {
        return Err(Found::Neither(first));
    }
    let (bytes, _) = needs(PACKET_HEADER_BYTES)?
        .split_first_chunk()
        .ok_or(Found::End { needed: PACKET_HEADER_BYTES, left: rest.len() })?;
    let header = PacketHeader::from_be_bytes(*bytes).map_err(Found::Packet)?;
    let size = PACKET_HEADER_BYTES + usize::from(header.data_bytes_less_one) + 1;
    let data = &needs(size)?[PACKET_HEADER_BYTES..];
    let is_other = wanted.apid.is_some_and(|apid| apid != header.apid);
    if is_other || header.apid == IDLE_APID {
        return Ok(Look::Pass(size));
    }
    let payload = if header.secondary_header { behind(data) } else { data };
    let row = row(payload, offset, (Some(header), wanted))?;
    Ok(Look::Row(Box::new(row), size))
}

/// The payload at the end of a packet's data field, behind a secondary header.
fn behind(data: &[u8]) -> &[u8] {
    let ends = [EVENT_BYTES, HOUSEKEEPING_BYTES].into_iter().filter_map(|size| {
        let (_, end) = data.split_at_checked(data.len().checked_sub(size)?)?;
        let [first, kind] = *end.first_chunk()?;
        (first == LAYOUT_VERSION && payload_bytes(kind) == Some(size)).then_some(end)
    });
    ends.min_by_key(|end| Payload::from_be_bytes(end).is_err()).unwrap_or(data)
}

fn row(
    bytes: &[u8],
    offset: u64,
    (packet, wanted): (Option<PacketHeader>, &Wanted),
) -> Result<Row, Found> {
    let payload = Payload::from_be_bytes(bytes).map_err(Found::Payload)?;
    let found = payload.origin().spacecraft;
    if found != wanted.spacecraft {
        return Err(Found::Spacecraft { found, wanted: wanted.spacecraft });
    }
    // The core reads meanings; what it calls them are the numbers at these places.
    let signed = |at: usize| {
        let word = bytes.get(at..).and_then(|rest| rest.first_chunk());
        word.map_or(0, |word| i64::from_be_bytes(*word))
    };
    Ok(Row {
        offset,
        packet,
        payload,
        telescopes: wanted.telescopes.clone(),
        kind: bytes[1],
        state: bytes[25],
        reason: u16::from_be_bytes([bytes[26], bytes[27]]),
        values: [signed(32), signed(40)],
    })
}
