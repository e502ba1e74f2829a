//! Rows as Apache Parquet.
//!
//! Numbers with a fraction are DOUBLE, whole numbers and counts INT64, words and truths STRING; times in
//! UTC are TIMESTAMP in ns adjusted to UTC, in TDB TIMESTAMP in ns that is not adjusted (its scale stands
//! in the name). Every column is optional. Provenance stands in the key-value metadata.
//!
//! Method: values are gathered by column as rows come and written in groups, so that memory does not
//! grow with their number.
//!
//! Limits: leap seconds are written as the second that follows. Timestamps end in 2262.

use super::column::{Cell, Column, Field};
use super::layout::{Layout, RowError};
use crate::error::WriteError;
use ephem::time::{format_tdb, format_utc, tdb_ns, utc_day, utc_midnight};
use onboard_core::time::Instant;
use parquet::basic::{ConvertedType, LogicalType, Repetition, TimeUnit, Type as PhysicalType};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{WriterProperties, WriterVersion};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};
use planner::provenance::{PROGRAM, Provenance};
use std::io::Write;
use std::sync::{Arc, Mutex, PoisonError};

/// Rows of one group.
const GROUP: usize = 1 << 17;
/// Days from 1970-01-01 to 2000-01-01.
const DAYS_TO_2000: i64 = 10_957;
const NS_PER_DAY: i64 = 86_400_000_000_000;

/// Writes rows as they come; returns how many there were.
///
/// # Errors
/// What a row or the writer says.
pub(super) fn write<R, E: Into<RowError>>(
    out: &mut dyn Write,
    rows: impl Iterator<Item = Result<R, E>>,
    layout: &Layout<'_, R>,
) -> Result<usize, WriteError> {
    let spool = Spool::default();
    let schema = schema(layout.columns).map_err(internal)?;
    let properties = Arc::new(properties(layout.provenance));
    let mut file =
        SerializedFileWriter::new(spool.clone(), schema, properties).map_err(internal)?;
    let mut rows = rows.peekable();
    let mut count = 0;
    while rows.peek().is_some() {
        let mut columns: Vec<Values> = layout.columns.iter().map(Values::from).collect();
        for row in rows.by_ref().take(GROUP) {
            let row = row.map_err(WriteError::row)?;
            for (column, values) in layout.columns.iter().zip(&mut columns) {
                values.push(column.name, column.field.of(&row))?;
            }
            count += 1;
        }
        let mut group = file.next_row_group().map_err(internal)?;
        for values in &columns {
            values.write(&mut group).map_err(internal)?;
        }
        group.close().map_err(internal)?;
        spool.drain(out)?;
    }
    file.close().map_err(internal)?;
    spool.drain(out)?;
    Ok(count)
}

fn internal(error: ParquetError) -> WriteError {
    WriteError::refused(error)
}

fn schema<R>(columns: &[Column<R>]) -> Result<TypePtr, ParquetError> {
    let timestamp =
        |is_adjusted_to_u_t_c| Some(LogicalType::timestamp(is_adjusted_to_u_t_c, TimeUnit::NANOS));
    let fields = columns.iter().map(|column| {
        let (physical, logical) = match column.field {
            Field::Number(_) => (PhysicalType::DOUBLE, None),
            Field::Whole(_) | Field::Count(_) => (PhysicalType::INT64, None),
            Field::Truth(_) | Field::MaybeTruth(_) | Field::Word(_) => {
                (PhysicalType::BYTE_ARRAY, Some(LogicalType::String))
            }
            Field::Utc(_) | Field::MaybeUtc(_) => (PhysicalType::INT64, timestamp(true)),
            Field::Tdb(_) | Field::MaybeTdb(_) => (PhysicalType::INT64, timestamp(false)),
        };
        let field = Type::primitive_type_builder(column.name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical)
            .with_converted_type(ConvertedType::NONE)
            .build()?;
        Ok(Arc::new(field))
    });
    let fields = fields.collect::<Result<Vec<_>, ParquetError>>()?;
    Ok(Arc::new(Type::group_type_builder("rows").with_fields(fields).build()?))
}

fn properties(provenance: &Provenance) -> WriterProperties {
    let start = ("start_tai_ns", provenance.start_tai_ns.to_string());
    let pairs = provenance.lines().map(|(key, value)| (key, value.into_owned())).chain([start]);
    let pairs = pairs.map(|(key, value)| KeyValue::new(key.to_owned(), value)).collect();
    WriterProperties::builder()
        .set_writer_version(WriterVersion::PARQUET_1_0)
        .set_created_by(PROGRAM.to_owned())
        .set_key_value_metadata(Some(pairs))
        .build()
}

/// What a column holds of a group of rows.
struct Values {
    /// 1 where there is a value, else 0.
    levels: Vec<i16>,
    held: Held,
}

