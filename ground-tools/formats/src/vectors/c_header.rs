//! Test vectors as a C99 header.
//!
//! Floats are hexadecimal constants, which every C99 compiler reads to the bit; `gyrfalcon_bits` in
//! the header gives the bits of a double for comparison. Arrays are `static const`, each with its
//! count as a macro. Units, frames and signs stand in the header's comments.
//!
//! Limits: C has no empty arrays; one that would be has a row of zeros, and its count says 0.
//!
//! # Example
//! ```
//! use formats::vectors::{VectorSet, c_header};
//! use mission::{Mission, Override};
//! use planner::{opportunities::boresight, provenance::Provenance, time::Duration, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=1")?])?;
//! let world = World::open(mission, None)?;
//! let tables = world.tables(&world.ground_options())?;
//! let lines = [boresight(&world.mission)?];
//! let start = [Duration::ZERO];
//! let set = VectorSet::new(&world, tables.parse()?, &lines, start.into_iter())?;
//! let header = c_header::text(&set, &Provenance::of(&world));
//! assert!(header.contains("#define GYRFALCON_START_TAI_NS INT64_C(1017662367814344741)\n"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::{TransitVector, Vector, VectorSet};
use onboard_core::field_of_view::FieldShape;
use onboard_core::phase::{Phase, Rotor};
use planner::opportunities::SightLine;
use planner::provenance::Provenance;
use std::fmt::{self, Display, Write};

/// Error of an attitude computed by other f64 arithmetic from the same Sun direction, in radians.
pub const ANGLE_TOLERANCE_RAD: f64 = 1e-12;
/// Error of entry and exit computed by another search on the same table, in ns.
pub const EDGE_TOLERANCE_NS: i64 = 1_000_000;
/// Half a chord below which entry and exit are too ill-conditioned for that, in radians.
pub const GRAZING_RAD: f64 = 1e-5;

/// A double as a C99 constant, to the bit.
struct Hex(f64);

impl Display for Hex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bits = self.0.to_bits();
        let sign = if bits >> 63 == 1 { "-" } else { "" };
        let exponent = i64::try_from((bits >> 52) & 0x7ff).unwrap_or(0);
        let digits = format!("{:013x}", bits & ((1 << 52) - 1));
        let digits = digits.trim_end_matches('0');
        let point = if digits.is_empty() { "" } else { "." };
        match (exponent, digits) {
            (0, "") => write!(f, "{sign}0x0p+0"),
            (0, _) => write!(f, "{sign}0x0{point}{digits}p-1022"),
            _ => write!(f, "{sign}0x1{point}{digits}p{:+}", exponent - 1023),
        }
    }
}

/// A name as a C string.
struct Quoted<'t>(&'t str);

impl Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"")?;
        for byte in self.0.bytes() {
            match byte {
                b'"' | b'\\' | b'?' => write!(f, "\\{}", char::from(byte))?,
                b' '..=b'~' => write!(f, "{}", char::from(byte))?,
                // Three octal digits end the escape, whatever follows.
                _ => write!(f, "\\{byte:03o}")?,
            }
        }
        f.write_str("\"")
    }
}

/// Text within a comment: nothing in it opens or closes one, or splices lines.
fn in_comment(text: &str) -> String {
    let text = text.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?");
    text.chars().map(|c| if c.is_control() || c == '\\' { ' ' } else { c }).collect()
}

const UNITS: &str = " * Times are ns of TAI: tai_ns since 2000-01-01T12:00:00 TAI, elapsed_ns since the mission's start.
 * Angles are radians. Phases are binary fractions of a turn: 2^64 is one turn.
 * Quaternions are (x, y, z, w) and take components in the detector's frame to components in the
 * ecliptic of J2000 (ICRF turned about x by 84381.448 arcsec): v_ecliptic = q v_detector q*. They
 * are given with w >= 0; q and -q are the same attitude.
 * Frames: z of a detector is its line of sight, x its sensitive direction. z of the boresight is the
 * mission's line of sight, x points away from the spin axis, y along the nominal scan.
 * Scan chain: attitude = detector, R_y(beta), R_z(spin), R_y(alpha), R_z(precession), then the
 * anti-Sun frame at the instant: z from Sun to spacecraft, x ecliptic north made perpendicular to
 * it, y = z cross x. R_y turns z towards x, R_z turns x towards y.
 * psi = atan2(north, east) of the detector's x on the sky; zeta = atan2(v.x, v.y) of the velocity
 * of the line of sight in the detector's frame, orbital motion included; both in (-pi, pi].
 * Doubles are hexadecimal constants: they hold the reference's bits.
";

