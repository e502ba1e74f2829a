//! A beam's error map, its profile, and what cannot be told apart, as figures; the map as FITS.

use crate::failure::Failure;
use crate::output::figures::{Figure, write_figures};
use crate::output::{fill_folder, whole};
use formats::fits::{Image, Plane, provenance_cards, write_images};
use mission::number::Number;
use onboard_core::ephemeris::EphemerisTable;
use pictures::{
    Axis, Chart, Contours, Drawing, MatrixPicture, PlanePicture, Ring, Scale, Series, Shape, chart,
    matrix_picture, plane_picture,
};
use planner::information::{
    ANNULI, BeamMap, COUNT, Lesson, Parameter, REACH, SIDE, Teaching, beam_map, decibel, gaussian,
    inner_radius_fwhm,
};
use planner::provenance::Provenance;
use planner::world::World;
use std::path::Path;

/// Levels that rings and lines mark, in dB.
const MARKED: [(f64, &str); 3] = [(-3.0, "-3 dB"), (-20.0, "-20 dB"), (-30.0, "-30 dB")];

/// Writes the figures of the only look that was asked for.
pub(super) fn write(
    world: &World,
    teaching: &Teaching,
    table: EphemerisTable<'_>,
    folder: &Path,
) -> Result<(), Failure> {
    let Some(look) = teaching.looks.first() else { return Ok(()) };
    let map = beam_map(world, table, look, teaching.sessions.as_deref())?;
    let lesson = teaching.lesson(0);
    let fwhm_arcmin = look.receiver.fwhm_arcmin.as_ref().map_or(1.0, Number::to_f64);
    let key = look.key();
    let title = format!("{}: beam of {key}", world.mission.name);
    let drawn = [
        ("beam-map", map_picture(&map, fwhm_arcmin, &title)?),
        ("beam-profile", profile_chart(&lesson, fwhm_arcmin, &title)?),
        (
            "correlations",
            correlations(
                teaching,
                &format!("{}: correlations of errors of {key}", world.mission.name),
            )?,
        ),
    ];
    let stem = key.replace(|c: char| !c.is_ascii_alphanumeric() && !"._+-".contains(c), "-");
    let figures: Vec<Figure> = drawn
        .into_iter()
        .map(|(name, drawing)| Figure { stem: format!("{stem}-{name}"), drawing })
        .collect();
    write_figures([Some(folder), Some(folder)], &figures)?;
    let bytes = fits(&map, fwhm_arcmin, world)?;
    let name = format!("{stem}-beam-map.fits");
    fill_folder(folder, vec![(name.as_str(), whole(&bytes))])
}

fn cells(of: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    (0..SIDE * SIDE).map(|index| of(index % SIDE, index / SIDE)).collect()
}

fn map_picture(map: &BeamMap, fwhm_arcmin: f64, title: &str) -> Result<Drawing, Failure> {
    let values = cells(|column, row| {
        let level = decibel(map.error(column, row));
        if level.is_finite() { level } else { f64::NAN }
    });
    // Contours where the Gaussian beam is 10, 100, ... times its error: whole decades of the ratio.
    let ratio = cells(|column, row| {
        let (x, y) = (BeamMap::middle_fwhm(column), BeamMap::middle_fwhm(row));
        let ratio = (gaussian(x.hypot(y)) / map.error(column, row)).log10();
        if ratio.is_finite() { ratio } else { f64::NAN }
    });
    let most = ratio.iter().copied().filter(|it| it.is_finite()).fold(0.0, f64::max);
    let levels: Vec<f64> = (0..9_u8).map(f64::from).filter(|it| *it < most).collect();
    let times: Vec<String> = levels.iter().map(|it| format!("{}", 10_f64.powf(*it))).collect();
    let meaning = format!("Gaussian beam over its error: {}", times.join(", "));
    let rings: Vec<Ring<'_>> = MARKED
        .iter()
        .map(|(level, name)| Ring { radius: radius_at(*level) * fwhm_arcmin, name })
        .collect();
    Ok(plane_picture(&PlanePicture {
        title,
        quantity: "error of the response in a cell",
        unit: "dB",
        axes: ["x", "y"],
        axes_unit: "arcmin",
        half: REACH * fwhm_arcmin,
        values: &values,
        side: SIDE,
        contours: Some(Contours { values: &ratio, levels: &levels, meaning: &meaning }),
        rings: &rings,
    })?)
}

