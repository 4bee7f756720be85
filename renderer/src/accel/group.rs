//! Elements of objects in the order of a tree's leaves, and the queries over them.

use glam::Vec3;

use super::object::Object;
use super::tree::Tree;
use crate::math::bounds::Bounds;
use crate::ray::{Hit, Ray};
use crate::shapes::triangle::ShearedRay;
use crate::shapes::{Shape, ShapeHit};

/// What a leaf of a tree holds.
#[derive(Debug, Clone, Copy)]
enum Item {
    /// A triangle at rest in the tree's space.
    Triangle([Vec3; 3]),
    /// The only element of an object whose shape isn't a mesh.
    Whole,
    /// An object in motion: the ray goes over into its space.
    Moving,
}

/// Items with their tree, in one space.
#[derive(Debug)]
pub(super) struct Group {
    tree: Tree,
    items: Vec<Item>,
    /// Object and element of each item; read for hits and for what isn't a triangle.
    ids: Vec<[u32; 2]>,
}

/// What the queries need besides the group: the objects, the groups of the moving ones, and memory to use.
pub(super) struct Context<'a> {
    pub(super) objects: &'a [Object],
    pub(super) inner: &'a [Option<Group>],
    pub(super) stack: Vec<(u32, f32)>,
}

impl Group {
    /// The tree over a whole scene: elements of objects at rest, and swept boxes of moving objects.
    pub(super) fn of_scene(objects: &[Object], shutter: [f64; 2]) -> Self {
        let mut list = Vec::new();
        for (index, object) in (0u32..).zip(objects) {
            match object.motion {
                Some(_) => list.push((object.bounds(shutter), Item::Moving, [index, 0])),
                None => list.extend(elements(index, &object.shape)),
            }
        }
        Self::new(&list)
    }

    /// The tree over one object's elements in its own space.
    pub(super) fn of_shape(index: u32, shape: &Shape) -> Self {
        Self::new(&elements(index, shape).collect::<Vec<_>>())
    }

    fn new(list: &[(Bounds, Item, [u32; 2])]) -> Self {
        let boxes: Vec<Bounds> = list.iter().map(|(b, ..)| *b).collect();
        let (tree, order) = Tree::new(&boxes);
        let items = order.iter().map(|&i| list[i as usize].1).collect();
        let ids = order.iter().map(|&i| list[i as usize].2).collect();
        Self { tree, items, ids }
    }

    /// The nearest hit.
    pub(super) fn closest(&self, ray: &Ray, context: &mut Context) -> Option<Hit> {
        let mut best = None;
        self.search(ray, context, |hit| {
            best = Some(hit);
            Some(hit.t)
        });
        best
    }

    /// Whether anything is hit.
    pub(super) fn occluded(&self, ray: &Ray, context: &mut Context) -> bool {
        let mut any = false;
        self.search(ray, context, |_| {
            any = true;
            None
        });
        any
    }

    /// Calls `found` with each hit nearer than the ones before; it returns how far to search on, or `None` to stop.
    #[inline]
    fn search(&self, ray: &Ray, context: &mut Context, mut found: impl FnMut(Hit) -> Option<f32>) {
        let sheared = ShearedRay::new(ray);
        let mut ray = *ray;
        let mut stack = std::mem::take(&mut context.stack);
        self.tree.walk(&ray.clone(), &mut stack, |range| {
            for index in range {
                let hit = match &self.items[index] {
                    Item::Triangle(vertices) => sheared.hit(vertices, ray.t_max).map(|h| self.hit(index, h)),
                    Item::Whole => self.whole(index, &ray, context),
                    Item::Moving => self.moving(index, &ray, context),
                };
                if let Some(hit) = hit {
                    ray.t_max = found(hit)?;
                }
            }
            Some(ray.t_max)
        });
        context.stack = stack;
    }

    fn hit(&self, index: usize, hit: ShapeHit) -> Hit {
        let [object, element] = self.ids[index];
        Hit { t: hit.t, object, element, uv: hit.uv }
    }

    fn whole(&self, index: usize, ray: &Ray, context: &Context) -> Option<Hit> {
        let [object, element] = self.ids[index];
        let hit = context.objects[object as usize].shape.intersect(element, ray)?;
        Some(self.hit(index, hit))
    }

    fn moving(&self, index: usize, ray: &Ray, context: &mut Context) -> Option<Hit> {
        let object = self.ids[index][0] as usize;
        let inner = context.inner[object].as_ref()?;
        inner.closest(&context.objects[object].to_object(ray), context)
    }
}

/// The elements of a shape with their boxes.
fn elements(object: u32, shape: &Shape) -> impl Iterator<Item = (Bounds, Item, [u32; 2])> + '_ {
    (0..shape.element_count()).map(move |element| {
        let item = match shape {
            Shape::Mesh(mesh) => Item::Triangle(mesh.vertices(element)),
            _ => Item::Whole,
        };
        (shape.element_bounds(element), item, [object, element])
    })
}
