//! Kernels that are wrong: each refused with a sentence, and none a panic or a hang.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use ephem::kernel::{Kernel, KernelError};
use ephem::trajectory::Trajectory;
use onboard_core::time::Duration;

/// DE440 from 2032-04-01 to 2032-06-10, bodies 3, 4, 10, 301, 399, cut by jplephem 2.24.
const GOOD: &[u8] = include_bytes!("data/excerpt.bsp");
const SPACECRAFT: &[u8] = include_bytes!("data/burn.bsp");

const BODIES: [i32; 5] = [3, 4, 10, 301, 399];

fn said(bytes: &[u8]) -> String {
    Kernel::from_bytes("bad.bsp", bytes).unwrap_err().to_string()
}

fn with(offset: usize, bytes: &[u8]) -> Vec<u8> {
    let mut copy = GOOD.to_vec();
    copy[offset..offset + bytes.len()].copy_from_slice(bytes);
    copy
}

#[test]
fn refusals_say_what_is_wrong() {
    assert!(Kernel::from_bytes("good.bsp", GOOD).is_ok());
    for (bytes, expected) in [
        (Vec::new(), "too short to be an SPK: 0 bytes"),
        (b"hello ".repeat(400), "is not a SPICE DAF: it begins with 'hello he'"),
        (with(0, b"DAF/PCK "), "is a SPICE file of type 'DAF/PCK', not an SPK"),
        (with(0, b"NAIF/DAF"), "is a SPICE file of type 'NAIF/DAF'"),
        (with(88, b"BIG-IEEE"), "(ND, NI) is (33554432, 100663296); legal is (2, 6)"),
        (with(88, b"VAX-GFLT"), "unknown byte order 'VAX-GFLT'"),
        (with(705, b"\n"), "damaged by a transfer in text mode"),
        (with(8, &3_i32.to_le_bytes()), "(ND, NI) is (3, 6); legal is (2, 6)"),
        (with(76, &9_000_i32.to_le_bytes()), "first summary record's number is 9000"),
        (with(76, &(-1_i32).to_le_bytes()), "first summary record's number is -1"),
        (GOOD[..50_000].to_vec(), "is truncated: its data ends at byte"),
        (GOOD[..1_024].to_vec(), "is truncated: its data ends at byte"),
        (with(84, &0_i32.to_le_bytes()), "the first free address is 0"),
    ] {
        let said = said(&bytes);
        assert!(said.starts_with("the kernel 'bad.bsp' "), "{said}");
        assert!(said.contains(expected), "{said}");
    }
    let missing = Kernel::load("no/such/file.bsp").unwrap_err();
    assert!(missing.to_string().starts_with("cannot read the kernel 'no/such/file.bsp'"));
}

/// Offset of summary `index`: the chain begins at the record that the file record names.
fn summary(index: usize) -> usize {
    let forward = i32::from_le_bytes(GOOD[76..80].try_into().unwrap());
    (usize::try_from(forward).unwrap() - 1) * 1024 + 24 + 40 * index
}

#[test]
fn damaged_summaries_are_refused() {
    let control = summary(0) - 24;
    let record = 1.0 + f64::from(u32::try_from(control / 1024).unwrap());
    let nan = f64::NAN.to_le_bytes();
    for (bytes, expected) in [
        (with(control, &record.to_le_bytes()), "is damaged"),
        (with(control, &1e9_f64.to_le_bytes()), "next record of summary record"),
        (with(control, &nan), "next record of summary record"),
        (with(control + 8, &7_f64.to_le_bytes()), "previous record of summary record"),
        (with(control + 16, &26_f64.to_le_bytes()), "the number of summaries"),
        (with(control + 16, &2.5_f64.to_le_bytes()), "the number of summaries"),
        (with(control + 16, &0_f64.to_le_bytes()), "holds no segment"),
        (
            with(control + 16, &1_f64.to_le_bytes()),
            "lacks the Sun (NAIF 10), which every mission needs; it holds 3",
        ),
        (with(summary(1), &nan), "the coverage of segment 2"),
        (with(summary(0) + 16, &77_i32.to_le_bytes()), "lacks the Earth-Moon barycentre (NAIF 3)"),
        (with(summary(1) + 16, &5_i32.to_le_bytes()), "puts Jupiter"),
        (
            with(summary(1) + 20, &399_i32.to_le_bytes()),
            "gives Mars (NAIF 4) from the Earth (NAIF 399)",
        ),
        (with(summary(1) + 20, &2_i32.to_le_bytes()), "legal is one of NAIF 0, 10"),
        (with(summary(2) + 20, &10_i32.to_le_bytes()), "the centre is 10"),
        (with(summary(2) + 20, &301_i32.to_le_bytes()), "gives the Sun (NAIF 10) from the Moon"),
        (with(summary(2) + 24, &17_i32.to_le_bytes()), "SPICE frame 17"),
        (with(summary(2) + 28, &17_i32.to_le_bytes()), "SPK type 17: legal are 1, 2, 3"),
        (with(summary(2) + 28, &21_i32.to_le_bytes()), "in segment 3 (body 10)"),
        (with(summary(2) + 28, &13_i32.to_le_bytes()), "in segment 3 (body 10)"),
        (with(summary(3) + 32, &1_i32.to_le_bytes()), "the first address of segment 4"),
        (with(summary(3) + 32, &i32::MAX.to_le_bytes()), "the addresses of segment 4"),
        (with(summary(3) + 36, &i32::MAX.to_le_bytes()), "truncated: segment 4 ends at byte"),
        (with(summary(3) + 36, &(-5_i32).to_le_bytes()), "the addresses of segment 4"),
    ] {
        let said = said(&bytes);
        assert!(said.contains(expected), "{expected}: {said}");
    }
}

