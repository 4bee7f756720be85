//! Points as text: one a line, numbers between commas.

use std::io::{BufRead, Read};

/// Longest line that is read.
const LONGEST: u64 = 1 << 16;

/// The lines of a file, as far as they have been read.
#[derive(Default)]
pub(super) struct Lines {
    /// Number of the last line, from 1.
    line: u64,
    text: String,
}

impl Lines {
    /// Reads up to `wanted` rows; fewer at the end of the file.
    ///
    /// Lines that begin with `#` are left out, and so is the first line if its first field is no number: names of columns.
    pub(super) fn read(
        &mut self,
        file: &mut impl BufRead,
        dimensions: usize,
        wanted: usize,
        values: &mut Vec<f64>,
    ) -> Result<(), String> {
        while values.len() < wanted * dimensions {
            self.text.clear();
            self.line += 1;
            let read = file.by_ref().take(LONGEST).read_line(&mut self.text);
            let read = read.map_err(|error| format!("line {}: {error}", self.line))?;
            if read == 0 {
                return Ok(());
            }
            if read as u64 == LONGEST {
                return Err(format!("line {}: longer than {LONGEST} bytes", self.line));
            }
            let text = self.text.trim();
            let names = self.line == 1 && text.split(',').next().is_none_or(|field| number(field).is_none());
            if names || text.starts_with('#') {
                continue;
            }
            let before = values.len();
            for field in text.split(',') {
                let message = || format!("line {}: {:?} is no number", self.line, field.trim());
                values.push(number(field).ok_or_else(message)?);
            }
            let given = values.len() - before;
            if given != dimensions {
                values.truncate(before);
                return Err(format!("line {}: {given} values; {dimensions} are accepted", self.line));
            }
        }
        Ok(())
    }
}

fn number(field: &str) -> Option<f64> {
    field.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<f64>, String> {
        let mut values = Vec::new();
        Lines::default().read(&mut text.as_bytes(), 2, 100, &mut values).map(|()| values)
    }

    #[test]
    fn rows_are_read_with_and_without_names() {
        assert_eq!(read("0.5,1\n-2, 3e-1\n"), Ok(vec![0.5, 1.0, -2.0, 0.3]));
        assert_eq!(read("x,y\n# made by hand\n1,2"), Ok(vec![1.0, 2.0]));
    }

    #[test]
    fn wrong_lines_are_named() {
        assert!(read("1,2\n3\n").is_err_and(|message| message.contains("line 2: 1 values")));
        assert!(read("1,2\n3,x\n").is_err_and(|message| message.contains("line 2: \"x\"")));
        assert!(read("1,2\n\n3,4\n").is_err_and(|message| message.contains("line 2")));
        assert!(read(&"1".repeat(1 << 17)).is_err_and(|message| message.contains("longer")));
    }
}
