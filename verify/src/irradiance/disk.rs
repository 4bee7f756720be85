/// Irradiance from a disk of radiance 1 in a plane parallel to the receiver's.
///
/// F = ½[1 − q/D], q = h² + a² − R², D = √(q² + 4R²h²) and E = πF; on the axis F = R²/(R² + h²). For q > 0 the difference is
/// computed as 2R²h²/(D(D + q)), which loses no digits for small disks.
///
/// * `radius` R ≥ 0, `height` h > 0 of the disk's plane, `offset` a: from the disk's axis to the receiver.
///
/// Returns: W m⁻² per W m⁻² sr⁻¹.
///
/// # Source
/// Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-13 and B-12 (on the axis), rearranged.
#[must_use]
pub fn from_parallel_disk(radius: f64, height: f64, offset: f64) -> f64 {
    let q = height * height + (offset - radius) * (offset + radius);
    let reach = 2.0 * radius * height;
    let d = q.hypot(reach);
    let factor = if q > 0.0 { 0.5 * reach * reach / (d * (d + q)) } else { 0.5 * (d - q) / d };
    std::f64::consts::PI * factor
}

#[cfg(test)]
mod tests {
    use super::super::quadrature::{kernel, over_square};
    use super::super::{Receiver, from_polygon};
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn receiver(offset: f64) -> Receiver {
        Receiver { position: [offset, 0.0, 0.0], normal: [0.0, 0.0, 1.0] }
    }

    #[test]
    fn agrees_with_quadrature_over_the_disk() {
        for (radius, height, offset) in [(1.0, 2.0, 0.0), (1.0, 0.5, 0.7), (0.5, 1.0, 3.0), (2.0, 0.7, 2.0)] {
            let numeric = over_square(600, |s, t| {
                let (r, angle) = (radius * s, 2.0 * PI * t);
                let point = [r * angle.cos(), r * angle.sin(), height];
                2.0 * PI * radius * r * kernel(receiver(offset), point, [0.0, 0.0, 1.0])
            });
            // Midpoint rule, h = 1/600: h²/24·|f''| with |f''| below 400 at the nearest point.
            assert!(
                (from_parallel_disk(radius, height, offset) - numeric).abs() < 5e-5,
                "{radius} {height} {offset}"
            );
        }
    }

    #[test]
    fn agrees_with_a_polygon_of_many_sides() {
        let corner = |i: u32| {
            let angle = 2.0 * PI * f64::from(i) / 20_000.0;
            [0.8 * angle.cos(), 0.8 * angle.sin(), 1.3]
        };
        let polygon: Vec<_> = (0..20_000).map(corner).collect();
        for offset in [0.0, 0.5, 4.0] {
            let ratio = from_parallel_disk(0.8, 1.3, offset) / from_polygon(receiver(offset), &polygon);
            // The inscribed polygon is smaller by (2π/n)²/6 = 1.6e-8, weighted by the rim's share of the light.
            assert!((ratio - 1.0).abs() < 4e-8, "{offset}: {ratio}");
        }
    }

    proptest! {
        /// The inscribed polygon of n sides lacks the share (2π/n)²/6 of the area, which gives at most 1/h² each.
        #[test]
        fn agrees_with_an_inscribed_polygon(
            radius in 0.01..3.0_f64, height in 0.3..3.0_f64, offset in 0.0..6.0_f64,
        ) {
            let sides = 2000_u32;
            let corner = |i: u32| {
                let angle = 2.0 * PI * f64::from(i) / f64::from(sides);
                [radius * angle.cos(), radius * angle.sin(), height]
            };
            let polygon: Vec<_> = (0..sides).map(corner).collect();
            let lacks = from_parallel_disk(radius, height, offset) - from_polygon(receiver(offset), &polygon);
            let share = (2.0 * PI / f64::from(sides)).powi(2) / 6.0;
            // 2,000 terms round by 1e-16 each.
            prop_assert!(lacks > -1e-12 && lacks < share * PI * (radius / height).powi(2) + 1e-12);
        }
    }

    #[test]
    fn the_axis_and_tiny_disks_keep_their_digits() {
        assert!((from_parallel_disk(3.0, 4.0, 0.0) / PI - 9.0 / 25.0).abs() < 1e-15); // a few roundings of 1.1e-16
        // A tiny disk is a point of area πR²: E = πR²h²/(h² + a²)², off by (R/h)² = 1e-18.
        let tiny = from_parallel_disk(1e-9, 1.0, 2.0) / (PI * 1e-18 / 25.0);
        assert!((tiny - 1.0).abs() < 1e-15);
    }
}
