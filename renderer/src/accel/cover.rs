//! Which boxes of a binary tree to keep in one of eight-wide nodes.
//!
//! The choice minimises the expected cost of a random ray, a node's or leaf's cost times its surface area, over all
//! ways to cover each binary subtree by up to seven slots.
//!
//! # Source
//! Ylitie, Karras, Laine 2017, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, section 4.1,
//! DOI 10.1145/3105762.3105773.

#![expect(clippy::cast_possible_truncation, reason = "elements are counted in u32, slots up to 8")]

use std::collections::VecDeque;

use glam::Vec3;
use obvhs::bvh2::Bvh2;
use wide::f32x8;

use super::block::Vertices;
use super::collapse::WideTree;
use super::node::{AHEAD, Bounds32, Child, Node, WIDTH, prefetch};

/// Cost of testing a leaf against that of a node; measured in benches/README.md.
const LEAF_COST: f32 = 1.5;

/// A part of the wide tree that stands for a binary node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub(super) node: u32,
    pub(super) cost: f32,
    pub(super) child: Child,
    pub(super) depth: usize,
}

/// The triangles among the items, of which leaves have room for eight vertices; what isn't one takes a leaf of its own.
pub(super) type Triangles<'a> = &'a [Option<[Vec3; 3]>];

/// A binary subtree level by level, with the best way to cover each of its nodes.
pub(super) struct Cover<'a> {
    tree: &'a Bvh2,
    triangles: Triangles<'a>,
    parts: &'a [Part],
    /// Boxes are scaled by it where areas are added: a power of 2 with which the largest side of all is 1 to 2.
    scale: f32,
    entries: Vec<Entry>,
    /// The vertices of entries whose parents' are to come; `None` of those that may not become a leaf.
    waiting: VecDeque<Option<Vertices>>,
}

/// A node of the subtree.
struct Entry {
    node: u32,
    /// The item of a leaf.
    item: u32,
    /// The node's box: its own memory is far from that of the nodes before and after.
    bounds: Bounds32,
    /// Index of the left child, which the right one follows; 0 without children.
    children: u32,
    /// How many items it has; more than a leaf may have where they don't go into one.
    count: u32,
    /// Lowest cost of covering it by up to 1, 2, … 7 slots.
    costs: [f32; WIDTH - 1],
    /// How many of 2, … 8 slots the left child gets; 0 to leave one slot free. First, whether it becomes a leaf (0) or
    /// a node (1) where it gets one slot.
    left: [u8; WIDTH],
}

impl Entry {
    fn new(node: u32) -> Self {
        let (bounds, costs, left) = (Bounds32::default(), [0.0; WIDTH - 1], [0; WIDTH]);
        Self { node, item: 0, bounds, children: 0, count: 1, costs, left }
    }
}

impl<'a> Cover<'a> {
    pub(super) fn new(tree: &'a Bvh2, triangles: Triangles<'a>, parts: &'a [Part]) -> Self {
        let largest = tree.nodes[0].aabb().diagonal().max_element().max(f32::MIN_POSITIVE);
        let scale = (-largest.log2().floor()).exp2();
        Self { tree, triangles, parts, scale, entries: Vec::new(), waiting: VecDeque::new() }
    }

    /// Writes the wide tree of the subtree below `root`; returns what it is to a tree above.
    pub(super) fn collapse(&mut self, root: u32, out: &mut WideTree) -> Part {
        self.lay_out(root);
        self.waiting.clear();
        for index in (0..self.entries.len()).rev() {
            if let Some(ahead) = index.checked_sub(AHEAD)
                && let Some(triangle) = self.triangle(&self.entries[ahead])
            {
                prefetch(triangle);
            }
            let vertices = self.vertices(index);
            self.choose(index, vertices.is_some());
            self.waiting.push_back(vertices);
        }
        let (child, place) = self.child(0, out);
        let depth = place.map_or(0, |place| self.fill(0, place, out));
        Part { node: root, cost: self.entries[0].costs[0], child, depth }
    }

