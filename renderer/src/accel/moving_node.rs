//! Nodes whose boxes move with what is in them.

use glam::{DVec3, Vec3};
use wide::{f32x8, f32x16, f64x8};

use super::node::{Boxes, Child, WIDTH};
use crate::math::bounds::Bounds;
use crate::math::eight::{rounded, widened};

/// A box at the start and one at the end of a segment of the shutter; in between it is interpolated.
pub(super) type Pair = [Bounds; 2];

/// Equal segments of the shutter.
#[derive(Debug)]
pub(super) struct Segments {
    /// When the first begins, how many of them pass in a unit of time, and the index of the last.
    pub(super) open: f64,
    pub(super) rate: f64,
    pub(super) last: f64,
}

/// Up to eight moving boxes as they lie in memory, in eights: the sides as in a node at rest at the start, how far they move until
/// the end, the children's bits, and nothing.
pub(super) type MovingNode = [f32x16; 7];

/// A moving box: its lower and upper sides at the start, and how far they move until the end.
#[derive(Debug, Clone, Copy)]
pub(super) struct MovingBounds {
    sides: [Vec3; 2],
    change: [Vec3; 2],
}

impl Boxes for MovingNode {
    type Bounds = MovingBounds;
    type Clock = Segments;

    #[inline]
    fn place(segments: &Segments, time: f32) -> (usize, f32) {
        let place = (f64::from(time) - segments.open) * segments.rate;
        #[expect(clippy::cast_possible_truncation, reason = "clamped to the segments")]
        let index = place.max(0.0).min(segments.last) as i32;
        #[expect(clippy::cast_possible_truncation, reason = "boxes are grown by its rounding")]
        let through = (place - f64::from(index)).clamp(0.0, 1.0) as f32;
        #[expect(clippy::cast_sign_loss, reason = "not below 0")]
        let index = index as usize;
        (index, through)
    }

    #[inline]
    fn through(segments: &Segments, tree: usize, times: f32x8) -> f32x8 {
        let place = (widened(times) - f64x8::splat(segments.open)) * f64x8::splat(segments.rate);
        rounded(place - f64x8::splat(tree as f64))
    }

    #[inline]
    fn children(&self) -> &[u32; WIDTH] {
        let eights: &[[u32; WIDTH]; 14] = bytemuck::cast_ref(self);
        &eights[12]
    }

    #[inline]
    fn sides(&self, axis: usize, which: usize, through: f32) -> f32x8 {
        let eights: &[f32x8; 14] = bytemuck::cast_ref(self);
        eights[6 + 2 * axis + which].mul_add(f32x8::splat(through), eights[2 * axis + which])
    }

    #[inline]
    fn farthest_sides(&self, axis: usize, which: usize, through: [f32; 2]) -> f32x8 {
        let [first, last] = through.map(|through| self.sides(axis, which, through));
        if which == 0 { first.fast_min(last) } else { first.fast_max(last) }
    }

    #[inline]
    fn side(&self, slot: usize, axis: usize, which: usize, through: f32x8) -> f32x8 {
        let eights: &[[f32; WIDTH]; 14] = bytemuck::cast_ref(self);
        let [side, change] = [0, 6].map(|first| f32x8::splat(eights[first + 2 * axis + which][slot]));
        change.mul_add(through, side)
    }

    #[inline]
    fn side_of(bounds: &MovingBounds, axis: usize, which: usize, through: f32x8) -> f32x8 {
        let [side, change] = [bounds.sides, bounds.change].map(|sides| f32x8::splat(sides[which][axis]));
        change.mul_add(through, side)
    }
}

impl MovingBounds {
    pub(super) fn new(pair: &Pair) -> Self {
        let [start, end] = padded(pair);
        Self { sides: start, change: [end[0] - start[0], end[1] - start[1]] }
    }
}

