//! Files of points for `lightproof samples`: finite rows, or one line that refuses them.
//!
//! Bits of the first byte say what the rest is: 0 and 1 its kind (.npy, .csv, raw f32, raw f64), 2 and 3 coordinates less one.
#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use lightproof::cli::CliError;
use lightproof::cli::points::{Number, Points};

/// A folder of this process, for the file that the reader opens.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("lightproof-fuzz-samples-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the folder for temporary files can be written");
    folder
});

/// Reads to the end; the number of values.
fn read(mut points: Points, dimensions: usize) -> Result<u64, CliError> {
    let (mut values, mut count) = (Vec::new(), 0);
    while points.next(&mut values)? {
        assert!(!values.is_empty() && values.len() % dimensions == 0, "{} values", values.len());
        assert!(values.iter().all(|value| value.is_finite()));
        count += values.len() as u64;
    }
    Ok(count)
}

fuzz_target!(|data: &[u8]| {
    let Some((&kind, bytes)) = data.split_first() else { return };
    let dimensions = usize::from(kind >> 2 & 3) + 1;
    let ending = ["npy", "csv", "raw", "raw"][usize::from(kind & 3)];
    let dtype = (kind & 2 > 0).then_some(Number { double: kind & 1 > 0, big_endian: false });
    let path = FOLDER.join("points").with_extension(ending);
    std::fs::write(&path, bytes).expect("the folder for temporary files can be written");
    match Points::open(&path, dimensions, dtype).and_then(|points| read(points, dimensions)) {
        Ok(count) => assert!(count > 0),
        Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
    }
});
