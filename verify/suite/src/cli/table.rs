//! The table at the end of `verify`.

use std::io::{self, Write};

use verify::claim::Verdict;

use super::output::Words;
use crate::figures::{count, three};
use crate::report::{ClaimReport, Report};

/// Writes one line a claim, then the totals.
pub(super) fn write(words: &mut Words, report: &Report) -> io::Result<()> {
    let width = report.claims.iter().map(|claim| claim.id.len()).max().unwrap_or(0).max(5);
    writeln!(
        words,
        "{:9}  {:width$}  {:>9}  {:>9}  {:>9}  {:>9}  {:>9}  {:>6}",
        "verdict", "claim", "estimate", "at most", "bound", "resolves", "n", "s"
    )?;
    for claim in &report.claims {
        write_claim(words, claim, width)?;
    }
    writeln!(words)?;
    for error in &report.errors {
        writeln!(words, "could not run: {}: {}", error.id, error.message)?;
    }
    let [holds, fails, undecided] =
        [Verdict::Holds, Verdict::Fails, Verdict::Undecided].map(|verdict| report.count(verdict));
    writeln!(
        words,
        "{} claims in {:.1} s: {holds} hold, {fails} fail, {undecided} undecided (level {}, seed {})",
        report.claims.len() + report.errors.len(),
        report.seconds,
        report.level,
        report.seed
    )
}

fn write_claim(words: &mut Words, claim: &ClaimReport, width: usize) -> io::Result<()> {
    let colour = match claim.verdict {
        Verdict::Holds => 32,
        Verdict::Fails => 31,
        Verdict::Undecided => 33,
    };
    let verdict = words.painted(&format!("{:9}", claim.verdict.to_string()), colour);
    writeln!(
        words,
        "{verdict}  {:width$}  {:>9}  {:>9}  {:>9}  {:>9}  {:>9}  {:>6.2}",
        claim.id,
        three(claim.estimate),
        three(claim.interval[1]),
        three(Some(claim.bound)),
        three(claim.resolves.value),
        count(claim.n),
        claim.seconds
    )?;
    for control in claim.controls.iter().filter(|control| !control.rejected) {
        writeln!(
            words,
            "           control \"{}\" is wrong and was accepted: the test is blind to it",
            control.name
        )?;
    }
    for doubt in &claim.doubts {
        writeln!(words, "           doubt: {doubt}")?;
    }
    Ok(())
}
