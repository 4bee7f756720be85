use super::{Domain, EDGE_ROUNDING, inside, is_unit, turn};

/// Unit vectors within an angle of +z: the sphere, the hemisphere and cones; its measure is solid angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Directions {
    name: &'static str,
    /// 1 − cos of the largest angle from +z.
    depth: f64,
}

impl Directions {
    /// All directions.
    pub fn sphere() -> Self {
        Self { name: "sphere", depth: 2.0 }
    }

    /// Directions with z at least 0.
    pub fn hemisphere() -> Self {
        Self { name: "hemisphere", depth: 1.0 }
    }

    /// Directions within `half_angle` of +z.
    ///
    /// * `half_angle`: radians, in (0, π].
    pub fn cone(half_angle: f64) -> Self {
        let half = (0.5 * half_angle).sin();
        Self { name: "cone", depth: 2.0 * half * half }
    }
}

impl Domain for Directions {
    type Point = [f64; 3];

    /// The share of the height between pole and rim (Archimedes: dω = dz dφ), and the angle about z as a
    /// share of the circle.
    #[inline]
    fn to_square(&self, [x, y, z]: [f64; 3]) -> Option<[f64; 2]> {
        if !is_unit([x, y, z]) {
            return None;
        }
        let ring = x * x + y * y;
        let below_pole = if z > 0.0 { ring / (1.0 + z) } else { 1.0 - z }; // 1 − z without cancellation
        Some([inside(below_pole / self.depth, EDGE_ROUNDING / self.depth.min(1.0).sqrt())?, turn(x, y)])
    }

    #[inline]
    fn point(&self, [share, turn]: [f64; 2]) -> [f64; 3] {
        let below_pole = share * self.depth;
        let ring = (below_pole * (2.0 - below_pole)).max(0.0).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
        [ring * cos, ring * sin, 1.0 - below_pole]
    }

    fn measure(&self) -> f64 {
        std::f64::consts::TAU * self.depth
    }

    fn axes(&self) -> [&'static str; 2] {
        ["(1 − cos θ)/(1 − cos θmax)", "φ/2π"]
    }

    fn name(&self) -> &'static str {
        self.name
    }

    fn coarse_grid(&self) -> [usize; 2] {
        [10, 20]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_rim_and_outside() {
        assert_eq!(Directions::sphere().to_square([0.0, 0.0, 1.0]), Some([0.0, 0.0]));
        assert!(Directions::sphere().to_square([0.0, 0.0, -1.0]).is_some_and(|[x, _]| x < 1.0));
        assert!(
            Directions::hemisphere().to_square([0.0, 1.0, 0.0]).is_some_and(|[x, y]| x < 1.0 && y == 0.25)
        );
        assert_eq!(Directions::hemisphere().to_square([0.0, 0.6, -0.8]), None);
        assert_eq!(Directions::sphere().to_square([0.0, 0.9, 0.0]), None);
    }

    #[test]
    fn a_narrow_cone_keeps_its_digits() {
        let cone = Directions::cone(1e-4);
        let [x, _] = cone.to_square(cone.point([0.25, 0.1])).expect("inside");
        assert!((x - 0.25).abs() < 1e-12); // sin²θ/(1 + cos θ) has a relative error of a few ulp
        assert!((cone.measure() / (std::f64::consts::PI * 1e-8) - 1.0).abs() < 1e-8); // θ²/12 of the small-angle form
    }
}
