//! The flight core's transit search, step by step, as a flight computer would run it.
//!
//! `cargo run -p ground-tools --example next_transits`
//!
//! The ground fits the table of the Sun and Jupiter; what follows uses only `onboard-core`: a channel
//! in fixed memory, one bounded step at a time, a state that can be saved and resumed.

use mission::{Mission, Override};
use onboard_core::ephemeris::{EphemerisTable, SUN};
use onboard_core::field_of_view::FieldOfView;
use onboard_core::frame::Boresight;
use onboard_core::rotation::Rotation;
use onboard_core::sun::SunModel;
use onboard_core::transit::{Channel, Step, TransitFinder};
use planner::world::World;
use std::error::Error;

/// NAIF's number of Jupiter's barycentre.
const JUPITER: i32 = 5;

#[expect(clippy::print_stdout, reason = "an example shows its result")]
fn main() -> Result<(), Box<dyn Error>> {
    // Ground: a mission among the planets, and the table that goes on board.
    let month = Override::set("span.duration_days=30")?;
    let world = World::open(Mission::load("litebird", &[month])?, None)?;
    let tables = world.tables(&ephem::fit::FitOptions::UPLINK)?;

    // On board: the table is read in place.
    let table = EphemerisTable::parse(&tables.fitted.bytes).map_err(|e| format!("{e:?}"))?;
    let sun = SunModel::Table(table.body(SUN).map_err(|e| format!("{e:?}"))?);
    let jupiter = table.body(JUPITER).map_err(|e| format!("{e:?}"))?;
    let boresight = Rotation::<Boresight, Boresight>::IDENTITY;
    let field =
        FieldOfView::circle(boresight, 0.5_f64.to_radians()).map_err(|e| format!("{e:?}"))?;
    let span = (world.start, world.end);
    let mut channels = [Channel::new(&world.scan, sun, jupiter, &field, span)];
    let mut finder = TransitFinder::new(&mut channels);

    let (mut steps, mut found) = (0_u32, 0_u32);
    loop {
        steps += 1;
        match finder.step() {
            Step::Transit(transit) => {
                found += 1;
                println!(
                    "{}  {:.3} s  {:.4} deg",
                    ephem::time::format_utc(transit.entry),
                    transit.dwell().seconds(),
                    transit.min_separation_rad.to_degrees()
                );
            }
            Step::Searched(_) => {}
            Step::Done => break,
            Step::Failed { error, .. } => return Err(format!("{error:?}").into()),
        }
    }
    println!("{found} transits in {steps} steps");
    Ok(())
}
