//! Pictures' data in a report: what [`Picture`] holds, in the precision of a drawing (`f32`).

use serde::{Deserialize, Serialize};
use verify::claim::{Line, Picture};

/// Data of one picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum PictureData {
    /// Counts on a grid, row by row from the row of lowest values.
    Cells {
        /// Columns and rows.
        shape: [usize; 2],
        /// What columns and rows are.
        axes: [String; 2],
        /// Counts observed.
        observed: Vec<f32>,
        /// Counts expected.
        expected: Vec<f32>,
    },
    /// Error against sample count.
    Convergence {
        /// One line a subject.
        lines: Vec<LineData>,
    },
    /// Measured points on an exact curve.
    Curve {
        /// What the axes are.
        axes: [String; 2],
        /// Exact values.
        exact: Vec<[f32; 2]>,
        /// Measured x, y and standard error of y.
        measured: Vec<[f32; 3]>,
    },
}

/// One line of a convergence plot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LineData {
    /// Name in the legend.
    pub name: String,
    /// Sample count, root mean square error, standard error of its natural logarithm.
    pub points: Vec<[f32; 3]>,
    /// Fitted slope and its 99.9 % limits; `null` where there is none.
    pub slope: [Option<f32>; 3],
    /// Slope that theory predicts.
    pub theory: f32,
}

impl PictureData {
    /// The data of a picture; points with a coordinate that is not finite cannot be drawn and are left out.
    pub fn of(picture: &Picture) -> Self {
        match picture {
            Picture::Cells { shape, axes, observed, expected } => Self::Cells {
                shape: *shape,
                axes: axes.map(String::from),
                observed: observed.iter().map(|&v| single(v)).collect(),
                expected: expected.iter().map(|&v| single(v)).collect(),
            },
            Picture::Convergence { lines } => {
                Self::Convergence { lines: lines.iter().map(LineData::of).collect() }
            }
            Picture::Curve { axes, exact, measured } => Self::Curve {
                axes: axes.map(String::from),
                exact: drawable(exact),
                measured: drawable(measured),
            },
        }
    }
}

impl LineData {
    fn of(line: &Line) -> Self {
        Self {
            name: line.name.clone(),
            points: drawable(&line.points),
            slope: line.slope.map(|v| v.is_finite().then_some(single(v))),
            theory: single(line.theory),
        }
    }
}

/// Points all of whose coordinates are finite.
fn drawable<const N: usize>(points: &[[f64; N]]) -> Vec<[f32; N]> {
    points.iter().filter(|point| point.iter().all(|v| v.is_finite())).map(|point| point.map(single)).collect()
}

#[expect(clippy::cast_possible_truncation, reason = "seven digits are more than a drawing shows")]
fn single(value: f64) -> f32 {
    value as f32
}
