//! Elementary intervals: the exact structure of (t, m, 2)-nets in base 2.

/// An elementary interval that does not hold its share of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Uneven {
    /// The square is cut into 2^x columns and 2^y rows.
    pub cuts: [u32; 2],
    /// Column and row of the interval.
    pub cell: [usize; 2],
    /// Points found in it.
    pub found: usize,
    /// Points that a net has in it.
    pub expected: usize,
}

/// Checks that 2^m points form a (t, m, 2)-net in base 2: each interval of area 2^(t−m) holds 2^t of them.
///
/// Returns: the first interval that holds another number; `None` for a net. Exact: a point is on the side on which its f64 is.
///
/// # Panics
/// If the number of points is not a power of two, or below 2^t.
///
/// # Source
/// Niederreiter 1987, 10.1007/BF01294651, definition 2.2.
#[must_use]
pub fn first_uneven(points: &[[f64; 2]], t: u32) -> Option<Uneven> {
    assert!(points.len().is_power_of_two(), "a net in base 2 has 2^m points, not {}", points.len());
    let m = points.len().ilog2();
    assert!(t <= m, "t is {t}, above m = {m}");
    let expected = 1 << t;
    (0..=m - t).find_map(|x| {
        let cuts = [x, m - t - x];
        let counts = counts(points, cuts);
        let place = counts.iter().position(|&count| count != expected)?;
        let cell = [place & ((1 << x) - 1), place >> x];
        Some(Uneven { cuts, cell, found: counts[place], expected })
    })
}

/// The smallest t for which the points form a (t, m, 2)-net in base 2; m at most.
///
/// # Panics
/// If the number of points is not a power of two.
#[must_use]
pub fn quality(points: &[[f64; 2]]) -> u32 {
    (0..points.len().ilog2()).find(|&t| first_uneven(points, t).is_none()).unwrap_or(points.len().ilog2())
}

fn counts(points: &[[f64; 2]], cuts: [u32; 2]) -> Vec<usize> {
    let mut counts = vec![0; 1 << (cuts[0] + cuts[1])];
    for point in points {
        // Times a power of two is exact, so the cell is too; a point at or above 1 counts in no cell.
        let cell = |axis: usize| {
            let scaled = point[axis] * f64::from(1_u32 << cuts[axis]);
            #[expect(
                clippy::cast_possible_truncation,
                reason = "the floor is what is wanted, of a number below 2^32"
            )]
            let place = scaled as usize;
            ((0.0..1.0).contains(&point[axis])).then_some(place)
        };
        if let (Some(x), Some(y)) = (cell(0), cell(1)) {
            counts[y << cuts[0] | x] += 1;
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seeds::uniform;

    /// Hammersley's points (i/n, bit-reversed i), a (0, m, 2)-net, scrambled by a constant for each coordinate.
    fn hammersley(m: u32) -> Vec<[f64; 2]> {
        let unit = |word: u32| f64::from(word) * 2.0_f64.powi(-32);
        (0..1 << m)
            .map(|i: u32| [unit((i << (32 - m)) ^ 0x6ab1_9d3c), unit(i.reverse_bits() ^ 0x91e2_0b57)])
            .collect()
    }

    #[test]
    fn a_net_passes_and_one_moved_point_breaks_it() {
        for m in [1, 4, 8, 10] {
            let mut points = hammersley(m);
            assert_eq!(first_uneven(&points, 0), None);
            points[0][0] = (points[0][0] + 0.5).fract();
            let uneven = first_uneven(&points, 0).unwrap();
            assert!(uneven.found != uneven.expected && uneven.expected == 1);
            assert!(quality(&points) > 0);
        }
    }

    #[test]
    fn random_points_and_a_plain_grid_are_no_nets() {
        let random: Vec<[f64; 2]> = (0..256).map(|i| [uniform(1, 2 * i), uniform(1, 2 * i + 1)]).collect();
        assert!(first_uneven(&random, 0).is_some());
        let grid: Vec<[f64; 2]> =
            (0..256).map(|i| [f64::from(i % 16) / 16.0, f64::from(i / 16) / 16.0]).collect();
        assert_eq!(quality(&grid), 4); // rows of 16 share one y: 2^4 points in each strip of width 1/16
        assert!(first_uneven(&[[1.0, 0.5], [0.2, 0.2]], 0).is_some());
    }
}
