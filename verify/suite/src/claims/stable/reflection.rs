//! Fresnel's equations, microfacets, half vectors, the blur disk.

use glam::{DVec3, Vec3};
use renderer::materials::Material;
use renderer::materials::fresnel;
use renderer::materials::microfacet::{Ggx, half_vector};
use renderer::math::Rgb;
use renderer::texture::Texture;

use super::Entry;
use super::numbers::{Numbers, rounded};
use super::routine::{Routine, roundings, single, ulp, ulps};
use super::tables;

pub(super) fn entries() -> Vec<Entry> {
    vec![
        DIELECTRIC.into(),
        Routine {
            id: "dielectric/critical",
            says: "Fresnel's equations are right to half a last place within an ulp of the critical angle",
            table: tables::NONE,
            draw: |n| {
                let eta = single(n.log(1.0001, 10.0));
                let inverse = 1.0 / f64::from(eta);
                let critical = single(((1.0 - inverse) * (1.0 + inverse)).sqrt());
                [f64::from(-near(n, critical)), f64::from(eta)]
            },
            ..DIELECTRIC
        }
        .into(),
        Routine {
            id: "dielectric/index-1",
            says: "Fresnel's equations are right to half a last place at indices 1 and 1 ± 1e-7",
            table: tables::NONE,
            draw: |n| {
                let eta = near(n, 1.0);
                [f64::from(single(n.sign() * n.log(1e-6, 1.0))), f64::from(eta)]
            },
            ..DIELECTRIC
        }
        .into(),
        Routine {
            id: "dielectric/grazing",
            says: "Fresnel's equations are right to half a last place down to cosines of 1e-30",
            table: tables::NONE,
            draw: |n| [n.sign() * n.log(1e-30, 1e-2), n.log(0.5, 3.0)].map(|x| f64::from(single(x))),
            ..DIELECTRIC
        }
        .into(),
        CONDUCTOR.into(),
        GGX.into(),
        HALF_VECTOR.into(),
        BLUR_DISK.into(),
    ]
}

/// A number up to three steps from `x`.
fn near(n: &Numbers, x: f32) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "−3 to 3")]
    let steps = n.between(-3.5, 3.5).round() as i32;
    f32::from_bits(x.to_bits().saturating_add_signed(steps))
}

/// Reflectance, transmittance, cosine of the refracted direction (0 on total reflection).
pub(super) const DIELECTRIC: Routine<2, 3> = Routine {
    id: "dielectric/everywhere",
    says: "Fresnel's reflectance, transmittance and refracted angle are right to half a last place, from both sides",
    unit: "ulp",
    bound: 0.51, // Half a last place by the rounding to f32; f64 before that adds 2⁻²⁹ for each of some ten roundings.
    one: ulps,
    table: tables::DIELECTRIC,
    corners: &[[1.0, 1.0], [-1.0, 1.5], [0.0, 1.5], [1e-38, 1.5]],
    draw: |n| {
        let cos = n.between(-1.0, 1.0);
        [cos, n.log(1e-3, 1e3)].map(|x| f64::from(single(x)))
    },
    draws: 4096,
    exact: |[cos, eta]| {
        let c = cos.abs();
        let far = if *cos < 0.0 { 1.0 / eta } else { *eta };
        // (η cos θ)² less (η² − 1), or cos² and (η² − 1): products of f32 numbers, of which the one that isn't exact is
        // not rounded before the difference.
        let beyond = (eta - 1.0) * (eta + 1.0);
        let q2 =
            if *cos < 0.0 { (c * eta).mul_add(c * eta, -beyond) / (eta * eta) } else { c.mul_add(c, beyond) };
        if q2 <= 0.0 || c == 0.0 {
            return [1.0, 0.0, 0.0];
        }
        // By amplitudes: r from (a − b)/(a + b), t from 1 − r² = 4ab/(a + b)², with a, b of c, q and of far·c, q/far. Both a − b
        // have the factor far² − 1 = q² − c², which is 1e-7 at an index as near to 1 and would lose 1e-9 as a difference.
        let (q, sum) = (q2.sqrt(), c + q2.sqrt());
        let apart = if *cos < 0.0 { beyond / (eta * eta) } else { beyond };
        let rs = apart / (sum * sum);
        let rp = apart * (c - 1.0 / sum) / (far * far * c + q);
        let passed = |a: f64, b: f64| 4.0 * (a / (a + b)) * (b / (a + b));
        [0.5 * (rs * rs + rp * rp), 0.5 * (passed(c, q) + passed(far * c, q / far)), q / far]
    },
    ours: |x| {
        let [cos, eta] = x.map(single);
        let at = fresnel::dielectric(cos, eta);
        [at.reflectance, at.transmittance, at.cos_t.unwrap_or(0.0)].map(f64::from)
    },
    naive: ("Snell's law and textbook quotients in single precision", |x| {
        let [cos, eta] = x.map(single);
        let far = if cos < 0.0 { 1.0 / eta } else { eta };
        let c = cos.abs();
        let sin2 = (1.0 - c * c) / (far * far);
        if sin2 >= 1.0 {
            return [1.0, 0.0, 0.0];
        }
        let t = (1.0 - sin2).sqrt();
        let (rs, rp) = ((c - far * t) / (c + far * t), (far * c - t) / (far * c + t));
        let r = 0.5 * (rs * rs + rp * rp);
        [r, 1.0 - r, t].map(f64::from)
    }),
};

