//! What holds for every material: no NaN, consistent sampling, reciprocity, energy.

use glam::{DVec3, Vec3};
use proptest::prelude::*;
use renderer::materials::{Beckmann, Branch, Bsdf, BsdfSample, Facets, Ggx, Lobe, Material, Metal};
use renderer::math::{Frame, Rgb};

mod cases;

const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

fn log_uniform(from: f32, to: f32) -> impl Strategy<Value = f32> {
    (from.ln()..to.ln()).prop_map(move |x| x.exp().clamp(from, to))
}

fn rgb() -> impl Strategy<Value = Rgb> {
    prop::array::uniform3(prop_oneof![Just(0.0), Just(1.0), 0.0..1.0_f32]).prop_map(Rgb::from)
}

fn metal() -> impl Strategy<Value = Metal> {
    // Silver, aluminium, a perfect reflector, no index at all, and a dielectric.
    let known = vec![(0.155, 4.83), (1.66, 9.22), (0.0, 1.0), (0.0, 0.0), (1.5, 0.0)];
    let value = prop_oneof![prop::sample::select(known), (log_uniform(1e-6, 1e6), log_uniform(1e-6, 1e6))];
    prop::array::uniform3(value).prop_map(|[r, g, b]| {
        Metal::new(Rgb::new(r.0, g.0, b.0), Rgb::new(r.1, g.1, b.1)).expect("the ranges are accepted")
    })
}

fn eta() -> impl Strategy<Value = f32> {
    prop_oneof![Just(1e-3), Just(1.0), Just(1.5), Just(1e3), log_uniform(0.2, 5.0)]
}

fn phong(sharp: f32) -> BoxedStrategy<Material> {
    let exponent = prop_oneof![Just(0.0), log_uniform(0.1, (1.0 / (sharp * sharp)).min(1e6))];
    (rgb(), rgb(), 0.0..=1.0_f32, exponent)
        .prop_map(|(d, s, share, n)| {
            Material::new_phong((d * share).into(), (s * (1.0 - share)).into(), n).unwrap()
        })
        .boxed()
}

fn facets(sharp: f32) -> BoxedStrategy<Facets> {
    let alpha = || [log_uniform(sharp, 10.0), log_uniform(sharp, 10.0)];
    prop_oneof![
        alpha().prop_map(|alpha| Ggx { alpha }.into()),
        alpha().prop_map(|alpha| Beckmann { alpha }.into()),
    ]
    .boxed()
}

/// Diffuse bodies under smooth coats. (Rough ones tabulate, too slow for thousands of cases; theirs is
/// `integrals_over_directions_are_means_over_samples` and the claims.)
fn plastic() -> BoxedStrategy<Material> {
    (eta(), any::<bool>(), rgb(), rgb())
        .prop_map(|(eta, nonlinear, d, s)| Material::new_plastic(eta, nonlinear, d.into(), s.into()).unwrap())
        .boxed()
}

/// Ground glass, and materials made of others.
fn mixed(sharp: f32) -> BoxedStrategy<Material> {
    let share = || prop_oneof![Just(0.0), 0.0..1.0_f32, Just(1.0)].prop_map(Rgb::splat);
    prop_oneof![
        ground_glass(sharp),
        (share(), prop_oneof![plain(sharp), forking(sharp), ground_glass(sharp)])
            .prop_map(|(opacity, m)| Material::new_mask(opacity.into(), m).unwrap()),
        (share(), plain(sharp), prop_oneof![plastic(), forking(sharp), ground_glass(sharp)])
            .prop_map(|(weight, a, b)| Material::new_blend(weight.into(), [a, b]).unwrap()),
    ]
    .boxed()
}

