//! Elements of objects under a tree, and the queries over them.

use std::time::Duration;

use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ploc::PlocSearchDistance;
use wide::f32x8;

use super::block::{BlockMemory, block};
use super::collapse::{WideTree, collapse};
use super::few::{self, Few, LEAVES, Leaf};
use super::item::Items;
use super::leaves::Leaves;
use super::memory::Array;
use super::node::{AHEAD, Bounds32, Boxes, Child, NodeMemory, Slab, WIDTH, lanes_of, limit, prefetch};
use super::object::Object;
use super::packet::{Packet, RAYS, Waiting};
use super::turns;
use super::walk::{Any, Closest, Entry, Found, Mode, Search, Tree, walk};
use crate::math::bounds::Bounds;
use crate::ray::{EightRays, Hit, Ray};
use crate::shapes::{EightHits, Shape, ShapeHit};

/// One item a leaf, as `collapse` expects. Reinsertion after its own collapse would cost as much as all the rest, and
/// 2 % of the nodes gain three quarters of what 5 % do. A longer search for neighbours makes no better trees.
pub(super) const BUILD: BvhBuildParams = BvhBuildParams {
    max_prims_per_leaf: 1,
    ploc_search_distance: PlocSearchDistance::Low,
    reinsertion_batch_ratio: 0.02,
    post_collapse_reinsertion_batch_ratio_multiplier: 0.0,
    ..BvhBuildParams::medium_build()
};

/// Bytes of a tree up to which rays walk it one after the other; measured in benches/README.md.
const ALONE: usize = 1 << 17;

/// Items under their trees, one for each span of time, in one space.
#[derive(Debug)]
pub(super) struct Group<N: Boxes = NodeMemory> {
    /// Which tree a ray walks, and where that begins.
    pub(super) clock: N::Clock,
    pub(super) roots: Vec<Child>,
    pub(super) nodes: Array<N>,
    /// The leaves; none if no item is a triangle.
    pub(super) blocks: Array<BlockMemory>,
    /// Object and element of each item in the order of the leaves.
    pub(super) ids: Array<[u32; 2]>,
    /// The leaves of each tree, if they are few.
    pub(super) few: Vec<Few<N>>,
    /// Room that a walk's stack needs: for seven children of each level, and eight of the last while they are written.
    pub(super) stack: usize,
    /// Whether the space is an object's own.
    pub(super) is_inner: bool,
}

/// What the queries need besides the group: the objects, the groups of the moving ones, and memory to use.
pub(super) struct Context<'a> {
    pub(super) objects: &'a [Object],
    /// The trees of moving objects with more than one element.
    pub(super) inner: &'a [Option<Box<Group>>],
    pub(super) stack: Vec<Entry>,
    pub(super) inner_stack: Vec<Entry>,
    pub(super) waiting: Vec<Waiting>,
}

impl<'a> Context<'a> {
    pub(super) fn new(objects: &'a [Object], inner: &'a [Option<Box<Group>>]) -> Self {
        let (stack, inner_stack, waiting) = Default::default();
        Self { objects, inner, stack, inner_stack, waiting }
    }
}

impl Group {
    /// The tree over a whole scene: elements of objects at rest, and of the moving objects that have one the boxes that
    /// they sweep.
    pub(super) fn of_scene(objects: &[Object], swept: &[Option<Bounds>]) -> Self {
        let mut items = Items::default();
        for ((index, object), swept) in (0u32..).zip(objects).zip(swept) {
            match (&object.motion, swept) {
                (Some(_), Some(bounds)) => items.add(bounds, [index, 0]),
                (Some(_), None) => {}
                (None, _) => items.add_elements(index, &object.shape),
            }
        }
        Self::new(&items)
    }

    /// The tree over one object's elements in its own space.
    pub(super) fn of_shape(index: u32, shape: &Shape) -> Self {
        let mut items = Items::default();
        items.add_elements(index, shape);
        Self { is_inner: true, ..Self::new(&items) }
    }

