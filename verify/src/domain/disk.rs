use super::{Domain, EDGE_ROUNDING, inside, turn};

/// Points of the plane within a radius of the origin; its measure is area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disk {
    radius: f64,
}

impl Disk {
    /// The disk of radius 1.
    pub fn unit() -> Self {
        Self::of_radius(1.0)
    }

    /// The disk of a given radius.
    ///
    /// * `radius`: above 0; otherwise every point is outside.
    pub fn of_radius(radius: f64) -> Self {
        Self { radius }
    }
}

impl Domain for Disk {
    type Point = [f64; 2];

    /// The square of the distance from the centre over that of the edge, and the angle as a share of the
    /// circle: r dr dφ = d(r²/2) dφ.
    #[inline]
    fn to_square(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let share = inside((x * x + y * y) / (self.radius * self.radius), 2.0 * EDGE_ROUNDING)?;
        Some([share, turn(x, y)])
    }

    #[inline]
    fn point(&self, [share, turn]: [f64; 2]) -> [f64; 2] {
        let r = self.radius * share.sqrt();
        let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
        [r * cos, r * sin]
    }

    fn measure(&self) -> f64 {
        std::f64::consts::PI * self.radius * self.radius
    }

    fn axes(&self) -> [&'static str; 2] {
        ["r²/R²", "φ/2π"]
    }

    fn name(&self) -> &'static str {
        "disk"
    }

    fn coarse_grid(&self) -> [usize; 2] {
        [10, 20]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centre_edge_and_outside() {
        let disk = Disk::of_radius(2.0);
        assert_eq!(disk.to_square([0.0, 0.0]), Some([0.0, 0.0]));
        assert_eq!(disk.to_square([0.0, 1.0]), Some([0.25, 0.25]));
        assert!(disk.to_square([-2.0, 0.0]).is_some());
        assert_eq!(disk.to_square([-2.001, 0.0]), None);
        assert_eq!(disk.to_square([f64::NAN, 0.0]), None);
        assert_eq!(disk.measure(), 4.0 * std::f64::consts::PI);
    }
}
