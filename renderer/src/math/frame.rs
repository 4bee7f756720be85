//! Right-handed orthonormal bases: the local frame in which z is the normal.

use glam::Vec3;
use wide::f32x8;

use super::eight::{Eight, Vec3x8};

/// Three perpendicular unit vectors with x × y = z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// First tangent.
    pub x: Vec3,
    /// Second tangent.
    pub y: Vec3,
    /// The axis: a surface's normal.
    pub z: Vec3,
}

impl Frame {
    /// Completes the unit vector `z` to a frame.
    ///
    /// # Precision, limits
    /// No branch and no direction that loses digits; lengths and angles are right to 1.6e-6, and to 5e-7 as far as seen.
    ///
    /// # Source
    /// Duff, Burgess, Christensen, Hery, Kensler, Liani and Villemin 2017, "Building an Orthonormal Basis,
    /// Revisited", JCGT 6(1), listing 3 (in `glam::Vec3::any_orthonormal_pair`).
    ///
    /// # Verified by
    /// `tests/properties.rs::frames_are_orthonormal`
    #[inline]
    pub fn from_z(z: Vec3) -> Self {
        let (x, y) = z.any_orthonormal_pair();
        Self { x, y, z }
    }

    /// Completes the unit vector `z` to a frame whose x axis is as near to `towards` as can be; any frame where that is
    /// parallel to `z`.
    pub fn from_z_towards(z: Vec3, towards: Vec3) -> Self {
        match (towards - z * z.dot(towards)).try_normalize() {
            Some(x) => Self { x, y: z.cross(x), z },
            None => Self::from_z(z),
        }
    }

    /// What [`Self::to_world`] makes of eight vectors in the frames that [`Self::from_z`] completes, bit for bit.
    #[inline]
    pub fn eight_to_world(z: Vec3x8, local: Vec3x8) -> Vec3x8 {
        let (Eight([zx, zy, zz]), Eight([x, y, w])) = (z, local);
        let one = f32x8::ONE;
        let sign = one.copysign(zz);
        let a = -one / (sign + zz);
        let b = zx * zy * a;
        let first = Eight([one + sign * zx * zx * a, sign * b, -sign * zx]);
        let second = Eight([b, sign + zy * zy * a, -zy]);
        first * x + second * y + z * w
    }

    /// The world vector `v` in local coordinates.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    /// The local vector `v` in world coordinates.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_can_lie_along_a_tangent() {
        let frame = Frame::from_z_towards(Vec3::Z, Vec3::new(0.0, 2.0, 5.0));
        assert_eq!(frame, Frame { x: Vec3::Y, y: Vec3::NEG_X, z: Vec3::Z });
        assert_eq!(Frame::from_z_towards(Vec3::Z, Vec3::NEG_Z), Frame::from_z(Vec3::Z));
    }

    #[test]
    fn the_poles_have_exact_frames() {
        for z in [Vec3::Z, Vec3::NEG_Z] {
            let frame = Frame::from_z(z);
            assert_eq!(frame.x.cross(frame.y), z);
            assert_eq!(frame.to_world(Vec3::Z), z);
            assert_eq!(frame.to_local(z), Vec3::Z);
        }
    }
}