const CONDUCTOR: Routine<3, 1> = Routine {
    id: "conductor/everywhere",
    says: "a conductor's reflectance is right to half a last place for any index, from normal to grazing",
    unit: "ulp, or 2⁻⁴⁸",
    bound: 0.51, // Half a last place by the rounding to f32; c − a of some ten roundings of 2⁻⁵³ is squared before it counts.
    one: |_, [r]| [ulp(*r).max(3.6e-15)],
    table: tables::CONDUCTOR,
    corners: &[[1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.0, 1.0, 1.0]],
    draw: |n| {
        let cos = n.one_of([n.unit(), n.log(1e-20, 1.0)]);
        [cos, n.log(1e-3, 50.0), n.one_of([0.0, 1.0, 1.0]) * n.log(1e-6, 50.0)].map(|x| f64::from(single(x)))
    },
    draws: 4096,
    exact: |[c, eta, k]| {
        // |r|² by complex arithmetic on m = η + ik, as (c − q)/(c + q) and (m²c − q)/(m²c + q) with q² = m² − s².
        let m2 = [(eta - k) * (eta + k), 2.0 * eta * k];
        let q2 = [c.mul_add(*c, (eta - 1.0) * (eta + 1.0) - k * k), m2[1]];
        let size = q2[0].hypot(q2[1]);
        // The root with the part that doesn't cancel first.
        let larger = (0.5 * (size + q2[0].abs())).sqrt();
        let smaller = if larger > 0.0 { 0.5 * q2[1] / larger } else { 0.0 };
        let q = if q2[0] >= 0.0 { [larger, smaller] } else { [smaller, larger] };
        let share = |a: [f64; 2]| {
            let square = |sign: f64| (a[0] + sign * q[0]).powi(2) + (a[1] + sign * q[1]).powi(2);
            let below = square(1.0);
            if below == 0.0 { 1.0 } else { square(-1.0) / below }
        };
        [0.5 * (share([*c, 0.0]) + share([m2[0] * c, m2[1] * c]))]
    },
    ours: |x| {
        let [cos, eta, k] = x.map(single);
        [f64::from(fresnel::conductor(cos, Rgb::splat(eta), Rgb::splat(k)).g)]
    },
    naive: ("a² = (A + t)/2 in single precision", |x| {
        let [c, eta, k] = x.map(single);
        let (c2, s2) = (c * c, 1.0 - c * c);
        let t = eta * eta - k * k - s2;
        let big = (t * t + 4.0 * eta * eta * k * k).sqrt();
        let ac2 = 2.0 * (0.5 * (big + t)).sqrt() * c;
        let rs = (big + c2 - ac2) / (big + c2 + ac2);
        let (p, q) = (big * c2 + s2 * s2, ac2 * s2);
        [f64::from(0.5 * rs * (1.0 + (p - q) / (p + q)))]
    }),
};

const GGX: Routine<5, 2> = Routine {
    id: "ggx/alpha-1e-5-to-1",
    says: "GGX's D and G₁ keep their digits for roughness 1e-5 to 1, at the pole, a step off it, and at grazing",
    unit: "roundings of 2⁻²⁴",
    bound: 15.5, // D: quotients 1, squares 3, two sums 5; their square 10; five factors with π 4½; inverse 1.
    one: roundings,
    table: tables::GGX,
    corners: &[[0.0, 0.0, 1.0, 1e-5, 1e-5], [3.4e-4, 0.0, 0.999_999_940_395_355_2, 1e-4, 1e-4]],
    draw: |n| {
        let [ax, ay] = [n.log(1e-5, 1.0), n.log(1e-5, 1.0)];
        let grazing = std::f64::consts::FRAC_PI_2 - n.log(1e-8, 1.0);
        let theta = n.one_of([ax * n.log(1e-2, 3.0), grazing]);
        let [x, y, z] = rounded(n.at_angle(theta));
        [x, y, z.max(1e-18), f64::from(single(ax)), f64::from(single(ay))]
    },
    draws: 4096,
    exact: |[x, y, z, ax, ay]| {
        let r = (x / ax).hypot(y / ay).hypot(*z);
        let stretched = (ax * x).hypot(ay * y).hypot(*z);
        [1.0 / (std::f64::consts::PI * ax * ay * r.powi(4)), 2.0 / (1.0 + stretched / z)]
    },
    ours: |x| {
        let [x, y, z, ax, ay] = x.map(single);
        let (ggx, w) = (Ggx { alpha: [ax, ay] }, Vec3::new(x, y, z));
        [ggx.d(w), ggx.g1(w)].map(f64::from)
    },
    naive: ("sin² by 1 − cos²", |x| {
        let [x, y, z, ax, ay] = x.map(single);
        let (cos2, sin2) = (z * z, 1.0 - z * z);
        let turn = x * x / (x * x + y * y).max(f32::MIN_POSITIVE);
        let tan2 = sin2 / cos2;
        let e = tan2 * (turn / (ax * ax) + (1.0 - turn) / (ay * ay));
        let spread = tan2 * (turn * ax * ax + (1.0 - turn) * ay * ay);
        let d = 1.0 / (std::f32::consts::PI * ax * ay * cos2 * cos2 * (1.0 + e) * (1.0 + e));
        [d, 2.0 / (1.0 + (1.0 + spread).sqrt())].map(f64::from)
    }),
};

