//! Microfacets of rough boundaries, panes, and the body under a coat.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec3, Vec3};
use renderer::materials::fresnel;
use renderer::materials::{Beckmann, Branch, Ggx, Material};
use renderer::math::Rgb;

use super::super::lobe::closed_form::Normals;
use super::Entry;
use super::numbers::rounded;
use super::reflection;
use super::routine::{ROUNDING, Routine, roundings, single};
use super::tables;
use crate::setup::{ground_glass, pane};

pub(super) fn entries() -> Vec<Entry> {
    vec![BECKMANN.into(), VISIBLE.into(), GROUND_GLASS.into(), PANE.into(), BODY.into()]
}

/// The exponent of Beckmann's distribution.
fn exponent([x, y, z, ax, ay]: &[f64; 5]) -> f64 {
    ((x / ax).powi(2) + (y / ay).powi(2)) / (z * z)
}

const BECKMANN: Routine<5, 2> = Routine {
    id: "beckmann/alpha-1e-5-to-1",
    says: "Beckmann's D and G₁ keep their digits for roughness 1e-5 to 1, at the pole, a step off it, and at grazing",
    unit: "roundings of 2⁻²⁴, for D times 1 + its exponent",
    // D: the exponent has quotients 1, squares 3, sum 4, z² and quotient 2: 6 of itself; exp 2, πα²z⁴ 6½, quotient 1. G₁: the
    // slope 4, of which erf and exp keep at most all, both and their sum 5, products 2.
    bound: 12.0,
    // An exponential of less than the smallest number counts as that.
    one: |x, [d, g1]| {
        let [_, _, z, ax, ay] = x;
        let least = f64::from(f32::from_bits(1)) / (PI * ax * ay * z.powi(4));
        let exponent = if *d > 0.0 { exponent(x) } else { 0.0 };
        [(ROUNDING * d * (1.0 + exponent)).max(least), ROUNDING * g1]
    },
    table: tables::BECKMANN,
    corners: &[[0.0, 0.0, 1.0, 1e-5, 1e-5], [3.4e-4, 0.0, 0.999_999_940_395_355_2, 1e-4, 1e-4]],
    draw: |n| {
        let [ax, ay] = [n.log(1e-5, 1.0), n.log(1e-5, 1.0)];
        let grazing = std::f64::consts::FRAC_PI_2 - n.log(1e-8, 1.0);
        let theta = n.one_of([ax * n.log(1e-2, 3.0), grazing]);
        let [x, y, z] = rounded(n.at_angle(theta));
        [x, y, z.max(1e-18), f64::from(single(ax)), f64::from(single(ay))]
    },
    draws: 2048,
    exact: |[x, y, z, ax, ay]| {
        let (normals, w) = (Normals::Beckmann([*ax, *ay]), DVec3::new(*x, *y, *z));
        [normals.d(w), normals.g1(w)]
    },
    ours: |x| {
        let [x, y, z, ax, ay] = x.map(single);
        let (facets, w) = (Beckmann { alpha: [ax, ay] }, Vec3::new(x, y, z));
        [facets.d(w), facets.g1(w)].map(f64::from)
    },
    naive: ("sin² by 1 − cos², G₁ by a rational approximation", |x| {
        let [x, y, z, ax, ay] = x.map(single);
        let (cos2, sin2) = (z * z, 1.0 - z * z);
        let turn = x * x / (x * x + y * y).max(f32::MIN_POSITIVE);
        let tan2 = sin2 / cos2;
        let e = tan2 * (turn / (ax * ax) + (1.0 - turn) / (ay * ay));
        let d = (-e).exp() / (std::f32::consts::PI * ax * ay * cos2 * cos2);
        // Walter, Marschner, Li, Torrance 2007, equation 27.
        let a = 1.0 / (tan2 * (turn * ax * ax + (1.0 - turn) * ay * ay)).sqrt();
        let near = (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a);
        [d, if a < 1.6 { near } else { 1.0 }].map(f64::from)
    }),
};

/// A visible normal of GGX: its slopes, and what one unit of error is for both.
fn visible([x, y, z, ax, ay, turn, height]: &[f64; 7]) -> ([f64; 2], f64) {
    let seen = DVec3::new(ax * x, ay * y, *z).normalize();
    let below = height * (1.0 + seen.z);
    let radius = (below * (2.0 - below)).sqrt();
    let (sin, cos) = (TAU * turn).sin_cos();
    let up = (1.0 - height) * (1.0 + seen.z);
    let slopes = [ax * (radius * cos + seen.x) / up, ay * (radius * sin + seen.y) / up];
    (slopes, (radius + seen.truncate().length()) / up)
}

