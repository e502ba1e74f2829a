//! `gyrfalcon table clock`, `table rollback` and `table change`: the small records beside the container.

use super::container::{load, read};
use crate::cli::quantities::instant;
use crate::cli::{ClockArgs, SharedArgs};
use crate::failure::Failure;
use crate::output::Sink;
use crate::verb::asked::mission;
use crate::verb::told::tell;
use formats::sequence::number;
use formats::uplink::{sequence_told, spacecraft};
use mission::number::Number;
use mission::quantity;
use mission::rounding;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::ToPrimitive;
use onboard_core::clock::ClockCorrelation;
use onboard_core::time::Duration;
use onboard_core::uplink::{MissionChangeOrder, RollbackOrder, check_sequence};
use std::path::Path;

const CLOCK_FILE: &str = "clock.tbl";
const ROLLBACK_FILE: &str = "rollback.tbl";
const CHANGE_FILE: &str = "change.tbl";

/// Writes a clock correlation.
pub(super) fn clock(shared: &SharedArgs, arguments: &ClockArgs) -> Result<(), Failure> {
    let at = instant("--at", &arguments.at)?;
    let record = ClockCorrelation {
        sequence: number(arguments.sequence.sequence, arguments.sequence.after)
            .map_err(Failure::Input)?,
        spacecraft: spacecraft(&mission(shared)?),
        uncertainty_ns: arguments.uncertainty_ns,
        ticks: arguments.ticks,
        at,
        tick_bits: tick_bits(&arguments.tick_ns)?,
        valid_from: match &arguments.valid_from {
            Some(text) => instant("--valid-from", text)?,
            None => at,
        },
        valid_until: at.plus(span("--valid-for", &arguments.valid_for)?),
    };
    if record.valid_until < record.valid_from {
        return Err(Failure::Input(format!(
            "--valid-from {} lies behind the end of --valid-for {}: an earlier time is needed",
            arguments.valid_from.as_deref().unwrap_or(&arguments.at),
            arguments.valid_for
        )));
    }
    write(shared, CLOCK_FILE, &record.to_le_bytes())
}

/// Writes the order to return from the active container to an older one.
pub(super) fn rollback(
    shared: &SharedArgs,
    active: &Path,
    target_file: &Path,
    until: &str,
) -> Result<(), Failure> {
    let (active_bytes, target_bytes) = (read(active)?, read(target_file)?);
    let from = *load(active, &active_bytes)?.header();
    let target = load(target_file, &target_bytes)?;
    let to = *target.header();
    let until = instant("--until", until)?;
    if to.sequence >= from.sequence {
        return Err(Failure::Input(format!(
            "{} has sequence {}, {} has {}: a rollback leads to a smaller one",
            active.display(),
            from.sequence,
            target_file.display(),
            to.sequence
        )));
    }
    let order = RollbackOrder {
        from: from.sequence,
        to: to.sequence,
        to_digest: target.set_digest(),
        until,
    };
    write(shared, ROLLBACK_FILE, &order.to_le_bytes())
}

/// Writes the order to take another spacecraft's container.
pub(super) fn change(
    shared: &SharedArgs,
    active: &Path,
    new: &Path,
    until: &str,
) -> Result<(), Failure> {
    let (active_bytes, new_bytes) = (read(active)?, read(new)?);
    let from = *load(active, &active_bytes)?.header();
    let taken = load(new, &new_bytes)?;
    let to = *taken.header();
    let until = instant("--until", until)?;
    if to.spacecraft == from.spacecraft {
        return Err(Failure::Input(format!(
            "{} and {} are of the same spacecraft ({:08x}): no order is needed",
            active.display(),
            new.display(),
            to.spacecraft
        )));
    }
    check_sequence(to.sequence, Some(from.sequence))
        .map_err(|error| Failure::Input(format!("{}: {}", new.display(), sequence_told(error))))?;
    let order = MissionChangeOrder {
        from: from.spacecraft,
        to: to.spacecraft,
        sequence: to.sequence,
        set_digest: taken.set_digest(),
        until,
    };
    write(shared, CHANGE_FILE, &order.to_le_bytes())
}

fn write(shared: &SharedArgs, default: &str, bytes: &[u8]) -> Result<(), Failure> {
    let path = shared.out.clone().unwrap_or_else(|| default.into());
    let sink = Sink::at(&path);
    sink.write(bytes)?;
    if sink == Sink::Stdout {
        return Ok(());
    }
    tell(&format!("written to {}: {} bytes\n", path.display(), bytes.len()))
}

fn span(option: &str, text: &str) -> Result<Duration, Failure> {
    let seconds =
        quantity::seconds(text).map_err(|error| Failure::Input(format!("{option}: {error}")))?;
    rounding::duration(&seconds)
        .filter(|span| *span >= Duration::ZERO)
        .ok_or_else(|| Failure::Input(format!("{option} {text} is not legal: 0 to 292 years are")))
}

/// The nearest multiple of 2^-64 ns.
fn tick_bits(text: &str) -> Result<u128, Failure> {
    let refuse = |why: &str| Failure::Input(format!("--tick-ns {text} is not legal: {why}"));
    let number = Number::parse(text).map_err(|error| refuse(&error.to_string()))?;
    let scale = BigRational::from_integer(BigInt::from(1_u8) << 64_u32);
    match (number.exact() * scale).round().to_integer().to_u128() {
        Some(bits) if bits > 0 => Ok(bits),
        _ => Err(refuse(
            "a length above 0 and below 1.8e19 ns, such as 1000.0023 or \"1e9/65536\", is needed",
        )),
    }
}
