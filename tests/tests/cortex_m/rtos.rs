//! The flight core as tasks of RTIC (`tests/rtos`) reports on the emulated Cortex-M7 what the same
//! cycles report on the host, whatever its tasks interrupt.

#[path = "../../rtos/src/flight.rs"]
mod flight;

use crate::machine::{self, Core};
use crate::sequencer;
use crate::toolchain::Toolchain;
use flight::Cycle;
use libtest_mimic::Failed;
use onboard_core::uplink::Tables;
use std::fmt::Write;

/// What the flight prints, computed here.
fn on_the_host() -> Result<String, Failed> {
    let tables = Tables::load(sequencer::uplink()).expect("a good uplink");
    let mut told = String::new();
    let mut cycle = Cycle::new(tables).ok_or("the plan has no session")?;
    while let Some(ran) = cycle.run(&mut told) {
        ran?;
    }
    if told.matches("Started").count() == 0 {
        return Err("no session began".into());
    }
    let channel = flight::channel(&tables).ok_or("the plan's first target has no field")?;
    writeln!(told, "{:?}", flight::forecast(&channel))?;
    Ok(told)
}

/// Both print the same.
pub fn preempted_tasks_tell_the_same(tools: &Toolchain) -> Result<(), Failed> {
    let expected = on_the_host()?;
    let uplink = machine::work_folder().join("plan/uplink.tbl");
    let told = machine::run_alone(tools, Core::M7, "tests/rtos", &uplink)?;
    if told == expected { Ok(()) } else { Err(format!("{told}\non the host:\n{expected}").into()) }
}
