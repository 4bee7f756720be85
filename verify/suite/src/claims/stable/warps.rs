//! Directions: cones, lobes, hemispheres, the sphere, the disk's centre.

use glam::{DVec3, Vec3};
use renderer::math::Frame;
use renderer::sampling::warp;

use super::Entry;
use super::numbers::rounded;
use super::routine::{ROUNDING, Routine, single, ulps};
use super::tables;
use crate::wrong;

pub(super) fn entries() -> Vec<Entry> {
    vec![
        ONE_MINUS_COS.into(),
        CONE.into(),
        PHONG.into(),
        PHONG_PDF.into(),
        COSINE.into(),
        SPHERE.into(),
        CENTRE.into(),
        FRAME.into(),
    ]
}

const ONE_MINUS_COS: Routine<1, 1> = Routine {
    id: "one-minus-cos/every-angle",
    says: "1 − cos θ from sin² θ keeps its digits at every angle down to the smallest number",
    unit: "ulp",
    bound: 2.75, // 1 − s has ½, the root 1½ and, as less than half of the sum, ¾; the sum and the quotient 1 each.
    one: ulps,
    table: tables::ONE_MINUS_COS,
    corners: &[[0.0], [1.0], [1e-45], [0.5]],
    draw: |n| [f64::from(single(n.log(1e-38, 1.0)))],
    draws: 4096,
    // 2 sin²(θ/2) in the place of the quotient.
    exact: |[s]| {
        let half = 0.5 * s.sqrt().asin();
        [2.0 * half.sin() * half.sin()]
    },
    ours: |[s]| [f64::from(warp::one_minus_cos(single(*s)))],
    naive: ("1 − √(1 − sin²)", |[s]| [f64::from(1.0 - (1.0 - single(*s)).sqrt())]),
};

const CONE: Routine<2, 2> = Routine {
    id: "cone/1e-12-to-4pi-sr",
    says: "directions of cones from 1e-12 sr to the sphere keep their distance from the axis",
    unit: "roundings of 2⁻²⁴",
    bound: 2.5, // The height 1; height·(2 − height) 3 more than it, halved by the root, which adds 1; 1 − height 1.
    // An error of the height moves the sine by (1 − h)/sin of it.
    one: |[u, h], [sin, cos]| {
        let height = u * h;
        let moved = if *sin > 0.0 { height * (1.0 - height).abs() / sin } else { 0.0 };
        [ROUNDING * (sin + moved), ROUNDING * (height + cos.abs())]
    },
    table: tables::CONE,
    corners: &[[0.0, 1e-13], [0.999_999_940_395_355_2, 2.0]],
    draw: |n| [n.sampler(), f64::from(single(n.log(1.6e-13, 2.0)))],
    draws: 4096,
    exact: |[u, h]| {
        let angle = 2.0 * (0.5 * u * h).sqrt().asin();
        [angle.sin(), angle.cos()]
    },
    ours: |[u, h]| polar(warp::square_to_cone([single(*u), 0.0], single(*h))),
    naive: ("cos by difference, sin from cos", |[u, h]| {
        polar(wrong::cone_without_digits([single(*u), 0.0], (1.0 - h).acos()))
    }),
};

/// Sine and cosine of the polar angle of a direction at azimuth 0.
fn polar(w: Vec3) -> [f64; 2] {
    [f64::from(w.x), f64::from(w.z)]
}

const PHONG: Routine<2, 2> = Routine {
    id: "phong/exponents-to-1e8",
    says: "directions of Phong lobes of any exponent keep their distance from the axis",
    unit: "roundings of 2⁻²⁴",
    bound: 4.5, // ln cos has 4 (log1p 2, sum, quotient); expm1 2 and the root's half of 6, and 1; exp 2 and L times 4.
    one: |[u, e], [sin, cos]| {
        let log = (-u).ln_1p() / (e + 1.0);
        [ROUNDING * sin, ROUNDING * cos * (1.0 - log)]
    },
    table: tables::PHONG,
    corners: &[[0.0, 1.0], [0.999_999_940_395_355_2, 0.0], [0.5, 1e8]],
    draw: |n| [n.sampler(), f64::from(single(n.log(1e-3, 1e8)))],
    draws: 4096,
    exact: |[u, e]| {
        let log = (-u).ln_1p() / (e + 1.0);
        [(-(2.0 * log).exp_m1()).sqrt(), log.exp()]
    },
    ours: |[u, e]| polar(warp::square_to_phong([single(*u), 0.0], single(*e))),
    naive: ("power in single precision, sin from cos", |[u, e]| {
        let cos = (1.0 - single(*u)).powf(1.0 / (single(*e) + 1.0));
        [f64::from((1.0 - cos * cos).max(0.0).sqrt()), f64::from(cos)]
    }),
};

