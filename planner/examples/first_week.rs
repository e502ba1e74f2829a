//! Prints the sessions of LiteBIRD's first week, one a line.
//!
//! `cargo run -p planner --example first_week`

use mission::{Mission, Override};
use planner::plan::{Revision, plan};
use planner::progress::Quietly;
use planner::time::format_utc;
use planner::world::World;

#[expect(clippy::print_stdout, reason = "an example shows its result")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let week = Override::set("span.duration_days=7")?;
    let world = World::open(Mission::load("litebird", &[week])?, None)?;
    let plan = plan(&world, &Revision::default(), &Quietly)?;
    for it in plan.sessions(&world)? {
        let (start, end, seen_s) = (format_utc(it.start), format_utc(it.end), it.dwell.seconds());
        println!("{} {} {} {start} {end} {seen_s}", it.id, it.target, it.telescope);
    }
    Ok(())
}
