//! The figures of `docs/validation/information.md` are those of its numbers.
//!
//! `UPDATE_GOLDEN=1 cargo test -p pictures --test validation` draws them again.
#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use pictures::{Axis, Chart, Scale, Series, Shape, chart};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Precession periods of the table, as the legend has them.
const PERIODS: [(&str, &str); 5] = [
    ("96.174", "1.6 h"),
    ("192.348", "3.2 h"),
    ("384.7", "6.4 h"),
    ("1440.3", "1 d"),
    ("14400.7", "10 d"),
];
const MISSIONS: [&str; 3] = ["LiteBIRD", "PICO", "Planck"];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/validation")
}

/// Amplitude and a column of the table, by mission or by precession period.
fn points(column: usize) -> BTreeMap<String, Vec<(f64, f64)>> {
    let text = std::fs::read_to_string(folder().join("information.csv")).unwrap();
    let mut found: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
    for line in text.lines().filter(|it| !it.starts_with('#')).skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let name = if cells[0] == "-" { cells[2] } else { cells[0] };
        let point = (cells[3].parse().unwrap(), cells[column].parse().unwrap());
        found.entry(name.to_owned()).or_default().push(point);
    }
    found
}

fn held(column: usize, quantity: &str, unit: &str, file: &str) {
    let points = points(column);
    let periods = PERIODS.map(|(key, name)| (key, format!("T_alpha = {name}")));
    let named = periods.iter().map(|(key, name)| (*key, name.as_str()));
    let series: Vec<Series<'_>> = named
        .chain(MISSIONS.map(|it| (it, it)))
        .map(|(key, name)| Series { name, shape: Shape::Line(&points[key]) })
        .collect();
    let drawing = chart(&Chart {
        title: "Jupiter, three years, alpha from 5 to 75 deg",
        x: Axis {
            quantity: "amplitude of the scan-beam angle",
            unit: "deg",
            scale: Scale::Log,
            range: Some((5e-5, 60.0)),
        },
        y: Axis { quantity, unit, scale: Scale::Log, range: None },
        series: &series,
        marks: &[],
        bands: &[],
        width_px: 1000,
        height_px: 680,
    })
    .unwrap();
    let path = folder().join(file);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, drawing.svg()).unwrap();
        std::fs::write(std::env::temp_dir().join(format!("{file}.png")), drawing.png().unwrap())
            .unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == drawing.svg(), "{file} is not the figure of information.csv");
}

#[test]
fn figures_are_those_of_the_table() {
    held(4, "error of the offset along the scan", "arcsec", "information-offset.svg");
    held(5, "error of the time constant", "ms", "information-time-constant.svg");
}