const PHONG_PDF: Routine<3, 1> = Routine {
    id: "phong-pdf/exponents-to-1e8",
    says: "densities of Phong lobes of any exponent keep their digits at the axis and at the horizon",
    unit: "roundings of 2⁻²⁴",
    bound: 6.0, // e·ln cos has 4 of itself (square, log1p 2, product); exp 2, e + 1, 2π 1½, quotient and product 2.
    one: |[x, z, e], [pdf]| {
        let log = if x * x < 0.5 { 0.5 * (-x * x).ln_1p() } else { z.ln() };
        [(ROUNDING * pdf * (1.0 + (e * log).abs())).max(f64::from(f32::from_bits(1)))]
    },
    table: tables::PHONG_PDF,
    corners: &[[0.0, 1.0, 1e8]],
    draw: |n| {
        let e = n.log(1e-2, 1e8);
        let x = single((n.log(1e-3, 4.0) / (e + 1.0).sqrt()).min(0.999_999));
        let z = single((1.0 - f64::from(x) * f64::from(x)).sqrt());
        [f64::from(x), f64::from(z), f64::from(single(e))]
    },
    draws: 4096,
    exact: |[x, z, e]| {
        let log = if x * x < 0.5 { 0.5 * (-x * x).ln_1p() } else { z.ln() };
        [(e + 1.0) / std::f64::consts::TAU * (e * log).exp()]
    },
    ours: |x| {
        let [x, z, e] = x.map(single);
        [f64::from(warp::phong_pdf(Vec3::new(x, 0.0, z), e))]
    },
    naive: ("the cosine to the power e", |x| {
        let [_, z, e] = x.map(single);
        [f64::from((e + 1.0) / std::f32::consts::TAU * z.powf(e))]
    }),
};

const COSINE: Routine<2, 1> = Routine {
    id: "cosine-hemisphere/horizon",
    says: "heights of cosine-distributed directions keep their digits down to the horizon",
    unit: "roundings of 2⁻²⁴",
    bound: 2.5, // 1 − r is exact here, 1 + r 1, the product 1, of which the root keeps half and adds 1; r itself is exact.
    one: |_, exact| exact.map(|e| (ROUNDING * e).max(1e-30)),
    table: tables::NONE,
    corners: &[[0.0, 0.5], [0.5, 0.5], [0.999_999_940_395_355_2, 0.3], [5.960_464_477_539_063e-8, 0.4]],
    draw: |n| [n.sampler(), n.sampler()],
    draws: 4096,
    exact: |u| {
        let r = u.map(|u| (2.0 * u - 1.0).abs()).into_iter().fold(0.0, f64::max);
        [((1.0 - r) * (1.0 + r)).sqrt()]
    },
    ours: |u| [f64::from(warp::square_to_cosine_hemisphere(u.map(single)).z)],
    naive: ("√(1 − x² − y²)", |u| {
        let p = warp::square_to_disk(u.map(single));
        [f64::from((1.0 - p.length_squared()).max(0.0).sqrt())]
    }),
};

const SPHERE: Routine<1, 1> = Routine {
    id: "sphere-warp/poles",
    says: "uniform directions keep their distance from the axis at both poles",
    unit: "roundings of 2⁻²⁴",
    bound: 2.5, // 1 − u is exact at the south pole and has 1 elsewhere, the product 1, of which the root keeps half, and adds 1.
    one: |_, exact| exact.map(|e| (ROUNDING * e).max(1e-30)),
    table: tables::NONE,
    corners: &[[0.0], [0.5], [0.999_999_940_395_355_2], [5.960_464_477_539_063e-8]],
    draw: |n| [n.sampler()],
    draws: 4096,
    exact: |[u]| [2.0 * (u * (1.0 - u)).sqrt()],
    ours: |[u]| [f64::from(warp::square_to_sphere([single(*u), 0.0]).x)],
    naive: ("√(1 − cos²)", |[u]| {
        let cos = 1.0 - 2.0 * single(*u);
        [f64::from((1.0 - cos * cos).sqrt())]
    }),
};

