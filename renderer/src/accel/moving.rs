//! Trees over moving objects whose boxes move with them.

use std::time::Duration;

use glam::{DVec3, Vec3};
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use wide::f32x8;

use super::collapse::{WideTree, collapse};
use super::group::{BUILD, Context, comes_before};
use super::node::{Child, Slab, WIDTH, limit};
use super::object::Object;
use super::walk::{Closest, Entry, Pending};
use crate::math::bounds::Bounds;
use crate::ray::{Hit, Ray};

/// A box at the start and one at the end of a segment of the shutter; in between it is interpolated.
type Pair = [Bounds; 2];

/// One tree for each of a number of equal segments of the shutter.
#[derive(Debug)]
pub(super) struct MovingTrees {
    shutter: [f64; 2],
    segments: Vec<Segment>,
}

#[derive(Debug)]
struct Segment {
    root: Child,
    nodes: Vec<MovingNode>,
    /// The object in each leaf.
    objects: Vec<u32>,
    stack: usize,
    /// Half the surface areas of its boxes, averaged over the segment.
    area: f64,
}

/// Up to eight moving boxes with what is in them.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct MovingNode {
    /// Lower and upper sides by axis at the start, and how far they move until the end.
    sides: [[f32x8; 2]; 3],
    change: [[f32x8; 2]; 3],
    children: [Child; WIDTH],
}

impl MovingTrees {
    /// The trees over the objects listed, with the shutter cut into `segments`.
    pub(super) fn new(objects: &[Object], listed: &[u32], shutter: [f64; 2], segments: u32) -> Self {
        let times = cuts(shutter, segments);
        let segment = |span: &[f64]| Segment::new(objects, listed, [span[0], span[1]]);
        Self { shutter, segments: times.windows(2).map(segment).collect() }
    }

    /// The trees with the fewest segments, a power of two, of which twice as many would not help much.
    pub(super) fn chosen(objects: &[Object], listed: &[u32], shutter: [f64; 2]) -> Self {
        let mut best = Self::new(objects, listed, shutter, 1);
        let mut count = 2;
        while count <= MOST_SEGMENTS {
            let next = Self::new(objects, listed, shutter, count);
            if next.mean_area() * SEGMENT_GAIN > best.mean_area() {
                break;
            }
            best = next;
            count *= 2;
        }
        best
    }

    /// Half the surface areas of all boxes, averaged over the shutter: what a random ray meets is proportional to it.
    fn mean_area(&self) -> f64 {
        self.segments.iter().map(|s| s.area).sum::<f64>() / self.segments.len() as f64
    }

