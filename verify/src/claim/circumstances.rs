//! Under which seed and with how much effort a claim runs.

use crate::seeds::derive;

/// Circumstances of one run of a claim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// Seed of this run; every random number of the run derives from it.
    pub seed: u64,
    /// Factor on the claim's own sample count: the level's (1, 8, 64) times the escalation's (1, 4, 16).
    pub effort: u64,
}

/// How thoroughly claims are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// The claim's own sample count.
    Quick,
    /// Eight times the quick level's samples.
    Standard,
    /// 64 times the quick level's samples.
    Exhaustive,
}

impl Level {
    /// The factor on a claim's own sample count.
    pub fn effort(self) -> u64 {
        match self {
            Self::Quick => 1,
            Self::Standard => 8,
            Self::Exhaustive => 64,
        }
    }

    /// The name on command lines and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Standard => "standard",
            Self::Exhaustive => "exhaustive",
        }
    }

    /// The level of that name.
    pub fn named(name: &str) -> Option<Self> {
        [Self::Quick, Self::Standard, Self::Exhaustive].into_iter().find(|level| level.name() == name)
    }

    /// The level in the environment variable `VERIFY_LEVEL`; `Quick` where it is not set.
    ///
    /// # Panics
    /// If it is set to anything but `quick`, `standard` or `exhaustive`: a test that ran at another level
    /// than asked for would mislead.
    pub fn from_env() -> Self {
        let Ok(name) = std::env::var("VERIFY_LEVEL") else { return Self::Quick };
        match Self::named(&name) {
            Some(level) => level,
            None => panic!("VERIFY_LEVEL is {name:?}; quick, standard or exhaustive is accepted"),
        }
    }
}

/// Where seeds come from.
pub enum Seed {}

impl Seed {
    /// The master seed in the environment variable `VERIFY_SEED`; 0 where it is not set.
    ///
    /// # Panics
    /// If it is set to anything but an integer from 0 to 2⁶⁴ − 1: a test that ran from another seed than
    /// asked for would mislead.
    pub fn from_env() -> u64 {
        let Ok(text) = std::env::var("VERIFY_SEED") else { return 0 };
        match text.parse() {
            Ok(seed) => seed,
            Err(_) => {
                panic!("VERIFY_SEED is {text:?}; an integer from 0 to 18446744073709551615 is accepted")
            }
        }
    }

    /// Derives the seed of one step of one subject from the master seed.
    ///
    /// The label is hashed with 64-bit FNV-1a; [`seeds::derive`](crate::seeds::derive) joins master, hash and
    /// step, so that seeds of different masters, labels or steps are unrelated.
    ///
    /// # Source
    /// Fowler, Noll, Vo, "The FNV non-cryptographic hash algorithm".
    pub fn derive(master: u64, label: &str, step: u64) -> u64 {
        let fnv = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        derive(master, label.bytes().fold(0xcbf2_9ce4_8422_2325, fnv), step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derived_seeds_differ_by_master_label_and_step() {
        let mut seeds: Vec<u64> = (0..20)
            .flat_map(|master| {
                ["a", "b", "ab", "ba", ""]
                    .map(|label| [0, 1, 2].map(|step| Seed::derive(master, label, step)))
            })
            .flatten()
            .collect();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 20 * 5 * 3);
    }

    #[test]
    fn levels_are_found_by_name() {
        assert_eq!(Level::named("standard"), Some(Level::Standard));
        assert_eq!(Level::named("Standard"), None);
    }
}
