//! A material for each side of a surface.

use glam::Vec3;

use super::bsdf::BsdfSample;
use super::{Bsdf, Calls, Material};
use crate::error::ParamError;
use crate::math::Rgb;

/// What the upper side shows, and what the lower side does: each as that material's own upper side.
#[derive(Debug, Clone, PartialEq)]
pub struct Faces(Box<[Material; 2]>);

/// Both sides at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FacesAt<'m> {
    faces: &'m [Material; 2],
    uv: [f32; 2],
}

impl Faces {
    /// The `upper` and the `lower` side.
    ///
    /// # Errors
    /// [`ParamError::OutOfRange`] when light can pass through one of them.
    pub fn new([upper, lower]: [Material; 2]) -> Result<Self, ParamError> {
        let transmitting = [&upper, &lower].into_iter().filter(|m| m.calls_for().dielectric).count();
        if transmitting > 0 {
            let (name, accepted) = ("number of transmitting sides", "none, materials that only reflect,");
            return Err(ParamError::OutOfRange { name, value: transmitting as f64, accepted });
        }
        Ok(Self(Box::new([upper, lower])))
    }

    /// Whether it looks at surface coordinates.
    pub(super) fn is_textured(&self) -> bool {
        self.0.iter().any(Material::is_textured)
    }

    /// What either side calls for.
    pub fn calls_for(&self) -> Calls {
        let [upper, lower] = &*self.0;
        upper.calls_for().or(lower.calls_for())
    }

    /// Both sides' sharp forms.
    pub(super) fn sharp(&self) -> Option<Material> {
        let [upper, lower] = &*self.0;
        Self::new([upper.sharp()?, lower.sharp()?]).ok().map(Material::Faces)
    }

    /// Both sides at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> FacesAt<'_> {
        FacesAt { faces: &self.0, uv }
    }
}

impl FacesAt<'_> {
    /// The side that `wo` sees, and the sign that turns directions to its upper side.
    fn seen(&self, wo: Vec3) -> (Bsdf<'_>, f32) {
        let [upper, lower] = self.faces;
        if wo.z < 0.0 { (lower.bsdf(self.uv), -1.0) } else { (upper.bsdf(self.uv), 1.0) }
    }

    /// f of the side that `wo` sees \[1/sr\].
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let (side, sign) = self.seen(wo);
        side.eval(sign * wo, sign * wi)
    }

    /// The same times |cos θᵢ|.
    pub fn eval_cos(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let (side, sign) = self.seen(wo);
        side.eval_cos(sign * wo, sign * wi)
    }

    /// The density of that side.
    ///
    /// # Measure
    /// Per steradian.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (side, sign) = self.seen(wo);
        side.pdf(sign * wo, sign * wi)
    }

    /// A direction drawn by that side.
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2]) -> Option<BsdfSample> {
        let (side, sign) = self.seen(wo);
        side.sample(sign * wo, u_lobe, u).map(|s| BsdfSample { wi: sign * s.wi, ..s })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_side_is_its_own_material() {
        let grey = |r: f32| Material::new_diffuse(Rgb::splat(r).into()).unwrap();
        let metal = Material::new_mirror(Rgb::splat(0.9).into()).unwrap();
        let both = Material::new_faces([grey(0.2), grey(0.7)]).unwrap();
        let (up, down) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, -0.8));
        let bsdf = both.bsdf([0.0; 2]);
        assert_eq!(bsdf.eval(up, Vec3::Z), grey(0.2).bsdf([0.0; 2]).eval(up, Vec3::Z));
        assert_eq!(bsdf.eval(down, Vec3::NEG_Z), grey(0.7).bsdf([0.0; 2]).eval(-down, Vec3::Z));
        assert_eq!(bsdf.eval(up, down), Rgb::BLACK);
        let mirrored = Material::new_faces([grey(0.2), metal]).unwrap();
        let sample = mirrored.bsdf([0.0; 2]).sample(down, 0.5, [0.5; 2]).unwrap();
        assert_eq!((sample.wi, sample.weight), (Vec3::new(0.0, -0.6, -0.8), Rgb::splat(0.9)));
        assert!(mirrored.calls_for().direction && !mirrored.calls_for().delta_only);
    }

    #[test]
    fn sides_that_let_light_through_are_refused() {
        let glass = Material::new_dielectric(1.5, Rgb::WHITE.into(), Rgb::WHITE.into()).unwrap();
        let mirror = Material::new_mirror(Rgb::WHITE.into()).unwrap();
        let error = Material::new_faces([mirror, glass]).unwrap_err().to_string();
        assert_eq!(
            error,
            "number of transmitting sides is 1; none, materials that only reflect, is accepted"
        );
    }
}
