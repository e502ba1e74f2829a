//! Maps of a survey as FITS: hits and cross-link moments, or I, Q and U.
//!
//! Who looked stands in `DETECTOR`, where the maps come from in the provenance's cards.

use crate::error::WriteError;
use crate::fits::{Card, Column, MapHeader, Polcconv, Values, provenance_cards, write_maps};
use planner::healpix::{Nside, Ordering};
use planner::mapmaking::StokesMaps;
use planner::provenance::Provenance;
use planner::survey::{MapFrame, Moment, SurveyMaps};
use planner::systematics::Residual;
use std::io::Write;

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
