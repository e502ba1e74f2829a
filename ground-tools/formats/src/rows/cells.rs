//! One row taken apart into its cells.

use crate::error::WriteError;
use serde::Serialize;
use serde::ser::{self, Impossible, SerializeStruct};
use std::fmt::Display;

/// A value of a row.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Cell {
    /// Left out.
    None,
    /// With a fraction.
    Number(f64),
    /// Whole.
    Whole(i64),
    /// Text.
    Word(String),
}

/// The cells of a row, which is a struct of numbers and words.
pub(super) fn row_of<R: Serialize>(row: &R, columns: usize) -> Result<Vec<Cell>, WriteError> {
    let cells = row.serialize(Cells(Vec::with_capacity(columns))).map_err(WriteError::refused)?;
    if cells.len() == columns {
        Ok(cells)
    } else {
        Err(WriteError::Refused(format!("a row of {} cells under {columns} columns", cells.len())))
    }
}

/// ns since 1970-01-01 of `YYYY-MM-DDThh:mm:ss[.fraction][Z]`, as every day had 86400 s.
pub(super) fn civil_ns(text: &str) -> Option<i64> {
    let text = text.strip_suffix('Z').unwrap_or(text);
    let (date, time) = text.split_once('T')?;
    let mut dates = date.splitn(3, '-').map(|it| it.parse::<i64>().ok());
    let (year, month, day) = (dates.next()??, dates.next()??, dates.next()??);
    let (clock, fraction) = time.split_once('.').unwrap_or((time, "0"));
    let mut clocks = clock.splitn(3, ':').map(|it| it.parse::<i64>().ok());
    let (hour, minute, second) = (clocks.next()??, clocks.next()??, clocks.next()??);
    let ns: i64 = format!("{fraction:0<9}").get(..9)?.parse().ok()?;
    // Years from March, so that a leap day ends its year.
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let days = 365 * year + year.div_euclid(4) - year.div_euclid(100)
        + year.div_euclid(400)
        + (153 * month + 2) / 5
        + day
        - 719_469;
    (((days * 24 + hour) * 60 + minute) * 60 + second).checked_mul(1_000_000_000)?.checked_add(ns)
}

/// Why a row cannot be taken apart.
#[derive(Debug)]
pub(super) struct Unfit(String);

impl Display for Unfit {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(&self.0)
    }
}

impl std::error::Error for Unfit {}

impl ser::Error for Unfit {
    fn custom<T: Display>(message: T) -> Self {
        Self(message.to_string())
    }
}

fn unfit<T>(what: &str) -> Result<T, Unfit> {
    Err(Unfit(format!("a table holds no {what}")))
}

/// Takes a struct.
struct Cells(Vec<Cell>);

impl SerializeStruct for Cells {
    type Ok = Vec<Cell>;
    type Error = Unfit;

    fn serialize_field<T: Serialize + ?Sized>(
        &mut self,
        _: &'static str,
        value: &T,
    ) -> Result<(), Unfit> {
        self.0.push(value.serialize(One)?);
        Ok(())
    }

    fn skip_field(&mut self, _: &'static str) -> Result<(), Unfit> {
        self.0.push(Cell::None);
        Ok(())
    }

    fn end(self) -> Result<Vec<Cell>, Unfit> {
        Ok(self.0)
    }
}

/// Takes a value.
struct One;

/// Refuses what is not listed, in both serializers.
macro_rules! refuse {
    ($ok:ty: $($method:ident($($kind:ty),*)),* $(,)?) => {
        $(fn $method(self, $(_: $kind),*) -> Result<$ok, Unfit> {
            unfit(stringify!($method))
        })*
    };
}

/// What neither a row nor a cell is.
macro_rules! refuse_compounds {
    ($ok:ty) => {
        type SerializeSeq = Impossible<$ok, Unfit>;
        type SerializeTuple = Impossible<$ok, Unfit>;
        type SerializeTupleStruct = Impossible<$ok, Unfit>;
        type SerializeTupleVariant = Impossible<$ok, Unfit>;
        type SerializeMap = Impossible<$ok, Unfit>;
        type SerializeStructVariant = Impossible<$ok, Unfit>;

        fn serialize_newtype_variant<T: Serialize + ?Sized>(
            self,
            _: &'static str,
            _: u32,
            _: &'static str,
            _: &T,
        ) -> Result<$ok, Unfit> {
            unfit("variant")
        }

        fn serialize_seq(self, _: Option<usize>) -> Result<Self::SerializeSeq, Unfit> {
            unfit("list")
        }

        fn serialize_tuple(self, _: usize) -> Result<Self::SerializeTuple, Unfit> {
            unfit("tuple")
        }

        fn serialize_tuple_struct(
            self,
            _: &'static str,
            _: usize,
        ) -> Result<Self::SerializeTupleStruct, Unfit> {
            unfit("tuple")
        }

        fn serialize_tuple_variant(
            self,
            _: &'static str,
            _: u32,
            _: &'static str,
            _: usize,
        ) -> Result<Self::SerializeTupleVariant, Unfit> {
            unfit("variant")
        }

        fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, Unfit> {
            unfit("map")
        }

        fn serialize_struct_variant(
            self,
            _: &'static str,
            _: u32,
            _: &'static str,
            _: usize,
        ) -> Result<Self::SerializeStructVariant, Unfit> {
            unfit("variant")
        }
    };
}

