//! Pictures of a survey's maps.

use crate::failure::Failure;
use crate::output::figures::{Figure, write_figures};
use formats::survey::name;
use onboard_core::direction::Direction;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::frame::Ecliptic;
use onboard_core::time::{Duration, Instant};
use pictures::{ColourMap, Range, Scale, SkyMap, SkyPicture, Track, View, sky_picture};
use planner::healpix::Ordering;
use planner::survey::{MapFrame, SurveyMaps};
use std::path::Path;

/// Which pictures are asked for, and where they go.
#[derive(Debug, Clone)]
pub(super) struct Pictures<'p> {
    /// Folders of PNG and of SVG files.
    pub folders: [Option<&'p Path>; 2],
    /// Patches beside the whole sky, with what their file's name says.
    pub patches: Vec<(String, View)>,
    /// Lines of the targets over the map.
    pub tracks: Vec<(String, Vec<(f64, f64)>)>,
    /// Colours by logarithm.
    pub log: bool,
}

impl Pictures<'_> {
    /// Writes the pictures of a map; `suffix` ends their names. Returns the files' names.
    ///
    /// # Errors
    /// [`Failure`] names the folder and what the system said.
    pub(super) fn write(
        &self,
        maps: &SurveyMaps,
        frame: MapFrame,
        (title, suffix): (&str, &str),
    ) -> Result<Vec<String>, Failure> {
        if self.folders.iter().all(Option::is_none) {
            return Ok(Vec::new());
        }
        let mut figures: Vec<Figure> = Vec::new();
        #[expect(clippy::cast_precision_loss, reason = "a colour")]
        let hits = |pixel: u32| match maps.hits(pixel) {
            0 => f64::NAN,
            hits => hits as f64,
        };
        self.draw(maps, frame, ("hits", "hits", title), suffix, &hits, &mut figures)?;
        for (index, &moment) in maps.moments().iter().enumerate() {
            let square =
                |pixel: u32| maps.h(pixel, index).map_or(f64::NAN, |(re, im)| re * re + im * im);
            let file = format!("h_{}_{}", moment.n(), moment.m());
            let quantity = format!("|h|\u{b2} {}", name(moment));
            self.draw(maps, frame, (&file, &quantity, title), suffix, &square, &mut figures)?;
        }
        write_figures(self.folders, &figures)
    }

    fn draw(
        &self,
        maps: &SurveyMaps,
        frame: MapFrame,
        (file, quantity, title): (&str, &str, &str),
        suffix: &str,
        values: &(dyn Fn(u32) -> f64 + Sync),
        figures: &mut Vec<Figure>,
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
            let stem = format!("{file}{name}{suffix}");
            figures.push(Figure { stem, drawing: sky_picture(&map, &picture)? });
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
    frame: MapFrame,
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
