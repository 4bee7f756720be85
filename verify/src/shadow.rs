//! Closed forms of soft shadows: irradiance under lights that something hides in part.
//!
//! Lights have the radiance 1 and lie in a plane parallel to the receiver's, which is z = 0 and faces +z.

use crate::coverage::clip_to_convex;
use crate::irradiance::{Receiver, from_parallel_disk, from_polygon, from_sphere};

/// Irradiance at `at` of the plane z = 0 from a flat light, of which a flat convex blocker hides a part.
///
/// The blocker's shadow on the light's plane, seen from the receiver, is the polygon p + (b − p)·H/h over its corners b; what
/// the light has in common with it does not count.
///
/// * `light`, `blocker`: corners x, y, counter-clockwise seen from above, both convex; `heights`: h of the blocker and H of the
///   light, 0 < h < H; `at`: x and y of the receiver.
///
/// Returns: W m⁻² per W m⁻² sr⁻¹.
///
/// # Precision, limits
/// An absolute error of about 1e-15: the difference of two polygons' irradiances.
///
/// # Source
/// Similar triangles; Lambert's formula for both polygons: exact.
#[must_use]
pub fn behind_polygon(light: &[[f64; 2]], blocker: &[[f64; 2]], heights: [f64; 2], at: [f64; 2]) -> f64 {
    let [h, height] = heights;
    let receiver = Receiver { position: [at[0], at[1], 0.0], normal: [0.0, 0.0, 1.0] };
    let raised = |polygon: &[[f64; 2]]| polygon.iter().map(|p| [p[0], p[1], height]).collect::<Vec<_>>();
    let cast = |b: &[f64; 2]| [0, 1].map(|i| at[i] + (b[i] - at[i]) * height / h);
    let shadow: Vec<[f64; 2]> = blocker.iter().map(cast).collect();
    let hidden = raised(&clip_to_convex(light, &shadow));
    from_polygon(receiver, &raised(light)) - from_polygon(receiver, &hidden)
}

/// Irradiance under a round light with a ball before it, both with their middles on the z axis.
///
/// Where the ball's outline lies within the light's: the light's irradiance less that of the ball, if it shone.
///
/// * `light`: radius and height; `ball`: radius and height of its middle; `offset`: of the receiver from the axis.
///
/// Returns: W m⁻² per W m⁻² sr⁻¹; `None` where the ball's outline leaves the light's.
///
/// # Source
/// Irradiance depends on the outline alone: Howell B-13 less B-42.
#[must_use]
pub fn behind_ball(light: [f64; 2], ball: [f64; 2], offset: f64) -> Option<f64> {
    let ([radius, height], [r, h]) = (light, ball);
    // The cone of the ball meets the light's plane in an ellipse; its ends in the plane through axis and receiver.
    let (distance, tilt) = (h.hypot(offset), offset.atan2(h));
    let sigma = (r / distance).asin();
    let end = |angle: f64| offset - height * (tilt + angle).tan();
    if r >= h || end(sigma) < -radius || end(-sigma) > radius || tilt + sigma >= std::f64::consts::FRAC_PI_2 {
        return None;
    }
    // Across, the ellipse is narrower than its length, so that within these ends it is within the light for the small
    // offsets at which its middle stays near the light's; the outline's points decide.
    let inside = (0..256).all(|i| {
        let turn = std::f64::consts::TAU * f64::from(i) / 256.0;
        // A direction of the cone: axis cos σ + sin σ (u cos t + v sin t), u in the plane, v = y.
        let (sin, cos) = sigma.sin_cos();
        let x = -tilt.sin() * cos + tilt.cos() * sin * turn.cos();
        let z = tilt.cos() * cos + tilt.sin() * sin * turn.cos();
        let y = sin * turn.sin();
        (offset + x * height / z).hypot(y * height / z) <= radius
    });
    let receiver = Receiver { position: [offset, 0.0, 0.0], normal: [0.0, 0.0, 1.0] };
    inside.then(|| from_parallel_disk(radius, height, offset) - from_sphere(receiver, [0.0, 0.0, h], r))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::irradiance::behind_half_plane;
    use crate::irradiance::quadrature::{kernel, over_square};

    const UP: [f64; 3] = [0.0, 0.0, 1.0];
    const LIGHT: [[f64; 2]; 4] = [[-0.5, -1.0], [1.0, -1.0], [1.0, 0.5], [-0.5, 0.5]];

    #[test]
    fn a_rectangle_agrees_with_shadow_rays_over_the_light() {
        let blocker = [[-0.3, -0.4], [0.4, -0.4], [0.4, 0.2], [-0.3, 0.2]];
        for at in [[0.0, 0.0], [0.5, -0.3], [-0.7, 0.6], [3.0, 0.0]] {
            let receiver = Receiver { position: [at[0], at[1], 0.0], normal: UP };
            let numeric = over_square(1000, |s, t| {
                let point = [1.5 * s - 0.5, 1.5 * t - 1.0, 2.0];
                let crossing = [0, 1].map(|i| at[i] + (point[i] - at[i]) * 0.4);
                let hidden = (-0.3..0.4).contains(&crossing[0]) && (-0.4..0.2).contains(&crossing[1]);
                if hidden { 0.0 } else { 2.25 * kernel(receiver, point, UP) }
            });
            // Each of four cuts falls within a row or column: half a node of 1/1000 of a light of at most 2.25/4.
            assert!((behind_polygon(&LIGHT, &blocker, [0.8, 2.0], at) - numeric).abs() < 1.2e-3, "{at:?}");
        }
    }

    #[test]
    fn a_wide_rectangle_is_a_half_plane() {
        let half = [[-99.0, -99.0], [0.1, -99.0], [0.1, 99.0], [-99.0, 99.0]];
        for x in [-1.0, -0.2, 0.1, 0.5, 2.0] {
            let plane = behind_half_plane([[-0.5, 1.0], [-1.0, 0.5]], [0.8, 2.0], 0.1, [x, 0.2]);
            // Differences of irradiances up to 1, each to a few roundings.
            assert!((behind_polygon(&LIGHT, &half, [0.8, 2.0], [x, 0.2]) - plane).abs() < 1e-14);
        }
    }

    #[test]
    fn a_ball_agrees_with_shadow_rays_and_is_none_at_the_rim() {
        for offset in [0.0, 0.2, 0.4] {
            let receiver = Receiver { position: [offset, 0.0, 0.0], normal: UP };
            let numeric = over_square(1500, |s, t| {
                let (r, turn) = (1.5 * s, std::f64::consts::TAU * t);
                let point = [r * turn.cos(), r * turn.sin(), 2.0];
                let to = [point[0] - offset, point[1], 2.0];
                let length = (to[0] * to[0] + to[1] * to[1] + 4.0).sqrt();
                // Squared distance of the ball's middle from the ray.
                let along = (-offset * to[0] + to[2]) / length;
                let apart = offset * offset + 1.0 - along * along;
                if apart < 0.09 {
                    0.0
                } else {
                    2.0 * std::f64::consts::PI * 1.5 * r * kernel(receiver, point, UP)
                }
            });
            let exact = behind_ball([1.5, 2.0], [0.3, 1.0], offset).expect("the ball is inside");
            // The rim falls within half a node of 1/1500 of what a row gives, below 2π·1.5·0.6/4 = 1.4.
            assert!((exact - numeric).abs() < 5e-4, "{offset}: {exact} {numeric}");
        }
        assert_eq!(behind_ball([1.5, 2.0], [0.3, 1.0], 1.2), None);
        assert_eq!(behind_ball([0.5, 2.0], [0.3, 1.0], 0.0), None);
    }
}
