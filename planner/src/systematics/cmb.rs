//! Spectra of the CMB: lensed scalars, and the tensors of r = 1.
//!
//! `C_l` (not `D_l`) in uK^2 by l from 0, made by CAMB \[Lewis2000\] with the parameters in the head of
//! `spectra.csv`; to l = 600.
//!
//! The tensors' tilt matters most: the consistency relation `n_t = -r/8` at r = 1 doubles the quadrupole
//! against `n_t = 0`, which is the default here as in the collaboration's spectra.

use crate::harmonics::gaussian_beam;
use thiserror::Error;

/// The embedded spectra.
const EMBEDDED: &str = include_str!("spectra.csv");

/// Tilt of the tensors of r = 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TensorTilt {
    /// `n_t = 0`.
    #[default]
    Scaleless,
    /// `n_t = -1/8`, the consistency relation at r = 1.
    Consistency,
}

/// Spectra by l from 0.
#[derive(Debug, Clone, PartialEq)]
pub struct CmbSpectra {
    /// Lensed scalar temperature.
    pub tt: Vec<f64>,
    /// Lensed scalar E.
    pub ee: Vec<f64>,
    /// B of lensing.
    pub bb: Vec<f64>,
    /// Temperature with E.
    pub te: Vec<f64>,
    /// B of the tensors of r = 1.
    pub tensor_bb: Vec<f64>,
}

/// Not a table of spectra.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SpectraError {
    /// A column is not there.
    #[error("no column {0}")]
    Column(&'static str),
    /// A row is no row of numbers, or its l not the number of rows before it.
    #[error("row {0}: not the numbers of that l")]
    Row(usize),
    /// A power below zero.
    #[error("l = {l}: a power of {value}")]
    Negative {
        /// The degree.
        l: usize,
        /// The power.
        value: f64,
    },
}

impl CmbSpectra {
    /// The embedded spectra.
    ///
    /// # Errors
    /// None but for a damaged table.
    pub fn embedded(tilt: TensorTilt) -> Result<Self, SpectraError> {
        Self::from_csv(EMBEDDED, tilt)
    }

    /// From a table with the columns of the embedded one, lines of `#` left out.
    ///
    /// # Errors
    /// [`SpectraError`], what is missing or wrong.
    pub fn from_csv(text: &str, tilt: TensorTilt) -> Result<Self, SpectraError> {
        let mut lines = text.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
        let head: Vec<&str> = lines.next().unwrap_or_default().split(',').map(str::trim).collect();
        let tensor = match tilt {
            TensorTilt::Scaleless => "BB_tens_r1_nt0",
            TensorTilt::Consistency => "BB_tens_r1",
        };
        let column = |name: &'static str| {
            head.iter().position(|&it| it == name).ok_or(SpectraError::Column(name))
        };
        let at = [
            column("ell")?,
            column("TT_lensed")?,
            column("EE_lensed")?,
            column("BB_lens")?,
            column("TE_lensed")?,
            column(tensor)?,
        ];
        let mut columns: [Vec<f64>; 5] = std::array::from_fn(|_| Vec::new());
        for (l, line) in lines.enumerate() {
            let cells: Vec<f64> =
                line.split(',').map(|cell| cell.trim().parse().unwrap_or(f64::NAN)).collect();
            let row = at.map(|at| cells.get(at).copied().unwrap_or(f64::NAN));
            let degree = f64::from(u32::try_from(l).unwrap_or(u32::MAX));
            if !row.iter().all(|x| x.is_finite()) || (row[0] - degree).abs() > 0.25 {
                return Err(SpectraError::Row(l));
            }
            // TE may have either sign.
            let powers = [row[1], row[2], row[3], row[5]];
            if let Some(&value) = powers.iter().find(|&&value| value < 0.0) {
                return Err(SpectraError::Negative { l, value });
            }
            for (column, value) in columns.iter_mut().zip(&row[1..]) {
                column.push(*value);
            }
        }
        let [tt, ee, bb, te, tensor_bb] = columns;
        Ok(Self { tt, ee, bb, te, tensor_bb })
    }

    /// The largest degree.
    #[must_use]
    pub fn l_max(&self) -> usize {
        self.tt.len().saturating_sub(1)
    }

    /// Seen through a Gaussian beam, to degree `l_max`; the tensors are left as they are. T, E and B
    /// have the beam of T, as is customary: that of spin 2 has `exp(4 sigma^2)` more power, 2e-5 at
    /// 17.9 arcmin.
    #[must_use]
    pub fn through_beam(&self, fwhm_rad: f64, l_max: usize) -> Self {
        let beam = gaussian_beam(fwhm_rad, 0, l_max);
        let product = |values: &[f64]| {
            values.iter().zip(&beam).map(|(value, beam)| value * beam * beam).collect()
        };
        Self {
            tt: product(&self.tt),
            ee: product(&self.ee),
            bb: product(&self.bb),
            te: product(&self.te),
            tensor_bb: self.tensor_bb.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_embedded_table_is_read() {
        let [flat, tilted] = [TensorTilt::Scaleless, TensorTilt::Consistency]
            .map(|tilt| CmbSpectra::embedded(tilt).unwrap());
        assert_eq!((flat.l_max(), flat.tt.len()), (600, 601));
        assert!(
            (flat.tt[2] - 1_063.274_32).abs() < 1e-9 && (flat.te[3] - 1.538_596_87).abs() < 1e-12
        );
        assert!((tilted.tensor_bb[2] / flat.tensor_bb[2] - 2.0101).abs() < 1e-3);
    }

    #[test]
    fn tables_that_are_none_are_refused() {
        let read = |text: &str| CmbSpectra::from_csv(text, TensorTilt::Scaleless).unwrap_err();
        let head = "ell,TT_lensed,EE_lensed,BB_lens,TE_lensed,BB_tens_r1_nt0\n";
        assert_eq!(read("ell,TT_lensed\n"), SpectraError::Column("EE_lensed"));
        assert_eq!(read(&format!("{head}0,1,1,1\n")), SpectraError::Row(0));
        assert_eq!(read(&format!("{head}0,1,1,1,1,1\n2,1,1,1,1,1\n")), SpectraError::Row(1));
        let negative = SpectraError::Negative { l: 0, value: -1.0 };
        assert_eq!(read(&format!("{head}0,1,-1,1,-3,1\n")), negative);
    }
}
