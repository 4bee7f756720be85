//! Trees over moving objects whose boxes move with them.

use std::time::Duration;

use glam::DVec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use wide::f32x16;

use super::collapse::{WideTree, collapse};
use super::few::{Few, LEAVES, Leaf};
use super::group::{BUILD, Context, Group, comes_before};
use super::memory::Array;
use super::moving_node::{MovingBounds, MovingNode, Pair, Segments, farthest, half_ulp, moving_node};
use super::node::{Child, WIDTH};
use super::object::Object;
use crate::math::bounds::Bounds;
use crate::ray::{Hit, Ray};
use crate::shapes::Shape;

/// Trees over moving objects, one for each of a number of equal segments of the shutter.
#[derive(Debug)]
pub(super) struct MovingTrees {
    group: Group<MovingNode>,
    /// Half the surface areas of all boxes, averaged over the shutter: what a random ray meets is proportional to it.
    area: f64,
}

impl MovingTrees {
    /// The trees over the objects listed, with the shutter cut into `segments`.
    pub(super) fn new(objects: &[Object], listed: &[u32], shutter: [f64; 2], segments: u32) -> Self {
        Self::with(objects, listed, &roundings(objects, listed, shutter), shutter, segments)
    }

    /// The same with the `roundings` of the objects listed.
    fn with(
        objects: &[Object],
        listed: &[u32],
        roundings: &[DVec3],
        shutter: [f64; 2],
        segments: u32,
    ) -> Self {
        let mut forest = Forest::default();
        for span in cuts(shutter, segments).windows(2) {
            let grown = |(&o, margin): (&u32, &DVec3)| {
                pair(&objects[o as usize], [span[0], span[1]]).map(|bounds| bounds.grown(*margin))
            };
            forest.plant(&listed.iter().zip(roundings).map(grown).collect::<Vec<_>>());
        }
        let Forest { roots, nodes, few, order, depth, area } = forest;
        let group = Group {
            clock: Segments {
                open: shutter[0],
                rate: f64::from(segments) / (shutter[1] - shutter[0]),
                last: roots.len() as f64 - 1.0,
            },
            roots,
            nodes: Array::new(nodes.len(), |index| nodes[index]),
            blocks: Array::Small(Vec::new()),
            ids: Array::new(order.len(), |leaf| [listed[order[leaf] as usize], 0]),
            few,
            stack: 7 * depth + WIDTH,
            is_inner: false,
        };
        Self { group, area: area / f64::from(segments) }
    }

    /// The trees with the fewest segments, a power of two, of which twice as many would not help much.
    pub(super) fn chosen(objects: &[Object], listed: &[u32], shutter: [f64; 2]) -> Self {
        let roundings = roundings(objects, listed, shutter);
        let mut best = Self::with(objects, listed, &roundings, shutter, 1);
        let mut count = 2;
        while count <= MOST_SEGMENTS {
            let next = Self::with(objects, listed, &roundings, shutter, count);
            if next.area * SEGMENT_GAIN > best.area {
                break;
            }
            best = next;
            count *= 2;
        }
        best
    }

    /// Makes each hit the first of it and those on moving objects.
    pub(super) fn closest(&self, rays: &[Ray], context: &mut Context, hits: &mut [Option<Hit>]) {
        let shortened: Vec<Ray> = if hits.iter().all(Option::is_none) {
            Vec::new()
        } else {
            let reach = |(ray, hit): (&Ray, &Option<Hit>)| hit.map_or(ray.t_max, |hit| hit.t.next_up());
            rays.iter().zip(&*hits).map(|of| Ray { t_max: reach(of), ..*of.0 }).collect()
        };
        let rays = if shortened.is_empty() { rays } else { &shortened };
        self.group.closest(rays, context, |i, found| {
            let best = &mut hits[i];
            if let Some(hit) = found
                && best.is_none_or(|best| comes_before(&hit, &best))
            {
                *best = found;
            }
        });
    }

    /// Notes each ray that hits a moving object.
    pub(super) fn occluded(&self, rays: &[Ray], context: &mut Context, blocked: &mut [bool]) {
        if !blocked.contains(&true) {
            return self.group.occluded(rays, context, |i, found| blocked[i] = found);
        }
        let open: Vec<usize> = (0..rays.len()).filter(|&i| !blocked[i]).collect();
        let rays: Vec<Ray> = open.iter().map(|&i| rays[i]).collect();
        self.group.occluded(&rays, context, |i, found| blocked[open[i]] = found);
    }

    /// Writes the indices of rays of these times, in the order of their segments but for rounding.
    pub(super) fn order(&self, times: impl Iterator<Item = f32> + Clone, order: &mut Vec<u32>) {
        let Segments { open, rate, last } = &self.group.clock;
        #[expect(clippy::cast_possible_truncation, reason = "the order is a matter of speed")]
        let (open, rate, last) = (*open as f32, *rate as f32, *last as f32);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the segments"
        )]
        let segment = |time: f32| ((time - open) * rate).max(0.0).min(last) as u32 as usize;
        let mut ends = vec![0; self.group.roots.len()];
        times.clone().for_each(|time| ends[segment(time)] += 1);
        let mut end = 0;
        for count in &mut ends {
            end += std::mem::replace(count, end);
        }
        order.resize(end, 0);
        for (i, time) in (0..).zip(times) {
            let place = &mut ends[segment(time)];
            order[*place] = i;
            *place += 1;
        }
    }

    /// Number of boxes that the ray meets before `reach`: around nodes, and around leaves.
    pub(super) fn boxes_met(&self, ray: &Ray, reach: f32) -> [u64; 2] {
        self.group.boxes_met(ray, reach)
    }
}

