//! From a binary tree to one of eight-wide nodes, a subtree by each thread.

#![expect(clippy::cast_possible_truncation, reason = "elements are counted in u32")]

use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;

use super::cover::{Cover, Part, Triangles};
use super::node::{Child, Node};

/// Subtrees that are collapsed on their own, each into one slot, so that threads share the work.
const PARTS: usize = 64;

/// Items from which on the work is shared.
pub(super) const SHARED_FROM: usize = 1 << 14;

/// A tree of eight-wide nodes over ranges of items.
#[derive(Debug, Clone, Default)]
pub(super) struct WideTree {
    pub(super) root: Child,
    pub(super) nodes: Vec<Node>,
    /// The end of each leaf's range of `order`; it begins where the one before ends.
    pub(super) leaf_ends: Vec<u32>,
    /// The items in the order of the leaves.
    pub(super) order: Vec<u32>,
    /// Levels of nodes.
    pub(super) depth: usize,
}

/// Collapses a tree whose leaves hold one item each; no item beyond the end of `triangles` is one.
pub(super) fn collapse(tree: &Bvh2, triangles: Triangles) -> WideTree {
    let mut wide = WideTree::default();
    if tree.nodes.is_empty() {
        return wide;
    }
    let shared = tree.primitive_indices.len() >= SHARED_FROM;
    let roots = if shared { frontier(&tree.nodes) } else { Vec::new() };
    let piece = |cover: &mut Cover, &root: &u32| {
        let mut wide = WideTree::default();
        (cover.collapse(root, &mut wide), wide)
    };
    let pieces: Vec<_> = roots.par_iter().map_init(|| Cover::new(tree, triangles, &[]), piece).collect();
    let mut parts: Vec<Part> = pieces.into_iter().map(|(part, piece)| wide.append(part, piece)).collect();
    parts.sort_unstable_by_key(|part| part.node);
    let whole = Cover::new(tree, triangles, &parts).collapse(0, &mut wide);
    (wide.root, wide.depth) = (whole.child, whole.depth);
    wide
}

/// The nodes of the first level that has enough of them.
fn frontier(nodes: &[Bvh2Node]) -> Vec<u32> {
    let mut level = vec![0];
    while level.len() < PARTS && level.iter().any(|&n| !nodes[n as usize].is_leaf()) {
        let below = |n: u32| {
            let node = &nodes[n as usize];
            let first = node.first_index;
            if node.is_leaf() { vec![n] } else { vec![first, first + 1] }
        };
        level = level.into_iter().flat_map(below).collect();
    }
    level
}

impl WideTree {
    /// Takes over the nodes and leaves of `piece`; returns what it is here.
    fn append(&mut self, part: Part, piece: Self) -> Part {
        let (node, leaf) = (self.nodes.len(), self.leaf_ends.len());
        let first = self.order.len() as u32;
        let shift = |child: Child| child.shifted(node, leaf);
        self.nodes.extend(piece.nodes.into_iter().map(|n| n.with_children(shift)));
        self.leaf_ends.extend(piece.leaf_ends.into_iter().map(|end| first + end));
        self.order.extend(piece.order);
        Part { child: shift(part.child), ..part }
    }
}