/// Where a Gaussian beam is at a level in dB, in full widths.
fn radius_at(level: f64) -> f64 {
    (level / 10.0 * 10_f64.ln() / (-4.0 * std::f64::consts::LN_2)).sqrt()
}

fn profile_chart(lesson: &Lesson, fwhm_arcmin: f64, title: &str) -> Result<Drawing, Failure> {
    let edge = |annulus: usize| inner_radius_fwhm(annulus) * fwhm_arcmin;
    let mut error = Vec::new();
    for annulus in 0..ANNULI {
        let level = decibel(lesson.profile.error(annulus));
        let level = if level.is_finite() { level } else { f64::NAN };
        let middle = 0.5 * (edge(annulus) + edge(annulus + 1));
        error.extend([edge(annulus), middle, edge(annulus + 1)].map(|at| (at, level)));
    }
    let reach = edge(ANNULI);
    let beam: Vec<(f64, f64)> = (0..=200_u8)
        .map(|n| {
            let part = f64::from(n) / 200.0;
            (reach * part, decibel(gaussian(REACH * part)))
        })
        .collect();
    let least = error.iter().map(|it| it.1).filter(|it| it.is_finite()).fold(-42.0, f64::min);
    let flat = |level: f64| beam.iter().map(|it| (it.0, level)).collect::<Vec<_>>();
    let (twenty, thirty) = (flat(-20.0), flat(-30.0));
    Ok(chart(&Chart {
        title,
        x: Axis {
            quantity: "distance from the beam's centre",
            unit: "arcmin",
            scale: Scale::Linear,
            range: Some((0.0, reach)),
        },
        y: Axis {
            quantity: "response",
            unit: "dB",
            scale: Scale::Linear,
            range: Some((least - 3.0, 2.0)),
        },
        series: &[
            Series { name: "Gaussian beam", shape: Shape::Line(&beam) },
            Series { name: "error in a cell of 1/8 FWHM", shape: Shape::Line(&error) },
            Series { name: "-20 dB", shape: Shape::Line(&twenty) },
            Series { name: "-30 dB", shape: Shape::Line(&thirty) },
        ],
        marks: &[],
        bands: &[],
        width_px: 1100,
        height_px: 680,
    })?)
}

fn fits(map: &BeamMap, fwhm_arcmin: f64, world: &World) -> Result<Vec<u8>, Failure> {
    let error = cells(|column, row| {
        let error = map.error(column, row);
        if error.is_finite() { error } else { f64::NAN }
    });
    let seconds = cells(|column, row| map.seconds(column, row));
    let cards = provenance_cards(&Provenance::of(world));
    let plane = Plane { side: SIDE, half: REACH * fwhm_arcmin, unit: "arcmin", cards: &cards };
    let images = [
        Image { name: "ERROR", unit: "", values: &error },
        Image { name: "SECONDS", unit: "s", values: &seconds },
    ];
    let mut bytes = Vec::new();
    write_images(&mut bytes, &plane, &images)?;
    Ok(bytes)
}

/// The correlations of all errors, and below them what is hard to tell apart.
fn correlations(teaching: &Teaching, title: &str) -> Result<Drawing, Failure> {
    let errors = teaching.errors(0);
    let kept: Vec<usize> = (0..COUNT).filter(|&i| errors.alone[i].is_some()).collect();
    let names: Vec<&str> = kept.iter().map(|&i| Parameter::EACH[i].name()).collect();
    let mut values = Vec::new();
    for &row in &kept {
        values.extend(kept.iter().map(|&column| errors.correlation[row][column]));
    }
    let notes: Vec<String> = errors
        .degeneracies
        .iter()
        .map(|it| {
            let (one, other) = (it.one.name(), it.other.name());
            format!("{one}, {other} ({:.3}): told apart by {}", it.correlation, it.broken_by())
        })
        .collect();
    Ok(matrix_picture(&MatrixPicture { title, names: &names, values: &values, notes: &notes })?)
}
