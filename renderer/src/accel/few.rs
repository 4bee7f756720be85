//! Trees of few leaves, walked by eight rays at once that may go any way: every leaf's box is tried against all of them.

use wide::f32x8;

use super::group::Context;
use super::node::{Boxes, inverses, lanes_of, limit_eight, met};
use super::walk::{Found, Mode, Search, Tree};
use crate::ray::{EightRays, Ray};

/// Rays walked at once.
pub(super) const RAYS: usize = 8;

/// Leaves up to which a tree is walked like this; measured in benches/README.md.
pub(super) const LEAVES: usize = 64;

/// A leaf of a tree.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf {
    pub(super) index: usize,
    /// Index of its first item, which is the only one if that isn't a triangle.
    pub(super) first: usize,
    pub(super) has_triangles: bool,
}

/// The leaves of a small tree with their boxes, in the order of visits.
#[derive(Debug)]
pub(super) struct Few<N: Boxes>(pub(super) Vec<(N::Bounds, Leaf)>);

impl<N: Boxes> Few<N> {
    /// Walks one to eight rays, so far `through` the tree's span of time, and puts what they find into `searches`. Each visits the leaves
    /// that hold what it hits, as it does alone, so it finds the same.
    #[inline]
    pub(super) fn walk<M: Mode>(
        &self,
        tree: &Tree<N>,
        rays: &[Ray],
        through: f32x8,
        searches: &mut [Search; RAYS],
        context: &mut Context,
    ) {
        let mut lanes = Lanes::new(rays, through);
        for (search, ray) in searches.iter_mut().zip(rays) {
            search.restart(ray);
        }
        let mut walking = 0xff >> (RAYS - rays.len());
        for (bounds, leaf) in &self.0 {
            let mut met = lanes.meet::<N>(bounds) & walking;
            if met == 0 {
                continue;
            }
            let hits = if leaf.has_triangles {
                None
            } else {
                tree.group.other_eight(leaf.first, &lanes.rays, context)
            };
            if let Some(hits) = &hits {
                met &= hits.lanes;
            }
            for lane in lanes_of::<RAYS>(met) {
                let search = &mut searches[lane];
                match &hits {
                    Some(hits) => {
                        search.accept::<M>(tree.group, Found::Item(leaf.first, hits.get(lane)));
                    }
                    None => search.leaf::<M>(tree, leaf.index, context),
                }
                lanes.rays.t_max.as_mut_array()[lane] = search.reach();
                if M::ANY && search.is_blocked() {
                    walking &= !(1 << lane);
                }
            }
            if walking == 0 {
                break;
            }
        }
    }
}

/// Eight rays prepared for boxes and for shapes.
struct Lanes {
    rays: EightRays,
    origin: [f32x8; 3],
    inverse: [f32x8; 3],
    /// How far through their tree's span of time.
    through: f32x8,
}

impl Lanes {
    /// Up to eight rays; what the other lanes hold doesn't matter.
    #[inline]
    fn new(rays: &[Ray], through: f32x8) -> Self {
        let rays = EightRays::new(rays);
        Self { rays: rays.widened(), origin: rays.origin.0, inverse: inverses(rays.direction).0, through }
    }

    /// Which rays meet a box before their `t_max`, as bits: none that hits what is in it is left out, by the reckoning of `SLACK`.
    #[inline]
    fn meet<N: Boxes>(&self, bounds: &N::Bounds) -> u32 {
        let distance = |axis: usize, which: usize| {
            (N::side_of(bounds, axis, which, self.through) - self.origin[axis]) * self.inverse[axis]
        };
        met(|axis| [distance(axis, 0), distance(axis, 1)], limit_eight(self.rays.t_max)).bits()
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3, Vec3};

    use crate::accel::Object;
    use crate::accel::group::{Context, Group};
    use crate::accel::walk::{Any, Closest};
    use crate::math::transform::Motion;
    use crate::ray::Ray;
    use crate::sampling::warp::point;
    use crate::shapes::{Shape, ShapeSettings};