const HALF_VECTOR: Routine<6, 2> = Routine {
    id: "half-vector/opposite-grazing",
    says: "half vectors of opposite grazing directions keep their digits down to heights of 1e-30",
    unit: "roundings of 2⁻²⁴",
    bound: 5.0, // Sums 1, squares 3, two more sums 5 of which the root keeps half and adds 1; scaling and quotient 1 each.
    one: roundings,
    table: tables::HALF_VECTOR,
    corners: &[[1.0, 0.0, 1e-30, -1.0, 0.0, 1e-30], [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]],
    draw: |n| {
        let up = n.log(1e-30, 1e-3);
        let a = n.at_angle(std::f64::consts::FRAC_PI_2).with_z(up);
        let b = DVec3::new(-a.x, -a.y, up * n.unit());
        let ([ax, ay, az], [bx, by, bz]) = (rounded(a), rounded(b));
        [ax, ay, az, bx, by, bz]
    },
    draws: 4096,
    exact: |[ax, ay, az, bx, by, bz]| {
        let length = (ax + bx).hypot(ay + by).hypot(az + bz);
        [0.5 * length, (az + bz) / length]
    },
    ours: |x| {
        let [ax, ay, az, bx, by, bz] = x.map(single);
        let (h, cos) = half_vector(Vec3::new(ax, ay, az), Vec3::new(bx, by, bz));
        [cos, h.z].map(f64::from)
    },
    naive: ("(a + b) normalised", |x| {
        let [ax, ay, az, bx, by, bz] = x.map(single);
        let sum = Vec3::new(ax, ay, az) + Vec3::new(bx, by, bz);
        [0.5 * sum.length(), sum.normalize().z].map(f64::from)
    }),
};

fn mirror(blur: f32) -> Option<Material> {
    let white = || Texture::Constant(Rgb::WHITE);
    Material::new_blur_disk(blur, None, white(), white()).ok()
}

const BLUR_DISK: Routine<7, 1> = Routine {
    id: "blur-disk/grazing",
    says: "the blur disk's density is right to its rim for blurs of 1e-4 to 100, at grazing too",
    unit: "roundings of 2⁻²⁴",
    bound: 1.01, // One rounding to f32, and f64 before that.
    one: roundings,
    table: tables::BLUR_DISK,
    corners: &[[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.5]],
    draw: |n| {
        let f = single(n.log(1e-4, 100.0));
        let up = n.log(1e-6, 1.0);
        let wo = rounded(n.at_angle(up.min(1.0).acos()));
        let r = DVec3::new(-wo[0], -wo[1], wo[2]);
        let side = r.cross(n.direction()).normalize();
        let off = f64::from(f) * n.one_of([n.unit() * 0.998, 1.002 + n.unit()]);
        let wi = rounded((r + off * side).normalize());
        [wo[0], wo[1], wo[2], wi[0], wi[1], wi[2], f64::from(f)]
    },
    draws: 1024,
    exact: |[ox, oy, oz, ix, iy, iz, f]| {
        let (r, wi) = (DVec3::new(-ox, -oy, *oz), DVec3::new(*ix, *iy, *iz));
        let tan2 = r.cross(wi).length_squared() / r.dot(wi).powi(2);
        let inside = r.dot(wi) > 0.0 && *iz > 0.0 && tan2 <= f * f;
        [if inside { (1.0 + tan2).powf(1.5) / (std::f64::consts::PI * f * f) } else { 0.0 }]
    },
    ours: |x| {
        let [ox, oy, oz, ix, iy, iz, f] = x.map(single);
        [mirror(f).map_or(f64::NAN, |m| {
            f64::from(m.bsdf([0.0; 2]).pdf(Vec3::new(ox, oy, oz), Vec3::new(ix, iy, iz)))
        })]
    },
    naive: ("tan² from the cosine", |x| {
        let [ox, oy, oz, ix, iy, iz, f] = x.map(single);
        let cos = Vec3::new(-ox, -oy, oz).dot(Vec3::new(ix, iy, iz));
        let tan2 = (1.0 - cos * cos) / (cos * cos);
        let inside = cos > 0.0 && iz > 0.0 && tan2 <= f * f;
        [if inside { f64::from(1.0 / (std::f32::consts::PI * f * f * cos * cos * cos)) } else { 0.0 }]
    }),
};
