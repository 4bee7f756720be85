//! Deliberately wrong versions: the controls that claims must reject, each with the mistake that it makes.

use std::f64::consts::{PI, TAU};

pub mod samplers;

/// Polar coordinates to Cartesian ones; a full turn is 1.
fn polar(radius: f64, turn: f64) -> [f64; 2] {
    let (sin, cos) = (TAU * turn).sin_cos();
    [radius * cos, radius * sin]
}

/// A direction at the height `z`, a full turn being 1.
fn at_height(z: f64, turn: f64) -> [f64; 3] {
    let [x, y] = polar((1.0 - z * z).max(0.0).sqrt(), turn);
    [x, y, z]
}

/// The disk without its square root: points crowd at the centre.
pub fn disk_without_root([u, v]: [f64; 2]) -> [f64; 2] {
    polar(u, v)
}

/// The disk with an exponent of 0.51 in the place of ½.
pub fn disk_with_exponent_051([u, v]: [f64; 2]) -> [f64; 2] {
    polar(u.powf(0.51), v)
}

/// A square stretched to the disk along its rays: r = max(|a|, |b|) at the angle of (a, b), without the correction of the angle.
pub fn disk_stretched([u, v]: [f64; 2]) -> [f64; 2] {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    polar(a.abs().max(b.abs()), b.atan2(a) / TAU)
}

/// The triangle without folding: half of its points lie outside, and are lost.
pub fn triangle_unfolded([u, v]: [f64; 2]) -> Option<[f64; 2]> {
    (u + v <= 1.0).then_some([u, v])
}

/// The triangle by dividing weights by their sum when they exceed it: points crowd on an edge.
pub fn triangle_normalised([u, v]: [f64; 2]) -> [f64; 2] {
    let sum = (u + v).max(1.0);
    [u / sum, v / sum]
}

/// The triangle's map without its square root: points crowd at one vertex.
pub fn triangle_without_root([u, v]: [f64; 2]) -> [f64; 2] {
    [u * (1.0 - v), u * v]
}

/// The parallelogram's corner with an edge where its opposite corner should be: p0 + u(p1 − p0) + uv(p2 − p0).
pub fn parallelogram_sheared([u, v]: [f64; 2], [a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + u * (b[i] - a[i]) + u * v * (c[i] - a[i]))
}

/// The sphere by uniform angles: directions crowd at the poles.
pub fn sphere_by_angles([u, v]: [f64; 2]) -> [f64; 3] {
    at_height((PI * u).cos(), v)
}

/// The sphere by normalising a point of the cube around it: directions crowd at the corners.
pub fn sphere_from_cube([u, v, w]: [f64; 3]) -> [f64; 3] {
    let p = [u, v, w].map(|x| 2.0 * x - 1.0);
    let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
    p.map(|x| x / length)
}

/// The hemisphere by uniform angles: directions crowd at the pole.
pub fn hemisphere_by_angles([u, v]: [f64; 2]) -> [f64; 3] {
    at_height((0.5 * PI * u).cos(), v)
}

/// Uniform directions of the hemisphere.
pub fn hemisphere_uniform([u, v]: [f64; 2]) -> [f64; 3] {
    at_height(u, v)
}

/// Directions of the hemisphere in proportion to the cosine.
pub fn hemisphere_cosine([u, v]: [f64; 2]) -> [f64; 3] {
    at_height(u.sqrt(), v)
}

/// The cone by a uniform angle from its axis.
pub fn cone_by_angle([u, v]: [f64; 2], half_angle: f64) -> [f64; 3] {
    at_height((half_angle * u).cos(), v)
}

/// The cone as a disk of directions that is normalised: dense at the rim by the cosine that is left out.
pub fn cone_as_disk([u, v]: [f64; 2], half_angle: f64) -> [f64; 3] {
    let [x, y] = polar(u.sqrt() * half_angle.sin(), v);
    [x, y, (1.0 - x * x - y * y).sqrt()]
}

/// Phong's lobe with the exponent e in the place of e + 1.
pub fn phong_with_exponent([u, v]: [f64; 2], exponent: f64) -> [f64; 3] {
    at_height((1.0 - u).powf(1.0 / exponent), v)
}