    /// Shapes of every kind on top of each other, one of them twice, and one that moves a little.
    fn objects() -> Vec<Object> {
        let place = |n: u32| DAffine3::from_translation(point(n).as_dvec3() * 2.0);
        let turned = |n: u32| place(n) * DAffine3::from_rotation_x(f64::from(n));
        let shape = |settings: &ShapeSettings, map| Object::still(Shape::new(settings, &map, false).unwrap());
        let sphere = ShapeSettings::Sphere { center: DVec3::X, radius: 0.5 };
        let cylinder = ShapeSettings::Cylinder { p0: DVec3::ZERO, p1: DVec3::Z, radius: 0.4 };
        let still = (0..5).flat_map(|n| {
            [
                shape(&ShapeSettings::Rectangle, turned(n)),
                shape(&ShapeSettings::Rectangle, turned(n)),
                shape(&ShapeSettings::Disk, turned(n + 10)),
                shape(&sphere, place(n + 20)),
                shape(&cylinder, turned(n + 30)),
                shape(&ShapeSettings::Cube, turned(n + 40)),
            ]
        });
        let step = DAffine3::from_translation(DVec3::Y * 0.1);
        let motion = Motion::keyed(vec![(0.0, DAffine3::IDENTITY), (1.0, step)]).unwrap();
        let moving = Object::moving(Shape::new(&sphere, &DAffine3::IDENTITY, false).unwrap(), motion);
        still.chain([moving]).collect()
    }

    /// Rays from everywhere, from within planes, along axes, and segments.
    fn rays() -> Vec<Ray> {
        let ray = |n: u32| {
            let (from, way) = (point(3 * n) * (0.5 + (n % 7) as f32), point(5 * n + 1));
            match n % 5 {
                0 => Ray::new(from, Vec3::AXES[n as usize % 3], 0.5),
                1 => Ray { t_max: 3.0, ..Ray::new(from, way, 0.5) },
                2 => Ray::new(Vec3::ZERO, way, 0.5),
                _ => Ray::new(from, way, 0.5),
            }
        };
        (0..20_000).map(ray).collect()
    }

    #[test]
    fn rays_walked_together_find_what_each_finds_alone() {
        let (objects, rays) = (objects(), rays());
        let swept: Vec<_> = objects.iter().map(|o| o.motion.as_ref().map(|_| o.bounds([0.0, 1.0]))).collect();
        let group = Group::of_scene(&objects, &swept);
        assert_eq!(group.few.len(), 1);
        let inner: Vec<_> = objects.iter().map(|_| None).collect();
        let context = &mut Context::new(&objects, &inner);
        // All, and numbers that aren't multiples of eight.
        for count in [0, 1, 7, 9, rays.len()] {
            let rays = &rays[..count];
            let (mut alone, mut together) = (vec![None; count], vec![None; count]);
            group.walk_each::<Closest>(rays, context, |i, found| alone[i] = found.hit(&group));
            group.walk_few::<Closest>(rays, context, |i, found| together[i] = found.hit(&group));
            assert_eq!(alone, together);
            let (mut each, mut few_at_once) = (vec![false; count], vec![false; count]);
            group.walk_each::<Any>(rays, context, |i, found| each[i] = found.is_blocked());
            group.walk_few::<Any>(rays, context, |i, found| few_at_once[i] = found.is_blocked());
            assert_eq!(each, few_at_once);
            assert!(each.iter().zip(&alone).all(|(any, hit)| *any == hit.is_some()));
            let met = |object: usize| alone.iter().flatten().any(|hit| hit.object as usize == object);
            let second = |object: usize| object < 30 && object % 6 == 1;
            assert!(count < 10_000 || (0..objects.len()).all(|object| met(object) != second(object)));
        }
    }
}
