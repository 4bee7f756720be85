use super::{Domain, EDGE_ROUNDING, cross, dot, inside, is_unit, minus, unit};
use crate::error::InputError;

/// Unit vectors inside a spherical triangle; its measure is solid angle.
///
/// The map sweeps the great-circle arcs from the second vertex to the opposite side, from the first vertex to the third.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalTriangle {
    start: [f64; 3],
    apex: [f64; 3],
    /// Unit tangent at the first vertex, along the side that the arcs sweep.
    along: [f64; 3],
    /// Unit normal of that side's plane, on the apex's side.
    normal: [f64; 3],
    /// Angle at the first vertex, and tan(c/2) of the side c from there to the apex.
    angle: f64,
    half_side: f64,
    solid_angle: f64,
    /// What rounding of a direction can make of a coordinate.
    slack: f64,
}

impl SphericalTriangle {
    /// The triangle of the directions of three vectors of any length.
    ///
    /// * `vertices`: any order; no two opposite. The second is the apex of the map.
    ///
    /// # Errors
    /// `Parameter` if the solid angle is not a positive finite number.
    pub fn new(vertices: [[f64; 3]; 3]) -> Result<Self, InputError> {
        let [start, apex, end] = vertices.map(unit);
        let solid_angle = solid_angle([start, apex, end]);
        if !(solid_angle > 0.0 && solid_angle.is_finite()) {
            let name = "solid angle of a spherical triangle";
            return Err(InputError::Parameter { name, value: solid_angle, accepted: "above 0" });
        }
        let (along, to_apex) = (tangent(start, end), tangent(start, apex));
        let upright = cross(start, along);
        let side = dot(upright, to_apex);
        let normal = upright.map(|x| x.copysign(x * side));
        let longest = [[start, apex], [apex, end], [end, start]]
            .map(|[a, b]| length(minus(a, b)))
            .into_iter()
            .fold(0.0, f64::max);
        Ok(Self {
            start,
            apex,
            along,
            normal,
            angle: side.abs().atan2(dot(along, to_apex)),
            half_side: half_tangent(start, apex),
            solid_angle,
            slack: EDGE_ROUNDING * longest.max(1.0) * longest / solid_angle, // over the least height, 2·area/longest, twice
        })
    }

    /// Both coordinates before they are brought into [0, 1), and the slack of the first; `None` for what is no direction.
    pub(super) fn coordinates(&self, point: [f64; 3]) -> Option<([f64; 2], f64)> {
        if !is_unit(point) {
            return None;
        }
        let from_apex = minus(point, self.apex);
        let distance = length(from_apex);
        if distance == 0.0 {
            return Some(([0.5, 0.0], self.slack));
        }
        // Where the arc through the point meets the swept side.
        let w = tangent(self.apex, point);
        let arc = dot(minus(self.apex, self.start), self.normal).atan2(-dot(w, self.normal));
        let foot = self.ahead(self.apex, w, arc.sin(), (0.5 * arc).sin());
        let q = half_tangent(self.start, foot).copysign(dot(minus(foot, self.start), self.along));
        let (sin, cos) = self.angle.sin_cos();
        let pq = self.half_side * q;
        let swept = 2.0 * (pq * sin).atan2(1.0 + pq * cos);
        let reach = length(minus(foot, self.apex));
        let shares = [swept / self.solid_angle, (distance / reach).powi(2)];
        Some((shares, self.slack * (reach / distance)))
    }

    /// What rounding of a direction can make of a coordinate.
    pub(super) fn slack(&self) -> f64 {
        self.slack
    }

    /// The direction at an arc of given sine, and sine of its half, from `origin` towards its tangent `towards`.
    fn ahead(&self, origin: [f64; 3], towards: [f64; 3], sin: f64, sin_half: f64) -> [f64; 3] {
        let back = 2.0 * sin_half * sin_half;
        std::array::from_fn(|i| origin[i] + (towards[i] * sin - origin[i] * back))
    }
}

impl Domain for SphericalTriangle {
    type Point = [f64; 3];

    /// The share of the area that the arc from the apex has swept, and (1 − cos θ) as a share of that at the arc's end.
    ///
    /// tan(E/2) = sin α p q/(1 + cos α p q) for the area E between two sides whose halves have the tangents p and q, at the
    /// angle α: products of small numbers, so a small triangle keeps its digits.
    fn to_square(&self, point: [f64; 3]) -> Option<[f64; 2]> {
        let ([swept, along], slack) = self.coordinates(point)?;
        Some([inside(swept, slack)?, inside(along, 2.0 * self.slack)?])
    }

