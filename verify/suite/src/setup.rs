//! Scenes that claims build in code, and what one pixel sees of them.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::{Arc, Mutex, PoisonError};

use glam::{DAffine3, DMat3, DVec3};
use renderer::camera::{CameraSettings, FovAxis, Projection, Shutter};
use renderer::film::{FilmSettings, Filter, Reconstruction};
use renderer::integrator::PathTracer;
use renderer::materials::{Facets, Ggx, Material, Metal};
use renderer::math::Rgb;
use renderer::math::transform::Motion;
use renderer::render::{RenderSettings, Rendering, render};
use renderer::sampling::{
    DecisionSet, Halton, Independent, MultiJitter, Pmj02, Sampler, SamplerKind, Sobol, Stratified,
};
use renderer::scene::{
    IntegratorSettings, ObjectSettings, SamplerSettings, Scene, SceneDescription, Strategy,
};
use renderer::shapes::ShapeSettings;
use renderer::texture::Texture;
use verify::error::InputError;
use verify::mean::MeanClaim;

/// An error of the renderer as a reason why a claim cannot run.
pub fn subject(error: impl std::fmt::Display) -> InputError {
    InputError::Subject(error.to_string())
}

/// A motion that stays where `to_world` puts it.
///
/// # Panics
/// If the transform is not finite or singular: the transforms of claims are neither.
pub fn fixed(to_world: DAffine3) -> Motion {
    Motion::fixed(to_world).expect("transforms of claims are finite and invertible")
}

/// A diffuse material of the same `albedo` in each channel.
///
/// # Panics
/// If `albedo` is not in [0, 1].
pub fn diffuse(albedo: f32) -> Arc<Material> {
    let reflectance = Texture::Constant(Rgb::splat(albedo));
    Arc::new(Material::new_diffuse(reflectance).expect("albedos of claims are in [0, 1]"))
}

fn gray(value: f32) -> Texture {
    Texture::Constant(Rgb::splat(value))
}

fn valid(material: Result<Material, renderer::ParamError>) -> Arc<Material> {
    Arc::new(material.expect("materials of claims are valid"))
}

/// Phong's model with a diffuse and a specular reflectance.
pub fn phong([diffuse, specular]: [f32; 2], exponent: f32) -> Arc<Material> {
    valid(Material::new_phong(gray(diffuse), gray(specular), exponent))
}

/// A rough mirror, GGX: index 0 and extinction 1 reflect all light, so that what is lost is the model's.
pub fn rough_mirror(alpha: f32, reflectance: f32) -> Arc<Material> {
    mirror_of(Ggx { alpha: [alpha; 2] }.into(), reflectance)
}

/// A rough mirror of any microfacets.
pub fn mirror_of(facets: Facets, reflectance: f32) -> Arc<Material> {
    let metal = Metal::new(Rgb::BLACK, Rgb::WHITE).expect("a mirror");
    valid(Material::new_rough_conductor(facets, metal, gray(reflectance)))
}

/// A smooth metal.
pub fn smooth_metal(metal: Metal) -> Arc<Material> {
    valid(Material::new_conductor(metal, gray(1.0)))
}

/// Ground glass.
pub fn ground_glass(facets: Facets, eta: f32) -> Arc<Material> {
    valid(Material::new_rough_dielectric(facets, eta, gray(1.0), gray(1.0)))
}

/// A window pane.
pub fn pane(eta: f32, transmittance: f32) -> Arc<Material> {
    valid(Material::new_thin_dielectric(eta, gray(1.0), gray(transmittance)))
}

/// Plastic of index 1.5 with a diffuse and a specular reflectance; rough where it has microfacets.
pub fn plastic([diffuse, specular]: [f32; 2], coat: Option<Facets>) -> Arc<Material> {
    let (diffuse, specular) = (gray(diffuse), gray(specular));
    valid(match coat {
        Some(facets) => Material::new_rough_plastic(facets, 1.5, true, diffuse, specular),
        None => Material::new_plastic(1.5, true, diffuse, specular),
    })
}

/// A share of a material, the rest holes.
pub fn masked(opacity: f32, inner: &Material) -> Arc<Material> {
    valid(Material::new_mask(gray(opacity), inner.clone()))
}

/// A material for each side.
pub fn faces([upper, lower]: [&Material; 2]) -> Arc<Material> {
    valid(Material::new_faces([upper.clone(), lower.clone()]))
}

/// A mixture of two materials, a share `weight` of the second.
pub fn blended(weight: f32, [first, second]: [&Material; 2]) -> Arc<Material> {
    valid(Material::new_blend(gray(weight), [first.clone(), second.clone()]))
}

/// A material on both sides.
pub fn two_sided(inner: &Material) -> Arc<Material> {
    valid(Material::new_two_sided(inner.clone()))
}

