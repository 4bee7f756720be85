//! Densities of points on lights: per area, per steradian, and all of them together.

use glam::DVec3;
use renderer::accel::Accel;
use renderer::lights::{AreaLight, LightSampling};
use renderer::ray::Ray;
use verify::claim::{Claim, Evidence, Level, Run, claim};
use verify::error::InputError;
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::super::jittered;
use super::super::pointwise::{EPSILON, never, rejecting, rejecting_subtle, same_density, single};
use super::{Lamp, eye, light};
use crate::bounds;

/// A density as the renderer has it, and the cosine at the light: a control changes it.
type Spoil = fn(f64, f64) -> f64;

/// Both claims on a light, from the standard level on.
pub(super) fn later(lamp: Lamp) -> [Claim; 2] {
    [pdf(lamp.clone()), solid_angle(lamp)].map(|claim| claim.from_level(Level::Standard))
}

/// The claim that a light's densities are those of its area.
pub(super) fn pdf(lamp: Lamp) -> Claim {
    let accel = lamp.alone();
    let says = format!(
        "the density of a point on a light ({}) is 1/A per area and d²/(A·cos θ') per steradian, by sampling and by hitting it",
        lamp.name
    );
    let mut builder = claim(format!("light/{}/pdf", lamp.name), says);
    let spoils: [(&'static str, Spoil); 2] =
        [("area 1 % too large", |pdf, _| pdf / 1.01), ("cosine at the light left out", |pdf, cos| pdf * cos)];
    for (name, spoil) in spoils {
        let (lamp, accel) = (lamp.clone(), lamp.alone());
        builder = rejecting(builder, name, move |u| misses(&lamp, &accel, u, spoil));
    }
    let (subtle, alone) = (lamp.clone(), lamp.alone());
    let area: Spoil = |pdf, _| pdf / 1.000_01;
    builder = rejecting_subtle(builder, "area 1e-5 too large", move |u| misses(&subtle, &alone, u, area));
    never(builder, "share of points with another density", move |u| misses(&lamp, &accel, u, |pdf, _| pdf))
}

fn misses(lamp: &Lamp, accel: &Accel, [u, v, place]: [f64; 3], spoil: Spoil) -> bool {
    let u = [u, v].map(single);
    let from = eye(lamp.views[0].0.lerp(lamp.views[1].0, place));
    let (target, per_area) = accel.objects()[0].sample_area(u, 0.0);
    let origin = from.surface.point.as_dvec3();
    let to = target.point.as_dvec3() - origin;
    let distance = to.length();
    let cos = -to.dot(target.ng.as_dvec3()) / distance;
    if !same_density(per_area, 1.0 / lamp.area, 4.0 * EPSILON) {
        return true; // a mesh's corners are rounded: 2 roundings of positions, of the area, of the density
    }
    let exact = spoil(distance * distance / (lamp.area * cos), cos);
    // Normal, direction and their product round a few times; along a bent surface the hit is beside the point by
    // distance·2⁻²⁴/cos θ', and its normal is turned by as much times the curvature.
    let tolerance = 32.0 * EPSILON * (1.0 + distance * lamp.bend) / (cos * cos);
    let Some(sample) = light(accel, LightSampling::Area).sample(accel, &from, u) else {
        return cos > 4.0 * EPSILON;
    };
    if cos <= 0.0 {
        return cos < -4.0 * EPSILON; // a point that faces away must not be taken
    }
    let found = found(&light(accel, LightSampling::Area), accel, origin, sample.wi.as_dvec3());
    let at_hit = found.is_some_and(|pdf| same_density(pdf, exact, tolerance));
    tolerance < 0.1 && !(same_density(sample.pdf, exact, tolerance) && at_hit)
}

/// The density of the point that a ray finds.
pub(super) fn found(light: &AreaLight, accel: &Accel, origin: DVec3, direction: DVec3) -> Option<f32> {
    let ray = Ray::new(origin.as_vec3(), direction.as_vec3(), 0.0);
    let mut hits = Vec::with_capacity(1);
    accel.closest(&[ray], &mut hits);
    let hit = (*hits.first()?)?;
    Some(light.pdf(accel, &ray, &hit, accel.interaction(&ray, &hit).surface.ng))
}

/// The claim that one over the density, averaged, is the solid angle of what is seen.
pub(super) fn solid_angle(lamp: Lamp) -> Claim {
    let says = format!(
        "one over the density of points on a light ({}) averages to the solid angle that it fills, from four places",
        lamp.name
    );
    let builder = claim(format!("light/{}/solid-angle", lamp.name), says);
    let (other, accel) = (lamp.clone(), lamp.alone());
    let builder = builder.rejects("cosine at the light left out", move |run| {
        mean_of(&other, &accel, run, |value, cos| value / cos)
    });
    let (same, accel) = (lamp.clone(), lamp.alone());
    builder
        .rejects("2.2 × resolution", move |run| {
            joint_control(&means(&same), run, |i, seed| mean_inverse(&same, &accel, i, seed, |x, _| x))
        })
        .by({
            let accel = lamp.alone();
            move |run| mean_of(&lamp, &accel, run, |value, _| value)
        })
}

fn means(lamp: &Lamp) -> [MeanClaim; 4] {
    // Each density rounds as in `misses`, near its own exact value; at most a few 2⁻²⁴ are common to all.
    lamp.views
        .map(|(_, exact)| MeanClaim { rounding: 1e-6, ..MeanClaim::relative(exact, bounds::SOLID_ANGLE) })
}

fn mean_of(lamp: &Lamp, accel: &Accel, run: &Run, spoil: Spoil) -> Result<Evidence, InputError> {
    joint_evidence(&means(lamp), run, |i, seed| mean_inverse(lamp, accel, i, seed, spoil))
}

/// The mean of 1/pdf over a replicate's points; those that face away count as 0.
fn mean_inverse(lamp: &Lamp, accel: &Accel, view: usize, seed: u64, spoil: Spoil) -> f64 {
    let (from, light) = (eye(lamp.views[view].0), light(accel, LightSampling::Area));
    jittered::mean(seed, lamp.side, |u, _| {
        let cos = |wi: glam::Vec3| f64::from(-wi.dot(accel.objects()[0].sample_area(u, 0.0).0.ng));
        light.sample(accel, &from, u).map_or(0.0, |s| spoil(1.0 / f64::from(s.pdf), cos(s.wi)))
    })
}
