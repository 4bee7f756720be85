//! How a ray walks a tree.

use glam::Vec3;
use wide::{f32x16, i32x8};

use super::block::{BlockMemory, BlockRef, Candidates, Probe};
use super::group::{Context, Group};
use super::node::{Boxes, Child, Met, NodeMemory, Slab, WIDTH, lanes_of, limit, prefetch};
use crate::math::eight::interleaved;
use crate::ray::{Hit, Ray};
use crate::shapes::ShapeHit;
use crate::shapes::triangle::ShearedRay;

/// How rays are walked, known when the code is compiled.
pub(super) trait Mode {
    /// Whether the walk ends at the first hit.
    const ANY: bool;
}

/// The nearest hit.
pub(super) struct Closest;

/// Any hit.
pub(super) struct Any;

impl Mode for Closest {
    const ANY: bool = false;
}

impl Mode for Any {
    const ANY: bool = true;
}

/// Lines of the cache that a leaf takes.
const BLOCK_LINES: usize = size_of::<BlockMemory>() / size_of::<f32x16>();

/// A group whose arrays are at hand.
#[derive(Clone, Copy)]
pub(super) struct Tree<'a, N: Boxes = NodeMemory> {
    pub(super) group: &'a Group<N>,
    pub(super) nodes: &'a [N],
    pub(super) blocks: &'a [BlockMemory],
}

impl<'a, N: Boxes> Tree<'a, N> {
    /// Lines of the cache that a node takes.
    const NODE_LINES: usize = size_of::<N>() / size_of::<f32x16>();

    #[inline]
    pub(super) fn node(&self, child: Child) -> &'a N {
        &self.nodes[child.node()]
    }

    /// What is in a leaf.
    #[inline]
    pub(super) fn content(&self, leaf: usize) -> Content<'a> {
        match self.blocks.get(leaf).map(BlockRef::new) {
            Some(block) if block.has_triangles() => Content::Triangles(block),
            Some(block) => Content::Other(block.first()),
            None => Content::Other(leaf),
        }
    }

    /// Fetches a leaf or node at rest, and the first and last lines of a moving node, into the cache. No branch depends on which it is: a leaf's two lines
    /// are asked for twice.
    #[inline]
    pub(super) fn prefetch(&self, child: Child) {
        let arrays: [&[f32x16]; 2] = [bytemuck::cast_slice(self.nodes), self.blocks.as_flattened()];
        let kind = usize::from(child.is_leaf());
        let count = [Self::NODE_LINES, BLOCK_LINES][kind];
        let first = child.index() * count;
        if let Some(lines) = arrays[kind].get(first..first + count)
            && let (Some(start), Some(end)) = (lines.first_chunk::<2>(), lines.last_chunk::<2>())
        {
            start.iter().chain(end).for_each(prefetch);
        }
    }
}

/// What is in a leaf.
pub(super) enum Content<'a> {
    Triangles(BlockRef<'a>),
    /// An item that isn't a triangle, by its index: it has a leaf of its own.
    Other(usize),
}

/// A child to visit later, below the distance at which the ray enters it: its bits have the order of the numbers, since
/// they aren't negative.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry(u64);

impl Entry {
    /// Eight at once, by their bits and those of their distances.
    #[inline]
    pub(super) fn eight(children: i32x8, near: i32x8) -> [Self; 8] {
        interleaved(children, near).map(Self)
    }

    #[inline]
    pub(super) fn new(child: Child, near: f32) -> Self {
        // A box around the origin may begin at −0.
        Self(u64::from(near.abs().to_bits()) << 32 | u64::from(child.bits()))
    }

    #[inline]
    pub(super) fn child(self) -> Child {
        Child::from_bits(self.0)
    }

    #[inline]
    pub(super) fn begins_before(self, limit: f32) -> bool {
        self.0 < u64::from(limit.to_bits()) << 32
    }
}