    /// The triangle of a leaf of the binary tree.
    fn triangle(&self, entry: &Entry) -> Option<&'a Option<[Vec3; 3]>> {
        let is_leaf = entry.children == 0 && self.part(entry.node).is_none();
        if is_leaf { self.triangles.get(entry.item as usize) } else { None }
    }

    /// The vertices of an entry, if it may become a leaf; those of its children, which come after it, wait first, the right one's
    /// before the left one's.
    fn vertices(&mut self, index: usize) -> Option<Vertices> {
        let entry = &self.entries[index];
        if entry.children == 0 {
            return self.triangle(entry)?.map(Vertices::of);
        }
        let (right, left) = (self.waiting.pop_front()?, self.waiting.pop_front()?);
        left?.union(&right?)
    }

    fn part(&self, node: u32) -> Option<&'a Part> {
        self.parts.binary_search_by_key(&node, |part| part.node).ok().map(|i| &self.parts[i])
    }

    /// Lists the nodes level by level.
    fn lay_out(&mut self, root: u32) {
        let nodes = &self.tree.nodes;
        self.entries.clear();
        self.entries.push(Entry::new(root));
        let mut index = 0;
        while index < self.entries.len() {
            if let Some(entry) = self.entries.get(index + AHEAD) {
                prefetch(&nodes[entry.node as usize]);
            }
            let node = self.entries[index].node;
            let binary = &nodes[node as usize];
            let first = binary.first_index;
            self.entries[index].bounds = Bounds32::of(binary.aabb());
            if binary.is_leaf() {
                self.entries[index].item = self.tree.primitive_indices[first as usize];
            } else if self.part(node).is_none() {
                self.entries[index].children = self.entries.len() as u32;
                self.entries.extend([first, first + 1].map(Entry::new));
            }
            index += 1;
        }
    }

    /// Finds the best covers of an entry whose children have theirs; a leaf has room for its vertices, or not.
    fn choose(&mut self, index: usize, has_room: bool) {
        let entry = &self.entries[index];
        let area = entry.bounds.half_area(self.scale);
        if entry.children == 0 {
            let part = self.part(entry.node);
            let entry = &mut self.entries[index];
            entry.costs = [part.map_or(area * LEAF_COST, |p| p.cost); WIDTH - 1];
            entry.count = if has_room { 1 } else { WIDTH as u32 + 1 };
            return;
        }
        let children = entry.children as usize;
        let (left, right) = (&self.entries[children], &self.entries[children + 1]);
        let count = if has_room { left.count + right.count } else { WIDTH as u32 + 1 };
        let count = count.min(WIDTH as u32 + 1);
        // By s + 1 slots in lane s.
        let (mut costs, mut choice) = (f32x8::splat(f32::INFINITY), f32x8::ZERO);
        let mut rest = [f32::INFINITY; 2 * WIDTH];
        rest[WIDTH..2 * WIDTH - 1].copy_from_slice(&right.costs);
        for k in 1..WIDTH {
            let of_right: [f32; WIDTH] = std::array::from_fn(|lane| rest[WIDTH - k + lane]);
            let cost = f32x8::splat(left.costs[k - 1]) + f32x8::from(of_right);
            choice = cost.simd_lt(costs).select(f32x8::splat(k as f32), choice);
            costs = costs.fast_min(cost);
        }
        let mut costs = costs.to_array();
        let mut choice = choice.to_array().map(|k| k as u8);
        let as_node = costs[WIDTH - 1] + area;
        let as_leaf = if count <= WIDTH as u32 { area * LEAF_COST } else { f32::INFINITY };
        choice[0] = u8::from(as_node < as_leaf);
        costs[0] = as_node.min(as_leaf);
        for slots in 1..WIDTH - 1 {
            let leaves_one_free = costs[slots - 1] <= costs[slots];
            costs[slots] = costs[slots - 1].min(costs[slots]);
            choice[slots] *= u8::from(!leaves_one_free);
        }
        let entry = &mut self.entries[index];
        entry.count = count;
        entry.costs.copy_from_slice(&costs[..WIDTH - 1]);
        entry.left = choice;
    }

    /// What an entry becomes in one slot; a leaf is written at once, for a node the place to write it is returned too.
    fn child(&self, index: usize, out: &mut WideTree) -> (Child, Option<usize>) {
        let entry = &self.entries[index];
        if let Some(part) = self.part(entry.node) {
            return (part.child, None);
        }
        if entry.children == 0 || entry.left[0] == 0 {
            self.add_items(index, &mut out.order);
            out.leaf_ends.push(out.order.len() as u32);
            return (Child::new(out.leaf_ends.len() - 1, true), None);
        }
        out.nodes.push(Node::new(&[]));
        let place = out.nodes.len() - 1;
        (Child::new(place, false), Some(place))
    }

    /// Lists the items of an entry.
    fn add_items(&self, index: usize, order: &mut Vec<u32>) {
        match self.entries[index] {
            Entry { children: 0, item, .. } => order.push(item),
            Entry { children, .. } => (0..2).for_each(|k| self.add_items(children as usize + k, order)),
        }
    }

    /// Writes the node of an entry and what is below it; returns the levels of nodes.
    ///
    /// Siblings lie side by side, before what is below them.
    fn fill(&self, index: usize, place: usize, out: &mut WideTree) -> usize {
        let mut slots = Vec::with_capacity(WIDTH);
        let (left, children) = (&self.entries[index].left, self.entries[index].children as usize);
        let left = usize::from(left[WIDTH - 1]);
        self.slots(children, left, &mut slots);
        self.slots(children + 1, WIDTH - left, &mut slots);
        let mut children = Vec::with_capacity(WIDTH);
        let mut below = Vec::with_capacity(WIDTH);
        let mut depth = 0;
        for slot in slots {
            let Entry { node, bounds, .. } = self.entries[slot];
            let (child, place) = self.child(slot, out);
            children.push((bounds, child));
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
        let children = entry.children as usize;
        self.slots(children, left, out);
        self.slots(children + 1, count - left, out);
    }
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeSet, HashMap};
    use std::time::Duration;

    use obvhs::aabb::Aabb;
    use obvhs::bvh2::builder::build_bvh2;

    use super::*;
    use crate::accel::collapse::collapse;
    use crate::accel::group::BUILD;
    use crate::accel::node::Boxes;
    use crate::math::bounds::Bounds;
    use crate::sampling::warp::point;

    /// Lowest cost of covering nodes of a binary tree, by recursion over all ways in f64.
    struct Reference<'a> {
        tree: &'a Bvh2,
        triangles: Triangles<'a>,
        /// Most of eight slots that a left child gets.
        most: usize,
        known: HashMap<(usize, usize), f64>,
    }

    impl Reference<'_> {
        fn items(&self, node: usize) -> Vec<usize> {
            let first = self.tree.nodes[node].first_index as usize;
            if self.tree.nodes[node].is_leaf() {
                return vec![self.tree.primitive_indices[first] as usize];
            }
            [first, first + 1].iter().flat_map(|&child| self.items(child)).collect()
        }

        fn fits_leaf(&self, node: usize) -> bool {
            let items = self.items(node);
            let triangles: Option<Vec<_>> =
                items.iter().map(|&item| self.triangles.get(item).copied()?).collect();
            let bits = |corners: [Vec3; 3]| corners.map(|corner| corner.to_array().map(f32::to_bits));
            let vertices = triangles.map(|list| list.into_iter().flat_map(bits).collect::<BTreeSet<_>>());
            items.len() == 1 || items.len() <= WIDTH && vertices.is_some_and(|list| list.len() <= WIDTH)
        }

        fn cost(&mut self, node: usize, slots: usize) -> f64 {
            if let Some(&cost) = self.known.get(&(node, slots)) {
                return cost;
            }
            let binary = self.tree.nodes[node];
            let area = half_area(&Bounds32::of(binary.aabb()));
            let mut cost = f64::INFINITY;
            if self.fits_leaf(node) {
                cost = area * f64::from(LEAF_COST);
            }
            if !binary.is_leaf() {
                let child = binary.first_index as usize;
                let split = |this: &mut Self, slots: usize| {
                    let most = this.most.min(slots - 1);
                    let by = |k| this.cost(child, k) + this.cost(child + 1, slots - k);
                    (1..=most).map(by).fold(f64::INFINITY, f64::min)
                };
                cost = cost.min(area + split(self, WIDTH));
                for slots in 2..=slots {
                    cost = cost.min(split(self, slots));
                }
            }
            self.known.insert((node, slots), cost);
            cost
        }
    }

    fn half_area(Bounds32 { min, max }: &Bounds32) -> f64 {
        Bounds { min: min.as_dvec3(), max: max.as_dvec3() }.half_area()
    }

    /// What a tree costs: a node and what is in it, or a leaf.
    fn cost(wide: &WideTree, child: Child, area: f64) -> f64 {
        if child.is_leaf() {
            return area * f64::from(LEAF_COST);
        }
        let node = wide.nodes[child.node()].to_memory();
        let below = |slot: usize| {
            let side = |which: usize| [0, 1, 2].map(|axis| node.sides(axis, which, 0.0).as_array()[slot]);
            let bounds = Bounds32 { min: side(0).into(), max: side(1).into() };
            cost(wide, node.child(slot), half_area(&bounds))
        };
        area + (0..WIDTH).filter(|&slot| node.child(slot) != Child::NONE).map(below).sum::<f64>()
    }

    #[test]
    fn no_cover_costs_less() {
        let (mut worst, mut seen) = (0.0f64, 0.0f64);
        for n in 0..40 {
            // A strip of triangles that share their corners with the next ones, and others between.
            let corner = |k: u32| point(1000 * n + k / 3) * 0.2 + Vec3::X * (k as f32 * 0.1);
            let triangle = |k: u32| (k % 5 != 4).then(|| [k, k + 1, k + 2].map(corner));
            let triangles: Vec<_> = (0..60).map(triangle).collect();
            let boxes = |(k, _)| {
                let corners = [k, k + 1, k + 2].map(corner).map(Into::into);
                let low = corners.into_iter().reduce(|a: glam::Vec3A, b| a.min(b)).unwrap();
                Aabb::new(low, corners.into_iter().reduce(|a: glam::Vec3A, b| a.max(b)).unwrap())
            };
            let boxes: Vec<Aabb> = (0..).zip(&triangles).map(boxes).collect();
            let tree = build_bvh2(&boxes, BUILD, &mut Duration::default());
            let wide = collapse(&tree, &triangles);
            let mut reference =
                Reference { tree: &tree, triangles: &triangles, most: WIDTH, known: HashMap::new() };
            let least = reference.cost(0, 1);
            let found = cost(&wide, wide.root, half_area(&Bounds32::of(tree.nodes[0].aabb())));
            worst = worst.max((found / least - 1.0).abs());
            // Had the left child one slot fewer.
            (reference.most, reference.known) = (6, HashMap::new());
            seen = seen.max(reference.cost(0, 1) / least - 1.0);
        }
        // Each of two sums compared has at most one rounding, of 2⁻²⁴, for each of 119 nodes, and areas have four.
        let resolution = 2.0 * (119.0 + 4.0) * 2f64.powi(-24);
        assert!(worst <= resolution, "{worst} {resolution}");
        assert!(seen > resolution, "{seen}");
    }

    #[test]
    fn items_keep_their_leaves_however_large_or_small() {
        // Half as large as coordinates may be, where areas of 2,000 boxes add up to more than f32 holds; and as small as areas vanish.
        for size in [0.5e18, 1.0, 1e-25] {
            let cube = |n: u32| {
                let corner = glam::Vec3A::from(point(n)) * (0.1 * size);
                Aabb::new(corner - glam::Vec3A::splat(size), corner + glam::Vec3A::splat(size))
            };
            let boxes: Vec<Aabb> = (0..2000).map(cube).collect();
            let tree = build_bvh2(&boxes, BUILD, &mut Duration::default());
            let WideTree { leaf_ends, mut order, .. } = collapse(&tree, &[]);
            assert_eq!(leaf_ends, (1..=2000).collect::<Vec<_>>(), "{size}");
            order.sort_unstable();
            assert_eq!(order, (0..2000).collect::<Vec<_>>(), "{size}");
        }
    }
}
