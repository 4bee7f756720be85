//! Nodes of eight boxes, and rays prepared for them.

use std::fmt::Debug;

use bytemuck::Pod;
use glam::Vec3;
use obvhs::aabb::Aabb;
use wide::{f32x8, f32x16, i32x8};

use super::walk::Mode;
use crate::math::bounds::Bounds;
use crate::math::eight::{Vec3x8, packed, sorted};
use crate::ray::Ray;

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// What a node's child is: the index of a node, or of a leaf where the top bit is set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Child(u32);

const LEAF: u32 = 1 << 31;

impl Default for Child {
    fn default() -> Self {
        Self::NONE
    }
}

impl Child {
    /// Neither node nor leaf.
    pub(super) const NONE: Self = Self(u32::MAX);

    /// The node or leaf of index `index` below 2³¹ − 1.
    pub(super) fn new(index: usize, is_leaf: bool) -> Self {
        let index = u32::try_from(index).ok().filter(|&i| i < LEAF - 1);
        let index =
            index.expect("elements are counted in u32, and there are at most half as many leaves and nodes");
        Self(if is_leaf { index | LEAF } else { index })
    }

    /// The same in an array that lies after `nodes` other nodes and `leaves` other leaves.
    pub(super) fn shifted(self, nodes: usize, leaves: usize) -> Self {
        match self.leaf() {
            _ if self == Self::NONE => self,
            Some(index) => Self::new(index + leaves, true),
            None => Self::new(self.node() + nodes, false),
        }
    }

    /// A number for it.
    #[inline]
    pub(super) fn bits(self) -> u32 {
        self.0
    }

    /// The child whose number is the lower half of `bits`.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "the upper half is dropped")]
    pub(super) fn from_bits(bits: u64) -> Self {
        Self(bits as u32)
    }

    /// The index of the leaf, if it is one.
    #[inline]
    pub(super) fn leaf(self) -> Option<usize> {
        self.is_leaf().then_some(self.index())
    }

    /// Whether it isn't a node.
    #[inline]
    pub(super) fn is_leaf(self) -> bool {
        self.0 & LEAF != 0
    }

    /// The index among nodes, or among leaves.
    #[inline]
    pub(super) fn index(self) -> usize {
        (self.0 & !LEAF) as usize
    }

    /// The index of the node, if it is one.
    #[inline]
    pub(super) fn node(self) -> usize {
        self.0 as usize
    }
}

/// Up to eight boxes with what is in them.
#[derive(Debug, Clone)]
pub(super) struct Node {
    /// Lower and upper sides by axis; a slot without a child has both at infinity, whichever way a ray goes beyond its limit or behind it.
    sides: [[[f32; WIDTH]; 2]; 3],
    children: [Child; WIDTH],
}

/// A node as it lies in memory, with boxes that may depend on the time.
pub(super) trait Boxes: Pod + Debug + Send + Sync {
    /// A single box.
    type Bounds: Copy + Debug + Send + Sync;

    /// What tells the times of the trees.
    type Clock: Debug;

    /// The index of the tree to walk, and how far through its span of time that is.
    fn place(clock: &Self::Clock, time: f32) -> (usize, f32);

    /// How far through a tree's span of time rays of eight times are: beyond 0 and 1 where other trees are for them.
    fn through(clock: &Self::Clock, tree: usize, times: f32x8) -> f32x8;

    /// The children's bits by slot.
    fn children(&self) -> &[u32; WIDTH];

    /// The child in a slot below 8.
    #[inline]
    fn child(&self, slot: usize) -> Child {
        Child(self.children()[slot])
    }

    /// The lower (0) or upper (1) sides of all boxes along an axis at a time.
    fn sides(&self, axis: usize, which: usize, through: f32) -> f32x8;

    /// The lowest of the lower sides of each box, or the highest of the upper ones, between two times.
    fn farthest_sides(&self, axis: usize, which: usize, through: [f32; 2]) -> f32x8;

    /// A side of the box in a slot at eight times.
    fn side(&self, slot: usize, axis: usize, which: usize, through: f32x8) -> f32x8;

    /// A side of a box at eight times.
    fn side_of(bounds: &Self::Bounds, axis: usize, which: usize, through: f32x8) -> f32x8;

