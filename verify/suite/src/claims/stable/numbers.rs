//! Inputs over the whole range of a routine, drawn from uniform numbers.

use std::cell::Cell;
use std::f64::consts::TAU;

use glam::DVec3;
use verify::points;

use super::routine::single;

/// Uniform numbers for one input.
pub(super) struct Numbers {
    uniform: [f64; 32],
    next: Cell<usize>,
}

impl Numbers {
    /// The numbers of input `index` of a run.
    pub(super) fn new(seed: u64, index: u64) -> Self {
        let mut uniform = [0.0; 32];
        points::fill(seed, index, &mut uniform);
        Self { uniform, next: Cell::new(0) }
    }

    /// A number in [0, 1).
    ///
    /// # Panics
    /// If an input takes more than 32.
    pub(super) fn unit(&self) -> f64 {
        let place = self.next.get();
        self.next.set(place + 1);
        self.uniform[place]
    }

    /// A number in [low, high).
    pub(super) fn between(&self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A number whose logarithm is uniform between those of `low` and `high`.
    pub(super) fn log(&self, low: f64, high: f64) -> f64 {
        (low.ln() + (high / low).ln() * self.unit()).exp()
    }

    /// One of the choices.
    pub(super) fn one_of<const K: usize>(&self, choices: [f64; K]) -> f64 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "u·K lies in [0, K)")]
        let index = (self.unit() * K as f64) as usize;
        choices[index.min(K - 1)]
    }

    /// 1 or −1.
    pub(super) fn sign(&self) -> f64 {
        self.one_of([1.0, -1.0])
    }

    /// A number as samplers give them: a multiple of 2⁻²⁴ in [0, 1), each power of two as likely as the next from either end.
    pub(super) fn sampler(&self) -> f64 {
        let steps = self.log(1.0, 16_777_215.0).floor();
        self.one_of([steps, 16_777_216.0 - steps, 0.0, (16_777_216.0 * self.uniform[31]).floor()])
            / 16_777_216.0
    }

    /// A unit vector.
    pub(super) fn direction(&self) -> DVec3 {
        let (z, phi) = (self.between(-1.0, 1.0), TAU * self.unit());
        let (sin, cos) = phi.sin_cos();
        let side = ((1.0 - z) * (1.0 + z)).sqrt();
        DVec3::new(side * cos, side * sin, z)
    }

    /// A unit vector at the angle `theta` from z.
    pub(super) fn at_angle(&self, theta: f64) -> DVec3 {
        let (sin, cos) = (TAU * self.unit()).sin_cos();
        DVec3::new(theta.sin() * cos, theta.sin() * sin, theta.cos())
    }
}

/// The vector in single precision.
pub(super) fn rounded(v: DVec3) -> [f64; 3] {
    v.to_array().map(|c| f64::from(single(c)))
}
