//! The firmware: reads `vectors.in` from the host, runs it, writes `vectors.out`.
//!
//! Exit codes: 0 done, 1 a fault or a panic, 2 a file cannot be used, 3 the input is malformed.

#![no_std]
#![no_main]

mod machine;

use machine::{Output, exit, memory, read_input, start_clock, ticks};
use vectors::run;

/// Called at reset, with a stack and the FPU on.
fn firmware() -> ! {
    let (input, scratch, buffer) = memory();
    let Some(input) = read_input(c"vectors.in", input) else { exit(2) };
    let Some(mut output) = Output::create(c"vectors.out", buffer) else { exit(2) };
    start_clock();
    let done = run(input, scratch, &ticks, &mut output);
    if !output.close() {
        exit(2);
    }
    exit(if done.is_ok() { 0 } else { 3 })
}
