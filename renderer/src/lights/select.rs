//! Which light to connect to.

use glam::Vec3;

use super::tree::{Extent, Tree};
use super::{AreaLight, Light};
use crate::accel::{Accel, Object};
use crate::math::Rgb;
use crate::shapes::Shape;

/// All lights of a scene.
///
/// Lights in a place are chosen by a tree, about in proportion to what they can send to a point; those beyond all shapes
/// have the same share each as all others together. Nothing is connected to a sky of one radiance where a path's own rays
/// find it: directions of a material's own density leave nothing but shadows to vary.
///
/// # Source
/// Conty Estevez and Kulla 2018, "Importance sampling of many lights with adaptive tree splitting",
/// doi 10.1145/3233305, for the importance, without splitting. Halving by places instead of by cost is ours.
#[derive(Debug, Clone, Default)]
pub struct Lights {
    lights: Vec<Light>,
    background: Option<usize>,
    tree: Tree,
    /// Lights beyond all shapes that paths are connected to.
    far: Vec<u32>,
    /// The light that paths are connected to, if it is the only one.
    only: Option<u32>,
}

impl Lights {
    /// The set of `lights`, whose shapes are the objects of `accel`.
    ///
    /// * `shutter`: when it opens and closes; `finds_sky`: whether paths that leave the scene count all of a constant background.
    pub fn new(lights: Vec<Light>, accel: &Accel, shutter: [f64; 2], finds_sky: bool) -> Self {
        let background = lights.iter().position(Light::is_background);
        let extents: Vec<Option<Extent>> = lights.iter().map(|light| extent(light, accel, shutter)).collect();
        let indexed = || (0_u32..).zip(&extents);
        let near: Vec<_> = indexed().filter_map(|(i, extent)| extent.map(|e| (i, e))).collect();
        let is_found = |&i: &usize| finds_sky && matches!(lights[i], Light::Constant { .. });
        let found = background.filter(is_found);
        let is_far = |(i, extent): &(u32, &Option<Extent>)| extent.is_none() && found != Some(*i as usize);
        let far: Vec<u32> = indexed().filter(is_far).map(|(i, _)| i).collect();
        let mut connected = near.iter().map(|(i, _)| *i).chain(far.iter().copied());
        let only = connected.next().filter(|_| connected.next().is_none());
        Self { tree: Tree::new(near, lights.len()), lights, background, far, only }
    }

    /// Whether paths are connected to none.
    pub fn is_empty(&self) -> bool {
        self.far.is_empty() && self.tree.is_empty()
    }

    /// Whether a choice is to be made.
    pub fn needs_choice(&self) -> bool {
        self.only.is_none() && !self.is_empty()
    }

    /// Whether a point on any of them is to be decided.
    pub fn have_extent(&self) -> bool {
        self.lights.iter().any(|light| matches!(light, Light::Area(_)))
            || self.far.iter().any(|&far| self.get(far).has_extent())
    }

    /// The light that paths are connected to, if it is the only one.
    pub fn only(&self) -> Option<&Light> {
        self.only.map(|light| self.get(light))
    }

    /// Whether points on the lights alone give an estimate of direct light on a diffuse surface that varies little for what is
    /// seen: there is one, and its points are even in the solid angle where it is near.
    pub fn are_even(&self) -> bool {
        matches!(self.lights.as_slice(), [Light::Area(light)] if light.is_even())
    }

    /// Every light.
    pub fn as_slice(&self) -> &[Light] {
        &self.lights
    }

    /// The light of index `light`.
    pub fn get(&self, light: u32) -> &Light {
        &self.lights[light as usize]
    }

    /// The light beyond all shapes, if there is one.
    pub fn background(&self) -> Option<&Light> {
        self.background.map(|i| &self.lights[i])
    }

    /// The probability with which [`Self::choose`] takes the light beyond all shapes.
    pub fn pmf_background(&self) -> f32 {
        let is_chosen = self.far.iter().any(|&far| self.background == Some(far as usize));
        if is_chosen { self.share() } else { 0.0 }
    }

    /// The probability of each light beyond all shapes that is chosen at times, and of all others together.
    fn share(&self) -> f32 {
        let groups = self.far.len() + usize::from(!self.tree.is_empty());
        1.0 / groups as f32
    }

