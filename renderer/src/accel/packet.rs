//! Up to thirty-two rays that go the same way, walked together.

use std::array::from_fn;

use wide::f32x8;

use super::group::{Context, Group};
use super::leaves::Leaves;
use super::node::{Boxes, Child, Met, SLACK, WIDTH, inverses, lanes_of, limit_eight, met};
use super::walk::{Content, Entry, Found, Mode, Search, Tree};
use crate::math::eight::Vec3x8;
use crate::ray::{EightRays, Ray};

/// Most eights of rays in a packet; measured in benches/README.md.
pub(super) const EIGHTS: usize = 4;

/// Most rays of a packet.
pub(super) const RAYS: usize = 8 * EIGHTS;

/// A number for each ray.
type Lanes = [f32x8; EIGHTS];

/// Cosine of the widest angle between the first ray of a packet and another; measured in benches/README.md.
const NARROW: f32 = 0.999;

/// A child to visit later, and the rays that meet its box.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Waiting {
    entry: Entry,
    rays: u32,
}

/// Eight rays prepared for boxes.
#[derive(Debug, Clone, Copy)]
struct Eight {
    rays: EightRays<f32x8>,
    inverse: [f32x8; 3],
    /// How far through their tree's span of time, beyond 0 and 1 where other trees are for them.
    through: f32x8,
}

/// Eights of rays prepared for boxes.
#[derive(Debug)]
pub(super) struct Packet {
    /// How many rays there are; the eights beyond them repeat the first.
    pub(super) count: usize,
    eights: [Eight; EIGHTS],
    /// Where they begin, and how far through its tree's span of time the first and the last of them are.
    root: Child,
    span: [f32; 2],
    /// The longest component of all directions.
    pub(super) longest: usize,
    /// 1 on the axes along which all rays meet the upper side first.
    upper_first: [usize; 3],
    /// Origins from which distances to the nearer and to the farther sides bound those of all rays.
    bounds: [[f32; 3]; 2],
    /// The smallest and the largest inverse.
    inverses: [[f32; 2]; 3],
}

impl Packet {
    /// The packet of as many eights of `rays`, from their first on, as begin at one root, point into one octant with the same longest
    /// component, and go the same way closely enough to gain from it; `None` if the first eight don't.
    #[inline]
    pub(super) fn new(group: &Group<impl Boxes>, rays: &[Ray]) -> Option<Self> {
        let (of_rays, _) = rays.as_chunks::<8>();
        let (first, others) = of_rays.split_first()?;
        // Most that don't go together are told by two of them.
        if first[0].direction.dot(first[7].direction) < NARROW {
            return None;
        }
        let (tree, _) = group.place(&first[0]);
        let eight = |rays| {
            let rays = EightRays::new(rays);
            Eight { rays, inverse: inverses(rays.direction).0, through: group.through(tree, rays.time) }
        };
        let mut eights = [eight(first); EIGHTS];
        let longest = first[0].direction.abs().max_position();
        let way = Vec3x8::splat(first[0].direction);
        let upper_first = eights[0].inverse.map(|inverse| usize::from(inverse.as_array()[0] < 0.0));
        let is_along = |Eight { rays, inverse, through }: &Eight| {
            let size = |axis: usize| rays.direction.0[axis].abs();
            let is_upper = |axis: usize| inverse[axis].simd_lt(f32x8::ZERO).to_bitmask();
            let is_close = rays.direction.dot(way).simd_ge(NARROW)
                & size(longest).simd_ge(size(0).fast_max(size(1)).fast_max(size(2)))
                & through.simd_ge(f32x8::ZERO)
                & through.simd_le(f32x8::ONE);
            is_close.all() && (0..3).all(|axis| is_upper(axis) == [0, 0xff][upper_first[axis]])
        };
        if !is_along(&eights[0]) {
            return None;
        }
        let mut count = 1;
        for rays in others.iter().take(EIGHTS - 1) {
            let eight = eight(rays);
            if !is_along(&eight) {
                break;
            }
            eights[count] = eight;
            count += 1;
        }
        let inverses = from_fn(|axis| range(eights.each_ref().map(|eight| eight.inverse[axis])));
        let origins: [[f32; 2]; 3] =
            from_fn(|axis| range(eights.each_ref().map(|eight| eight.rays.origin.0[axis])));
        Some(Self {
            count: 8 * count,
            root: group.roots[tree],
            span: range(eights.each_ref().map(|eight| eight.through)),
            // A greater origin is nearer to the upper sides.
            bounds: [1, 0].map(|near| from_fn(|axis| origins[axis][near ^ upper_first[axis]])),
            inverses,
            longest,
            eights,
            upper_first,
        })
    }