/// A ray and what it has found in the leaves visited so far.
///
/// That is the smallest of its hits in the order of distance, object and element, which doesn't depend on the order of
/// the leaves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Search {
    /// The ray; hits matter below its `t_max`, and up to the best one's distance.
    ray: Ray,
    /// Made at the first leaf of triangles.
    probe: Option<Probe>,
    /// Made at the first triangle that the probe leaves in doubt.
    sheared: Option<ShearedRay>,
    best: Option<Found>,
    /// Whether anything is hit, if that is the question.
    is_blocked: bool,
}

/// A hit whose names are looked up only if they matter.
#[derive(Debug, Clone, Copy)]
pub(super) enum Found {
    /// A hit on the item of that index in the group.
    Item(usize, ShapeHit),
    /// A hit in an object's own group.
    Named(Hit),
}

impl Found {
    fn t(&self) -> f32 {
        match self {
            Self::Item(_, hit) => hit.t,
            Self::Named(hit) => hit.t,
        }
    }

    fn named(&self, group: &Group<impl Boxes>) -> Hit {
        match *self {
            Self::Item(index, hit) => group.hit(index, hit),
            Self::Named(hit) => hit,
        }
    }
}

impl Search {
    #[inline]
    pub(super) fn new(ray: &Ray) -> Self {
        Self { ray: *ray, probe: None, sheared: None, best: None, is_blocked: false }
    }

    /// Begins anew with another ray, in place: a copy would wait for what has just been written.
    #[inline]
    pub(super) fn restart(&mut self, ray: &Ray) {
        self.ray = *ray;
        self.probe = None;
        self.sheared = None;
        self.best = None;
        self.is_blocked = false;
    }

    /// Whether it has hit anything, asked if that is the question.
    pub(super) fn is_blocked(&self) -> bool {
        self.is_blocked
    }

    /// The first hit of those found.
    pub(super) fn hit(&self, group: &Group<impl Boxes>) -> Option<Hit> {
        self.best.map(|found| found.named(group))
    }

    /// The ray's `t_max`: hits matter below it.
    #[inline]
    pub(super) fn reach(&self) -> f32 {
        self.ray.t_max
    }

    /// How far away a box may begin and still matter.
    #[inline]
    pub(super) fn limit(&self) -> f32 {
        limit(self.ray.t_max)
    }

    /// Tries what is in a leaf.
    #[inline]
    pub(super) fn leaf<M: Mode>(&mut self, tree: &Tree<impl Boxes>, leaf: usize, context: &mut Context) {
        match tree.content(leaf) {
            Content::Triangles(block) => {
                let probe = self.probe.get_or_insert_with(|| Probe::new(&self.ray));
                let candidates = block.relative(probe).candidates(probe, self.ray.t_max);
                self.settle::<M>(tree, block, candidates);
            }
            Content::Other(index) => self.other::<M>(tree, index, context),
        }
    }

    /// Tries what is in a leaf of which the candidates are known.
    #[inline]
    pub(super) fn settle<M: Mode>(
        &mut self,
        tree: &Tree<impl Boxes>,
        block: BlockRef,
        Candidates { lanes, certain, .. }: Candidates,
    ) {
        if M::ANY && certain != 0 {
            self.is_blocked = true;
            return;
        }
        for lane in lanes_of::<WIDTH>(lanes) {
            self.test::<M>(tree, block.first() + lane, &block.triangle(lane));
            if M::ANY && self.is_blocked {
                return;
            }
        }
    }

    /// Tests a triangle, the item of that index.
    #[inline]
    pub(super) fn test<M: Mode>(&mut self, tree: &Tree<impl Boxes>, index: usize, corners: &[Vec3; 3]) {
        let sheared = self.sheared.get_or_insert_with(|| ShearedRay::new(&self.ray));
        if let Some(hit) = sheared.hit(corners, self.ray.t_max) {
            self.accept::<M>(tree.group, Found::Item(index, hit));
        }
    }

    /// Tries an item that isn't a triangle.
    #[inline]
    pub(super) fn other<M: Mode>(&mut self, tree: &Tree<impl Boxes>, index: usize, context: &mut Context) {
        if let Some(hit) = tree.group.other(index, &self.ray, context) {
            self.accept::<M>(tree.group, hit);
        }
    }

    /// Hits matter below `t_max` only.
    #[inline]
    pub(super) fn shorten(&mut self, t_max: f32) {
        self.ray.t_max = self.ray.t_max.min(t_max);
    }

