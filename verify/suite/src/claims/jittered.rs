//! Points for means: a jittered square, so that a mean over few of them is already near its integral.

use verify::points;

use super::pointwise::single;

/// The fractional part of the golden ratio: its multiples fill the circle evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The mean of a function over one point in each cell of a square of `side`² cells.
///
/// * `f`: takes a jittered point of [0, 1)², and a third number in [0, 1) that fills its range evenly by itself.
///
/// Returns: for each seed, a value whose mean over seeds is the integral: every number is uniform on its own cell.
pub(super) fn mean(seed: u64, side: u32, mut f: impl FnMut([f32; 2], f32) -> f64) -> f64 {
    let count = u64::from(side) * u64::from(side);
    let mut shift = [0.0; 2];
    points::fill(seed, count, &mut shift);
    let mut sum = 0.0;
    let mut index = 0;
    for row in 0..side {
        for column in 0..side {
            let mut u = [0.0; 2];
            points::fill(seed, index, &mut u);
            let cell = [column, row];
            let jittered = [0, 1].map(|i| single((f64::from(cell[i]) + u[i]) / f64::from(side)));
            sum += f(jittered, single((shift[0] + index as f64 * GOLDEN).fract()));
            index += 1;
        }
    }
    sum / count as f64
}