#[test]
fn a_missing_target_is_named_on_use() {
    let kernel = Kernel::from_bytes("good.bsp", GOOD).unwrap();
    let at = kernel.coverage(3).unwrap().0;
    let error = kernel.state(8, at).unwrap_err().to_string();
    assert_eq!(error, "the ephemeris holds no Neptune (NAIF 8)");
}

/// Refused, or every state where the good kernel has it; `limit` relative to the distance.
fn harmless(bytes: &[u8], good: &Kernel, limit: f64) -> Result<(), String> {
    let Ok(kernel) = Kernel::from_bytes("bad.bsp", bytes) else { return Ok(()) };
    for body in BODIES {
        let (start, end) = good.coverage(body).unwrap();
        let step = Duration::from_ns(end.since(start).ns() / 97);
        let mut at = start;
        while at <= end {
            let expected = good.state(body, at).unwrap();
            // A shortened coverage answers with an error, which is fair.
            if let Ok(state) = kernel.state(body, at) {
                let moved = (state.position_km - expected.position_km).norm();
                if moved.is_nan() || moved > limit * expected.position_km.norm() + 1e-3 {
                    return Err(format!("body {body} moved by {moved} km"));
                }
            }
            at = at.plus(step);
        }
    }
    Ok(())
}

#[test]
fn a_flipped_bit_is_refused_or_harmless() {
    let good = Kernel::from_bytes("good.bsp", GOOD).unwrap();
    let mut copy = GOOD.to_vec();
    // Every bit of the file record's fields and of the summaries, then a sample of the data.
    let heads = (0..96).chain(699..727).chain(summary(0) - 24..summary(5));
    let bits = heads.flat_map(|byte| (0..8).map(move |bit| (byte, bit)));
    let data = (summary(0) + 2048 - 24..GOOD.len()).flat_map(|byte| {
        // Eight bits of every 29th byte.
        (0..8).filter(move |_| byte % 29 == 0).map(move |bit| (byte, bit))
    });
    let mut refused = 0;
    for (byte, bit) in bits.chain(data) {
        copy[byte] ^= 1 << bit;
        // Thrice what the joints let pass.
        harmless(&copy, &good, 3e-10).unwrap_or_else(|why| panic!("byte {byte} bit {bit}: {why}"));
        refused += usize::from(Kernel::from_bytes("bad.bsp", &copy).is_err());
        copy[byte] ^= 1 << bit;
    }
    assert!(refused > 3000, "{refused}");
}

#[test]
fn every_truncation_is_refused() {
    for length in (0..GOOD.len()).step_by(97).chain([GOOD.len() - 1, GOOD.len() - 8]) {
        assert!(Kernel::from_bytes("cut.bsp", &GOOD[..length]).is_err(), "{length}");
    }
}

#[test]
fn a_damaged_spacecraft_file_never_panics() {
    let kernel = Kernel::embedded();
    let good = Trajectory::from_spk("good.bsp", SPACECRAFT, None).unwrap();
    let (start, end) = good.coverage().unwrap();
    let mut copy = SPACECRAFT.to_vec();
    for byte in (0..SPACECRAFT.len()).filter(|byte| *byte < 100 || byte % 7 == 0) {
        for bit in [0, 4, 7] {
            copy[byte] ^= 1 << bit;
            if let Ok(trajectory) = Trajectory::from_spk("bad.bsp", &copy, None) {
                for part in 0..5 {
                    let ns = end.since(start).ns() / 4 * part;
                    let _ = trajectory.state(&kernel, start.plus(Duration::from_ns(ns)));
                }
            }
            copy[byte] ^= 1 << bit;
        }
    }
    for length in (0..SPACECRAFT.len()).step_by(61) {
        let cut = Trajectory::from_spk("cut.bsp", &SPACECRAFT[..length], None);
        // A file padded with zeros to a whole record may lose some of the padding.
        assert!(cut.is_err() || length > SPACECRAFT.len() - 1024, "{length}");
    }
}

#[test]
fn a_wrong_record_is_named() {
    // A coefficient of the Sun's third record, changed by a part in 1e6.
    let kernel_error = {
        let first = i32::from_le_bytes(GOOD[summary(2) + 32..summary(2) + 36].try_into().unwrap());
        let offset = (usize::try_from(first).unwrap() - 1 + 2 * 35 + 2) * 8;
        let value = f64::from_le_bytes(GOOD[offset..offset + 8].try_into().unwrap());
        Kernel::from_bytes("bad.bsp", &with(offset, &(value * (1.0 + 1e-6)).to_le_bytes()))
    };
    let error = kernel_error.unwrap_err();
    assert!(matches!(error, KernelError::Spk { .. }));
    assert!(error.to_string().contains("in segment 3 (body 10), records 2 and 3 are"), "{error}");
}
