//! Claims: what is asserted, with which bound, and what the evidence could have seen.

use crate::error::InputError;

/// What a claim concludes from its evidence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The 99.9 % upper limit of the defect is below the bound.
    Holds,
    /// Three runs in a row, at n, 4n and 16n, each rejected "exactly right" at 1e-3.
    Fails,
    /// Neither; never a pass.
    Undecided,
}

/// The smallest defect that a run would have caught, and how surely.
#[derive(Debug, Clone, PartialEq)]
pub struct Resolution {
    /// What the value measures, such as "RMS relative error over cells".
    pub quantity: &'static str,
    /// The smallest defect caught, in that quantity.
    pub value: f64,
    /// The probability of catching it in one run at 1e-3.
    pub power: f64,
}

/// Circumstances of one run of a claim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// Seed of this run; every random number of the run derives from it.
    pub seed: u64,
    /// Factor on the claim's own sample count: the level's (1, 8, 64) times the escalation's (1, 4, 16).
    pub effort: u64,
}

/// What one run of a claim found.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// Name of the test, such as "chi-square, 200 cells".
    pub method: String,
    /// Number of independent draws (or replicates).
    pub n: u64,
    /// The test statistic.
    pub statistic: f64,
    /// Degrees of freedom of the statistic, where it has any.
    pub dof: Option<f64>,
    /// Probability of such a statistic if the subject is exactly right.
    pub p_value: f64,
    /// The defect's estimate, in the quantity of the resolution.
    pub estimate: f64,
    /// The defect's 99.9 % confidence limits, lower and upper.
    pub interval: [f64; 2],
    /// The bound that the defect must stay below.
    pub bound: f64,
    /// The smallest defect that this run would have caught.
    pub resolution: Resolution,
    /// Reasons why normal theory is not trusted here (then the verdict is never `Holds`).
    pub doubts: Vec<String>,
    /// Data for pictures, in the order in which they are drawn.
    pub pictures: Vec<Picture>,
}

/// Data that a report can draw.
#[derive(Debug, Clone, PartialEq)]
pub enum Picture {
    /// Values on a grid of cells, row by row: observed and expected counts.
    Cells {
        /// Columns and rows.
        shape: [usize; 2],
        /// What the columns and the rows are.
        axes: [&'static str; 2],
        /// Counts observed.
        observed: Vec<f64>,
        /// Counts expected.
        expected: Vec<f64>,
    },
    /// Error against sample count, one line a subject, with the theory's slope.
    Convergence {
        /// The lines.
        lines: Vec<Line>,
    },
    /// Measured points with standard errors on an exact curve.
    Curve {
        /// What the horizontal and the vertical axis are, with units.
        axes: [&'static str; 2],
        /// Exact values, x and y.
        exact: Vec<[f64; 2]>,
        /// Measured: x, y and the standard error of y.
        measured: Vec<[f64; 3]>,
    },
}

/// One line of a convergence plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name in the legend.
    pub name: String,
    /// Sample count, root mean square error, and the standard error of its natural logarithm.
    pub points: Vec<[f64; 3]>,
    /// Slope fitted to ln error against ln n, and its 99.9 % confidence limits.
    pub slope: [f64; 3],
    /// Slope that theory predicts.
    pub theory: f64,
}

/// Anything that turns circumstances into evidence.
pub type Trial<'a> = Box<dyn Fn(&Run) -> Result<Evidence, InputError> + Send + Sync + 'a>;
