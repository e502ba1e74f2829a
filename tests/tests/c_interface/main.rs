//! A C99 program that flies a day over the C interface tells the words that Rust computes, on the
//! host and on an emulated Cortex-M7; and every code of the header stands in the docs.
//!
//! The library is built as an integrator builds it, the program `onboard-core/c/examples` with
//! `-Wall -Wextra -pedantic -Werror`. Without the target's tools its test is ignored, with the command
//! that brings them.

mod build;
mod codes;
mod day;
mod flash;
mod teller;
#[expect(dead_code, reason = "its linker is the firmware's; the C compiler links here")]
#[path = "../cortex_m/toolchain.rs"]
mod toolchain;

use libtest_mimic::{Arguments, Failed, Trial};
use std::path::Path;
use std::sync::{Arc, OnceLock};
use toolchain::Toolchain;

fn main() {
    let tools = Arc::new(Toolchain::find().and_then(|tools| Ok((build::compiler()?, tools))));
    let missing = tools.as_ref().as_ref().err().cloned();
    let on_target = Trial::test("the_c_day_on_a_cortex_m7_has_rusts_words", move || {
        let (compiler, tools) = tools.as_ref().as_ref()?;
        same_words("files-cortex-m7", |folder| build::run_on_cortex_m7(compiler, tools, folder))
    })
    .with_ignored_flag(missing.is_some());
    let on_target = match missing {
        Some(_) => on_target.with_kind(toolchain::HOW_TO_ENABLE),
        None => on_target,
    };
    let trials = vec![
        on_target,
        Trial::test("the_c_day_on_the_host_has_rusts_words", || {
            same_words("files-host", build::run_on_the_host)
        }),
        Trial::test("a_wrong_word_is_named", a_wrong_word_is_named),
        Trial::test("the_docs_have_every_code_of_the_header", codes::documented),
        Trial::test("the_docs_have_every_states_words", codes::words),
        Trial::test("what_the_pages_name_is_in_the_header", codes::named),
        Trial::test("codes_are_written_once", codes::unique),
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}

/// Runs the day in a folder that holds its files, and compares what it tells with Rust's.
fn same_words(
    folder_name: &str,
    run: impl Fn(&Path) -> Result<String, Failed>,
) -> Result<(), Failed> {
    static FLOWN: OnceLock<Result<day::Flown, String>> = OnceLock::new();
    let flown = FLOWN.get_or_init(day::fly);
    let flown = flown.as_ref()?;
    let folder = build::folder(folder_name)?;
    for (name, bytes) in build::FILES.into_iter().zip(&flown.files) {
        std::fs::write(folder.join(name), bytes)?;
    }
    compare(&run(&folder)?, &flown.told)?;
    println!("{} words as in Rust", flown.told.lines().count());
    Ok(())
}

/// The first line that differs, with its number.
fn compare(told: &str, expected: &str) -> Result<(), String> {
    let mut number = 0;
    let (mut told, mut expected) = (told.lines(), expected.lines());
    loop {
        number += 1;
        match (told.next(), expected.next()) {
            (None, None) => return Ok(()),
            (found, wanted) if found == wanted => {}
            (found, wanted) => return Err(format!("line {number}: {found:?}, in Rust {wanted:?}")),
        }
    }
}

fn a_wrong_word_is_named() -> Result<(), Failed> {
    let same = "spin 0000000000000001\nspin 0000000000000002\n";
    compare(same, same)?;
    for (told, line) in [
        ("spin 0000000000000001\nspin 0000000000000003\n", "line 2"),
        ("spin 0000000000000001\n", "line 2"),
        ("spun 0000000000000001\nspin 0000000000000002\n", "line 1"),
    ] {
        let Err(said) = compare(told, same) else { return Err(format!("{told} passed").into()) };
        if !said.starts_with(line) {
            return Err(said.into());
        }
    }
    Ok(())
}
