//! Where rays meet triangles, and keyed transforms.

use glam::{DAffine3, DMat3, DVec3, Vec3};
use renderer::math::transform::Motion;
use renderer::ray::Ray;
use renderer::shapes::triangle::ShearedRay;

use super::Entry;
use super::numbers::rounded;
use super::routine::{ROUNDING, ROUNDING_F64, Routine, ulp};
use super::tables;

pub(super) fn entries() -> Vec<Entry> {
    vec![TRIANGLE.into(), FLAT.into(), ROTATION.into(), STRETCH.into()]
}

/// The ray of the first six numbers.
pub(super) fn ray(x: &[f64]) -> Ray {
    Ray::new(vector(&x[..3]).as_vec3(), vector(&x[3..6]).as_vec3(), 0.0)
}

/// The first three numbers.
pub(super) fn vector(x: &[f64]) -> DVec3 {
    DVec3::new(x[0], x[1], x[2])
}

/// Distance and weights of the second and third vertex; −1 for a miss.
type Crossing = [f64; 3];

const MISS: Crossing = [-1.0; 3];

fn corners(x: &[f64; 15]) -> [DVec3; 3] {
    [vector(&x[6..9]), vector(&x[9..12]), vector(&x[12..])]
}

/// Farthest corner from the ray's origin: the size of the numbers that are sheared.
fn reach(x: &[f64; 15]) -> f64 {
    corners(x).iter().map(|p| (*p - vector(&x[..3])).length()).fold(0.0, f64::max)
}

/// How far the ray passes from the nearest edge's line: by how much it would have to move for another answer.
fn to_edge(x: &[f64; 15]) -> f64 {
    let (o, d) = (vector(&x[..3]), vector(&x[3..6]));
    let [a, b, c] = corners(x);
    let distance = |(p, q): (DVec3, DVec3)| {
        let n = d.cross(q - p);
        (n.dot(p - o) / n.length()).abs()
    };
    [(a, b), (b, c), (c, a)].map(distance).into_iter().fold(f64::INFINITY, f64::min)
}

/// The crossing in double precision.
fn crossing(x: &[f64; 15]) -> Crossing {
    let (o, d) = (vector(&x[..3]), vector(&x[3..6]));
    let [a, b, c] = corners(x);
    let (e1, e2) = (b - a, c - a);
    let n = e1.cross(e2);
    let t = n.dot(a - o) / n.dot(d);
    let hit = o + d * t - a;
    let square = n.length_squared();
    let (w1, w2) = (hit.cross(e2).dot(n) / square, e1.cross(hit).dot(n) / square);
    if t > 0.0 && w1 >= 0.0 && w2 >= 0.0 && w1 + w2 <= 1.0 { [t, w1, w2] } else { MISS }
}

/// How an answer differs from the exact one: of the distance, and of the place or of the decision.
fn judged(x: &[f64; 15], answer: Option<Crossing>) -> [f64; 2] {
    let exact = crossing(x);
    match answer {
        None if exact == MISS => [0.0; 2],
        Some(_) if exact == MISS => [0.0, to_edge(x)],
        None => [0.0, to_edge(x)],
        Some([t, w1, w2]) => {
            let [a, b, c] = corners(x);
            let (o, d) = (vector(&x[..3]), vector(&x[3..6]));
            let place = a + w1 * (b - a) + w2 * (c - a) - o;
            [(t - exact[0]) / ulp(exact[0]), place.cross(d).length() / d.length()]
        }
    }
}

fn sheared(x: &[f64; 15]) -> Option<Crossing> {
    let vertices = corners(x).map(|p| p.as_vec3());
    let hit = ShearedRay::new(&ray(x)).hit(&vertices, f32::INFINITY)?;
    Some([hit.t, hit.uv[0], hit.uv[1]].map(f64::from))
}

/// The usual test in single precision.
///
/// # Source
/// Möller, Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection".
fn moller_trumbore(x: &[f64; 15]) -> Option<Crossing> {
    let Ray { origin, direction: d, .. } = ray(x);
    let [a, b, c]: [Vec3; 3] = corners(x).map(|p| p.as_vec3());
    let (e1, e2, s) = (b - a, c - a, origin - a);
    let p = d.cross(e2);
    let determinant = e1.dot(p);
    let q = s.cross(e1);
    let (u, v, t) = (s.dot(p) / determinant, d.dot(q) / determinant, e2.dot(q) / determinant);
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0;
    inside.then(|| [t, u, v].map(f64::from))
}

