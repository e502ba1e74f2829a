//! The flight core on an emulated Cortex-M7 and M4F gives the host's bits, within its instructions.
//!
//! Each test builds `tests/firmware` for a core, runs it under QEMU on a vector file made here, runs
//! the same library on the host, and compares every word. Without the tools the tests are ignored,
//! with the command that brings them; `tests/firmware/README.md` says more.
//!
//! Requirements: REQ-CORE-2.

mod budget;
mod comparison;
mod input;
mod machine;
mod rtos;
mod sequencer;
mod services;
mod slots;
mod toolchain;

use libtest_mimic::{Arguments, Failed, Trial};
use machine::Core;
use std::sync::{Arc, OnceLock};
use toolchain::Toolchain;

/// Vectors of each preset and pair of rotation directions.
const PER_CASE: usize = 10_000;

fn main() {
    let tools = Arc::new(Toolchain::find());
    let sky = Arc::new(OnceLock::new());
    let missing = tools.as_ref().as_ref().err().cloned();
    let on_target = |name: &str, test: fn(&Toolchain, &input::Tables) -> Result<(), Failed>| {
        let (tools, sky) = (Arc::clone(&tools), Arc::clone(&sky));
        let run = move || test(tools.as_ref().as_ref()?, sky.get_or_init(input::Tables::fit));
        let trial = Trial::test(name, run).with_ignored_flag(missing.is_some());
        match &missing {
            Some(_) => trial.with_kind(toolchain::HOW_TO_ENABLE),
            None => trial,
        }
    };
    let trials = vec![
        Trial::test("one_flipped_bit_is_named", comparison::one_flipped_bit_is_named),
        Trial::test("the_vector_file_covers_what_it_must", input::covers_what_it_must),
        on_target("cortex_m7_has_the_hosts_bits", |tools, sky| {
            same_bits(tools, sky, Core::M7, PER_CASE)
        }),
        on_target("cortex_m4f_has_the_hosts_bits", |tools, sky| {
            same_bits(tools, sky, Core::M4F, PER_CASE)
        }),
        on_target("cortex_m7_built_for_size_has_the_hosts_bits", |tools, sky| {
            same_bits(tools, sky, Core::M7ForSize, PER_CASE)
        }),
        on_target("tasks_of_a_real_time_framework_tell_the_same", |tools, _| {
            rtos::preempted_tasks_tell_the_same(tools)
        }),
        on_target("instructions_are_within_their_budget", budget::instructions),
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}

/// Runs the vector file on a core and on the host.
fn same_bits(
    tools: &Toolchain,
    tables: &input::Tables,
    core: Core,
    per_case: usize,
) -> Result<(), Failed> {
    let input = input::vectors(tables, per_case);
    let output = machine::run(tools, core, &input, false)?;
    let same = comparison::compare(&input, &output)?;
    println!("{core:?}: {} items, {} words, all bits as on the host", same.items, same.words);
    Ok(())
}
