//! Little-endian fields of the input, one after the other.

use crate::Malformed;
use onboard_core::rotation::Rotation;
use onboard_core::time::{Duration, Instant};

/// What is left of a block.
#[derive(Debug)]
pub struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    /// Reads from the first byte on.
    #[must_use]
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Whether everything has been read.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// That many bytes.
    ///
    /// # Errors
    /// [`Malformed`] at the end.
    pub fn field<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
        let (field, rest) = self.rest.split_first_chunk::<N>().ok_or(Malformed)?;
        self.rest = rest;
        Ok(*field)
    }

    /// A u32.
    ///
    /// # Errors
    /// [`Malformed`] at the end.
    pub fn u32(&mut self) -> Result<u32, Malformed> {
        self.field().map(u32::from_le_bytes)
    }

    /// An i32.
    ///
    /// # Errors
    /// [`Malformed`] at the end.
    pub fn i32(&mut self) -> Result<i32, Malformed> {
        self.field().map(i32::from_le_bytes)
    }

    /// A u64.
    ///
    /// # Errors
    /// [`Malformed`] at the end.
    pub fn u64(&mut self) -> Result<u64, Malformed> {
        self.field().map(u64::from_le_bytes)
    }

    /// A u32 that fits a u16.
    ///
    /// # Errors
    /// [`Malformed`] at the end, or beyond a u16.
    pub fn u16(&mut self) -> Result<u16, Malformed> {
        u16::try_from(self.u32()?).map_err(|_| Malformed)
    }

    /// A u32 that is an index.
    ///
    /// # Errors
    /// [`Malformed`] at the end.
    pub fn index(&mut self) -> Result<usize, Malformed> {
        usize::try_from(self.u32()?).map_err(|_| Malformed)
    }

    /// An f64.
    ///
    /// # Errors
    /// [`Malformed`] at the end.
    pub fn f64(&mut self) -> Result<f64, Malformed> {
        self.field().map(f64::from_le_bytes)
    }

    /// Several f64.
    ///
    /// # Errors
    /// [`Malformed`] at the end.
    pub fn numbers<const N: usize>(&mut self) -> Result<[f64; N], Malformed> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.f64()?;
        }
        Ok(numbers)
    }

    /// A duration, i64 ns.
    ///
    /// # Errors
    /// [`Malformed`] at the end.
    pub fn duration(&mut self) -> Result<Duration, Malformed> {
        self.field().map(|bytes| Duration::from_ns(i64::from_le_bytes(bytes)))
    }

    /// An instant, i64 ns of TAI.
    ///
    /// # Errors
    /// [`Malformed`] at the end.
    pub fn instant(&mut self) -> Result<Instant, Malformed> {
        self.field().map(|bytes| Instant::from_tai_ns(i64::from_le_bytes(bytes)))
    }

    /// A rotation, x y z w.
    ///
    /// # Errors
    /// [`Malformed`] at the end, or where it is no rotation.
    pub fn rotation<A, B>(&mut self) -> Result<Rotation<A, B>, Malformed> {
        Rotation::from_xyzw(self.numbers()?).map_err(|_| Malformed)
    }

    /// As many bytes as the u32 before them says.
    ///
    /// # Errors
    /// [`Malformed`] where they are not there.
    pub fn sized(&mut self) -> Result<&'a [u8], Malformed> {
        let length = usize::try_from(self.u32()?).map_err(|_| Malformed)?;
        let (bytes, rest) = self.rest.split_at_checked(length).ok_or(Malformed)?;
        self.rest = rest;
        Ok(bytes)
    }
}