    /// The ray's segment and how far through it the ray is.
    fn at(&self, ray: &Ray) -> (&Segment, f32) {
        let [open, close] = self.shutter;
        let count = self.segments.len();
        let place = (f64::from(ray.time) - open) / (close - open) * count as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the segments"
        )]
        let index = (place.max(0.0) as usize).min(count - 1);
        #[expect(clippy::cast_possible_truncation, reason = "boxes are grown by its rounding")]
        let through = (place - index as f64).clamp(0.0, 1.0) as f32;
        (&self.segments[index], through)
    }

    /// The first of `best` and the hits of moving objects.
    pub(super) fn closest(&self, ray: &Ray, mut best: Option<Hit>, context: &mut Context) -> Option<Hit> {
        let mut query = Ray { t_max: best.map_or(ray.t_max, |hit| hit.t.next_up()), ..*ray };
        self.search(&query.clone(), context, |object, context| {
            if let Some(hit) = context.object(object, &query)
                && best.is_none_or(|best| comes_before(&hit, &best))
            {
                best = Some(hit);
                query.t_max = hit.t.next_up();
            }
            Some(query.t_max)
        });
        best
    }

    /// Whether a moving object is hit.
    pub(super) fn occluded(&self, ray: &Ray, context: &mut Context) -> bool {
        let mut any = false;
        self.search(ray, context, |object, context| {
            any = context.object(object, ray).is_some();
            (!any).then_some(ray.t_max)
        });
        any
    }

    /// Calls `visit` with each object whose box the ray meets before what `visit` returned last; `None` ends the search.
    fn search(
        &self,
        ray: &Ray,
        context: &mut Context,
        mut visit: impl FnMut(u32, &mut Context) -> Option<f32>,
    ) {
        let (segment, through) = self.at(ray);
        let slab = Slab::new(ray);
        let mut stack = std::mem::take(&mut context.moving_stack);
        stack.resize(segment.stack, Entry::default());
        let mut pending = Pending { stack: &mut stack, bottom: 0, top: 0 };
        let mut reach = limit(ray.t_max);
        let mut next = segment.root;
        while next != Child::NONE {
            if let Some(leaf) = next.leaf() {
                match visit(segment.objects[leaf], context) {
                    Some(t_max) => reach = limit(t_max),
                    None => break,
                }
                next = Child::NONE;
            } else {
                let node = &segment.nodes[next.node()];
                let (mask, near) = node.enter(&slab, through, reach);
                next = pending.choose::<Closest>(mask, &near, |slot| node.children[slot]);
            }
            if next == Child::NONE {
                next = pending.pop::<Closest>(reach);
            }
        }
        context.moving_stack = stack;
    }

    /// Number of boxes that the ray meets before `reach`: around nodes, and around leaves.
    pub(super) fn boxes_met(&self, ray: &Ray, reach: f32) -> [u64; 2] {
        let (segment, through) = self.at(ray);
        let slab = Slab::new(ray);
        let mut met = [0; 2];
        let mut waiting = vec![segment.root];
        while let Some(child) = waiting.pop() {
            if child.leaf().is_none() {
                let node = &segment.nodes[child.node()];
                let (mask, _) = node.enter(&slab, through, limit(reach));
                let slots = (0..WIDTH).filter(|slot| mask >> slot & 1 == 1);
                for child in slots.map(|slot| node.children[slot]) {
                    met[usize::from(child.leaf().is_some())] += 1;
                    waiting.push(child);
                }
            }
        }
        met
    }
}

impl Segment {
    fn new(objects: &[Object], listed: &[u32], span: [f64; 2]) -> Self {
        let pairs: Vec<Pair> = listed.iter().map(|&o| pair(&objects[o as usize], span)).collect();
        let middle = |[a, b]: &Pair| Bounds { min: (a.min + b.min) * 0.5, max: (a.max + b.max) * 0.5 };
        let boxes: Vec<Aabb> = pairs.iter().map(|pair| aabb(&middle(pair))).collect();
        let binary = build_bvh2(&boxes, BUILD, &mut Duration::default());
        // Each object has a leaf of its own.
        let wide = collapse(&binary, &|_| 8);
        let mut segment = Self {
            root: wide.root,
            nodes: vec![MovingNode::new(&[]); wide.nodes.len()],
            objects: wide.order.iter().map(|&item| listed[item as usize]).collect(),
            stack: 7 * wide.depth + 1,
            area: 0.0,
        };
        if wide.root != Child::NONE {
            segment.bound(&wide, &pairs, wide.root);
        }
        segment
    }

    /// Writes the boxes below a child; returns the one around it.
    fn bound(&mut self, wide: &WideTree, pairs: &[Pair], child: Child) -> Pair {
        if let Some(leaf) = child.leaf() {
            return pairs[wide.order[leaf] as usize];
        }
        let children = wide.nodes[child.node()].children().iter().filter(|c| **c != Child::NONE);
        let list: Vec<(Pair, Child)> = children.map(|&c| (self.bound(wide, pairs, c), c)).collect();
        self.nodes[child.node()] = MovingNode::new(&list);
        self.area += list.iter().map(|(pair, _)| mean_half_area(pair)).sum::<f64>();
        let around = |end: usize| list.iter().fold(Bounds::EMPTY, |all, (pair, _)| all.union(&pair[end]));
        [around(0), around(1)]
    }
}

