//! Rank 5: where rays meet the objects of a scene, for slices of rays.

mod block;
mod collapse;
mod cover;
mod few;
mod group;
mod item;
mod leaves;
mod memory;
mod moving;
mod moving_node;
mod node;
mod object;
mod packet;
mod turns;
mod walk;

pub use object::Object;

use crate::interaction::Interaction;
use crate::ray::{Hit, Ray};
use crate::shapes::ShapeHit;
use group::{Context, Group};
use moving::MovingTrees;

/// The objects of a scene, found by rays.
///
/// One tree holds every element of the objects at rest and the boxes swept by moving objects that move little; the boxes
/// of the others are interpolated in time, in a tree for each segment of the shutter. A moving mesh has a tree in its own
/// space.
#[derive(Debug)]
pub struct Accel {
    objects: Vec<Object>,
    shutter: [f64; 2],
    scene: Group,
    moving: Option<MovingTrees>,
    /// The tree of each moving object with more than one element.
    inner: Vec<Option<Box<Group>>>,
}

/// How moving objects are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MotionIndex {
    /// By their motion: swept boxes where these are at most 1.4 times as large as the object's own, else interpolated ones,
    /// with twice as many segments for as long as this makes boxes 10 % smaller.
    #[default]
    Chosen,
    /// By the boxes that they sweep while the shutter is open.
    Swept,
    /// By boxes interpolated in time, in trees for that many segments of the shutter, at least 1.
    Interpolated(u32),
}

impl Accel {
    /// Builds the trees over `objects` as they are between `shutter[0]` and `shutter[1]`; rays have times in between.
    ///
    /// An object with a motion that rests costs what a moving one costs: place its shape and leave the motion out.
    pub fn new(objects: Vec<Object>, shutter: [f64; 2]) -> Self {
        Self::indexed(objects, shutter, MotionIndex::Chosen)
    }

    /// As `new`, with the way to find moving objects given.
    pub fn indexed(objects: Vec<Object>, shutter: [f64; 2], index: MotionIndex) -> Self {
        // Rays have f32 times, which may round to just outside.
        let shutter = rounded_outward(shutter);
        let swept = |o: &Object| {
            o.motion.as_ref()?;
            let is_swept = match index {
                MotionIndex::Chosen => moving::is_slow(o, shutter),
                MotionIndex::Swept => true,
                MotionIndex::Interpolated(_) => false,
            };
            is_swept.then(|| o.bounds(shutter))
        };
        let swept: Vec<_> = objects.iter().map(swept).collect();
        let scene = Group::of_scene(&objects, &swept);
        let others = (0u32..).zip(&objects).zip(&swept);
        let others: Vec<u32> = others
            .filter(|((_, o), swept)| o.motion.is_some() && swept.is_none())
            .map(|((i, _), _)| i)
            .collect();
        let moving = (!others.is_empty()).then(|| match index {
            MotionIndex::Interpolated(count) => MovingTrees::new(&objects, &others, shutter, count.max(1)),
            _ => MovingTrees::chosen(&objects, &others, shutter),
        });
        let tree = |(index, o): (u32, &Object)| {
            (o.motion.is_some() && o.shape.element_count() > 1)
                .then(|| Box::new(Group::of_shape(index, &o.shape)))
        };
        let inner = (0u32..).zip(&objects).map(tree).collect();
        Self { objects, shutter, scene, moving, inner }
    }

    /// The objects, in the order given.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The order in which rays of these times are found fastest, as indices written over `order`.
    pub fn order(&self, times: impl ExactSizeIterator<Item = f32> + Clone, order: &mut Vec<u32>) {
        order.clear();
        match &self.moving {
            Some(moving) => moving.order(times, order),
            None => order.extend((0..).zip(times).map(|(i, _)| i)),
        }
    }

    /// The nearest hit of each ray, written over `hits`.
    pub fn closest(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.resize(rays.len(), None);
        let mut context = Context::new(&self.objects, &self.inner);
        self.scene.closest(rays, &mut context, |i, hit| hits[i] = hit);
        if let Some(moving) = &self.moving {
            moving.closest(rays, &mut context, hits);
        }
    }

    /// Whether anything lies on each ray's segment, written over `out`.
    pub fn occluded(&self, rays: &[Ray], out: &mut Vec<bool>) {
        out.clear();
        out.resize(rays.len(), false);
        let mut context = Context::new(&self.objects, &self.inner);
        self.scene.occluded(rays, &mut context, |i, blocked| out[i] = blocked);
        if let Some(moving) = &self.moving {
            moving.occluded(rays, &mut context, out);
        }
    }

    /// How many boxes each ray meets on the way to its nearest hit, summed: around nodes, and around leaves. Boxes within
    /// moving objects are left aside. Any order of steps has to visit these.
    pub fn boxes_met(&self, rays: &[Ray]) -> [u64; 2] {
        let mut hits = Vec::new();
        self.closest(rays, &mut hits);
        let met = |(ray, hit): (&Ray, &Option<Hit>)| {
            let reach = hit.map_or(ray.t_max, |h| h.t);
            let moving = self.moving.as_ref().map_or([0; 2], |moving| moving.boxes_met(ray, reach));
            let resting = self.scene.boxes_met(ray, reach);
            [moving[0] + resting[0], moving[1] + resting[1]]
        };
        rays.iter().zip(&hits).map(met).fold([0; 2], |sum, met| [sum[0] + met[0], sum[1] + met[1]])
    }

    /// The surface at a hit that `closest` found for `ray`.
    pub fn interaction(&self, ray: &Ray, hit: &Hit) -> Interaction {
        let mut interaction = Interaction::default();
        self.put_interaction(ray, hit, &mut interaction);
        interaction
    }

    /// Writes the surface at a hit that `closest` found for `ray` to where it stays.
    #[inline]
    pub fn put_interaction(&self, ray: &Ray, hit: &Hit, interaction: &mut Interaction) {
        debug_assert!(
            (self.shutter[0]..=self.shutter[1]).contains(&f64::from(ray.time))
                || self.objects.iter().all(|o| o.motion.is_none()),
            "moving objects are bounded only while the shutter is open"
        );
        let object = &self.objects[hit.object as usize];
        let at = ShapeHit { t: hit.t, uv: hit.uv };
        object.put_surface(hit.element, &at, ray, &mut interaction.surface);
        interaction.wo = -ray.direction;
        interaction.time = ray.time;
        interaction.object = hit.object;
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounded to nearest, then one step outwards")]
fn rounded_outward([open, close]: [f64; 2]) -> [f64; 2] {
    [f64::from((open as f32).next_down()), f64::from((close as f32).next_up())]
}
