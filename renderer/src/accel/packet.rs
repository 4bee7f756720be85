//! Eight rays that go the same way, walked together.

use std::array::from_fn;

use wide::f32x8;

use super::group::{Context, Group};
use super::node::{Boxes, Child, WIDTH, inverses, limit, met};
use super::walk::{Content, Entry, Found, Mode, Search, Tree};
use crate::ray::{EightRays, Ray};

/// Rays of a packet.
pub(super) const RAYS: usize = 8;

/// All rays of a packet, as bits.
pub(super) const ALL: u32 = (1 << RAYS) - 1;

/// Cosine of the widest angle between the first ray of a packet and another; measured in benches/README.md.
const NARROW: f32 = 0.999;

/// A child to visit later, and the rays that meet its box.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Waiting {
    entry: Entry,
    rays: u32,
}

/// Eight rays prepared for boxes.
#[derive(Debug)]
pub(super) struct Packet {
    /// Where they begin, how far through its tree's span of time each is, and the first and the last of them.
    root: Child,
    through: f32x8,
    span: [f32; 2],
    rays: EightRays<f32x8>,
    inverse: [f32x8; 3],
    /// 1 on the axes along which all rays meet the upper side first.
    upper_first: [usize; 3],
    /// Origins from which distances to the nearer and to the farther sides bound those of all rays.
    bounds: [[f32; 3]; 2],
    /// The smallest and the largest inverse.
    inverses: [[f32; 2]; 3],
}

impl Packet {
    /// The packet of `rays`; `None` if they begin at different roots, point in different octants or too many ways to gain from it.
    #[inline]
    pub(super) fn new(group: &Group<impl Boxes>, rays: &[Ray; RAYS]) -> Option<Self> {
        let first = &rays[0];
        if rays.iter().any(|ray| ray.direction.dot(first.direction) < NARROW) {
            return None;
        }
        let lanes = EightRays::new(rays);
        let (root, through) = group.start_together(first, lanes.time)?;
        let inverse = inverses(lanes.direction).0;
        let upward = inverse.map(|inverse| inverse.simd_lt(f32x8::ZERO).to_bitmask());
        if upward.iter().any(|&lanes| lanes != 0 && lanes != ALL) {
            return None;
        }
        let upper_first = upward.map(|lanes| usize::from(lanes != 0));
        let range = |of: &f32x8| {
            of.as_array()
                .iter()
                .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)])
        };
        let origins = lanes.origin.0.each_ref().map(range);
        Some(Self {
            root,
            through,
            span: range(&through),
            // A greater origin is nearer to the upper sides.
            bounds: [1, 0].map(|near| from_fn(|axis| origins[axis][near ^ upper_first[axis]])),
            inverses: inverse.each_ref().map(range),
            inverse,
            rays: lanes,
            upper_first,
        })
    }

    /// Which boxes of a node some ray may meet before `limit` (bits), and a bound on how far away the first enters each.
    ///
    /// Rounding keeps order: the bounds hold for what `Boxes::enter` computes for each ray, in every bit.
    #[inline]
    fn enter(&self, node: &impl Boxes, limit: f32) -> (u32, f32x8) {
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

    /// Which rays meet the box in a slot of a node before their limits, as bits.
    #[inline]
    fn meet(&self, node: &impl Boxes, slot: usize, limits: f32x8) -> u32 {
        let distance = |axis: usize, which: usize| {
            (node.side(slot, axis, which, self.through) - self.rays.origin.0[axis]) * self.inverse[axis]
        };
        met(|axis| [distance(axis, 0), distance(axis, 1)], limits).0
    }

    /// Walks the rays through a tree, and puts what they find into `searches`. Each meets at least the boxes that it meets alone, so it
    /// finds the same.
    #[inline]
    pub(super) fn walk<M: Mode>(
        &self,
        tree: &Tree<impl Boxes>,
        rays: &[Ray; RAYS],
        searches: &mut [Search; RAYS],
        stack: &mut Vec<Waiting>,
        context: &mut Context,
    ) {
        for (search, ray) in searches.iter_mut().zip(rays) {
            search.restart(ray);
        }
        let mut limits = f32x8::new(from_fn(|ray| limit(rays[ray].t_max)));
        let mut farthest = highest(&limits);
        let mut walking = ALL;
        let mut eight = self.rays.widened();
        stack.clear();
        stack.push(Waiting { entry: Entry::new(self.root, 0.0), rays: ALL });
        while let Some(Waiting { entry, rays: meeting }) = stack.pop() {
            let left = meeting & walking;
            if left == 0 || !(M::ANY || entry.begins_before(farthest)) {
                continue;
            }
            let Some(leaf) = entry.child().leaf() else {
                self.descend::<M>(tree, entry.child(), (&limits, farthest, walking), stack);
                continue;
            };
            if !at_once::<M>(tree, leaf, left, &mut eight, searches, context) {
                // All candidates first: what the branches below depend on is known when they come.
                let mut candidates = [(0, 0); RAYS];
                for ray in lanes_of(left) {
                    candidates[ray] = searches[ray].candidates::<M>(tree, leaf);
                }
                for ray in lanes_of(left) {
                    searches[ray].settle::<M>(tree, leaf, candidates[ray], context);
                }
            }
            for ray in lanes_of(left) {
                if M::ANY && searches[ray].is_blocked() {
                    walking &= !(1 << ray);
                }
                limits.as_mut_array()[ray] = searches[ray].limit();
            }
            farthest = highest(&limits);
        }
    }

    /// Leaves the children of a node that rays meet for later, with the farthest at the bottom.
    #[inline]
    fn descend<M: Mode>(
        &self,
        tree: &Tree<impl Boxes>,
        node: Child,
        (limits, farthest, walking): (&f32x8, f32, u32),
        stack: &mut Vec<Waiting>,
    ) {
        let node = tree.node(node);
        let (slots, near) = self.enter(node, farthest);
        let base = stack.len();
        let mut meeting = [0; WIDTH];
        for slot in lanes_of(slots) {
            meeting[slot] = self.meet(node, slot, *limits) & walking;
        }
        for slot in lanes_of(slots) {
            let rays = meeting[slot];
            if rays == 0 {
                continue;
            }
            let child = node.child(slot);
            tree.prefetch(child);
            let waiting = Waiting { entry: Entry::new(child, near.as_array()[slot]), rays };
            let mut place = stack.len();
            stack.push(waiting);
            while !M::ANY && place > base && stack[place - 1].entry < waiting.entry {
                stack[place] = stack[place - 1];
                place -= 1;
            }
            stack[place] = waiting;
        }
    }
}

