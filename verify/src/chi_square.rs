//! Chi-square tests of samplers: do points follow a density on a domain, and by how much could they miss it?
//!
//! The same points are counted on two grids: a coarse one of about 200 cells, which sees smooth errors best
//! and carries the bound, and a fine one of about 20,000, which sees narrow ones. The second test is of the
//! counts inside each coarse cell, given that cell's count; so the two are independent, and their p-values
//! are joined exactly (Šidák). The number of discarded samples joins by Bonferroni's rule where there are
//! any.
//!
//! ```
//! use std::f64::consts::{PI, TAU};
//! use verify::{chi_square::ChiSquare, claim::Seed, domain::Disk};
//!
//! fn my_aperture([u, v]: [f64; 2]) -> Option<[f64; 2]> {
//!     let (sin, cos) = (TAU * v).sin_cos();
//!     Some([u.sqrt() * cos, u.sqrt() * sin])
//! }
//!
//! ChiSquare::on(Disk::unit())
//!     .density(|_| 1.0 / PI) // per unit area
//!     .samples(my_aperture) // `None` would be counted as discarded
//!     .bound(0.05) // RMS relative error over cells
//!     .run(Seed::from_env())
//!     .assert_holds();
//! ```

use std::sync::{Arc, OnceLock};

mod expected;
mod judge;
mod pearson;

use crate::claim::{Claim, Evidence, Level, Outcome, Run, claim};
use crate::domain::Domain;
use crate::error::InputError;
use crate::histogram::Histogram;
use crate::points::fill;
use expected::Expected;

/// Size of the automatic control's defect, in resolutions: caught in practice always, and still small.
const CONTROL_RESOLUTIONS: f64 = 2.2;

/// Bound where none is given: an RMS relative error over cells of 1 %.
const DEFAULT_BOUND: f64 = 0.01;

/// A domain and the density that points on it should have.
pub struct Target<D: Domain> {
    domain: D,
    density: Box<dyn Fn(D::Point) -> f64 + Send + Sync>,
    /// Cell probabilities, integrated when first asked for.
    expected: OnceLock<Result<Expected, InputError>>,
}

/// A chi-square test of one sampler.
pub struct ChiSquare<D: Domain> {
    target: Arc<Target<D>>,
    subject: Subject,
    controls: Vec<(String, Subject)>,
    bound: f64,
    defect_axis: usize,
    control_resolutions: f64,
}

/// Draws samples of one sampler and counts them.
type Subject = Box<dyn Fn(&Draw) -> Histogram + Send + Sync>;

/// What to draw.
struct Draw {
    seed: u64,
    n: u64,
    shape: [usize; 2],
    defect: Option<Defect>,
}

/// A planted defect: one of the sampler's numbers, u, replaced by u^exponent.
#[derive(Clone, Copy)]
struct Defect {
    axis: usize,
    exponent: f64,
}

impl<D: Domain> ChiSquare<D> {
    /// Starts a test on a domain; the density is uniform unless [`Target::density`] says otherwise.
    pub fn on(domain: D) -> Target<D> {
        let uniform = 1.0 / domain.measure();
        Target { domain, density: Box::new(move |_| uniform), expected: OnceLock::new() }
    }

    /// Sets the bound: the RMS relative error over the coarse grid's cells below which the sampler must be.
    /// It also sets the sample count.
    ///
    /// * `bound`: in (0, 1); 0.01 if not set.
    #[must_use]
    pub fn bound(mut self, bound: f64) -> Self {
        self.bound = bound;
        self
    }

    /// Adds a wrong sampler, which the test must reject.
    #[must_use]
    pub fn rejects<const N: usize>(
        mut self,
        name: impl Into<String>,
        wrong: impl Fn([f64; N]) -> Option<D::Point> + Send + Sync + 'static,
    ) -> Self {
        self.controls.push((name.into(), subject(&self.target, wrong)));
        self
    }

    /// Chooses which of the sampler's numbers the automatic control distorts; the first if not set.
    ///
    /// For samplers that use their first number for little, such as the choice between two lobes.
    #[must_use]
    pub fn defect_in(mut self, axis: usize) -> Self {
        self.defect_axis = axis;
        self
    }

