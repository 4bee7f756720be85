//! Furnaces: scenes in which every point is as bright as every other, whatever happens on the way.

use glam::{DAffine3, DVec3};
use renderer::materials::{Ggx, Material};
use renderer::math::Rgb;
use renderer::scene::{IntegratorSettings, LightSettings, Scene, Strategy};
use renderer::shapes::ShapeSettings;
use std::sync::Arc;
use verify::claim::{Claim, Evidence, Level, Run, claim};
use verify::error::InputError;
use verify::irradiance::furnace_radiance;
use verify::mean::{MeanClaim, joint_control, joint_evidence};

mod many;

use super::lobe::{self, integral, upper};
use crate::bounds;
use crate::setup::{
    blurred_mirror, diffuse, lamp, masked, pane, phong, plastic, radiance, rough_mirror, spot, subject,
    thing, two_sided,
};

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    let mut list = vec![
        closed("furnace/closed/endless", &[None]),
        closed("furnace/closed/cut", &[Some(1), Some(2), Some(3), Some(6)]),
    ];
    list.extend([Surface::Diffuse, Surface::Phong, Surface::Rough, Surface::Blurred].map(white));
    let later = [Surface::Plastic, Surface::RoughPlastic, Surface::Pane, Surface::Mask];
    list.extend(later.map(|surface| white(surface).from_level(Level::Standard)));
    list.push(glass_sphere());
    list.extend(many::claims());
    list.into_iter().map(|claim| claim.same_up_to(Level::Standard)).collect()
}

/// Rounding of paths of a few bounces in single precision: 16 roundings of 2⁻²⁴ that all agree.
const ROUNDING: f64 = 1e-6;

fn about(exact: f64) -> MeanClaim {
    MeanClaim { rounding: ROUNDING, ..MeanClaim::relative(exact, bounds::FURNACE) }
}

/// Scenes and what they should show.
type Furnaces = Vec<(Scene, f64)>;

