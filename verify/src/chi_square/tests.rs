//! Verdicts of chi-square tests on right and wrong samplers.

use std::f64::consts::PI;

use super::*;
use crate::claim::{Seed, Verdict};
use crate::domain::{Directions, Disk, Interval, Parallelogram, Triangle};

fn polar(r: f64, turn: f64) -> [f64; 2] {
    let (sin, cos) = (2.0 * PI * turn).sin_cos();
    [r * cos, r * sin]
}

fn right_disk([u, v]: [f64; 2]) -> Option<[f64; 2]> {
    Some(polar(u.sqrt(), v))
}

const RUN: Run = Run { seed: 1, effort: 1 };

#[test]
fn two_million_samples_resolve_less_than_one_percent_on_200_cells() {
    let test = ChiSquare::on(Disk::unit()).samples(right_disk).bound(0.01);
    let evidence = test.evidence(&RUN).expect("runs");
    // λ* with 199 degrees of freedom: chi2.isf(1e-6) = 308.6 of scipy 1.17.1; 1e-3 of χ²(λ) lies below it at λ = 211, n = 2.11e6.
    assert!((2_050_000..2_150_000).contains(&evidence.n), "{}", evidence.n);
    assert_eq!((evidence.dof, evidence.bound), (Some(199.0), 0.01));
    assert!(evidence.doubts.is_empty() && evidence.interval[1] < 0.01);
    assert!((0.006..0.008).contains(&evidence.resolution.value)); // √(102.4…106)/2.11e6) = 0.0070, at 1e-3 and half of it
}

#[test]
fn the_right_disk_holds_and_wrong_ones_are_rejected() {
    let test = ChiSquare::on(Disk::unit()).density(|_| 1.0 / PI).samples(right_disk).bound(0.01);
    let test = test.rejects("no square root", |[u, v]: [f64; 2]| Some(polar(u, v)));
    let test = test.rejects("exponent 0.51", |[u, v]: [f64; 2]| Some(polar(u.powf(0.51), v)));
    let outcome = test.run(Seed::from_env());
    outcome.assert_holds();
    assert_eq!(outcome.controls.len(), 3);
}

#[test]
fn a_wrong_disk_fails_after_three_runs() {
    let almost = |[u, v]: [f64; 2]| Some(polar(u.powf(0.51), v)); // RMS 2 %, at a resolution of 1.4 %
    let outcome = ChiSquare::on(Disk::unit()).samples(almost).bound(0.02).run(Seed::from_env());
    assert_eq!((outcome.verdict, outcome.runs), (Verdict::Fails, 3));
}

#[test]
fn a_blind_test_fails() {
    let constant = |[_, v, w]: [f64; 3]| Some(polar(v.sqrt(), w)); // the first number is not used: its defect can't be seen
    let outcome = ChiSquare::on(Disk::unit()).samples(constant).bound(0.05).run(Seed::from_env());
    assert_eq!((outcome.verdict, outcome.accepted_controls().count()), (Verdict::Fails, 1));
    ChiSquare::on(Disk::unit())
        .samples(constant)
        .defect_in(1)
        .bound(0.05)
        .run(Seed::from_env())
        .assert_holds();
}

#[test]
fn points_outside_or_where_the_density_is_0_are_impossible() {
    let out = |[u, v]: [f64; 2]| Some(if u < 1e-4 { [2.0, 0.0] } else { polar(u.sqrt(), v) });
    let evidence = ChiSquare::on(Disk::unit()).samples(out).bound(0.1).evidence(&RUN).expect("runs");
    assert!(evidence.p_value == 0.0 && evidence.doubts[0].contains("outside the domain"));
    let upper_half = |[x, _]: [f64; 2]| if x < 0.5 { 2.0 } else { 0.0 };
    let square = |edge: f64| move |[u, v]: [f64; 2]| Some([edge * u, v]);
    let test = |edge| {
        ChiSquare::on(Parallelogram::unit_square()).density(upper_half).samples(square(edge)).bound(0.1)
    };
    assert!(test(0.5).evidence(&RUN).expect("runs").p_value > 1e-3);
    let few = test(0.501).evidence(&RUN).expect("runs");
    assert!(few.p_value < 1e-9 && few.method.contains("where the density is 0")); // 40 of 20,920, where rounding allows 0.02
}

