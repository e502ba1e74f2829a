//! Coefficients of a real field: `a_lm` for m not negative.
//!
//! Those of negative m are `a_(l,-m) = (-1)^m conj a_lm`.
//!
//! Order in memory: by m, then by l, as healpy has it.

use super::Complex64;

/// The coefficients `a_lm`, l from 0 to `l_max`, m from 0 to l.
#[derive(Debug, Clone, PartialEq)]
pub struct Alm {
    l_max: usize,
    values: Vec<Complex64>,
}

impl Alm {
    /// All zero.
    #[must_use]
    pub fn zero(l_max: usize) -> Self {
        let count = (l_max + 1) * (l_max + 2) / 2;
        Self { l_max, values: vec![Complex64::ZERO; count] }
    }

    /// From rows by m, each from l = m; `None` where a row has another length.
    #[must_use]
    pub fn from_rows(l_max: usize, rows: impl IntoIterator<Item = Vec<Complex64>>) -> Option<Self> {
        let mut values = Vec::with_capacity((l_max + 1) * (l_max + 2) / 2);
        let mut m = 0;
        for row in rows {
            if m > l_max || row.len() != l_max + 1 - m {
                return None;
            }
            values.extend(row);
            m += 1;
        }
        (m == l_max + 1).then_some(Self { l_max, values })
    }

    /// The largest degree.
    #[must_use]
    pub const fn l_max(&self) -> usize {
        self.l_max
    }

    fn start(&self, m: usize) -> usize {
        m * (2 * self.l_max + 3 - m) / 2
    }

    fn index(&self, l: usize, m: usize) -> Option<usize> {
        (m <= l && l <= self.l_max).then(|| self.start(m) + l - m)
    }

    /// The coefficient of l and m; zero where there is none.
    #[must_use]
    pub fn at(&self, l: usize, m: usize) -> Complex64 {
        self.index(l, m).map_or(Complex64::ZERO, |at| self.values[at])
    }

    /// Sets the coefficient of l and m; nothing where there is none.
    pub fn set(&mut self, l: usize, m: usize, value: Complex64) {
        if let Some(at) = self.index(l, m) {
            self.values[at] = value;
        }
    }

    /// The coefficients of m from l = m; empty beyond the last m.
    #[must_use]
    pub fn row(&self, m: usize) -> &[Complex64] {
        if m > self.l_max {
            return &[];
        }
        let start = self.start(m);
        &self.values[start..=start + self.l_max - m]
    }

    /// Each coefficient times the weight of its degree; degrees without one become zero.
    #[must_use]
    pub fn weighted(&self, weight: impl Fn(usize) -> f64) -> Self {
        let mut to = self.clone();
        let weights: Vec<f64> = (0..=self.l_max).map(weight).collect();
        for m in 0..=self.l_max {
            let start = self.start(m);
            for (value, weight) in to.values[start..].iter_mut().zip(&weights[m..]) {
                *value *= weight;
            }
        }
        to
    }

    /// The sum with coefficients of the same degrees; those beyond are left out.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mut to = self.clone();
        for m in 0..=self.l_max {
            let start = self.start(m);
            for (value, more) in to.values[start..].iter_mut().zip(other.row(m)) {
                *value += more;
            }
        }
        to
    }

    /// The same to another degree, cut off or filled with zeros.
    #[must_use]
    pub fn to_degree(&self, l_max: usize) -> Self {
        let mut to = Self::zero(l_max);
        for m in 0..=l_max.min(self.l_max) {
            let start = to.start(m);
            let count = l_max - m + 1;
            for (value, from) in to.values[start..start + count].iter_mut().zip(self.row(m)) {
                *value = *from;
            }
        }
        to
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_and_orders_have_their_places() {
        let mut alm = Alm::zero(3);
        alm.set(3, 2, Complex64::new(1.0, -2.0));
        alm.set(4, 0, Complex64::ONE);
        alm.set(2, 3, Complex64::ONE);
        assert_eq!(alm.at(3, 2), Complex64::new(1.0, -2.0));
        assert_eq!((alm.at(4, 0), alm.at(2, 3)), (Complex64::ZERO, Complex64::ZERO));
        assert_eq!(alm.row(2), &[Complex64::ZERO, Complex64::new(1.0, -2.0)]);
        assert_eq!((alm.row(3).len(), alm.row(4).len()), (1, 0));
        let wide = alm.to_degree(5);
        assert_eq!((wide.at(3, 2), wide.row(2).len()), (alm.at(3, 2), 4));
        assert_eq!(wide.to_degree(3), alm);
        let doubled = alm.plus(&alm).weighted(|l| if l == 3 { 0.5 } else { 7.0 });
        assert_eq!(doubled, alm);
        let rows: Vec<Vec<Complex64>> = (0..4).map(|m| alm.row(m).to_vec()).collect();
        assert_eq!(Alm::from_rows(3, rows.clone()), Some(alm));
        assert_eq!(Alm::from_rows(3, rows.into_iter().take(3)), None);
    }
}
