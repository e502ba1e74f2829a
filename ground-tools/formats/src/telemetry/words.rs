//! Words for the numbers of telemetry, as `docs/telemetry.md` lists them.

/// What a number of a reason is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Value {
    /// There is none.
    None,
    /// A count, an identity, a body or a span in ns.
    Number,
    /// An instant.
    Instant,
}

/// Kinds of payloads, by number.
pub const KINDS: [(u8, &str); 9] = [
    (1, "entered"),
    (2, "started"),
    (3, "ended"),
    (4, "skipped"),
    (5, "aborted"),
    (6, "safe"),
    (7, "tables"),
    (8, "time-jumped"),
    (16, "housekeeping"),
];

/// States, by number.
pub const STATES: [(u8, &str); 5] =
    [(1, "idle"), (2, "setup"), (3, "calibrating"), (4, "cooldown"), (5, "safe")];

/// Reasons, by number: the word, what the value is, what the second value is.
pub const REASONS: [(u16, &str, Value, Value); 37] = [
    (40, "ephemeris-length", Value::None, Value::None),
    (41, "ephemeris-span", Value::Number, Value::None),
    (42, "ephemeris-coefficient", Value::Number, Value::None),
    (43, "no-such-body", Value::Number, Value::None),
    (44, "out-of-span", Value::Instant, Value::None),
    (45, "ephemeris-body", Value::Number, Value::None),
    (110, "clock-not-a-correlation", Value::None, Value::None),
    (111, "clock-damaged", Value::None, Value::None),
    (112, "clock-illegal", Value::None, Value::None),
    (113, "clock-older", Value::Number, Value::Number),
    (114, "clock-not-yet-valid", Value::Instant, Value::None),
    (115, "clock-expired", Value::Instant, Value::None),
    (116, "clock-beyond-scale", Value::None, Value::None),
    (117, "clock-step-too-large", Value::Number, Value::Number),
    (118, "clock-other-spacecraft", Value::Number, Value::Number),
    (160, "commanded", Value::None, Value::None),
    (161, "no-clock", Value::None, Value::None),
    (162, "no-tables", Value::None, Value::None),
    (163, "tables-not-yet-valid", Value::Instant, Value::None),
    (164, "tables-expired", Value::Instant, Value::None),
    (165, "no-such-telescope", Value::None, Value::None),
    (166, "time-reversed", Value::Number, Value::None),
    (167, "boot", Value::None, Value::None),
    (168, "tables-damaged", Value::None, Value::None),
    (180, "missed", Value::None, Value::None),
    (181, "overlap", Value::None, Value::None),
    (182, "not-checked", Value::None, Value::None),
    (183, "no-pass", Value::None, Value::None),
    (184, "entry", Value::Number, Value::None),
    (185, "exit", Value::Number, Value::None),
    (186, "passes", Value::Number, Value::None),
    (187, "avoidance", Value::Number, Value::None),
    (188, "uncertain", Value::Number, Value::None),
    (200, "safe", Value::None, Value::None),
    (201, "tables", Value::None, Value::None),
    (202, "time-jumped", Value::None, Value::None),
    (203, "avoidance", Value::Number, Value::None),
];

/// The word of a number.
pub(super) fn word(words: &[(u8, &'static str)], number: u8) -> &'static str {
    words.iter().find(|it| it.0 == number).map_or("", |it| it.1)
}
