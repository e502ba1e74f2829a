//! What a survey leaves behind: maps in FITS, pictures.

use crate::failure::Failure;
use crate::output::{Sink, write_folder};
use crate::picture::{
    ColourMap, Drawing, Range, Scale, SkyMap, SkyPicture, Track, View, sky_picture,
};
use formats::fits::{Card, Column, MapHeader, Values, provenance_cards, write_maps};
use formats::survey::name;
use onboard_core::direction::Direction;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::frame::Ecliptic;
use onboard_core::time::{Duration, Instant};
use planner::healpix::Ordering;
use planner::provenance::Provenance;
use planner::survey::{self, Moment, SurveyMaps};
use std::path::{Path, PathBuf};

/// How pixels of files are numbered, and in which frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    /// RING or NESTED.
    pub ordering: Ordering,
    /// Ecliptic or galactic.
    pub frame: survey::MapFrame,
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
    let mut cards = provenance_cards(provenance);
    cards.push(Card::text("DETECTOR", seen_by, "who looked"));
    let header = MapHeader {
        nside,
        ordering: layout.ordering,
        frame: layout.frame.into(),
        name: "SURVEY".to_owned(),
        polcconv: None,
        cards,
    };
    sink.write_with(|out| write_maps(out, &header, &columns))
}

/// Which pictures are asked for, and where they go.
#[derive(Debug, Clone)]
pub(super) struct Pictures {
    /// Folder of PNG files.
    pub png: Option<PathBuf>,
    /// Folder of SVG files.
    pub svg: Option<PathBuf>,
    /// Patches beside the whole sky, with what their file's name says.
    pub patches: Vec<(String, View)>,
    /// Lines of the targets over the map.
    pub tracks: Vec<(String, Vec<(f64, f64)>)>,
    /// Colours by logarithm.
    pub log: bool,
}

impl Pictures {
    /// Writes the pictures of a map; `suffix` ends their names. Returns the files' names.
    ///
    /// # Errors
    /// [`Failure`] names the folder and what the system said.
    pub(super) fn write(
        &self,
        maps: &SurveyMaps,
        frame: survey::MapFrame,
        (title, suffix): (&str, &str),
    ) -> Result<Vec<String>, Failure> {
        let mut written = Vec::new();
        if self.png.is_none() && self.svg.is_none() {
            return Ok(written);
        }
        let mut drawings: Vec<(String, Drawing)> = Vec::new();
        #[expect(clippy::cast_precision_loss, reason = "a colour")]
        let hits = |pixel: u32| match maps.hits(pixel) {
            0 => f64::NAN,
            hits => hits as f64,
        };
        self.draw(maps, frame, ("hits", "hits", title), suffix, &hits, &mut drawings)?;
        for (index, &moment) in maps.moments().iter().enumerate() {
            let square =
                |pixel: u32| maps.h(pixel, index).map_or(f64::NAN, |(re, im)| re * re + im * im);
            let file = format!("h_{}_{}", moment.n(), moment.m());
            let quantity = format!("|h|\u{b2} {}", name(moment));
            self.draw(maps, frame, (&file, &quantity, title), suffix, &square, &mut drawings)?;
        }
        for (folder, kind) in [(&self.png, "png"), (&self.svg, "svg")] {
            let Some(folder) = folder else { continue };
            let files = drawings
                .iter()
                .map(|(stem, drawing)| {
                    let bytes = if kind == "png" {
                        drawing.png()?
                    } else {
                        drawing.svg().as_bytes().to_vec()
                    };
                    Ok((format!("{stem}.{kind}"), bytes))
                })
                .collect::<Result<Vec<(String, Vec<u8>)>, Failure>>()?;
            let named: Vec<(&str, &[u8])> =
                files.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())).collect();
            write_folder(folder, &named)?;
            written.extend(files.iter().map(|(name, _)| folder.join(name).display().to_string()));
        }
        Ok(written)
    }

    fn draw(
        &self,
        maps: &SurveyMaps,
        frame: survey::MapFrame,
        (file, quantity, title): (&str, &str, &str),
        suffix: &str,
        values: &(dyn Fn(u32) -> f64 + Sync),
        drawings: &mut Vec<(String, Drawing)>,
    ) -> Result<(), Failure> {
        let map =
            SkyMap { nside: maps.nside(), ordering: Ordering::Nested, frame: frame.into(), values };
        let tracks: Vec<Track<'_>> =
            self.tracks.iter().map(|(name, points)| Track { name, points }).collect();
        let whole = (String::new(), View::WholeSky { longitude_rad: 0.0 });
        for (name, view) in std::iter::once(&whole).chain(&self.patches) {
            let picture = SkyPicture {
                title,
                quantity,
                unit: if file == "hits" { "samples" } else { "" },
                view: *view,
                width_px: if name.is_empty() { 1600 } else { 1000 },
                scale: if self.log { Scale::Log } else { Scale::Linear },
                range: Range::Percentiles(0.5, 99.5),
                colours: ColourMap::Viridis,
                tracks: &tracks,
            };
            drawings.push((format!("{file}{name}{suffix}"), sky_picture(&map, &picture)?));
        }
        Ok(())
    }
}

/// The targets' lines over a span: longitude and latitude in the map's frame.
#[must_use]
pub(super) fn tracks(
    table: EphemerisTable<'_>,
    targets: &[(String, i32)],
    (start, end): (Instant, Instant),
    frame: survey::MapFrame,
) -> Vec<(String, Vec<(f64, f64)>)> {
    const POINTS: i64 = 400;
    let to_map = frame.from_ecliptic();
    targets
        .iter()
        .filter_map(|(name, body)| {
            let body = table.body(*body).ok()?;
            let span = end.since(start).ns();
            let points = (0..=POINTS)
                .filter_map(|k| {
                    let at = start.plus(Duration::from_ns(span / POINTS * k));
                    let there: Direction<Ecliptic> = body.state(at).ok()?.direction;
                    let there = to_map.apply(there);
                    Some((there.longitude_rad(), there.latitude_rad()))
                })
                .collect();
            Some((name.clone(), points))
        })
        .collect()
}

/// `maps.fits` with a part before its extension: `maps-1d.fits`.
#[must_use]
pub(super) fn beside(path: &Path, suffix: &str) -> PathBuf {
    let stem = path.file_stem().map_or(String::new(), |it| it.to_string_lossy().into_owned());
    let extension =
        path.extension().map_or(String::new(), |it| format!(".{}", it.to_string_lossy()));
    path.with_file_name(format!("{stem}{suffix}{extension}"))
}
