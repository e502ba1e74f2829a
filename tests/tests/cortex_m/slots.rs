//! Images for the two slots: good, damaged, cut, older, expired; rollbacks; clock correlations.

use crate::input::{Input, sized};
use onboard_core::clock::ClockCorrelation;
use onboard_core::time::Instant;
use onboard_core::uplink::{
    Header, RollbackOrder, SectionKind, SessionRecord, Tables, WORD_BYTES, checksum,
};
use tests::Plain;
use tests::campaign::{ephemeris, sun, telescope};
use tests::uplink::{container, mission, plan};
use vectors::slots::SPACECRAFT;

const ROOM: usize = 1536;
/// More operations than any upload takes.
const ALL: u32 = 1000;
const NOW: i64 = 500;

fn image(sequence: u32, until: i64, sessions: usize) -> Vec<u8> {
    let at = Instant::from_tai_ns(1);
    let session = SessionRecord {
        start: at,
        end: at,
        first_entry: at,
        last_exit: at,
        body: 5,
        turn: 0,
        telescope: 0,
        passes: 1,
    };
    let header = Header {
        sequence,
        valid_from: Instant::from_tai_ns(0),
        valid_until: Instant::from_tai_ns(until),
        mission_digest: [sequence.to_le_bytes()[0]; 16],
        spacecraft: 1,
    };
    let contents: [(SectionKind, &[u8]); 3] = [
        (SectionKind::Ephemeris, &ephemeris()),
        (SectionKind::Mission, &mission(&Plain::LITEBIRD, sun(), &[telescope()])),
        (SectionKind::Plan, &plan(&vec![session; sessions])),
    ];
    container(&header, &contents)
}

/// A container of another spacecraft.
fn of_another() -> Vec<u8> {
    let mut bytes = image(6, 900, 0);
    bytes[56] ^= 1;
    let crc = checksum(&bytes[..60]);
    bytes[60..64].copy_from_slice(&crc.to_le_bytes());
    bytes
}

#[derive(Debug)]
struct Orders {
    images: Vec<Vec<u8>>,
    bytes: Vec<u8>,
}

impl Orders {
    fn order(&mut self, words: &[u32]) {
        self.bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    }

    /// Operations of an image's upload: the erase, its words, the COMMIT word.
    fn operations(&self, image: u32) -> u32 {
        2 + self.images[image as usize].len().div_ceil(WORD_BYTES) as u32
    }

    fn erase(&mut self, slot: u32) {
        self.order(&[0, slot]);
    }

    fn flip(&mut self, slot: u32, offset: u32, bits: u32) {
        self.order(&[1, slot, offset, bits]);
    }

    fn offer(&mut self, image: u32, now: i64, operations: u32) {
        self.order(&[2, image]);
        self.bytes.extend(now.to_le_bytes());
        self.order(&[operations]);
    }

    fn roll_back(&mut self, order: &[u8], now: i64, operations: u32) {
        self.order(&[3]);
        self.bytes.extend(order);
        self.bytes.extend(now.to_le_bytes());
        self.order(&[operations]);
    }

    fn correlate(&mut self, record: &[u8], counters: &[u64]) {
        self.order(&[4]);
        self.bytes.extend(record);
        self.order(&[counters.len() as u32]);
        self.bytes.extend(counters.iter().flat_map(|ticks| ticks.to_le_bytes()));
    }
}

/// Orders on slots that begin as ones.
pub fn block(input: &mut Input) {
    let mut damaged = image(4, 900, 0);
    damaged[200] ^= 4;
    let images = vec![
        image(1, 900, 0),
        image(2, 900, 0),
        image(3, 900, 0),
        damaged,
        image(5, NOW - 1, 0),
        image(6, 900, 0),
        vec![0x55; ROOM + 1],
        image(7, 900, 20),
        image(5000, 900, 0),
        of_another(),
    ];
    let mut orders = Orders { images, bytes: Vec::new() };
    uplinks(&mut orders);
    rollbacks(&mut orders);
    correlations(&mut orders);
    let mut block = (ROOM as u32).to_le_bytes().to_vec();
    block.extend((orders.images.len() as u32).to_le_bytes());
    for image in &orders.images {
        block.extend(sized(image));
    }
    block.extend(orders.bytes);
    input.block(7, "slots", &block);
}

