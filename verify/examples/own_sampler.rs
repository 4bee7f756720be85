//! Is my lens sampler uniform, and would I see it if it were not? `cargo run --release -p verify --example own_sampler`

use std::f64::consts::TAU;

use verify::chi_square::ChiSquare;
use verify::claim::{Run, Seed};
use verify::cube::Cube;
use verify::domain::Disk;
use verify::goodness::{Marginal, Sides, Statistic};
use verify::independence::Source;

/// The sampler under test: a point of the unit disk from two numbers.
fn my_lens([u, v]: [f64; 2]) -> Option<[f64; 2]> {
    let (sin, cos) = (TAU * v).sin_cos();
    Some([u.sqrt() * cos, u.sqrt() * sin])
}

/// The mistake that everybody makes once.
fn naive([u, v]: [f64; 2]) -> Option<[f64; 2]> {
    let (sin, cos) = (TAU * v).sin_cos();
    Some([u * cos, u * sin])
}

/// A generator under test: xorshift64*, started anew for each point.
fn my_generator(seed: u64, index: u64, point: &mut [f64]) {
    let mut state = (seed ^ (index + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15)).max(1);
    for x in point {
        for _ in 0..4 {
            state ^= state >> 12;
            state ^= state << 25;
            state ^= state >> 27;
        }
        *x = (state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64;
    }
}

fn main() {
    let outcome = ChiSquare::on(Disk::unit())
        .samples(my_lens) // uniform, unless `.density(…)` says otherwise
        .rejects("no square root", naive)
        .bound(0.01) // RMS relative error of the density over cells
        .run(Seed::from_env());
    println!("{outcome}\n");
    outcome.assert_holds();

    // The numbers themselves: four of them, on every axis and pair of axes.
    let run = Run { seed: Seed::from_env(), effort: 1 };
    let numbers = Cube::evidence(4, 0.02, Source::Independent, &run, my_generator).expect("runs");
    println!("{}: joint p {:.3}", numbers.method, numbers.p_value);

    // The radius alone: r² is uniform. Two-sided, since independent points are never quite even.
    let radius = Marginal {
        statistic: Statistic::AndersonDarling,
        sides: Sides::Both,
        values: 100_000,
        bound: 0.02,
        source: Source::Independent,
    };
    let square = |seed, index| {
        let mut u = [0.0; 2];
        verify::points::fill(seed, index, &mut u);
        my_lens(u).map_or(0.0, |[x, y]| (x * x + y * y).min(1.0))
    };
    let evidence = radius.evidence(&run, square).expect("runs");
    println!(
        "{}: p {:.3}, resolves a tilt of {:.4}",
        evidence.method, evidence.p_value, evidence.resolution.value
    );
}
