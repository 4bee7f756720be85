//! Chi-square tests of samplers: do points follow a density on a domain, and by how much could they miss it?
//!
//! The same points are counted on two grids: a coarse one of about 200 cells, which carries the bound, and a
//! fine one of about 20,000, which sees narrow errors. The statistic of the coarse grid is split into low-order
//! contrasts, which see smooth errors best, and the rest; the test on the fine grid is of the counts inside
//! each coarse cell, given that cell's count. The numbers of discarded samples and of samples at atoms (points
//! that have a probability of their own) are tested as binomials. These tests are independent, and their
//! p-values are joined exactly (Šidák).
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

mod contrasts;
mod draw;
mod expected;
mod judge;
mod pearson;
mod smooth;

use crate::claim::{Claim, Evidence, Level, Outcome, Run, claim};
use crate::domain::Domain;
use crate::error::InputError;
use crate::histogram::Histogram;
use crate::independence::Source;
use draw::{Defect, Draw, Subject, exponent_of, subject};
use expected::{Density, Expected};

pub use draw::Drawn;
pub use judge::Parts;

/// Size of the automatic control's defect, in resolutions: caught in practice always, and still small.
const CONTROL_RESOLUTIONS: f64 = 2.2;

/// Bound where none is given: an RMS relative error over cells of 1 %.
const DEFAULT_BOUND: f64 = 0.01;

/// A domain and the density that points on it should have.
pub struct Target<D: Domain> {
    domain: D,
    density: Density<D::Point>,
    /// Probabilities of the points that have one of their own.
    atoms: Vec<f64>,
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
    source: Source,
}

impl<D: Domain> ChiSquare<D> {
    /// Starts a test on a domain; the density is uniform unless [`Target::density`] says otherwise.
    pub fn on(domain: D) -> Target<D> {
        Target { domain, density: Density::Uniform, atoms: Vec::new(), expected: OnceLock::new() }
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
        self.controls.push((name.into(), subject(&self.target, move |u| wrong(u).into())));
        self
    }

    /// Says what the sampler declares of its draws; independent if not set. A low-discrepancy source is refused: its counts are too
    /// even to be tested so.
    #[must_use]
    pub fn source(mut self, source: Source) -> Self {
        self.source = source;
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
        self.source.independent("chi-square")?;
        let n = self.target.sample_count(self.bound)? * run.effort;
        let histogram = subject(&Draw { seed: run.seed, n, defect });
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
        self.density = Density::Function(Box::new(density));
        self.expected = OnceLock::new();
        self
    }

    /// Sets a density that is constant on the cells of a regular grid over the domain's coordinates.
    ///
    /// * `shape`: columns and rows; `values`: row by row, per unit of the domain's measure, as for [`density`](Self::density).
    #[must_use]
    pub fn cells(mut self, shape: [usize; 2], values: Vec<f64>) -> Self {
        self.density = Density::Cells { shape, values };
        self.expected = OnceLock::new();
        self
    }

    /// Sets the probabilities of points that have one of their own (atoms, such as a mirror's direction); none if not set.
    ///
    /// Each is held against its count as a binomial; the density's integral and their sum may fall short of 1 together.
    #[must_use]
    pub fn atoms(mut self, probabilities: &[f64]) -> Self {
        self.atoms = probabilities.to_vec();
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
        self.draws(move |u| sampler(u).into())
    }

    /// Completes the test with a sampler that has atoms.
    ///
    /// * `sampler`: turns independent numbers, uniform on [0, 1), into what is drawn.
    pub fn draws<const N: usize>(
        self,
        sampler: impl Fn([f64; N]) -> Drawn<D::Point> + Send + Sync + 'static,
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
            source: Source::Independent,
        }
    }

    /// An empty histogram for [`judge`](Self::judge), to count points that come from elsewhere.
    pub fn histogram(&self) -> Histogram {
        let ([columns, rows], [x, y]) = (self.domain.coarse_grid(), self.domain.refinement());
        Histogram::with_atoms([columns * x, rows * y], self.atoms.len())
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

    /// The same for a smooth error, which lies in the low-order contrasts.
    ///
    /// # Errors
    /// `Density`, `Quadrature`, `TooFew`.
    pub fn smooth_resolution(&self, n: u64) -> Result<f64, InputError> {
        Ok(judge::smooth_resolution(self.expected()?, n))
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

    /// The three independent tests of which [`judge`](Self::judge) joins the p-values.
    ///
    /// # Errors
    /// `Density`, `Quadrature`, `TooFew`, `Parameter`.
    pub fn parts(&self, histogram: &Histogram) -> Result<Parts, InputError> {
        Ok(judge::parts(self.expected()?, histogram))
    }

    fn expected(&self) -> Result<&Expected, InputError> {
        self.expected
            .get_or_init(|| Expected::of(&self.domain, &self.density, &self.atoms))
            .as_ref()
            .map_err(Clone::clone)
    }
}

#[cfg(test)]
mod tests;
