//! Runs a list of claims on several threads.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use verify::claim::{Claim, Level, Outcome};

use crate::report::ClaimError;

/// Under which circumstances claims are run.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Master seed.
    pub seed: u64,
    /// How thoroughly.
    pub level: Level,
    /// How many claims at once.
    pub threads: usize,
}

/// Runs the claims, each on a thread of its own, in the order of the list; returns their results in that order.
///
/// Claims do not run on rayon's threads: one that renders waits for rayon's workers there, and a worker that waits takes up the next
/// claim, whose time would count twice.
///
/// * `done`: called after each claim, on its thread.
pub fn run(
    claims: &[&Claim],
    settings: Settings,
    done: impl Fn(&Claim) + Sync,
) -> Vec<Result<Outcome, ClaimError>> {
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<Result<Outcome, ClaimError>>>> =
        claims.iter().map(|_| Mutex::new(None)).collect();
    let work = || {
        while let Some((claim, slot)) = {
            let i = next.fetch_add(1, Ordering::Relaxed);
            claims.get(i).zip(results.get(i))
        } {
            let result = run_one(claim, settings);
            *slot.lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
            done(claim);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..settings.threads.clamp(1, claims.len().max(1)) {
            scope.spawn(work);
        }
    });
    let taken = results.into_iter().map(|slot| slot.into_inner().unwrap_or_else(PoisonError::into_inner));
    taken.map(|result| result.expect("the scope ends when every claim has run")).collect()
}

/// Runs one claim; a panic in it is our bug, but it must not hide what the others found.
fn run_one(claim: &Claim, settings: Settings) -> Result<Outcome, ClaimError> {
    let error = |message| ClaimError { id: String::from(claim.id()), message };
    match catch_unwind(AssertUnwindSafe(|| claim.run(settings.seed, settings.level))) {
        Ok(result) => result.map_err(|reason| error(reason.to_string())),
        Err(_) => Err(error(String::from("panicked; the message is above"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use verify::claim::{Evidence, Resolution, Verdict, claim};
    use verify::error::InputError;

    fn evidence(n: u64) -> Evidence {
        Evidence {
            method: String::from("given"),
            n,
            statistic: 0.0,
            dof: None,
            p_value: 0.5,
            estimate: 0.0,
            interval: [0.0, 0.1],
            bound: 1.0,
            resolution: Resolution { quantity: "given", value: 0.5, power: 0.9 },
            doubts: Vec::new(),
            pictures: Vec::new(),
        }
    }

    #[test]
    fn results_are_in_the_order_of_the_list_for_any_number_of_threads() {
        let claims: Vec<Claim> =
            (0..9).map(|i| claim(format!("a/b/{i}"), "").by(move |_| Ok(evidence(i)))).collect();
        let list: Vec<&Claim> = claims.iter().collect();
        for threads in [1, 2, 20] {
            let settings = Settings { seed: 0, level: Level::Quick, threads };
            let results = run(&list, settings, |_| ());
            let n: Vec<u64> = results.iter().flatten().map(|outcome| outcome.evidence.n).collect();
            assert_eq!(n, (0..9).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_claim_that_cannot_run_or_panics_hides_no_other() {
        let claims = [
            claim("a/b/refused", "").by(|_| Err(InputError::Subject(String::from("no scene")))),
            claim("a/b/panics", "").by(|_| panic!("as this test wants")),
            claim("a/b/right", "").by(|_| Ok(evidence(1))),
        ];
        let list: Vec<&Claim> = claims.iter().collect();
        let results = run(&list, Settings { seed: 0, level: Level::Quick, threads: 1 }, |_| ());
        assert_eq!(results[0].as_ref().err().map(|e| e.message.as_str()), Some("no scene"));
        assert!(results[1].is_err());
        assert_eq!(results[2].as_ref().map(|outcome| outcome.verdict), Ok(Verdict::Holds));
    }
}