fn uplinks(orders: &mut Orders) {
    orders.offer(1, NOW, ALL);
    orders.offer(0, NOW, ALL);
    // Cut uploads leave the other slot active; the last is whole.
    let whole = orders.operations(2);
    for operations in [0, 1, 2, 3, 5, whole - 2, whole - 1, whole] {
        orders.offer(2, NOW, operations);
    }
    for refused in [0, 2, 3, 4, 6, 7, 8, 9] {
        orders.offer(refused, NOW, ALL);
    }
    orders.offer(5, -1, ALL);
    for offset in [0, 9, 31, 32, 63, 64, 511, 512, 521, 524, 528, 572, 582, 642, 762] {
        for slot in [0, 1, 0, 1] {
            orders.flip(slot, offset, 0x10);
        }
    }
}

fn rollbacks(orders: &mut Orders) {
    orders.erase(0);
    orders.erase(1);
    orders.offer(1, NOW, ALL);
    orders.offer(2, NOW, ALL);
    let to_digest = Tables::load(&orders.images[1]).expect("a good image").set_digest();
    let order = RollbackOrder { from: 3, to: 2, to_digest, until: Instant::from_tai_ns(NOW + 100) };
    let good = order.to_le_bytes();
    let mut flipped = good;
    flipped[20] ^= 1;
    for bad in [
        flipped,
        [0; 40],
        RollbackOrder { to: 3, ..order }.to_le_bytes(),
        RollbackOrder { from: 9, ..order }.to_le_bytes(),
        RollbackOrder { to: 1, ..order }.to_le_bytes(),
        RollbackOrder { to_digest: to_digest ^ 1, ..order }.to_le_bytes(),
    ] {
        orders.roll_back(&bad, NOW, ALL);
    }
    orders.roll_back(&good, NOW + 101, ALL);
    orders.roll_back(&good, NOW, 0);
    orders.roll_back(&good, NOW, 1);
    orders.roll_back(&good, NOW, ALL);
    orders.offer(2, NOW, ALL);
    orders.offer(5, NOW, 3);
    orders.offer(2, NOW, ALL);
    orders.offer(5, NOW, ALL);
    let again = RollbackOrder { from: 6, ..order }.to_le_bytes();
    orders.roll_back(&again, NOW, ALL);
    orders.roll_back(&again, NOW, ALL);
}

fn correlations(orders: &mut Orders) {
    let record = ClockCorrelation {
        sequence: 3,
        spacecraft: SPACECRAFT,
        uncertainty_ns: 500,
        ticks: 1_000_000,
        at: Instant::from_tai_ns(5_000_000_000),
        tick_bits: ClockCorrelation::tick_of(1000, 0x1234_5678_9abc_def0),
        valid_from: Instant::from_tai_ns(0),
        valid_until: Instant::from_tai_ns(9_000_000_000_000),
    };
    let counters = [0, 1, 999_999, 1_000_001, 123_456_789, u64::MAX, u64::MAX / 2, 1 << 40];
    let good = record.to_le_bytes();
    let mut damaged = good;
    damaged[50] ^= 1;
    orders.correlate(&damaged, &[1_000_000]);
    orders.correlate(&[0; 72], &[]);
    orders.correlate(&good, &counters);
    orders.correlate(&good, &counters[..1]);
    orders.correlate(&ClockCorrelation { sequence: 2, ..record }.to_le_bytes(), &counters[..1]);
    orders.correlate(&ClockCorrelation { tick_bits: 0, sequence: 9, ..record }.to_le_bytes(), &[]);
    let other = ClockCorrelation { sequence: 4, spacecraft: SPACECRAFT + 1, ..record };
    orders.correlate(&other.to_le_bytes(), &[]);
    orders.correlate(&ClockCorrelation { sequence: u32::MAX, ..record }.to_le_bytes(), &[]);
    let slower = ClockCorrelation { sequence: 4, tick_bits: record.tick_bits * 7 + 3, ..record };
    orders.correlate(&slower.to_le_bytes(), &counters);
}