    fn point(&self, [swept, along]: [f64; 2]) -> [f64; 3] {
        let half = 0.5 * swept * self.solid_angle;
        let q = half.sin() / (self.half_side * (self.angle - half).sin());
        let square = 1.0 + q * q;
        let foot = self.ahead(self.start, self.along, 2.0 * q / square, q / square.sqrt());
        let half_reach = 0.5 * length(minus(foot, self.apex));
        let sin_half = along.sqrt() * half_reach;
        let cos_half = ((1.0 - sin_half) * (1.0 + sin_half)).max(0.0).sqrt();
        let w = tangent(self.apex, foot);
        self.ahead(self.apex, w, 2.0 * sin_half * cos_half, sin_half)
    }

    fn measure(&self) -> f64 {
        self.solid_angle
    }

    fn axes(&self) -> [&'static str; 2] {
        ["swept area", "(1 − cos θ)/(1 − cos θmax)"]
    }

    fn name(&self) -> &'static str {
        "spherical triangle"
    }
}

/// The solid angle of three directions, by the triple product of differences, which keeps its digits for small ones.
///
/// # Source
/// Van Oosterom and Strackee 1983, 10.1109/TBME.1983.325207.
fn solid_angle([a, b, c]: [[f64; 3]; 3]) -> f64 {
    let triple = dot(a, cross(minus(b, a), minus(c, a))).abs();
    2.0 * triple.atan2(1.0 + dot(a, b) + dot(b, c) + dot(c, a))
}

/// Unit tangent at direction `a` towards `b`: with d = b − a, the part of d across a, where d·a = −|d|²/2 loses no digit.
fn tangent(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let d = minus(b, a);
    let half_square = 0.5 * dot(d, d);
    unit(std::array::from_fn(|i| d[i] + a[i] * half_square))
}

/// tan of half the angle between two directions.
fn half_tangent(a: [f64; 3], b: [f64; 3]) -> f64 {
    length(minus(a, b)) / length(std::array::from_fn(|i| a[i] + b[i]))
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::tests::{assert_equal_measure, assert_round_trip};

    const OCTANT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    /// A triangle of that size about a direction without zeros.
    fn small(size: f64) -> SphericalTriangle {
        let corner = |x: f64, y: f64| [0.6 + 0.8 * size * x, 0.3 + size * y, 0.7 - size * x];
        SphericalTriangle::new([corner(0.0, 0.0), corner(1.0, 0.2), corner(0.1, 1.0)])
            .expect("not degenerate")
    }

    #[test]
    fn the_octant_has_its_area_and_holds_its_vertices() {
        let octant = SphericalTriangle::new(OCTANT).expect("not degenerate");
        assert!((octant.measure() - std::f64::consts::FRAC_PI_2).abs() < 1e-15); // one rounding
        for vertex in OCTANT {
            assert!(octant.to_square(vertex).is_some());
        }
        for outside in [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [0.6, 0.8 - 1e-4, -0.01]] {
            assert_eq!(octant.to_square(unit(outside)), None, "{outside:?}");
        }
        assert_eq!(octant.to_square([0.5, 0.5, 0.5]), None);
    }

    #[test]
    fn triangles_of_any_size_are_mapped_evenly_and_back() {
        for square in [[0.1, 0.2], [0.5, 0.5], [0.9, 0.3], [0.3, 0.95]] {
            assert_equal_measure(&SphericalTriangle::new(OCTANT).expect("not degenerate"), square);
            let large = [[1.0, 0.1, -0.4], [-0.5, 0.9, -0.4], [-0.4, -0.8, -0.5]];
            assert_equal_measure(&SphericalTriangle::new(large).expect("not degenerate"), square);
            for size in [1.0, 1e-2, 1e-4, 1e-6] {
                // A direction has a rounding of 2e-16; its distances are `size`, times some tens near the apex.
                assert_round_trip(&small(size), square, 1e-14 / size);
            }
        }
    }

    #[test]
    fn a_small_triangle_has_the_area_of_the_plane_one() {
        for size in [1e-4, 1e-6] {
            let corner = |x: f64, y: f64| [size * x, size * y, 1.0];
            let triangle = SphericalTriangle::new([corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)]);
            let area = triangle.expect("not degenerate").measure() / (0.5 * size * size);
            assert!((area - 1.0).abs() < size * size + 1e-9, "{area}"); // the sphere's sagitta; ε/size = 2e-10 of rounding
        }
    }

    #[test]
    fn points_beyond_each_side_are_outside() {
        let triangle = small(0.5);
        for square in [[-0.1, 0.5], [1.1, 0.5], [0.5, 1.2]] {
            assert_eq!(triangle.to_square(triangle.point(square)), None, "{square:?}");
        }
        assert!(triangle.to_square(triangle.point([0.5, 1.0])).is_some());
    }

    #[test]
    fn a_degenerate_triangle_is_refused() {
        assert!(SphericalTriangle::new([OCTANT[0], OCTANT[0], OCTANT[1]]).is_err());
        assert!(SphericalTriangle::new([[0.0; 3], OCTANT[0], OCTANT[1]]).is_err());
    }
}
