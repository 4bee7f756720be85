//! Sampled directions against the closed forms of their densities, seen from above and at a grazing angle.

use glam::{DMat3, DVec3, Vec3};
use renderer::materials::{Beckmann, Branch, Bsdf, Facets, Ggx, Lobe};
use verify::chi_square::ChiSquare;
use verify::claim::{Claim, Level};
use verify::domain::Directions;

use super::super::pointwise::single;
use super::{BLUR, BROAD, ETA, EXPONENT, PHONG, SHARP};
use super::{
    beckmann, blurred, brushed, closed_form, diffuse, frame_of, ggx, ideal, normals, phong, plain, towards,
};
use crate::{bounds, setup, wrong};

pub(super) fn claims() -> Vec<Claim> {
    let mut list = vec![diffuse_lobe(), phong_from_above(), phong_grazing()];
    list.push(rough("lobe/ggx-sharp/from-above", SHARP, 1.0));
    list.push(rough("lobe/ggx-sharp/grazing", SHARP, 0.2));
    list.push(rough("lobe/ggx-broad/from-above", BROAD, 1.0));
    list.push(rough("lobe/ggx-broad/grazing", BROAD, 0.2));
    list.push(blur_disk("lobe/blur-reflection/from-above", Branch::Reflect, 1.0));
    list.push(blur_disk("lobe/blur-reflection/grazing", Branch::Reflect, 0.2));
    list.push(blur_disk("lobe/blur-refraction/from-above", Branch::Refract, 1.0));
    // From inside, where the refracted direction is 0.2 above the surface: sin θ = √(1 − 0.2²)/1.5.
    list.push(blur_disk("lobe/blur-refraction/grazing", Branch::Refract, -(1.0 - 0.96 / 2.25_f64).sqrt()));
    for cos in [1.0, 0.2] {
        list.push(microfacets("beckmann", beckmann(), Beckmann { alpha: [1.1 * BROAD; 2] }.into(), cos));
        list.push(microfacets("ggx-brushed", brushed(), Ggx { alpha: [0.22, 0.66] }.into(), cos));
    }
    list.extend([0.9, -0.8].map(ground_glass));
    list.extend([("plastic", None), ("rough-plastic", Some(brushed()))].map(plastic));
    list
}

/// Where a lobe is seen from, as claims are called.
fn view(cos: f64) -> &'static str {
    match cos {
        c if c < 0.0 => "inside",
        c if c < 0.5 => "grazing",
        _ => "from-above",
    }
}

fn microfacets(name: &str, facets: Facets, rougher: Facets, cos: f64) -> Claim {
    let wo = towards(cos);
    let exact = normals(facets);
    let density = move |wi| exact.mirrored(wo.as_dvec3(), wi);
    let of = |facets| direction(plain(setup::mirror_of(facets, 1.0)), wo);
    let (wrong, other) = (of(rougher), of(Ggx { alpha: [BROAD; 2] }.into()));
    test(Directions::hemisphere(), DMat3::IDENTITY, density, of(facets))
        .rejects("10 % rougher", move |u: [f64; 2]| wrong(u).map(|w| w.to_array().map(f64::from)))
        .rejects("round GGX", move |u: [f64; 2]| other(u).map(|w| w.to_array().map(f64::from)))
        .claim(
            format!("lobe/{name}/{}", view(cos)),
            format!("directions follow the visible normals of {name}, cos θₒ = {cos}"),
        )
        .from_level(Level::Standard)
}

/// The direction that a BSDF of several lobes samples; one of finitely many is left out.
fn any_direction(
    bsdf: Bsdf<'static>,
    wo: Vec3,
) -> impl Fn([f64; 3]) -> Option<Vec3> + Copy + Send + Sync + 'static {
    move |[lobe, u, v]| {
        let sample = bsdf.sample(wo, single(lobe), [u, v].map(single))?;
        (sample.lobe == Lobe::Spread).then_some(sample.wi)
    }
}