/// A wrong version by its name: other scenes with the right values.
type Control = (&'static str, Box<dyn Fn() -> Result<Furnaces, InputError> + Send + Sync>);

/// A claim on furnaces that `built` makes; `controls` make other ones, to be held against the right values.
fn furnace(
    (id, says): (&'static str, String),
    samples: u32,
    built: impl Fn() -> Result<Furnaces, InputError> + Clone + Send + Sync + 'static,
    controls: Vec<Control>,
) -> Claim {
    let judged = move |furnaces: &Furnaces, run: &Run| -> Result<Evidence, InputError> {
        let means: Vec<MeanClaim> = furnaces.iter().map(|(_, exact)| about(*exact)).collect();
        joint_evidence(&means, run, |i, seed| radiance(&furnaces[i].0, samples, seed))
    };
    let mut builder = claim(id, says);
    for (name, wrong) in controls {
        builder = builder.rejects(name, move |run| judged(&wrong()?, run));
    }
    let same = built.clone();
    builder
        .rejects("2.2 × resolution", move |run| {
            let furnaces = same()?;
            let means: Vec<MeanClaim> = furnaces.iter().map(|(_, exact)| about(*exact)).collect();
            joint_control(&means, run, |i, seed| radiance(&furnaces[i].0, samples, seed))
        })
        .by(move |run| judged(&built()?, run))
}

/// Albedo of the closed furnace.
const ALBEDO: f32 = 0.5;

/// The inside of a sphere that emits 1 and reflects, with paths of up to so many edges.
fn closed_scene(albedo: f32, max_depth: Option<u32>) -> Result<Scene, InputError> {
    let sphere = ShapeSettings::Sphere { center: DVec3::ZERO, radius: 2.0 };
    let mut wall = lamp(sphere, DAffine3::IDENTITY);
    wall.material = diffuse(albedo);
    wall.flip_normals = true;
    let integrator = IntegratorSettings { max_depth, rr_depth: 6, ..IntegratorSettings::PATH };
    let description = spot(DVec3::new(0.3, 0.2, -0.5), DVec3::new(1.0, 1.0, 1.0), vec![wall], integrator);
    Scene::new(&description).map_err(subject)
}

fn closed(id: &'static str, depths: &'static [Option<u32>]) -> Claim {
    // A path of d edges is reflected d − 1 times.
    let build = move |albedo: f32, edges_lost: u32| -> Result<Furnaces, InputError> {
        let one = |depth: &Option<u32>| {
            let reflections = depth.map(|edges| edges - 1 + edges_lost);
            Ok((closed_scene(albedo, *depth)?, furnace_radiance(1.0, ALBEDO.into(), reflections)))
        };
        depths.iter().map(one).collect()
    };
    let (ends, how) =
        if depths == [None] { (false, "without end") } else { (true, "cut after 1, 2, 3 and 6 edges") };
    let says =
        format!("inside a sphere of albedo ½ that emits 1, paths {how} add up to the geometric series");
    let mut controls: Vec<Control> =
        vec![("albedo 1 % too large", Box::new(move || build(1.01 * ALBEDO, 0)))];
    if ends {
        controls.push(("one reflection too few", Box::new(move || build(ALBEDO, 1))));
    }
    // Only roulette is random here: both ways to find light have the density cos θ/π.
    let samples = if ends { 64 } else { 1024 };
    furnace((id, says), samples, move || build(ALBEDO, 0), controls)
}

/// What a convex body in the white furnace is made of.
#[derive(Clone, Copy)]
enum Surface {
    Diffuse,
    Phong,
    Rough,
    Blurred,
    /// White under a smooth coat: what the coat reflects and what comes out add up to all.
    Plastic,
    RoughPlastic,
    /// A hollow glass ball: what a pane does not reflect it lets pass.
    Pane,
    /// White with holes, on both sides.
    Mask,
}

impl Surface {
    fn id(self) -> &'static str {
        match self {
            Self::Diffuse => "furnace/white/diffuse",
            Self::Phong => "furnace/white/phong",
            Self::Rough => "furnace/white/ggx",
            Self::Blurred => "furnace/white/blur-reflection",
            Self::Plastic => "furnace/white/plastic",
            Self::RoughPlastic => "furnace/white/rough-plastic",
            Self::Pane => "furnace/white/pane",
            Self::Mask => "furnace/white/mask",
        }
    }

    /// The material, its reflectance times `factor`.
    fn material(self, factor: f32) -> Arc<Material> {
        match self {
            Self::Diffuse => diffuse(factor),
            Self::Phong => phong([0.3 * factor, 0.5 * factor], 20.0),
            Self::Rough => rough_mirror(0.5, factor),
            Self::Blurred => blurred_mirror(0.4, factor),
            Self::Plastic => plastic([factor; 2], None),
            Self::RoughPlastic => plastic([0.6 * factor, factor], Some(Ggx { alpha: [0.5; 2] }.into())),
            Self::Pane => pane(1.5, factor),
            Self::Mask => masked(0.625, &two_sided(&diffuse(factor))),
        }
    }

    /// Which paths: inside a ball, where none is absorbed, without roulette, so that all find the same.
    fn paths(self) -> IntegratorSettings {
        let rr_depth =
            if matches!(self, Self::Pane | Self::Mask) { 100 } else { IntegratorSettings::PATH.rr_depth };
        IntegratorSettings { rr_depth, ..IntegratorSettings::PATH }
    }

    /// Samples a replicate: more where the surface cuts a lobe.
    fn samples(self) -> u32 {
        match self {
            Self::Pane => 64,
            Self::Diffuse | Self::Plastic | Self::Mask => 512,
            Self::Rough => 1024,
            Self::RoughPlastic => 4096,
            Self::Phong | Self::Blurred => 2048,
        }
    }

    /// Ways to look for light; points on lights alone seldom find a narrow lobe.
    fn strategies(self) -> &'static [Strategy] {
        match self {
            Self::Diffuse | Self::Plastic | Self::RoughPlastic | Self::Mask => {
                &[Strategy::Light, Strategy::Material, Strategy::Both]
            }
            Self::Phong | Self::Rough | Self::Blurred | Self::Pane => &[Strategy::Material, Strategy::Both],
        }
    }

    /// The share of light from everywhere that is reflected at the cosine `z`, by closed forms or their quadrature.
    fn albedo(self, z: f64) -> f64 {
        let wo = lobe::towards(z);
        let over = |f: &dyn Fn(DVec3) -> f64| integral(&upper(), |wi| f(wi.as_dvec3()))[0];
        let eye = wo.as_dvec3();
        match self {
            Self::Diffuse | Self::Plastic | Self::Pane | Self::Mask => 1.0,
            Self::RoughPlastic => {
                // By its own value, which `material/rough-plastic/*` and a test against Mitsuba are about: here it is
                // the ways to look for light that agree.
                let material = self.material(1.0);
                let bsdf = material.bsdf([0.0; 2]);
                integral(&upper(), |wi| f64::from(bsdf.eval(wo, wi).g * wi.z))[0]
            }
            Self::Phong => {
                // The highlight has n + 2 in its value where its density has n + 1.
                let highlight = |wi: DVec3| lobe::closed_form::highlight(20, eye, wi) * wi.z;
                0.3 + 0.5 * 22.0 / 21.0 * over(&highlight)
            }
            Self::Rough => {
                over(&|wi| lobe::closed_form::ggx(0.5, eye, wi) * lobe::closed_form::ggx_g1(0.5, wi))
            }
            Self::Blurred => {
                // The disk of radius f across the mirrored direction dips below the surface beyond the chord at the
                // share d of its radius: z = f·d·sin θ.
                let d = (z / (0.4 * (1.0 - z * z).sqrt())).min(1.0);
                1.0 - (d.acos() - d * (1.0 - d * d).sqrt()) * std::f64::consts::FRAC_1_PI
            }
        }
    }
}

