//! How much value fits into the time and the places left, overlap ignored: a knapsack bound.
//!
//! Method: [`Knapsack`] is the dynamic programme's table for two capacities: time in [`STEPS`] steps
//! (what a piece takes rounded down, values rounded up, so that the table never falls short) and places
//! for those pieces that are counted. Of the pieces that reach in from before the region at most one
//! per lane is taken. The table holds the answer for every tail of the list of pieces.
//! [`promising`] first leaves out pieces that no set worth more than a given value holds, by the
//! Lagrangian relaxation of the same knapsack, so that the table stays small.
//!
//! Limits: more than [`MOST_PLACES`] places are not counted, and with more than [`MOST_PIECES`]
//! pieces there is no table; the answer is then a larger upper bound.

/// Steps of time in the table.
const STEPS: usize = 240;
/// Values in the table are in units of 2^16, rounded up.
const VALUE_BITS: u32 = 16;
/// Most places that are counted.
const MOST_PLACES: usize = 8;
/// Most pieces in a table.
const MOST_PIECES: usize = 400;
/// Prices of time tried by the relaxation.
const PRICES: u32 = 10;
/// Time in the relaxation is in steps of 2^20 ns.
const STEP_BITS: u32 = 20;

/// What a piece takes besides time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Nothing.
    Free,
    /// One of the places.
    Counted,
    /// The one instant of its lane where the region begins.
    Head(usize),
}

/// Something that takes time and has a value, neither negative.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) value: i64,
    pub(super) time: i64,
    pub(super) kind: Kind,
}

/// The most value that fits, for every tail of a list of pieces.
#[derive(Debug, Default)]
pub(super) struct Knapsack {
    /// By first piece, then places, then steps.
    table: Vec<u32>,
    /// Length of a step, ns.
    step: i64,
    /// Steps and places of a row, each plus one; zero for no table.
    steps: usize,
    places: usize,
}

impl Knapsack {
    /// The table of `pieces`, heads of one lane standing together; no `time` is no limit.
    pub(super) fn new(pieces: &[Piece], time: Option<i64>, places: usize) -> Self {
        if pieces.len() > MOST_PIECES {
            return Self::default();
        }
        let (step, steps) = time.map_or((1, 1), |ns| (ns / 240 + 1, STEPS + 1));
        let places = if places > MOST_PLACES { 1 } else { places + 1 };
        let row = steps * places;
        let mut knapsack = Self { table: vec![0; row * (pieces.len() + 1)], step, steps, places };
        let mut group_end = pieces.len();
        for (index, piece) in pieces.iter().enumerate().rev() {
            let next = pieces.get(index + 1).map(|piece| piece.kind);
            // A head adds to what follows all heads of its lane, any other piece to what follows it.
            group_end = match piece.kind {
                Kind::Head(_) if next == Some(piece.kind) => group_end,
                _ => index + 1,
            };
            let takes =
                time.map_or(0, |_| usize::try_from(piece.time / step).unwrap_or(usize::MAX));
            let counts = usize::from(piece.kind == Kind::Counted && places > 1);
            let value = u32::try_from((piece.value >> VALUE_BITS) + 1).unwrap_or(u32::MAX);
            let (before, after) = knapsack.table.split_at_mut((index + 1) * row);
            let this = &mut before[index * row..];
            this.copy_from_slice(&after[..row]);
            let base = &after[(group_end - index - 1) * row..][..row];
            let Some(room) = steps.checked_sub(takes) else { continue };
            for place in counts..places {
                let from = &base[(place - counts) * steps..][..room];
                let into = &mut this[place * steps + takes..][..room];
                for (into, from) in into.iter_mut().zip(from) {
                    *into = (*into).max(from.saturating_add(value));
                }
            }
        }
        knapsack
    }

    /// The most value that pieces from `first` on add in the time and places left.
    pub(super) fn most(&self, first: usize, time: Option<i64>, places: usize) -> i64 {
        if self.steps == 0 {
            return i64::MAX;
        }
        let step = usize::try_from(time.unwrap_or(0) / self.step).unwrap_or(0).min(self.steps - 1);
        let place = places.min(self.places - 1);
        match self.table[(first * self.places + place) * self.steps + step] {
            u32::MAX => i64::MAX,
            value => i64::from(value) << VALUE_BITS,
        }
    }
}

/// What the Lagrangian relaxation takes at one price of a step of time.
#[derive(Debug, Clone)]
struct Relaxed {
    price: i64,
    /// No set is worth more.
    bound: i64,
    /// Steps taken.
    steps: i64,
    /// Reduced values of the counted pieces taken, largest first; `None` where all are.
    places: Option<Vec<i64>>,
    /// The largest reduced value of a head, per lane.
    heads: Vec<i64>,
}

