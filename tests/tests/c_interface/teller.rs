//! What a day tells: a line with a name and a word each, and the codes of the header.

use onboard_core::sequencer::{SafeReason, SkipReason, State};
use onboard_core::transit::Transit;
use std::fmt::Write;

#[derive(Default)]
pub struct Teller(pub String);

impl Teller {
    pub fn word(&mut self, name: &str, word: u64) {
        writeln!(self.0, "{name} {word:016x}").expect("a String takes everything");
    }

    pub fn integer(&mut self, name: &str, value: i64) {
        self.word(name, value as u64);
    }

    pub fn real(&mut self, name: &str, value: f64) {
        self.word(name, value.to_bits());
    }

    pub fn reals(&mut self, name: &str, values: impl IntoIterator<Item = f64>) {
        values.into_iter().for_each(|value| self.real(name, value));
    }

    /// A record, four bytes a word.
    pub fn record(&mut self, name: &str, bytes: &[u8]) {
        for word in bytes.as_chunks::<4>().0 {
            self.word(name, u32::from_le_bytes(*word).into());
        }
    }

    pub fn transit(&mut self, transit: &Transit) {
        self.word("channel", transit.channel as u64);
        self.integer("entry", transit.entry.tai_ns());
        self.integer("closest", transit.closest.tai_ns());
        self.integer("exit", transit.exit.tai_ns());
        self.real("separation", transit.min_separation_rad);
        let clipped = u64::from(transit.entry_clipped) * 2 + u64::from(transit.exit_clipped);
        self.word("clipped", clipped);
    }

    pub fn state(&mut self, state: State) {
        let (kind, session, reason, value) = match state {
            State::Idle => (1, 0, 0, 0),
            State::Setup(session) => (2, session, 0, 0),
            State::Calibrating(session) => (3, session, 0, 0),
            State::Cooldown(session) => (4, session, 0, 0),
            State::Safe(why) => {
                let (reason, value) = safe(why);
                (5, 0, reason, value)
            }
        };
        self.word("state", kind);
        self.word("state's session", session.into());
        self.word("state's reason", reason);
        self.integer("state's value", value);
    }
}

/// The code and the value of a reason; the flight meets few of them.
pub fn safe(reason: SafeReason) -> (u64, i64) {
    match reason {
        SafeReason::Boot => (167, 0),
        SafeReason::TablesDamaged => (168, 0),
        SafeReason::Commanded => (160, 0),
        SafeReason::NoClock => (161, 0),
        SafeReason::NoTables => (162, 0),
        SafeReason::TablesNotYetValid(from) => (163, from.tai_ns()),
        SafeReason::TablesExpired(until) => (164, until.tai_ns()),
        other => panic!("not on this flight: {other:?}"),
    }
}

pub fn skip(reason: SkipReason) -> (u64, i64) {
    match reason {
        SkipReason::Missed => (180, 0),
        SkipReason::Overlap => (181, 0),
        SkipReason::NotChecked => (182, 0),
        SkipReason::NoPass => (183, 0),
        SkipReason::Entry(by) => (184, by.ns()),
        SkipReason::Exit(by) => (185, by.ns()),
        SkipReason::Passes(number) => (186, number.into()),
        SkipReason::Avoidance(body) => (187, body.into()),
        SkipReason::Uncertain(by) => (188, by.ns()),
        other => panic!("not on this flight: {other:?}"),
    }
}