    fn new(Items { boxes, triangles, ids }: &Items) -> Self {
        let binary = build_bvh2(boxes, BUILD, &mut Duration::default());
        let WideTree { root, nodes, leaf_ends, order, depth } = collapse(&binary, triangles);
        let first = |leaf: usize| if leaf == 0 { 0 } else { leaf_ends[leaf - 1] };
        let items = |leaf: usize| &order[first(leaf) as usize..leaf_ends[leaf] as usize];
        let leaf = |leaf: usize| {
            let of_leaf = items(leaf);
            let ahead = order[first(leaf) as usize..].iter().skip(AHEAD).take(of_leaf.len());
            ahead.for_each(|&item| prefetch(&triangles[item as usize]));
            block(of_leaf.iter().map(|&item| triangles[item as usize]), first(leaf))
        };
        let has_triangles = triangles.iter().any(Option::is_some);
        let blocks = Array::new(if has_triangles { leaf_ends.len() } else { 0 }, leaf);
        let boxed = |index: usize| {
            let items = items(index).iter().map(|&item| item as usize);
            let has_triangles = items.clone().any(|item| triangles[item].is_some());
            let bounds =
                items.map(|item| Bounds32::of(&boxes[item])).reduce(|all, bounds| all.union(&bounds));
            let bounds = bounds.expect("a leaf has an item");
            (bounds, Leaf { index, first: first(index) as usize, has_triangles })
        };
        let few = (leaf_ends.len() <= LEAVES).then(|| {
            let mut leaves: Vec<(Bounds32, Leaf)> = (0..leaf_ends.len()).map(boxed).collect();
            // What costs little comes first, and leaves less to the rest.
            leaves.sort_by_key(|(_, leaf)| leaf.has_triangles);
            Few(leaves)
        });
        let nodes = Array::new(nodes.len(), |index| nodes[index].to_memory());
        let ids = Array::new(order.len(), |i| ids[order[i] as usize]);
        let (few, stack) = (few.into_iter().collect(), 7 * depth + WIDTH);
        Self { clock: (), roots: vec![root], nodes, blocks, ids, few, stack, is_inner: false }
    }
}

impl<N: Boxes> Group<N> {
    /// The index of the tree that a ray walks, and how far through that tree's span of time it is.
    #[inline]
    pub(super) fn place(&self, ray: &Ray) -> (usize, f32) {
        N::place(&self.clock, ray.time)
    }

    /// How far through the span of time of the tree of that index eight rays are: beyond 0 and 1 where other trees are for them.
    #[inline]
    pub(super) fn through(&self, tree: usize, times: f32x8) -> f32x8 {
        N::through(&self.clock, tree, times)
    }

    /// The root of that tree instead of its index.
    #[inline]
    pub(super) fn start(&self, ray: &Ray) -> (Child, f32) {
        let (index, through) = self.place(ray);
        (self.roots[index], through)
    }

