//! Where every body of a table is, and how it moves.
//!
//! Block: a container (u32 bytes, then it), then instants (i64) to the end; some may lie outside the
//! table.

use crate::Malformed;
use crate::reader::Reader;
use crate::sink::Sink;
use crate::tables::Loaded;

/// Evaluates every body at every instant.
///
/// # Errors
/// [`Malformed`] where the container does not load.
pub fn run(block: &mut Reader<'_>, sink: &mut impl Sink) -> Result<(), Malformed> {
    let loaded = Loaded::read(block.sized()?)?;
    while !block.is_empty() {
        let at = block.instant()?;
        sink.item(at.tai_ns());
        for span in loaded.ephemeris.spans() {
            sink.integer("body", span.body.into());
            match loaded.ephemeris.body(span.body).and_then(|body| body.state(at)) {
                Ok(state) => {
                    sink.numbers(
                        ["direction.x", "direction.y", "direction.z"],
                        state.direction.xyz(),
                    );
                    sink.numbers(["rate.x", "rate.y", "rate.z"], state.rate_per_s);
                }
                Err(error) => sink.text("state refused", &error),
            }
        }
    }
    Ok(())
}
