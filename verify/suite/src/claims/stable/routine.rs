//! Routines with their exact values: the largest error over hard inputs from a table and over drawn ones.

use std::hint::black_box;
use std::time::Instant;

use verify::claim::{Claim, Evidence, Resolution, Run, claim};
use verify::error::InputError;
use verify::mean::CONTROL_FACTOR;

use super::numbers::Numbers;
use crate::report::StabilityRow;

/// Half a unit in the last place of single precision, 2⁻²⁴: the relative error of one rounding.
pub(super) const ROUNDING: f64 = 1.0 / 16_777_216.0;

/// Half a unit in the last place of double precision.
pub(super) const ROUNDING_F64: f64 = f64::EPSILON / 2.0;

/// How a value is measured: what counts as one unit of error.
pub(super) type Unit<const N: usize, const M: usize> = fn(&[f64; N], &[f64; M]) -> [f64; M];

/// One way to compute the values.
pub(super) type Form<const N: usize, const M: usize> = fn(&[f64; N]) -> [f64; M];

/// An input and its exact values.
type Row<const N: usize, const M: usize> = ([f64; N], [f64; M]);

/// A routine from N numbers to M numbers, over a range of inputs.
///
/// A value that is NaN stands for "none", and agrees only with NaN.
#[derive(Clone, Copy)]
pub(super) struct Routine<const N: usize, const M: usize> {
    /// Routine and range, as in the claim's name.
    pub(super) id: &'static str,
    /// What is asserted.
    pub(super) says: &'static str,
    /// What one unit of error is, in words.
    pub(super) unit: &'static str,
    /// How far a value may be from the exact one.
    pub(super) bound: f64,
    /// One unit of error at an input and its exact values.
    pub(super) one: Unit<N, M>,
    /// Inputs with their values to 50 digits, as a file of `references/stability`; or none.
    pub(super) table: &'static str,
    /// Inputs that are always tried.
    pub(super) corners: &'static [[f64; N]],
    /// Draws an input.
    pub(super) draw: fn(&Numbers) -> [f64; N],
    /// How many inputs a run draws at effort 1.
    pub(super) draws: u64,
    /// The values by another derivation in double precision.
    pub(super) exact: Form<N, M>,
    /// The renderer's values.
    pub(super) ours: Form<N, M>,
    /// The form that is usual and loses digits, by name.
    pub(super) naive: (&'static str, Form<N, M>),
}

/// The largest error of `subject` over a run's inputs, the number of inputs, and the largest error of the second
/// derivation against the table.
struct Worst {
    error: f64,
    inputs: u64,
    second: f64,
}

impl<const N: usize, const M: usize> Routine<N, M> {
    /// The claim that the routine stays within its bound, which its usual form doesn't.
    pub(super) fn claim(self) -> Claim {
        let (naive, off) = (self, self);
        claim(format!("stable/{}", self.id), self.says)
            .rejects(format!("{} × bound", CONTROL_FACTOR), move |run| {
                off.evidence(run, &|x| {
                    let (value, exact) = ((off.ours)(x), (off.exact)(x));
                    let one = (off.one)(x, &exact);
                    std::array::from_fn(|i| value[i] + CONTROL_FACTOR * off.bound * one[i])
                })
            })
            .rejects(self.naive.0, move |run| naive.evidence(run, &naive.naive.1))
            .by(move |run| self.evidence(run, &self.ours))
    }

    fn evidence(&self, run: &Run, subject: &dyn Fn(&[f64; N]) -> [f64; M]) -> Result<Evidence, InputError> {
        let Worst { error, inputs, second } = self.worst(run.seed, self.draws * run.effort, subject)?;
        // The second opinion must agree with the table to a tenth of what is asserted.
        let disagrees = second > 0.1 * self.bound;
        let doubt =
            format!("the derivation in double precision is {second:.3} {} off the 50 digits", self.unit);
        Ok(worst_case(self.unit, error, inputs, self.bound, disagrees.then_some(doubt)))
    }

    fn worst(
        &self,
        seed: u64,
        draws: u64,
        subject: &dyn Fn(&[f64; N]) -> [f64; M],
    ) -> Result<Worst, InputError> {
        let mut worst = Worst { error: 0.0, inputs: 0, second: 0.0 };
        for (x, exact) in self.rows()? {
            worst.error = worst.error.max(self.error(&x, &exact, &subject(&x)));
            worst.second = worst.second.max(self.error(&x, &exact, &(self.exact)(&x)));
            worst.inputs += 1;
        }
        let drawn = (0..draws).map(|index| (self.draw)(&Numbers::new(seed, index)));
        for x in self.corners.iter().copied().chain(drawn) {
            worst.error = worst.error.max(self.error(&x, &(self.exact)(&x), &subject(&x)));
            worst.inputs += 1;
        }
        Ok(worst)
    }

