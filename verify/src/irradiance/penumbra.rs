use super::from_parallel_rectangle;

/// Irradiance under a rectangle of radiance 1 that an opaque half-plane hides in part.
///
/// The half-plane is parallel to both, at height h between receiver and light, and covers all x below its edge xₑ. From x the light is seen
/// from x + (xₑ − x)·H/h on; the rest is [`from_parallel_rectangle`].
///
/// * `light`: its x and y ranges; `heights`: h of the blocker and H of the light, 0 < h < H; `edge`: xₑ; `at`: x and y of the receiver.
///
/// Returns: W m⁻² per W m⁻² sr⁻¹.
///
/// # Source
/// Similar triangles, and Howell B-3 for what remains: exact.
#[must_use]
pub fn behind_half_plane(light: [[f64; 2]; 2], heights: [f64; 2], edge: f64, at: [f64; 2]) -> f64 {
    let [[x0, x1], [y0, y1]] = light;
    let cut = at[0] + (edge - at[0]) * heights[1] / heights[0];
    let seen = [x0.max(cut).min(x1), x1];
    from_parallel_rectangle(seen.map(|x| x - at[0]), [y0 - at[1], y1 - at[1]], heights[1])
}

#[cfg(test)]
mod tests {
    use super::super::Receiver;
    use super::super::quadrature::{kernel, over_square};
    use super::*;

    const LIGHT: [[f64; 2]; 2] = [[-0.5, 1.0], [-1.0, 0.5]];

    #[test]
    fn agrees_with_shadow_rays_over_the_light() {
        for x in [-2.0, -0.6, 0.0, 0.4, 2.0] {
            let receiver = Receiver { position: [x, 0.2, 0.0], normal: [0.0, 0.0, 1.0] };
            let numeric = over_square(1000, |s, t| {
                let point = [LIGHT[0][0] + 1.5 * s, LIGHT[1][0] + 1.5 * t, 2.0];
                let crossing = x + (point[0] - x) * 0.8 / 2.0;
                if crossing < 0.1 { 0.0 } else { 2.25 * kernel(receiver, point, [0.0, 0.0, 1.0]) }
            });
            // The cut falls within a column: half a node of 1/1000 of a light that gives at most 2.25/4.
            let exact = behind_half_plane(LIGHT, [0.8, 2.0], 0.1, [x, 0.2]);
            assert!((exact - numeric).abs() < 3e-4, "{x}: {exact} {numeric}");
        }
    }

    #[test]
    fn far_from_the_edge_it_is_dark_or_unshadowed() {
        let open = from_parallel_rectangle([-5.5, -4.0], [-1.0, 0.5], 2.0);
        assert_eq!(behind_half_plane(LIGHT, [0.8, 2.0], -10.0, [5.0, 0.0]), open);
        assert_eq!(behind_half_plane(LIGHT, [0.8, 2.0], 1.0, [-5.0, 0.0]), 0.0);
    }
}