/// Trees of several segments, one after the other.
#[derive(Debug, Default)]
struct Forest {
    roots: Vec<Child>,
    nodes: Vec<MovingNode>,
    few: Vec<Few<MovingNode>>,
    /// The item in each leaf.
    order: Vec<u32>,
    depth: usize,
    /// Half the surface areas of the boxes, averaged over their segments.
    area: f64,
}

impl Forest {
    /// Adds the tree over items with these boxes.
    fn plant(&mut self, pairs: &[Pair]) {
        let middle = |[a, b]: &Pair| Bounds { min: (a.min + b.min) * 0.5, max: (a.max + b.max) * 0.5 };
        let boxes: Vec<Aabb> = pairs.iter().map(|pair| aabb(&middle(pair))).collect();
        let binary = build_bvh2(&boxes, BUILD, &mut Duration::default());
        // Each item has a leaf of its own.
        let wide = collapse(&binary, &[]);
        let first = [self.nodes.len(), self.order.len()];
        self.nodes.resize(first[0] + wide.nodes.len(), [f32x16::ZERO; 7]);
        self.order.extend(&wide.order);
        self.depth = self.depth.max(wide.depth);
        self.bound(&wide, pairs, wide.root, first);
        self.roots.push(wide.root.shifted(first[0], first[1]));
        if pairs.len() <= LEAVES {
            let leaf = |(leaf, &item): (usize, &u32)| {
                let index = first[1] + leaf;
                (MovingBounds::new(&pairs[item as usize]), Leaf { index, first: index, has_triangles: false })
            };
            self.few.push(Few(wide.order.iter().enumerate().map(leaf).collect()));
        }
    }

    /// Writes the boxes below a child of a tree whose nodes and leaves begin at `first`; returns the one around it.
    fn bound(&mut self, wide: &WideTree, pairs: &[Pair], child: Child, first: [usize; 2]) -> Pair {
        if let Some(leaf) = child.leaf() {
            return pairs[wide.order[leaf] as usize];
        }
        let children = wide.nodes[child.node()].children().iter().filter(|c| **c != Child::NONE);
        let mut below = |&c: &Child| (self.bound(wide, pairs, c, first), c.shifted(first[0], first[1]));
        let list: Vec<(Pair, Child)> = children.map(&mut below).collect();
        self.nodes[first[0] + child.node()] = moving_node(&list);
        self.area += list.iter().map(|(pair, _)| mean_half_area(pair)).sum::<f64>();
        let around = |end: usize| list.iter().fold(Bounds::EMPTY, |all, (pair, _)| all.union(&pair[end]));
        [around(0), around(1)]
    }
}

/// The `rounding` of each of the objects listed; rays begin on any of the objects.
fn roundings(objects: &[Object], listed: &[u32], shutter: [f64; 2]) -> Vec<DVec3> {
    let far = farthest(&objects.iter().fold(Bounds::EMPTY, |all, object| all.union(&object.bounds(shutter))));
    listed.iter().map(|&o| rounding(&objects[o as usize], shutter, far)).collect()
}

/// By how much a ray may pass an object's own box and yet hit the object. In the object's space it is rounded to f64, and to f32 for
/// triangles: where it begins if the object only shifts, else both ways and its direction (16 half units are enough for stretches by up
/// to 4 besides). Hits on triangles are rounded, too (2⁻²¹ of the size, as for boxes at rest).
///
/// * `far`: how far from the origin of the render frame rays begin along each axis.
fn rounding(object: &Object, shutter: [f64; 2], far: DVec3) -> DVec3 {
    let (own, swept) = (object.shape.bounds(), object.bounds(shutter));
    let far = far + (swept.min - own.min).abs().max((swept.max - own.max).abs());
    if !matches!(object.shape, Shape::Mesh(_)) {
        return DVec3::splat(far.max_element() * 2f64.powi(-44));
    }
    let shifts = object.motion.as_ref().is_some_and(|motion| motion.offset(shutter[0]).is_some());
    let of_rays = if shifts { half_ulp(far) } else { DVec3::splat(16.0 * half_ulp(far).max_element()) };
    of_rays + (swept.max - swept.min).max_element() * 2f64.powi(-21)
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
    motion.swept(&own, shutter).half_area() <= SWEPT_AREA * mean_area(object, shutter)
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
    (a.half_area() + 4.0 * middle.half_area() + b.half_area()) / 6.0
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::accel::node::Boxes;
    use crate::math::transform::Motion;
    use crate::sampling::warp::point;
    use crate::shapes::ShapeSettings;

    fn time(n: u32) -> f32 {
        point(4 * n + 3).x.abs()
    }

    #[test]
    fn rays_are_put_in_the_order_of_segments_and_else_stay_in_theirs() {
        let shift = |n: u32| {
            let at = |k: u32| DAffine3::from_translation(20.0 * point(2 * n + k).as_dvec3());
            let shape = Shape::new(&ShapeSettings::Cube, &DAffine3::IDENTITY, false).unwrap();
            Object::moving(shape, Motion::keyed(vec![(0.0, at(0)), (1.0, at(1))]).unwrap())
        };
        let objects: Vec<Object> = (0..5).map(shift).collect();
        let trees = MovingTrees::new(&objects, &[0, 1, 2, 3, 4], [0.0, 1.0], 4);
        let (mut order, mut sorted) = (Vec::new(), (0..1000).collect::<Vec<u32>>());
        trees.order((0..1000).map(time), &mut order);
        sorted.sort_by_key(|&n| MovingNode::place(&trees.group.clock, time(n)).0);
        assert_eq!(order, sorted);
        assert_ne!(order, (0..1000).collect::<Vec<_>>());
    }
}
