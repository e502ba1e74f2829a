//! See `fuzz::telemetry`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| fuzz::telemetry::run(data));