/// A mirror blurred on a disk.
pub fn blurred_mirror(blur: f32, reflectance: f32) -> Arc<Material> {
    valid(Material::new_blur_disk(blur, None, gray(reflectance), gray(1.0)))
}

/// Glass blurred on a disk.
pub fn blurred_glass(blur: f32, eta: f32) -> Arc<Material> {
    valid(Material::new_blur_disk(blur, Some(eta), gray(1.0), gray(1.0)))
}

/// Smooth glass.
pub fn glass(eta: f32) -> Arc<Material> {
    tinted_glass(eta, 1.0)
}

/// Smooth glass that lets a share of the refracted light through each face.
pub fn tinted_glass(eta: f32, transmittance: f32) -> Arc<Material> {
    valid(Material::new_dielectric(eta, gray(1.0), gray(transmittance)))
}

/// A pane of smooth glass without thickness.
pub fn thin_glass(eta: f32) -> Arc<Material> {
    valid(Material::new_thin_dielectric(eta, gray(1.0), gray(1.0)))
}

/// A black shape that emits the radiance 1 on the side of its normal.
pub fn lamp(shape: ShapeSettings, to_world: DAffine3) -> ObjectSettings {
    ObjectSettings { radiance: Rgb::WHITE.into(), ..thing(shape, to_world, diffuse(0.0)) }
}

/// A shape that does not emit.
pub fn thing(shape: ShapeSettings, to_world: DAffine3, material: Arc<Material>) -> ObjectSettings {
    ObjectSettings {
        name: "object of a claim".into(),
        shape,
        to_world: fixed(to_world),
        flip_normals: false,
        material,
        radiance: Rgb::BLACK.into(),
    }
}

/// The transform that looks from `from` to `to`, as Mitsuba's `lookat`: +z towards `to`, +x to the left.
pub fn look(from: DVec3, to: DVec3, up: DVec3) -> DAffine3 {
    let z = (to - from).normalize();
    let x = up.cross(z).normalize();
    DAffine3 { matrix3: DMat3::from_cols(x, z.cross(x), z), translation: from }
}

/// The canonical rectangle [−1, 1]² with its middle at `centre`, its sides along `side` and `other` (half lengths
/// included), its normal along their cross product.
pub fn rectangle_at(centre: DVec3, side: DVec3, other: DVec3) -> DAffine3 {
    let normal = side.cross(other).normalize();
    DAffine3 { matrix3: DMat3::from_cols(side, other, normal), translation: centre }
}

/// A scene of `objects` seen by a pinhole at `eye` that has one pixel, so narrow that it sees one point: `target`.
pub fn spot(
    eye: DVec3,
    target: DVec3,
    objects: Vec<ObjectSettings>,
    integrator: IntegratorSettings,
) -> SceneDescription {
    let view = (target - eye).normalize();
    let up = if view.y.abs() < 0.9 { DVec3::Y } else { DVec3::X };
    let projection =
        Projection::Perspective { fov: 1e-3, axis: FovAxis::X, lens_radius: 0.0, focus_distance: 1.0 };
    SceneDescription {
        camera: CameraSettings {
            projection,
            to_world: fixed(look(eye, target, up)),
            shutter: Shutter::INSTANT,
        },
        film: FilmSettings {
            width: 1,
            height: 1,
            crop: None,
            filter: Filter::PIXEL,
            reconstruction: Reconstruction::Importance,
        },
        sampler: SamplerSettings { kind: SamplerKind::Sobol, spp: 1, seed: 0 },
        integrator,
        objects,
        lights: Vec::new(),
        hash: 0,
    }
}

/// A scene seen along −z by parallel rays, one unit of length a pixel, with the origin in the middle of the film: x runs to
/// the right and y upwards. Lights only.
pub fn flat(size: [u32; 2], objects: Vec<ObjectSettings>) -> SceneDescription {
    flat_at(10.0, 1.0, size, objects)
}

/// The same from the height `eye`, with pixels of the side `pixel`.
pub fn flat_at(eye: f64, pixel: f64, size: [u32; 2], objects: Vec<ObjectSettings>) -> SceneDescription {
    let emission = IntegratorSettings { max_depth: Some(1), ..IntegratorSettings::DIRECT };
    let mut description = spot(eye * DVec3::Z, DVec3::ZERO, objects, emission);
    let half = 0.5 * pixel * f64::from(size[0]);
    let view = look(eye * DVec3::Z, DVec3::ZERO, DVec3::Y);
    description.camera.projection = Projection::Orthographic;
    description.camera.to_world = fixed(view * DAffine3::from_scale(DVec3::new(half, half, 1.0)));
    description.film = FilmSettings { width: size[0], height: size[1], ..description.film };
    description
}

/// The middles of the pixels of [`flat`], row by row.
pub fn pixel_middles([width, height]: [u32; 2]) -> Vec<[f64; 2]> {
    let x = move |i: u32| f64::from(i) + 0.5 - 0.5 * f64::from(width);
    let y = move |j: u32| 0.5 * f64::from(height) - f64::from(j) - 0.5;
    (0..height).flat_map(|j| (0..width).map(move |i| [x(i), y(j)])).collect()
}