    /// The boxes of a node that some ray may meet before `limit`, and bounds on how far away the first enters each.
    ///
    /// Rounding keeps order: the bounds hold for what `Boxes::enter` computes for each ray, in every bit.
    #[inline]
    fn enter(&self, node: &impl Boxes, limit: f32) -> Met {
        let products = |axis: usize, end: usize| {
            let side = node.farthest_sides(axis, self.upper_first[axis] ^ end, self.span);
            let side = side - f32x8::splat(self.bounds[end][axis]);
            self.inverses[axis].map(|inverse| side * f32x8::splat(inverse))
        };
        let distances = |axis: usize| {
            let ([a, b], [c, d]) = (products(axis, 0), products(axis, 1));
            [a.fast_min(b), c.fast_max(d)]
        };
        met(distances, f32x8::splat(limit))
    }

    /// Which of eight rays meet the box in a slot of a node before their limits, as bits.
    #[inline]
    fn meet(&self, node: &impl Boxes, slot: usize, eight: &Eight, limits: f32x8) -> u32 {
        let distance = |axis: usize, end: usize| {
            let side = node.side(slot, axis, self.upper_first[axis] ^ end, eight.through);
            (side - eight.rays.origin.0[axis]) * eight.inverse[axis]
        };
        // As `met`, which doesn't know which side is the nearer one.
        let enter = distance(0, 0).fast_max(distance(1, 0)).fast_max(distance(2, 0).fast_max(f32x8::ZERO));
        let leave = distance(0, 1).fast_min(distance(1, 1)).fast_min(distance(2, 1));
        enter.simd_le((leave * f32x8::splat(SLACK)).fast_min(limits)).to_bitmask()
    }

    /// Walks the rays through a tree, and puts what they find into `searches`. Each meets at least the boxes that it meets alone, so it
    /// finds the same.
    #[inline]
    pub(super) fn walk<M: Mode>(
        &self,
        tree: &Tree<impl Boxes>,
        rays: &[Ray],
        searches: &mut [Search; RAYS],
        leaves: &mut Leaves,
        stack: &mut Vec<Waiting>,
        context: &mut Context,
    ) {
        for (search, ray) in searches.iter_mut().zip(rays) {
            search.restart(ray);
        }
        let mut limits = self.eights.each_ref().map(|eight| limit_eight(eight.rays.t_max));
        limits[self.count / 8..].fill(f32x8::splat(f32::NEG_INFINITY));
        let mut farthest = range(limits)[1];
        let mut walking = u32::MAX >> (32 - self.count);
        leaves.restart();
        stack.clear();
        stack.push(Waiting { entry: Entry::new(self.root, 0.0), rays: walking });
        while let Some(Waiting { entry, rays: meeting }) = stack.pop() {
            let left = meeting & walking;
            if left == 0 || !(M::ANY || entry.begins_before(farthest)) {
                continue;
            }
            let Some(leaf) = entry.child().leaf() else {
                self.descend::<M>(tree, entry.child(), (&limits, farthest, left), stack);
                continue;
            };
            let changed = match tree.content(leaf) {
                Content::Triangles(block) => leaves.visit::<M>(self, tree, block, left, searches),
                Content::Other(index) => self.other::<M>(tree, index, left, searches, context),
            };
            for ray in lanes_of::<RAYS>(changed) {
                if M::ANY && searches[ray].is_blocked() {
                    walking &= !(1 << ray);
                }
                limits[ray / 8].as_mut_array()[ray % 8] = searches[ray].limit();
            }
            if changed != 0 {
                farthest = range(limits)[1];
            }
        }
        leaves.finish(self, tree, searches);
    }

    /// Eights of rays, of which the first hold those of the packet.
    #[inline]
    pub(super) fn eights(&self) -> [&EightRays<f32x8>; EIGHTS] {
        self.eights.each_ref().map(|eight| &eight.rays)
    }