const CENTRE: Routine<2, 2> = Routine {
    id: "disk/centre",
    says: "the concentric map keeps its digits down to the disk's centre",
    unit: "roundings of the radius",
    // The angle: quotient and product 2 of at most π/4, π/4 itself ½ of that, and in the second case π/2 and the difference
    // 1¾ more: 3.7. Sine and cosine 1, the product 1: √(3.7² + 2²).
    bound: 4.3,
    one: |u, _| {
        let r = u.map(|u| (2.0 * u - 1.0).abs()).into_iter().fold(0.0, f64::max);
        [ROUNDING * r; 2]
    },
    table: tables::NONE,
    corners: &[[0.5, 0.5], [0.5, 0.500_000_059_604_644_8], [0.499_999_970_197_677_6, 0.5], [0.0, 0.0]],
    draw: |n| {
        let near = |n: &super::numbers::Numbers| 0.5 + n.sign() * 0.5 * n.sampler();
        [near(n), near(n)].map(|u| f64::from(single(u.min(0.999_999_940_395_355_2))))
    },
    draws: 4096,
    exact: |u| {
        let [a, b] = u.map(|u| 2.0 * u - 1.0);
        let radius = a.abs().max(b.abs());
        if radius == 0.0 {
            return [0.0; 2];
        }
        // The angle goes round the square evenly: by π/4 from the middle of a side to its corner.
        let quarter = std::f64::consts::FRAC_PI_4;
        let phi = if a.abs() > b.abs() {
            quarter * b / a + if a < 0.0 { 4.0 * quarter } else { 0.0 }
        } else {
            2.0 * quarter - quarter * a / b + if b < 0.0 { 4.0 * quarter } else { 0.0 }
        };
        [radius * phi.cos(), radius * phi.sin()]
    },
    ours: |u| warp::square_to_disk(u.map(single)).to_array().map(f64::from),
    naive: ("the quotient without a case for the centre", |u| {
        let [a, b] = u.map(|u| 2.0 * single(u) - 1.0);
        let quarter = std::f32::consts::FRAC_PI_4;
        let (r, phi) =
            if a * a > b * b { (a, quarter * (b / a)) } else { (b, 2.0 * quarter - quarter * (a / b)) };
        [f64::from(r * phi.cos()), f64::from(r * phi.sin())]
    }),
};

/// How far a frame about `z` is from orthonormal: lengths, angles, handedness.
fn defects(x: DVec3, y: DVec3, z: DVec3) -> [f64; 6] {
    [
        x.length_squared() - 1.0,
        y.length_squared() - 1.0,
        x.dot(y),
        x.dot(z),
        y.dot(z),
        if x.cross(y).dot(z) > 0.0 { 0.0 } else { f64::INFINITY },
    ]
}

const FRAME: Routine<3, 6> = Routine {
    id: "frame/every-normal",
    says: "frames are orthonormal and right-handed for every normal, both poles and subnormal components included",
    unit: "roundings of 2⁻²⁴",
    bound: 5.0, // Components are products of three factors of at most 1 with 5 roundings; that of the normal counts among them.
    one: |_, _| [ROUNDING; 6],
    table: tables::NONE,
    corners: &[
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [-0.0, 0.0, -1.0],
        [1e-40, -1e-42, -1.0],
        [1e-45, 0.0, -1.0],
        [1.0, 0.0, -0.0],
        [1.0, 1e-45, 0.0],
        [0.0, 1.0, -1e-40],
    ],
    draw: |n| {
        let theta = n.one_of([n.log(1e-9, 3.0), std::f64::consts::PI - n.log(1e-9, 3.0)]);
        rounded(n.at_angle(theta))
    },
    draws: 4096,
    exact: |_| [0.0; 6],
    ours: |z| {
        let frame = Frame::from_z(DVec3::from(*z).as_vec3());
        defects(frame.x.as_dvec3(), frame.y.as_dvec3(), DVec3::from(*z))
    },
    naive: ("division by 1 + z", |z| {
        let [nx, ny, nz] = z.map(single);
        let (a, b) = (1.0 / (1.0 + nz), -nx * ny / (1.0 + nz));
        let (x, y) = (Vec3::new(1.0 - nx * nx * a, b, -nx), Vec3::new(b, 1.0 - ny * ny * a, -ny));
        defects(x.as_dvec3(), y.as_dvec3(), DVec3::from(*z))
    }),
};