/// A lamp that fills the half-plane x cos φ + y sin φ < `distance` of the plane z = 0, as far as 1000 units.
pub fn half_plane(distance: f64, angle: f64) -> ObjectSettings {
    let normal = DVec3::new(angle.cos(), angle.sin(), 0.0);
    let along = DVec3::Z.cross(normal);
    lamp(ShapeSettings::Rectangle, rectangle_at((distance - 1e3) * normal, 1e3 * normal, 1e3 * along))
}

/// Where the eye of [`receiver`] is.
pub const RECEIVER_EYE: DVec3 = DVec3::new(0.003, 0.002, 0.004);

/// A white diffuse receiver at the origin with its normal along +z, lit by `lamps`, and an eye close to it: its
/// radiance times π is the irradiance at the origin.
///
/// The eye is 5 mm from the receiver, so that no lamp farther away comes between them; the spot that it sees is
/// 1e-7 wide, over which the irradiance of a lamp 0.05 away varies by less than 1e-10 relative (the second order).
pub fn receiver(lamps: Vec<ObjectSettings>) -> SceneDescription {
    let plate = DAffine3::from_scale(DVec3::new(0.01, 0.01, 1.0));
    let mut objects = vec![thing(ShapeSettings::Rectangle, plate, diffuse(1.0))];
    objects.extend(lamps);
    let integrator = IntegratorSettings { strategy: Strategy::Light, ..IntegratorSettings::DIRECT };
    spot(RECEIVER_EYE, DVec3::ZERO, objects, integrator)
}

/// The scene of `description`.
///
/// # Panics
/// If it is refused: the scenes of claims are not.
pub fn built(description: &SceneDescription) -> Scene {
    Scene::new(description).expect("the scenes of claims are valid")
}

/// A function of a configuration and a seed that remembers its values: controls that plant a defect in what the
/// subject gave need not render it again.
pub fn remembering<T: Clone>(subject: impl Fn(usize, u64) -> T) -> impl Fn(usize, u64) -> T {
    let known = Mutex::new(HashMap::new());
    move |configuration, seed| {
        let remembered = || known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(value) = remembered().get(&(configuration, seed)) {
            return T::clone(value);
        }
        let value = subject(configuration, seed);
        remembered().insert((configuration, seed), value.clone());
        value
    }
}

/// One replicate's image of `scene`: `samples` a pixel, at least 1, from `seed`.
pub fn image(scene: &Scene, kind: SamplerKind, samples: u32, seed: u64) -> Rendering {
    let settings = RenderSettings { sampler: kind, samples, replicates: 1, seed, threads: 0 };
    render(scene, &PathTracer { settings: scene.integrator }, &settings, &|_| ())
        .expect("one replicate, at least one sample, and the threads at hand")
}

/// The claim that the means of two images differ by at most `bound`, in units of the mean `unit`.
pub fn difference_of_images(unit: f64, bound: f64) -> MeanClaim {
    // Sums of f32 products along paths of a few vertices.
    let rounding = 16.0 * f64::from(f32::EPSILON);
    MeanClaim { rounding, ..MeanClaim::in_units_of(unit, 0.0, bound) }
}

/// The mean over all pixels and channels of an image.
pub fn mean(image: &Rendering) -> f64 {
    let sum: f64 = image.pixels.iter().flat_map(|p| p.mean).sum();
    sum / (3.0 * image.pixels.len() as f64)
}

/// The mean over all pixels and channels of one replicate's image of `scene`.
pub fn radiance(scene: &Scene, samples: u32, seed: u64) -> f64 {
    mean(&image(scene, SamplerKind::Sobol, samples, seed))
}

/// The irradiance [W m⁻²] at the receiver of `scene`, which [`receiver`] made.
pub fn irradiance(scene: &Scene, samples: u32, seed: u64) -> f64 {
    PI * radiance(scene, samples, seed)
}

/// The sampler of that kind and seed for `samples` per pixel and replicate.
///
/// * `planned`: the decisions before the first bounce.
pub fn sampler(kind: SamplerKind, seed: u64, planned: DecisionSet, samples: u32) -> Box<dyn Sampler> {
    match kind {
        SamplerKind::Independent => Box::new(Independent::new(seed)),
        SamplerKind::Stratified => Box::new(Stratified::new(seed, samples)),
        SamplerKind::MultiJitter => Box::new(MultiJitter::new(seed, samples)),
        SamplerKind::Halton => Box::new(Halton::new(seed, planned, samples)),
        SamplerKind::Sobol => Box::new(Sobol::new(seed, planned)),
        SamplerKind::Pmj02 => Box::new(Pmj02::new(seed)),
    }
}