fn ground_glass(sharp: f32) -> BoxedStrategy<Material> {
    // Near index 1 the half vector loses the digits of η − 1: where values are compared, 0.2 are kept.
    let index = if sharp < 0.01 { eta().boxed() } else { prop_oneof![0.3..0.8_f32, 1.2..4.0_f32].boxed() };
    (facets(sharp), index, rgb(), rgb())
        .prop_map(|(f, eta, r, t)| Material::new_rough_dielectric(f, eta, r.into(), t.into()).unwrap())
        .boxed()
}

/// Metals and diffuse surfaces with roughness from `sharp`.
fn plain(sharp: f32) -> BoxedStrategy<Material> {
    prop_oneof![
        rgb().prop_map(|r| Material::new_diffuse(r.into()).unwrap()),
        rgb().prop_map(|r| Material::new_mirror(r.into()).unwrap()),
        (metal(), rgb()).prop_map(|(m, r)| Material::new_conductor(m, r.into()).unwrap()),
        (facets(sharp), metal(), rgb())
            .prop_map(|(f, m, r)| Material::new_rough_conductor(f, m, r.into()).unwrap()),
    ]
    .boxed()
}

/// A blur from `sharp` to 100, or to 2 where `sharp` is 0.05: wide disks are steep at their rim.
fn blur(sharp: f32) -> impl Strategy<Value = f32> {
    log_uniform(sharp, (0.1 / sharp).min(100.0))
}

fn fuzzy(sharp: f32) -> BoxedStrategy<Material> {
    (blur(sharp), rgb())
        .prop_map(|(f, r)| Material::new_blur_disk(f, None, r.into(), Rgb::WHITE.into()).unwrap())
        .boxed()
}

/// Materials that light can pass through.
fn forking(sharp: f32) -> BoxedStrategy<Material> {
    prop_oneof![
        (eta(), rgb(), rgb())
            .prop_map(|(eta, r, t)| Material::new_dielectric(eta, r.into(), t.into()).unwrap()),
        (eta(), rgb(), rgb())
            .prop_map(|(eta, r, t)| Material::new_thin_dielectric(eta, r.into(), t.into()).unwrap()),
        (blur(sharp), eta(), rgb(), rgb()).prop_map(|(f, eta, r, t)| Material::new_blur_disk(
            f,
            Some(eta),
            r.into(),
            t.into()
        )
        .unwrap()),
    ]
    .boxed()
}

fn reflector(sharp: f32) -> BoxedStrategy<Material> {
    prop_oneof![4 => plain(sharp), 1 => fuzzy(sharp), 1 => phong(sharp), 1 => plastic()].boxed()
}

fn material(sharp: f32) -> BoxedStrategy<Material> {
    prop_oneof![
        3 => reflector(sharp),
        1 => reflector(sharp).prop_map(|m| Material::new_two_sided(m).unwrap()),
        2 => forking(sharp),
        2 => mixed(sharp),
    ]
    .boxed()
}

/// Unit vectors, among them the poles, exactly grazing and nearly grazing ones.
fn direction() -> impl Strategy<Value = Vec3> {
    let cos = prop_oneof![
        4 => -1.0..1.0_f64,
        1 => prop::sample::select(vec![0.0, -0.0, 1.0, -1.0]),
        1 => prop::sample::select(vec![1e-4, -1e-4, 1e-10, -1e-10, 1e-30, -1e-30, 1e-44, -1e-44]),
    ];
    let phi = prop_oneof![0.0..std::f64::consts::TAU, Just(0.0), Just(std::f64::consts::PI)];
    (cos, phi).prop_map(|(cos, phi)| polar(cos, phi))
}

fn polar(cos: f64, phi: f64) -> Vec3 {
    let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
    DVec3::new(sin * phi.cos(), sin * phi.sin(), cos).as_vec3()
}

fn unit() -> impl Strategy<Value = f32> {
    prop_oneof![1 => Just(0.0), 1 => Just(ONE_MINUS_EPSILON), 4 => 0.0..ONE_MINUS_EPSILON]
}

