//! Maps of a survey as FITS: hits and cross-link moments, written and read, or I, Q and U.
//!
//! Who looked stands in `DETECTOR`, where the maps come from in the provenance's cards.

use crate::error::WriteError;
use crate::fits::{
    self, Card, Column, FitsFileError, Frames, MapHeader, Polcconv, Values, provenance_cards,
    read_columns, write_maps,
};
use planner::harmonics::Complex64;
use planner::healpix::{Nside, Ordering};
use planner::mapmaking::StokesMaps;
use planner::provenance::Provenance;
use planner::survey::{MapFrame, Moment, SurveyMaps};
use planner::systematics::Residual;
use std::io::Write;
use std::path::Path;

/// How pixels of files are numbered, and in which frame.
#[derive(Debug, Clone, Copy)]
pub struct Layout {
    /// RING or NESTED.
    pub ordering: Ordering,
    /// Ecliptic or galactic.
    pub frame: MapFrame,
}

impl Layout {
    /// What a file of maps says of itself.
    fn header(
        self,
        (nside, name): (Nside, &str),
        (provenance, seen_by): (&Provenance, &str),
    ) -> MapHeader {
        let mut cards = provenance_cards(provenance);
        cards.push(Card::text("DETECTOR", seen_by, "who looked"));
        MapHeader {
            nside,
            ordering: self.ordering,
            frame: self.frame.into(),
            name: name.to_owned(),
            polcconv: None,
            cards,
        }
    }
}

/// A moment in a column's name: letters, digits and underscores; M for minus, P for the point.
fn column_name(moment: Moment, part: &str) -> String {
    let order = |x: f64| x.to_string().replace('-', "M").replace('.', "P");
    format!("H_{}_{}_{part}", order(moment.n()), order(moment.m()))
}

/// Orientation functions out of a file, RING order.
#[derive(Debug, Clone, PartialEq)]
pub struct OrientationMaps {
    /// Resolution.
    pub nside: Nside,
    /// Frame of the map.
    pub frame: MapFrame,
    /// Samples by pixel.
    pub hits: Vec<u64>,
    /// h of each moment asked for, NaN where unobserved.
    pub functions: Vec<Vec<Complex64>>,
}

/// Reads the hits and the moments asked for out of a file as [`write_survey`] writes it. Of (n, m) and
/// (-n, -m) either will do.
///
/// # Errors
/// [`FitsFileError`] with the path and the columns that are missing, or what is wrong with the file.
pub fn read_orientations(
    path: &Path,
    moments: &[Moment],
) -> Result<OrientationMaps, FitsFileError> {
    let frames =
        Frames { accepted: &[fits::MapFrame::Ecliptic, fits::MapFrame::Galactic], unsaid: None };
    let parts = ["RE", "IM"];
    let either: Vec<[String; 2]> = moments
        .iter()
        .flat_map(|&moment| {
            let other = Moment::new(0.0 - moment.n(), 0.0 - moment.m()).unwrap_or(moment);
            parts.map(|part| [moment, other].map(|it| column_name(it, part)))
        })
        .collect();
    let names: Vec<[&str; 2]> = either.iter().map(|[own, other]| [&own[..], other]).collect();
    let wanted: Vec<&[&str]> =
        [&["HITS"][..]].into_iter().chain(names.iter().map(|it| &it[..])).collect();
    let fits::Columns { nside, ordering, frame, columns } = read_columns(path, &wanted, frames)?;
    let places: Vec<usize> = (0..nside.pixels())
        .map(|ring| nside.numbered(ordering, nside.nested_of_ring(ring)) as usize)
        .collect();
    let mut columns = columns.into_iter();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
    let count = |hits: f64| hits.max(0.0) as u64;
    let hits = columns.next().map(|(_, values)| values).unwrap_or_default();
    let hits = places.iter().map(|&at| count(hits[at])).collect();
    let mut functions = Vec::new();
    for [own, _] in either.iter().step_by(2) {
        let [Some((name, re)), Some((_, im))] = [columns.next(), columns.next()] else { break };
        // h of (-n, -m) is the conjugate of h of (n, m).
        let sign = if name.eq_ignore_ascii_case(own) { 1.0 } else { -1.0 };
        functions.push(places.iter().map(|&at| Complex64::new(re[at], sign * im[at])).collect());
    }
    Ok(OrientationMaps { nside, frame: frame.into(), hits, functions })
}

/// Three columns of one moment, by pixel in the file's order.
type MomentColumns<'v> = [Box<dyn Fn(u32) -> f64 + 'v>; 3];

/// Writes hits, then abs(h)^2, real and imaginary part of each moment.
///
/// # Errors
/// What `out` failed with.
pub fn write_survey(
    out: &mut dyn Write,
    maps: &SurveyMaps,
    layout: Layout,
    origin: (&Provenance, &str),
) -> Result<(), WriteError> {
    let nside = maps.nside();
    let nested = |pixel: u32| nside.nested(layout.ordering, pixel);
    let hits = |pixel: u32| i64::try_from(maps.hits(nested(pixel))).unwrap_or(i64::MAX);
    let part = |index: usize, value: fn((f64, f64)) -> f64| {
        move |pixel: u32| maps.h(nested(pixel), index).map_or(f64::NAN, value)
    };
    let moments: Vec<MomentColumns<'_>> = (0..maps.moments().len())
        .map(|index| -> MomentColumns<'_> {
            [
                Box::new(part(index, |(re, im)| re * re + im * im)),
                Box::new(part(index, |(re, _)| re)),
                Box::new(part(index, |(_, im)| im)),
            ]
        })
        .collect();
    let names: Vec<[String; 3]> = maps
        .moments()
        .iter()
        .map(|&moment| ["ABS2", "RE", "IM"].map(|part| column_name(moment, part)))
        .collect();
    let mut columns =
        vec![Column { name: "HITS", unit: "samples", values: Values::Integer(&hits) }];
    for (names, values) in names.iter().zip(&moments) {
        for (name, values) in names.iter().zip(values) {
            columns.push(Column { name, unit: "", values: Values::Double(values) });
        }
    }
    let header = layout.header((nside, "SURVEY"), origin);
    write_maps(out, &header, &columns)
}

