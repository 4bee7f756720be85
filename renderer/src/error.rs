//! What can go wrong before or around rendering. Rendering itself does not fail.

use std::path::{Path, PathBuf};

/// Why a scene, a file or a setting was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An object of the scene has a parameter that is not accepted.
    #[error("{object}: {reason}")]
    Scene {
        /// The object, by its kind and its name or place.
        object: String,
        /// What is wrong with it.
        reason: ParamError,
    },
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's word.
        source: std::io::Error,
    },
    /// A file's content is not what its format says.
    #[error("{}: {}", place(path, *line, *column), one_line(message))]
    Format {
        /// The file.
        path: PathBuf,
        /// Line, from 1; 0 in a file without lines, whose message names the vertex, face or attribute.
        line: u32,
        /// Column, from 1; 0 where the whole line is meant.
        column: u32,
        /// What is wrong, and what is accepted.
        message: String,
    },
    /// A valid file that asks for something that is not built.
    #[error("{}: {} is not supported; {accepted}", place(path, *line, *column), one_line(feature))]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u32,
        /// Column, from 1.
        column: u32,
        /// What it asks for.
        feature: String,
        /// What is accepted instead.
        accepted: String,
    },
}

/// The file, with as much of line and column as is known.
fn place(path: &Path, line: u32, column: u32) -> String {
    match (line, column) {
        (0, _) => path.display().to_string(),
        (_, 0) => format!("{}:{line}", path.display()),
        _ => format!("{}:{line}:{column}", path.display()),
    }
}

/// The message with the line breaks and other control characters that it quotes from a file written out, as `\n`.
fn one_line(message: &str) -> String {
    let mut line = String::with_capacity(message.len());
    for c in message.chars() {
        if c.is_control() { line.extend(c.escape_default()) } else { line.push(c) }
    }
    line
}

/// A parameter's value breaks an inequality.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParamError {
    /// Not a finite number.
    #[error("{name} is {value}; a finite number is accepted")]
    NotFinite {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// Outside its range.
    #[error("{name} is {value}; {accepted} is accepted")]
    OutOfRange {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The accepted range.
        accepted: &'static str,
    },
    /// A transform that flattens space.
    #[error("{name} is singular (determinant {determinant:e}); an invertible transform is accepted")]
    Singular {
        /// The parameter.
        name: &'static str,
        /// The determinant of its linear part.
        determinant: f64,
    },
    /// A shape without area or a mesh without faces.
    #[error("{name} is empty; {accepted} is accepted")]
    Empty {
        /// What is empty.
        name: &'static str,
        /// What is accepted.
        accepted: &'static str,
    },
    /// An index that points at nothing.
    #[error("{name} {index} is out of range; 0 to {last} is accepted")]
    Index {
        /// What is indexed.
        name: &'static str,
        /// The index.
        index: u64,
        /// The last one that exists.
        last: u64,
    },
}