const TRIANGLE: Routine<15, 2> = Routine {
    id: "triangle/needles",
    says: "a ray meets a needle of aspect 1e7, seen edge-on to 1e-4 rad, where it does",
    unit: "ulp of the distance, or 2⁻²⁴ of the reach across the ray",
    // The distance is the plane's, half a last place and what f64 loses in a needle's normal, 2⁻⁵³·1e7·1e4 relative, far less.
    // Across: sheared corners are rounded once each, by √½ of 2⁻²⁴ of the reach, and the two weights once, by half each.
    bound: 2.0,
    one: |x, _| [1.0, ROUNDING * reach(x)],
    table: tables::NONE,
    corners: &[],
    draw: |n| {
        let aspect = n.log(1.0, 1e7);
        let a = DVec3::new(n.between(-1.0, 1.0), n.between(-1.0, 1.0), n.between(-1.0, 1.0));
        let (along, other) = (n.direction(), n.direction());
        let across = along.cross(other).normalize() / aspect;
        let p = [a, a + along, a + n.unit() * along + across].map(rounded).map(DVec3::from);
        let (e1, e2) = (p[1] - p[0], p[2] - p[0]);
        let [b1, b2] = [n.unit(), n.unit()];
        let [b1, b2] = if b1 + b2 > 1.0 { [1.0 - b1, 1.0 - b2] } else { [b1, b2] };
        let tilt = n.log(1e-4, 1.0);
        let normal = e1.cross(e2).normalize_or(other);
        let d = rounded((tilt * normal + (1.0 - tilt * tilt).sqrt() * along).normalize());
        let o = rounded(p[0] + b1 * e1 + b2 * e2 - n.between(0.5, 2.0) * DVec3::from(d));
        let mut x = [0.0; 15];
        x[..3].copy_from_slice(&o);
        x[3..6].copy_from_slice(&d);
        for (k, p) in p.iter().enumerate() {
            x[6 + 3 * k..9 + 3 * k].copy_from_slice(&p.to_array());
        }
        x
    },
    draws: 4096,
    exact: |_| [0.0; 2],
    ours: |x| judged(x, sheared(x)),
    naive: ("Möller and Trumbore in single precision", |x| judged(x, moller_trumbore(x))),
};

/// The number of answers "hit" about a triangle without area.
const FLAT: Routine<15, 1> = Routine {
    id: "triangle/zero-area",
    says: "no ray meets a triangle without area",
    unit: "hits",
    bound: 0.5, // None is right.
    one: |_, _| [1.0],
    table: tables::NONE,
    corners: &[],
    draw: |n| {
        // Corners on a line, exactly: whole steps of 2⁻¹⁰ along a vector of whole numbers.
        let whole = |size: f64| (size * n.between(-1.0, 1.0)).round();
        let a = DVec3::new(whole(1024.0), whole(1024.0), whole(1024.0));
        let along = DVec3::new(whole(31.0), whole(31.0), whole(31.0));
        let [i, j] = [whole(31.0), whole(31.0)];
        let p = [a, a + i * along, a + j * along].map(|p| p / 1024.0);
        let o = DVec3::from(rounded(3.0 * n.direction()));
        let target = p[0] + n.unit() * (p[1] - p[0]);
        let d = rounded((target - o).normalize());
        let mut x = [0.0; 15];
        x[..3].copy_from_slice(&o.to_array());
        x[3..6].copy_from_slice(&d);
        for (k, p) in p.iter().enumerate() {
            x[6 + 3 * k..9 + 3 * k].copy_from_slice(&p.to_array());
        }
        x
    },
    draws: 8192,
    exact: |_| [0.0],
    ours: |x| [f64::from(u8::from(sheared(x).is_some()))],
    naive: ("Möller and Trumbore in single precision", |x| {
        [f64::from(u8::from(moller_trumbore(x).is_some()))]
    }),
};