/// Writes I, Q and U with the condition and the hits of each pixel.
///
/// # Errors
/// What `out` failed with.
pub fn write_stokes(
    out: &mut dyn Write,
    maps: &StokesMaps,
    (nside, layout): (Nside, Layout),
    origin: (&Provenance, &str),
) -> Result<(), WriteError> {
    let nested = |pixel: u32| nside.nested(layout.ordering, pixel) as usize;
    let ([i, q, u], condition) = (maps.iqu(), maps.condition());
    let i = |pixel: u32| i[nested(pixel)];
    let q = |pixel: u32| q[nested(pixel)];
    let u = |pixel: u32| u[nested(pixel)];
    let condition = |pixel: u32| condition[nested(pixel)];
    let hits = |pixel: u32| i64::try_from(maps.hits()[nested(pixel)]).unwrap_or(i64::MAX);
    let columns = [
        Column { name: "I_STOKES", unit: "", values: Values::Double(&i) },
        Column { name: "Q_STOKES", unit: "", values: Values::Double(&q) },
        Column { name: "U_STOKES", unit: "", values: Values::Double(&u) },
        Column { name: "CONDITION", unit: "", values: Values::Double(&condition) },
        Column { name: "HITS", unit: "samples", values: Values::Integer(&hits) },
    ];
    let header = layout.header((nside, "STOKES"), origin);
    let header = MapHeader { polcconv: Some(Polcconv::Cosmo), ..header };
    write_maps(out, &header, &columns)
}

/// Writes what a systematic effect leaves: dI, dQ and dU, COSMO sense, uK of the CMB; RING order, no
/// value where a pixel has no solution.
///
/// # Errors
/// What `out` failed with.
pub fn write_residual(
    out: &mut dyn Write,
    residual: &Residual,
    frame: MapFrame,
    origin: (&Provenance, &str),
) -> Result<(), WriteError> {
    let i = |pixel: u32| residual.intensity[pixel as usize];
    let q = |pixel: u32| residual.polarisation[pixel as usize].re;
    let u = |pixel: u32| residual.polarisation[pixel as usize].im;
    let columns = [
        Column { name: "I_STOKES", unit: "uK_CMB", values: Values::Double(&i) },
        Column { name: "Q_STOKES", unit: "uK_CMB", values: Values::Double(&q) },
        Column { name: "U_STOKES", unit: "uK_CMB", values: Values::Double(&u) },
    ];
    let layout = Layout { ordering: Ordering::Ring, frame };
    let header = layout.header((residual.nside(), "RESIDUAL"), origin);
    let header = MapHeader { polcconv: Some(Polcconv::Cosmo), ..header };
    write_maps(out, &header, &columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_come_back_from_their_file() {
        let nside = Nside::new(2).unwrap();
        let path = std::env::temp_dir().join(format!("orientations-{}.fits", std::process::id()));
        let header = MapHeader {
            nside,
            ordering: Ordering::Nested,
            frame: fits::MapFrame::Galactic,
            name: "SURVEY".to_owned(),
            polcconv: None,
            cards: Vec::new(),
        };
        let hits = |pixel: u32| i64::from(pixel % 5);
        let re = |pixel: u32| f64::from(pixel);
        let im = |pixel: u32| -f64::from(pixel) / 3.0;
        let columns = [
            Column { name: "HITS", unit: "", values: Values::Integer(&hits) },
            Column { name: "H_2_M4_RE", unit: "", values: Values::Double(&re) },
            Column { name: "H_2_M4_IM", unit: "", values: Values::Double(&im) },
            Column { name: "H_M1_4_RE", unit: "", values: Values::Double(&re) },
            Column { name: "H_M1_4_IM", unit: "", values: Values::Double(&im) },
        ];
        let mut file = std::fs::File::create(&path).unwrap();
        write_maps(&mut file, &header, &columns).unwrap();
        let moment = |n: f64, m: f64| Moment::new(n, m).unwrap();
        let found = read_orientations(&path, &[moment(2.0, -4.0), moment(1.0, -4.0)]).unwrap();
        let refused = read_orientations(&path, &[moment(3.0, -4.0)]).unwrap_err().to_string();
        std::fs::remove_file(&path).unwrap();
        assert_eq!((found.frame, found.nside), (MapFrame::Galactic, nside));
        let value = |pixel: u32| Complex64::new(f64::from(pixel), -f64::from(pixel) / 3.0);
        for ring in 0..48 {
            let nested = nside.nested_of_ring(ring);
            let at = ring as usize;
            assert_eq!(found.hits[at], u64::from(nested % 5));
            assert_eq!(found.functions[0][at], value(nested));
            // (1, -4) is the conjugate of (-1, 4), and so on.
            assert_eq!(found.functions[1][at], value(nested).conj());
        }
        assert!(refused.contains("has no column H_3_M4_RE or H_M3_4_RE"), "{refused}");
    }
}
