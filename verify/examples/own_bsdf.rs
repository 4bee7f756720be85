//! Do sample, pdf and eval of my BSDF agree? `cargo run --release -p verify --example own_bsdf`

use std::f64::consts::{PI, TAU};

use verify::chi_square::{ChiSquare, Drawn};
use verify::claim::{Run, Seed, claim};
use verify::domain::Directions;
use verify::mean::MeanClaim;

/// A coated diffuse surface: a mirror with probability `COAT`, else a diffuse reflection of albedo `ALBEDO`. `wo` is along the normal.
const COAT: f64 = 0.04;
const ALBEDO: f64 = 0.5;

/// A direction, and whether it is the mirror's.
fn sample([choice, u, v]: [f64; 3]) -> ([f64; 3], bool) {
    if choice < COAT {
        return ([0.0, 0.0, 1.0], true);
    }
    let (sin, cos) = (TAU * v).sin_cos();
    ([u.sqrt() * cos, u.sqrt() * sin, (1.0 - u).sqrt()], false)
}

/// Density of the directions that are not the mirror's, per steradian.
fn pdf([_, _, z]: [f64; 3]) -> f64 {
    (1.0 - COAT) * z.max(0.0) / PI
}

/// The BSDF without its mirror, per steradian.
fn eval(_: [f64; 3]) -> f64 {
    (1.0 - COAT) * ALBEDO / PI
}

fn main() {
    // The mirror is an atom: its count is held against its probability, all other directions against the density.
    let test = ChiSquare::on(Directions::hemisphere())
        .density(pdf)
        .atoms(&[COAT])
        .draws(|u| match sample(u) {
            (_, true) => Drawn::Atom(0),
            (direction, false) => Drawn::Point(direction),
        })
        .defect_in(1) // the automatic control distorts this number; the first only chooses the lobe
        .bound(0.02);
    let directions = test
        .claim("bsdf/sample/pdf", "directions follow their density")
        .run(Seed::from_env(), verify::claim::Level::Quick);
    println!("{}\n", directions.expect("a density"));

    // The albedo from weights f·cos/pdf against its closed form, 64 samples a replicate.
    let albedo = MeanClaim { replicates: 64, ..MeanClaim::relative(COAT + (1.0 - COAT) * ALBEDO, 0.05) };
    let replicate = |seed: u64| {
        let weight = |index| {
            let mut u = [0.0; 3];
            verify::points::fill(seed, index, &mut u);
            match sample(u) {
                (_, true) => 1.0,
                (direction, false) => eval(direction) * direction[2] / pdf(direction),
            }
        };
        (0..64).map(weight).sum::<f64>() / 64.0
    };
    let outcome = claim("bsdf/weight/albedo", "weights average to the albedo")
        .rejects("2.2 resolutions more", move |run: &Run| albedo.control(run, replicate))
        .by(move |run: &Run| albedo.evidence(run, replicate))
        .run(Seed::from_env(), verify::claim::Level::Quick)
        .expect("runs");
    println!("{outcome}");
    outcome.assert_holds();
}
