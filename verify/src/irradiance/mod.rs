//! Closed forms of what uniform lights give: irradiance and solid angles, to hold estimators against.
//!
//! Irradiance is for a light of radiance 1 W m⁻² sr⁻¹ that fills its outline as seen from the receiver, so it equals the projected
//! solid angle; times 1/π it is the form factor. A light that emits to one side only gives this where the receiver is on that side,
//! and nothing elsewhere.
//!
//! Every formula is tested against a second formula or against quadrature over the light.

mod disk;
mod furnace;
mod penumbra;
mod polygon;
mod rectangle;
mod solid_angle;
mod sphere;

pub use disk::from_parallel_disk;
pub use furnace::{furnace_radiance, integrating_sphere_irradiance};
pub use penumbra::behind_half_plane;
pub use polygon::from_polygon;
pub use rectangle::{between_parallel_rectangles, from_parallel_rectangle, from_perpendicular_rectangle};
pub use solid_angle::{
    disk_solid_angle, parallel_rectangle_solid_angle, polygon_solid_angle, sphere_solid_angle,
    triangle_solid_angle,
};
pub use sphere::from_sphere;

/// A receiver: where it is and which way it faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Receiver {
    /// Position, in any unit of length shared with the light.
    pub position: [f64; 3],
    /// Unit normal of the side that receives.
    pub normal: [f64; 3],
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn along(a: [f64; 3], t: f64, b: [f64; 3]) -> [f64; 3] {
    [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]]
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// Σ over the corners of `x` × `y`, with signs, of a function that is 0 on the axes: its integral's corner form.
fn quadrant_sum(x: [f64; 2], y: [f64; 2], corner: impl Fn(f64, f64) -> f64) -> f64 {
    corner(x[1], y[1]) - corner(x[0], y[1]) - corner(x[1], y[0]) + corner(x[0], y[0])
}

#[cfg(test)]
pub(crate) mod quadrature {
    //! The independent route: the midpoint rule over a light's area or a cone of directions.
    use super::{Receiver, dot, length, minus};

    /// Midpoint rule with n×n nodes over the unit square.
    pub(crate) fn over_square(n: u32, f: impl Fn(f64, f64) -> f64) -> f64 {
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        let row = |i: u32| -> f64 { (0..n).map(|j| f(at(i), at(j))).sum() };
        (0..n).map(row).sum::<f64>() / f64::from(n).powi(2)
    }

    /// Midpoint rule with n nodes over [0, 1].
    pub(crate) fn over_unit(n: u32, f: impl Fn(f64) -> f64) -> f64 {
        (0..n).map(|i| f((f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n)
    }

    /// cos θ·|cos θ'|/r² from the receiver to a light's point with the given unit normal; 0 below the horizon.
    pub(crate) fn kernel(receiver: Receiver, point: [f64; 3], normal: [f64; 3]) -> f64 {
        let to = minus(point, receiver.position);
        let r = length(to);
        (dot(to, receiver.normal) / r).max(0.0) * (dot(to, normal) / r).abs() / (r * r)
    }
}