fn ground_glass(cos: f64) -> Claim {
    let wo = towards(cos);
    let exact = normals(beckmann());
    let density = move |wi| exact.through(f64::from(ETA), wo.as_dvec3(), wi);
    let of = |facets, eta| any_direction(plain(setup::ground_glass(facets, eta)), wo);
    let rougher = of(Beckmann { alpha: [1.1 * BROAD; 2] }.into(), ETA);
    let denser = of(beckmann(), 1.1 * ETA);
    test(Directions::sphere(), DMat3::IDENTITY, density, of(beckmann(), ETA))
        .rejects("10 % rougher", move |u: [f64; 3]| rougher(u).map(|w| w.to_array().map(f64::from)))
        .rejects("index 10 % too large", move |u: [f64; 3]| denser(u).map(|w| w.to_array().map(f64::from)))
        .defect_in(1) // of the facets; the first number chooses between reflection and refraction
        .claim(
            format!("lobe/ground-glass/{}", view(cos)),
            format!("directions are visible facets' mirrored and refracted ones, cos θₒ = {cos}"),
        )
        .from_level(Level::Standard)
}

/// Plastic's density, which `lobe/*/pdf` and `material/*/agreement` hold to its form, is that of its directions.
fn plastic((name, coat): (&str, Option<Facets>)) -> Claim {
    let wo = towards(0.5);
    let of = |specular: f32| plain(setup::plastic([0.5, specular], coat));
    let bsdf = of(1.0);
    let density = move |wi: DVec3| f64::from(bsdf.pdf(wo, wi.as_vec3()));
    let other = any_direction(of(0.5), wo);
    test(Directions::hemisphere(), DMat3::IDENTITY, density, any_direction(bsdf, wo))
        .rejects("half as many mirrored", move |u: [f64; 3]| other(u).map(|w| w.to_array().map(f64::from)))
        .rejects("uniform directions of the body", |[_, u, v]: [f64; 3]| {
            Some(wrong::hemisphere_uniform([u, v]))
        })
        .defect_in(1) // of the direction; the first number chooses between coat and body
        .claim(format!("lobe/{name}/from-above"), format!("directions of {name} follow its density"))
        .from_level(Level::Standard)
}

/// A test of directions in the frame of the domain; directions that are dropped are `None`.
fn test<const N: usize>(
    domain: Directions,
    frame: DMat3,
    density: impl Fn(DVec3) -> f64 + Send + Sync + 'static,
    sample: impl Fn([f64; N]) -> Option<Vec3> + Send + Sync + 'static,
) -> ChiSquare<Directions> {
    let to_frame = frame.transpose();
    ChiSquare::on(domain)
        .density(move |w| density(frame * DVec3::from(w)))
        .samples(move |u| sample(u).map(|w| (to_frame * w.as_dvec3()).to_array()))
        .bound(bounds::LOBE)
}

/// The direction that a BSDF of one lobe samples.
fn direction(
    bsdf: Bsdf<'static>,
    wo: Vec3,
) -> impl Fn([f64; 2]) -> Option<Vec3> + Copy + Send + Sync + 'static {
    move |u| bsdf.sample(wo, 0.0, u.map(single)).map(|s| s.wi)
}

fn diffuse_lobe() -> Claim {
    let sample = direction(diffuse(), towards(0.5));
    test(Directions::hemisphere(), DMat3::IDENTITY, closed_form::diffuse, sample)
        .rejects("point of the ball in the place of the sphere", |u: [f64; 3]| {
            Some(wrong::diffuse_from_ball(u))
        })
        .rejects("uniform directions", |u: [f64; 2]| Some(wrong::hemisphere_uniform(u)))
        .claim("lobe/diffuse/from-above", "directions of the diffuse lobe follow cos θ/π")
}

fn rough(id: &'static str, alpha: f32, cos: f64) -> Claim {
    let wo = towards(cos);
    let (alpha_64, wo_64) = (f64::from(alpha), wo.as_dvec3());
    let density = move |wi| closed_form::ggx(alpha_64, wo_64, wi);
    let sample = direction(ggx(alpha), wo);
    let rougher = direction(ggx(1.1 * alpha), wo);
    let mut test = test(Directions::hemisphere(), DMat3::IDENTITY, density, sample)
        .rejects("10 % rougher", move |u: [f64; 2]| rougher(u).map(|w| w.to_array().map(f64::from)));
    if cos < 1.0 {
        // From above all normals of the model are seen alike.
        test = test.rejects("normals that are not seen as well", move |u: [f64; 2]| {
            wrong::ggx_by_all_normals(u, alpha_64, wo_64.to_array())
        });
    }
    test.claim(id, format!("directions follow the visible normals of GGX, α = {alpha}, cos θₒ = {cos}"))
}

