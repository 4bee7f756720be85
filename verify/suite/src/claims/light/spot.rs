//! The cone of a spot.

use glam::DVec3;
use renderer::accel::Accel;
use renderer::lights::{Light, Spot};
use renderer::math::Rgb;
use verify::claim::{Claim, Level, claim};

use super::super::lobe::anywhere;
use super::super::pointwise::{EPSILON, never, rejecting};
use super::eye;

pub(super) fn claims() -> Vec<Claim> {
    vec![cone().from_level(Level::Standard)]
}

/// Where the spot is, the middle of its cone, and its angles in degrees.
const POSITION: DVec3 = DVec3::new(0.5, -1.0, 2.0);
const AXIS: DVec3 = DVec3::new(0.36, 0.48, -0.8);
const ANGLES: [f32; 2] = [25.0, 60.0];

/// The share of the intensity at an angle [radians].
fn falloff(angle: f64) -> f64 {
    let [beam, cutoff] = ANGLES.map(|a| f64::from(a).to_radians());
    ((cutoff - angle) / (cutoff - beam)).clamp(0.0, 1.0)
}

/// The same, linear in the cosine.
fn by_cosine(angle: f64) -> f64 {
    let [beam, cutoff] = ANGLES.map(|a| f64::from(a).to_radians().cos());
    ((angle.cos() - cutoff) / (beam - cutoff)).clamp(0.0, 1.0)
}

fn cone() -> Claim {
    let light = move || {
        let spot = Spot::new(POSITION.as_vec3(), AXIS.as_vec3(), Rgb::splat(3.0), ANGLES);
        Light::Spot(spot.expect("angles in order"))
    };
    let nothing = || Accel::new(Vec::new(), [0.0; 2]);
    let misses = |light: &Light, accel: &Accel, [u, v, d]: [f64; 3], share: fn(f64) -> f64| {
        let distance = 0.5 + 4.0 * d;
        let from = eye(POSITION + distance * anywhere([u, v]).as_dvec3());
        let to = from.surface.point.as_dvec3() - POSITION;
        let angle = AXIS.normalize().dot(to.normalize()).clamp(-1.0, 1.0).acos();
        let exact = 3.0 * share(angle) / to.length_squared();
        let got = light.sample(accel, &from, [0.0; 2]).map_or(0.0, |s| f64::from(s.radiance.g));
        // Positions of up to 6 are rounded by 2⁻²², which turns the direction by that over the distance; the intensity
        // falls over 0.61 radians.
        let rounding = 64.0 * EPSILON * (1.0 + 1.0 / distance) * 3.0 / to.length_squared();
        (got - exact).abs() > rounding
    };
    let says = "a spot's light is its intensity over the squared distance, and falls with the angle from the beam to the cutoff";
    let mut builder = claim("light/spot/cone", says);
    let whole: fn(f64) -> f64 = |a| f64::from(u8::from(falloff(a) > 0.0));
    let controls =
        [("falling with the cosine", by_cosine as fn(f64) -> f64), ("whole up to the cutoff", whole)];
    for (name, share) in controls {
        let (light, accel) = (light(), nothing());
        builder = rejecting(builder, name, move |u| misses(&light, &accel, u, share));
    }
    let (light, accel) = (light(), nothing());
    never(builder, "share of places with other light", move |u| misses(&light, &accel, u, falloff))
}
