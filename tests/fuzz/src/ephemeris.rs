//! The ephemeris section, without a container about it.

use onboard_core::ephemeris::{EphemerisError, EphemerisTable, HEADER_BYTES, Span};
use onboard_core::time::Instant;
use std::collections::BTreeSet;
use tests::Noise;

/// Most spans of a table that are looked into.
const SPANS: usize = 6;

/// Reads the bytes as a table.
pub fn run(data: &[u8]) {
    if let Ok(table) = EphemerisTable::parse(data) {
        let bodies = table.bodies().flat_map(|body| body.to_le_bytes());
        let spans = table.spans().flat_map(|span| span.to_le_bytes());
        let again: Vec<u8> = bodies.chain(spans).collect();
        assert_eq!(again, data[HEADER_BYTES..HEADER_BYTES + again.len()]);
        let counts = (table.bodies().count(), table.spans().count());
        assert_eq!(counts, (count_at(data, 0), count_at(data, 4)));
        check(table, data.len() as u64);
    }
}

fn count_at(data: &[u8], offset: usize) -> usize {
    data[offset..].first_chunk::<4>().map_or(0, |count| u32::from_le_bytes(*count) as usize)
}

/// These instants, one ns to either side, the ends of the scale, and some between.
#[must_use]
pub fn instants(edges: &[Instant], seed: u64) -> Vec<Instant> {
    let mut noise = Noise::new(seed);
    let mut ns = vec![i64::MIN, -1, 0, i64::MAX, noise.bits() as i64];
    for edge in edges {
        let edge = edge.tai_ns();
        ns.extend([edge.saturating_sub(1), edge, edge.saturating_add(1)]);
    }
    for pair in edges.windows(2) {
        let (low, high) = (pair[0].tai_ns(), pair[1].tai_ns());
        let length = i128::from(high) - i128::from(low);
        let within = i128::from(low) + ((length * i128::from(noise.bits() >> 32)) >> 32);
        ns.push(i64::try_from(within).unwrap_or(low));
    }
    ns.into_iter().map(Instant::from_tai_ns).collect()
}

/// Asks an accepted table for everything that it can answer.
pub fn check(table: EphemerisTable<'_>, seed: u64) {
    let spans: Vec<Span> = table.spans().collect();
    let bodies: BTreeSet<i32> = spans.iter().take(SPANS).map(|span| span.body).collect();
    for number in [i32::MIN, i32::MAX, 10].into_iter().filter(|it| !bodies.contains(it)) {
        assert_eq!(table.body(number).is_ok(), spans.iter().any(|span| span.body == number));
    }
    for number in bodies {
        let body = table.body(number).expect("a body that has spans");
        let own: Vec<&Span> = spans.iter().filter(|span| span.body == number).collect();
        let ends: Vec<Instant> = own
            .iter()
            .take(SPANS)
            .flat_map(|span| [span.start, span.end().expect("an end")])
            .collect();
        let (from, until) = body.coverage().expect("a coverage");
        assert!(from <= until);
        assert!(own.iter().all(|span| span.bounds.rate_rad_s <= body.bounds().rate_rad_s));
        for at in instants(&ends, seed) {
            let covered =
                own.iter().any(|span| span.start <= at && span.end().is_some_and(|end| at <= end));
            match body.state(at) {
                Ok(state) => {
                    assert!(covered, "an answer outside the spans, at {at:?}");
                    let [x, y, z] = state.direction.xyz();
                    let length = (x * x + y * y + z * z).sqrt();
                    assert!((length - 1.0).abs() < 1e-9, "a direction of length {length}");
                    assert!(state.rate_per_s.iter().all(|it| it.is_finite()), "{state:?}");
                }
                Err(error) => assert_eq!(error, EphemerisError::OutOfSpan(at)),
            }
        }
    }
}