    /// Takes note of a hit before the ray's `t_max`.
    #[inline]
    pub(super) fn accept<M: Mode>(&mut self, group: &Group<impl Boxes>, found: Found) {
        if M::ANY {
            self.is_blocked = true;
        } else {
            self.take(group, found);
        }
    }

    /// Keeps a hit before the ray's `t_max` if it comes before the best one.
    // Always inlined: a hit handed over in memory would be copied before it is there.
    #[inline(always)]
    fn take(&mut self, group: &Group<impl Boxes>, found: Found) {
        if let Some(best) = &self.best
            && best.t() == found.t()
        {
            let name = |f: &Found| {
                let hit = f.named(group);
                (hit.object, hit.element)
            };
            if name(best) < name(&found) {
                return;
            }
        }
        // Equal distances still count.
        self.ray.t_max = found.t().next_up();
        if let Found::Item(index, _) = found {
            group.prefetch_name(index);
        }
        self.best = Some(found);
    }
}

/// Walks one ray all the way, from the root of its tree on, that far through the tree's span of time.
#[inline]
pub(super) fn walk<M: Mode>(
    tree: &Tree<impl Boxes>,
    ray: &Ray,
    (root, through): (Child, f32),
    stack: &mut [Entry],
    context: &mut Context,
) -> Search {
    let mut search = Search::new(ray);
    let slab = Slab::new(ray, through);
    let mut pending = Pending { stack, bottom: 0, top: 0 };
    let mut next = root;
    let mut limit = limit(ray.t_max);
    while next != Child::NONE {
        match next.leaf() {
            None => {
                let node = tree.node(next);
                next = pending.choose::<M>(&node.enter(&slab, limit), |slot| node.child(slot));
                if next != Child::NONE {
                    continue;
                }
            }
            Some(leaf) => {
                search.leaf::<M>(tree, leaf, context);
                if M::ANY && search.is_blocked {
                    break;
                }
                limit = self::limit(search.ray.t_max);
            }
        }
        next = pending.pop::<M>(limit);
    }
    search
}

/// A part of a stack, of children left for later.
pub(super) struct Pending<'a> {
    pub(super) stack: &'a mut [Entry],
    pub(super) bottom: usize,
    pub(super) top: usize,
}

impl Pending<'_> {
    /// The nearest of the children whose boxes are met, or the first if any hit will do; the others are left for later, with the
    /// farthest at the bottom. `Child::NONE` if there are none.
    #[inline]
    pub(super) fn choose<M: Mode>(&mut self, met: &Met, child: impl Fn(usize) -> Child) -> Child {
        let mut mask = met.bits();
        if mask == 0 {
            return Child::NONE;
        }
        let mut take = || {
            let slot = mask.trailing_zeros() as usize % WIDTH;
            mask &= mask - 1;
            (slot, mask != 0)
        };
        // Nothing is passed over where any hit will do, so distances don't matter.
        let entry =
            |slot: usize| Entry::new(child(slot), if M::ANY { 0.0 } else { met.near.as_array()[slot] });
        let (slot, mut more) = take();
        if !more {
            // Not by way of its entry, which would be there later.
            return child(slot);
        }
        let mut nearest = entry(slot);
        let base = self.top;
        while more {
            let (slot, is_more) = take();
            more = is_more;
            let mut other = entry(slot);
            if !M::ANY {
                (nearest, other) = (nearest.min(other), nearest.max(other));
            }
            let mut place = self.top;
            while !M::ANY && place > base && self.stack[place - 1] < other {
                self.stack[place] = self.stack[place - 1];
                place -= 1;
            }
            self.stack[place] = other;
            self.top += 1;
        }
        nearest.child()
    }

    /// The last child left for later that begins before `limit`.
    #[inline]
    pub(super) fn pop<M: Mode>(&mut self, limit: f32) -> Child {
        while self.top > self.bottom {
            self.top -= 1;
            let entry = self.stack[self.top];
            if M::ANY || entry.begins_before(limit) {
                return entry.child();
            }
        }
        Child::NONE
    }
}
