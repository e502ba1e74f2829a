//! `gyrfalcon vectors`: test vectors for flight code.

use super::asked::{window, world};
use super::delivered::{form, sink};
use super::table::container;
use super::told::{print_json, warn};
use crate::cli::{Format, SharedArgs, VectorsArgs};
use crate::failure::Failure;
use crate::output::{Sink, is_device, to_stdout, write_folder};
use ephem::random::SplitMix64;
use formats::rows::{self, Column, Layout, json_lines};
use formats::vectors::{TransitVector, Vector, VectorSet, c_header};
use mission::digest::sha256_hex;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::time::Duration;
use planner::provenance::Provenance;
use planner::world::World;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Instants where none are asked for.
const DEFAULT_COUNT: u32 = 1000;
/// Most instants; more is a history, not test vectors.
const MOST: usize = 1_000_000;

pub(super) fn run(shared: &SharedArgs, arguments: &VectorsArgs) -> Result<(), Failure> {
    let mut world = world(shared)?;
    world.keep_targets(&arguments.target)?;
    let lines = arguments.sight.lines(&world.mission)?;
    let times = instants(&world, arguments)?;
    let mut provenance = Provenance::of(&world);
    let (tables, bytes);
    let ephemeris: EphemerisTable<'_> = match &arguments.table {
        None => {
            tables = world.tables(&world.ground_options())?;
            tables.parse()?
        }
        Some(file) => {
            bytes = container::read(file)?;
            provenance.table_sha256 = Some(sha256_hex(&bytes));
            container::ephemeris(file, &bytes, &world.mission)?
        }
    };
    let set = VectorSet::new(&world, ephemeris, &lines, times.into_iter());
    // A table of the user's own may hold anything.
    let set = set.map_err(|error| match (&arguments.table, Failure::from(error)) {
        (Some(file), Failure::Internal(what)) => {
            Failure::Input(format!("{}: it does not serve the mission: {what}", file.display()))
        }
        (_, failure) => failure,
    })?;
    let files = deliver(shared, &set, &provenance)?;
    if !shared.json {
        return Ok(());
    }
    print_json(&json!({
        "vectors": set.vectors.len(),
        "transits": set.transits.len(),
        "lines": lines.iter().map(planner::opportunities::SightLine::key).collect::<Vec<_>>(),
        "files": files.iter().map(|it| it.to_string_lossy()).collect::<Vec<_>>(),
        "provenance": serde_json::to_value(&provenance).map_err(Failure::internal)?,
    }))
}

/// The elapsed times asked for, rising where they are drawn or stepped.
fn instants(world: &World, arguments: &VectorsArgs) -> Result<Vec<Duration>, Failure> {
    let named = &arguments.instants;
    let (from, until) = window(world);
    let whole = until.ns() - from.ns();
    let times: Vec<Duration> = if named.step.is_some() || !named.at.is_empty() {
        named.within((from, until))?.take(MOST + 1).collect()
    } else {
        let count = i64::from(arguments.count.map_or(DEFAULT_COUNT, std::num::NonZeroU32::get));
        let mut drawn: Vec<i64> = match arguments.seed {
            Some(seed) => {
                let mut random = SplitMix64(seed);
                (0..count).map(|_| random.up_to(whole)).collect()
            }
            None => (0..count).map(|index| spaced(whole, index, count)).collect(),
        };
        drawn.sort_unstable();
        drawn.into_iter().map(|it| Duration::from_ns(from.ns() + it)).collect()
    };
    if times.len() > MOST {
        return Err(Failure::Input(format!(
            "that is more than {MOST} instants: fewer are needed (pointing writes histories)"
        )));
    }
    Ok(times)
}

/// The instant `index` of `count` from 0 to `whole`, both included.
fn spaced(whole: i64, index: i64, count: i64) -> i64 {
    let exact = i128::from(whole) * i128::from(index) / i128::from((count - 1).max(1));
    i64::try_from(exact).unwrap_or(whole)
}

