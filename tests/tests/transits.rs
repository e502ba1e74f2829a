//! The transit finder against an independent search for a fixed direction.

use onboard_core::ephemeris::EphemerisTable;
use onboard_core::field_of_view::FieldOfView;
use onboard_core::frame::Boresight;
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::sun::SunModel;
use onboard_core::time::Instant;
use onboard_core::transit::Channel;
use tests::{Plain, table, transits, turn_rate};

const YEAR_NS: u64 = 31_557_600_000_000_000;

fn circular_sun(longitude_deg: f64) -> SunModel<'static> {
    SunModel::Circular(Rotor {
        rate: turn_rate(YEAR_NS, 1),
        start: Phase::from_radians(longitude_deg.to_radians()),
    })
}

#[test]
// REQ-TRANSIT-1.
fn a_fixed_direction_for_a_year_matches_the_reference() {
    let text = include_str!("../data/transits.json");
    let reference: serde_json::Value = serde_json::from_str(text).unwrap();
    let expected = &reference["windows"]["std|L0_real|fixed lon210.5 lat0.3|1yr"];
    let (lon, lat) = (210.5_f64.to_radians(), 0.3_f64.to_radians());
    let direction = [lat.cos() * lon.cos(), lat.cos() * lon.sin(), lat.sin()];
    let bytes = table(1_000_000, 0, YEAR_NS, &[vec![direction]]);
    let target = EphemerisTable::parse(&bytes).unwrap().body(1_000_000).unwrap();
    let field =
        FieldOfView::circle(Rotation::<Boresight, Boresight>::IDENTITY, 0.5_f64.to_radians())
            .unwrap();
    let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(YEAR_NS as i64));
    let sun = circular_sun(191.375_794_289_018_01);
    let channel = Channel::new(&Plain::LITEBIRD.strategy(), sun, target, &field, span);
    let found = transits(&mut [channel]);
    assert_eq!(found.len() as u64, expected["n"].as_u64().unwrap());
    let mut total = 0.0;
    for transit in &found {
        total += transit.dwell().seconds();
    }
    assert!((total - expected["total_s"].as_f64().unwrap()).abs() < 1e-4, "{total}");
    for (transit, window) in found.iter().zip(expected["first50"].as_array().unwrap()) {
        let seconds = |at: Instant| at.tai_ns() as f64 * 1e-9;
        let (entry, exit) = (window[0].as_f64().unwrap(), window[1].as_f64().unwrap());
        assert!((seconds(transit.entry) - entry).abs() < 2e-6, "{entry}");
        assert!((seconds(transit.exit) - exit).abs() < 2e-6, "{exit}");
    }
}
