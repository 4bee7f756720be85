//! Uniform directions to a triangle, by its solid angle.

use glam::DVec3;

/// A triangle as seen from the origin: its solid angle, and the map of the unit square onto it that is uniform there.
///
/// With unit vectors A, B, C to the corners, the first number u moves a corner C′ from A to C along their arc until the
/// triangle ABC′ has the solid angle uΩ. If C′ is the angle t away from A, in the plane of A and the unit vector T
/// across it, then tan(uΩ/2) = det(A, B, T)·τ / (1 + A·B + B·T·τ) with τ = tan(t/2), which is solved for τ. The second
/// number moves from B to C′, evenly in 1 − cos of the angle to B.
///
/// # Precision, limits
/// Volumes and differences are formed from edges, so that the relative error of the solid angle stays below 1e-9 from
/// 1e-10 sr to the hemisphere, and that of the place within the triangle below 1e-6 of its size for heights above a
/// hundredth of it and of the distance.
///
/// # Source
/// Arvo 1995, "Stratified sampling of spherical triangles", doi 10.1145/218380.218500, for the two steps; the solid
/// angle's tangent is van Oosterom and Strackee's, 1983, doi 10.1109/TBME.1983.325207. Solving it for τ instead of
/// angles at the corners is ours and keeps the digits of small triangles.
///
/// # Verified by
/// `tests/solid_angles.rs`; claims `light/triangle/*`
#[derive(Debug, Clone, Copy)]
pub struct SphericalTriangle {
    corner: DVec3,
    edges: [DVec3; 2],
    /// Cross product of the edges.
    cross: DVec3,
    /// Unit vectors to the first two corners, and from the first towards the third.
    a: DVec3,
    b: DVec3,
    t: DVec3,
    /// det(a, b, t), 1 + a·b, b·t.
    volume: f64,
    one_plus_cos: f64,
    slope: f64,
    solid_angle: f64,
}

impl SphericalTriangle {
    /// The triangle of `corners` relative to the point from which it is seen.
    ///
    /// Returns: `None` if the point lies in its plane, or the triangle has no area.
    pub fn new([p, q, r]: [DVec3; 3]) -> Option<Self> {
        let edges = [q - p, r - p];
        let cross = edges[0].cross(edges[1]);
        let volume = p.dot(cross);
        let (lp, lq, lr) = (p.length(), q.length(), r.length());
        let denominator = lp * lq * lr + p.dot(q) * lr + q.dot(r) * lp + r.dot(p) * lq;
        let solid_angle = 2.0 * libm::atan2(volume.abs(), denominator);
        let (a, b) = (p / lp, q / lq);
        // The part of the third corner across the first, from the edge between them.
        let across = edges[1] - edges[1].dot(a) * a;
        let t = across.try_normalize()?;
        let sine = volume / (lp * lq * across.length());
        (solid_angle > 0.0 && sine != 0.0).then(|| Self {
            corner: p,
            edges,
            cross,
            a,
            b,
            t,
            volume: sine.abs(),
            one_plus_cos: 1.0 + a.dot(b),
            slope: b.dot(t),
            solid_angle,
        })
    }

    /// The solid angle in steradians.
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// The point of the triangle for `u` in [0, 1]², as weights of its second and third corner.
    ///
    /// # Measure
    /// 1 / `solid_angle()` per steradian.
    pub fn sample(&self, u: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = libm::sincos(0.5 * u[0] * self.solid_angle);
        // τ as a quotient, and the sine and cosine of the doubled angle from it; no quotient is formed that may be 0.
        let (over, under) = (self.one_plus_cos * sin, self.volume * cos - self.slope * sin);
        let scale = 1.0 / (over * over + under * under);
        let sin_t = 2.0 * over * under * scale;
        let one_minus_cos_t = 2.0 * over * over * scale;
        let from_a = sin_t * self.t - one_minus_cos_t * self.a;
        // C′ − B, and the part of C′ across B.
        let chord = from_a + (self.a - self.b);
        let one_minus_cos = 0.5 * chord.length_squared();
        let across = (chord + one_minus_cos * self.b).normalize_or_zero();
        let fall = u[1] * one_minus_cos;
        let direction = self.b + (fall * (2.0 - fall)).max(0.0).sqrt() * across - fall * self.b;
        self.weights(direction)
    }

    /// The weights of the second and third corner where `direction` meets the plane, kept inside the triangle.
    fn weights(&self, direction: DVec3) -> [f64; 2] {
        let distance = self.corner.dot(self.cross) / direction.dot(self.cross);
        let from_corner = distance * direction - self.corner;
        let area2 = self.cross.length_squared();
        let v = (from_corner.cross(self.edges[1]).dot(self.cross) / area2).max(0.0);
        let w = (self.edges[0].cross(from_corner).dot(self.cross) / area2).max(0.0);
        let sum = (v + w).max(1.0);
        [v / sum, w / sum]
    }
}
