//! The header of an .npy file.

use std::io::Read;

use super::file::Number;

/// Longest header that is read; that of an array of numbers is some hundred bytes.
const LONGEST: u64 = 1 << 16;

/// What an .npy file holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) number: Number,
    pub(super) shape: Vec<u64>,
    fortran: bool,
}

/// Reads the header; the numbers follow.
///
/// # Source
/// `NumPy` Enhancement Proposal 1, "A Simple File Format for `NumPy` Arrays".
pub(super) fn header(file: &mut impl Read) -> Result<Header, String> {
    let mut start = [0; 8];
    file.read_exact(&mut start)
        .map_err(|_| String::from("ends within the first 8 bytes of an .npy header"))?;
    if &start[..6] != b"\x93NUMPY" {
        return Err(String::from("no .npy file: it does not begin with \\x93NUMPY"));
    }
    let mut size = [0; 4];
    let bytes = match start[6] {
        1 => 2,
        2 | 3 => 4,
        version => return Err(format!("version {version} of the .npy format; 1, 2 and 3 are accepted")),
    };
    let cut = || String::from("ends within its .npy header");
    file.read_exact(&mut size[..bytes]).map_err(|_| cut())?;
    let size = u64::from(u32::from_le_bytes(size));
    if size > LONGEST {
        return Err(format!("its .npy header has {size} bytes; at most {LONGEST} are accepted"));
    }
    let mut text = Vec::new();
    file.take(size).read_to_end(&mut text).map_err(|error| error.to_string())?;
    if text.len() as u64 != size {
        return Err(cut());
    }
    parse(&String::from_utf8_lossy(&text))
}

/// Reads the dictionary, such as `{'descr': '<f8', 'fortran_order': False, 'shape': (10, 2), }`.
fn parse(text: &str) -> Result<Header, String> {
    let after = |key: &str| {
        let found = text.split_once(&format!("'{key}':")).map(|(_, rest)| rest.trim_start());
        found.ok_or_else(|| format!("its .npy header has no {key}"))
    };
    let kind = after("descr")?;
    let kind = kind.split([',', '}']).next().unwrap_or(kind).trim().trim_matches('\'');
    let number = match kind {
        "<f4" => Number { double: false, big_endian: false },
        "<f8" => Number { double: true, big_endian: false },
        ">f4" => Number { double: false, big_endian: true },
        ">f8" => Number { double: true, big_endian: true },
        other => return Err(format!("its numbers are of type {other:?}; float32 and float64 are accepted")),
    };
    let shape = after("shape")?.trim_start_matches('(');
    let shape = shape.split(')').next().unwrap_or(shape).split(',').map(str::trim).filter(|n| !n.is_empty());
    let shape = shape.map(|n| n.parse().map_err(|_| format!("its shape has the entry {n:?}")));
    let fortran = after("fortran_order")?.starts_with("True");
    Ok(Header { number, shape: shape.collect::<Result<_, _>>()?, fortran })
}

impl Header {
    /// The number of points of a given number of coordinates.
    pub(super) fn rows(&self, dimensions: usize) -> Result<u64, String> {
        let shape = self.shape.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
        let accepted = if dimensions == 1 { "(n,) or (n, 1)".into() } else { format!("(n, {dimensions})") };
        let rows = match *self.shape {
            [rows] if dimensions == 1 => Ok(rows),
            [rows, columns] if columns == dimensions as u64 => Ok(rows),
            _ => Err(format!("its shape is ({shape}); {accepted} is accepted for this domain")),
        }?;
        if self.fortran && dimensions > 1 {
            return Err(String::from(
                "stored column by column; row by row is accepted (numpy.ascontiguousarray)",
            ));
        }
        Ok(rows)
    }

    /// Columns and rows of a table; one row for a list.
    pub(super) fn table(&self) -> Result<[usize; 2], String> {
        let size = |n: u64| usize::try_from(n).map_err(|error| error.to_string());
        match *self.shape {
            [columns] => Ok([size(columns)?, 1]),
            [rows, columns] if !self.fortran => Ok([size(columns)?, size(rows)?]),
            _ => Err(format!(
                "its shape is {:?}; (columns,) or (rows, columns), row by row, is accepted",
                self.shape
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(version: u8, text: &str) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY".to_vec();
        bytes.extend([version, 0]);
        let size = u32::try_from(text.len()).expect("short");
        bytes.extend(&size.to_le_bytes()[..if version == 1 { 2 } else { 4 }]);
        bytes.extend(text.bytes());
        bytes
    }

    #[test]
    fn headers_of_all_versions_are_read() {
        let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (10, 3), }   \n";
        for version in [1, 2, 3] {
            let header = header(&mut &file(version, text)[..]).expect("a header");
            assert_eq!((header.rows(3), header.number.bytes()), (Ok(10), 4));
            assert!(header.rows(2).is_err_and(|message| message.contains("(10, 3)")));
        }
        let list = parse("{'descr': '>f8', 'fortran_order': True, 'shape': (7,), }").expect("a header");
        assert_eq!((list.rows(1), list.number.big_endian), (Ok(7), true));
        assert_eq!(list.table(), Ok([7, 1]));
    }

    #[test]
    fn what_is_no_array_of_numbers_is_refused() {
        let good = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }";
        assert!(header(&mut &file(9, good)[..]).is_err_and(|message| message.contains("version 9")));
        assert!(header(&mut &file(1, good)[..20]).is_err_and(|message| message.contains("ends within")));
        assert!(header(&mut &b"x,y\n0.1,0.2\n"[..]).is_err_and(|message| message.contains("does not begin")));
        assert!(parse(&good.replace("<f8", "<i8")).is_err_and(|message| message.contains("<i8")));
        let fortran = parse(&good.replace("False", "True")).expect("a header");
        assert!(fortran.rows(2).is_err() && fortran.table().is_err());
    }
}
