//! Little-endian fields of the input, one after the other.

use crate::Malformed;
use onboard_core::frame::{Boresight, Detector};
use onboard_core::rotation::Rotation;
use onboard_core::time::Instant;

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

    fn field<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
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

    /// An f64.
    ///
    /// # Errors
    /// [`Malformed`] at the end.
    pub fn f64(&mut self) -> Result<f64, Malformed> {
        self.field().map(f64::from_le_bytes)
    }

    /// An instant, i64 ns of TAI.
    ///
    /// # Errors
    /// [`Malformed`] at the end.
    pub fn instant(&mut self) -> Result<Instant, Malformed> {
        self.field().map(|bytes| Instant::from_tai_ns(i64::from_le_bytes(bytes)))
    }

    /// A detector, x y z w.
    ///
    /// # Errors
    /// [`Malformed`] at the end, or where it is no rotation.
    pub fn detector(&mut self) -> Result<Rotation<Detector, Boresight>, Malformed> {
        let xyzw = [self.f64()?, self.f64()?, self.f64()?, self.f64()?];
        Rotation::from_xyzw(xyzw).map_err(|_| Malformed)
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