fn channels(rgb: Rgb) -> impl Iterator<Item = f32> {
    rgb.to_array().into_iter()
}

fn check_sample(wo: Vec3, s: &BsdfSample) {
    assert!(s.wi.is_normalized(), "{s:?}");
    assert!(channels(s.weight).all(|c| c.is_finite() && c >= 0.0), "{s:?}");
    assert!(s.pdf.is_finite() && s.pdf > 0.0, "{s:?}");
    assert_eq!(s.transmitted, (wo.z > 0.0) != (s.wi.z > 0.0), "{s:?}");
    assert!(s.eta_rel > 0.0 && (s.transmitted || s.eta_rel == 1.0), "{s:?}");
}

proptest! {
    #![proptest_config(cases::config(20_000))]

    #[test]
    fn nothing_is_ever_nan_or_negative(
        m in material(1e-4), wo in direction(), wi in direction(), u_lobe in unit(), u in [unit(), unit()]
    ) {
        let bsdf = m.bsdf([0.3, 0.7]);
        prop_assert!(channels(bsdf.eval(wo, wi)).all(|c| c >= 0.0));
        prop_assert!(channels(bsdf.eval_cos(wo, wi)).all(|c| c.is_finite() && c >= 0.0));
        for pdf in [bsdf.pdf(wo, wi), bsdf.branch_pdf(wo, wi)] {
            prop_assert!(pdf.is_finite() && pdf >= 0.0);
        }
        prop_assert!((0.0..=1.0).contains(&bsdf.branch_probability_fresnel(wo)));
        if let Some(s) = bsdf.sample(wo, u_lobe, u) {
            check_sample(wo, &s);
        }
        for branch in [Branch::Reflect, Branch::Refract] {
            if let Some(s) = bsdf.sample_branch(wo, branch, u) {
                check_sample(wo, &s);
                prop_assert_eq!(s.transmitted, branch == Branch::Refract);
            }
        }
    }

    /// Beyond what the rounding of directions does to them (see [`range`]), density and weight agree within 2e-4: some
    /// twenty roundings of 2⁻²⁴, times 100 at most where 1 − F or a tail's exponent cancels.
    #[test]
    fn a_sample_says_the_density_and_the_weight_that_hold_there(
        m in material(0.05), wo in direction(), u_lobe in unit(), u in [unit(), unit()]
    ) {
        let bsdf = m.bsdf([0.0; 2]);
        let Some(s) = bsdf.sample(wo, u_lobe, u) else { return Ok(()) };
        if s.lobe == Lobe::Delta {
            let alone = m.calls_for().delta_only;
            prop_assert!(!alone || bsdf.pdf(wo, s.wi) == 0.0 && bsdf.eval_cos(wo, s.wi).is_black());
            return Ok(());
        }
        let [least, most] = range([wo, s.wi], |wo, wi| bsdf.pdf(wo, wi));
        prop_assert!(most > 0.0, "{} where nothing is drawn", s.pdf);
        prop_assert!(s.pdf >= least * (1.0 - 2e-4) && s.pdf <= most * (1.0 + 2e-4), "{} in {least}..{most}", s.pdf);
        for (c, w) in s.weight.to_array().into_iter().enumerate() {
            let [least, most] = range([wo, s.wi], |wo, wi| {
                let pdf = bsdf.pdf(wo, wi);
                if pdf > 0.0 { bsdf.eval_cos(wo, wi).to_array()[c] / pdf } else { 0.0 }
            });
            prop_assert!(w >= least - 2e-4 * least.max(1e-3) && w <= most + 2e-4 * most.max(1e-3), "{w} in {least}..{most}");
        }
    }

    #[test]
    fn the_cosine_is_in_the_value_for_light_once(
        m in material(0.05), wo in direction(), wi in direction()
    ) {
        let bsdf = m.bsdf([0.0; 2]);
        // At the horizon itself a lobe that is even over cosines has no value.
        prop_assume!(wi.z.abs() > 1e-6);
        for (f_cos, f) in channels(bsdf.eval_cos(wo, wi)).zip(channels(bsdf.eval(wo, wi))) {
            // Sums of up to three lobes whose products are rounded in another order, and numbers below the normal ones.
            prop_assert!((f_cos - f * wi.z.abs()).abs() <= 1e-5 * f_cos + f32::MIN_POSITIVE, "{} {}", f_cos, f);
        }
    }

    #[test]
    fn the_frame_follows_the_tangent_where_two_roughnesses_differ(alpha in [0.01..1.0_f32, 0.01..1.0_f32]) {
        let conductor = |alpha: [f32; 2]| {
            let metal = Metal::new(Rgb::splat(0.2), Rgb::splat(3.0)).unwrap();
            Material::new_rough_conductor(Ggx { alpha }, metal, Rgb::WHITE.into()).unwrap().calls_for()
        };
        prop_assert_eq!(conductor(alpha).anisotropic, alpha[0] != alpha[1]);
        prop_assert!(!conductor([alpha[0]; 2]).anisotropic);
    }

    #[test]
    fn reflection_is_reciprocal(
        m in prop_oneof![plain(0.01), phong(0.01), plastic()], wo in direction(), wi in direction()
    ) {
        let bsdf = m.bsdf([0.0; 2]);
        for (there, back) in channels(bsdf.eval(wo, wi)).zip(channels(bsdf.eval(wi, wo))) {
            // Some ten roundings of 2⁻²⁴ in a product; Phong's angle is computed from exactly mirrored numbers.
            prop_assert!((there - back).abs() <= 1e-6 * there, "{} {}", there, back);
        }
    }

    #[test]
    fn below_there_is_nothing_or_the_same_as_above(
        m in reflector(1e-3), wo in direction(), wi in direction(), u_lobe in unit(), u in [unit(), unit()]
    ) {
        let both = Material::new_two_sided(m.clone()).unwrap();
        let (one, two) = (m.bsdf([0.0; 2]), both.bsdf([0.0; 2]));
        let below = if wo.z > 0.0 { -wo } else { wo };
        prop_assert!(one.eval(below, wi).is_black() && one.pdf(below, wi) == 0.0);
        prop_assert!(one.sample(below, u_lobe, u).is_none());
        prop_assert_eq!(two.eval(-wo, -wi), two.eval(wo, wi));
        prop_assert_eq!(two.pdf(-wo, -wi), two.pdf(wo, wi));
        let flipped = two.sample(-wo, u_lobe, u).map(|s| BsdfSample { wi: -s.wi, ..s });
        prop_assert_eq!(flipped, two.sample(wo, u_lobe, u));
    }

    /// Except for Phong, whose mixture of lobes has weights above 1, no single sample creates light.
    #[test]
    fn no_sample_creates_light(
        m in prop_oneof![plain(1e-4), fuzzy(1e-4), forking(1e-4), ground_glass(1e-4)], wo in direction(),
        u_lobe in unit(), u in [unit(), unit()]
    ) {
        if let Some(s) = m.bsdf([0.0; 2]).sample(wo, u_lobe, u) {
            // Radiance is multiplied by 1/η² when it is refracted; power is not. Four roundings of 2⁻²⁴.
            prop_assert!(s.weight.max_component() * s.eta_rel * s.eta_rel <= 1.0 + 3e-7, "{:?}", s);
        }
    }

    #[test]
    fn choosing_a_branch_and_following_both_agree(
        m in forking(1e-2), wo in direction(), u in [unit(), unit()]
    ) {
        let bsdf = m.bsdf([0.0; 2]);
        let f = bsdf.branch_probability_fresnel(wo);
        for (branch, u_lobe) in [(Branch::Reflect, 0.0), (Branch::Refract, ONE_MINUS_EPSILON)] {
            let share = if branch == Branch::Reflect { f } else { 1.0 - f };
            let both = bsdf.sample_branch(wo, branch, u);
            if share < 1e-3 { continue; }
            let one = bsdf.sample(wo, u_lobe, u);
            prop_assert_eq!(both.map(|s| s.wi), one.map(|s| s.wi));
            for (b, o) in both.iter().zip(&one) {
                for (b, o) in channels(b.weight).zip(channels(o.weight)) {
                    // F is off by 1.02 · 2⁻²⁵, of a pane 2F/(1 + F) by half of that and by 2⁻²⁵ for the sum and for the quotient, and 1 − F by
                    // as much; besides, both weights are within six roundings of 2⁻²⁴.
                    let bound = (2.51 / 4.0 / share + 3.0) * f32::EPSILON * b;
                    prop_assert!((b - o * share).abs() <= bound, "{} {}", b, o * share);
                }
            }
        }
    }
}

