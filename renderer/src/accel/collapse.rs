//! From a binary tree to one of eight-wide nodes: which boxes to keep.
//!
//! The choice minimises the expected cost of a random ray, a node's or leaf's cost times its surface area, over all
//! ways to cover each binary subtree by up to seven slots.
//!
//! # Source
//! Ylitie, Karras, Laine 2017, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, section 4.1,
//! DOI 10.1145/3105762.3105773.

#![expect(clippy::cast_possible_truncation, reason = "elements are counted in u32, slots up to 8")]

use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;

use super::block::Vertices;
use super::node::{Bounds32, Child, Node, WIDTH};

/// Cost of testing a leaf against that of a node; measured in benches/README.md.
const LEAF_COST: f32 = 1.5;

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

/// A part of the wide tree that stands for a binary node.
#[derive(Debug, Clone, Copy)]
struct Part {
    node: u32,
    cost: f32,
    child: Child,
    depth: usize,
}

/// The vertices of each item, of which leaves have room for eight; `None` for what takes a leaf of its own.
type Room<'a> = &'a (dyn Fn(u32) -> Option<Vertices> + Sync);

/// Collapses a tree whose leaves hold one item each.
pub(super) fn collapse(tree: &Bvh2, room: Room) -> WideTree {
    let mut wide = WideTree::default();
    if tree.nodes.is_empty() {
        return wide;
    }
    let shared = tree.primitive_indices.len() >= SHARED_FROM;
    let roots = if shared { frontier(&tree.nodes) } else { Vec::new() };
    let pieces: Vec<_> = roots.par_iter().map(|&root| piece(tree, room, root)).collect();
    let mut parts: Vec<Part> = pieces.into_iter().map(|(part, piece)| wide.append(part, piece)).collect();
    parts.sort_unstable_by_key(|part| part.node);
    let whole = Cover::new(tree, room, 0, &parts).emit(&mut wide);
    (wide.root, wide.depth) = (whole.child, whole.depth);
    wide
}

/// A subtree collapsed on its own.
fn piece(tree: &Bvh2, room: Room, root: u32) -> (Part, WideTree) {
    let mut wide = WideTree::default();
    let part = Cover::new(tree, room, root, &[]).emit(&mut wide);
    (part, wide)
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

/// A binary subtree in depth-first order, with the best way to cover each of its nodes.
struct Cover<'a> {
    tree: &'a Bvh2,
    entries: Vec<Entry>,
    parts: &'a [Part],
}

/// A node of the subtree. Its left child follows it.
struct Entry {
    node: u32,
    /// The binary node's first child or item, and half its surface: its memory is far from that of the nodes before and after.
    first: u32,
    area: f32,
    /// Index of the right child; 0 without children.
    right: u32,
    /// How many items it has; more than a leaf may have where they don't go into one.
    count: u32,
    /// Lowest cost of covering it by up to 1, 2, … 7 slots.
    costs: [f32; WIDTH - 1],
    /// How many of 2, … 8 slots the left child gets; 0 to leave one slot free. First, whether it becomes a leaf (0) or
    /// a node (1) where it gets one slot.
    left: [u8; WIDTH],
}

impl<'a> Cover<'a> {
    fn new(tree: &'a Bvh2, room: Room<'a>, root: u32, parts: &'a [Part]) -> Self {
        let mut cover = Self { tree, entries: Vec::new(), parts };
        cover.lay_out(root);
        let mut waiting = Vec::new();
        for index in (0..cover.entries.len()).rev() {
            let vertices = cover.vertices(index, room, &mut waiting);
            cover.choose(index, vertices.is_some());
            waiting.push(vertices);
        }
        cover
    }

    /// The vertices of an entry, if it may become a leaf; those of its children, which come after it, wait on top.
    fn vertices(&self, index: usize, room: Room, waiting: &mut Vec<Option<Vertices>>) -> Option<Vertices> {
        let entry = &self.entries[index];
        if entry.right != 0 {
            let (left, right) = (waiting.pop()?, waiting.pop()?);
            return left?.union(&right?);
        }
        if self.part(entry.node).is_some() { None } else { room(self.item(entry)) }
    }

