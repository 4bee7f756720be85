//! Uniform directions to a rectangle, by its solid angle.

/// A rectangle as seen from a point: its solid angle, and the map of the unit square onto it that is uniform there.
///
/// With the point's foot on the rectangle's plane as origin and the height h as unit of everything, a vertical line
/// at x and the lines y₀, y₁ enclose, from the foot on, the solid angle G with
/// sin G = s·(b₁√(1 − s²b₀²) − b₀√(1 − s²b₁²)), where s = x/√(x² + h²) and bⱼ = yⱼ/√(yⱼ² + h²). The first number
/// shares out G between the two sides and is solved for x; the second shares out the height of the great circle at x.
///
/// # Precision, limits
/// Sines and differences are formed without cancellation, so that the relative error of the solid angle stays below
/// 1e-9 from 1e-10 sr to the hemisphere, and that of the place within the rectangle below 1e-6 of its sides for heights
/// above a hundredth of them and sides of up to 100 : 1; numbers of 24 digits have no finer steps.
///
/// # Source
/// Ureña, Fajardo and King 2013, "An area-preserving parametrization for spherical rectangles",
/// doi 10.1111/cgf.12151. Its angles by arc cosine lose all digits of small rectangles; the sines above are ours.
///
/// # Verified by
/// `tests/solid_angles.rs`; claims `light/rectangle/*`
#[derive(Debug, Clone, Copy)]
pub struct SphericalRectangle {
    corner: [f64; 2],
    size: [f64; 2],
    height: f64,
    /// bⱼ of the two sides along x, and their difference.
    sines: [f64; 2],
    sine_width: f64,
    /// Sine and cosine of G at the side x₀.
    start: [f64; 2],
    solid_angle: f64,
}

impl SphericalRectangle {
    /// The rectangle from `corner` to `corner` + `size`, in its plane's coordinates around the foot of the point.
    ///
    /// * `size`, `height`: above 0; `height` is the point's distance from the plane.
    pub fn new(corner: [f64; 2], size: [f64; 2], height: f64) -> Self {
        let [[x0, x1], [y0, y1]] = [0, 1].map(|i| [corner[i], corner[i] + size[i]]);
        let slant = |y: f64| (y * y + height * height).sqrt();
        let (r0, r1) = (slant(y0), slant(y1));
        let [b0, b1] = [y0 / r0, y1 / r1];
        let ratio = height / (r0 * r1);
        // b₁² − b₀², and from it the difference, unless the signs already make it a sum.
        let squares = ratio * ratio * size[1] * (y1 + y0);
        let sine_width = if b0 * b1 > 0.0 { squares / (b1 + b0) } else { b1 - b0 };
        let s = x0 / slant(x0);
        let [c0, c1] = [b0, b1].map(|b| ((1.0 - s * b) * (1.0 + s * b)).max(0.0).sqrt());
        let rise = if b0 * b1 > 0.0 { squares / (b1 * c0 + b0 * c1) } else { b1 * c0 - b0 * c1 };
        let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        Self {
            corner,
            size,
            height,
            sines: [b0, b1],
            sine_width,
            start: [s * rise, c0 * c1 + s * s * b0 * b1],
            solid_angle: solid_angle(corners, height, size[0] * size[1]),
        }
    }

    /// The solid angle in steradians.
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// The place on the rectangle for `u` in [0, 1]², as shares of its sides in [0, 1].
    ///
    /// # Measure
    /// 1 / `solid_angle()` per steradian.
    pub fn sample(&self, u: [f64; 2]) -> [f64; 2] {
        let h = self.height;
        let (sin, cos) = libm::sincos(u[0] * self.solid_angle);
        let sin_g = self.start[0] * cos + self.start[1] * sin;
        let cos_g = self.start[1] * cos - self.start[0] * sin;
        // The square of sin G / s is (b₁ − b₀)² + 2b₀b₁(1 − cos G), or (b₁ + b₀)² − 2b₀b₁(1 + cos G) where the sines
        // have two signs and the first would cancel.
        let fall = sin_g * sin_g / (1.0 + cos_g.abs());
        let ([b0, b1], width) = (self.sines, self.sine_width);
        let square = if cos_g > 0.0 {
            width * width + 2.0 * b0 * b1 * fall
        } else {
            (b1 + b0).powi(2) - 2.0 * b0 * b1 * fall
        };
        let x = h * sin_g / (square - sin_g * sin_g).max(0.0).sqrt();
        let share_x = share(x, self.corner[0], self.size[0]);

        let distance2 = (self.corner[0] + share_x * self.size[0]).powi(2) + h * h;
        let sine = |y: f64| y / (y * y + distance2).sqrt();
        let [v0, v1] = [sine(self.corner[1]), sine(self.corner[1] + self.size[1])];
        let v = v0 + u[1] * (v1 - v0);
        let y = v * (distance2 / ((1.0 - v) * (1.0 + v))).sqrt();
        [share_x, share(y, self.corner[1], self.size[1])]
    }
}

/// Where `place` lies between `start` and `start` + `size`: 0 to 1, whatever rounding makes of it.
fn share(place: f64, start: f64, size: f64) -> f64 {
    ((place - start) / size).clamp(0.0, 1.0)
}

/// The solid angle of the rectangle of these corners around the foot.
///
/// Around the foot it is the sum over the corners of atan(|xy| / (h·r)), whose terms have one sign there. Elsewhere it
/// is the sum of two triangles, each 2·atan2(volume, denominator), as one complex product; with the foot on the common
/// side the denominators would vanish.
///
/// # Source
/// van Oosterom and Strackee 1983, doi 10.1109/TBME.1983.325207.
fn solid_angle(corners: [[f64; 2]; 4], height: f64, area: f64) -> f64 {
    let h2 = height * height;
    let dot = |i: usize, j: usize| corners[i][0] * corners[j][0] + corners[i][1] * corners[j][1] + h2;
    let length = [0, 1, 2, 3].map(|i| dot(i, i).sqrt());
    let is_around = |axis: usize| corners[0][axis] * corners[2][axis] < 0.0;
    if is_around(0) && is_around(1) {
        let corner = |i: usize| [height * length[i], (corners[i][0] * corners[i][1]).abs()];
        let pair = |i, j| {
            let ([c0, s0], [c1, s1]) = (corner(i), corner(j));
            libm::atan2(c0 * s1 + s0 * c1, c0 * c1 - s0 * s1)
        };
        return pair(0, 1) + pair(2, 3);
    }
    let denominator = |b: usize, c: usize| {
        length[0] * length[b] * length[c]
            + dot(0, b) * length[c]
            + dot(b, c) * length[0]
            + dot(c, 0) * length[b]
    };
    let (n, d0, d1) = (height * area, denominator(1, 2), denominator(2, 3));
    2.0 * libm::atan2(n * (d0 + d1), d0 * d1 - n * n)
}
