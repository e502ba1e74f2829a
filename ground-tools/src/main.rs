//! The `gyrfalcon` command.

use clap::{ColorChoice, Parser};
use ground_tools::cli::Cli;
use ground_tools::message::for_terminal;
use ground_tools::output::interrupt;
use ground_tools::verb;
use std::io::IsTerminal;
use std::process::ExitCode;

/// Exit code of an internal error.
const INTERNAL: u8 = 3;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(usage) => {
            // Help and version go to standard output with exit code 0, mistakes to standard error.
            let _ = usage.print();
            return ExitCode::from(if usage.use_stderr() { 2 } else { 0 });
        }
    };
    interrupt::install();
    let color = cli.shared.color;
    std::panic::set_hook(Box::new(move |panic| {
        report(color, &format!("internal error: {panic}\nplease report it with the command"));
    }));
    match std::panic::catch_unwind(|| verb::run(&cli)) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(failure)) => {
            report(color, &failure.to_string());
            ExitCode::from(failure.exit_code())
        }
        Err(_) => ExitCode::from(INTERNAL),
    }
}

#[expect(clippy::print_stderr, reason = "the place for errors")]
fn report(color: ColorChoice, message: &str) {
    let colored = match color {
        ColorChoice::Always => true,
        ColorChoice::Never => false,
        ColorChoice::Auto => {
            std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
        }
    };
    let label = if colored { "\x1b[1;31merror:\x1b[0m" } else { "error:" };
    eprintln!("{label} {}", for_terminal(message));
}
