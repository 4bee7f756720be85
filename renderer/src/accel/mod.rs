//! Rank 5: where rays meet the objects of a scene, for slices of rays.

mod block;
mod collapse;
mod group;
mod node;
mod object;
mod walk;

pub use object::Object;

use crate::interaction::Interaction;
use crate::ray::{Hit, Ray};
use crate::shapes::ShapeHit;
use group::{Context, Group};

/// The objects of a scene, found by rays.
///
/// One tree holds every element of the objects at rest and, as one item each, the boxes that the moving objects sweep
/// while the shutter is open; each moving object has a tree in its own space.
#[derive(Debug)]
pub struct Accel {
    objects: Vec<Object>,
    shutter: [f64; 2],
    scene: Group,
    /// The tree of each moving object.
    inner: Vec<Option<Group>>,
}

impl Accel {
    /// Builds the trees over `objects` as they are between `shutter[0]` and `shutter[1]`; rays have times in between.
    ///
    /// An object with a motion that rests costs what a moving one costs: place its shape and leave the motion out.
    pub fn new(objects: Vec<Object>, shutter: [f64; 2]) -> Self {
        // Rays have f32 times, which may round to just outside.
        let shutter = rounded_outward(shutter);
        let scene = Group::of_scene(&objects, shutter);
        let tree = |(index, o): (u32, &Object)| o.motion.is_some().then(|| Group::of_shape(index, &o.shape));
        let inner = (0u32..).zip(&objects).map(tree).collect();
        Self { objects, shutter, scene, inner }
    }

    /// The objects, in the order given.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The nearest hit of each ray, written over `hits`.
    pub fn closest(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.resize(rays.len(), None);
        self.scene.closest(rays, &mut self.context(), hits);
    }

    /// Whether anything lies on each ray's segment, written over `out`.
    pub fn occluded(&self, rays: &[Ray], out: &mut Vec<bool>) {
        out.clear();
        out.resize(rays.len(), false);
        self.scene.occluded(rays, &mut self.context(), out);
    }

    fn context(&self) -> Context<'_> {
        Context { objects: &self.objects, inner: &self.inner, stack: Vec::new() }
    }

    /// The surface at a hit that `closest` found for `ray`.
    pub fn interaction(&self, ray: &Ray, hit: &Hit) -> Interaction {
        debug_assert!(
            (self.shutter[0]..=self.shutter[1]).contains(&f64::from(ray.time))
                || self.inner.iter().all(Option::is_none),
            "moving objects are bounded only while the shutter is open"
        );
        let object = &self.objects[hit.object as usize];
        let surface = object.surface(hit.element, &ShapeHit { t: hit.t, uv: hit.uv }, ray);
        Interaction { surface, wo: -ray.direction, time: ray.time, object: hit.object }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounded to nearest, then one step outwards")]
fn rounded_outward([open, close]: [f64; 2]) -> [f64; 2] {
    [f64::from((open as f32).next_down()), f64::from((close as f32).next_up())]
}
