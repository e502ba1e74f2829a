//! Maps and coefficients against healpy's, at the numbers of `reference/healpy.csv`.

use super::{Alm, Complex64, Rings, SpinAlm};
use crate::healpix::Nside;
use std::collections::BTreeMap;

const REFERENCE: &str = include_str!("reference/healpy.csv");

struct Row {
    what: &'static str,
    /// Pixel, or l and m.
    at: [usize; 2],
    value: Complex64,
}

/// By nside, degree and spin.
fn rows() -> BTreeMap<[usize; 3], Vec<Row>> {
    let mut to = BTreeMap::<_, Vec<Row>>::new();
    for line in REFERENCE.lines().filter(|line| !line.starts_with('#')) {
        let cells: Vec<&'static str> = line.split(',').collect();
        let whole = |at: usize| cells[at].parse::<usize>().unwrap();
        let value = Complex64::new(cells[6].parse().unwrap(), cells[7].parse().unwrap());
        let row = Row { what: cells[0], at: [whole(4), whole(5)], value };
        to.entry([whole(1), whole(2), whole(3)]).or_default().push(row);
    }
    to
}

fn number(x: usize) -> f64 {
    f64::from(u32::try_from(x).unwrap())
}

fn coefficients(l_max: usize, spin: usize, k: f64) -> Alm {
    let mut alm = Alm::zero(l_max);
    for l in spin..=l_max {
        for m in 0..=l {
            let (l_f, m_f) = (number(l), number(m));
            let re = (1.3 * l_f + 0.7 * m_f * m_f + k).cos();
            let im = if m > 0 { (2.1 * l_f * m_f + 0.2 * k + 0.3).sin() } else { 0.0 };
            alm.set(l, m, Complex64::new(re, im) / (1.0 + l_f));
        }
    }
    alm
}

#[test]
fn maps_and_coefficients_are_those_of_healpy() {
    let mut worst = [0.0_f64; 2];
    let mut count = 0;
    for ([side, l_max, spin], rows) in rows() {
        let rings = Rings::new(Nside::new(u32::try_from(side).unwrap()).unwrap());
        let e = coefficients(l_max, spin, 0.0);
        let map = if spin == 0 {
            rings.map(&SpinAlm::scalar(&e)).unwrap()
        } else {
            rings.map(&SpinAlm { spin, e, b: coefficients(l_max, spin, 1.0) }).unwrap()
        };
        let pixels: Vec<Complex64> = (0..map.len())
            .map(|p| {
                let im = if spin == 0 { 0.0 } else { (0.11 * number(p) + 0.5).sin() };
                Complex64::new((0.37 * number(p)).cos(), im)
            })
            .collect();
        let found = rings.alm(spin, &pixels, l_max, 0).unwrap();
        let sign = if spin == 0 { -1.0 } else { 1.0 };
        let iterated = || rings.alm(0, &pixels, l_max, 3).unwrap();
        let iterated = rows.iter().any(|row| row.what == "iterated").then(iterated);
        let size = map.iter().map(|value| value.norm()).fold(0.0, f64::max);
        for Row { what, at: [first, second], value } in rows {
            count += 1;
            if what == "map" {
                worst[0] = worst[0].max((map[first] - value).norm() / size);
                continue;
            }
            let alm = match what {
                "e" => &found.e,
                "b" => &found.b,
                _ => &iterated.as_ref().unwrap().e,
            };
            worst[1] = worst[1].max((alm.at(first, second) * sign - value).norm());
        }
    }
    assert!(count > 300, "{count}");
    assert!(worst[0] < 1e-12 && worst[1] < 1e-12, "{worst:?}");
}

#[test]
fn what_is_no_map_is_refused() {
    use super::TransformError;
    let rings = Rings::new(Nside::new(1).unwrap());
    let needed = TransformError::Pixels { found: 11, needed: 12 };
    assert_eq!(rings.scalar_alm(&[0.0; 11], 2, 0), Err(needed));
    assert_eq!(rings.alm(17, &[Complex64::ZERO; 12], 2, 0), Err(TransformError::Spin(17)));
    assert_eq!(rings.scalar_alm(&[0.0; 12], 8193, 0), Err(TransformError::Degree(8193)));
    let uneven = SpinAlm { spin: 2, e: Alm::zero(2), b: Alm::zero(3) };
    assert_eq!(rings.map(&uneven), Err(TransformError::Parts { e: 2, b: 3 }));
}
