//! The transit search over several channels, to its end.
//!
//! Block: a container (u32 bytes, then it), first and last instant of the search (i64), then channels
//! to the end: body i32, telescope's index u32, radius f64. A radius above 0 is that circle about the
//! telescope's line of sight; 0 is the telescope's own field of view.

use crate::Malformed;
use crate::reader::Reader;
use crate::sink::Sink;
use crate::tables::Loaded;
use heapless::Vec;
use onboard_core::field_of_view::FieldOfView;
use onboard_core::scan::ScanStrategy;
use onboard_core::transit::{Channel, Step, Transit, TransitFinder};

/// Most channels of a block.
pub const MAX_CHANNELS: usize = 16;

/// The channels of a block.
///
/// # Errors
/// [`Malformed`] where a channel cannot be, or there are too many.
pub fn channels<'a>(
    block: &mut Reader<'_>,
    loaded: &Loaded<'a>,
) -> Result<Vec<Channel<'a>, MAX_CHANNELS>, Malformed> {
    channels_of(&loaded.mission.strategy(), block, loaded)
}

/// The channels of a block, with another strategy than the mission's.
///
/// # Errors
/// [`Malformed`] where a channel cannot be, or there are too many.
pub fn channels_of<'a>(
    scan: &ScanStrategy,
    block: &mut Reader<'_>,
    loaded: &Loaded<'a>,
) -> Result<Vec<Channel<'a>, MAX_CHANNELS>, Malformed> {
    let times = (block.instant()?, block.instant()?);
    let sun = loaded.sun()?;
    let mut channels = Vec::new();
    while !block.is_empty() {
        let body = loaded.ephemeris.body(block.i32()?).map_err(|_| Malformed)?;
        let field = field(block, loaded)?;
        channels.push(Channel::new(scan, sun, body, &field, times)).map_err(|_| Malformed)?;
    }
    Ok(channels)
}

/// A field of view of a block: telescope's index and radius.
pub(crate) fn field(block: &mut Reader<'_>, loaded: &Loaded<'_>) -> Result<FieldOfView, Malformed> {
    let telescope = loaded.mission.telescopes().nth(block.index()?).ok_or(Malformed)?;
    let radius = block.f64()?;
    let field = if radius > 0.0 {
        FieldOfView::circle(telescope.rotation, radius)
    } else {
        telescope.field_of_view()
    };
    field.map_err(|_| Malformed)
}

/// Searches to the end; every transit, then the work done.
///
/// # Errors
/// [`Malformed`] where a channel cannot be made.
pub fn run(block: &mut Reader<'_>, sink: &mut impl Sink) -> Result<(), Malformed> {
    let loaded = Loaded::read(block.sized()?)?;
    search(&mut channels(block, &loaded)?, sink);
    Ok(())
}

/// Searches to the end.
pub(crate) fn search(channels: &mut [Channel<'_>], sink: &mut impl Sink) {
    let mut finder = TransitFinder::new(channels);
    let mut steps = 0;
    loop {
        steps += 1;
        match finder.step() {
            Step::Transit(transit) => write(&transit, sink),
            Step::Searched(_) => {}
            Step::Done => break,
            Step::Failed { channel, error } => {
                sink.integer("failed channel", i64::try_from(channel).unwrap_or(-1));
                sink.text("search refused", &error);
                break;
            }
        }
    }
    sink.item(0);
    sink.word("steps", steps);
    for channel in finder.channels() {
        sink.word("evaluations", channel.evaluations());
        // The saved state tells where each channel stands.
        sink.text("state", &channel.state());
    }
}

/// A transit's words.
pub(crate) fn write(transit: &Transit, sink: &mut impl Sink) {
    sink.item(transit.entry.tai_ns());
    sink.integer("channel", i64::try_from(transit.channel).unwrap_or(-1));
    sink.integer("entry", transit.entry.tai_ns());
    sink.integer("closest", transit.closest.tai_ns());
    sink.integer("exit", transit.exit.tai_ns());
    sink.number("least separation", transit.min_separation_rad);
    sink.word("entry clipped", transit.entry_clipped.into());
    sink.word("exit clipped", transit.exit_clipped.into());
}
