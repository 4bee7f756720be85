//! The elements of shapes, as trees take them.

use glam::Vec3;
use rayon::prelude::*;

use super::collapse::SHARED_FROM;
use super::node::Bounds32;
use crate::shapes::Shape;

/// What a leaf of a tree holds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Item {
    /// Padded, as hits on edges ask for.
    pub(super) bounds: Bounds32,
    /// Corners of a triangle at rest in the tree's space.
    pub(super) triangle: Option<[Vec3; 3]>,
    /// Object and element.
    pub(super) id: [u32; 2],
}

/// Adds the elements of a shape with their boxes.
pub(super) fn add_elements(list: &mut Vec<Item>, object: u32, shape: &Shape) {
    let item = |element| {
        let triangle = match shape {
            Shape::Mesh(mesh) => Some(mesh.vertices(element)),
            _ => None,
        };
        Item { bounds: Bounds32::padded(&shape.element_bounds(element)), triangle, id: [object, element] }
    };
    let elements = 0..shape.element_count();
    if elements.len() < SHARED_FROM {
        list.extend(elements.map(item));
    } else {
        list.par_extend(elements.into_par_iter().map(item));
    }
}
