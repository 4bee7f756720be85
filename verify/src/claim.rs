//! Claims: what is asserted, with which bound, and the rule that turns evidence into a verdict.
//!
//! A claim runs its subject up to three times, at n, 4n and 16n, each from a fresh seed derived from (master
//! seed, claim, step):
//! - a run that does not reject "exactly right" at 1e-3, whose 99.9 % upper limit is below the bound and
//!   which has no doubts ends it: `Holds`;
//! - three rejections in a row: `Fails`, so a right part fails once in 1e9 claims;
//! - otherwise (every run inconclusive, or some rejected and some not): `Undecided`.
//!
//! A run that neither rejects nor holds escalates too, since more samples may settle it. A subject whose
//! defect equals the bound has three chances of 1e-3 to hold. Controls (wrong versions) run once, at n; one
//! that is accepted makes the claim fail, for then the test is blind.

use std::time::Instant;

mod circumstances;
mod evidence;
mod outcome;

pub use circumstances::{Level, Run, Seed};
pub use evidence::{Evidence, Line, Picture, Resolution};
pub use outcome::{ControlOutcome, Outcome};

use crate::error::InputError;

/// Probability at which one run rejects "exactly right", and of each of an interval's two sides.
pub const REJECTION_LEVEL: f64 = 1e-3;

/// Probability at which a single run fails a subject that cannot be drawn again, such as a file of points or
/// an image.
pub const SINGLE_RUN_LEVEL: f64 = 1e-9;

/// Factors on the sample count of the runs of one claim, in order.
const ESCALATION: [u64; 3] = [1, 4, 16];

/// What a claim concludes from its evidence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The 99.9 % upper limit of the defect is below the bound.
    Holds,
    /// Three runs in a row, at n, 4n and 16n, each rejected "exactly right" at 1e-3; or a control was
    /// accepted.
    Fails,
    /// Neither; never a pass.
    Undecided,
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Holds => "holds",
            Self::Fails => "fails",
            Self::Undecided => "undecided",
        })
    }
}

/// Anything that turns circumstances into evidence.
pub type Trial<'a> = Box<dyn Fn(&Run) -> Result<Evidence, InputError> + Send + Sync + 'a>;

/// Which observation counts as a rejection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Criterion {
    /// The p-value of "exactly right" is below 1e-3.
    PValue,
    /// The 99.9 % interval lies wholly above the bound.
    Interval,
}

/// A named assertion, the trial that tests it, and the wrong versions that the same test must reject.
pub struct Claim {
    id: String,
    says: String,
    bound: Option<f64>,
    criterion: Criterion,
    first_level: Level,
    unraised: Level,
    trial: Trial<'static>,
    controls: Vec<(String, Trial<'static>)>,
}

/// A claim without its trial: what [`claim`] starts and [`ClaimBuilder::by`] completes.
#[must_use = "a claim is complete after `by`"]
pub struct ClaimBuilder {
    id: String,
    says: String,
    bound: Option<f64>,
    criterion: Criterion,
    controls: Vec<(String, Trial<'static>)>,
}

/// Starts a claim.
///
/// * `id`: `group/subject/property`, lower case; the name of its test.
/// * `says`: the assertion in one plain sentence.
pub fn claim(id: impl Into<String>, says: impl Into<String>) -> ClaimBuilder {
    ClaimBuilder {
        id: id.into(),
        says: says.into(),
        bound: None,
        criterion: Criterion::PValue,
        controls: Vec::new(),
    }
}

impl ClaimBuilder {
    /// Replaces the bound that the evidence carries, for this claim and its controls, in the quantity of the
    /// evidence's estimate.
    ///
    /// The sample count does not follow: a trial that derives n from a bound must be given it as well.
    pub fn bound(mut self, bound: f64) -> Self {
        self.bound = Some(bound);
        self
    }

    /// Rejects a run when its 99.9 % interval lies above the bound, instead of when its p-value is below
    /// 1e-3.
    ///
    /// For quantities of which no exact value is asserted (rates, slopes, costs); their evidence may have
    /// `p_value` NaN.
    pub fn judged_by_interval(mut self) -> Self {
        self.criterion = Criterion::Interval;
        self
    }

    /// Adds a control: a wrong version that the same test must reject in one run at n.
    pub fn rejects(
        mut self,
        name: impl Into<String>,
        trial: impl Fn(&Run) -> Result<Evidence, InputError> + Send + Sync + 'static,
    ) -> Self {
        self.controls.push((name.into(), Box::new(trial)));
        self
    }

    /// Completes the claim with the trial of its subject.
    pub fn by(self, trial: impl Fn(&Run) -> Result<Evidence, InputError> + Send + Sync + 'static) -> Claim {
        let Self { id, says, bound, criterion, controls } = self;
        let (first_level, trial) = (Level::Quick, Box::new(trial));
        Claim { id, says, bound, criterion, first_level, unraised: first_level, trial, controls }
    }
}

impl Claim {
    /// The claim's name, `group/subject/property`.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// The assertion in one sentence.
    pub fn says(&self) -> &str {
        &self.says
    }