/// The node over children with their boxes, at most eight of them.
pub(super) fn moving_node(list: &[(Pair, Child)]) -> MovingNode {
    // As in `Node::new`.
    let (mut sides, mut change) = ([[[f32::INFINITY; WIDTH]; 2]; 3], [[[0.0; WIDTH]; 2]; 3]);
    let mut children = [Child::NONE; WIDTH];
    for (slot, (pair, child)) in list.iter().enumerate() {
        let bounds = MovingBounds::new(pair);
        for axis in 0..3 {
            for side in 0..2 {
                sides[axis][side][slot] = bounds.sides[side][axis];
                change[axis][side][slot] = bounds.change[side][axis];
            }
        }
        children[slot] = *child;
    }
    let mut memory = [[0.0; WIDTH]; 14];
    memory[..6].copy_from_slice(sides.as_flattened());
    memory[6..12].copy_from_slice(change.as_flattened());
    memory[12] = children.map(|child| f32::from_bits(child.bits()));
    bytemuck::cast(memory)
}

/// The boxes in f32, grown for what their interpolation rounds. Larger boxes would be met by the rays that leave what is in them.
fn padded(pair: &Pair) -> [[Vec3; 2]; 2] {
    pair.each_ref().map(|bounds| bounds.grown(margin(pair)).to_f32_outward())
}

/// What the interpolation of sides may round: their change, its share by a place in time that is itself rounded (2⁻²⁵ at most), and the
/// sum.
fn margin([start, end]: &Pair) -> DVec3 {
    let change = (end.min - start.min).abs().max((end.max - start.max).abs());
    let largest = farthest(start).max(farthest(end));
    half_ulp(change) + change * 2f64.powi(-25) + half_ulp(largest)
}

/// The largest coordinate along each axis.
pub(super) fn farthest(bounds: &Bounds) -> DVec3 {
    bounds.min.abs().max(bounds.max.abs())
}

/// Half a unit in the last place of f32 numbers up to this size and a little more.
pub(super) fn half_ulp(size: DVec3) -> DVec3 {
    let largest = (size * (1.0 + 2f64.powi(-20))).as_vec3();
    largest.map(|x| 0.5 * (x.next_up() - x)).as_dvec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::warp::point;

    /// Two boxes of one size, 0.1 to 1.1 along each axis, within 20 of the origin and 3 of one another.
    fn boxes(n: u32) -> Pair {
        let at = |k: u32| point(4 * n + k).as_dvec3();
        let (place, size) = (20.0 * at(0), at(1).abs() + 0.1);
        [place, place + 3.0 * at(2)].map(|min| Bounds { min, max: min + size })
    }

    fn time(n: u32) -> f32 {
        point(4 * n + 3).x.abs()
    }

    #[test]
    fn moving_sides_lie_outside_of_their_boxes_by_no_more_than_rounding_calls_for() {
        let clock = Segments { open: 0.0, rate: 4.0, last: 3.0 };
        // How far outside, in units of what rounding may take away.
        let (mut least, mut most) = (f64::INFINITY, 0.0f64);
        for n in 0..100_000 {
            let pair = boxes(n);
            let [start, end] = &pair;
            let (moving, margin) = (MovingBounds::new(&pair), margin(&pair));
            let (segment, through) = MovingNode::place(&clock, time(n));
            let share = 4.0 * f64::from(time(n)) - segment as f64;
            let exact = [start.min.lerp(end.min, share), start.max.lerp(end.max, share)];
            for (which, outward) in [-1.0, 1.0].into_iter().enumerate() {
                for axis in 0..3 {
                    let side = MovingNode::side_of(&moving, axis, which, f32x8::splat(through)).as_array()[0];
                    let slack = outward * (f64::from(side) - exact[which][axis]) / margin[axis];
                    (least, most) = (least.min(slack), most.max(slack));
                }
            }
        }
        // With half of the margin some would lie inside. At most it is all there, once more by what it was for, and the sides'
        // own rounding outwards, of two half units.
        assert!((0.0..0.5).contains(&least) && most <= 4.0, "{least} {most}");
    }
}
