//! How a ray walks a tree.

use super::block::Probe;
use super::group::{Context, Group};
use super::node::{Child, Slab, WIDTH, limit};
use crate::ray::{Hit, Ray};
use crate::shapes::ShapeHit;
use crate::shapes::triangle::ShearedRay;

/// How rays are walked, known when the code is compiled.
pub(super) trait Mode {
    /// Whether the walk ends at the first hit.
    const ANY: bool;
    /// Whether what will be visited is fetched ahead, which pays while other rays are walked.
    const PREFETCH: bool;
}

/// A child to visit later, and how far away the ray enters it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Entry {
    child: Child,
    near: f32,
}

/// A ray on its way through a tree.
///
/// What it finds is the smallest of its hits in the order of distance, object and element: it doesn't depend on the
/// order of its steps.
#[derive(Debug, Clone, Copy)]
pub(super) struct Walker {
    /// The ray; hits matter below its `t_max`, and up to the best one's distance.
    ray: Ray,
    slab: Slab,
    /// Made at the first leaf of triangles.
    probe: Option<Probe>,
    /// Made at the first triangle that the probe leaves in doubt.
    sheared: Option<ShearedRay>,
    next: Child,
    /// The walker's part of the stack and how far it is filled.
    bottom: usize,
    top: usize,
    best: Option<Found>,
    /// Which of a batch's rays it is.
    pub(super) index: usize,
}

/// A hit whose names are looked up only if they matter.
#[derive(Debug, Clone, Copy)]
enum Found {
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

    fn named(&self, group: &Group) -> Hit {
        match *self {
            Self::Item(index, hit) => group.hit(index, hit),
            Self::Named(hit) => hit,
        }
    }
}

impl Walker {
    /// Ray `index` of a batch at the root of the group's tree; `bottom` is where its stack begins.
    #[inline]
    pub(super) fn new(group: &Group, ray: &Ray, index: usize, bottom: usize) -> Self {
        Self {
            ray: *ray,
            slab: Slab::new(ray),
            probe: None,
            sheared: None,
            next: group.root,
            bottom,
            top: bottom,
            best: None,
            index,
        }
    }

    /// The next ray of the batch in this one's place.
    #[inline]
    pub(super) fn restart(&mut self, group: &Group, ray: &Ray, index: usize) {
        *self = Self::new(group, ray, index, self.bottom);
    }

    /// Whether anything is left to visit.
    #[inline]
    pub(super) fn is_walking(&self) -> bool {
        self.next != Child::NONE
    }

    /// Whether it has hit anything.
    pub(super) fn has_hit(&self) -> bool {
        self.best.is_some()
    }

    /// The first hit of those found.
    pub(super) fn hit(&self, group: &Group) -> Option<Hit> {
        self.best.map(|found| found.named(group))
    }

    /// Visits one node or leaf.
    #[inline]
    pub(super) fn step<M: Mode>(&mut self, group: &Group, stack: &mut [Entry], context: &mut Context) {
        let mut pending = Pending { stack, bottom: self.bottom, top: self.top };
        self.next = match self.next.leaf() {
            None => descend::<M>(group, self.next, &self.slab, limit(self.ray.t_max), &mut pending),
            Some(leaf) => {
                self.search_leaf(group, leaf, context);
                Child::NONE
            }
        };
        if self.next == Child::NONE && !(M::ANY && self.has_hit()) {
            self.next = pending.pop(limit(self.ray.t_max));
        }
        self.top = pending.top;
    }

    /// Goes all the way.
    #[inline]
    pub(super) fn walk<M: Mode>(&mut self, group: &Group, stack: &mut [Entry], context: &mut Context) {
        // Copies that the compiler can keep in registers.
        let slab = self.slab;
        let mut next = self.next;
        let mut pending = Pending { stack, bottom: self.bottom, top: self.top };
        while next != Child::NONE {
            let limit = limit(self.ray.t_max);
            while next.leaf().is_none() {
                next = descend::<M>(group, next, &slab, limit, &mut pending);
                if next == Child::NONE {
                    next = pending.pop(limit);
                }
            }
            if next == Child::NONE {
                break;
            }
            if let Some(leaf) = next.leaf() {
                self.search_leaf(group, leaf, context);
            }
            if M::ANY && self.has_hit() {
                break;
            }
            next = pending.pop(self::limit(self.ray.t_max));
        }
        self.next = Child::NONE;
    }

    #[inline]
    fn search_leaf(&mut self, group: &Group, leaf: usize, context: &mut Context) {
        let block = &group.blocks[leaf];
        let mut lanes = block.candidates(&self.ray, &mut self.probe);
        while lanes != 0 {
            let lane = lanes.trailing_zeros();
            lanes &= lanes - 1;
            let index = block.first as usize + lane as usize;
            let hit = match block.triangle(lane) {
                Some(vertices) => {
                    let sheared = self.sheared.get_or_insert_with(|| ShearedRay::new(&self.ray));
                    sheared.hit(&vertices, self.ray.t_max).map(|hit| Found::Item(index, hit))
                }
                None => group.other(index, &self.ray, context).map(Found::Named),
            };
            if let Some(hit) = hit {
                self.take(group, hit);
            }
        }
    }

    /// Keeps a hit before the ray's `t_max` if it comes before the best one.
    #[inline]
    fn take(&mut self, group: &Group, found: Found) {
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
        self.best = Some(found);
    }
}

/// Visits a node of the group.
#[inline]
fn descend<M: Mode>(group: &Group, node: Child, slab: &Slab, limit: f32, pending: &mut Pending) -> Child {
    let node = &group.nodes[node.node()];
    let (mask, near) = node.enter(slab, limit);
    let fetch = |child| {
        if M::PREFETCH {
            group.prefetch(child);
        }
    };
    pending.choose::<M>(mask, &near, node.children(), fetch)
}

/// A part of a stack, of children left for later.
pub(super) struct Pending<'a> {
    pub(super) stack: &'a mut [Entry],
    pub(super) bottom: usize,
    pub(super) top: usize,
}

impl Pending<'_> {
    /// The nearest of the children in `mask`; the others are left for later, with the farthest at the bottom unless any
    /// hit will do. `Child::NONE` if there are none. Calls `seen` with each.
    #[inline]
    pub(super) fn choose<M: Mode>(
        &mut self,
        mut mask: u32,
        near: &[f32; WIDTH],
        children: &[Child; WIDTH],
        seen: impl Fn(Child),
    ) -> Child {
        if mask == 0 {
            return Child::NONE;
        }
        let mut take = || {
            let slot = mask.trailing_zeros() as usize % WIDTH;
            mask &= mask - 1;
            seen(children[slot]);
            (Entry { child: children[slot], near: near[slot] }, mask != 0)
        };
        let (mut nearest, mut more) = take();
        let base = self.top;
        while more {
            let (mut entry, is_more) = take();
            more = is_more;
            if entry.near < nearest.near {
                std::mem::swap(&mut entry, &mut nearest);
            }
            let mut place = self.top;
            while !M::ANY && place > base && self.stack[place - 1].near < entry.near {
                self.stack[place] = self.stack[place - 1];
                place -= 1;
            }
            self.stack[place] = entry;
            self.top += 1;
        }
        nearest.child
    }

    /// The last child left for later that begins before `limit`.
    #[inline]
    pub(super) fn pop(&mut self, limit: f32) -> Child {
        while self.top > self.bottom {
            self.top -= 1;
            let entry = self.stack[self.top];
            if entry.near < limit {
                return entry.child;
            }
        }
        Child::NONE
    }
}