const VISIBLE: Routine<7, 2> = Routine {
    id: "ggx/visible-normals",
    says: "visible normals of GGX keep their slopes' digits for roughness 1e-5 to 1, up to the last number",
    unit: "roundings of 2⁻²⁴ of the slope's two parts",
    // The direction stretched 5, both factors under the root 7, of which it keeps 7 and adds 1; the azimuth 1½ of 2π at most;
    // sine 2, product and sum 2; the height 6; scaling, normalisation and their quotient 4.
    bound: 32.0,
    one: |x, _| [x[3], x[4]].map(|alpha| ROUNDING * alpha * visible(x).1),
    table: tables::NONE,
    corners: &[
        [0.0, 0.0, 1.0, 1e-5, 1e-5, 0.5, 0.999_999_940_395_355_2],
        [0.6, 0.0, 0.8, 1e-4, 1.0, 0.3, 0.999_999_940_395_355_2],
    ],
    draw: |n| {
        let w =
            rounded(n.at_angle(n.one_of([n.log(1e-5, 1.0), std::f64::consts::FRAC_PI_2 - n.log(1e-5, 1.0)])));
        let [ax, ay] = [n.log(1e-5, 1.0), n.log(1e-5, 1.0)].map(|a| f64::from(single(a)));
        [w[0], w[1], w[2].max(1e-9), ax, ay, n.unit(), n.sampler()].map(|x| f64::from(single(x)))
    },
    draws: 2048,
    exact: |x| visible(x).0,
    ours: |x| {
        let [x, y, z, ax, ay, turn, height] = x.map(single);
        let m = Ggx { alpha: [ax, ay] }.sample_visible(Vec3::new(x, y, z), [turn, height]).as_dvec3();
        [m.x / m.z, m.y / m.z]
    },
    naive: ("2 − x by difference", |x| {
        let [x, y, z, ax, ay, turn, height] = x.map(single);
        let seen = Vec3::new(ax * x, ay * y, z).normalize();
        let below = height * (1.0 + seen.z);
        let radius = (below * (2.0 - below)).sqrt();
        let (sin, cos) = (std::f32::consts::TAU * turn).sin_cos();
        let up = (1.0 - height) * (1.0 + seen.z);
        [ax * (radius * cos + seen.x) / up, ay * (radius * sin + seen.y) / up].map(f64::from)
    }),
};

/// The directions, the one above the surface first, and whether that is where light is seen from.
fn sides(x: &[f64; 8]) -> ([DVec3; 2], bool) {
    let [o, i] = [DVec3::new(x[0], x[1], x[2]), DVec3::new(x[3], x[4], x[5])];
    if o.z > 0.0 { ([o, i], true) } else { ([i, o], false) }
}

fn glass(x: &[f64; 8]) -> Arc<Material> {
    ground_glass(Ggx { alpha: [single(x[6]); 2] }.into(), single(x[7]))
}

const GROUND_GLASS: Routine<8, 2> = Routine {
    id: "ground-glass/critical",
    says: "what ground glass refracts is right to its last digits, from both sides, down to cosines of 1e-3 beside the critical angle",
    unit: "roundings of 2⁻²⁴",
    bound: 36.0, // D 10½ and 4 of its normal, which is rounded once; two shadowings 5½ each; three products and the rest 4 more.
    one: roundings,
    table: tables::GROUND_GLASS,
    corners: &[],
    draw: |n| {
        let eta = f64::from(single(n.log(1.01, 4.0)));
        let alpha = f64::from(single(n.log(1e-3, 1.0)));
        let cos = n.log(1e-3, 1.0);
        let h = n.at_angle((alpha * n.log(1e-2, 2.0)).min(1.4));
        let t = h.cross(n.direction()).normalize();
        let t = if t.z < 0.0 { -t } else { t };
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        let a = cos * h + sin * t;
        let b = -(1.0 - (sin / eta).powi(2)).sqrt() * h - sin / eta * t;
        let [o, i] = if n.sign() > 0.0 { [a, b] } else { [b, a] };
        let (o, i) = (rounded(o), rounded(i));
        [o[0], o[1], o[2], i[0], i[1], i[2], alpha, eta]
    },
    draws: 2048,
    exact: |x| {
        let ([a, b], from_above) = sides(x);
        let (normals, eta) = (Normals::Ggx([x[6]; 2]), x[7]);
        let sum = a + eta * b;
        let h = sum.normalize() * sum.z.signum();
        let [ca, cb] = [a.dot(h), -b.dot(h)];
        if ca <= 0.0 || cb <= 0.0 {
            return [0.0; 2];
        }
        // 1 − r² of both polarisations' amplitudes.
        let passed = |near: f64, far: f64| 4.0 * near * far / (near + far).powi(2);
        let t = 0.5 * (passed(ca, eta * cb) + passed(eta * ca, cb));
        let both = t * normals.d(h) * ca * cb / sum.length_squared();
        let [ga, gb] = [normals.g1(a) / a.z, normals.g1(-b) / -b.z];
        let (seen, carried) = if from_above { (ga, eta * eta) } else { (gb, 1.0) };
        [both * ga * gb * (eta * eta / carried), both * seen * carried]
    },
    ours: |x| {
        let w = x.map(single);
        let (wo, wi) = (Vec3::new(w[0], w[1], w[2]), Vec3::new(w[3], w[4], w[5]));
        let glass = glass(x);
        let bsdf = glass.bsdf([0.0; 2]);
        [bsdf.eval(wo, wi).g, bsdf.pdf(wo, wi)].map(f64::from)
    },
    naive: ("h and Snell's law from one cosine in single precision", |x| {
        let w = x.map(single);
        let (wo, wi, eta) = (Vec3::new(w[0], w[1], w[2]), Vec3::new(w[3], w[4], w[5]), w[7]);
        let (wo, wi, eta) = if wo.z < 0.0 { (-wo, -wi, 1.0 / eta) } else { (wo, wi, eta) };
        let (ggx, sum) = (Ggx { alpha: [w[6]; 2] }, wo + eta * wi);
        let h = sum.normalize() * sum.z.signum();
        let t = fresnel::dielectric(wo.dot(h).clamp(0.0, 1.0), eta).transmittance;
        let both = t * ggx.d(h) * wo.dot(h) * -wi.dot(h) / sum.length_squared();
        let [go, gi] = [ggx.g1(wo) / wo.z, ggx.g1(-wi) / -wi.z];
        [both * go * gi, both * go * eta * eta].map(f64::from)
    }),
};