    /// The boxes that the ray meets before `limit`.
    #[inline]
    fn enter(&self, slab: &Slab, limit: f32) -> Met {
        let distances = |axis: usize| {
            let (origin, inverse) = (f32x8::splat(slab.origin[axis]), f32x8::splat(slab.inverse[axis]));
            [0, 1].map(|which| (self.sides(axis, which, slab.through) - origin) * inverse)
        };
        met(distances, f32x8::splat(limit))
    }
}

/// A node at rest: the sides, the children's bits, and nothing, in eights.
pub(super) type NodeMemory = [f32x16; 4];

impl Boxes for NodeMemory {
    type Bounds = Bounds32;
    type Clock = ();

    #[inline]
    fn place((): &(), _: f32) -> (usize, f32) {
        (0, 0.0)
    }

    #[inline]
    fn through((): &(), _: usize, _: f32x8) -> f32x8 {
        f32x8::ZERO
    }

    #[inline]
    fn children(&self) -> &[u32; WIDTH] {
        let eights: &[[u32; WIDTH]; 8] = bytemuck::cast_ref(self);
        &eights[6]
    }

    #[inline]
    fn sides(&self, axis: usize, which: usize, _: f32) -> f32x8 {
        let eights: &[f32x8; 8] = bytemuck::cast_ref(self);
        eights[2 * axis + which]
    }

    #[inline]
    fn farthest_sides(&self, axis: usize, which: usize, _: [f32; 2]) -> f32x8 {
        self.sides(axis, which, 0.0)
    }

    #[inline]
    fn side(&self, slot: usize, axis: usize, which: usize, _: f32x8) -> f32x8 {
        let eights: &[[f32; WIDTH]; 8] = bytemuck::cast_ref(self);
        f32x8::splat(eights[2 * axis + which][slot])
    }

    #[inline]
    fn side_of(bounds: &Bounds32, axis: usize, which: usize, _: f32x8) -> f32x8 {
        f32x8::splat([bounds.min, bounds.max][which][axis])
    }
}

/// Four roundings within 2⁻²⁴ on each side of a comparison (a difference, the inverse, its slack, a product):
/// 1 + 2·4·2⁻²⁴, rounded up.
///
/// # Source
/// Ize 2013, Robust BVH Ray Traversal, JCGT 2(2).
pub(super) const SLACK: f32 = 1.0 + 5.0 * f32::EPSILON;

impl Node {
    /// The node over `children` with their boxes, at most eight of them.
    pub(super) fn new(children: &[(Bounds32, Child)]) -> Self {
        let mut sides = [[[f32::INFINITY; WIDTH]; 2]; 3];
        let mut list = [Child::NONE; WIDTH];
        for (slot, (bounds, child)) in children.iter().enumerate() {
            for (axis, [low, high]) in sides.iter_mut().enumerate() {
                low[slot] = bounds.min[axis];
                high[slot] = bounds.max[axis];
            }
            list[slot] = *child;
        }
        Self { sides, children: list }
    }

    /// The node with its children replaced.
    pub(super) fn with_children(self, f: impl Fn(Child) -> Child) -> Self {
        Self { children: self.children.map(f), ..self }
    }

    /// The children by slot.
    pub(super) fn children(&self) -> &[Child; WIDTH] {
        &self.children
    }

    /// What lies in memory.
    pub(super) fn to_memory(&self) -> NodeMemory {
        let mut memory = [[0.0; WIDTH]; 8];
        memory[..6].copy_from_slice(self.sides.as_flattened());
        memory[6] = self.children.map(|child| f32::from_bits(child.0));
        bytemuck::cast(memory)
    }
}

/// A box in f32.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Bounds32 {
    pub(super) min: Vec3,
    pub(super) max: Vec3,
}

impl Bounds32 {
    /// The box in f32, rounded outwards and grown by 2⁻²¹ of its size: a hit on a triangle's edge may lie outside the
    /// triangle by the 2⁻²⁴ of twice its size to which sheared vertices are rounded.
    pub(super) fn padded(bounds: &Bounds) -> Self {
        let margin = (bounds.max - bounds.min).max_element() * 2f64.powi(-21);
        let [min, max] = bounds.grown(glam::DVec3::splat(margin)).to_f32_outward();
        Self { min, max }
    }

    /// The box of a builder's.
    pub(super) fn of(aabb: &Aabb) -> Self {
        Self { min: aabb.min.into(), max: aabb.max.into() }
    }

