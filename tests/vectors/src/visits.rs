//! Visits counted as a search finds them, with the confidence in each.
//!
//! Block: a container (u32 bytes, then it), a covariance (3 variances, 3 covariances, f64), ends of
//! the bins in seconds (dwell, revisit, gap: low and high f64; dwell linear, the others logarithmic),
//! then a search as in [`transits`]. A target is a channel.

use crate::Malformed;
use crate::reader::Reader;
use crate::sink::Sink;
use crate::tables::Loaded;
use crate::transits::{self, MAX_CHANNELS, channels};
use onboard_core::transit::{Confidence, Step, TransitFinder};
use onboard_core::uncertainty::ScanCovariance;
use onboard_core::visits::{Bins, Divisions, Histogram, Spacing, TargetVisits, VisitLog};

/// Bins of each histogram.
pub const BINS: usize = 12;

fn bins(spacing: Spacing, block: &mut Reader<'_>) -> Result<Bins, Malformed> {
    Bins::new(spacing, block.f64()?, block.f64()?).map_err(|_| Malformed)
}

/// Searches to the end; every transit with its confidence, then all counts.
///
/// # Errors
/// [`Malformed`] where something is illegal or the search fails.
pub fn run(block: &mut Reader<'_>, sink: &mut impl Sink) -> Result<(), Malformed> {
    let loaded = Loaded::read(block.sized()?)?;
    let covariance = ScanCovariance { variances: block.numbers()?, covariances: block.numbers()? };
    let divisions = Divisions {
        dwell: bins(Spacing::Linear, block)?,
        revisit: bins(Spacing::Logarithmic, block)?,
        gap: bins(Spacing::Logarithmic, block)?,
    };
    let mut memory = [TargetVisits::<BINS>::EMPTY; MAX_CHANNELS];
    let mut log = VisitLog::new(&divisions, &mut memory);
    let mut channels = channels(block, &loaded)?;
    let mut finder = TransitFinder::new(&mut channels);
    loop {
        match finder.step() {
            Step::Transit(transit) => {
                transits::write(&transit, sink);
                let channel = finder.channels().get(transit.channel).ok_or(Malformed)?;
                let confidence = channel.confidence(&transit, &covariance);
                write(&confidence.map_err(|_| Malformed)?, sink);
                // The second time it is refused.
                for _ in 0..2 {
                    sink.text("recorded", &log.record(transit.channel, &transit));
                }
            }
            Step::Searched(_) => {}
            Step::Done => break,
            Step::Failed { .. } => return Err(Malformed),
        }
    }
    let divisions = log.divisions();
    for index in 0..=BINS {
        for bins in [divisions.dwell, divisions.revisit, divisions.gap] {
            sink.number("bin's edge", bins.edge_s(index, BINS));
        }
    }
    for target in log.targets() {
        counts(target, sink);
    }
    Ok(())
}

fn write(confidence: &Confidence, sink: &mut impl Sink) {
    sink.numbers(
        ["entry sigma", "exit sigma", "closest sigma"],
        [confidence.entry_sigma_s, confidence.exit_sigma_s, confidence.closest_sigma_s],
    );
    sink.number("separation sigma", confidence.separation_sigma_rad);
    sink.number("probability", confidence.probability);
    sink.integer("earliest entry", confidence.earliest_entry.tai_ns());
    sink.integer("latest exit", confidence.latest_exit.tai_ns());
}

fn counts(target: &TargetVisits<BINS>, sink: &mut impl Sink) {
    sink.word("visits", target.visits.into());
    sink.word("clipped visits", target.clipped.into());
    sink.integer("dwell sum", target.dwell_sum.ns());
    sink.text("longest gap", &target.longest_gap);
    sink.text("last visit", &target.last);
    for Histogram { counts, under, over } in [target.dwell, target.revisit, target.gap] {
        sink.word("under", under.into());
        for count in counts {
            sink.word("bin", count.into());
        }
        sink.word("over", over.into());
    }
}