    /// The group with its arrays at hand.
    #[inline]
    pub(super) fn tree(&self) -> Tree<'_, N> {
        Tree { group: self, nodes: self.nodes.as_slice(), blocks: self.blocks.as_slice() }
    }

    /// The nearest hit of one ray in an object's own space.
    fn closest_of(&self, ray: &Ray, context: &mut Context) -> Option<Hit> {
        let tree = self.tree();
        let mut stack = std::mem::take(&mut context.inner_stack);
        stack.resize(self.stack, Entry::default());
        let search = walk::<Closest>(&tree, ray, self.start(ray), &mut stack, context);
        context.inner_stack = stack;
        search.hit(self)
    }

    /// Number of boxes that the ray meets before `reach`: around nodes, and around leaves.
    pub(super) fn boxes_met(&self, ray: &Ray, reach: f32) -> [u64; 2] {
        let (root, through) = self.start(ray);
        let (slab, tree) = (Slab::new(ray, through), self.tree());
        let mut met = [0; 2];
        let mut waiting = vec![root];
        while let Some(child) = waiting.pop() {
            if child.leaf().is_none() {
                let node = tree.node(child);
                let slots = lanes_of::<WIDTH>(node.enter(&slab, limit(reach)).bits());
                for child in slots.map(|slot| node.child(slot)) {
                    met[usize::from(child.leaf().is_some())] += 1;
                    waiting.push(child);
                }
            }
        }
        met
    }

    /// Walks rays one after the other and calls `done` with the index of each and what it found.
    // Not inlined: what it keeps of a packet's rays would be room that the other walks ask for too.
    #[inline(never)]
    pub(super) fn walk_each<M: Mode>(
        &self,
        rays: &[Ray],
        context: &mut Context,
        mut done: impl FnMut(usize, &Search),
    ) {
        let Some(first) = rays.first() else { return };
        let mut stack = std::mem::take(&mut context.stack);
        stack.resize(self.stack, Entry::default());
        let mut waiting = std::mem::take(&mut context.waiting);
        let (mut searches, mut leaves) = ([Search::new(first); RAYS], Leaves::default());
        let (tree, mut index) = (self.tree(), 0..);
        let mut left = rays;
        while !left.is_empty() {
            if let Some(packet) = Packet::new(self, left) {
                let now = left.split_off(..packet.count).unwrap_or_default();
                packet.walk::<M>(&tree, now, &mut searches, &mut leaves, &mut waiting, context);
                searches
                    .iter()
                    .zip(index.by_ref().take(now.len()))
                    .for_each(|(found, index)| done(index, found));
                continue;
            }
            let (of_rays, count, through) = self.of_one_tree(left);
            let now = left.split_off(..count).unwrap_or_default();
            for ((ray, through), index) in now.iter().zip(through.to_array()).zip(&mut index) {
                let start = (self.roots[of_rays], through);
                done(index, &walk::<M>(&tree, ray, start, &mut stack, context));
            }
        }
        (context.stack, context.waiting) = (stack, waiting);
    }

    /// The index of the tree that the first of up to eight rays walks, how many, from it on, walk the same, and how far through its
    /// span of time each is.
    #[inline]
    fn of_one_tree(&self, rays: &[Ray]) -> (usize, usize, f32x8) {
        let (tree, _) = self.place(&rays[0]);
        let mut times = f32x8::ZERO;
        times.as_mut_array().iter_mut().zip(rays).for_each(|(time, ray)| *time = ray.time);
        let through = self.through(tree, times);
        let is_along = through.simd_ge(f32x8::ZERO) & through.simd_le(f32x8::ONE);
        let count = (is_along.to_bitmask() | 1).trailing_ones() as usize;
        (tree, count.min(rays.len()), through.fast_max(f32x8::ZERO).fast_min(f32x8::ONE))
    }

    /// Walks rays through the few leaves of their trees and calls `done` as `walk_each` does.
    #[inline]
    pub(super) fn walk_few<M: Mode>(
        &self,
        rays: &[Ray],
        context: &mut Context,
        mut done: impl FnMut(usize, &Search),
    ) {
        let Some(first) = rays.first() else { return };
        let (tree, mut searches, mut index) = (self.tree(), [Search::new(first); few::RAYS], 0..);
        let mut left = rays;
        while !left.is_empty() {
            let (of_rays, count, through) = self.of_one_tree(left);
            let now = left.split_off(..count).unwrap_or_default();
            self.few[of_rays].walk::<M>(&tree, now, through, &mut searches, context);
            searches.iter().zip(index.by_ref().take(count)).for_each(|(found, index)| done(index, found));
        }
    }

    /// Calls `done` with the index of each ray and its nearest hit.
    #[inline]
    pub(super) fn closest(
        &self,
        rays: &[Ray],
        context: &mut Context,
        mut done: impl FnMut(usize, Option<Hit>),
    ) {
        if self.ids.as_slice().is_empty() {
            return;
        }
        let done = |i: usize, found: &Search| done(i, found.hit(self));
        if !self.few.is_empty() {
            self.walk_few::<Closest>(rays, context, done);
        } else if self.is_small() || are_coherent(rays) {
            self.walk_each::<Closest>(rays, context, done);
        } else {
            turns::walk::<Closest>(self, rays, context, done);
        }
    }

    /// Calls `done` with the index of each ray and whether it hits anything.
    #[inline]
    pub(super) fn occluded(&self, rays: &[Ray], context: &mut Context, mut done: impl FnMut(usize, bool)) {
        if self.ids.as_slice().is_empty() {
            return;
        }
        let done = |i: usize, found: &Search| done(i, found.is_blocked());
        if !self.few.is_empty() {
            self.walk_few::<Any>(rays, context, done);
        } else if self.is_small() || are_coherent(rays) {
            self.walk_each::<Any>(rays, context, done);
        } else {
            turns::walk::<Any>(self, rays, context, done);
        }
    }

    /// Whether rays walk its trees one after the other.
    fn is_small(&self) -> bool {
        let tree = self.tree();
        size_of_val(tree.nodes) + size_of_val(tree.blocks) <= ALONE * self.roots.len()
    }

    /// Fetches what `hit` will look up into the cache.
    #[inline]
    pub(super) fn prefetch_name(&self, index: usize) {
        prefetch(&self.ids.as_slice()[index]);
    }

    pub(super) fn hit(&self, index: usize, hit: ShapeHit) -> Hit {
        let [object, element] = self.ids.as_slice()[index];
        Hit { t: hit.t, object, element, uv: hit.uv }
    }

    /// The hit of an item that isn't a triangle at rest.
    #[inline]
    pub(super) fn other(&self, index: usize, ray: &Ray, context: &mut Context) -> Option<Found> {
        let [id, element] = self.ids.as_slice()[index];
        let object = &context.objects[id as usize];
        if object.motion.is_none() || self.is_inner {
            return object.shape.intersect(element, ray).map(|hit| Found::Item(index, hit));
        }
        match &context.inner[id as usize] {
            Some(inner) => {
                inner.closest_of(&object.to_object(ray).rounded(ray.time), context).map(Found::Named)
            }
            None => object.intersect(element, ray).map(|hit| Found::Item(index, hit)),
        }
    }

    /// The hits of eight rays on an item that isn't a triangle, if it can be tested against them at once.
    #[inline]
    pub(super) fn other_eight(&self, index: usize, rays: &EightRays, context: &Context) -> Option<EightHits> {
        context.objects[self.ids.as_slice()[index][0] as usize].intersect_eight(rays)
    }
}

