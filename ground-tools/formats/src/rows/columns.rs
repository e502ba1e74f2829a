//! Rows as Apache Parquet, typed by their values.
//!
//! Numbers with a fraction are DOUBLE, whole numbers INT64, words STRING; `_utc` is TIMESTAMP in ns
//! adjusted to UTC, `_tdb` TIMESTAMP in ns that is not adjusted (its scale stands in the name). A
//! column is optional where a row may leave it out. Provenance stands in the key-value metadata.
//!
//! Method: rows are taken apart by serde as they come and written in groups, so that memory does not
//! grow with their number. The columns' types are those of the first group.
//!
//! Limits: a column without any value in the first group is DOUBLE, or by its name INT64 or STRING.
//! Leap seconds are written as the second that follows. Timestamps end in 2262.

use super::cells::{self, Cell, row_of};
use super::{Layout, RowError};
use crate::error::WriteError;
use parquet::basic::{ConvertedType, LogicalType, Repetition, TimeUnit, Type as PhysicalType};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{WriterProperties, WriterVersion};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};
use planner::provenance::{PROGRAM, Provenance};
use serde::Serialize;
use std::io::Write;
use std::sync::{Arc, Mutex, PoisonError};

/// Rows of one group.
const GROUP: usize = 1 << 17;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Number,
    Whole,
    Word,
    Utc,
    Tdb,
}

/// Writes rows as they come; returns how many there were.
///
/// # Errors
/// What a row or the writer says.
pub(super) fn write<R: Serialize, E: Into<RowError>>(
    out: &mut dyn Write,
    rows: impl Iterator<Item = Result<R, E>>,
    layout: &Layout<'_>,
) -> Result<usize, WriteError> {
    let mut rows = rows.peekable();
    let mut file: Option<File> = None;
    let mut count = 0;
    loop {
        let mut group: Vec<Vec<Cell>> = Vec::new();
        for row in rows.by_ref().take(GROUP) {
            group.push(row_of(&row.map_err(WriteError::row)?, layout.header.len())?);
        }
        if group.is_empty() && file.is_some() {
            break;
        }
        let file = match &mut file {
            Some(file) => file,
            None => file.insert(File::new(layout, &group)?),
        };
        count += group.len();
        if !group.is_empty() {
            file.group(&group)?;
        }
        file.spool.drain(out)?;
        if rows.peek().is_none() {
            break;
        }
    }
    if let Some(file) = file {
        let spool = file.spool.clone();
        file.writer.close().map_err(internal)?;
        spool.drain(out)?;
    }
    Ok(count)
}

fn internal(error: ParquetError) -> WriteError {
    WriteError::refused(error)
}

/// A file on its way.
struct File {
    writer: SerializedFileWriter<Spool>,
    spool: Spool,
    kinds: Vec<Kind>,
    names: Vec<String>,
}

impl File {
    fn new(layout: &Layout<'_>, first: &[Vec<Cell>]) -> Result<Self, WriteError> {
        let names: Vec<String> = layout.header.iter().map(|&name| name.to_owned()).collect();
        let kinds: Vec<Kind> = names
            .iter()
            .enumerate()
            .map(|(index, name)| kind(name, first.iter().filter_map(|row| row.get(index))))
            .collect();
        let spool = Spool::default();
        let schema = schema(&names, &kinds).map_err(internal)?;
        let properties = Arc::new(properties(layout.provenance));
        let writer = SerializedFileWriter::new(spool.clone(), schema, properties);
        Ok(Self { writer: writer.map_err(internal)?, spool, kinds, names })
    }

    fn group(&mut self, rows: &[Vec<Cell>]) -> Result<(), WriteError> {
        let mut group = self.writer.next_row_group().map_err(internal)?;
        for (index, kind) in self.kinds.iter().enumerate() {
            let cells = rows.iter().filter_map(|row| row.get(index));
            column(&mut group, *kind, cells).map_err(|error| match error {
                ColumnError::Parquet(error) => internal(error),
                ColumnError::Cell(cell) => {
                    WriteError::Refused(format!("column {} takes no {cell:?}", self.names[index]))
                }
            })?;
        }
        group.close().map_err(internal)?;
        Ok(())
    }
}