/// The tent without the square root of its right half.
pub fn tent_half_rooted(u: f64, radius: f64) -> f64 {
    if u < 0.5 { radius * ((2.0 * u).sqrt() - 1.0) } else { radius * (2.0 * u - 1.0) }
}

/// The box in the place of the tent.
pub fn tent_as_box(u: f64, radius: f64) -> f64 {
    radius * (2.0 * u - 1.0)
}

/// The cone by a height that is subtracted from 1 in single precision, and a sine that is taken from the height again: few values are left.
pub fn cone_without_digits([u, v]: [f32; 2], half_angle: f64) -> glam::Vec3 {
    #[expect(clippy::cast_possible_truncation, reason = "the mistake to be made")]
    let cos_max = half_angle.cos() as f32;
    let cos = 1.0 - u * (1.0 - cos_max);
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (sin_phi, cos_phi) = (std::f32::consts::TAU * v).sin_cos();
    glam::Vec3::new(sin * cos_phi, sin * sin_phi, cos)
}

/// A rectangle filled like a disk, and so without its corners; coordinates in [−1, 1]².
pub fn rectangle_as_disk([u, v]: [f64; 2]) -> [f64; 2] {
    polar(u.sqrt(), v)
}

/// A mesh whose triangles are chosen by their index, each as often as any other, whatever its area.
pub fn mesh_by_index([w, u, v]: [f64; 3], triangles: &[[[f64; 3]; 3]]) -> Option<[f64; 3]> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "w·n lies in [0, n)")]
    let [a, b, c] = triangles.get((w * triangles.len() as f64) as usize)?;
    let (s, t) = (u.sqrt() * (1.0 - v), u.sqrt() * v);
    Some(std::array::from_fn(|i| a[i] + s * (b[i] - a[i]) + t * (c[i] - a[i])))
}

/// Diffuse reflection by a point of the ball above the surface, in the place of the sphere: cos³ θ in the place of cos θ.
pub fn diffuse_from_ball([u, v, w]: [f64; 3]) -> [f64; 3] {
    let radius = w.cbrt();
    let [x, y, z] = at_height(2.0 * u - 1.0, v).map(|c| radius * c);
    let length = (x * x + y * y + (z + 1.0).powi(2)).sqrt();
    [x / length, y / length, (z + 1.0) / length]
}

/// A rough mirror by normals in proportion to D(h)·cos θₕ, seen or not; `None` below the surface.
pub fn ggx_by_all_normals([u, v]: [f64; 2], alpha: f64, wo: [f64; 3]) -> Option<[f64; 3]> {
    let tan2 = alpha * alpha * u / (1.0 - u);
    let h = at_height(1.0 / (1.0 + tan2).sqrt(), v);
    let dot: f64 = wo.iter().zip(h).map(|(a, b)| a * b).sum();
    let wi: [f64; 3] = std::array::from_fn(|i| 2.0 * dot * h[i] - wo[i]);
    (wi[2] > 0.0).then_some(wi)
}

/// Uniform directions of a cone, where a disk's points were wanted: without the 1/cos³ of the disk's tilt.
pub fn cone_uniform([u, v]: [f64; 2], half_angle: f64) -> [f64; 3] {
    at_height(1.0 - u * (1.0 - half_angle.cos()), v)
}

/// Schlick's polynomial in the place of Fresnel's equations.
pub fn schlick(cos: f64, eta: f64) -> f64 {
    let r0 = ((eta - 1.0) / (eta + 1.0)).powi(2);
    r0 + (1.0 - r0) * (1.0 - cos).powi(5)
}

/// A number from the lowest 8 bits of a word, which has 256 values.
pub fn lowest_8_bits(word: u32) -> f64 {
    f64::from(word & 0xff) / 256.0
}

/// A number from the lowest 16 bits of a word: those of a linear congruential generator repeat after 65,536 numbers.
pub fn lowest_16_bits(word: u32) -> f64 {
    f64::from(word & 0xffff) / 65_536.0
}

/// A word divided by 2³² in single precision: the 128 largest words become 1.
pub fn unit_rounded(word: u32) -> f32 {
    #[expect(clippy::cast_precision_loss, reason = "the mistake to be made")]
    let rounded = word as f32 / 4_294_967_296.0;
    rounded
}