    /// Leaves the claim out of the levels below `level`, at which it runs with its own sample count.
    ///
    /// For what costs too much for the quick level, or repeats there what a cheaper claim shows.
    pub fn from_level(mut self, level: Level) -> Self {
        self.first_level = level;
        self.same_up_to(level)
    }

    /// Keeps the sample count of its first level up to `level`; above, it rises as from there.
    ///
    /// For what is settled as it is, and has no sharper bound to reach.
    pub fn same_up_to(mut self, level: Level) -> Self {
        self.unraised = self.unraised.max(level);
        self
    }

    /// The lowest level whose list the claim is in.
    pub fn first_level(&self) -> Level {
        self.first_level
    }

    /// The factor on the claim's own sample count at `level`.
    fn effort(&self, level: Level) -> u64 {
        (level.effort() / self.unraised.effort()).max(1)
    }

    /// The names of its controls.
    pub fn controls(&self) -> impl Iterator<Item = &str> {
        self.controls.iter().map(|(name, _)| name.as_str())
    }

    /// Runs the subject until it holds or three runs are done, then each control once, on the random numbers of the
    /// subject's first run: a control differs from the subject by its mistake alone.
    ///
    /// * `seed`: master seed; each run's own derives from it, the claim's id and the step.
    /// * `level`: with the claim's first level, the factor on the sample count.
    ///
    /// # Errors
    /// Whatever a trial cannot do; and `Parameter` when a p-value or a bound is not a number, which no
    /// verdict can rest on.
    pub fn run(&self, seed: u64, level: Level) -> Result<Outcome, InputError> {
        let start = Instant::now();
        let (mut verdict, mut rejections, mut runs) = (Verdict::Undecided, 0, 0u8);
        let mut last = None;
        for (step, factor) in (0u64..).zip(ESCALATION) {
            let run = Run { seed: Seed::derive(seed, &self.id, step), effort: self.effort(level) * factor };
            let evidence = self.evidence(&self.trial, &run)?;
            runs += 1;
            let rejected = self.rejected(&evidence);
            rejections += usize::from(rejected);
            let settled = !rejected && evidence.is_within_bound();
            last = Some(evidence);
            if settled {
                verdict = Verdict::Holds;
                break;
            }
        }
        if rejections == ESCALATION.len() {
            verdict = Verdict::Fails;
        }
        let controls = self.run_controls(seed, level)?;
        if controls.iter().any(|control| !control.rejected) {
            verdict = Verdict::Fails;
        }
        Ok(Outcome {
            id: self.id.clone(),
            says: self.says.clone(),
            verdict,
            evidence: last.expect("the escalation has at least one step"),
            runs,
            controls,
            seconds: start.elapsed().as_secs_f64(),
            seed,
            level,
        })
    }

    fn run_controls(&self, seed: u64, level: Level) -> Result<Vec<ControlOutcome>, InputError> {
        let control = |(name, trial): &(String, Trial<'static>)| {
            let run = Run { seed: Seed::derive(seed, &self.id, 0), effort: self.effort(level) };
            let evidence = self.evidence(trial, &run)?;
            Ok(ControlOutcome {
                name: name.clone(),
                p_value: evidence.p_value,
                rejected: self.rejected(&evidence),
            })
        };
        self.controls.iter().map(control).collect()
    }

    fn evidence(&self, trial: &Trial<'static>, run: &Run) -> Result<Evidence, InputError> {
        let mut evidence = trial(run)?;
        evidence.bound = self.bound.unwrap_or(evidence.bound);
        if self.criterion == Criterion::PValue && !(0.0..=1.0).contains(&evidence.p_value) {
            return Err(InputError::Parameter {
                name: "p-value of a run",
                value: evidence.p_value,
                accepted: "0 to 1 (or a claim that is judged by its interval)",
            });
        }
        if evidence.bound.is_nan() || evidence.interval.iter().any(|limit| limit.is_nan()) {
            let value = if evidence.bound.is_nan() { evidence.bound } else { f64::NAN };
            return Err(InputError::Parameter {
                name: "bound or limit of a run",
                value,
                accepted: "a number",
            });
        }
        Ok(evidence)
    }

