//! SPK segments of types 1, 18, 19 and 21, in either byte order, against SPICE.
//!
//! `modified_and_pieced.bsp` holds made-up difference lines and packets; `.csv` the states that
//! CSPICE N67 reads there.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use ephem::kernel::Kernel;
use ephem::time::from_tdb_ns;
use ephem::trajectory::Trajectory;

const LITTLE: &[u8] = include_bytes!("data/modified_and_pieced.bsp");
const STATES: &str = include_str!("data/modified_and_pieced.csv");
const RECORD: usize = 1024;

/// The same file as a big-endian machine writes it.
fn big_endian() -> Vec<u8> {
    let mut big = LITTLE.to_vec();
    let mut swap = |from: usize, width: usize| big[from..from + width].reverse();
    for at in [8, 12, 76, 80, 84] {
        swap(at, 4);
    }
    (0..3).for_each(|index| swap(RECORD + 8 * index, 8));
    for summary in 0..25 {
        let from = RECORD + 24 + 40 * summary;
        (0..2).for_each(|index| swap(from + 8 * index, 8));
        (0..6).for_each(|index| swap(from + 16 + 4 * index, 4));
    }
    (3 * RECORD..LITTLE.len()).step_by(8).for_each(|at| swap(at, 8));
    big[88..96].copy_from_slice(b"BIG-IEEE");
    big
}

fn rows() -> impl Iterator<Item = (i32, f64, [f64; 6])> {
    STATES.lines().skip(1).map(|line| {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |index: usize| fields[index].parse::<f64>().unwrap();
        (fields[0].parse().unwrap(), number(1), std::array::from_fn(|index| number(index + 2)))
    })
}

#[test]
fn states_are_those_that_spice_reads() {
    let kernel = Kernel::embedded();
    for bytes in [LITTLE.to_vec(), big_endian()] {
        let mut compared = 0;
        for (body, tdb_s, expected) in rows() {
            let trajectory = Trajectory::from_spk("types.bsp", &bytes, Some(body)).unwrap();
            let (start, end) = trajectory.coverage().unwrap();
            #[expect(clippy::cast_possible_truncation, reason = "times of a day in ns")]
            let at = from_tdb_ns((tdb_s * 1e9).round() as i64);
            if at < start || at > end {
                // A microsecond at each end is not used.
                continue;
            }
            let state = trajectory.state(&kernel, at).unwrap();
            let ([x, y, z, ..], [.., vx, vy, vz]) = (expected, expected);
            let off_km = (state.position_km - nalgebra::Vector3::new(x, y, z)).norm();
            let off_km_s = (state.velocity_km_s - nalgebra::Vector3::new(vx, vy, vz)).norm();
            // An instant is rounded to the ns: at 30 km/s that is 30 um.
            assert!(off_km < 1e-6 && off_km_s < 1e-11, "{body} at {tdb_s}: {off_km} {off_km_s}");
            compared += 1;
        }
        assert!(compared > 70, "{compared}");
    }
}