    /// Chooses the size of the automatic control's defect, in resolutions of a sampler that shows all of it; 2.2 if
    /// not set.
    ///
    /// For samplers that bring several values of a number to the same place, where their errors average: the control
    /// is to be 2.2 resolutions of the points.
    #[must_use]
    pub fn defect_of(mut self, resolutions: f64) -> Self {
        self.control_resolutions = resolutions;
        self
    }

    /// Makes it a claim, with its controls: the given ones, and the sampler itself with its first number u
    /// replaced by u^(1 + δ), where δ makes 2.2 times the resolution.
    pub fn claim(self, id: impl Into<String>, says: impl Into<String>) -> Claim {
        let test = Arc::new(self);
        let mut builder = claim(id, says);
        for index in 0..test.controls.len() {
            let control = test.clone();
            let name = control.controls[index].0.clone();
            builder =
                builder.rejects(name, move |run| control.evidence_of(&control.controls[index].1, run, None));
        }
        let control = test.clone();
        let name = format!("u{}^(1+δ), {} × resolution", test.defect_axis, test.control_resolutions);
        let with_defect = move |run: &Run| {
            let resolution = control.resolution(run)?;
            control.evidence_with_defect(run, control.control_resolutions * resolution)
        };
        builder.rejects(name, with_defect).by(move |run| test.evidence(run))
    }

    /// Runs the test, for use in a `#[test]`: at the level of `VERIFY_LEVEL`, under the name of the thread,
    /// which is that of the test.
    ///
    /// # Panics
    /// If the test cannot run: the density is none, or integrates to no known value.
    pub fn run(self, seed: u64) -> Outcome {
        let domain = self.target.domain.name();
        let id = std::thread::current().name().map_or_else(|| format!("chi-square/{domain}"), String::from);
        match self
            .claim(id, format!("samples follow their density on the {domain}"))
            .run(seed, Level::from_env())
        {
            Ok(outcome) => outcome,
            Err(reason) => panic!("the test cannot run: {reason}"),
        }
    }

    /// Draws n · effort samples and tests them; n is such that a right sampler is undecided with probability
    /// 1e-6.
    ///
    /// # Errors
    /// `Density`, `Quadrature`, `TooFew` if the density is none; `Parameter` if the bound is out of range.
    pub fn evidence(&self, run: &Run) -> Result<Evidence, InputError> {
        self.evidence_of(&self.subject, run, None)
    }

    /// Like [`evidence`](Self::evidence), of the sampler with a planted defect: one of its numbers, u, is
    /// replaced by u^(1 + δ).
    ///
    /// * `rms`: RMS relative error over the coarse grid's columns that the defect gives to uniform numbers
    ///   themselves; above 0. What it gives to the sampler's points is at most that, and less where one
    ///   cell's points come from many values of u.
    ///
    /// # Errors
    /// As [`evidence`](Self::evidence).
    pub fn evidence_with_defect(&self, run: &Run, rms: f64) -> Result<Evidence, InputError> {
        let columns = self.target.domain.coarse_grid()[0];
        let defect = Defect { axis: self.defect_axis, exponent: exponent_of(rms, columns) };
        self.evidence_of(&self.subject, run, Some(defect))
    }

    /// The smallest RMS relative error that a run would catch with power 0.9.
    ///
    /// # Errors
    /// As [`evidence`](Self::evidence).
    pub fn resolution(&self, run: &Run) -> Result<f64, InputError> {
        let expected = self.target.expected()?;
        Ok(judge::resolution(expected, judge::sample_count(expected, self.bound)? * run.effort))
    }

    fn evidence_of(
        &self,
        subject: &Subject,
        run: &Run,
        defect: Option<Defect>,
    ) -> Result<Evidence, InputError> {
        let expected = self.target.expected()?;
        let n = judge::sample_count(expected, self.bound)? * run.effort;
        let histogram = subject(&Draw { seed: run.seed, n, shape: expected.fine.shape, defect });
        self.target.judge(&histogram, self.bound)
    }
}

impl<D: Domain> Target<D> {
    /// Sets the density, per unit of the domain's measure.
    ///
    /// * `density`: at least 0 and finite; its integral over the domain may fall short of 1 by the
    ///   probability of being discarded.
    #[must_use]
    pub fn density(mut self, density: impl Fn(D::Point) -> f64 + Send + Sync + 'static) -> Self {
        self.density = Box::new(density);
        self.expected = OnceLock::new();
        self
    }

