//! Which node of branch and bound comes next: best bound first.
//!
//! Method: an ordered set of bounds beside the nodes; ties fall to the earlier node.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Choices fixed, and the bound on what they allow.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub(super) bound: i128,
    pub(super) fixes: Vec<(usize, bool)>,
}

/// Nodes that wait, by bound, the earlier first where bounds tie.
#[derive(Debug, Clone, Default)]
pub(super) struct Waiting {
    order: BTreeSet<(i128, Reverse<usize>)>,
    nodes: BTreeMap<usize, Node>,
    number: usize,
}

impl Waiting {
    pub(super) fn add(&mut self, node: Node) {
        self.order.insert((node.bound, Reverse(self.number)));
        self.nodes.insert(self.number, node);
        self.number += 1;
    }

    pub(super) fn next(&mut self) -> Option<Node> {
        let (_, Reverse(number)) = self.order.pop_last()?;
        self.nodes.remove(&number)
    }

    pub(super) fn largest(&self) -> Option<i128> {
        self.order.last().map(|it| it.0)
    }
}
