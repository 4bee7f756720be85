//! The elements of shapes, as trees take them.

use glam::Vec3;
use obvhs::aabb::Aabb;
use rayon::prelude::*;

use super::collapse::SHARED_FROM;
use super::node::Bounds32;
use crate::math::bounds::Bounds;
use crate::shapes::Shape;

/// What the leaves of a tree hold, by item.
#[derive(Debug, Default)]
pub(super) struct Items {
    /// Padded, as hits on edges ask for.
    pub(super) boxes: Vec<Aabb>,
    /// Corners of triangles at rest in the tree's space.
    pub(super) triangles: Vec<Option<[Vec3; 3]>>,
    /// Object and element.
    pub(super) ids: Vec<[u32; 2]>,
}

impl Items {
    /// Adds what isn't a triangle.
    pub(super) fn add(&mut self, bounds: &Bounds, id: [u32; 2]) {
        self.boxes.push(padded(bounds));
        self.triangles.push(None);
        self.ids.push(id);
    }

    /// Adds the elements of a shape with their boxes.
    pub(super) fn add_elements(&mut self, object: u32, shape: &Shape) {
        let bounds = |element| padded(&shape.element_bounds(element));
        let triangle = |element| match shape {
            Shape::Mesh(mesh) => Some(mesh.vertices(element)),
            _ => None,
        };
        let elements = 0..shape.element_count();
        if elements.len() < SHARED_FROM {
            self.boxes.extend(elements.clone().map(bounds));
            self.triangles.extend(elements.clone().map(triangle));
        } else {
            self.boxes.par_extend(elements.clone().into_par_iter().map(bounds));
            self.triangles.par_extend(elements.clone().into_par_iter().map(triangle));
        }
        self.ids.extend(elements.map(|element| [object, element]));
    }
}

fn padded(bounds: &Bounds) -> Aabb {
    let Bounds32 { min, max } = Bounds32::padded(bounds);
    Aabb::new(min.into(), max.into())
}