const TYPES: &str = "\
typedef struct {
    const char *telescope;         /* \"-\" for the mission boresight */
    const char *detector;          /* \"-\" for a telescope's own line of sight */
    double detector_in_boresight[4]; /* x, y, z, w: detector frame to boresight frame */
    int is_rectangle;              /* 0: circle */
    double field_rad[2];           /* circle: radius, 0; rectangle: width along y, height along x */
    int has_hwp;                   /* 0: hwp phases are 0 and mean nothing */
    uint64_t hwp_rate_high;        /* turns per ns, two's complement, upper 64 of 128 fraction bits */
    uint64_t hwp_rate_low;         /* the lower 64 */
    uint64_t hwp_start_phase;
} gyrfalcon_line;

typedef struct {
    int line;                      /* index into gyrfalcon_lines */
    int64_t tai_ns;
    int64_t elapsed_ns;
    double sun[3];                 /* unit vector from the Sun to the spacecraft, ecliptic */
    double q[4];                   /* x, y, z, w: detector to ecliptic */
    double direction[3];           /* line of sight, ecliptic */
    double psi_rad;
    double zeta_rad;
    double scan_speed_rad_s;       /* speed of the line of sight on the sky */
    uint64_t precession_phase;
    uint64_t spin_phase;
    uint64_t hwp_phase;
    uint64_t precession_count;     /* completed turns since the start */
    uint64_t spin_count;
} gyrfalcon_vector;

typedef struct {
    const char *target;
    int32_t body;                  /* its number in the uplink table */
    int line;                      /* index into gyrfalcon_lines */
    int64_t entry_tai_ns;          /* first instant inside */
    int64_t exit_tai_ns;           /* last instant inside */
    int64_t closest_tai_ns;        /* instant of smallest separation */
    double min_separation_rad;
    int entry_clipped;             /* 1: inside already at the mission's start */
    int exit_clipped;              /* 1: still inside at the mission's end */
} gyrfalcon_transit;

/* The bits of a double, for comparison to the bit. */
static inline uint64_t gyrfalcon_bits(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}
";

/// The header's text.
#[must_use]
pub fn text(set: &VectorSet<'_>, provenance: &Provenance) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write(&mut out, set, provenance);
    out
}

fn write(out: &mut String, set: &VectorSet<'_>, provenance: &Provenance) -> fmt::Result {
    writeln!(
        out,
        "/*\n * Test vectors for flight code: what the flight core of Gyrfalcon answers.\n *"
    )?;
    for (key, value) in provenance.lines() {
        writeln!(out, " * {key}: {}", in_comment(&value))?;
    }
    write!(out, " *\n{UNITS} */\n#ifndef GYRFALCON_VECTORS_H\n#define GYRFALCON_VECTORS_H\n\n")?;
    write!(out, "#include <stdint.h>\n#include <string.h>\n\n")?;
    writeln!(
        out,
        "/*\n * Suggested tolerances. With the same arithmetic (libm's, no contraction) all bits agree. Other\n * arithmetic: directions and attitudes, from the Sun's direction given here, to an angle; entries\n * and exits, on the same table, to a time where half the chord through the field exceeds GRAZING.\n */"
    )?;
    writeln!(out, "#define GYRFALCON_TOLERANCE_ANGLE_RAD {ANGLE_TOLERANCE_RAD:e}")?;
    writeln!(out, "#define GYRFALCON_TOLERANCE_EDGE_NS INT64_C({EDGE_TOLERANCE_NS})")?;
    writeln!(out, "#define GYRFALCON_GRAZING_RAD {GRAZING_RAD:e}\n")?;
    mission(out, set)?;
    writeln!(out, "{TYPES}")?;
    array(out, "line", set.lines.iter().map(line))?;
    let index = |telescope: &str, detector: &str| {
        let here = |it: &SightLine| it.telescope_name == telescope && it.detector_name == detector;
        set.lines.iter().position(here).unwrap_or(0)
    };
    array(
        out,
        "vector",
        set.vectors.iter().map(|it| vector(it, index(it.telescope, it.detector))),
    )?;
    let transits = set.transits.iter();
    array(out, "transit", transits.map(|it| transit(it, index(it.telescope, it.detector))))?;
    out.push_str("#endif\n");
    Ok(())
}

/// The scanning strategy as macros.
fn mission(out: &mut String, set: &VectorSet<'_>) -> fmt::Result {
    let parameters = set.world.scan.parameters();
    writeln!(
        out,
        "/*\n * The scanning strategy. A rate is in turns per ns, two's complement with 128 fraction bits, upper\n * and lower half: phase = start + (rate * elapsed_ns modulo 2^128) >> 64.\n */"
    )?;
    writeln!(out, "#define GYRFALCON_START_TAI_NS INT64_C({})", parameters.start.tai_ns())?;
    writeln!(out, "#define GYRFALCON_ALPHA_RAD {}", Hex(parameters.alpha_rad))?;
    writeln!(out, "#define GYRFALCON_BETA_RAD {}", Hex(parameters.beta_rad))?;
    for (name, rotor) in [("PRECESSION", parameters.precession), ("SPIN", parameters.spin)] {
        let [high, low, start] = halves(rotor);
        writeln!(out, "#define GYRFALCON_{name}_RATE_HIGH {high}")?;
        writeln!(out, "#define GYRFALCON_{name}_RATE_LOW {low}")?;
        writeln!(out, "#define GYRFALCON_{name}_START_PHASE {start}")?;
    }
    out.push('\n');
    Ok(())
}

