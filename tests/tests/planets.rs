//! A forecast over five planets, from the first day of LiteBIRD's mission.

use ephem::apparent::Sky;
use ephem::fit::{FitOptions, fit};
use ephem::source::Source;
use ephem::time::parse_time;
use onboard_core::ephemeris::{EphemerisTable, SUN};
use onboard_core::field_of_view::FieldOfView;
use onboard_core::forecast::{Forecast, ForecastStep, NextVisit};
use onboard_core::frame::Boresight;
use onboard_core::rotation::Rotation;
use onboard_core::scan::{ScanParameters, ScanStrategy};
use onboard_core::sun::SunModel;
use onboard_core::time::Duration;
use onboard_core::transit::Channel;
use onboard_core::uncertainty::ScanCovariance;
use tests::Plain;

const DAY_NS: i64 = 86_400_000_000_000;

/// Steps until a forecast is done.
fn steps(channels: &mut [Channel<'_>], next: &mut [Option<NextVisit>]) -> u32 {
    let mut forecast = Forecast::new(channels, next);
    for steps in 1.. {
        match forecast.step(|_| ScanCovariance::ZERO) {
            ForecastStep::Found(_) | ForecastStep::Searched(_) => {}
            ForecastStep::Done => return steps,
            ForecastStep::Failed { channel, error } => panic!("channel {channel}: {error:?}"),
        }
    }
    0
}

#[test]
fn five_planets_take_as_many_steps_together_as_one_by_one() {
    let start = parse_time("2032-04-01T00:00:00 TDB").unwrap();
    let end = start.plus(Duration::from_ns(1096 * DAY_NS));
    let planets = ["mars", "jupiter", "saturn", "uranus", "neptune"].map(Source::by_name);
    let planets = planets.map(Result::unwrap);
    let fitted = fit(&Sky::from_l2(start), &planets, (start, end), &FitOptions::UPLINK).unwrap();
    let table = EphemerisTable::parse(&fitted.bytes).unwrap();
    let sun = SunModel::Table(table.body(SUN).unwrap());
    let parameters = ScanParameters { start, ..*Plain::LITEBIRD.strategy().parameters() };
    let scan = ScanStrategy::new(parameters).unwrap();
    let field =
        FieldOfView::circle(Rotation::<Boresight, Boresight>::IDENTITY, 0.5_f64.to_radians())
            .unwrap();
    let channel = |source: &Source| {
        let body = table.body(source.body()).unwrap();
        Channel::new(&scan, sun, body, &field, (start, end))
    };
    let mut channels: Vec<_> = planets.iter().map(channel).collect();
    let mut next = [None; 5];
    let alone: u32 = channels
        .clone()
        .iter_mut()
        .map(|channel| steps(std::slice::from_mut(channel), &mut [None]))
        .sum();
    let together = steps(&mut channels, &mut next);
    assert!(next.iter().all(Option::is_some));
    // Each forecast by itself has a last step that only says that it is done.
    assert_eq!(together, alone - 4);
    assert!(together < 400, "{together}");
}