/// The values that there are.
enum Held {
    Numbers(Vec<f64>),
    Wholes(Vec<i64>),
    Words(Vec<ByteArray>),
}

impl<R> From<&Column<R>> for Values {
    fn from(column: &Column<R>) -> Self {
        let held = match column.field {
            Field::Number(_) => Held::Numbers(Vec::new()),
            Field::Whole(_)
            | Field::Count(_)
            | Field::Utc(_)
            | Field::Tdb(_)
            | Field::MaybeUtc(_)
            | Field::MaybeTdb(_) => Held::Wholes(Vec::new()),
            Field::Truth(_) | Field::MaybeTruth(_) | Field::Word(_) => Held::Words(Vec::new()),
        };
        Self { levels: Vec::new(), held }
    }
}

impl Values {
    fn push(&mut self, name: &str, cell: Cell<'_>) -> Result<(), WriteError> {
        self.levels.push(i16::from(cell != Cell::None));
        let beyond = |value: String| WriteError::Refused(format!("column {name} takes no {value}"));
        match (&mut self.held, cell) {
            (_, Cell::None) => {}
            (Held::Numbers(held), Cell::Number(number)) => held.push(number),
            (Held::Wholes(held), Cell::Whole(number)) => held.push(number),
            (Held::Wholes(held), Cell::Count(number)) => {
                held.push(i64::try_from(number).map_err(|_| beyond(number.to_string()))?);
            }
            (Held::Wholes(held), Cell::Utc(at)) => {
                held.push(utc_since_1970(at).ok_or_else(|| beyond(format_utc(at)))?);
            }
            (Held::Wholes(held), Cell::Tdb(at)) => {
                held.push(tdb_since_1970(at).ok_or_else(|| beyond(format_tdb(at)))?);
            }
            (Held::Words(held), Cell::Truth(truth)) => {
                held.push(ByteArray::from(if truth { "true" } else { "false" }));
            }
            (Held::Words(held), Cell::Word(word)) => held.push(ByteArray::from(&*word)),
            (_, cell) => return Err(beyond(format!("{cell:?}"))),
        }
        Ok(())
    }

    /// As the next column of a group.
    fn write(&self, group: &mut SerializedRowGroupWriter<'_, Spool>) -> Result<(), ParquetError> {
        let unknown = || ParquetError::General("a column too many".to_owned());
        let mut column = group.next_column()?.ok_or_else(unknown)?;
        let levels = Some(&self.levels[..]);
        match &self.held {
            Held::Numbers(held) => column.typed::<DoubleType>().write_batch(held, levels, None)?,
            Held::Wholes(held) => column.typed::<Int64Type>().write_batch(held, levels, None)?,
            Held::Words(held) => column.typed::<ByteArrayType>().write_batch(held, levels, None)?,
        };
        column.close()
    }
}

/// ns of UTC since 1970-01-01, as every day had 86400 s.
fn utc_since_1970(at: Instant) -> Option<i64> {
    let day = utc_day(at);
    let midnight = (day + DAYS_TO_2000).checked_mul(NS_PER_DAY)?;
    midnight.checked_add(at.since(utc_midnight(day)).ns())
}

/// ns of TDB since 1970-01-01T00:00:00 TDB.
fn tdb_since_1970(at: Instant) -> Option<i64> {
    tdb_ns(at).checked_add(DAYS_TO_2000 * NS_PER_DAY + NS_PER_DAY / 2)
}

/// Bytes on their way to a writer that cannot be sent between threads.
#[derive(Debug, Clone, Default)]
struct Spool(Arc<Mutex<Vec<u8>>>);

impl Spool {
    fn drain(&self, out: &mut dyn Write) -> Result<(), std::io::Error> {
        let mut held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        out.write_all(&held)?;
        held.clear();
        Ok(())
    }
}

impl Write for Spool {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ephem::time::parse_time;

    #[test]
    fn times_count_from_1970() {
        let utc = |text: &str| utc_since_1970(parse_time(text).unwrap());
        // date -u -d 2032-02-29T23:59:59 +%s
        assert_eq!(utc("2032-02-29T23:59:59.5Z"), Some(1_961_711_999_500_000_000));
        assert_eq!(utc("2016-12-31T23:59:60.25Z"), Some(1_483_228_800_250_000_000));
        assert_eq!(utc("2290-01-01T00:00:00Z"), None);
        let tdb = |text: &str| tdb_since_1970(parse_time(text).unwrap());
        assert_eq!(tdb("1970-01-01T00:00:00 TDB"), Some(0));
        assert_eq!(tdb("2032-02-29T23:59:59.5 TDB"), Some(1_961_711_999_500_000_000));
        assert_eq!(tdb("2290-01-01T00:00:00 TDB"), None);
    }
}