    /// The light for `u` in [0, 1) where `from` is lit, and its probability.
    ///
    /// # Panics
    /// Without any to connect to.
    pub fn choose(&self, u: f32, from: Vec3) -> (&Light, f32) {
        if let Some(only) = self.only() {
            return (only, 1.0);
        }
        let share = self.share();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "u/share lies in [0, groups]"
        )]
        let group = (u / share) as usize;
        match self.far.get(group) {
            Some(&far) => (self.get(far), share),
            None if self.tree.is_empty() => (self.get(self.far[self.far.len() - 1]), share),
            None => {
                let within = (u / share - self.far.len() as f32).clamp(0.0, 1.0 - 0.5 * f32::EPSILON);
                let (light, pmf) = self.tree.choose(within, from);
                (self.get(light), share * pmf)
            }
        }
    }

    /// The probability with which [`Self::choose`] takes a light that has a place.
    pub fn pmf(&self, light: u32, from: Vec3) -> f32 {
        if self.only.is_some() { 1.0 } else { self.share() * self.tree.pmf(light, from) }
    }
}

/// Where the light is while the shutter is open, and which way it shines; `None` beyond all shapes.
fn extent(light: &Light, accel: &Accel, shutter: [f64; 2]) -> Option<Extent> {
    let point = |position: Vec3, intensity: Rgb| Extent {
        middle: position,
        radius: 0.0,
        axis: Vec3::Z,
        cos: -1.0,
        intensity: intensity.mean(),
    };
    match light {
        Light::Area(AreaLight { object, radiance, .. }) => {
            Some(extent_of(&accel.objects()[*object as usize], radiance.mean(), shutter))
        }
        Light::Point { position, intensity } => Some(point(*position, *intensity)),
        Light::Spot(spot) => Some(point(spot.position, spot.intensity)),
        Light::Constant { .. } | Light::Environment(_) | Light::Directional { .. } => None,
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the area of what f32 holds")]
fn extent_of(object: &Object, radiance: f32, shutter: [f64; 2]) -> Extent {
    let bounds = object.bounds(shutter);
    let [middle, half] = bounds.middle_and_half();
    let is_flat = match &object.shape {
        Shape::Rectangle(_) | Shape::Disk(_) => true,
        shape => matches!(shape, Shape::Mesh(_)) && shape.element_count() == 1,
    };
    // A flat light at rest has one normal, wherever on it.
    let (axis, cos) = match &object.motion {
        None if is_flat => (object.shape.sample_area([0.5; 2]).ng, 1.0),
        _ => (Vec3::Z, -1.0),
    };
    Extent {
        middle: middle.as_vec3(),
        radius: (half.length() * (1.0 + 1e-6)) as f32, // the middle is rounded
        axis,
        cos,
        intensity: radiance * object.shape.area() as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    #[test]
    fn a_constant_sky_is_not_connected_to_where_paths_find_it() {
        let sky = Light::Constant { radiance: Rgb::WHITE };
        let point = Light::Point { position: Vec3::Y, intensity: Rgb::WHITE };
        let none = Accel::new(Vec::new(), [0.0; 2]);
        let [found, connected] =
            [true, false].map(|finds| Lights::new(vec![sky.clone(), point.clone()], &none, [0.0; 2], finds));
        assert_eq!((found.only(), found.background()), (Some(&point), Some(&sky)));
        assert_eq!((found.pmf_background(), found.pmf(1, Vec3::ZERO)), (0.0, 1.0));
        assert!(!found.needs_choice() && !found.have_extent() && !found.is_empty());
        assert_eq!((connected.only(), connected.pmf_background()), (None, 0.5));
        assert!(connected.needs_choice() && connected.have_extent());
        assert!(Lights::new(vec![sky], &none, [0.0; 2], true).is_empty());
    }

    #[test]
    fn the_last_number_below_one_chooses_the_last_light() {
        let light = |r| Light::Constant { radiance: Rgb::splat(r) };
        let none = Accel::new(Vec::new(), [0.0; 2]);
        let lights = Lights::new(vec![light(1.0), light(2.0), light(3.0)], &none, [0.0; 2], false);
        assert_eq!(lights.choose(1.0 - f32::EPSILON / 2.0, Vec3::ZERO), (&light(3.0), 1.0 / 3.0));
        assert_eq!(lights.choose(0.0, Vec3::ZERO), (&light(1.0), 1.0 / 3.0));
    }
}
