//! Why a command could not run: status 2 and one message.

use std::path::PathBuf;

use crate::report::ReadError;

/// Why a command could not run.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// A file could not be written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's word.
        source: std::io::Error,
    },
    /// A report could not be read.
    #[error("{}: {source}", path.display())]
    Report {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: ReadError,
    },
    /// No claim has such a name.
    #[error("--only {pattern}: no claim has such a name; the nearest are {nearest}")]
    NoMatch {
        /// The pattern given.
        pattern: String,
        /// Names like it.
        nearest: String,
    },
    /// The claims of such a name belong to a higher level.
    #[error("--only {pattern}: its claims run from --level {} on", first.name())]
    AboveLevel {
        /// The pattern given.
        pattern: String,
        /// The lowest level that has one of them.
        first: verify::claim::Level,
    },
    /// Some claims could not run; each was named when it happened.
    #[error("{count} of {total} claims could not run: {first}")]
    Claims {
        /// How many.
        count: usize,
        /// Of how many.
        total: usize,
        /// The first of them and its reason.
        first: String,
    },
    /// A table of exact values could not be read.
    #[error(transparent)]
    Stability(verify::error::InputError),
    /// An image could not be read.
    #[error(transparent)]
    Image(#[from] renderer::Error),
    /// What belongs to an image contradicts it.
    #[error("{}: {message}", path.display())]
    Sidecar {
        /// The file beside the image.
        path: PathBuf,
        /// The contradiction, and what is accepted.
        message: String,
    },
    /// A file of points or densities that cannot be used.
    #[error("{}: {message}", path.display())]
    Points {
        /// The file.
        path: PathBuf,
        /// What is wrong, at which row, and what is accepted.
        message: String,
    },
    /// A setting that the renderer refuses.
    #[error(transparent)]
    Setting(#[from] renderer::ParamError),
    /// A file of a kind that is not written.
    #[error("{}: {accepted} is accepted", path.display())]
    Kind {
        /// The file.
        path: PathBuf,
        /// The accepted endings.
        accepted: &'static str,
    },
    /// Arguments that are not what the command takes.
    #[error("{0}")]
    Arguments(String),
    /// A test could not be carried out.
    #[error("{subject}: {reason}")]
    Test {
        /// Of what.
        subject: String,
        /// Why.
        reason: verify::error::InputError,
    },
    /// Standard output failed.
    #[error("standard output: {0}")]
    Output(std::io::Error),
    /// Nobody reads standard output any more: a quiet end.
    #[error("standard output is closed")]
    Closed,
    /// A report could not be put into JSON.
    #[error("report: {0}")]
    Json(#[from] serde_json::Error),
    /// The pool of threads could not be started.
    #[error("--threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

impl From<std::io::Error> for CliError {
    /// An error of standard output or standard error; files say their path instead.
    fn from(error: std::io::Error) -> Self {
        if error.kind() == std::io::ErrorKind::BrokenPipe { Self::Closed } else { Self::Output(error) }
    }
}
