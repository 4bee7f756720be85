//! Reasons why a test cannot run. A rejected hypothesis is a [`Verdict`](crate::claim::Verdict), not an error.

/// Why a test could not be carried out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InputError {
    /// A density is negative or not a number somewhere.
    #[error("the density is {value} at {place}; it must be finite and at least 0")]
    Density {
        /// The value found.
        value: f64,
        /// Where, in the domain's own terms.
        place: String,
    },
    /// A quadrature did not reach its tolerance.
    #[error("quadrature reached a relative error of {reached:e}, not {wanted:e}, on {place}")]
    Quadrature {
        /// Estimated relative error reached.
        reached: f64,
        /// Relative error asked for.
        wanted: f64,
        /// Which cell or integral.
        place: String,
    },
    /// A parameter is outside its range.
    #[error("{name} is {value}; {accepted} is accepted")]
    Parameter {
        /// The parameter's name.
        name: &'static str,
        /// The value given.
        value: f64,
        /// The accepted range.
        accepted: &'static str,
    },
    /// Fewer observations than the test needs.
    #[error("{given} {what} given; at least {needed} are needed")]
    TooFew {
        /// What was counted.
        what: &'static str,
        /// How many there are.
        given: u64,
        /// How many are needed.
        needed: u64,
    },
    /// A test that assumes independent draws was given a source that declares itself low-discrepancy.
    #[error("{test} assumes independent draws; this source declares itself low-discrepancy")]
    NotIndependent {
        /// The test's name.
        test: &'static str,
    },
    /// What a subject (a renderer, a file) reported instead of a result.
    #[error("{0}")]
    Subject(String),
}
