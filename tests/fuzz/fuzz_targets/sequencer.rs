//! See `fuzz::sequencer`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| fuzz::sequencer::run(data));