fn phong_from_above() -> Claim {
    let (wo, share) = (towards(1.0), f64::from(PHONG[1] / (PHONG[0] + PHONG[1])));
    let bsdf = phong(PHONG, f32::from(EXPONENT));
    let density = move |wi| {
        share * closed_form::highlight(EXPONENT.into(), wo.as_dvec3(), wi)
            + (1.0 - share) * closed_form::diffuse(wi)
    };
    let sample =
        move |[lobe, u, v]: [f64; 3]| bsdf.sample(wo, single(lobe), [u, v].map(single)).map(|s| s.wi);
    test(Directions::hemisphere(), DMat3::IDENTITY, density, sample)
        .rejects("lobes chosen with equal probability", |[lobe, u, v]: [f64; 3]| {
            let highlight = wrong::phong_with_exponent([u, v], f64::from(EXPONENT) + 1.0);
            Some(if lobe < 0.5 { highlight } else { wrong::hemisphere_cosine([u, v]) })
        })
        .defect_in(2) // of the azimuth, which both lobes share when seen from above
        .claim("lobe/phong/from-above", "directions follow the mixture of Phong's highlight and cos θ/π")
}

fn phong_grazing() -> Claim {
    let wo = towards(0.2);
    let density = move |wi| closed_form::highlight(EXPONENT.into(), wo.as_dvec3(), wi);
    let highlight = |exponent: f32| direction(phong([0.0, 0.5], exponent), wo);
    let sharper = highlight(1.1 * f32::from(EXPONENT));
    let right = highlight(f32::from(EXPONENT));
    test(Directions::hemisphere(), DMat3::IDENTITY, density, right)
        .rejects("exponent 10 % too large", move |u: [f64; 2]| {
            sharper(u).map(|w| w.to_array().map(f64::from))
        })
        .rejects("highlight about the normal", |u: [f64; 2]| {
            Some(wrong::phong_with_exponent(u, f64::from(EXPONENT) + 1.0))
        })
        // The same directions in the same proportions, but too many of them.
        .rejects("another direction for one below the surface", move |[a, b, c, d]: [f64; 4]| {
            right([a, b]).or_else(|| right([c, d])).map(|w| w.to_array().map(f64::from))
        })
        .claim(
            "lobe/phong/grazing",
            "directions follow Phong's highlight, which the surface cuts, at cos θₒ = 0.2",
        )
}

/// The cone of a blur disk about its ideal direction.
fn blur_disk(id: &'static str, branch: Branch, cos: f64) -> Claim {
    let wo = towards(cos);
    let (f, r) = (f64::from(BLUR), ideal(wo, branch));
    let bsdf = blurred(Some(ETA));
    let frame = frame_of(r);
    let normal = frame.transpose() * DVec3::Z * r.z.signum();
    let kept = move |w: [f64; 3]| (normal.dot(DVec3::from(w)) > 0.0).then_some(w);
    let sample = move |u: [f64; 2]| bsdf.sample_branch(wo, branch, u.map(single)).map(|s| s.wi);
    test(Directions::cone(f.atan()), frame, move |wi| closed_form::blur(f, r, wi), sample)
        .rejects("uniform directions of the cone", move |u: [f64; 2]| kept(wrong::cone_uniform(u, f.atan())))
        .rejects("disk 2 % too small", move |u: [f64; 2]| {
            kept(on_disk(wrong::rectangle_as_disk(u), 0.98 * f))
        })
        .rejects("disk without square root", move |u: [f64; 2]| kept(on_disk(wrong::disk_without_root(u), f)))
        .claim(id, format!("directions are those of a uniform disk across the ideal one, cos θₒ = {cos:.3}"))
}

/// The direction to a point of the disk of radius `f` at distance 1.
fn on_disk([x, y]: [f64; 2], f: f64) -> [f64; 3] {
    DVec3::new(f * x, f * y, 1.0).normalize().to_array()
}