    /// The largest error of the values, in units.
    fn error(&self, x: &[f64; N], exact: &[f64; M], value: &[f64; M]) -> f64 {
        let one = (self.one)(x, exact);
        let errors = (0..M).map(|i| match (exact[i], value[i]) {
            (e, v) if e == v || e.is_nan() && v.is_nan() => 0.0,
            (e, v) if e.is_finite() && v.is_finite() => (v - e).abs() / one[i],
            _ => f64::INFINITY,
        });
        // A unit of 0 makes the error infinite or NaN; neither may pass.
        errors.fold(0.0, |a, b| {
            if b <= a {
                a
            } else if b.is_nan() {
                f64::INFINITY
            } else {
                b
            }
        })
    }

    /// The table's inputs and values.
    fn rows(&self) -> Result<Vec<Row<N, M>>, InputError> {
        let wrong = |line: &str| InputError::Subject(format!("table of stable/{}: \"{line}\"", self.id));
        let lines = self.table.lines().filter(|line| !line.starts_with('#')).skip(1);
        lines
            .map(|line| {
                let cells: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
                let cells = cells.map_err(|_| wrong(line))?;
                if cells.len() != N + M {
                    return Err(wrong(line));
                }
                Ok((std::array::from_fn(|i| cells[i]), std::array::from_fn(|i| cells[N + i])))
            })
            .collect()
    }

    /// The row of the table of what stability costs: worst errors and times of the usual form and of ours.
    pub(super) fn row(&self) -> Result<StabilityRow, InputError> {
        let draws = self.draws.min(1000);
        let worst = |subject: Form<N, M>| Ok(self.worst(0, draws, &subject)?.error);
        let inputs: Vec<[f64; N]> = (0..draws.min(256)).map(|i| (self.draw)(&Numbers::new(1, i))).collect();
        let [naive_ns, ours_ns] = nanoseconds(&inputs, [self.naive.1, self.ours]);
        let known = |error: f64| error.is_finite().then_some(error);
        Ok(StabilityRow {
            routine: String::from(self.id),
            unit: String::from(self.unit),
            naive: String::from(self.naive.0),
            naive_error: known(worst(self.naive.1)?),
            error: known(worst(self.ours)?),
            bound: self.bound,
            naive_ns,
            ours_ns,
        })
    }
}

/// Nanoseconds a call of both forms, each the least of five rounds that alternate.
fn nanoseconds<const N: usize, const M: usize>(inputs: &[[f64; N]], forms: [Form<N, M>; 2]) -> [f64; 2] {
    let mut least = [f64::INFINITY; 2];
    for _ in 0..5 {
        for (form, least) in forms.iter().zip(&mut least) {
            let start = Instant::now();
            for x in inputs {
                black_box(form(black_box(x)));
            }
            *least = least.min(start.elapsed().as_secs_f64() * 1e9 / inputs.len().max(1) as f64);
        }
    }
    least
}

/// The evidence of a largest error over inputs: rejected where it passes the bound.
pub(super) fn worst_case(
    unit: &'static str,
    error: f64,
    inputs: u64,
    bound: f64,
    doubt: Option<String>,
) -> Evidence {
    Evidence {
        method: String::from("largest error over hard and drawn inputs"),
        n: inputs,
        statistic: error,
        dof: None,
        p_value: if error < bound { 1.0 } else { 0.0 },
        estimate: error,
        interval: [error, error],
        bound,
        resolution: Resolution { quantity: unit, value: bound, power: 1.0 },
        doubts: doubt.into_iter().collect(),
        pictures: Vec::new(),
    }
}

/// A unit in the last place of single precision at `exact`, subnormal numbers included.
pub(super) fn ulp(exact: f64) -> f64 {
    let exponent = if exact == 0.0 { -126 } else { libm_exponent(exact).max(-126) };
    2f64.powi(exponent - 23)
}

/// ⌊log₂|x|⌋ of a normal number.
fn libm_exponent(x: f64) -> i32 {
    let bits = (x.abs().to_bits() >> 52) & 0x7ff;
    i32::try_from(bits).unwrap_or(0) - 1023
}

/// Every value in units of its own last place.
pub(super) fn ulps<const N: usize, const M: usize>(_: &[f64; N], exact: &[f64; M]) -> [f64; M] {
    exact.map(ulp)
}

/// Every value in units of 2⁻²⁴ of itself, or of the smallest number.
pub(super) fn roundings<const N: usize, const M: usize>(_: &[f64; N], exact: &[f64; M]) -> [f64; M] {
    exact.map(|e| (e.abs() * ROUNDING).max(f64::from(f32::from_bits(1))))
}

/// The nearest single-precision number.
pub(super) fn single(x: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "to round is the purpose")]
    let rounded = x as f32;
    rounded
}
