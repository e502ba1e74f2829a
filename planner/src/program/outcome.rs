//! What a search found: a set, a bound on all sets, and the multipliers of the relaxation.

/// Why the search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// No better set exists, or none at all.
    Proven,
    /// The limit on the work was reached.
    Work,
    /// The caller asked to stop.
    Stopped,
}

/// The best set found, and how good it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The choices taken, ascending; `None` where no set was found that meets all rows.
    pub taken: Option<Vec<usize>>,
    /// Value of the set in units; 0 without one.
    pub value: i128,
    /// No set is worth more, in units.
    pub bound: i128,
    /// The bound of the linear relaxation alone.
    pub relaxed: i128,
    /// Dual price of each row of the programme in units of value per unit of its limit.
    pub prices: Vec<f64>,
    /// The same summed over the rows that each family added to the relaxation.
    pub family_prices: Vec<f64>,
    /// Slope of each cell's gain in units of value per unit of its sum.
    pub slopes: Vec<f64>,
    /// Share of each choice in the relaxation.
    pub shares: Vec<f64>,
    /// Why the search ended.
    pub ended: Ended,
    /// Nodes of the final branch and bound.
    pub nodes: usize,
    /// Rows added as cuts or by families to the whole programme.
    pub cuts: usize,
}