/// The least and the largest value of `f` at two directions that are each off by up to 2⁻²¹, to any side: eight
/// roundings, as many as a half vector, a refraction and a normalisation have. And by 2⁻²² in length, the four roundings of a
/// normalisation: where directions are nearly opposite, their sum has little else along them.
fn range([wo, wi]: [Vec3; 2], f: impl Fn(Vec3, Vec3) -> f32) -> [f32; 2] {
    let moved = |w: Vec3| {
        let (s, t) = w.any_orthonormal_pair();
        let near = [s, -s, t, -t].map(|to| (w + to / (1 << 21) as f32).normalize());
        let length = (-22f32).exp2();
        [w, near[0], near[1], near[2], near[3], w * (1.0 - length), w * (1.0 + length)]
    };
    let pairs = moved(wo).into_iter().flat_map(|wo| moved(wi).map(|wi| (wo, wi)));
    pairs.map(|(wo, wi)| f(wo, wi)).fold([f32::INFINITY, 0.0], |[least, most], x| [least.min(x), most.max(x)])
}

/// Materials with lobes wide enough for quadrature, each of them as (name, material).
fn wide_lobes() -> Vec<(&'static str, Material)> {
    let white = || Rgb::WHITE.into();
    let metal = || Metal::new(Rgb::new(0.201, 0.924, 1.102), Rgb::new(3.913, 2.453, 2.142)).unwrap();
    let phong = |n| Material::new_phong(Rgb::splat(0.3).into(), Rgb::new(0.7, 0.1, 0.4).into(), n);
    let all = [
        ("diffuse", Material::new_diffuse(Rgb::new(1.0, 0.5, 0.2).into())),
        ("rough", Material::new_rough_conductor(Ggx { alpha: [0.2, 0.2] }, metal(), white())),
        ("anisotropic", Material::new_rough_conductor(Ggx { alpha: [0.15, 0.6] }, metal(), white())),
        ("normal slopes", Material::new_rough_conductor(Beckmann { alpha: [0.3, 0.5] }, metal(), white())),
        ("ground glass", Material::new_rough_dielectric(Ggx { alpha: [0.3; 2] }, 1.5, white(), white())),
        ("sandblasted", Material::new_rough_dielectric(Beckmann { alpha: [0.4; 2] }, 1.25, white(), white())),
        ("rough plastic", Material::new_rough_plastic(Ggx { alpha: [0.3; 2] }, 1.5, true, white(), white())),
        ("fuzzy mirror", Material::new_blur_disk(0.4, None, white(), white())),
        ("frosted glass", Material::new_blur_disk(0.3, Some(1.5), white(), Rgb::new(0.9, 0.5, 1.0).into())),
        ("plastic-like", phong(20.0)),
        ("uniform", phong(0.0)),
    ];
    all.into_iter().map(|(name, m)| (name, m.unwrap())).collect()
}