#[test]
fn discarded_samples_are_held_against_the_missing_mass() {
    let keep = |share: f64| move |[u, v, w]: [f64; 3]| (w < share).then(|| polar(u.sqrt(), v));
    let test = |mass: f64, share| {
        ChiSquare::on(Disk::unit()).density(move |_| mass / PI).samples(keep(share)).bound(0.02)
    };
    test(0.7, 0.7).run(Seed::from_env()).assert_holds();
    assert!(test(0.7, 0.71).evidence(&RUN).expect("runs").p_value < 1e-9);
    assert!(test(1.0, 0.9999).evidence(&RUN).expect("runs").p_value < 1e-9);
    assert_eq!(test(1.01, 1.0).evidence(&RUN).expect("runs").p_value, 0.0);
}

#[test]
fn atoms_are_held_against_their_probabilities() {
    // A third of the samples at the centre, a tenth at the edge, the rest on the disk.
    let lobes = |first: f64| {
        move |[choice, u, v]: [f64; 3]| match choice {
            c if c < first => Drawn::Atom(0),
            c if c < first + 0.1 => Drawn::Atom(1),
            _ => Drawn::Point(polar(u.sqrt(), v)),
        }
    };
    let test = |atoms: &[f64], first: f64| {
        ChiSquare::on(Disk::unit()).atoms(atoms).draws(lobes(first)).bound(0.02).defect_in(1)
    };
    let third = 1.0 / 3.0;
    test(&[third, 0.1], third).run(Seed::from_env()).assert_holds();
    let wrong = test(&[third, 0.1], 0.34).evidence(&RUN).expect("runs");
    assert!(wrong.p_value < 1e-9 && wrong.method.contains("at atom 0"), "{}", wrong.method);
    let unknown = test(&[third], third).evidence(&RUN).expect("runs");
    assert!(unknown.p_value == 0.0 && unknown.doubts[0].contains("outside"));
    let thick = ChiSquare::on(Disk::unit()).density(|_| 0.5 / PI).atoms(&[third, 0.2]).draws(lobes(third));
    let too_much = thick.bound(0.02).evidence(&RUN).expect("runs");
    assert!(too_much.p_value == 0.0 && too_much.doubts[0].contains("more than 1"));
}

#[test]
fn a_smooth_error_below_the_resolution_is_seen_by_the_contrasts() {
    let test = ChiSquare::on(Disk::unit()).samples(right_disk).bound(0.01);
    let size = 0.8 * test.resolution(&RUN).expect("a density");
    let evidence = test.evidence_with_defect(&RUN, size).expect("runs");
    assert!(
        evidence.p_value < 1e-3 && evidence.method.contains("14 low-order contrasts"),
        "{}",
        evidence.method
    );
}

#[test]
fn a_low_discrepancy_source_is_refused() {
    let test = ChiSquare::on(Disk::unit()).samples(right_disk).source(Source::LowDiscrepancy);
    assert!(matches!(test.evidence(&RUN), Err(InputError::NotIndependent { .. })));
}

#[test]
fn a_density_on_cells_is_followed() {
    // Density 2x on [0, 1) in steps of a quarter, drawn by choosing the step.
    let steps = |[u, v, w]: [f64; 3]| {
        let step = [1.0, 4.0, 9.0].iter().filter(|limit| 16.0 * u > **limit).count() as f64;
        Some([(step + v) / 4.0, w])
    };
    let table = vec![0.25, 0.75, 1.25, 1.75];
    let test = ChiSquare::on(Parallelogram::unit_square()).cells([4, 1], table).samples(steps).defect_in(1);
    test.bound(0.02).run(Seed::from_env()).assert_holds();
}

#[test]
fn a_narrow_error_is_seen_inside_the_cells() {
    // A tooth of the size of a fine cell: the coarse grid's cells keep their counts.
    let tooth = |[u]: [f64; 1]| Some((u * 2000.0).floor() / 2000.0 + (u * 2000.0).fract().powf(1.1) / 2000.0);
    let test = ChiSquare::on(Interval::unit()).samples(tooth).bound(0.01);
    let evidence = test.evidence(&RUN).expect("runs");
    assert!(evidence.p_value < 1e-9 && evidence.estimate < 0.01);
}

#[test]
fn points_too_even_to_be_independent_are_doubted() {
    let target = ChiSquare::on(Interval::unit());
    let mut histogram = target.histogram();
    for i in 0..100_000 {
        target.add(&mut histogram, f64::from(i) / 100_000.0);
    }
    let evidence = target.judge(&histogram, 0.1).expect("enough points");
    assert!(!evidence.is_within_bound() && evidence.doubts[0].contains("smaller than independent"));
}

