//! At which instants: seconds on the scan clock, evenly spaced or one by one.

use crate::failure::Failure;
use clap::Args;
use mission::number::Number;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};
use onboard_core::time::Duration;

/// Instants of the mission.
#[derive(Debug, Clone, Args)]
pub struct InstantArgs {
    /// Seconds between instants on the scan clock, such as 0.05
    #[arg(long, value_name = "SECONDS", value_parser = step, conflicts_with = "at")]
    pub step: Option<Duration>,
    /// Elapsed seconds on the scan clock, such as 0,59.5,1234.567
    #[arg(long, value_name = "S1,S2,...", value_parser = elapsed, value_delimiter = ',')]
    pub at: Vec<Duration>,
}

impl InstantArgs {
    /// The elapsed times asked for, within a window of elapsed times.
    ///
    /// # Errors
    /// [`Failure::Input`] names the instant that lies beyond.
    pub fn within(
        &self,
        (from, until): (Duration, Duration),
    ) -> Result<impl Iterator<Item = Duration> + Clone + use<>, Failure> {
        if let Some(beyond) = self.at.iter().find(|elapsed| !(from..=until).contains(*elapsed)) {
            return Err(Failure::Input(format!(
                "--at {} lies beyond the mission: a number of seconds from {} to {} is needed (or a \
                 longer --duration)",
                beyond.seconds(),
                from.seconds(),
                until.seconds()
            )));
        }
        let at = self.at.clone();
        let step = self.step.map_or(0, Duration::ns);
        let stepped = if step > 0 { (until.ns() - from.ns()) / step + 1 } else { 0 };
        Ok(at
            .into_iter()
            .chain((0..stepped).map(move |index| Duration::from_ns(from.ns() + index * step))))
    }
}

/// Elapsed seconds, exact to the nanosecond.
fn elapsed(text: &str) -> Result<Duration, String> {
    let number = Number::parse(text).map_err(|error| error.to_string())?;
    let ns = number.exact() * BigRational::from_integer(1_000_000_000.into());
    if !ns.is_integer() || ns.is_negative() {
        return Err(format!("{text} s: a number from 0 with at most 9 decimals is needed"));
    }
    let ns = ns.numer().to_i64();
    ns.map(Duration::from_ns).ok_or_else(|| format!("{text} s: a number below 292 years is needed"))
}

/// The same, above zero.
fn step(text: &str) -> Result<Duration, String> {
    let step = elapsed(text)?;
    if step == Duration::ZERO { Err("a step above 0 s is needed".to_owned()) } else { Ok(step) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Cli, Verb};
    use clap::Parser;

    fn parse(arguments: &str) -> Result<Cli, String> {
        let words = std::iter::once("gyrfalcon").chain(arguments.split_whitespace());
        Cli::try_parse_from(words).map_err(|error| error.to_string())
    }

    #[test]
    fn elapsed_seconds_are_exact() {
        let at = |text: &str| match parse(&format!("pointing --at {text}"))?.verb {
            Verb::Pointing(arguments) => Ok(arguments.instants.at),
            _ => Err("another verb".to_owned()),
        };
        let times = at("0,59.5,94672799.947000001").unwrap();
        let expected = [0, 59_500_000_000, 94_672_799_947_000_001].map(Duration::from_ns);
        assert_eq!(times, expected);
        assert!(at("1.0000000001").unwrap_err().contains("with at most 9 decimals is needed"));
        assert!(at("1e12").unwrap_err().contains("below 292 years"));
        assert!(at("x").unwrap_err().contains("is not a number"));
        assert!(parse("pointing --step 0").unwrap_err().contains("a step above 0 s is needed"));
        assert!(parse("pointing --step 1 --at 2").is_err());
    }
}
