//! What running a claim gives: its verdict, the evidence of its last run, its controls; and the message of a
//! test that does not hold.

use std::fmt::{Display, Formatter};
use std::fs::{create_dir_all, write};
use std::path::Path;

use super::{Evidence, Level, Picture, Verdict};
use crate::picture::{self, Residual};

/// How a wrong version fared.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlOutcome {
    /// The control's name.
    pub name: String,
    /// Its probability under "exactly right".
    pub p_value: f64,
    /// Whether the test rejected it, as it must.
    pub rejected: bool,
}

/// The result of a claim.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The claim's name.
    pub id: String,
    /// The assertion in one sentence.
    pub says: String,
    /// What is concluded.
    pub verdict: Verdict,
    /// Evidence of the last run of the subject.
    pub evidence: Evidence,
    /// Number of runs of the subject: 1 to 3.
    pub runs: u8,
    /// The controls, each run once.
    pub controls: Vec<ControlOutcome>,
    /// Wall time of all runs, controls included.
    pub seconds: f64,
    /// The master seed.
    pub seed: u64,
    /// The level.
    pub level: Level,
}

impl Outcome {
    /// Controls that the test accepted although they are wrong; each makes the claim fail.
    pub fn accepted_controls(&self) -> impl Iterator<Item = &ControlOutcome> {
        self.controls.iter().filter(|control| !control.rejected)
    }

    /// Passes if the verdict is `Holds`.
    ///
    /// # Panics
    /// Otherwise; the message has statistic, degrees of freedom, p, level, n, seed, the three worst cells,
    /// and the command that repeats it. A test that counts in cells leaves a picture in `target/lightproof`.
    pub fn assert_holds(&self) {
        assert!(self.verdict == Verdict::Holds, "{self}{}", self.leave_picture());
    }

    /// Draws the cells into a file; returns words on where it is.
    fn leave_picture(&self) -> String {
        let title = format!("{} {}: {}", self.id, self.verdict, self.says);
        let Some(text) = picture::svg(&title, &self.command(), &self.evidence) else { return String::new() };
        let name = self.id.replace(|c: char| !c.is_alphanumeric(), "-");
        let path = Path::new("target/lightproof").join(name).with_extension("svg");
        let written = path.parent().map_or(Ok(()), create_dir_all).and_then(|()| write(&path, text));
        match written {
            Ok(()) => format!("\n  picture: {}", path.display()),
            Err(error) => format!("\n  no picture: {}: {error}", path.display()),
        }
    }

    /// The command that repeats a test: the test's own name where the thread has one, as under `cargo test`;
    /// else the claim's id.
    fn command(&self) -> String {
        let thread = std::thread::current();
        let test = thread.name().filter(|name| *name != "main").unwrap_or(&self.id);
        format!("VERIFY_SEED={} VERIFY_LEVEL={} cargo test {test:?}", self.seed, self.level.name())
    }
}

impl Display for Outcome {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let e = &self.evidence;
        writeln!(f, "{} {}: {}", self.id, self.verdict, self.says)?;
        write!(f, "  {}: statistic {:.6}, ", e.method, e.statistic)?;
        if let Some(dof) = e.dof {
            write!(f, "dof {dof}, ")?;
        }
        writeln!(
            f,
            "p {:.3e}, n {}, run {} of at most 3, level {}, seed {}",
            e.p_value,
            e.n,
            self.runs,
            self.level.name(),
            self.seed
        )?;
        let [low, high] = e.interval;
        let resolution = &e.resolution;
        writeln!(
            f,
            "  {}: {:.4e} in [{low:.4e}, {high:.4e}], bound {:.4e}",
            resolution.quantity, e.estimate, e.bound
        )?;
        writeln!(f, "  resolves {:.4e} with power {}", resolution.value, resolution.power)?;
        for doubt in &e.doubts {
            writeln!(f, "  doubt: {doubt}")?;
        }
        for control in self.accepted_controls() {
            writeln!(
                f,
                "  control \"{}\" is wrong and was accepted, p {:.3e}: the test is blind to it",
                control.name, control.p_value
            )?;
        }
        e.pictures.iter().try_for_each(|picture| worst_cells(f, picture))?;
        write!(f, "  repeat with: {}", self.command())
    }
}

/// Writes the three cells of largest standardised residual.
fn worst_cells(f: &mut Formatter<'_>, picture: &Picture) -> std::fmt::Result {
    let Picture::Cells { shape, axes: [x, y], .. } = picture else { return Ok(()) };
    for Residual { cell: [column, row], observed, expected, deviations } in picture::worst_cells(picture, 3) {
        writeln!(
            f,
            "  cell {x} {column}/{}, {y} {row}/{}: observed {observed}, expected {expected:.1}, residual {deviations:+.2}",
            shape[0], shape[1]
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claim::Resolution;

    fn outcome(verdict: Verdict) -> Outcome {
        let picture = Picture::Cells {
            shape: [2, 2],
            axes: ["r^2", "phi"],
            observed: vec![100.0, 130.0, 70.0, 3.0],
            expected: vec![100.0, 100.0, 100.0, 0.0],
        };
        let evidence = Evidence {
            method: String::from("chi-square, 4 cells"),
            n: 303,
            statistic: 18.0,
            dof: Some(3.0),
            p_value: 4.4e-4,
            estimate: 0.2,
            interval: [0.1, 0.3],
            bound: 0.01,
            resolution: Resolution { quantity: "RMS relative error over cells", value: 0.25, power: 0.9 },
            doubts: vec![String::from("few cells")],
            pictures: vec![picture],
        };
        let controls = vec![ControlOutcome { name: String::from("naive"), p_value: 0.5, rejected: false }];
        let says = String::from("points are uniform");
        Outcome {
            id: String::from("a/b/c"),
            says,
            verdict,
            evidence,
            runs: 3,
            controls,
            seconds: 0.1,
            seed: 42,
            level: Level::Quick,
        }
    }

    #[test]
    fn the_message_names_everything_needed_to_repeat_the_run() {
        let message = outcome(Verdict::Fails).to_string();
        for part in [
            "a/b/c fails",
            "statistic 18",
            "dof 3",
            "p 4.400e-4",
            "n 303",
            "seed 42",
            "level quick",
            "bound 1.0000e-2",
            "\"naive\"",
        ] {
            assert!(message.contains(part), "{part} is missing in {message}");
        }
        assert!(message.contains("VERIFY_SEED=42 VERIFY_LEVEL=quick cargo test"));
        let worst = message
            .find("phi 1/2: observed 3, expected 0.0, residual +inf")
            .expect("the impossible cell is named");
        assert!(worst < message.find("residual +3.00").expect("then the second worst"));
    }

    #[test]
    fn holding_passes() {
        outcome(Verdict::Holds).assert_holds();
    }

    #[test]
    #[should_panic(expected = "undecided")]
    fn undecided_does_not_pass() {
        outcome(Verdict::Undecided).assert_holds();
    }
}