/// A body in an environment of radiance 1, seen at the cosine `z`.
fn body(material: Arc<Material>, z: f64, settings: IntegratorSettings) -> Result<Scene, InputError> {
    let sphere = ShapeSettings::Sphere { center: DVec3::ZERO, radius: 1.0 };
    let target = DVec3::Z;
    let eye = target + 3.0 * DVec3::new((1.0 - z * z).sqrt(), 0.0, z);
    let objects = vec![thing(sphere, DAffine3::IDENTITY, material)];
    let mut description = spot(eye, target, objects, settings);
    description.lights.push(LightSettings::Constant { radiance: Rgb::WHITE });
    Scene::new(&description).map_err(subject)
}

/// Cosines at which bodies are seen.
const COSINES: [f64; 2] = [0.9, 0.2];

fn white(surface: Surface) -> Claim {
    let build = move |factor: f32| -> Result<Furnaces, InputError> {
        let mut list = Vec::new();
        for z in COSINES {
            let exact = surface.albedo(z);
            for &strategy in surface.strategies() {
                let settings = IntegratorSettings { strategy, ..surface.paths() };
                list.push((body(surface.material(factor), z, settings)?, exact));
            }
        }
        Ok(list)
    };
    let says = "in light from everywhere a body is as bright as its reflectance, however light is looked for";
    let controls: Vec<Control> = vec![("albedo 1 % too small", Box::new(move || build(0.99)))];
    furnace((surface.id(), says.into()), surface.samples(), move || build(1.0), controls)
}

fn glass_sphere() -> Claim {
    let build = |eta: f32, lost: f32| -> Result<Furnaces, InputError> {
        // Without roulette every path finds the same.
        let settings = IntegratorSettings { rr_depth: 100, ..IntegratorSettings::PATH };
        let one = |z: f64| Ok((body(crate::setup::tinted_glass(eta, 1.0 - lost), z, settings)?, 1.0));
        COSINES.into_iter().map(one).collect()
    };
    let says = String::from("in light from everywhere a glass sphere cannot be seen");
    let controls: Vec<Control> = vec![("each refraction loses 0.5 %", Box::new(move || build(1.5, 0.005)))];
    furnace(("furnace/white/glass", says), 64, move || build(1.5, 0.0), controls)
}
