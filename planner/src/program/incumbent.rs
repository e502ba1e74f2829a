//! The best set so far: which sets may replace it, and how it is improved as a whole.
//!
//! A set is offered as marks, one per choice. It replaces the incumbent where it meets every row, every
//! family and every fixed choice, and is worth more.

use super::family::Family;
use super::large_neighbourhood::Construction;
use super::options::Aids;
use super::problem::Program;
use super::round;
use super::state::{Index, State};

/// A set as marks and its value, where there is one.
pub(super) type Incumbent = Option<(Vec<bool>, i128)>;

/// A programme with what its sets are judged by.
#[derive(Clone, Copy)]
pub(super) struct Judge<'p, 'a> {
    pub(super) program: &'p Program,
    pub(super) index: &'p Index,
    pub(super) aids: &'p Aids<'a>,
    /// What each choice costs; empty where sets are not filled up.
    pub(super) costs: &'p [f64],
}

impl Judge<'_, '_> {
    /// Keeps a set that meets all rows and is better. What violates rows of families is removed first,
    /// and the room that leaves is filled.
    pub(super) fn offer(&self, set: &[bool], best: &mut Incumbent) {
        if !self.is_better(set, best, &[]) {
            return;
        }
        let families = self.aids.families;
        let own = round::within_families(self.program, self.index, families, set.to_vec());
        let room = own != set && !self.costs.is_empty();
        let set = if room { self.filled(own) } else { own };
        if self.is_better(&set, best, families) {
            let value = State::of(self.program, self.index, &set).value();
            *best = Some((set, value));
        }
    }

    /// Offers the greedy fill of what must be taken.
    pub(super) fn offer_filled(&self, best: &mut Incumbent) {
        let set = self.filled(round::always(self.program, self.index).marks());
        self.offer(&set, best);
    }

    /// The incumbent after a large-neighbourhood search.
    pub(super) fn renew(&self, best: &mut Incumbent) {
        if let Some((set, value)) = best {
            let mut construction =
                Construction::new(self.program, self.index, self.aids, set.clone());
            construction.improve(self.costs);
            let better = construction.marks();
            *value = State::of(self.program, self.index, &better).value();
            *set = better;
        }
    }

    /// A set that violates nothing, filled greedily.
    fn filled(&self, set: Vec<bool>) -> Vec<bool> {
        let all = 0..set.len();
        let mut construction = Construction::new(self.program, self.index, self.aids, set);
        construction.fill(all, &|choice| self.costs[choice]);
        construction.marks()
    }

    /// Whether a set meets all rows, these families too, and is worth more than the incumbent.
    fn is_better(&self, set: &[bool], best: &Incumbent, families: &[&dyn Family]) -> bool {
        let state = State::of(self.program, self.index, set);
        best.as_ref().is_none_or(|(_, value)| state.value() > *value)
            && state.meets_choices()
            && state.broken_rows().next().is_none()
            && families.iter().all(|family| family.broken(set).is_empty())
    }
}