    /// Half the surface area of the box scaled by a factor: of large boxes themselves not even a few could be added.
    pub(super) fn half_area(&self, scale: f32) -> f32 {
        let size = (self.max - self.min) * scale;
        (size.x + size.y) * size.z + size.x * size.y
    }

    /// The smallest box that holds both.
    pub(super) fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }
}

/// A ray prepared for boxes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slab {
    pub(super) origin: [f32; 3],
    pub(super) inverse: [f32; 3],
    /// How far through its tree's span of time.
    pub(super) through: f32,
}

impl Slab {
    #[inline]
    pub(super) fn new(ray: &Ray, through: f32) -> Self {
        // A finite inverse keeps 0 · ∞ out of `enter` where the origin lies in a side's plane.
        let inverse = ray.direction.recip().clamp(Vec3::MIN, Vec3::MAX);
        Self { origin: ray.origin.to_array(), inverse: inverse.to_array(), through }
    }
}

/// As in `Slab::new`, for eight rays.
#[inline]
pub(super) fn inverses(direction: Vec3x8) -> Vec3x8 {
    let (lowest, highest) = (f32x8::splat(f32::MIN), f32x8::splat(f32::MAX));
    direction.map(|d| (f32x8::ONE / d).fast_max(lowest).fast_min(highest))
}

/// Which of eight boxes are met, and how far away each is entered.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Met {
    /// All bits in the lanes of those that are met, and none in the others.
    mask: f32x8,
    pub(super) near: f32x8,
}

impl Met {
    /// Those that are met, as bits.
    #[inline]
    pub(super) fn bits(&self) -> u32 {
        self.mask.to_bitmask()
    }

    /// The slots of the boxes that are met, the farthest first, or the last where any hit will do: in the three lowest bits, with
    /// those of the distance above if it matters. What follows them is of no meaning.
    #[inline]
    pub(super) fn order<M: Mode>(&self) -> i32x8 {
        if M::ANY {
            // Nothing is passed over, so distances don't matter.
            return bytemuck::cast(packed(self.bits()));
        }
        let slots = i32x8::new([0, 1, 2, 3, 4, 5, 6, 7]);
        let (mask, near): (i32x8, i32x8) = (bytemuck::cast(self.mask), bytemuck::cast(self.near));
        // Without its sign: a box around the origin may begin at −0.
        sorted(near & i32x8::splat(i32::MAX & !7) | slots | !mask)
    }
}

/// Which of eight boxes are met before their limits, by the distances of their two sides along each axis.
#[inline(always)]
pub(super) fn met(distances: impl Fn(usize) -> [f32x8; 2], limits: f32x8) -> Met {
    let [x, y, z] = [distances(0), distances(1), distances(2)];
    let near = |[a, b]: [f32x8; 2]| a.fast_min(b);
    let far = |[a, b]: [f32x8; 2]| a.fast_max(b);
    // As trees, whose results are there sooner than a chain's.
    let enter = near(x).fast_max(near(y)).fast_max(near(z).fast_max(f32x8::ZERO));
    let leave = far(x).fast_min(far(y)).fast_min(far(z));
    Met { mask: enter.simd_le((leave * f32x8::splat(SLACK)).fast_min(limits)), near: enter }
}

/// The lanes of a mask, in their order, below `N`.
#[inline]
pub(super) fn lanes_of<const N: usize>(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = (mask != 0).then_some(mask.trailing_zeros() as usize % N);
        mask &= mask.wrapping_sub(1);
        lane
    })
}

/// How far away a box may begin and still matter, if hits matter up to `reach`; finite, so that a ray along an axis
/// misses boxes infinitely far away.
#[inline]
pub(super) fn limit(reach: f32) -> f32 {
    (reach * SLACK).min(f32::MAX)
}

/// `limit` of eight rays.
#[inline]
pub(super) fn limit_eight(reach: f32x8) -> f32x8 {
    (reach * f32x8::splat(SLACK)).fast_min(f32x8::splat(f32::MAX))
}

/// How many nodes or items ahead the memory of a list of them is fetched.
pub(super) const AHEAD: usize = 16;

/// Fetches the cache line of a value, where the processor has an instruction for it.
#[inline]
pub(super) fn prefetch<T>(value: &T) {
    #[cfg(target_arch = "x86_64")]
    safe_arch::prefetch_t0(value);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = value;
}
