//! Writes `include/gyrfalcon.h` from the library's source, or with `--check` compares it with what is
//! there and answers 1 where it differs.

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let config = match cbindgen::Config::from_file(library.join("cbindgen.toml")) {
        Ok(config) => config,
        Err(error) => return failed(&error),
    };
    let sources = ["error", "clock", "tables", "slots", "flash", "scrub", "attitude"]
        .into_iter()
        .chain(["tracker", "transits", "forecast", "sequencer", "telemetry", "visits"]);
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in sources {
        builder = builder.with_src(library.join("src").join(source).with_extension("rs"));
    }
    let mut made = Vec::new();
    match builder.generate() {
        Ok(bindings) => bindings.write(&mut made),
        Err(error) => return failed(&error.to_string()),
    }
    let header = library.join("include/gyrfalcon.h");
    if std::env::args().any(|argument| argument == "--check") {
        return match std::fs::read(&header) {
            Ok(found) if found == made => ExitCode::SUCCESS,
            _ => {
                failed("include/gyrfalcon.h is not what the source says: run this without --check")
            }
        };
    }
    match std::fs::write(&header, made) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failed(&error.to_string()),
    }
}

fn failed(why: &str) -> ExitCode {
    eprintln!("header: {why}");
    ExitCode::FAILURE
}