/// A rate's upper and lower half and the start phase, as constants.
fn halves(rotor: Rotor) -> [String; 3] {
    let bits = rotor.rate.bits();
    let constant = |bits: u128| format!("UINT64_C({bits:#018x})");
    [constant(bits >> 64), constant(bits & u128::from(u64::MAX)), phase(rotor.start)]
}

fn phase(phase: Phase) -> String {
    format!("UINT64_C({:#018x})", phase.bits())
}

fn numbers<const N: usize>(values: [f64; N]) -> String {
    let all: Vec<String> = values.iter().map(|value| Hex(*value).to_string()).collect();
    format!("{{{}}}", all.join(", "))
}

/// An array with its count.
fn array(out: &mut String, name: &str, rows: impl ExactSizeIterator<Item = String>) -> fmt::Result {
    let count = rows.len();
    writeln!(out, "#define GYRFALCON_{}_COUNT {count}", name.to_uppercase())?;
    writeln!(out, "static const gyrfalcon_{name} gyrfalcon_{name}s[{}] = {{", count.max(1))?;
    if count == 0 {
        writeln!(out, "    {}", zero_row(name))?;
    }
    for row in rows {
        writeln!(out, "    {row},")?;
    }
    out.push_str("};\n\n");
    Ok(())
}

/// A whole row of zeros.
fn zero_row(name: &str) -> &'static str {
    if name == "vector" {
        "{0, 0, 0, {0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0}, 0, 0, 0, 0, 0, 0, 0, 0}"
    } else {
        "{\"\", 0, 0, 0, 0, 0, 0, 0, 0}"
    }
}

fn line(it: &SightLine) -> String {
    let (is_rectangle, field) = match it.field.shape() {
        FieldShape::Circle(radius) => (0, [radius, 0.0]),
        FieldShape::Rectangle { width_rad, height_rad } => (1, [width_rad, height_rad]),
    };
    let plate = it.hwp.map_or_else(|| ["0", "0", "0"].map(str::to_owned), halves);
    format!(
        "{{{}, {}, {}, {is_rectangle}, {}, {}, {}}}",
        Quoted(&it.telescope_name),
        Quoted(&it.detector_name),
        numbers(it.rotation.to_xyzw()),
        numbers(field),
        i32::from(it.hwp.is_some()),
        plate.join(", ")
    )
}

fn vector(it: &Vector<'_>, line: usize) -> String {
    let [precession, spin] = [it.precession_phase, it.spin_phase].map(phase);
    let hwp = it.hwp_phase.map_or_else(|| "0".to_owned(), phase);
    format!(
        "{{{line}, INT64_C({}), INT64_C({}), {}, {}, {}, {}, {}, {}, {precession}, {spin}, {hwp}, \
         UINT64_C({}), UINT64_C({})}}",
        it.tai_ns,
        it.elapsed_ns,
        numbers([it.sun_x, it.sun_y, it.sun_z]),
        numbers([it.q_x, it.q_y, it.q_z, it.q_w]),
        numbers([it.x, it.y, it.z]),
        Hex(it.psi_rad),
        Hex(it.zeta_rad),
        Hex(it.scan_speed_rad_s),
        it.precession_count,
        it.spin_count
    )
}

fn transit(it: &TransitVector<'_>, line: usize) -> String {
    format!(
        "{{{}, {}, {line}, INT64_C({}), INT64_C({}), INT64_C({}), {}, {}, {}}}",
        Quoted(it.target),
        it.body,
        it.entry_tai_ns,
        it.exit_tai_ns,
        it.closest_tai_ns,
        Hex(it.min_separation_rad),
        i32::from(it.entry_clipped),
        i32::from(it.exit_clipped)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubles_are_written_to_the_bit() {
        for (value, text) in [
            (0.0, "0x0p+0"),
            (-0.0, "-0x0p+0"),
            (1.0, "0x1p+0"),
            (-0.1, "-0x1.999999999999ap-4"),
            (3.0, "0x1.8p+1"),
            (f64::MIN_POSITIVE / 2.0, "0x0.8p-1022"),
            (f64::MAX, "0x1.fffffffffffffp+1023"),
        ] {
            assert_eq!(Hex(value).to_string(), text);
        }
    }

    #[test]
    fn names_are_harmless() {
        assert_eq!(Quoted("a\"b\\?\u{e9}1").to_string(), "\"a\\\"b\\\\\\?\\303\\2511\"");
        assert_eq!(in_comment("a */ b /* c \\\n"), "a * / b / * c   ");
    }
}