const PANE: Routine<2, 2> = Routine {
    id: "pane/everywhere",
    says: "what a window pane reflects and lets pass keeps its digits for any index, also at grazing and where hardly any passes",
    unit: "roundings of 2⁻²⁴",
    bound: 3.6, // Fresnel's share 1, half of it and 1 in the sum, the quotient 1.
    one: roundings,
    table: tables::NONE,
    corners: &[[1.0, 1.5], [1e-30, 1.5], [1e-3, 1e3], [0.5, 1e-3]],
    draw: |n| {
        let cos = n.one_of([n.unit().max(1e-9), n.log(1e-30, 1.0)]);
        [cos, n.one_of([n.log(1e-3, 1e3), 1.0 + n.log(1e-6, 1.0)])].map(|x| f64::from(single(x)))
    },
    draws: 2048,
    exact: |x| {
        let [r, t, _] = (reflection::DIELECTRIC.exact)(x);
        [2.0 * r / (1.0 + r), t / (1.0 + r)]
    },
    ours: |[cos, eta]| {
        let pane = pane(single(*eta), 1.0);
        let wo = Vec3::new(single(((1.0 - cos) * (1.0 + cos)).sqrt()), 0.0, single(*cos));
        [Branch::Reflect, Branch::Refract].map(|branch| {
            let sample = pane.bsdf([0.0; 2]).sample_branch(wo, branch, [0.0; 2]);
            sample.map_or(0.0, |s| f64::from(s.weight.g))
        })
    },
    naive: ("the rest of 1, in single precision", |x| {
        let [cos, eta] = x.map(single);
        let r = fresnel::dielectric(cos, eta).reflectance;
        let reflected = r + (1.0 - r) * (1.0 - r) * r / (1.0 - r * r).max(f32::MIN_POSITIVE);
        [reflected, 1.0 - reflected].map(f64::from)
    }),
};

/// The share of diffuse light that a smooth boundary to an index of n > 1 reflects.
///
/// # Source
/// Walsh 1926, as in Egan, Hilgeman 1979: Optical Properties of Inhomogeneous Materials.
fn walsh(n: f64) -> f64 {
    let (n2, n4) = (n * n, n.powi(4));
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln()
}

/// The body's value along the normal from its reflectance, the index, and what escapes of diffuse light inside.
fn body(rho: f64, eta: f64, escaping: f64) -> f64 {
    let passed = 1.0 - ((eta - 1.0) / (eta + 1.0)).powi(2);
    passed * passed / (PI * eta * eta) * rho / ((1.0 - rho) + rho * escaping)
}

const BODY: Routine<2, 1> = Routine {
    id: "plastic/white-body",
    says: "a body under a coat, white or not, reflects what all its internal reflections add up to, for indices up to 10",
    unit: "relative error",
    bound: 5e-6, // What escapes is promised to 1e-6 of what enters, which is 0.29 at an index of 10; some ten roundings.
    one: |_, exact| *exact,
    table: tables::NONE,
    corners: &[[1.0, 1.49], [1.0, 10.0]],
    draw: |n| [1.0 - n.one_of([0.0, n.log(1e-7, 1.0)]), n.log(1.02, 10.0)].map(|x| f64::from(single(x))),
    draws: 64,
    exact: |[rho, eta]| [body(*rho, *eta, (1.0 - walsh(*eta)) / (eta * eta))],
    ours: |[rho, eta]| {
        let (diffuse, specular) = (Rgb::splat(single(*rho)).into(), Rgb::BLACK.into());
        let plastic = Material::new_plastic(single(*eta), true, diffuse, specular);
        [plastic.map_or(f64::NAN, |m| f64::from(m.bsdf([0.0; 2]).eval(Vec3::Z, Vec3::Z).g))]
    },
    // A fit that renderers use, as good as 0.0005 at usual indices.
    naive: ("1 − ρF by difference, F by a fit", |[rho, eta]| {
        let f = -1.4399 / (eta * eta) + 0.7099 / eta + 0.6681 + 0.0636 * eta;
        [body(*rho, *eta, 1.0 - f)]
    }),
};