impl MovingNode {
    fn new(list: &[(Pair, Child)]) -> Self {
        // As in `Node::new`.
        let (mut sides, mut change) = ([[[f32::INFINITY; WIDTH]; 2]; 3], [[[0.0; WIDTH]; 2]; 3]);
        let mut children = [Child::NONE; WIDTH];
        for (slot, (pair, child)) in list.iter().enumerate() {
            let [start, end] = pair.each_ref().map(padded);
            for axis in 0..3 {
                for side in 0..2 {
                    sides[axis][side][slot] = start[side][axis];
                    change[axis][side][slot] = end[side][axis] - start[side][axis];
                }
            }
            children[slot] = *child;
        }
        let wide = |all: [[[f32; WIDTH]; 2]; 3]| all.map(|axis| axis.map(f32x8::new));
        Self { sides: wide(sides), change: wide(change), children }
    }

    #[inline]
    fn enter(&self, slab: &Slab, through: f32, limit: f32) -> (u32, f32x8) {
        let through = f32x8::splat(through);
        slab.enter(|axis, side| self.change[axis][side].mul_add(through, self.sides[axis][side]), limit)
    }
}

/// The box in f32, grown for the rounding of hits on its contents (2⁻²¹ of its size, as for boxes at rest) and of the
/// interpolation: with |side| ≤ m at both ends, its change, the product, the sum and the place in time round within
/// 2⁻²⁴ of 2m each, below 2⁻²⁰·m.
fn padded(bounds: &Bounds) -> [Vec3; 2] {
    let size = (bounds.max - bounds.min).max_element();
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    bounds.grown(DVec3::splat(size * 2f64.powi(-21) + largest * 2f64.powi(-20))).to_f32_outward()
}

fn aabb(bounds: &Bounds) -> Aabb {
    let [min, max] = bounds.to_f32_outward();
    Aabb::new(min.into(), max.into())
}

/// The ends of `segments` equal parts of the shutter.
fn cuts([open, close]: [f64; 2], segments: u32) -> Vec<f64> {
    (0..=segments).map(|i| open + (close - open) * (f64::from(i) / f64::from(segments))).collect()
}

/// The object's boxes at the two ends of a span of time.
fn pair(object: &Object, span: [f64; 2]) -> Pair {
    let own = object.shape.bounds();
    object.motion.as_ref().map_or([own; 2], |motion| motion.interpolated(&own, span))
}

/// A box may be this much larger than the object's own, on average over the shutter, and still stand for it at all
/// times: then its tree is that of the objects at rest, and no other needs to be searched.
///
/// # Source
/// Psychopath, a renderer by N. Vegdahl, joins its boxes by this factor.
const SWEPT_AREA: f64 = 1.4;

/// Most segments of the shutter, and how many times smaller boxes must become to cut it in twice as many.
const MOST_SEGMENTS: u32 = 16;
const SEGMENT_GAIN: f64 = 1.1;

/// Whether one box for all times is good enough for an object.
pub(super) fn is_slow(object: &Object, shutter: [f64; 2]) -> bool {
    let Some(motion) = &object.motion else { return true };
    let own = object.shape.bounds();
    half_area(&motion.swept(&own, shutter)) <= SWEPT_AREA * mean_area(object, shutter)
}

/// Half the surface area of an object's box, interpolated on the most segments, averaged over the shutter.
fn mean_area(object: &Object, shutter: [f64; 2]) -> f64 {
    let times = cuts(shutter, MOST_SEGMENTS);
    let sum: f64 = times.windows(2).map(|span| mean_half_area(&pair(object, [span[0], span[1]]))).sum();
    sum / f64::from(MOST_SEGMENTS)
}

/// Half the surface area of an interpolated box, averaged over time: it is quadratic there, and Simpson's rule exact.
fn mean_half_area([a, b]: &Pair) -> f64 {
    let middle = Bounds { min: (a.min + b.min) * 0.5, max: (a.max + b.max) * 0.5 };
    (half_area(a) + 4.0 * half_area(&middle) + half_area(b)) / 6.0
}

fn half_area(bounds: &Bounds) -> f64 {
    let size = bounds.max - bounds.min;
    size.x * size.y + size.y * size.z + size.z * size.x
}
