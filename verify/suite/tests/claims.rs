//! Every claim of a level as a test under its own name: the quick level's; `VERIFY_LEVEL` and `VERIFY_SEED` override level and seed.

use libtest_mimic::{Arguments, Failed, Trial};
use lightproof::claims;
use verify::claim::{Claim, Level, Seed, Verdict};

fn main() {
    let (seed, level) = (Seed::from_env(), Level::from_env());
    let trial = |claim: Claim| Trial::test(String::from(claim.id()), move || check(&claim, seed, level));
    libtest_mimic::run(&Arguments::from_args(), claims::at(level).into_iter().map(trial).collect()).exit();
}

/// Runs a claim; anything but `Holds` fails the test.
fn check(claim: &Claim, seed: u64, level: Level) -> Result<(), Failed> {
    let outcome = claim.run(seed, level)?;
    if outcome.verdict == Verdict::Holds { Ok(()) } else { Err(Failed::from(outcome.to_string())) }
}
