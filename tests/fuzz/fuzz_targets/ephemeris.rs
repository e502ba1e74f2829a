//! See `fuzz::ephemeris`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| fuzz::ephemeris::run(data));
