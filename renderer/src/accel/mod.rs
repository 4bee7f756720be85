//! Rank 4: where rays meet the objects of a scene, for slices of rays.

mod object;

pub use object::Object;

use crate::interaction::Interaction;
use crate::ray::{Hit, Ray};
use crate::shapes::ShapeHit;

/// The objects of a scene, found by rays.
#[derive(Debug)]
pub struct Accel {
    objects: Vec<Object>,
    shutter: [f64; 2],
}

impl Accel {
    /// Builds the tree over `objects` as they are between `shutter[0]` and `shutter[1]`; rays have times in between.
    pub fn new(objects: Vec<Object>, shutter: [f64; 2]) -> Self {
        Self { objects, shutter }
    }

    /// The objects, in the order given.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The nearest hit of each ray, written over `hits`.
    pub fn closest(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.extend(rays.iter().map(|r| self.closest_of(r)));
    }

    /// Whether anything lies on each ray's segment, written over `out`.
    pub fn occluded(&self, rays: &[Ray], out: &mut Vec<bool>) {
        out.clear();
        out.extend(rays.iter().map(|r| self.closest_of(r).is_some()));
    }

    fn closest_of(&self, ray: &Ray) -> Option<Hit> {
        let mut ray = *ray;
        let mut best = None;
        for (object, o) in (0u32..).zip(&self.objects) {
            let local = o.to_object(&ray);
            for element in 0..o.shape.element_count() {
                let query = Ray { t_max: ray.t_max, ..local };
                if let Some(h) = o.shape.intersect(element, &query) {
                    ray.t_max = h.t;
                    best = Some(Hit { t: h.t, object, element, uv: h.uv });
                }
            }
        }
        best
    }

    /// The surface at a hit that `closest` found for `ray`.
    pub fn interaction(&self, ray: &Ray, hit: &Hit) -> Interaction {
        debug_assert!(f64::from(ray.time) >= self.shutter[0] && f64::from(ray.time) <= self.shutter[1]);
        let object = &self.objects[hit.object as usize];
        let surface = object.surface(hit.element, &ShapeHit { t: hit.t, uv: hit.uv }, ray);
        Interaction { surface, wo: -ray.direction, time: ray.time, object: hit.object }
    }
}
