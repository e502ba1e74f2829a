//! Attitude, what a detector does on the sky, half-wave plates and phases.
//!
//! Block: a container (u32 bytes, then it), a detector (x y z w, f64), then instants (i64) to the end.

use crate::Malformed;
use crate::reader::Reader;
use crate::sink::Sink;
use crate::tables::Loaded;
use onboard_core::attitude::{attitude, sweep};
use onboard_core::frame::{Boresight, Detector};
use onboard_core::hwp::hwp_phase;

/// Evaluates at every instant, the Sun afresh each time.
///
/// # Errors
/// [`Malformed`] where the container does not load.
pub fn run(block: &mut Reader<'_>, sink: &mut impl Sink) -> Result<(), Malformed> {
    let loaded = Loaded::read(block.sized()?)?;
    let (scan, sun) = (loaded.mission.strategy(), loaded.sun()?);
    let detector = block.rotation::<Detector, Boresight>()?;
    while !block.is_empty() {
        let at = block.instant()?;
        sink.item(at.tai_ns());
        match attitude(&scan, &sun, at) {
            Ok(attitude) => sink.numbers(
                ["attitude.x", "attitude.y", "attitude.z", "attitude.w"],
                attitude.to_xyzw(),
            ),
            Err(error) => sink.text("attitude refused", &error),
        }
        match sweep(&scan, &sun, detector, at) {
            Ok(swept) => {
                sink.numbers(
                    ["detector.x", "detector.y", "detector.z", "detector.w"],
                    swept.attitude.to_xyzw(),
                );
                sink.numbers(["direction.x", "direction.y", "direction.z"], swept.direction.xyz());
                sink.number("psi", swept.crossing_angle_rad);
                sink.number("zeta", swept.scan_beam_angle_rad);
                sink.number("speed", swept.speed_rad_s);
            }
            Err(error) => sink.text("sweep refused", &error),
        }
        let (precession, spin) = scan.phases(at);
        sink.word("precession phase", precession.bits());
        sink.word("spin phase", spin.bits());
        for plate in loaded.mission.telescopes().filter_map(|telescope| telescope.hwp) {
            let phase = hwp_phase(&scan, plate, at);
            sink.word("hwp phase", phase.bits());
            sink.number("hwp angle", phase.radians());
        }
    }
    Ok(())
}
