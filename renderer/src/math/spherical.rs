//! Angles of unit vectors in a local frame, where z is the normal.

use glam::Vec3;

/// cos θ, θ from the normal; negative below the surface.
#[inline]
pub fn cos_theta(w: Vec3) -> f32 {
    w.z
}

/// |cos θ|.
#[inline]
pub fn abs_cos_theta(w: Vec3) -> f32 {
    w.z.abs()
}

/// cos² θ.
#[inline]
pub fn cos2_theta(w: Vec3) -> f32 {
    w.z * w.z
}

/// sin² θ = x² + y², which keeps its digits near the normal where 1 − cos² θ has none.
#[inline]
pub fn sin2_theta(w: Vec3) -> f32 {
    w.x * w.x + w.y * w.y
}

/// sin θ, never negative.
#[inline]
pub fn sin_theta(w: Vec3) -> f32 {
    sin2_theta(w).sqrt()
}

/// tan² θ; infinite at the horizon.
#[inline]
pub fn tan2_theta(w: Vec3) -> f32 {
    sin2_theta(w) / cos2_theta(w)
}

/// Whether both vectors are on the same side of the surface; a vector in the surface is on neither.
#[inline]
pub fn same_hemisphere(a: Vec3, b: Vec3) -> bool {
    a.z * b.z > 0.0
}

/// The unit vector at polar angle θ, given by its sine and cosine, and azimuth `phi` in radians from x towards y.
#[inline]
pub fn direction(sin_theta: f32, cos_theta: f32, phi: f32) -> Vec3 {
    let (sin_phi, cos_phi) = libm::sincosf(phi);
    Vec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

/// The azimuth of `(x, y)` as a share of the full turn, in [0, 1): 0 on x, ¼ on y.
#[inline]
pub fn turn(x: f32, y: f32) -> f32 {
    let turn = libm::atan2f(y, x) * (0.5 / std::f32::consts::PI);
    // A small negative azimuth plus 1 rounds to 1, which is the same direction as 0.
    let wrapped = if turn < 0.0 { turn + 1.0 } else { turn };
    if wrapped < 1.0 { wrapped } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_of_the_axes() {
        assert_eq!((cos_theta(Vec3::Z), sin_theta(Vec3::Z), tan2_theta(Vec3::Z)), (1.0, 0.0, 0.0));
        assert_eq!((abs_cos_theta(Vec3::NEG_Z), cos2_theta(Vec3::NEG_Z)), (1.0, 1.0));
        assert_eq!((sin2_theta(Vec3::X), tan2_theta(Vec3::X)), (1.0, f32::INFINITY));
    }

    #[test]
    fn a_vector_in_the_surface_is_on_neither_side() {
        assert!(same_hemisphere(Vec3::NEG_Z, Vec3::new(0.6, 0.0, -0.8)));
        assert!(!same_hemisphere(Vec3::Z, Vec3::NEG_Z));
        assert!(!same_hemisphere(Vec3::X, Vec3::Z));
    }

    #[test]
    fn turns_of_the_axes() {
        assert_eq!(
            [turn(1.0, 0.0), turn(0.0, 1.0), turn(-1.0, 0.0), turn(0.0, -1.0)],
            [0.0, 0.25, 0.5, 0.75]
        );
        assert_eq!(turn(1.0, -1.0e-30), 0.0, "just before the full turn");
        assert_eq!(turn(0.0, 0.0), 0.0);
    }
}