    /// Whether all begin at one point.
    #[inline]
    pub(super) fn has_one_origin(&self) -> bool {
        self.bounds[0] == self.bounds[1]
    }

    /// Leaves the children of a node that some of `rays` (bits) meet for later, with the farthest at the bottom.
    #[inline]
    fn descend<M: Mode>(
        &self,
        tree: &Tree<impl Boxes>,
        node: Child,
        (limits, farthest, rays): (&Lanes, f32, u32),
        stack: &mut Vec<Waiting>,
    ) {
        let node = tree.node(node);
        let met = self.enter(node, farthest);
        let base = stack.len();
        for slot in lanes_of::<WIDTH>(met.bits()) {
            let mut meeting = 0;
            for (i, (eight, limits)) in self.eights[..self.count / 8].iter().zip(limits).enumerate() {
                meeting |= self.meet(node, slot, eight, *limits) << (8 * i);
            }
            let rays = meeting & rays;
            if rays == 0 {
                continue;
            }
            let child = node.child(slot);
            tree.prefetch(child);
            let waiting = Waiting { entry: Entry::new(child, met.near.as_array()[slot]), rays };
            let mut place = stack.len();
            stack.push(waiting);
            while !M::ANY && place > base && stack[place - 1].entry < waiting.entry {
                stack[place] = stack[place - 1];
                place -= 1;
            }
            stack[place] = waiting;
        }
    }

    /// Tries an item that isn't a triangle against those rays that meet its box, given as bits, by eights where it can be; returns them.
    #[inline]
    fn other<M: Mode>(
        &self,
        tree: &Tree<impl Boxes>,
        index: usize,
        meeting: u32,
        searches: &mut [Search; RAYS],
        context: &mut Context,
    ) -> u32 {
        let (searches, _) = searches.as_chunks_mut::<8>();
        for (i, (searches, rays)) in searches.iter_mut().zip(self.eights()).enumerate() {
            let lanes = meeting >> (8 * i) & 0xff;
            if lanes == 0 {
                continue;
            }
            if let Some(hits) = tree.group.other_eight(index, &reaching(rays, searches), context) {
                for lane in lanes_of::<8>(lanes & hits.lanes) {
                    searches[lane].accept::<M>(tree.group, Found::Item(index, hits.get(lane)));
                }
            } else {
                lanes_of::<8>(lanes).for_each(|lane| searches[lane].other::<M>(tree, index, context));
            }
        }
        meeting
    }
}

/// Eight rays as far as they still matter.
#[inline]
pub(super) fn reaching(rays: &EightRays<f32x8>, searches: &[Search; 8]) -> EightRays {
    EightRays { t_max: f32x8::new(from_fn(|lane| searches[lane].reach())), ..rays.widened() }
}

/// The smallest and the largest of some numbers.
#[inline]
fn range(of: Lanes) -> [f32; 2] {
    let ends = of.iter().skip(1).fold([of[0]; 2], |[low, high], x| [low.fast_min(*x), high.fast_max(*x)]);
    let [low, high] = ends.each_ref().map(f32x8::as_array);
    [
        low.iter().fold(f32::INFINITY, |all, x| all.min(*x)),
        high.iter().fold(f32::NEG_INFINITY, |all, x| all.max(*x)),
    ]
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn packets_are_narrow_in_one_octant_and_along_one_axis() {
        let group: Group = Group::of_scene(&[], &[]);
        let count = |way: Vec3, turn: Vec3| {
            let rays: [Ray; 40] =
                from_fn(|ray| Ray::new(Vec3::ZERO, (way + turn * ray as f32).normalize(), 0.0));
            Packet::new(&group, &rays).map_or(0, |packet| packet.count)
        };
        let way = Vec3::new(1.0, 0.5, 0.5);
        // Neighbours turn by 0.04°, by 0.2° and by 0.4°.
        assert_eq!([0.001, 0.005, 0.01].map(|turn| count(way, Vec3::Y * turn)), [32, 8, 0]);
        // The 13th ray points to another octant, and along another axis.
        assert_eq!(count(Vec3::new(1.0, -0.0125, 0.5), Vec3::Y * 0.001), 8);
        assert_eq!(count(Vec3::new(1.0, 0.9875, 0.5), Vec3::Y * 0.001), 8);
    }
}
