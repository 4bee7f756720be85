//! Rays walked in turns, so that one computes while others wait for memory, or for what a branch depends on.

use super::group::{Context, Group};
use super::node::{Boxes, Child, Met, Slab, WIDTH, lanes_of};
use super::walk::{Entry, Mode, Pending, Search, Tree};
use crate::math::eight::permuted;
use crate::ray::Ray;

/// Rays walked in turns; measured in benches/README.md.
const LANES: usize = 32;

/// Walks rays in turns and calls `done` with the index of each and what it found.
///
/// All that are at a node test its boxes, then choose where to go, then all that are at a leaf visit it. So no branch has to guess
/// whether a node or a leaf comes, and those that depend on the boxes find the tests done: a wrong guess there costs little.
#[inline]
pub(super) fn walk<M: Mode>(
    group: &Group<impl Boxes>,
    rays: &[Ray],
    context: &mut Context,
    mut done: impl FnMut(usize, &Search),
) {
    let mut stack = std::mem::take(&mut context.stack);
    stack.resize(LANES * group.stack, Entry::default());
    let tree = group.tree();
    let mut waiting = rays.iter().enumerate();
    let start = |(lane, (index, ray))| Walker::new(group, ray, index, lane * group.stack);
    let mut walkers: Vec<Walker> = (0..LANES).zip(waiting.by_ref()).map(start).collect();
    // The lanes of walkers at nodes, and of those at leaves or at an end, as bits.
    let (mut at_nodes, mut at_leaves) = (0, 0);
    for (lane, walker) in walkers.iter().enumerate() {
        at_leaves |= walker.is_at_leaf() << lane;
        at_nodes |= 1 << lane & !at_leaves;
    }
    let mut met = [Met::default(); LANES];
    while at_nodes | at_leaves != 0 {
        for lane in lanes_of::<LANES>(at_nodes) {
            met[lane] = walkers[lane].meet(&tree);
        }
        for lane in lanes_of::<LANES>(at_nodes) {
            let walker = &mut walkers[lane];
            walker.descend::<M>(&tree, &met[lane], &mut stack);
            at_leaves |= walker.is_at_leaf() << lane;
        }
        at_nodes &= !at_leaves;
        for lane in lanes_of::<LANES>(at_leaves) {
            let walker = &mut walkers[lane];
            if let Some(leaf) = walker.leaf() {
                walker.search.leaf::<M>(&tree, leaf, context);
                walker.leave::<M>(&tree, &mut stack);
            } else {
                done(walker.index, &walker.search);
                let Some((index, ray)) = waiting.next() else {
                    at_leaves &= !(1 << lane);
                    continue;
                };
                walker.restart(group, ray, index);
            }
            at_nodes |= (walker.is_at_leaf() ^ 1) << lane;
        }
        at_leaves &= !at_nodes;
    }
    context.stack = stack;
}

/// A ray on its way through a tree.
#[derive(Debug, Clone, Copy)]
struct Walker {
    search: Search,
    slab: Slab,
    /// How far away a box may begin and still matter.
    limit: f32,
    next: Child,
    /// The walker's part of the stack and how far it is filled.
    bottom: usize,
    top: usize,
    /// Which of a batch's rays it is.
    index: usize,
}

impl Walker {
    /// Ray `index` of a batch at the root of the group's tree; `bottom` is where its stack begins.
    #[inline]
    fn new(group: &Group<impl Boxes>, ray: &Ray, index: usize, bottom: usize) -> Self {
        let (next, through) = group.start(ray);
        let (search, slab) = (Search::new(ray), Slab::new(ray, through));
        Self { search, slab, limit: search.limit(), next, bottom, top: bottom, index }
    }

    /// The next ray of the batch in this one's place.
    #[inline]
    fn restart(&mut self, group: &Group<impl Boxes>, ray: &Ray, index: usize) {
        self.search.restart(ray);
        let (next, through) = group.start(ray);
        self.slab = Slab::new(ray, through);
        (self.next, self.limit) = (next, self.search.limit());
        self.top = self.bottom;
        self.index = index;
    }

    /// 0 at a node, 1 at a leaf or an end.
    #[inline]
    fn is_at_leaf(&self) -> u32 {
        u32::from(self.next.is_leaf())
    }

    /// The leaf to visit; `None` at an end.
    #[inline]
    fn leaf(&self) -> Option<usize> {
        if self.next == Child::NONE { None } else { self.next.leaf() }
    }

    /// Tests the boxes of the node that it is at.
    #[inline]
    fn meet(&self, tree: &Tree<impl Boxes>) -> Met {
        tree.node(self.next).enter(&self.slab, self.limit)
    }

    /// Goes on below a node of which it has met those boxes.
    #[inline]
    fn descend<M: Mode>(&mut self, tree: &Tree<impl Boxes>, met: &Met, stack: &mut [Entry]) {
        let order = met.order::<M>();
        let children = permuted(bytemuck::cast(*tree.node(self.next).children()), bytemuck::cast(order));
        // All eight slots, the nearest of those that are met on top: nothing depends on how many there are.
        stack[self.top..self.top + WIDTH].copy_from_slice(&Entry::eight(bytemuck::cast(children), order));
        let top = self.top + met.bits().count_ones() as usize;
        let mut pending = Pending { stack, bottom: self.bottom, top };
        self.next = pending.pop::<M>(self.limit);
        self.top = pending.top;
        tree.prefetch(self.next);
    }

    /// Goes on after a leaf.
    #[inline]
    fn leave<M: Mode>(&mut self, tree: &Tree<impl Boxes>, stack: &mut [Entry]) {
        let mut pending = Pending { stack, bottom: self.bottom, top: self.top };
        self.limit = self.search.limit();
        let is_done = M::ANY && self.search.is_blocked();
        self.next = if is_done { Child::NONE } else { pending.pop::<M>(self.limit) };
        self.top = pending.top;
        tree.prefetch(self.next);
    }
}
