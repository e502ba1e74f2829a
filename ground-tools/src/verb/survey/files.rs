//! Maps of a survey in FITS, and what their files are called.

use crate::failure::Failure;
use crate::output::Sink;
use formats::fits::{Card, Column, MapHeader, Values, provenance_cards, write_maps};
use planner::healpix::{Nside, Ordering};
use planner::provenance::Provenance;
use planner::survey::{MapFrame, Moment, SurveyMaps};
use std::path::{Path, PathBuf};

/// How pixels of files are numbered, and in which frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    /// RING or NESTED.
    pub ordering: Ordering,
    /// Ecliptic or galactic.
    pub frame: MapFrame,
}

impl Layout {
    /// What a file of maps says of itself.
    pub(super) fn header(
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
/// [`Failure::Input`] names the path and what the system said.
pub(super) fn write_fits(
    sink: &Sink,
    maps: &SurveyMaps,
    layout: Layout,
    provenance: &Provenance,
    seen_by: &str,
) -> Result<(), Failure> {
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
    let header = layout.header((nside, "SURVEY"), (provenance, seen_by));
    sink.write_with(|out| write_maps(out, &header, &columns))
}

/// `maps.fits` with a part before its extension: `maps-1d.fits`.
#[must_use]
pub(super) fn beside(path: &Path, suffix: &str) -> PathBuf {
    let stem = path.file_stem().map_or(String::new(), |it| it.to_string_lossy().into_owned());
    let extension =
        path.extension().map_or(String::new(), |it| format!(".{}", it.to_string_lossy()));
    path.with_file_name(format!("{stem}{suffix}{extension}"))
}