    /// Completes the test with the sampler.
    ///
    /// * `sampler`: turns independent numbers, uniform on [0, 1), into a point; `None` discards the sample.
    pub fn samples<const N: usize>(
        self,
        sampler: impl Fn([f64; N]) -> Option<D::Point> + Send + Sync + 'static,
    ) -> ChiSquare<D> {
        let target = Arc::new(self);
        let subject = subject(&target, sampler);
        ChiSquare {
            target,
            subject,
            controls: Vec::new(),
            bound: DEFAULT_BOUND,
            defect_axis: 0,
            control_resolutions: CONTROL_RESOLUTIONS,
        }
    }

    /// An empty histogram for [`judge`](Self::judge), to count points that come from elsewhere.
    pub fn histogram(&self) -> Histogram {
        let ([columns, rows], [x, y]) = (self.domain.coarse_grid(), self.domain.refinement());
        Histogram::new([columns * x, rows * y])
    }

    /// Counts a point; one outside the domain is counted as such.
    pub fn add(&self, histogram: &mut Histogram, point: D::Point) {
        histogram.add(self.domain.to_square(point));
    }

    /// How many independent points a bound takes: so many that a right sampler is undecided with probability 1e-6.
    ///
    /// # Errors
    /// `Density`, `Quadrature`, `TooFew`, `Parameter`.
    pub fn sample_count(&self, bound: f64) -> Result<u64, InputError> {
        judge::sample_count(self.expected()?, bound)
    }

    /// The smallest RMS relative error that counts of `n` independent points would show with power 0.9.
    ///
    /// # Errors
    /// `Density`, `Quadrature`, `TooFew`.
    pub fn resolution(&self, n: u64) -> Result<f64, InputError> {
        Ok(judge::resolution(self.expected()?, n))
    }

    /// Tests counts of independent points.
    ///
    /// * `histogram`: of the shape that [`histogram`](Self::histogram) gives, with at least 10 samples;
    ///   `bound`: RMS relative error over the coarse grid's cells, in (0, 1).
    ///
    /// # Errors
    /// `Density`, `Quadrature`, `TooFew`, `Parameter`.
    pub fn judge(&self, histogram: &Histogram, bound: f64) -> Result<Evidence, InputError> {
        judge::judge(self.expected()?, histogram, bound, self.domain.name(), self.domain.axes())
    }

    fn expected(&self) -> Result<&Expected, InputError> {
        self.expected
            .get_or_init(|| Expected::of(&self.domain, &*self.density))
            .as_ref()
            .map_err(Clone::clone)
    }
}

/// The loop that draws a sampler's points and counts them; compiled for each sampler.
fn subject<D: Domain, const N: usize>(
    target: &Arc<Target<D>>,
    sampler: impl Fn([f64; N]) -> Option<D::Point> + Send + Sync + 'static,
) -> Subject {
    let target = target.clone();
    Box::new(move |draw| {
        let mut histogram = Histogram::new(draw.shape);
        for index in 0..draw.n {
            let mut u = [0.0; N];
            fill(draw.seed, index, &mut u);
            if let Some(Defect { axis, exponent }) = draw.defect
                && let Some(u) = u.get_mut(axis)
            {
                *u = u.powf(exponent);
            }
            match sampler(u) {
                Some(point) => histogram.add(target.domain.to_square(point)),
                None => histogram.add_discarded(),
            }
        }
        histogram
    })
}

/// The exponent 1 + δ for which u^(1 + δ) of uniform u has a given RMS relative error over equal columns.
fn exponent_of(rms: f64, columns: usize) -> f64 {
    let columns = columns.max(2) as f64;
    let reached = |delta: f64| {
        let mut square = 0.0;
        let (mut edge, mut below) = (0.0, 0.0);
        while edge < columns {
            edge += 1.0;
            let upto = (edge / columns).powf(1.0 / (1.0 + delta));
            square += columns * (upto - below - 1.0 / columns).powi(2);
            below = upto;
        }
        square.sqrt()
    };
    let mut high = 1.0;
    while reached(high) < rms && high < 1e6 {
        high *= 2.0;
    }
    1.0 + crate::power::bisect([0.0, high], |delta| reached(delta) < rms)
}

#[cfg(test)]
mod tests;