    fn rejected(&self, evidence: &Evidence) -> bool {
        match self.criterion {
            Criterion::PValue => evidence.p_value < REJECTION_LEVEL,
            Criterion::Interval => evidence.interval[0] > evidence.bound,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    /// Evidence with p, interval, and bound 1.
    fn found(p_value: f64, interval: [f64; 2]) -> Evidence {
        Evidence {
            method: String::from("given"),
            n: 1,
            statistic: 0.0,
            dof: None,
            p_value,
            estimate: interval[0],
            interval,
            bound: 1.0,
            resolution: Resolution { quantity: "given", value: 0.5, power: 0.9 },
            doubts: Vec::new(),
            pictures: Vec::new(),
        }
    }

    /// A claim whose k-th run gives the k-th evidence, and the runs that it asked for.
    fn verdict_of(script: Vec<Evidence>) -> Outcome {
        let script = Mutex::new(script.into_iter());
        let next =
            move |_: &Run| Ok(script.lock().expect("no panic inside").next().expect("script is long enough"));
        let claim = claim("a/b/c", "scripted").by(next);
        assert_eq!((claim.id(), claim.says()), ("a/b/c", "scripted"));
        claim.run(0, Level::Quick).expect("runs")
    }

    #[test]
    fn a_run_inside_the_bound_holds_at_once() {
        let outcome = verdict_of(vec![found(0.5, [0.0, 0.9])]);
        assert_eq!((outcome.verdict, outcome.runs), (Verdict::Holds, 1));
    }

    #[test]
    fn three_rejections_fail_and_two_do_not() {
        let wrong = || found(1e-9, [0.0, 0.9]);
        let outcome = verdict_of(vec![wrong(), wrong(), wrong()]);
        assert_eq!((outcome.verdict, outcome.runs), (Verdict::Fails, 3));
        let outcome = verdict_of(vec![wrong(), wrong(), found(0.2, [0.0, 0.9])]);
        assert_eq!((outcome.verdict, outcome.runs), (Verdict::Holds, 3));
        let outcome = verdict_of(vec![found(0.2, [0.0, 1.1]), wrong(), wrong()]);
        assert_eq!((outcome.verdict, outcome.runs), (Verdict::Undecided, 3));
    }

    #[test]
    fn a_limit_at_the_bound_or_a_doubt_never_holds() {
        let at_bound = || found(0.5, [0.0, 1.0]);
        assert_eq!(verdict_of(vec![at_bound(), at_bound(), at_bound()]).verdict, Verdict::Undecided);
        let doubtful = || Evidence {
            doubts: vec![String::from("one sample is half of the sum")],
            ..found(0.5, [0.0, 0.1])
        };
        assert_eq!(verdict_of(vec![doubtful(), doubtful(), doubtful()]).verdict, Verdict::Undecided);
    }

    #[test]
    fn runs_have_fresh_seeds_and_the_efforts_of_level_and_step() {
        let runs = std::sync::Arc::new(Mutex::new(Vec::new()));
        let log = runs.clone();
        let trial = move |run: &Run| {
            log.lock().expect("no panic inside").push(*run);
            Ok(found(0.0, [2.0, 3.0]))
        };
        claim("a/b/c", "").by(trial).run(7, Level::Standard).expect("runs");
        let runs = runs.lock().expect("no panic inside");
        assert_eq!(runs.iter().map(|run| run.effort).collect::<Vec<_>>(), [8, 32, 128]);
        assert!(runs[0].seed != runs[1].seed && runs[1].seed != runs[2].seed && runs[0].seed != 7);
    }

    #[test]
    fn a_claim_from_a_level_on_has_its_own_sample_count_there() {
        let trial = |run: &Run| Ok(Evidence { n: run.effort, ..found(0.5, [0.0, 0.1]) });
        let counts = |claim: Claim| {
            let n = |level| claim.run(0, level).expect("runs").evidence.n;
            [Level::Quick, Level::Standard, Level::Exhaustive].map(n)
        };
        assert_eq!(counts(claim("a/b/c", "").by(trial).from_level(Level::Standard)), [1, 1, 8]);
        assert_eq!(counts(claim("a/b/c", "").by(trial).same_up_to(Level::Standard)), [1, 1, 8]);
    }

    #[test]
    fn an_accepted_control_makes_a_right_claim_fail() {
        let with_control = |p| {
            let subject = |_: &Run| Ok(found(0.5, [0.0, 0.1]));
            claim("a/b/c", "")
                .rejects("wrong", move |_| Ok(found(p, [0.0, 0.1])))
                .by(subject)
                .run(0, Level::Quick)
        };
        let rejected = with_control(1e-4).expect("runs");
        assert_eq!(rejected.verdict, Verdict::Holds);
        let accepted = with_control(1e-2).expect("runs");
        assert_eq!((accepted.verdict, accepted.runs), (Verdict::Fails, 1));
        assert!(!accepted.controls[0].rejected);
    }

    #[test]
    fn an_interval_claim_rejects_above_its_bound_and_takes_no_p_value() {
        let run = |interval, bound| {
            let trial = move |_: &Run| Ok(found(f64::NAN, interval));
            claim("a/b/c", "")
                .bound(bound)
                .judged_by_interval()
                .by(trial)
                .run(0, Level::Quick)
                .expect("runs")
                .verdict
        };
        assert_eq!(run([2.0, 3.0], 1.5), Verdict::Fails);
        assert_eq!(run([2.0, 3.0], 2.5), Verdict::Undecided);
        assert_eq!(run([2.0, 3.0], 3.5), Verdict::Holds);
    }

    #[test]
    fn a_p_value_that_is_not_a_number_is_an_error() {
        let outcome = claim("a/b/c", "").by(|_| Ok(found(f64::NAN, [0.0, 0.1]))).run(0, Level::Quick);
        assert!(matches!(outcome, Err(InputError::Parameter { .. })));
    }
}