/// What a column holds: by its name where times are named, else by its values.
fn kind<'c>(name: &str, mut cells: impl Iterator<Item = &'c Cell>) -> Kind {
    if name.ends_with("_utc") {
        return Kind::Utc;
    }
    if name.ends_with("_tdb") {
        return Kind::Tdb;
    }
    match cells.find(|cell| !matches!(cell, Cell::None)) {
        Some(Cell::Number(_)) => Kind::Number,
        Some(Cell::Whole(_)) => Kind::Whole,
        Some(Cell::Word(_)) => Kind::Word,
        Some(Cell::None) | None => match name {
            "target" | "telescope" | "detector" | "clipped" | "id" | "reason" => Kind::Word,
            _ if name.ends_with("tai_ns") || name.ends_with("_count") => Kind::Whole,
            _ => Kind::Number,
        },
    }
}

fn schema(names: &[String], kinds: &[Kind]) -> Result<TypePtr, ParquetError> {
    let timestamp =
        |is_adjusted_to_u_t_c| Some(LogicalType::timestamp(is_adjusted_to_u_t_c, TimeUnit::NANOS));
    let fields = names.iter().zip(kinds).map(|(name, kind)| {
        let (physical, logical) = match kind {
            Kind::Number => (PhysicalType::DOUBLE, None),
            Kind::Whole => (PhysicalType::INT64, None),
            Kind::Word => (PhysicalType::BYTE_ARRAY, Some(LogicalType::String)),
            Kind::Utc => (PhysicalType::INT64, timestamp(true)),
            Kind::Tdb => (PhysicalType::INT64, timestamp(false)),
        };
        let field = Type::primitive_type_builder(name, physical)
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

enum ColumnError {
    Parquet(ParquetError),
    Cell(Cell),
}

impl From<ParquetError> for ColumnError {
    fn from(error: ParquetError) -> Self {
        Self::Parquet(error)
    }
}

/// Writes the next column of a group.
fn column<'c>(
    group: &mut SerializedRowGroupWriter<'_, Spool>,
    kind: Kind,
    cells: impl Iterator<Item = &'c Cell>,
) -> Result<(), ColumnError> {
    let unknown = || ColumnError::Parquet(ParquetError::General("a column too many".to_owned()));
    let mut column = group.next_column()?.ok_or_else(unknown)?;
    let mut levels: Vec<i16> = Vec::new();
    let (mut numbers, mut wholes, mut words) = (Vec::new(), Vec::new(), Vec::new());
    for cell in cells {
        levels.push(i16::from(!matches!(cell, Cell::None)));
        match (kind, cell) {
            (_, Cell::None) => {}
            (Kind::Number, Cell::Number(number)) => numbers.push(*number),
            (Kind::Whole, Cell::Whole(number)) => wholes.push(*number),
            (Kind::Word, Cell::Word(word)) => words.push(ByteArray::from(word.as_str())),
            (Kind::Utc | Kind::Tdb, Cell::Word(word)) => {
                wholes.push(cells::civil_ns(word).ok_or_else(|| ColumnError::Cell(cell.clone()))?);
            }
            _ => return Err(ColumnError::Cell(cell.clone())),
        }
    }
    let levels = Some(&levels[..]);
    match kind {
        Kind::Number => {
            column.typed::<DoubleType>().write_batch(&numbers, levels, None)?;
        }
        Kind::Word => {
            column.typed::<ByteArrayType>().write_batch(&words, levels, None)?;
        }
        Kind::Whole | Kind::Utc | Kind::Tdb => {
            column.typed::<Int64Type>().write_batch(&wholes, levels, None)?;
        }
    }
    column.close()?;
    Ok(())
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