impl Relaxed {
    fn new(pieces: &[Piece], price: i64, left: i64, places: usize) -> Self {
        let mut top = (places <= MOST_PLACES).then(|| vec![(0, 0); places]);
        let mut heads: Vec<(i64, i64)> = Vec::new();
        let mut bound = price.saturating_mul(left);
        let mut steps = 0_i64;
        for piece in pieces {
            let takes = piece.time >> STEP_BITS;
            let value = piece.value.saturating_sub(price.saturating_mul(takes));
            if value <= 0 {
                continue;
            }
            let mut entry = (value, takes);
            match (piece.kind, &mut top) {
                (Kind::Head(lane), _) => {
                    if heads.len() <= lane {
                        heads.resize(lane + 1, (0, 0));
                    }
                    heads[lane] = heads[lane].max(entry);
                }
                (Kind::Counted, Some(top)) => {
                    for slot in top {
                        if entry.0 > slot.0 {
                            std::mem::swap(slot, &mut entry);
                        }
                    }
                }
                (Kind::Counted | Kind::Free, _) => {
                    bound = bound.saturating_add(value);
                    steps = steps.saturating_add(takes);
                }
            }
        }
        for (value, takes) in top.iter().flatten().chain(&heads) {
            bound = bound.saturating_add(*value);
            steps = steps.saturating_add(*takes);
        }
        let values = |pairs: Vec<(i64, i64)>| pairs.into_iter().map(|pair| pair.0).collect();
        Self { price, bound, steps, places: top.map(values), heads: values(heads) }
    }

    /// No set that holds `piece` is worth more.
    fn with(&self, piece: &Piece) -> i64 {
        let takes = piece.time >> STEP_BITS;
        let value = piece.value.saturating_sub(self.price.saturating_mul(takes));
        let displaced = match (piece.kind, &self.places) {
            (Kind::Head(lane), _) => self.heads.get(lane).copied().unwrap_or(0),
            // One of those taken displaces nothing but itself, another one the least of them.
            (Kind::Counted, Some(top)) => match top.last() {
                Some(&least) => value.max(least),
                None => return i64::MIN,
            },
            (Kind::Counted | Kind::Free, _) => value.max(0),
        };
        self.bound.saturating_sub(displaced).saturating_add(value)
    }
}

/// Which pieces may be part of a set worth more than `worst`.
pub(super) fn promising(
    pieces: &[Piece],
    time: Option<i64>,
    places: usize,
    worst: i64,
) -> Vec<bool> {
    let left = time.map_or(0, |ns| (ns >> STEP_BITS) + 1);
    let mut best = Relaxed::new(pieces, 0, left, places);
    if time.is_some() && best.steps > left {
        let (mut low, mut high) = (0, i64::MAX);
        let mut price = best.bound / best.steps;
        for _ in 0..PRICES {
            let relaxed = Relaxed::new(pieces, price, left, places);
            // The slope of the bound is what is left less what is taken.
            if relaxed.steps > left {
                low = price;
            } else {
                high = price;
            }
            if relaxed.bound < best.bound {
                best = relaxed;
            }
            let twice = price.saturating_mul(2);
            price = if high == i64::MAX { twice } else { i64::midpoint(low, high) };
            if price <= low {
                break;
            }
        }
    }
    pieces.iter().map(|piece| best.with(piece) > worst).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ephem::random::SplitMix64;

    /// The best value over all subsets, by trying each.
    fn by_trying(pieces: &[Piece], time: i64, places: usize) -> (i64, u32) {
        let mut best = (0, 0);
        'sets: for set in 0_u32..1 << pieces.len() {
            let (mut value, mut used, mut counted, mut lanes) = (0, 0, 0, 0_u32);
            for (index, piece) in pieces.iter().enumerate() {
                if set >> index & 1 == 0 {
                    continue;
                }
                value += piece.value;
                used += piece.time;
                counted += usize::from(piece.kind == Kind::Counted);
                if let Kind::Head(lane) = piece.kind {
                    if lanes >> lane & 1 == 1 {
                        continue 'sets;
                    }
                    lanes |= 1 << lane;
                }
            }
            if used <= time && counted <= places && value > best.0 {
                best = (value, set);
            }
        }
        best
    }

    #[test]
    fn the_table_and_the_filter_never_fall_short() {
        let mut random = SplitMix64(9);
        let mut next = |below: i64| random.up_to(below - 1);
        let (mut tight, mut dropped) = (0, 0);
        for round in 0..300 {
            let heads = usize::try_from(next(4)).unwrap();
            let pieces: Vec<Piece> = (0..10)
                .map(|index| Piece {
                    value: (next(1 << 20) + 1) << 20,
                    time: (next(100) + 1) << 34,
                    kind: match index {
                        _ if index < heads => Kind::Head(index / 2),
                        _ if next(4) == 0 => Kind::Free,
                        _ => Kind::Counted,
                    },
                })
                .collect();
            let (time, places) = (next(300) << 34, usize::try_from(next(5)).unwrap());
            let (best, set) = by_trying(&pieces, time, places);
            let table = Knapsack::new(&pieces, Some(time), places).most(0, Some(time), places);
            assert!(table >= best, "round {round}: {table} < {best}");
            tight += i32::from(table - best < best / 1_000);
            let keep = promising(&pieces, Some(time), places, best - 1);
            for (index, keep) in keep.iter().enumerate() {
                assert!(*keep || set >> index & 1 == 0, "round {round} drops piece {index}");
                dropped += i32::from(!keep);
            }
        }
        assert!(tight > 200 && dropped > 500, "{tight} tables tight, {dropped} pieces dropped");
    }

    #[test]
    fn no_limits_and_no_table_are_told_apart() {
        let piece = Piece { value: 5 << VALUE_BITS, time: 7, kind: Kind::Free };
        let free = Knapsack::new(&[piece; 3], None, usize::MAX);
        assert_eq!(free.most(1, None, usize::MAX), 12 << VALUE_BITS);
        let many = vec![piece; MOST_PIECES + 1];
        assert_eq!(Knapsack::new(&many, None, 3).most(0, None, 3), i64::MAX);
    }
}
