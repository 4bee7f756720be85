//! Means of Fresnel's reflectance: over diffuse light, as the choice of a branch, and between the faces of a slab.

use glam::{DAffine3, DVec3, Vec3};
use renderer::materials::Material;
use renderer::math::Rgb;
use renderer::scene::{IntegratorSettings, ObjectSettings, Scene};
use renderer::shapes::ShapeSettings;
use renderer::texture::Texture;
use verify::claim::{Claim, Evidence, Run, claim};
use verify::error::InputError;
use verify::fresnel::{diffuse_reflectance as walsh, slab as both_faces};
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::super::jittered;
use super::super::lobe::closed_form;
use crate::bounds;
use crate::setup::{glass, lamp, radiance, rectangle_at, spot, subject, thin_glass, thing};

pub(super) fn claims() -> Vec<Claim> {
    vec![
        diffuse(),
        choice(),
        through("fresnel/slab/both-faces", "a slab", slab),
        through("fresnel/slab/pane", "a pane without thickness", pane),
    ]
}

/// Rounding of single precision in means of densities and reflectances: at most 16 roundings of 2⁻²⁴ that all agree.
const ROUNDING: f64 = 1e-6;

fn about(exact: f64) -> MeanClaim {
    MeanClaim { rounding: ROUNDING, ..MeanClaim::relative(exact, bounds::FRESNEL) }
}

/// A smooth boundary of index `eta`.
fn boundary(eta: f32) -> Material {
    let white = || Texture::Constant(Rgb::WHITE);
    Material::new_dielectric(eta, white(), white()).expect("indices of claims are valid")
}

/// Indices of water, glass and diamond's neighbourhood.
const INDICES: [f32; 3] = [1.33, 1.5, 2.0];

/// Samples of a replicate: 64 by 64.
const SIDE: u32 = 64;

fn diffuse() -> Claim {
    let means =
        || INDICES.map(f64::from).map(walsh).as_flattened().iter().map(|&f| about(f)).collect::<Vec<_>>();
    let sampled = |i: usize, seed: u64, height: fn(f32) -> f32| {
        let glass = boundary(INDICES[i / 2]);
        let bsdf = glass.bsdf([0.0; 2]);
        let side = if i.is_multiple_of(2) { 1.0 } else { -1.0 };
        jittered::mean(seed, SIDE, |_, share| {
            let z = height(share);
            f64::from(bsdf.branch_probability_fresnel(Vec3::new((1.0 - z * z).sqrt(), 0.0, side * z)))
        })
    };
    // The share of light below a height: z² of what follows the cosine, z of what is uniform.
    let cosine: fn(f32) -> f32 = f32::sqrt;
    let uniform: fn(f32) -> f32 = |share| share;
    claim(
        "fresnel/diffuse/mean",
        "diffuse light is reflected as Walsh's closed form says, from outside and inside",
    )
    .rejects("2.2 × resolution", move |run| joint_control(&means(), run, |i, seed| sampled(i, seed, cosine)))
    .rejects("uniform directions", move |run| {
        joint_evidence(&means(), run, |i, seed| sampled(i, seed, uniform))
    })
    .rejects("index 1 % too large", move |run| {
        let means: Vec<_> =
            INDICES.map(|n| walsh(1.01 * f64::from(n))).as_flattened().iter().map(|&f| about(f)).collect();
        joint_evidence(&means, run, |i, seed| sampled(i, seed, cosine))
    })
    .by(move |run| joint_evidence(&means(), run, |i, seed| sampled(i, seed, cosine)))
}

/// Cosines from outside and inside at which the choice of a branch is counted, and indices.
const COSINES: [[f32; 2]; 5] = [[1.0, 3.0], [0.5, 2.0], [0.1, 1.5], [-0.9, 2.0], [-0.76, 1.5]];

