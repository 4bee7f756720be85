//! Points in a file, read piece by piece: .npy, .csv and raw little-endian numbers.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use super::{csv, npy};
use crate::cli::CliError;

/// Values that are read at a time.
const BATCH: usize = 1 << 16;

/// How numbers are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Number {
    /// Eight bytes instead of four.
    pub double: bool,
    /// The highest byte first.
    pub big_endian: bool,
}

impl Number {
    pub(super) fn bytes(self) -> usize {
        if self.double { 8 } else { 4 }
    }

    fn decode(self, bytes: &[u8]) -> f64 {
        let mut ordered = [0; 8];
        let ordered = &mut ordered[..bytes.len()];
        ordered.copy_from_slice(bytes);
        if self.big_endian {
            ordered.reverse();
        }
        match *ordered {
            [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
            [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
            _ => unreachable!("numbers have four or eight bytes"),
        }
    }
}

/// An open file of points: .npy, .csv or raw numbers.
pub struct Points {
    path: PathBuf,
    file: BufReader<File>,
    dimensions: usize,
    kind: Kind,
    /// Rows read so far.
    rows: u64,
}

/// How the rows lie in the file.
enum Kind {
    /// Numbers one after the other; as many rows as a header says, or up to the end.
    Binary { number: Number, rows: Option<u64> },
    /// One row a line.
    Csv(csv::Lines),
}

impl Points {
    /// Opens a file; its kind follows from its ending.
    ///
    /// * `dimensions`: coordinates of a point, from 1.
    /// * `dtype`: how a raw file stores numbers.
    ///
    /// # Errors
    /// `CliError::Io` for a file that cannot be read, `CliError::Points` for a header that does not fit, and for a kind without
    /// `dtype` or with one too many.
    pub fn open(path: &Path, dimensions: usize, dtype: Option<Number>) -> Result<Self, CliError> {
        let opened = File::open(path).map_err(|source| CliError::Io { path: path.to_owned(), source })?;
        let mut file = BufReader::with_capacity(1 << 18, opened);
        let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_lowercase);
        let kind = match (ending.as_deref(), dtype) {
            (Some("npy" | "csv"), Some(_)) => {
                let message = "a .npy or .csv file says itself how its numbers are stored; --dtype is accepted for raw files";
                return Err(refused(path, message));
            }
            (Some("npy"), None) => {
                let header = npy::header(&mut file).map_err(|message| refused(path, &message))?;
                let rows = header.rows(dimensions).map_err(|message| refused(path, &message))?;
                Kind::Binary { number: header.number, rows: Some(rows) }
            }
            (Some("csv"), None) => Kind::Csv(csv::Lines::default()),
            (_, Some(number)) => Kind::Binary { number, rows: None },
            (_, None) => {
                let message = "neither .npy nor .csv; a raw file of little-endian numbers is accepted with --dtype f32 or f64";
                return Err(refused(path, message));
            }
        };
        Ok(Self { path: path.to_owned(), file, dimensions, kind, rows: 0 })
    }

    /// Reads the next rows into `values`, one after the other; returns whether there were any.
    ///
    /// # Errors
    /// `CliError::Points`, with the row, for what is no finite number, for incomplete rows, and for bytes after the last one.
    pub fn next(&mut self, values: &mut Vec<f64>) -> Result<bool, CliError> {
        values.clear();
        let wanted = (BATCH / self.dimensions).max(1);
        let read = match &mut self.kind {
            Kind::Binary { number, rows } => {
                let left = rows.map_or(u64::MAX, |rows| rows - self.rows);
                let wanted = usize::try_from(left).unwrap_or(usize::MAX).min(wanted);
                let complete = binary(&mut self.file, *number, wanted * self.dimensions, values);
                complete
                    .and_then(|()| truncation(values.len(), self.dimensions, rows.is_some() && wanted > 0))
            }
            Kind::Csv(lines) => lines.read(&mut self.file, self.dimensions, wanted, values),
        };
        let whole = values.len() / self.dimensions;
        let finite = values.iter().position(|value| !value.is_finite());
        if let Some(place) = finite {
            let (row, column) = (self.rows + (place / self.dimensions) as u64, place % self.dimensions);
            let message = format!("{} in column {column}; finite numbers are accepted", values[place]);
            return Err(self.at(row, &message));
        }
        read.map_err(|message| self.at(self.rows + whole as u64, &message))?;
        self.rows += whole as u64;
        if whole == 0 {
            self.check_end()?;
        }
        Ok(whole > 0)
    }

    /// After the last row: there must have been one, and nothing may follow.
    fn check_end(&mut self) -> Result<(), CliError> {
        if self.rows == 0 {
            return Err(refused(&self.path, "no points in it"));
        }
        let mut byte = [0];
        if self.file.read(&mut byte).map_err(|source| CliError::Io { path: self.path.clone(), source })? > 0 {
            let message = format!(
                "more bytes after the last of {} rows; the shape in its header is accepted",
                self.rows
            );
            return Err(refused(&self.path, &message));
        }
        Ok(())
    }

    fn at(&self, row: u64, message: &str) -> CliError {
        refused(&self.path, &format!("row {row} (the first is 0): {message}"))
    }
}

/// Reads up to `wanted` numbers; fewer at the end of the file.
fn binary(file: &mut impl Read, number: Number, wanted: usize, values: &mut Vec<f64>) -> Result<(), String> {
    let size = number.bytes();
    let mut bytes = Vec::with_capacity(wanted * size);
    let limit = (wanted * size) as u64;
    file.take(limit).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    values.extend(bytes.chunks_exact(size).map(|bytes| number.decode(bytes)));
    match bytes.len() % size {
        0 => Ok(()),
        rest => Err(format!("the file ends after {rest} of the {size} bytes of a number")),
    }
}

/// Whether rows are complete.
///
/// * `promised`: a header says that there are rows left.
fn truncation(values: usize, dimensions: usize, promised: bool) -> Result<(), String> {
    match values % dimensions {
        0 if values == 0 && promised => {
            Err(String::from("the file ends; its header says that rows are left"))
        }
        0 => Ok(()),
        rest => Err(format!("the file ends after {rest} of {dimensions} values")),
    }
}

/// What is wrong with a file.
pub(super) fn refused(path: &Path, message: &str) -> CliError {
    CliError::Points { path: path.to_owned(), message: String::from(message) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_both_sizes_and_orders_are_read() {
        let single = Number { double: false, big_endian: false };
        assert_eq!(single.decode(&1.5f32.to_le_bytes()), 1.5);
        assert_eq!(Number { big_endian: true, ..single }.decode(&1.5f32.to_be_bytes()), 1.5);
        let double = Number { double: true, big_endian: false };
        assert_eq!(double.decode(&(-0.1f64).to_le_bytes()), -0.1);
        assert_eq!(Number { big_endian: true, ..double }.decode(&(-0.1f64).to_be_bytes()), -0.1);
    }

    #[test]
    fn incomplete_numbers_and_rows_are_seen() {
        let number = Number { double: true, big_endian: false };
        let mut values = Vec::new();
        assert_eq!(binary(&mut &[0u8; 24][..], number, 2, &mut values), Ok(()));
        assert_eq!(values, [0.0, 0.0]);
        assert!(binary(&mut &[0u8; 9][..], number, 5, &mut values).is_err());
        assert!(truncation(3, 2, false).is_err() && truncation(0, 2, true).is_err());
        assert!(truncation(0, 2, false).is_ok() && truncation(4, 2, true).is_ok());
    }
    /// What the fuzzer starts from, and what it found: `line-break` made a message of two lines.
    #[test]
    fn the_fuzzers_inputs_are_read_or_refused_in_one_line() {
        let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../renderer/fuzz/corpus/samples");
        let folder = std::env::temp_dir().join(format!("lightproof-samples-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (mut read, mut refused) = (0, 0);
        for entry in std::fs::read_dir(corpus).unwrap() {
            // As in the fuzz target: the first byte says what the rest is.
            let bytes = std::fs::read(entry.unwrap().path()).unwrap();
            let (kind, dimensions) = (usize::from(bytes[0] & 3), usize::from(bytes[0] >> 2 & 3) + 1);
            let path = folder.join("points").with_extension(["npy", "csv", "raw", "raw"][kind]);
            std::fs::write(&path, &bytes[1..]).unwrap();
            let dtype = (kind > 1).then_some(Number { double: kind == 3, big_endian: false });
            let mut values = Vec::new();
            let whole = Points::open(&path, dimensions, dtype).and_then(|mut points| {
                while points.next(&mut values)? {}
                Ok(())
            });
            match whole {
                Ok(()) => read += 1,
                Err(error) => {
                    assert!(!error.to_string().contains('\n'), "{error}");
                    refused += 1;
                }
            }
        }
        std::fs::remove_dir_all(&folder).unwrap();
        assert!(read >= 6 && refused >= 1, "{read} read, {refused} refused");
    }
}