/// Tries a leaf's shape against those rays of a packet that meet its box, given as bits, if it can be tested against eight at once.
#[inline]
fn at_once<M: Mode>(
    tree: &Tree<impl Boxes>,
    leaf: usize,
    meeting: u32,
    eight: &mut EightRays,
    searches: &mut [Search; RAYS],
    context: &Context,
) -> bool {
    let Content::Other(index) = tree.content(leaf) else { return false };
    eight.t_max = f32x8::new(from_fn(|ray| searches[ray].reach()));
    let hits = tree.group.other_eight(index, eight, context);
    if let Some(hits) = &hits {
        for ray in lanes_of(meeting & hits.lanes) {
            searches[ray].accept::<M>(tree.group, Found::Item(index, hits.get(ray)));
        }
    }
    hits.is_some()
}

/// The lanes of a mask, in their order.
#[inline]
pub(super) fn lanes_of(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = (mask != 0).then_some(mask.trailing_zeros() as usize % RAYS);
        mask &= mask.wrapping_sub(1);
        lane
    })
}

fn highest(limits: &f32x8) -> f32 {
    limits.as_array().iter().fold(f32::NEG_INFINITY, |all, x| all.max(*x))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn packets_are_narrow_and_in_one_octant() {
        let group: Group = Group::of_scene(&[], &[]);
        let packet = |way: Vec3, turn: Vec3| {
            let rays = from_fn(|ray| Ray::new(Vec3::ZERO, (way + turn * ray as f32).normalize(), 0.0));
            Packet::new(&group, &rays)
        };
        let way = Vec3::new(1.0, 0.5, 0.5);
        // The last of eight turns by about 1.6°, and by 16°.
        assert!(packet(way, Vec3::Y * 0.005).is_some());
        assert!(packet(way, Vec3::Y * 0.05).is_none());
        assert!(packet(Vec3::new(1.0, -0.01, 0.5), Vec3::Y * 0.005).is_none());
    }
}
