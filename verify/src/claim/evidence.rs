//! What one run of a claim found, and what it could have seen.

use super::{SINGLE_RUN_LEVEL, Verdict};

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

impl Evidence {
    /// Whether the 99.9 % upper limit of the defect is below the bound and nothing speaks against trusting
    /// it.
    pub fn is_within_bound(&self) -> bool {
        self.interval[1] < self.bound && self.doubts.is_empty()
    }

    /// The verdict on a subject that cannot be drawn again, such as a file: `Fails` at 1e-9, since there is
    /// no second run.
    pub fn verdict_of_single_run(&self) -> Verdict {
        if self.p_value < SINGLE_RUN_LEVEL {
            Verdict::Fails
        } else if self.is_within_bound() {
            Verdict::Holds
        } else {
            Verdict::Undecided
        }
    }
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
