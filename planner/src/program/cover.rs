//! Lifted cover cuts of rows of coefficients at or above zero (knapsacks).
//!
//! Method: choices C with `sum a_i > b` are a cover, of which at most |C| - 1 may be taken. The cover is
//! found greedily by the relaxation's shares and made minimal; every other choice whose coefficient is
//! at least the sum of the h largest of the cover counts h times (Balas 1975). A cut is kept where the
//! shares violate it. Integers only, so a cut removes no set.
//!
//! Limits: at most one cut per row and round.

use super::number::{f64_from_i64, f64_from_usize, i64_from_usize};
use super::problem::{Choice, Program, Row};

/// Shares must violate a cut by this much.
const BROKEN: f64 = 0.02;

/// Cuts that the shares violate.
pub(super) fn separate(program: &Program, shares: &[f64]) -> Vec<Row> {
    let mut cuts: Vec<Row> =
        program.rows.iter().filter_map(|row| cut(program, row, shares)).collect();
    cuts.sort_by(|a, b| (&a.terms, a.limit).cmp(&(&b.terms, b.limit)));
    cuts.dedup();
    cuts
}

fn cut(program: &Program, row: &Row, shares: &[f64]) -> Option<Row> {
    if row.limit < 0 || row.terms.iter().any(|it| it.1 < 0) {
        return None;
    }
    // Rows of ones are their own covers.
    let first = row.terms.first()?.1;
    if row.terms.iter().all(|it| it.1 == first) && row.limit % first.max(1) == 0 {
        return None;
    }
    let open = |it: &&(usize, i64)| it.1 > 0 && program.choices[it.0] != Choice::Never;
    let mut order: Vec<(usize, i64)> =
        row.terms.iter().filter(open).filter(|it| shares[it.0] > 1e-6).copied().collect();
    // Least lack of share per coefficient first.
    let lack = |it: &(usize, i64)| (1.0 - shares[it.0]).max(0.0) / f64_from_i64(it.1);
    order.sort_by(|a, b| lack(a).total_cmp(&lack(b)).then(b.1.cmp(&a.1)).then(a.0.cmp(&b.0)));
    let limit = i128::from(row.limit);
    let mut sum = 0_i128;
    let mut cover: Vec<(usize, i64)> = Vec::new();
    for it in order {
        cover.push(it);
        sum += i128::from(it.1);
        if sum > limit {
            break;
        }
    }
    if sum <= limit {
        return None;
    }
    // Without what is not needed, the smallest share first.
    let mut by_share = cover.clone();
    by_share.sort_by(|a, b| shares[a.0].total_cmp(&shares[b.0]).then(a.0.cmp(&b.0)));
    for it in by_share {
        if sum - i128::from(it.1) > limit {
            sum -= i128::from(it.1);
            cover.retain(|other| other.0 != it.0);
        }
    }
    cover.sort_by_key(|it| std::cmp::Reverse(it.1));
    let mut sums = vec![0_i128];
    for it in &cover {
        sums.push(sums[sums.len() - 1] + i128::from(it.1));
    }
    let mut terms: Vec<(usize, i64)> = cover.iter().map(|it| (it.0, 1)).collect();
    terms.sort_unstable();
    let inside = terms.clone();
    for it in row.terms.iter().filter(open) {
        if inside.binary_search(&(it.0, 1)).is_err() {
            let times = sums.partition_point(|&sum| sum <= i128::from(it.1)) - 1;
            if times > 0 {
                terms.push((it.0, i64_from_usize(times)));
            }
        }
    }
    terms.sort_unstable();
    let most = cover.len() - 1;
    let used: f64 = terms.iter().map(|&(choice, times)| shares[choice] * f64_from_i64(times)).sum();
    let broken = used > f64_from_usize(most) + BROKEN;
    broken.then(|| Row { terms, limit: i64_from_usize(most) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ephem::random::SplitMix64;

    #[test]
    fn cuts_remove_shares_but_no_set() {
        let mut random = SplitMix64(11);
        let mut found = 0;
        for _ in 0..500 {
            let count = 10;
            let terms: Vec<(usize, i64)> =
                (0..count).map(|at| (at, random.up_to(29) + 1)).collect();
            let limit = random.up_to(99) + 20;
            let row = Row { terms: terms.clone(), limit };
            let program = Program {
                values: vec![1; count],
                choices: vec![Choice::Free; count],
                rows: vec![row],
                cells: Vec::new(),
            };
            let shares: Vec<f64> =
                (0..count).map(|_| f64_from_i64(random.up_to(4)) / 4.0).collect();
            for cut in separate(&program, &shares) {
                found += 1;
                for set in 0_u32..1 << count {
                    let sum = |terms: &[(usize, i64)]| -> i64 {
                        terms.iter().filter(|it| set >> it.0 & 1 == 1).map(|it| it.1).sum()
                    };
                    assert!(sum(&terms) > limit || sum(&cut.terms) <= cut.limit);
                }
            }
        }
        assert!(found > 50, "{found}");
    }
}