    fn part(&self, node: u32) -> Option<&'a Part> {
        self.parts.binary_search_by_key(&node, |part| part.node).ok().map(|i| &self.parts[i])
    }

    /// The item of a leaf of the binary tree.
    fn item(&self, entry: &Entry) -> u32 {
        self.tree.primitive_indices[entry.first as usize]
    }

    /// Lists the nodes depth first.
    fn lay_out(&mut self, root: u32) {
        // Nodes to come, with the entry whose right child they are.
        let mut stack = vec![(root, None)];
        while let Some((node, parent)) = stack.pop() {
            let index = self.entries.len();
            if let Some(parent) = parent {
                let parent: &mut Entry = &mut self.entries[parent as usize];
                parent.right = index as u32;
            }
            let binary = &self.tree.nodes[node as usize];
            let (first, area) = (binary.first_index, binary.aabb().half_area());
            let (costs, left) = ([0.0; WIDTH - 1], [0; WIDTH]);
            self.entries.push(Entry { node, first, area, right: 0, count: 1, costs, left });
            if !binary.is_leaf() && self.part(node).is_none() {
                stack.push((first + 1, Some(index as u32)));
                stack.push((first, None));
            }
        }
    }

    /// Finds the best covers of an entry whose children have theirs; a leaf has room for its vertices, or not.
    fn choose(&mut self, index: usize, has_room: bool) {
        let entry = &self.entries[index];
        let area = entry.area;
        if entry.right == 0 {
            let part = self.part(entry.node);
            let entry = &mut self.entries[index];
            entry.costs = [part.map_or(area * LEAF_COST, |p| p.cost); WIDTH - 1];
            entry.count = if has_room { 1 } else { WIDTH as u32 + 1 };
            return;
        }
        let (left, right) = (&self.entries[index + 1], &self.entries[entry.right as usize]);
        let count = if has_room { left.count + right.count } else { WIDTH as u32 + 1 };
        let count = count.min(WIDTH as u32 + 1);
        let mut costs = [f32::INFINITY; WIDTH + 1];
        let mut choice = [0u8; WIDTH];
        for slots in 2..=WIDTH {
            for k in 1..slots {
                let cost = left.costs[k - 1] + right.costs[slots - k - 1];
                if cost < costs[slots] {
                    costs[slots] = cost;
                    choice[slots - 1] = k as u8;
                }
            }
        }
        let as_node = costs[WIDTH] + area;
        let as_leaf = if count <= WIDTH as u32 { area * LEAF_COST } else { f32::INFINITY };
        choice[0] = u8::from(as_node < as_leaf);
        costs[1] = as_node.min(as_leaf);
        for slots in 2..WIDTH {
            if costs[slots - 1] <= costs[slots] {
                costs[slots] = costs[slots - 1];
                choice[slots - 1] = 0;
            }
        }
        let entry = &mut self.entries[index];
        entry.count = count;
        entry.costs.copy_from_slice(&costs[1..WIDTH]);
        entry.left = choice;
    }

    /// Writes the wide tree of the best cover; returns what it is to a tree above.
    fn emit(&self, out: &mut WideTree) -> Part {
        let root = &self.entries[0];
        let (child, place) = self.child(0, out);
        let depth = place.map_or(0, |place| self.fill(0, place, out));
        Part { node: root.node, cost: root.costs[0], child, depth }
    }

    /// What an entry becomes in one slot; a leaf is written at once, for a node the place to write it is returned too.
    fn child(&self, index: usize, out: &mut WideTree) -> (Child, Option<usize>) {
        let entry = &self.entries[index];
        if let Some(part) = self.part(entry.node) {
            return (part.child, None);
        }
        if entry.right == 0 || entry.left[0] == 0 {
            // Items that take all the room have a leaf of their own; the others take 1 each.
            let nodes = if entry.right == 0 { 1 } else { 2 * entry.count as usize - 1 };
            let items = self.entries[index..index + nodes].iter().filter(|e| e.right == 0);
            out.order.extend(items.map(|e| self.item(e)));
            out.leaf_ends.push(out.order.len() as u32);
            return (Child::new(out.leaf_ends.len() - 1, true), None);
        }
        out.nodes.push(Node::new(&[]));
        let place = out.nodes.len() - 1;
        (Child::new(place, false), Some(place))
    }

    /// Writes the node of an entry and what is below it; returns the levels of nodes.
    ///
    /// Siblings lie side by side, before what is below them.
    fn fill(&self, index: usize, place: usize, out: &mut WideTree) -> usize {
        let mut slots = Vec::with_capacity(WIDTH);
        let left = usize::from(self.entries[index].left[WIDTH - 1]);
        self.slots(index + 1, left, &mut slots);
        self.slots(self.entries[index].right as usize, WIDTH - left, &mut slots);
        let mut children = Vec::with_capacity(WIDTH);
        let mut below = Vec::with_capacity(WIDTH);
        let mut depth = 0;
        for slot in slots {
            let node = self.entries[slot].node;
            let (child, place) = self.child(slot, out);
            let aabb = self.tree.nodes[node as usize].aabb();
            children.push((Bounds32 { min: aabb.min.into(), max: aabb.max.into() }, child));
            below.extend(place.map(|p| (slot, p)));
            depth = depth.max(self.part(node).map_or(0, |p| p.depth));
        }
        out.nodes[place] = Node::new(&children);
        for (slot, place) in below {
            depth = depth.max(self.fill(slot, place, out));
        }
        depth + 1
    }

    /// The entries that cover an entry by up to `count` slots.
    fn slots(&self, index: usize, mut count: usize, out: &mut Vec<usize>) {
        let entry = &self.entries[index];
        while count > 1 && entry.left[count - 1] == 0 {
            count -= 1;
        }
        if count == 1 {
            out.push(index);
            return;
        }
        let left = usize::from(entry.left[count - 1]);
        self.slots(index + 1, left, out);
        self.slots(entry.right as usize, count - left, out);
    }
}
