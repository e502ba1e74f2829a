//! Instructions per operation against `tests/firmware/instructions.toml`.
//!
//! `SysTick` runs at 25 MHz; with one instruction per ns of the board's time a tick is 40
//! instructions, and a run repeats exactly. These are instructions, not cycles and not time.

use crate::input::{self, Tables};
use crate::machine::{self, Core};
use crate::toolchain::{Toolchain, root};
use libtest_mimic::Failed;
use std::collections::BTreeMap;

const PER_TICK: u64 = 40;

/// Runs the meter on both cores, prints what it finds, and fails above a budget.
pub fn instructions(tools: &Toolchain, tables: &Tables) -> Result<(), Failed> {
    let path = root().join("tests/firmware/instructions.toml");
    let recorded: toml::Table = std::fs::read_to_string(path)?.parse()?;
    let mut over = Vec::new();
    for (core, name) in [(Core::M7, "cortex-m7"), (Core::M4F, "cortex-m4f")] {
        for (operation, found) in measure(tools, tables, core)? {
            let entry = |key: &str| -> Result<u64, String> {
                recorded
                    .get(name)
                    .and_then(|core| core.get(operation)?.get(key)?.as_integer())
                    .and_then(|number| u64::try_from(number).ok())
                    .ok_or(format!("instructions.toml has no {name}.{operation}.{key}"))
            };
            let (budget, before) = (entry("budget")?, entry("recorded")?);
            let change = i128::from(found) - i128::from(before);
            println!(
                "{name:<10} {operation:<24} {found:>8} instructions, recorded {before} \
                 ({change:+}), budget {budget}"
            );
            if found > budget {
                over.push(format!("{name} {operation}: {found}, budget {budget}"));
            }
        }
    }
    if over.is_empty() { Ok(()) } else { Err(over.join("; ").into()) }
}

/// Instructions per operation, rounded up.
fn measure(
    tools: &Toolchain,
    tables: &Tables,
    core: Core,
) -> Result<BTreeMap<&'static str, u64>, Failed> {
    let output = machine::run(tools, core, &input::metered(tables), true)?;
    let words: Vec<u64> =
        output.as_chunks::<8>().0.iter().map(|bytes| u64::from_le_bytes(*bytes)).collect();
    let (measured, rest) = words.as_chunks::<3>();
    let [pointing, sweeping, step, parse, idle, checking, update] = measured else {
        return Err(format!("the meter wrote {} words", words.len()).into());
    };
    assert!(rest.is_empty());
    let mean = |[count, ticks, _]: &[u64; 3]| (ticks * PER_TICK).div_ceil(*count);
    Ok(BTreeMap::from([
        ("pointing", mean(pointing)),
        ("sweep", mean(sweeping)),
        ("transit-step-mean", mean(step)),
        // The clock may cut off up to one tick.
        ("transit-step-longest", (step[2] + 1) * PER_TICK),
        ("container-kib", mean(parse)),
        ("sequencer-idle", mean(idle)),
        ("sequencer-checking-mean", mean(checking)),
        ("sequencer-checking-longest", (checking[2] + 1) * PER_TICK),
        ("tracker-update", mean(update)),
    ]))
}