/// Writes all files or none; returns their paths.
fn deliver(
    shared: &SharedArgs,
    set: &VectorSet<'_>,
    provenance: &Provenance,
) -> Result<Vec<PathBuf>, Failure> {
    let sink = sink(shared);
    if shared.json && sink == Sink::Stdout {
        return Ok(Vec::new());
    }
    let format = form(shared)?;
    let (vectors, transits) = (&set.vectors, &set.transits);
    let (first, second) = match format {
        Format::C => (c_header::text(set, provenance).into_bytes(), None),
        Format::Jsonl => {
            let mut bytes = Vec::new();
            let rows = vectors.iter().map(Ok::<_, Failure>);
            let before = json_lines(&mut bytes, rows, &Vector::columns(), Some(provenance))?;
            let provenance = Some(provenance).filter(|_| before == 0);
            let rows = transits.iter().map(Ok::<_, Failure>);
            json_lines(&mut bytes, rows, &TransitVector::columns(), provenance)?;
            (bytes, None)
        }
        Format::Csv | Format::Parquet | Format::Aem => {
            let format = format.of_rows()?;
            let second = rows_in(transits, &TransitVector::columns(), (format, provenance))?;
            (rows_in(vectors, &Vector::columns(), (format, provenance))?, Some(second))
        }
    };
    let Sink::File(path) = sink else {
        if second.is_some() && !set.transits.is_empty() {
            let dropped = "the transits' table needs a file beside the vectors': give --out FILE";
            warn(shared, &[dropped]);
        }
        to_stdout(&first)?;
        return Ok(Vec::new());
    };
    if is_device(&path) {
        if second.is_some() && !set.transits.is_empty() {
            let dropped = "the transits' table needs a file beside the vectors', not a device";
            warn(shared, &[dropped]);
        }
        Sink::File(path.clone()).write(&first)?;
        return Ok(vec![path]);
    }
    let Some(second) = second else {
        Sink::File(path.clone()).write(&first)?;
        return Ok(vec![path]);
    };
    let beside = transits_beside(&path);
    let (Some(name), Some(other)) = (path.file_name(), beside.file_name()) else {
        return Sink::File(path.clone()).write(&first).map(|()| vec![path.clone()]);
    };
    let (name, other) = (name.to_string_lossy(), other.to_string_lossy());
    let folder = path.parent().filter(|it| !it.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(Failure::Input(format!(
            "cannot write {}: {} is not a folder",
            path.display(),
            folder.display()
        )));
    }
    write_folder(folder, &[(&name, &first), (&other, &second)])?;
    Ok(vec![path.clone(), beside])
}

/// Rows in one form.
fn rows_in<'r, R>(
    rows: &'r [R],
    columns: &[Column<&'r R>],
    (format, provenance): (rows::Format, &Provenance),
) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let rows = rows.iter().map(Ok::<_, Failure>);
    rows::write(&mut bytes, rows, &Layout { format, provenance, columns })?;
    Ok(bytes)
}

/// `NAME.transits.csv` beside `NAME.csv`.
fn transits_beside(path: &Path) -> PathBuf {
    let stem = path.file_stem().map_or_else(String::new, |it| it.to_string_lossy().into_owned());
    let extension = path.extension().map_or_else(|| "csv".into(), |it| it.to_string_lossy());
    path.with_file_name(format!("{stem}.transits.{extension}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instants_reach_both_ends() {
        let all: Vec<i64> = (0..4).map(|index| spaced(10, index, 4)).collect();
        assert_eq!(all, [0, 3, 6, 10]);
        assert_eq!(spaced(10, 0, 1), 0);
        let century = 3_155_760_000_000_000_000;
        assert_eq!(spaced(century, 999_999, 1_000_000), century);
    }

    #[test]
    fn the_transits_file_stands_beside() {
        assert_eq!(transits_beside(Path::new("a/v.csv")), Path::new("a/v.transits.csv"));
        assert_eq!(transits_beside(Path::new("v")), Path::new("v.transits.csv"));
    }
}
