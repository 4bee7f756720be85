//! Densities per steradian in double precision, written from their definitions and not from the renderer's code.

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::DVec3;

/// cos θ/π above the surface.
pub(in super::super) fn diffuse(wi: DVec3) -> f64 {
    FRAC_1_PI * wi.z.max(0.0)
}

/// Microfacets, rough by two numbers along x and y.
///
/// # Source
/// Walter, Marschner, Li, Torrance 2007, equations 25, 26, 33 and 34; with two numbers: Heitz 2014, section 5.
#[derive(Clone, Copy)]
pub(in super::super) enum Normals {
    /// GGX.
    Ggx([f64; 2]),
    /// Beckmann.
    Beckmann([f64; 2]),
}

impl Normals {
    /// tan² θ in a plane stretched by the roughness: along φ, tan² θ (cos² φ/αx² + sin² φ/αy²).
    pub(in super::super) fn steepness(self, h: DVec3) -> f64 {
        let (Self::Ggx([ax, ay]) | Self::Beckmann([ax, ay])) = self;
        ((h.x / ax).powi(2) + (h.y / ay).powi(2)) / (h.z * h.z)
    }

    /// D: the area of microfacets per steradian of normals.
    pub(in super::super) fn d(self, h: DVec3) -> f64 {
        let t = self.steepness(h);
        let peak = |[ax, ay]: [f64; 2]| FRAC_1_PI / (ax * ay * h.z.powi(4));
        match self {
            Self::Ggx(alpha) => peak(alpha) / (1.0 + t).powi(2),
            Self::Beckmann(alpha) => peak(alpha) * (-t).exp(),
        }
    }

    /// Smith's G₁: 2/(1 + √(1 + 1/a²)) of GGX, 2/(1 + erf a + exp(−a²)/(a√π)) of Beckmann, a = cot θ over the
    /// roughness along φ.
    pub(in super::super) fn g1(self, w: DVec3) -> f64 {
        let (Self::Ggx([ax, ay]) | Self::Beckmann([ax, ay])) = self;
        let a = w.z / (ax * w.x).hypot(ay * w.y);
        match self {
            Self::Ggx(_) => 2.0 / (1.0 + (1.0 + 1.0 / (a * a)).sqrt()),
            Self::Beckmann(_) => 2.0 / (1.0 + erf(a) + (-a * a).exp() / (a * std::f64::consts::PI.sqrt())),
        }
    }

    /// Mirrored visible normals: G₁(wo)·(wo·h)·D(h)/cos θₒ, times the Jacobian 1/(4·wo·h).
    ///
    /// # Source
    /// Walter, Marschner, Li, Torrance 2007, equation 14; Heitz 2014, equation 3.
    pub(in super::super) fn mirrored(self, wo: DVec3, wi: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        self.g1(wo) * self.d((wo + wi).normalize()) / (4.0 * wo.z)
    }

    /// Ground glass seen from either side: mirrored visible normals with the share F(wo·h), refracted ones with the
    /// rest and the Jacobian η²·|wi·h|/|wo + η·wi|².
    ///
    /// * `eta`: index below the surface over that above it.
    ///
    /// # Source
    /// Walter, Marschner, Li, Torrance 2007, equations 16 and 17.
    pub(in super::super) fn through(self, eta: f64, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z < 0.0 {
            return self.through(1.0 / eta, -wo, -wi);
        }
        if wi.z > 0.0 {
            return fresnel(wo.dot((wo + wi).normalize()), eta) * self.mirrored(wo, wi);
        }
        let sum = wo + eta * wi;
        let h = sum.normalize() * sum.z.signum();
        let [near, far] = [wo.dot(h), -wi.dot(h)];
        if near <= 0.0 || far <= 0.0 {
            return 0.0;
        }
        let visible = self.g1(wo) * near * self.d(h) / wo.z;
        (1.0 - fresnel(near, eta)) * visible * eta * eta * far / sum.length_squared()
    }
}

