//! Lobes of materials: their directions follow the closed form of the density, `pdf` is that form, and its integral is 1 less what is dropped.

use std::sync::Arc;

use glam::{DMat3, DVec3, Vec3};
use renderer::materials::{Beckmann, Branch, Bsdf, Facets, Ggx, Material};
use verify::claim::{Claim, Level};
use verify::domain::{Directions, Domain};
use verify::quadrature::{Tolerance, integrate_2d};

use super::pointwise::{EPSILON, single};
use crate::setup;

pub(super) mod closed_form;
mod density;
mod directions;
mod fuzzy;
mod white;

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    let all = [directions::claims(), density::claims(), fuzzy::claims(), white::claims()];
    all.into_iter().flatten().map(|claim| claim.same_up_to(Level::Standard)).collect()
}

/// Roughness of the sharp and the broad metal.
const SHARP: f32 = 0.1;
const BROAD: f32 = 0.5;

/// Phong's exponent, and the diffuse and specular reflectance beside it.
const EXPONENT: i16 = 20;
const PHONG: [f32; 2] = [0.3, 0.5];

/// The blur of the blur disks, and the index of the one that refracts.
const BLUR: f32 = 0.4;
const ETA: f32 = 1.5;

/// Roughness along two tangents.
const BRUSHED: [f32; 2] = [0.2, 0.6];

/// Microfacets of claims in double precision, from the renderer's.
fn normals(facets: Facets) -> closed_form::Normals {
    match facets {
        Facets::Ggx(f) => closed_form::Normals::Ggx(f.alpha.map(f64::from)),
        Facets::Beckmann(f) => closed_form::Normals::Beckmann(f.alpha.map(f64::from)),
    }
}

/// GGX that is rougher along y.
pub(super) fn brushed() -> Facets {
    Ggx { alpha: BRUSHED }.into()
}

/// Beckmann, round and broad.
pub(super) fn beckmann() -> Facets {
    Beckmann { alpha: [BROAD; 2] }.into()
}

/// The material's BSDF; it has no textures. Materials of claims live as long as the program.
pub(super) fn plain(material: Arc<Material>) -> Bsdf<'static> {
    let kept: &'static Arc<Material> = Box::leak(Box::new(material));
    kept.bsdf([0.0; 2])
}

/// Diffuse, of albedo 0.8.
pub(super) fn diffuse() -> Bsdf<'static> {
    plain(setup::diffuse(0.8))
}

/// A rough mirror.
pub(super) fn ggx(alpha: f32) -> Bsdf<'static> {
    plain(setup::rough_mirror(alpha, 1.0))
}

/// Phong's model with a diffuse and a specular reflectance.
pub(super) fn phong(reflectances: [f32; 2], exponent: f32) -> Bsdf<'static> {
    plain(setup::phong(reflectances, exponent))
}

/// A blurred mirror, or blurred glass where `eta` is given.
pub(super) fn blurred(eta: Option<f32>) -> Bsdf<'static> {
    plain(eta.map_or_else(|| setup::blurred_mirror(BLUR, 1.0), |eta| setup::blurred_glass(BLUR, eta)))
}

/// The unit vector at the cosine `z` to the normal, turned away from every axis.
pub(super) fn towards(z: f64) -> Vec3 {
    let sin = (1.0 - z * z).sqrt();
    DVec3::new(0.6 * sin, 0.8 * sin, z).as_vec3()
}

/// The ideal direction of a branch in double precision.
fn ideal(wo: Vec3, branch: Branch) -> DVec3 {
    let wo = wo.as_dvec3().normalize();
    let eta = if wo.z > 0.0 { f64::from(ETA) } else { 1.0 / f64::from(ETA) };
    match branch {
        Branch::Reflect => DVec3::new(-wo.x, -wo.y, wo.z),
        Branch::Refract => {
            let sin = wo.truncate() / -eta;
            sin.extend(-wo.z.signum() * (1.0 - sin.length_squared()).sqrt())
        }
    }
}

/// A right-handed frame whose third axis is the unit vector `z`.
fn frame_of(z: DVec3) -> DMat3 {
    let (x, y) = z.any_orthonormal_pair();
    DMat3::from_cols(x, y, z)
}

/// A direction of the unit sphere, for points where densities are compared.
pub(super) fn anywhere(u: [f64; 2]) -> Vec3 {
    renderer::sampling::warp::square_to_sphere(u.map(single))
}

/// Relative error of `count` roundings to single precision.
fn roundings(count: f64) -> f64 {
    count * EPSILON
}

/// Directions and a frame for them: where a quadrature looks.
pub(super) type Region = (Directions, DMat3);

/// Both hemispheres.
pub(super) fn everywhere() -> Vec<Region> {
    let below = DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z);
    vec![(Directions::hemisphere(), DMat3::IDENTITY), (Directions::hemisphere(), below)]
}

/// The upper hemisphere.
pub(super) fn upper() -> Vec<Region> {
    vec![(Directions::hemisphere(), DMat3::IDENTITY)]
}

/// Cones a little wider than the blur disks about the ideal directions of both branches.
pub(super) fn cones(wo: Vec3) -> Vec<Region> {
    let cone = Directions::cone(1.05 * f64::from(BLUR).atan());
    [Branch::Reflect, Branch::Refract].map(|branch| (cone, frame_of(ideal(wo, branch)))).into()
}

/// The integral of a function over regions of directions, and the error that the quadrature states.
pub(super) fn integral(regions: &[Region], f: impl Fn(Vec3) -> f64) -> [f64; 2] {
    // Single precision rounds each value by a few 2⁻²⁴: more digits would be sought in vain. A cut through a region
    // takes pieces along it; 2,000 of them leave an error of the order of 1e-4.
    let tolerance = Tolerance { relative: 1e-5, absolute: 1e-6, pieces: 2000 };
    let over = |(domain, frame): &Region| {
        let value = |square| domain.measure() * f((*frame * DVec3::from(domain.point(square))).as_vec3());
        let integral = integrate_2d(&value, [[0.0, 1.0], [0.0, 1.0]], tolerance);
        [integral.value, integral.error]
    };
    regions.iter().map(over).fold([0.0; 2], |[value, error], [v, e]| [value + v, error + e])
}