/// Whether a hit comes first in the order of distance, object and element.
pub(super) fn comes_before(a: &Hit, b: &Hit) -> bool {
    (a.t, a.object, a.element) < (b.t, b.object, b.element)
}

/// Whether neighbours in the list point mostly the same way, within 6°, and find in the cache what the ray before has left there.
pub(super) fn are_coherent(rays: &[Ray]) -> bool {
    let pairs = rays.windows(2).step_by(8);
    let along = pairs.clone().filter(|p| p[0].direction.dot(p[1].direction) > 0.995).count();
    2 * along >= pairs.len()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DAffine3;

    use super::*;
    use crate::sampling::warp::point;
    use crate::shapes::{MeshData, ShapeSettings};

    #[test]
    fn rays_walked_in_turns_find_what_each_finds_alone() {
        let corners = |n: u32| [0, 1, 2].map(|k| (point(n) * 2.0 + point(7 * n + k)).to_array());
        let data = MeshData {
            positions: (0..400).flat_map(corners).collect(),
            triangles: (0..400).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect(),
            ..MeshData::default()
        };
        let shape = Shape::new(&ShapeSettings::Mesh(Arc::new(data)), &DAffine3::IDENTITY, false).unwrap();
        let objects = [Object::still(shape)];
        let group = Group::of_scene(&objects, &[None]);
        let rays: Vec<Ray> = (0..500).map(|n| Ray::new(point(3 * n) * 4.0, point(5 * n + 1), 0.0)).collect();
        let context = &mut Context::new(&objects, &[]);
        let (mut alone, mut in_turns) = (vec![None; rays.len()], vec![None; rays.len()]);
        group.walk_each::<Closest>(&rays, context, |i, found| alone[i] = found.hit(&group));
        turns::walk::<Closest>(&group, &rays, context, |i, found| in_turns[i] = found.hit(&group));
        assert_eq!(alone, in_turns);
        assert!(alone.iter().any(Option::is_some) && alone.iter().any(Option::is_none));
        let (mut each, mut turns) = (vec![false; rays.len()], vec![false; rays.len()]);
        group.walk_each::<Any>(&rays, context, |i, found| each[i] = found.is_blocked());
        turns::walk::<Any>(&group, &rays, context, |i, found| turns[i] = found.is_blocked());
        assert!(each == turns && each.iter().zip(&alone).all(|(any, hit)| *any == hit.is_some()));
    }
}
