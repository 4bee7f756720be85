//! Sobol's generator matrices, as tables that turn the bytes of an index into digits.

/// Primitive polynomials and initial direction numbers of the dimensions after the first.
///
/// Each row: the polynomial's inner coefficients, the first of them highest, and the odd numbers m1, m2, …, as
/// many as its degree.
///
/// # Source
/// Joe and Kuo 2008, "Constructing Sobol sequences with better two-dimensional projections",
/// doi 10.1137/070709359; dimensions 2 to 16 of their file new-joe-kuo-6.21201.
const JOE_KUO: [(u32, &[u32]); DIMENSIONS - 1] = [
    (0, &[1]),
    (1, &[1, 3]),
    (1, &[1, 3, 1]),
    (2, &[1, 1, 1]),
    (1, &[1, 1, 3, 3]),
    (4, &[1, 3, 5, 13]),
    (2, &[1, 1, 5, 5, 17]),
    (4, &[1, 1, 5, 5, 5]),
    (7, &[1, 1, 7, 11, 19]),
    (11, &[1, 1, 5, 1, 1]),
    (13, &[1, 1, 1, 3, 11]),
    (14, &[1, 3, 5, 5, 31]),
    (1, &[1, 3, 3, 9, 7, 49]),
    (13, &[1, 1, 1, 15, 21, 21]),
    (16, &[1, 3, 1, 13, 27, 49]),
];

/// How many dimensions have direction numbers here.
pub(super) const DIMENSIONS: usize = 16;

/// One dimension of the sequence for indices below 2³²: for each byte of the index, the digits it adds.
#[derive(Debug, Clone)]
pub(super) struct Dimension([[u32; 256]; 4]);

impl Dimension {
    /// The tables of dimension `dimension`, from 0.
    pub(super) fn new(dimension: usize) -> Self {
        let columns = columns(dimension);
        let mut tables = [[0; 256]; 4];
        for (table, columns) in tables.iter_mut().zip(columns.chunks_exact(8)) {
            for byte in 1..256_usize {
                let rest = byte & (byte - 1);
                table[byte] = table[rest] ^ columns[byte.trailing_zeros() as usize];
            }
        }
        Self(tables)
    }

    /// The digits of point `index` in reverse: the first digit lowest.
    #[inline]
    pub(super) fn digits_reversed(&self, index: u32) -> u32 {
        let byte = |k: u32| (index >> (8 * k) & 255) as usize;
        let low = self.0[0][byte(0)] ^ self.0[1][byte(1)];
        if index >> 16 == 0 { low } else { low ^ self.0[2][byte(2)] ^ self.0[3][byte(3)] }
    }
}

/// What each bit of the index adds, as reversed digits.
fn columns(dimension: usize) -> [u32; 32] {
    if dimension == 0 {
        return std::array::from_fn(|k| 1 << k);
    }
    let (polynomial, initial) = JOE_KUO[dimension - 1];
    let degree = initial.len();
    let mut v = [0_u32; 32];
    for k in 0..32 {
        v[k] = if k < degree {
            initial[k] << (31 - k)
        } else {
            // Bit j of the inner coefficients, from the highest, belongs to the column j + 1 before.
            let inner = (1..degree).filter(|&j| polynomial >> (degree - 1 - j) & 1 == 1);
            inner.fold(v[k - degree] ^ v[k - degree] >> degree, |sum, j| sum ^ v[k - j])
        };
    }
    v.map(u32::reverse_bits)
}

/// The digits of dimension 1 in reverse, without a table.
///
/// Its matrix is Pascal's triangle modulo 2, which is a product of five sparse matrices; dimension 0 in reverse is
/// the index itself.
#[inline]
pub(super) const fn second_dimension_reversed(mut index: u32) -> u32 {
    index ^= (index & 0xaaaa_aaaa) >> 1;
    index ^= (index & 0xcccc_cccc) >> 2;
    index ^= (index & 0xf0f0_f0f0) >> 4;
    index ^= (index & 0xff00_ff00) >> 8;
    index ^ (index & 0xffff_0000) >> 16
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "a dimension is below 16")]
mod tests {
    use super::*;
    use crate::sampling::hash::{halves, mixed};

    #[test]
    fn the_first_65536_points_are_those_of_another_implementation() {
        for dimension in 0..DIMENSIONS {
            let tables = Dimension::new(dimension);
            for index in (0..1_u32 << 16).step_by(7) {
                let other = sobol_burley::parts::sobol_rev(index.reverse_bits(), dimension as u32);
                assert_eq!(tables.digits_reversed(index), other, "dimension {dimension}, point {index}");
            }
        }
    }

    #[test]
    fn the_second_dimension_needs_no_table() {
        let [first, second] = [Dimension::new(0), Dimension::new(1)];
        for n in 0..1_000 {
            let [index, _] = halves(mixed(n));
            assert_eq!(first.digits_reversed(index), index);
            assert_eq!(second.digits_reversed(index), second_dimension_reversed(index));
        }
    }

    #[test]
    fn every_dimension_is_a_permutation_of_the_first_2_to_the_m_cells() {
        // Upper triangular with ones on the diagonal: digit k is flipped by bit k of the index and by later ones.
        for dimension in 0..DIMENSIONS {
            for (k, column) in columns(dimension).into_iter().enumerate() {
                assert_eq!(column.ilog2() as usize, k, "dimension {dimension}");
            }
        }
    }
}