/// The error function: 2/√π·exp(−x²)·Σ 2ⁿ x²ⁿ⁺¹/(1·3·…·(2n + 1)).
///
/// # Source
/// Abramowitz, Stegun: Handbook of Mathematical Functions, 7.1.6.
fn erf(x: f64) -> f64 {
    if x > 6.0 {
        return 1.0; // 1 − erf 6 = 2e-17
    }
    let (mut term, mut sum, mut odd) = (x, x, 1.0);
    while term > 1e-17 * sum {
        odd += 2.0;
        term *= 2.0 * x * x / odd;
        sum += term;
    }
    sum * (-x * x).exp() * 2.0 / std::f64::consts::PI.sqrt()
}

/// Smith's G₁ of round GGX.
pub(in super::super) fn ggx_g1(alpha: f64, w: DVec3) -> f64 {
    Normals::Ggx([alpha; 2]).g1(w)
}

/// Mirrored visible normals of round GGX.
pub(in super::super) fn ggx(alpha: f64, wo: DVec3, wi: DVec3) -> f64 {
    Normals::Ggx([alpha; 2]).mirrored(wo, wi)
}

/// Phong's highlight (n + 1)/(2π)·cosⁿ α about the mirrored direction, above the surface.
pub(in super::super) fn highlight(exponent: i32, wo: DVec3, wi: DVec3) -> f64 {
    let mirrored = DVec3::new(-wo.x, -wo.y, wo.z);
    let cos = mirrored.normalize().dot(wi.normalize()).max(0.0);
    if wi.z <= 0.0 { 0.0 } else { f64::from(exponent + 1) / TAU * cos.powi(exponent) }
}

/// The blur disk: 1/(π f² cos³ γ) where tan γ ≤ f about the ideal direction, on that direction's side of the surface.
pub(in super::super) fn blur(f: f64, ideal: DVec3, wi: DVec3) -> f64 {
    let cos = ideal.dot(wi) / wi.length();
    let tan = ideal.cross(wi).length() / ideal.dot(wi);
    let inside = cos > 0.0 && tan <= f && wi.z * ideal.z > 0.0;
    if inside { FRAC_1_PI / (f * f * cos.powi(3)) } else { 0.0 }
}

/// Fresnel's reflectance by the sines and tangents of both angles; `eta` is the far side's index over the near side's.
pub(in super::super) fn fresnel(cos: f64, eta: f64) -> f64 {
    let near = cos.min(1.0).acos();
    if near < 1e-6 {
        return ((eta - 1.0) / (eta + 1.0)).powi(2); // the next term is of the order of the angle's square
    }
    let sin = near.sin() / eta;
    if sin >= 1.0 {
        return 1.0;
    }
    let far = sin.asin();
    let s = (near - far).sin() / (near + far).sin();
    let p = (near - far).tan() / (near + far).tan();
    0.5 * (s * s + p * p)
}

/// The reflectance of a metal of index m = η + ik, by complex arithmetic: the mean of |(c − q)/(c + q)|² and
/// |(m²c − q)/(m²c + q)|², q² = m² − sin² θ.
pub(in super::super) fn metal(c: f64, [eta, k]: [f64; 2]) -> f64 {
    let m2 = [eta * eta - k * k, 2.0 * eta * k];
    let q2 = [m2[0] - (1.0 - c * c), m2[1]];
    let (radius, angle) = (q2[0].hypot(q2[1]).sqrt(), q2[1].atan2(q2[0]) / 2.0);
    let q = [radius * angle.cos(), radius * angle.sin()];
    let ratio = |a: [f64; 2]| {
        let square = |sign: f64| (a[0] + sign * q[0]).powi(2) + (a[1] + sign * q[1]).powi(2);
        square(-1.0) / square(1.0)
    };
    (ratio([c, 0.0]) + ratio([m2[0] * c, m2[1] * c])) / 2.0
}
