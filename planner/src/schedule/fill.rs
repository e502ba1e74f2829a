//! How much value fits into the time and the places left, overlap ignored.
//!
//! Method: [`Fill`] is the table of the knapsack with two capacities, time in [`STEPS`] steps
//! (what a piece takes rounded down, so that the table never falls short) and places for those
//! pieces that are counted; of the pieces that reach in from before the region at most one per lane
//! is taken. It holds the answer for every tail of the list of pieces. [`promising`] first leaves
//! out pieces that no set worth more than a given value holds, by Lagrange's relaxation of the same
//! knapsack, so that the table stays small.
//!
//! Limits: more places than [`MOST_PLACES`] are not counted; the answer is then an upper bound.

/// Steps of time in the table.
const STEPS: usize = 480;
/// Most places that are counted.
const MOST_PLACES: usize = 8;
/// Most pieces in a table; with more, the table says nothing.
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

/// Something that takes time and has a value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) value: i64,
    pub(super) time: i64,
    pub(super) kind: Kind,
}

/// The most value that fits, for every tail of a list of pieces.
#[derive(Debug, Default)]
pub(super) struct Fill {
    /// By first piece, then places, then steps.
    table: Vec<i64>,
    /// Length of a step, ns.
    step: i64,
    /// Steps and places of a row, each plus one; zero for no table.
    steps: usize,
    places: usize,
}

impl Fill {
    /// The table of `pieces`, heads of one lane standing together; `time` is the largest number
    /// where time has no limit.
    pub(super) fn new(pieces: &[Piece], time: i64, places: usize) -> Self {
        if pieces.len() > MOST_PIECES {
            return Self::default();
        }
        let limited = time < i64::MAX;
        let step = if limited { time / 480 + 1 } else { i64::MAX };
        let steps = if limited { STEPS + 1 } else { 1 };
        let places = if places > MOST_PLACES { 1 } else { places + 1 };
        let row = steps * places;
        let mut fill = Self { table: vec![0; row * (pieces.len() + 1)], step, steps, places };
        let mut group_end = pieces.len();
        for (index, piece) in pieces.iter().enumerate().rev() {
            let next = pieces.get(index + 1).map(|piece| piece.kind);
            let base = match piece.kind {
                Kind::Head(_) if next == Some(piece.kind) => group_end,
                _ => index + 1,
            };
            group_end = base;
            let takes =
                if limited { usize::try_from(piece.time / step).unwrap_or(steps) } else { 0 };
            let counts = usize::from(piece.kind == Kind::Counted && places > 1);
            let (head, tail) = fill.table.split_at_mut((index + 1) * row);
            let this = &mut head[index * row..];
            this.copy_from_slice(&tail[..row]);
            let base = &tail[(base - index - 1) * row..][..row];
            for place in counts..places {
                let Some(room) = steps.checked_sub(takes) else { continue };
                let from = &base[(place - counts) * steps..][..room];
                let into = &mut this[place * steps + takes..][..room];
                for (into, from) in into.iter_mut().zip(from) {
                    *into = (*into).max(from.saturating_add(piece.value));
                }
            }
        }
        fill
    }

    /// The most value that pieces from `first` on add in the time and places left.
    pub(super) fn most(&self, first: usize, time: i64, places: usize) -> i64 {
        if self.steps == 0 {
            return i64::MAX;
        }
        let step = usize::try_from(time / self.step).unwrap_or(0).min(self.steps - 1);
        let place = places.min(self.places - 1);
        self.table[(first * self.places + place) * self.steps + step]
    }
}

/// What the relaxation takes at one price of time.
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
        let steps = piece.time >> STEP_BITS;
        let gain = piece.value.saturating_sub(self.price.saturating_mul(steps));
        let displaced = match (piece.kind, &self.places) {
            (Kind::Head(lane), _) => self.heads.get(lane).copied().unwrap_or(0),
            // One of those taken displaces nothing but itself, another one the least of them.
            (Kind::Counted, Some(places)) => match places.last() {
                Some(&least) => gain.max(least),
                None => return i64::MIN,
            },
            (Kind::Counted | Kind::Free, _) => gain.max(0),
        };
        self.bound.saturating_sub(displaced).saturating_add(gain)
    }
}

/// Which pieces may be part of a set worth more than `worst`.
pub(super) fn promising(pieces: &[Piece], time: i64, places: usize, worst: i64) -> Vec<bool> {
    let left = if time < i64::MAX { (time >> STEP_BITS) + 1 } else { 0 };
    let mut best = Relaxed::new(pieces, 0, left, places);
    if time < i64::MAX && best.steps > left {
        let (mut low, mut high) = (0, i64::MAX);
        let mut price = best.bound / left.max(best.steps);
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
            price =
                if high == i64::MAX { price.saturating_mul(2) } else { i64::midpoint(low, high) };
            if price <= low {
                break;
            }
        }
    }
    pieces.iter().map(|piece| best.with(piece) > worst).collect()
}
