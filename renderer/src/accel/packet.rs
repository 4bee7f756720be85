//! Eight rays that go the same way, walked together.

use std::array::from_fn;

use wide::f32x8;

use super::group::Context;
use super::node::{Child, NodeRef, Slab, WIDTH, limit, met};
use super::walk::{Entry, Mode, Search, Tree};
use crate::ray::Ray;

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
    origin: [f32x8; 3],
    inverse: [f32x8; 3],
    /// 1 on the axes along which all rays meet the upper side first.
    upper_first: [usize; 3],
    /// Origins from which distances to the nearer and to the farther sides bound those of all rays.
    bounds: [[f32; 3]; 2],
    /// The smallest and the largest inverse.
    inverses: [[f32; 2]; 3],
}

impl Packet {
    /// The packet of `rays`; `None` if they point in different octants or too many ways to gain from it.
    #[inline]
    pub(super) fn new(rays: &[Ray; RAYS]) -> Option<Self> {
        let first = &rays[0];
        if rays.iter().any(|ray| ray.direction.dot(first.direction) < NARROW) {
            return None;
        }
        let slabs: [Slab; RAYS] = from_fn(|ray| Slab::new(&rays[ray]));
        let octant = |slab: &Slab| slab.inverse.map(|i| i < 0.0);
        let upper_first = octant(&slabs[0]);
        if slabs.iter().any(|slab| octant(slab) != upper_first) {
            return None;
        }
        let upper_first = upper_first.map(usize::from);
        let lanes = |of: fn(&Slab) -> &[f32; 3]| from_fn(|axis| from_fn(|ray| of(&slabs[ray])[axis]));
        let [origin, inverse]: [[[f32; RAYS]; 3]; 2] = [lanes(|s| &s.origin), lanes(|s| &s.inverse)];
        let range = |of: &[f32; RAYS]| {
            of.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)])
        };
        let origins = origin.each_ref().map(range);
        let wide = |lanes: [[f32; RAYS]; 3]| lanes.map(f32x8::new);
        Some(Self {
            // A greater origin is nearer to the upper sides.
            bounds: [1, 0].map(|near| from_fn(|axis| origins[axis][near ^ upper_first[axis]])),
            inverses: inverse.each_ref().map(range),
            origin: wide(origin),
            inverse: wide(inverse),
            upper_first,
        })
    }

    /// Which boxes of a node some ray may meet before `limit` (bits), and a bound on how far away the first enters each.
    ///
    /// Rounding keeps order: the bounds hold for what `Slab::enter` computes for each ray, in every bit.
    #[inline]
    fn enter(&self, node: NodeRef, limit: f32) -> (u32, f32x8) {
        let products = |axis: usize, end: usize| {
            let side = node.side(axis, self.upper_first[axis] ^ end) - f32x8::splat(self.bounds[end][axis]);
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
    fn meet(&self, node: NodeRef, slot: usize, limits: f32x8) -> u32 {
        let distance = |axis: usize, which: usize| {
            (f32x8::splat(node.side(axis, which).as_array()[slot]) - self.origin[axis]) * self.inverse[axis]
        };
        met(|axis| [distance(axis, 0), distance(axis, 1)], limits).0
    }

    /// Walks the rays through a tree. Each meets at least the boxes that it meets alone, so it finds the same.
    #[inline]
    pub(super) fn walk<M: Mode>(
        &self,
        tree: &Tree,
        rays: &[Ray; RAYS],
        stack: &mut Vec<Waiting>,
        context: &mut Context,
    ) -> [Search; RAYS] {
        let mut searches: [Search; RAYS] = from_fn(|ray| Search::new(&rays[ray]));
        let mut limits = f32x8::new(from_fn(|ray| limit(rays[ray].t_max)));
        let mut farthest = highest(&limits);
        let mut walking = ALL;
        stack.clear();
        stack.push(Waiting { entry: Entry::new(tree.group.root, 0.0), rays: ALL });
        while let Some(Waiting { entry, rays }) = stack.pop() {
            let left = rays & walking;
            if left == 0 || !(M::ANY || entry.begins_before(farthest)) {
                continue;
            }
            let Some(leaf) = entry.child().leaf() else {
                self.descend::<M>(tree, entry.child(), (&limits, farthest, walking), stack);
                continue;
            };
            // All candidates first: what the branches below depend on is known when they come.
            let mut candidates = [(0, 0); RAYS];
            for ray in lanes_of(left) {
                candidates[ray] = searches[ray].candidates::<M>(tree, leaf);
            }
            for ray in lanes_of(left) {
                searches[ray].settle::<M>(tree, leaf, candidates[ray], context);
                if M::ANY && searches[ray].is_blocked() {
                    walking &= !(1 << ray);
                }
                limits.as_mut_array()[ray] = searches[ray].limit();
            }
            farthest = highest(&limits);
        }
        searches
    }

    /// Leaves the children of a node that rays meet for later, with the farthest at the bottom.
    #[inline]
    fn descend<M: Mode>(
        &self,
        tree: &Tree,
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
        let packet = |way: Vec3, turn: Vec3| {
            Packet::new(&from_fn(|ray| Ray::new(Vec3::ZERO, (way + turn * ray as f32).normalize(), 0.0)))
        };
        let way = Vec3::new(1.0, 0.5, 0.5);
        // The last of eight turns by about 1.6°, and by 16°.
        assert!(packet(way, Vec3::Y * 0.005).is_some());
        assert!(packet(way, Vec3::Y * 0.05).is_none());
        assert!(packet(Vec3::new(1.0, -0.01, 0.5), Vec3::Y * 0.005).is_none());
    }
}
