//! A binary tree of boxes, and how a ray walks it.

use std::ops::Range;
use std::time::Duration;

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;

use crate::math::bounds::Bounds;
use crate::ray::Ray;

/// A bounding-volume hierarchy over items that are laid out in its leaves' order.
#[derive(Debug)]
pub(super) struct Tree {
    nodes: Vec<Bvh2Node>,
}

/// Three roundings within 2⁻²⁴, on each side of a comparison: 1 + 2·3·2⁻²⁴, rounded up.
///
/// # Source
/// Ize 2013, Robust BVH Ray Traversal, JCGT 2(2).
const SLACK: f32 = 1.0 + 4.0 * f32::EPSILON;

impl Tree {
    /// Builds the tree; also returns the order of the boxes in its leaves.
    pub(super) fn new(boxes: &[Bounds]) -> (Self, Vec<u32>) {
        if boxes.is_empty() {
            return (Self { nodes: Vec::new() }, Vec::new());
        }
        let boxes: Vec<Aabb> = boxes.iter().map(padded).collect();
        let tree = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
        (Self { nodes: tree.nodes }, tree.primitive_indices)
    }

    /// Calls `leaf` with the items of each leaf that the ray may meet before `t_max`, near ones first as a rule.
    ///
    /// `leaf` returns the distance beyond which nothing matters any more, or `None` to end the walk. `stack` is memory
    /// to use; what is in it stays.
    #[inline]
    pub(super) fn walk(
        &self,
        ray: &Ray,
        stack: &mut Vec<(u32, f32)>,
        mut leaf: impl FnMut(Range<usize>) -> Option<f32>,
    ) {
        let slab = Slab::new(ray);
        let mut limit = ray.t_max * SLACK;
        let Some(root) = self.nodes.first() else { return };
        if slab.enter(root) == f32::INFINITY {
            return;
        }
        let base = stack.len();
        let mut node = root;
        loop {
            if node.is_leaf() {
                match leaf(items(node)) {
                    Some(t_max) => limit = t_max * SLACK,
                    None => break,
                }
            } else {
                let first = node.first_index;
                let [a, b] = [&self.nodes[first as usize], &self.nodes[first as usize + 1]];
                let (near_a, near_b) = (slab.enter(a), slab.enter(b));
                let a_first = near_a <= near_b;
                let (near, far) = if a_first { (near_a, near_b) } else { (near_b, near_a) };
                if near < limit {
                    if far < limit {
                        stack.push((first + u32::from(a_first), far));
                    }
                    node = if a_first { a } else { b };
                    continue;
                }
            }
            // What was pushed may have become too far.
            let next = loop {
                if stack.len() == base {
                    return;
                }
                match stack.pop() {
                    Some((index, near)) if near < limit => break index,
                    _ => {}
                }
            };
            node = &self.nodes[next as usize];
        }
        stack.truncate(base);
    }
}

fn items(node: &Bvh2Node) -> Range<usize> {
    let first = node.first_index as usize;
    first..first + node.prim_count as usize
}

/// The box in f32, rounded outwards and grown by 2⁻²¹ of its size: a hit on a triangle's edge may lie outside the
/// triangle by the 2⁻²⁴ of twice its size to which sheared vertices are rounded.
fn padded(bounds: &Bounds) -> Aabb {
    let margin = (bounds.max - bounds.min).max_element() * 2f64.powi(-21);
    let [min, max] = bounds.grown(glam::DVec3::splat(margin)).to_f32_outward();
    Aabb::new(min.into(), max.into())
}

/// A ray prepared for boxes.
struct Slab {
    origin: Vec3A,
    inverse: Vec3A,
}

impl Slab {
    fn new(ray: &Ray) -> Self {
        // A finite inverse keeps 0 · ∞ out of `enter` where the origin lies in a side's plane.
        let inverse = ray.direction.recip().clamp(glam::Vec3::MIN, glam::Vec3::MAX);
        Self { origin: ray.origin.into(), inverse: inverse.into() }
    }

    /// The distance at which the ray enters the box, 0 from inside; infinite for a miss.
    #[inline]
    fn enter(&self, node: &Bvh2Node) -> f32 {
        let bounds = node.aabb();
        let t1 = (bounds.min - self.origin) * self.inverse;
        let t2 = (bounds.max - self.origin) * self.inverse;
        let near = t1.min(t2).max_element().max(0.0);
        let far = t1.max(t2).min_element() * SLACK;
        if near <= far { near } else { f32::INFINITY }
    }
}