/// Two keys a turn about z apart, and the transform at share `s` between them.
fn turned(stretch: DMat3, angle: f64, s: f64) -> Option<DMat3> {
    let keys = vec![
        (0.0, DAffine3::from_mat3(stretch)),
        (1.0, DAffine3::from_mat3(DMat3::from_rotation_z(angle) * stretch)),
    ];
    Some(Motion::keyed(keys).ok()?.at(s).matrix3)
}

const ROTATION: Routine<2, 2> = Routine {
    id: "rotation/0-to-pi",
    says: "a turn between two keys by 1e-17 to π less 1e-12 goes evenly round its own axis",
    unit: "roundings of 2⁻⁵³",
    // Newton's last step, the quaternion's root and normalisation, two sines and the matrix: some forty roundings; at π a
    // quaternion's smallest component has them in full, and turns the axis by as much.
    bound: 64.0,
    one: |_, _| [ROUNDING_F64; 2],
    table: tables::ROTATION,
    corners: &[[0.0, 0.5], [std::f64::consts::PI - 1e-12, 0.5], [1e-300, 0.5]],
    draw: |n| {
        let angle =
            n.one_of([n.log(1e-17, 1.0), std::f64::consts::PI - n.log(1e-12, 1.0), n.between(0.0, 3.1)]);
        [angle, n.unit()]
    },
    draws: 1024,
    exact: |[angle, s]| [(angle * s).cos(), (angle * s).sin()],
    ours: |[angle, s]| {
        turned(DMat3::IDENTITY, *angle, *s).map_or([f64::NAN; 2], |m| [m.x_axis.x, m.x_axis.y])
    },
    naive: ("angle from the arc cosine of the quaternions' product", |[angle, s]| {
        let half = (0.5 * angle).cos().acos();
        let [a, b] = [((1.0 - s) * half).sin() / half.sin(), (s * half).sin() / half.sin()];
        let (w, z) = (a + b * (0.5 * angle).cos(), b * (0.5 * angle).sin());
        [w * w - z * z, 2.0 * w * z]
    }),
};

const STRETCH: Routine<4, 2> = Routine {
    id: "transform/near-singular",
    says: "a turning body squeezed to 1e-11 of its size, mirrored or not, keeps its shape between keys",
    unit: "roundings of 2⁻⁵³",
    // The rotation's 64, with the polar decomposition of a matrix of condition 1e11: its rotation is as well determined as
    // the two large axes, whose sum of singular values divides the roundings.
    bound: 128.0,
    one: |_, _| [ROUNDING_F64; 2],
    table: tables::NONE,
    corners: &[[3.0, 0.5, 1e-11, -1.0], [1.0, 0.25, 1e-11, 1.0]],
    draw: |n| [n.between(0.0, 3.1), n.unit(), n.log(1e-11, 1.0), n.sign()],
    draws: 1024,
    exact: |[angle, s, _, _]| [(angle * s).cos(), (angle * s).sin()],
    ours: |[angle, s, thin, sign]| {
        let stretch = DMat3::from_diagonal(*sign * DVec3::new(1.0, 1.0, *thin));
        let m = turned(stretch, *angle, *s);
        m.map_or([f64::NAN; 2], |m| [sign * m.x_axis.x, sign * m.x_axis.y])
    },
    naive: ("matrix entries interpolated", |[angle, s, _, _]| [1.0 - s + s * angle.cos(), s * angle.sin()]),
};

#[cfg(test)]
mod tests {
    use super::*;

    /// The crossing in double precision, which decides about ours, against 50 digits.
    #[test]
    fn the_second_opinion_on_triangles_is_the_first() {
        let mut rows = 0;
        for line in tables::TRIANGLE.lines().skip(2) {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            let x: [f64; 15] = std::array::from_fn(|i| cells[i]);
            for (ours, exact) in crossing(&x).iter().zip(&cells[15..]) {
                // Needles of aspect 1e7 seen at 1e-4: roundings of 2⁻⁵³ times at most 1e7²·1e4 in a weight's square, and
                // far less as a rule; a thousandth of what single precision's 2⁻²⁴ would be.
                assert!((ours - exact).abs() <= 1e-3, "{line}: {ours}");
            }
            rows += 1;
        }
        assert!(rows > 200, "{rows}");
    }
}