/// The moments of a lobe: its mass by `pdf`, and f cos θᵢ in red times 1, x, y and z².
type Moments = [f64; 5];

fn moments(wi: Vec3, density: f32, value: f32) -> Moments {
    let [x, y, z] = wi.as_dvec3().to_array();
    let value = f64::from(value);
    [f64::from(density), value, value * x, value * y, value * z * z]
}

fn add(sum: &mut Moments, term: Moments, scale: f64) {
    for (s, t) in sum.iter_mut().zip(term) {
        *s += t * scale;
    }
}

/// The midpoint rule about an axis that no lobe shares, so that no rim runs along a row of cells.
fn by_quadrature(bsdf: &Bsdf, wo: Vec3) -> Moments {
    let n = 1024_i32;
    let frame = Frame::from_z(Vec3::new(2.0, -1.0, 0.7).normalize());
    let mut sum = [0.0; 5];
    for i in 0..n {
        let cos = (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
        for j in 0..n {
            let wi = polar(cos, (f64::from(j) + 0.5) * std::f64::consts::TAU / f64::from(n));
            let wi = frame.to_world(wi);
            add(&mut sum, moments(wi, bsdf.pdf(wo, wi), bsdf.eval_cos(wo, wi).r), 1.0);
        }
    }
    sum.map(|s| s * 4.0 * std::f64::consts::PI / f64::from(n * n))
}

/// Over a lattice: the lobe choice in order, the direction by the sequence of the plastic number.
fn by_sampling(bsdf: &Bsdf, wo: Vec3) -> Moments {
    let n = 1 << 18;
    let mut sum = [0.0; 5];
    for i in 0..n {
        let i = f64::from(i);
        let u = [i * 0.754_877_666_246_692_7, i * 0.569_840_290_998_053_2].map(|x: f64| to_f32(x.fract()));
        if let Some(s) = bsdf.sample(wo, to_f32((i + 0.5) / f64::from(n)), u) {
            add(&mut sum, moments(s.wi, 1.0, s.weight.r), 1.0 / f64::from(n));
        }
    }
    sum
}

#[expect(clippy::cast_possible_truncation, reason = "rounded, and kept below 1")]
fn to_f32(x: f64) -> f32 {
    (x as f32).min(ONE_MINUS_EPSILON)
}

/// The integral of a lobe by quadrature over directions is the mean of its samples: sampler, density and value
/// belong together, and what `pdf` lacks is what `sample` drops.
#[test]
fn integrals_over_directions_are_means_over_samples() {
    for (name, material) in wide_lobes() {
        let bsdf = material.bsdf([0.0; 2]);
        for (cos, phi) in [(1.0, 0.0), (0.8, 0.4), (0.4, 2.0), (0.1, 5.0), (-0.9, 1.0)] {
            let wo = polar(cos, phi);
            let [by_quadrature, by_sampling] = [by_quadrature(&bsdf, wo), by_sampling(&bsdf, wo)];
            for (k, (q, s)) in by_quadrature.into_iter().zip(by_sampling).enumerate() {
                // A lobe's rim cuts at most 4 × 1024 of 2²⁰ cells, half of each wrong at worst: 2e-3 of the mean
                // density times the sphere; peaks here are below 5 times a cell's mean, signs alternate.
                assert!((q - s).abs() < 4e-3, "{name}, cos {cos}, moment {k}: {q} and {s}");
            }
        }
    }
}

#[test]
fn no_surface_creates_light() {
    for (name, material) in wide_lobes() {
        let bsdf = material.bsdf([0.0; 2]);
        for cos in [1.0, 0.9, 0.6, 0.3, 0.1, 0.01] {
            let albedo = by_sampling(&bsdf, polar(cos, 0.3))[1];
            // The lattice's error: discrepancy about 1e-4 at 2¹⁸ points, weights up to 2.
            assert!(albedo < 1.0 + 2e-4, "{name}, cos {cos}: {albedo}");
        }
    }
}