impl ser::Serializer for Cells {
    type Ok = Vec<Cell>;
    type Error = Unfit;
    type SerializeStruct = Self;

    refuse_compounds!(Vec<Cell>);
    refuse!(Vec<Cell>:
        serialize_bool(bool), serialize_i8(i8), serialize_i16(i16), serialize_i32(i32),
        serialize_i64(i64), serialize_u8(u8), serialize_u16(u16), serialize_u32(u32),
        serialize_u64(u64), serialize_f32(f32), serialize_f64(f64), serialize_char(char),
        serialize_str(&str), serialize_bytes(&[u8]), serialize_none(), serialize_unit(),
        serialize_unit_struct(&'static str), serialize_unit_variant(&'static str, u32, &'static str),
    );

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<Vec<Cell>, Unfit> {
        value.serialize(self)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        value: &T,
    ) -> Result<Vec<Cell>, Unfit> {
        value.serialize(self)
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Self, Unfit> {
        Ok(self)
    }
}

impl ser::Serializer for One {
    type Ok = Cell;
    type Error = Unfit;
    type SerializeStruct = Impossible<Cell, Unfit>;

    refuse_compounds!(Cell);
    refuse!(Cell: serialize_bytes(&[u8]), serialize_unit_struct(&'static str));

    fn serialize_bool(self, value: bool) -> Result<Cell, Unfit> {
        Ok(Cell::Word(value.to_string()))
    }

    fn serialize_i8(self, value: i8) -> Result<Cell, Unfit> {
        self.serialize_i64(value.into())
    }

    fn serialize_i16(self, value: i16) -> Result<Cell, Unfit> {
        self.serialize_i64(value.into())
    }

    fn serialize_i32(self, value: i32) -> Result<Cell, Unfit> {
        self.serialize_i64(value.into())
    }

    fn serialize_i64(self, value: i64) -> Result<Cell, Unfit> {
        Ok(Cell::Whole(value))
    }

    fn serialize_u8(self, value: u8) -> Result<Cell, Unfit> {
        self.serialize_i64(value.into())
    }

    fn serialize_u16(self, value: u16) -> Result<Cell, Unfit> {
        self.serialize_i64(value.into())
    }

    fn serialize_u32(self, value: u32) -> Result<Cell, Unfit> {
        self.serialize_i64(value.into())
    }

    fn serialize_u64(self, value: u64) -> Result<Cell, Unfit> {
        i64::try_from(value).map(Cell::Whole).map_err(|_| Unfit(format!("{value} is too large")))
    }

    fn serialize_f32(self, value: f32) -> Result<Cell, Unfit> {
        self.serialize_f64(value.into())
    }

    fn serialize_f64(self, value: f64) -> Result<Cell, Unfit> {
        Ok(Cell::Number(value))
    }

    fn serialize_char(self, value: char) -> Result<Cell, Unfit> {
        Ok(Cell::Word(value.to_string()))
    }

    fn serialize_str(self, value: &str) -> Result<Cell, Unfit> {
        Ok(Cell::Word(value.to_owned()))
    }

    fn serialize_none(self) -> Result<Cell, Unfit> {
        Ok(Cell::None)
    }

    fn serialize_unit(self) -> Result<Cell, Unfit> {
        Ok(Cell::None)
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<Cell, Unfit> {
        value.serialize(self)
    }

    fn serialize_unit_variant(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
    ) -> Result<Cell, Unfit> {
        Ok(Cell::Word(variant.to_owned()))
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        value: &T,
    ) -> Result<Cell, Unfit> {
        value.serialize(self)
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Self::SerializeStruct, Unfit> {
        unfit("struct")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn civil_times_count_from_1970() {
        assert_eq!(civil_ns("1970-01-01T00:00:00"), Some(0));
        // date -u -d 2032-02-29T23:59:59 +%s
        assert_eq!(civil_ns("2032-02-29T23:59:59.5Z"), Some(1_961_711_999_500_000_000));
        assert_eq!(civil_ns("2300-01-01T00:00:00Z"), None);
        assert_eq!(civil_ns("soon"), None);
    }

    #[test]
    fn only_flat_rows_are_taken() {
        #[derive(Serialize)]
        struct Row {
            a: f64,
            b: Option<u32>,
            c: &'static str,
            d: Option<f64>,
        }
        let row = Row { a: 0.5, b: Some(7), c: "x", d: None };
        let expected = [Cell::Number(0.5), Cell::Whole(7), Cell::Word("x".to_owned()), Cell::None];
        assert_eq!(row_of(&row, 4).unwrap(), expected);
        assert!(row_of(&row, 3).is_err());
        assert!(row_of(&[1, 2], 2).is_err());
        assert!(row_of(&1.0, 1).is_err());
    }
}
