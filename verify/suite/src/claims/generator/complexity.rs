//! Linear complexity tells the families apart without chance: a shift register of 2^j + 1 cells, of 19,937, or of half the bits.

use verify::claim::{Claim, Evidence, Resolution, Run, claim};
use verify::linear_complexity::linear_complexity;

use super::Named;
use crate::bounds;

/// Bits looked at: twice the Mersenne Twister's state of 19,937, and some.
const BITS: usize = 40_200;

/// What the linear complexity of a bit should be.
#[derive(Clone, Copy)]
enum Theory {
    /// This number, whatever the seed.
    Exactly(usize),
    /// That of random bits: half of their number, more or less.
    Random,
}

/// The claims about the complexity of the generators' bits.
pub(super) fn claims([lcg, twister, pcg, xoshiro]: [Named; 4]) -> Vec<Claim> {
    // bit j of a full-period LCG modulo 2^k repeats after 2^(j + 1) outputs, its second half the opposite of the first
    let weak = Linear { start: lcg, bit: 12, bits: 10_000, theory: Theory::Exactly((1 << 12) + 1) };
    let linear = Linear { start: twister, bit: 31, bits: BITS, theory: Theory::Exactly(19_937) };
    let random = |start| Linear { start, bit: 31, bits: BITS, theory: Theory::Random };
    vec![
        weak.claim("bit 12 of the LCG satisfies a recurrence of length 2¹² + 1", pcg),
        linear.claim(
            "a bit of the Mersenne Twister satisfies a recurrence of length 19,937, and no shorter one",
            pcg,
        ),
        random(pcg).claim("a bit of PCG satisfies no linear recurrence that random bits do not", twister),
        random(xoshiro)
            .claim("a bit of xoshiro satisfies no linear recurrence that random bits do not", twister),
    ]
}

/// One bit of a generator's outputs, and how complex it should be.
#[derive(Clone, Copy)]
struct Linear {
    start: Named,
    bit: u32,
    bits: usize,
    theory: Theory,
}

impl Linear {
    fn claim(self, says: &str, other: Named) -> Claim {
        claim(format!("generator/{}/linear-complexity", self.start.0), says)
            .bound(bounds::LINEAR_COMPLEXITY)
            .rejects(format!("{} in its place", other.0), move |run| {
                Ok(Self { start: other, ..self }.evidence(run))
            })
            .by(move |run| Ok(self.evidence(run)))
    }

    /// How far the complexity is from theory's.
    ///
    /// Of n random bits the complexity is L with probability 2^min(n − 2L, 2L − 1 − n) (n even), so that |L − n/2| ≥ d has 2·4^−d; a known complexity
    /// leaves no chance at all.
    fn evidence(&self, run: &Run) -> Evidence {
        let mut generator = self.start.1(run.seed);
        let bits: Vec<bool> = (0..self.bits).map(|_| generator.next_u32() >> self.bit & 1 == 1).collect();
        let found = linear_complexity(&bits);
        let expected = match self.theory {
            Theory::Exactly(expected) => expected,
            Theory::Random => self.bits / 2,
        };
        let distance = found.abs_diff(expected) as f64;
        let p_value = match self.theory {
            _ if distance == 0.0 => 1.0,
            Theory::Exactly(_) => 0.0,
            Theory::Random => 2.0 * 4.0_f64.powf(-distance),
        };
        // the smallest distance that is rejected at 1e-3: 2·4^−6 = 5e-4
        let smallest = if matches!(self.theory, Theory::Random) { 6.0 } else { 1.0 };
        Evidence {
            method: format!("linear complexity of {} bits", self.bits),
            n: self.bits as u64,
            statistic: found as f64,
            dof: None,
            p_value,
            estimate: distance,
            interval: [distance; 2],
            bound: bounds::LINEAR_COMPLEXITY,
            resolution: Resolution {
                quantity: "error of the linear complexity",
                value: smallest,
                power: 1.0,
            },
            doubts: Vec::new(),
            pictures: Vec::new(),
        }
    }
}
