//! Coefficients of a complex field with a spin, and the operators that raise and lower it.
//!
//! `F = sum_lm a_lm sY_lm`, `a_lm = -(E_lm + i B_lm)` for m of both signs, E and B those of real fields.
//! For s = 2 this is `Q + iU`, COSMO sense. A real field of spin 0 has `E = -a`, `B = 0`.
//!
//! Method: eth raises, `eth sY_lm = sqrt((l - s)(l + s + 1)) (s+1)Y_lm`, its conjugate lowers,
//! `ethbar sY_lm = -sqrt((l + s)(l - s + 1)) (s-1)Y_lm` \[Goldberg1967\].
//!
//! Limits: spins are not negative; a field of spin -s is held as its conjugate.

use super::Complex64;
use super::alm::Alm;

/// A field of some spin, by its coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct SpinAlm {
    /// The spin, not negative.
    pub spin: usize,
    /// E.
    pub e: Alm,
    /// B, to the same degree.
    pub b: Alm,
}

impl SpinAlm {
    /// The real field of spin 0 with these coefficients.
    #[must_use]
    pub fn scalar(alm: &Alm) -> Self {
        Self { spin: 0, e: alm.weighted(|_| -1.0), b: Alm::zero(alm.l_max()) }
    }

    /// The largest degree.
    #[must_use]
    pub const fn l_max(&self) -> usize {
        self.e.l_max()
    }

    /// `a_lm` and `a_(l,-m)`.
    #[must_use]
    pub fn pair(&self, l: usize, m: usize) -> [Complex64; 2] {
        let (e, b) = (self.e.at(l, m), self.b.at(l, m));
        let sign = if m.is_multiple_of(2) { -1.0 } else { 1.0 };
        [-(e + Complex64::I * b), (e.conj() + Complex64::I * b.conj()) * sign]
    }

    /// eth of the field: its spin one higher.
    #[must_use]
    pub fn raised(&self) -> Self {
        let factor = raising(self.spin);
        let [e, b] = [&self.e, &self.b].map(|alm| alm.weighted(&factor));
        Self { spin: self.spin + 1, e, b }
    }

    /// The conjugate eth of the field, its spin one lower; `None` for spin 0.
    #[must_use]
    pub fn lowered(&self) -> Option<Self> {
        let spin = self.spin.checked_sub(1)?;
        let factor = raising(spin);
        let [e, b] = [&self.e, &self.b].map(|alm| alm.weighted(|l| -factor(l)));
        Some(Self { spin, e, b })
    }

    /// The sum with a field of the same spin.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self { spin: self.spin, e: self.e.plus(&other.e), b: self.b.plus(&other.b) }
    }
}

/// `sqrt((l - s)(l + s + 1))` by l, 0 below s.
pub(crate) fn raising(spin: usize) -> impl Fn(usize) -> f64 {
    move |l| {
        if l <= spin {
            return 0.0;
        }
        let product = (l - spin) * (l + spin + 1);
        f64::from(u32::try_from(product).unwrap_or(u32::MAX)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn raising_and_lowering_are_those_of_the_laplacian() {
        let mut alm = Alm::zero(4);
        alm.set(3, 2, Complex64::new(0.5, -1.0));
        alm.set(4, 1, Complex64::new(2.0, 0.0));
        let field = SpinAlm { spin: 2, e: alm.clone(), b: alm.weighted(|_| 0.3) };
        // ethbar eth sY = -(l - s)(l + s + 1) sY
        let back = field.raised().lowered().unwrap();
        assert!((back.e.at(3, 2) + 6.0 * field.e.at(3, 2)).norm() < 1e-14);
        assert!((back.b.at(4, 1) + 14.0 * field.b.at(4, 1)).norm() < 1e-14);
        assert_eq!(SpinAlm::scalar(&alm).lowered(), None);
        let [plus, minus] = field.pair(3, 2);
        assert!((plus + alm.at(3, 2) * Complex64::new(1.0, 0.3)).norm() < 1e-15);
        assert!((minus + alm.at(3, 2).conj() * Complex64::new(1.0, 0.3)).norm() < 1e-15);
    }
}