fn choice() -> Claim {
    let exact = |[z, eta]: [f32; 2]| {
        let far = if z > 0.0 { f64::from(eta) } else { 1.0 / f64::from(eta) };
        // The closed form is 0/0 at normal incidence, where R is flat: 1e-7 less of a cosine changes it by less than that.
        closed_form::fresnel(f64::from(z.abs()).min(0.999_999_9), far)
    };
    let means = move || COSINES.map(|place| about(exact(place)));
    let reflected = |i: usize, seed: u64, scale: f32| {
        let [z, eta] = COSINES[i];
        let (wo, glass) = (Vec3::new((1.0 - z * z).sqrt(), 0.0, z), boundary(eta));
        let bsdf = glass.bsdf([0.0; 2]);
        // The third number alone decides; by itself it fills its range evenly.
        jittered::mean(seed, SIDE, |u, lobe| {
            f64::from(u8::from(bsdf.sample(wo, scale * lobe, u).is_some_and(|s| !s.transmitted)))
        })
    };
    claim(
        "fresnel/dielectric/choice",
        "one branch is reflected with the probability of its share of the power",
    )
    .rejects("2.2 × resolution", move |run| joint_control(&means(), run, |i, seed| reflected(i, seed, 1.0)))
    .rejects("one half each", move |run| {
        joint_evidence(&means().map(|mean| MeanClaim { exact: 0.5, ..mean }), run, |i, seed| {
            reflected(i, seed, 1.0)
        })
    })
    .rejects("numbers from 0 to 0.99", move |run| {
        joint_evidence(&means(), run, |i, seed| reflected(i, seed, 0.99))
    })
    .by(move |run| joint_evidence(&means(), run, |i, seed| reflected(i, seed, 1.0)))
}

/// Samples a replicate of the slab.
const SAMPLES: u32 = 256;

fn slab() -> ObjectSettings {
    thing(ShapeSettings::Cube, DAffine3::from_scale(DVec3::new(10.0, 10.0, 0.25)), glass(1.5))
}

fn pane() -> ObjectSettings {
    let sheet = DAffine3::from_scale(DVec3::new(10.0, 10.0, 1.0));
    thing(ShapeSettings::Rectangle, sheet, thin_glass(1.5))
}

/// Glass between an eye and a lamp of radiance 1, and before a lamp behind the eye.
fn scenes(glass: fn() -> ObjectSettings) -> Result<[Scene; 2], InputError> {
    let build = |lamp: ObjectSettings| {
        // Without roulette, which would only add noise: a branch of less than 1/64 is followed by chance as it is. An echo
        // has R = 0.04 times the light of the one before, so a hundred edges leave out 0.04^97 of it.
        let integrator = IntegratorSettings {
            max_depth: Some(100),
            rr_depth: 100,
            branch: renderer::scene::Branch::Both,
            ..IntegratorSettings::PATH
        };
        Scene::new(&spot(
            DVec3::new(0.1, 0.2, -3.0),
            DVec3::new(0.1, 0.2, 0.0),
            vec![glass(), lamp],
            integrator,
        ))
        .map_err(subject)
    };
    let behind = rectangle_at(DVec3::new(0.0, 0.0, 3.0), DVec3::X, -DVec3::Y);
    let at_the_eye = rectangle_at(DVec3::new(0.0, 0.0, -6.0), DVec3::X, DVec3::Y);
    Ok([build(lamp(ShapeSettings::Rectangle, behind))?, build(lamp(ShapeSettings::Rectangle, at_the_eye))?])
}

fn through(id: &str, what: &str, glass: fn() -> ObjectSettings) -> Claim {
    let of = move |single_face: f64, run: &Run| -> Result<Evidence, InputError> {
        let [reflected, through] = both_faces(single_face);
        let scenes = scenes(glass)?;
        joint_evidence(&[about(through), about(reflected)], run, |i, seed| {
            radiance(&scenes[i], SAMPLES, seed)
        })
    };
    let face: f64 = 0.04; // ((1.5 − 1)/(1.5 + 1))²
    claim(id, format!("{what} lets (1 − R)/(1 + R) through and reflects 2R/(1 + R), with all its echoes"))
        .rejects("2.2 × resolution", move |run| {
            let scenes = scenes(glass)?;
            let [reflected, through] = both_faces(face);
            joint_control(&[about(through), about(reflected)], run, |i, seed| {
                radiance(&scenes[i], SAMPLES, seed)
            })
        })
        .rejects("one face", move |run| of(face / (2.0 - face), run))
        .rejects("R 1 % too large", move |run| of(1.01 * face, run))
        .by(move |run| of(face, run))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walsh_is_the_integral_of_fresnel() {
        let n = 200_000;
        for index in INDICES.map(f64::from) {
            for (exact, far) in walsh(index).into_iter().zip([index, 1.0 / index]) {
                let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
                let mean =
                    (0..n).map(|i| closed_form::fresnel(at(i).sqrt(), far)).sum::<f64>() / f64::from(n);
                // Midpoint rule; at the critical angle and at grazing R ends like a root: h^1.5 = 1e-8 times a slope of 10.
                assert!((mean - exact).abs() < 1e-7, "{index}: {mean} {exact}");
            }
        }
    }
}