#[test]
fn a_singular_density_is_integrated_and_held() {
    // The naive disk has density 1/(2πr): right when it is asked for.
    let test = ChiSquare::on(Disk::unit()).density(|[x, y]| 1.0 / (2.0 * PI * x.hypot(y)));
    test.samples(|[u, v]: [f64; 2]| Some(polar(u, v))).bound(0.02).run(Seed::from_env()).assert_holds();
}

#[test]
fn a_cosine_lobe_holds_and_a_uniform_one_is_rejected() {
    let lobe = |[u, v]: [f64; 2]| {
        let [x, y] = polar(u.sqrt(), v);
        Some([x, y, (1.0 - u).sqrt()])
    };
    let uniform = |[u, v]: [f64; 2]| {
        let [x, y] = polar((u * (2.0 - u)).sqrt(), v);
        Some([x, y, 1.0 - u])
    };
    let test = ChiSquare::on(Directions::hemisphere()).density(|[_, _, z]| z / PI).samples(lobe);
    test.bound(0.02).rejects("uniform", uniform).run(Seed::from_env()).assert_holds();
}

#[test]
fn a_density_with_a_jump_across_the_cells_holds() {
    // Uniform directions in a cone of cos θ > 0.8 about +x, on the whole sphere.
    let inside = |[x, _, _]: [f64; 3]| if x > 0.8 { 1.0 / (0.4 * PI) } else { 0.0 };
    let cone = |cos: f64| {
        move |[u, v]: [f64; 2]| {
            let x = 1.0 - (1.0 - cos) * u;
            let [y, z] = polar((1.0 - x * x).sqrt(), v);
            Some([x, y, z])
        }
    };
    let test = |cos| ChiSquare::on(Directions::sphere()).density(inside).samples(cone(cos)).bound(0.01);
    let right = test(0.8);
    let expected = right.target.expected().expect("a density");
    for grid in [&expected.coarse, &expected.fine] {
        // Below a tenth of the statistic's spread √(2k) even at the exhaustive level.
        let spread = (2.0 * grid.possible_cells() as f64).sqrt();
        assert!(grid.quadrature_lambda(64.0 * 2.1e6) < 0.1 * spread);
    }
    right.run(Seed::from_env()).assert_holds();
    assert!(test(0.799).evidence(&RUN).expect("runs").p_value < 1e-9);
}

#[test]
fn the_planted_defect_has_the_size_asked_for() {
    let exponent = exponent_of(0.02, 10);
    let (n, mut histogram) = (1_000_000u32, vec![0.0; 10]);
    for i in 0..n {
        let u = ((f64::from(i) + 0.5) / f64::from(n)).powf(exponent);
        histogram[(0..10).rfind(|k| u >= f64::from(*k) / 10.0).map_or(0, |k| k as usize)] +=
            10.0 / f64::from(n);
    }
    let rms = (histogram.iter().map(|share: &f64| (share - 1.0).powi(2)).sum::<f64>() / 10.0).sqrt();
    assert!((rms - 0.02).abs() < 2e-5, "{rms}"); // counts of 10⁶ even points are off by at most 1 of 10⁵ a cell
}

#[test]
#[expect(clippy::cast_possible_truncation, reason = "single precision is what the test is about")]
fn samplers_in_single_precision_hold() {
    // A triangle of size 1 a hundred units away: vertices, edges and sums rounded to 24 bits.
    let vertices = [[100.0f32, -70.3, 40.1], [101.1, -70.0, 40.2], [100.3, -69.2, 40.9]];
    let triangle = Triangle::new(vertices.map(|v| v.map(f64::from))).expect("not degenerate");
    let point = move |[u, v]: [f64; 2]| {
        let (root, v) = ((u as f32).sqrt(), v as f32);
        let [a, b, c] = vertices;
        let weights = [1.0 - root, root * (1.0 - v), root * v];
        Some([0, 1, 2].map(|i| f64::from(weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i])))
    };
    ChiSquare::on(triangle).samples(point).bound(0.02).run(Seed::from_env()).assert_holds();
    let direction = |[u, v]: [f64; 2]| {
        let (sin, cos) = (std::f32::consts::TAU * v as f32).sin_cos();
        let (ring, z) = ((u as f32).sqrt(), (1.0 - u as f32).max(0.0).sqrt());
        Some([ring * cos, ring * sin, z].map(f64::from))
    };
    let cosine = |[_, _, z]: [f64; 3]| f64::from(z as f32 * std::f32::consts::FRAC_1_PI);
    ChiSquare::on(Directions::hemisphere())
        .density(cosine)
        .samples(direction)
        .bound(0.02)
        .run(Seed::from_env())
        .assert_holds();
}
